"""Help on quantities and keys."""
