"""The scene: parts, names and structural order of a machine."""
