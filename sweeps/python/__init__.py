"""Datasets, figures and notebook display for Python."""
