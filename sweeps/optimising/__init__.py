"""Searching for the best variants of a study: what is sought, by which method, into which file, and what it says."""
