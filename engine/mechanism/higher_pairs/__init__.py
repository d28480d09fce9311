"""Higher pairs inside a mechanism: cams that drive links of it."""
