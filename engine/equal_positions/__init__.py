"""Curves at equally spaced positions: sums, extremes, strokes, flywheels."""
