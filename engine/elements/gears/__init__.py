"""Gear trains: fixed, planetary and differential; speeds, assembly, torques with losses, inertia."""
