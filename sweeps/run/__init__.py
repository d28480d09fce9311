"""Running a study into a result file: blocks, progress and cost."""
