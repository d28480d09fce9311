"""The guide, one chapter per file."""
