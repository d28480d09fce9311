"""Plans of a machine as an engineer draws them: velocities, accelerations, forces, free bodies, bearing loads.

`MachineCycle(scene).at(position)` gives the machine at a position; each plan is a function of it and of axes of
matplotlib. Plans are drawn to round scales that hold on paper, with the scale μ and a bar.
"""

from sweeps.plans.bearing_loads import bearing_load, bearing_sheet, least_loaded, load_polar, load_rose, shares
from sweeps.plans.files import plan_pictures, reaction_pictures
from sweeps.plans.force_plan import force_plan, polygon
from sweeps.plans.free_body import free_body
from sweeps.plans.kinematic_plans import acceleration_plan, velocity_plan
from sweeps.plans.loads import Load, group_loads, loads_on_links
from sweeps.plans.mechanism_plan import mechanism_plan
from sweeps.plans.polygons import Leg, Plan, Step, accelerations, velocities
from sweeps.plans.pose import MachineCycle, Pose
from sweeps.plans.reaction_curves import reaction_panel, reaction_sheet
from sweeps.plans.sheets import force_sheet, kinematic_sheet

__all__ = [
    "Leg",
    "Load",
    "MachineCycle",
    "Plan",
    "Pose",
    "Step",
    "acceleration_plan",
    "accelerations",
    "bearing_load",
    "bearing_sheet",
    "force_plan",
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
    "polygon",
    "reaction_panel",
    "reaction_pictures",
    "reaction_sheet",
    "shares",
    "velocities",
    "velocity_plan",
]
