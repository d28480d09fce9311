"""Optimisation of studies."""
