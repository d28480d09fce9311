"""Counterweights that balance a machine best."""
