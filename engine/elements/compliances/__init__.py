"""Stiffness and damping of shafts, rods, beams, meshes and couplings, and of their combinations."""
