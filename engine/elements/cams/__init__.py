"""Cams and their followers as machine elements: motion, profile, forces, the least base circle."""
