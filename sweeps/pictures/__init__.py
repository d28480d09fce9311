"""Pictures of machines, sweeps and machine elements."""
