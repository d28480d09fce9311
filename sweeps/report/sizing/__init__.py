"""Reports of `sweeps flywheel` and `sweeps balance`."""
