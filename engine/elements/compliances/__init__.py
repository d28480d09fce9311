"""Stiffness and damping of shafts, rods, beams, meshes and couplings, and of what they make up together."""
