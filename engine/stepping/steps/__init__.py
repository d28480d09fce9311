"""One step of a walk: its stages, errors, edges and guards, in lanes."""
