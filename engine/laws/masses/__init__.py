"""Moments of inertia, inertia forces, replacement masses."""
