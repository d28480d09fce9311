"""Steady running: found directly, the flywheel for it, and the results of its cycle."""
