"""Scenes of mechanisms that were found from what is wanted of them, as commented texts."""
