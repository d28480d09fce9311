"""Gears and cams: motion handed on by higher pairs."""
