"""Elements evaluated beside a machine, or alone."""
