"""Kernels over equally spaced positions, written as text."""
