"""Plates on legs of every kind: bounds of the proof, and reactions against virtual power."""

import numpy as np
import pytest
from plan_machines import assert_in_equilibrium, assert_legs_meet, largest
from reaction_graphs import ReactionValues

from engine import Near, Scene, SceneError, assembly_modes
from engine.mechanism.assembly import Slide
from engine.mechanism.groups.closure_of_free import Direction
from engine.scene.structure.ordering import order
from sweeps.pictures.plans.polygons import accelerations, velocities
from sweeps.pictures.plans.pose import pose_at

EPS = np.finfo(float).eps
ROUNDINGS = 1000
# Where legs are joined to the plate, in its axes, and to the frame.
ON_PLATE = ((0.0, 0.0), (0.12, 0.0), (0.06, 0.08))
ON_FRAME = ((0.0, 0.0), (0.3, -0.1), (0.25, 0.3))
# Outer and inner pair of each leg, the first of which hangs on the crank: combinations that can be assembled, with legs
# of every kind in every place.
LEGS = [("RR", "RR", "PP"), ("RR", "RP", "RP"), ("RP", "PR", "PR"), ("RP", "PP", "RR")]


def plate_on(legs: tuple[str, ...]) -> dict:
    data = {
        "gravity": 9.81,
        "points": {"O": {"x": 0.0, "y": 0.0}, "M": {"link": "plate", "x": 0.05, "y": 0.03}},
        "guides": {},
        "input": {"type": "crank", "pivot": "O", "pin": "A", "length": 0.01, "speed": 10.0},
        "links": {"plate": {}},
        "bodies": {"plate_body": {"link": "plate", "mass": 2.0, "x": 0.05, "y": 0.03, "inertia": 0.02}},
    }
    for i, (kind, (u, v), (x, y)) in enumerate(zip(legs, ON_PLATE, ON_FRAME, strict=True)):
        leg, outer = f"leg{i}", f"P{i}" if i else "A"
        if kind[0] == "P":
            data["guides"][f"way{i}"] = {"x": x, "y": y, "angle": 0.4 + 1.3 * i}
            data["links"][leg] = {"guide": f"way{i}", "offset": 0.01}
        else:
            data["links"][leg] = {"joints": [outer]}
            if i:
                data["points"][outer] = {"x": x, "y": y}
        if kind[1] == "R":
            data["points"][f"J{i}"] = {"link": "plate", "x": u, "y": v}
            data["links"][leg]["joints"] = [*data["links"][leg].get("joints", ()), f"J{i}"]
            data["links"][leg] |= {"length": 0.2} if kind == "RR" else {}
        elif kind == "RP":
            data["guides"][f"slot{i}"] = {"link": "plate", "x": u, "y": v, "angle": 0.9 + i}
            data["links"][leg]["guide"] = f"slot{i}"
        else:
            data["guides"][f"rail{i}"] = {"link": leg, "x": 0.02, "y": 0.03, "angle": 1.1}
            data["links"]["plate"]["guide"] = f"rail{i}"
        data["bodies"][f"body{i}"] = {"link": leg, "mass": 1.0, "x": 0.03, "y": 0.02, "inertia": 0.01}
    return data


def in_best_mode(legs: tuple[str, ...]) -> Scene:
    scene = Scene.model_validate(plate_on(legs))
    (modes,) = assembly_modes(scene).values()
    best = max(modes, key=lambda mode: abs(mode.transmission))
    near = {name: Near(x=x, y=y) for name, (x, y) in best.points.items()}
    return scene.model_copy(update={"near": near})


@pytest.mark.parametrize("legs", LEGS)
def test_plate_on_legs_of_every_kind__is_in_equilibrium_and_its_proof_holds(legs):
    of, q = ReactionValues(in_best_mode(legs)), np.linspace(0.3, 6.0, 6)
    # Reactions, inertia forces and rates agree, or virtual power wouldn't.
    one, other = of(["input_moment_by_equilibrium", "input_moment_by_power"], q).values()
    assert one == pytest.approx(other, rel=0, abs=ROUNDINGS * EPS * np.abs(one).max())
    force, forces, moment, moments = of.values(list(of.reactions.checks.values()), q)
    assert (force < ROUNDINGS * EPS * forces).all()
    assert (np.abs(moment) < ROUNDINGS * EPS * moments).all()
    # What the proof takes for the greatest that a derivative can be is no less than the derivative.
    (motion,) = of.kinematics.free.values()
    closure, zero = motion.closure, of.graph.zero
    unknowns = [
        Slide(of.kinematics.slides[pair.link].d, zero, zero)
        if pair.kind == "prismatic"
        else Direction(motion.links[name].u, zero, zero)
        for name, pair in closure.cutting.placed
    ]
    first, _ = closure.bounds(unknowns, motion.linearised.misses, zero)
    for k, unit in enumerate(motion.linearised.units):
        for row, miss in zip(first, closure.misses(unit), strict=True):
            bound, derivative = of.values([row[k], miss.v], q)
            assert (np.abs(derivative) <= bound * (1.0 + ROUNDINGS * EPS)).all()


def test_group_without_a_point__is_told_to_have_one():
    data = plate_on(("RP", "RP", "RP"))
    del data["points"]["M"]
    with pytest.raises(SceneError, match=r"2 assembly modes .* no point to select one: give them points\.NAME"):
        ReactionValues(data)(["leg0.A.reaction"], np.zeros(1))


def test_loop_of_sliding_pairs__is_refused():
    data = plate_on(("RR", "RR", "RR"))
    data["guides"] = {f"on_{n}": {"link": n, "angle": 0.5 + i} for i, n in enumerate("abc")}
    data["points"] = {"O": {"x": 0.0, "y": 0.0}, "P": {"x": 0.4, "y": 0.0}, "J": {"link": "b", "x": 0.1, "y": 0.0}}
    data["links"] = {
        "a": {"joints": ["A"], "guide": "on_b"},
        "b": {"guide": "on_c"},
        "c": {"guide": "on_a"},
        "bar": {"joints": ["P", "J"], "length": 0.3},
    }
    with pytest.raises(SceneError, match=r"a loop of sliding pairs only, closed by c\.on_a"):
        order(Scene.model_validate(data | {"bodies": {}}))


def test_leg_of_two_sliding_pairs__has_its_place_in_plans():
    """It has no joint: its plans go by its own origin, and close; it is in equilibrium under its loads."""
    pose = pose_at(in_best_mode(("RP", "PP", "RR")), 2.2)
    for plan in (velocities(pose), accelerations(pose)):
        (name,) = plan.places
        assert_legs_meet(plan, 100 * EPS)
        # The leg slides along a guide of the frame, as that lies.
        assert abs((plan.images[name].conjugate() * pose.guide("way1")).imag) < 100 * EPS * largest(plan)
    assert_in_equilibrium(pose, 100 * EPS)
