"""The equation of motion, step by step: in energy over the crank angle, or in time."""
