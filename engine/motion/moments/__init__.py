"""Inertia and moments of many variants over the crank angle, with their jumps and bends."""
