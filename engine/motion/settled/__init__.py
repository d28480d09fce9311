"""Steady motion: found directly, the flywheel for it, and what is asked of its cycle."""
