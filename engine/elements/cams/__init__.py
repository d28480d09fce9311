"""Cams and followers as machine elements: motion, profile, forces, minimum base circle."""
