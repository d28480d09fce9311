"""Engines: cylinder layouts, shaking forces and torque by orders, balance shafts, firing."""
