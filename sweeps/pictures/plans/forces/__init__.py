"""What acts on the links of a machine at a position, and its plans: loads, force polygons, free bodies."""
