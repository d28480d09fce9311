"""Motions that have a closed form."""
