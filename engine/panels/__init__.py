"""Curves at positions of each variant's own, between the places where loads set in."""
