"""Engines: layouts, orders of shaking and torque, balance shafts, firing."""
