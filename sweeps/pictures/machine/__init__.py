"""Diagrams of one machine over its cycle or its regimes, and its animation."""
