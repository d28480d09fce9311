"""The guide: what the README has no room for, a chapter a file."""
