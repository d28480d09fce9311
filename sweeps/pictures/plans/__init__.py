"""Graphical analysis of a machine: velocity, acceleration and force polygons, free bodies, bearing loads.

`pose_at(scene, position)` gives the machine at a position; each plan is a function of it and of Matplotlib axes. Plans
have round scales that hold on paper, with the scale μ and a scale bar.
"""
