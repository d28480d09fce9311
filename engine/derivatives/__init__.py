"""Derivatives of summaries by the numbers of a scene."""
