"""Gear trains: fixed, planetary and differential; speeds, assembly, moments with losses, inertia."""
