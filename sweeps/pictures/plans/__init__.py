"""Graphical analysis of a machine: velocity, acceleration and force polygons, free bodies, bearing loads.

`MachineCycle(scene).at(position)` gives the machine at a position; each plan is a function of it and of Matplotlib
axes. Plans have round scales that hold on paper, with the scale μ and a scale bar.
"""

from sweeps.pictures.plans.bearing_loads import bearing_load, bearing_sheet, least_loaded, load_polar, load_rose, shares
from sweeps.pictures.plans.files import bearing_pictures, plan_pictures, reaction_pictures
from sweeps.pictures.plans.forces.force_plan import force_plan, force_polygon
from sweeps.pictures.plans.forces.free_body import free_body
from sweeps.pictures.plans.forces.loads import DrawnLoad, group_loads, loads_on_links
from sweeps.pictures.plans.kinematic_plans import acceleration_plan, velocity_plan
from sweeps.pictures.plans.mechanism_plan import mechanism_plan
from sweeps.pictures.plans.polygons import Leg, PlanStep, VectorPlan, accelerations, velocities
from sweeps.pictures.plans.pose import MachineCycle, Pose
from sweeps.pictures.plans.reaction_curves import reaction_panel, reaction_sheet
from sweeps.pictures.plans.sheets import force_sheet, kinematic_sheet

__all__ = [
    "DrawnLoad",
    "Leg",
    "MachineCycle",
    "PlanStep",
    "Pose",
    "VectorPlan",
    "acceleration_plan",
    "accelerations",
    "bearing_load",
    "bearing_pictures",
    "bearing_sheet",
    "force_plan",
    "force_polygon",
    "force_sheet",
    "free_body",
    "group_loads",
    "kinematic_sheet",
    "least_loaded",
    "load_polar",
    "load_rose",
    "loads_on_links",
    "mechanism_plan",
    "plan_pictures",
    "reaction_panel",
    "reaction_pictures",
    "reaction_sheet",
    "shares",
    "velocities",
    "velocity_plan",
]
