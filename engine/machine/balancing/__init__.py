"""Optimal counterweights of a machine."""
