"""Inertia and torques of many variants over the crank angle, with their jumps and kinks."""
