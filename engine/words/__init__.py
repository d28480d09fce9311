"""What engineers call things, and what is said of a variant that has no answer."""
