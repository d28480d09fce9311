"""Diagrams of one machine over its cycle or regimes, and its animation."""
