"""True motion of a machine: the equation of motion under its motors and loads, its regimes, its flywheel."""
