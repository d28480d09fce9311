"""What a machine is: its parts, units, names, and their structural order."""
