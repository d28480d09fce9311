"""Linkages of other programs as scenes."""
