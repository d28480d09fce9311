"""What `sweeps flywheel` and `sweeps balance` tell."""
