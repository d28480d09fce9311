"""Machine elements, evaluated together with a machine or alone."""
