"""Panels: the stretches that a cycle is divided into, series of curves on them, and what is kept of these."""
