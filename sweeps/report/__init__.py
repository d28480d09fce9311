"""What a study will do and what its results say, in words, tables and the formats of other programs."""
