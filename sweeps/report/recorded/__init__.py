"""What a result file records: columns over variants, the study that made them, its scene."""
