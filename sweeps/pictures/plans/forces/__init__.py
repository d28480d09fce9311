"""Forces on the links of a machine at a position: loads, force polygons, free bodies."""
