"""HTML report of a result in a single file."""
