"""Reactions of whole machines against the equations of Newton and Euler, solved densely, and against closed forms.

Tolerances: see `machines.compare`, the sensitivity of the reference itself to a rounding of the data.
"""

import math

import numpy as np
import pytest
from drawn_machines import geared_five_bar, quick_return, scotch_yoke, sliding_input
from loaded_machines import asked, loaded
from machines import chain, compare, moving, variants_of
from newton_euler import reactions
from press import actions, bodies, press

from engine import Machine, MovingMachine, Scene


def rows_of(scene: Scene, q: np.ndarray) -> dict[str, np.ndarray]:
    rows = reactions(scene, q)
    return rows | {f"input_moment_by_{way}": rows["input_moment"] for way in ("equilibrium", "power")}


def check(scene: dict, positions: int = 16, some: slice = slice(None)) -> None:
    machine = MovingMachine(Scene.model_validate(scene), positions=positions)
    found = machine.fields(asked(machine.scene))
    compare({field: row[some] for field, row in found.items()}, scene, lambda of: rows_of(of, machine.q[some]))


# Against Newton and Euler


@pytest.mark.parametrize(("seed", "dyads", "in_series"), [(0, 5, False), (4, 10, True)])
def test_random_chains_of_dyads__newton_euler(seed, dyads, in_series):
    check(loaded(chain(seed, dyads, in_series), seed))


@pytest.mark.parametrize("machine", [geared_five_bar(), sliding_input(), quick_return(0.01), scotch_yoke()])
def test_machines_of_all_kinds__newton_euler(machine):
    check(loaded(machine.model_dump(exclude_none=True), 7))


@pytest.mark.parametrize("machine", [geared_five_bar(), sliding_input()])
def test_reactions_without_inertia__are_those_of_the_machine_all_but_at_rest(machine):
    scene = loaded(machine.model_dump(exclude_none=True), 3)
    static = MovingMachine(Scene.model_validate(scene | {"inertia_in_reactions": False}), positions=16)
    found = static.fields(asked(static.scene))
    # Its loads don't depend on speed; inertia forces are 1e-16 of those at its own.
    slow = {**scene, "input": {**scene["input"], "speed": 1e-8 * scene["input"]["speed"]}}
    compare(found, slow, lambda of: rows_of(of, static.q))


# A press with every action, run both ways.
PRESS, BOTH_WAYS = press(bodies=bodies(), **actions()), {"input.speed": [7.0, -3.0]}


def test_press_with_every_action__newton_euler():
    fields = [*asked(Scene.model_validate(PRESS)), "drive.second.reaction_x", "drive.second.reaction_y"]
    fields += ["input_moment_by_power", "input_moment"]
    # The ends of the stroke come from cubics between positions, (h⁴/384) max|d⁗| [m]; a table's slope of 2000 N/m
    # makes a force of it, and reactions are at most some ten times a force on the ram.
    ends = (2 * math.pi / 360) ** 4 / 384 * 20 * 2000
    # Each of these lies well between the positions at which resistances change their sign.
    some = slice(5, None, 48)
    for variant in variants_of(PRESS, BOTH_WAYS):
        machine, rows = moving(variant, fields, 360)
        found, q = {field: row[some] for field, row in rows.items()}, machine.q[some]
        compare(found, variant, lambda of, q=q: rows_of(of, q), truncation=dict.fromkeys(found, 10 * ends))


def test_piston_in_a_slot__cylinder_is_borne_by_the_rocker():
    scene = loaded(quick_return().model_dump(exclude_none=True), 2)
    cylinder = {"type": "pump", "piston": "stone", "bore": 0.05, "suction": 9e4, "discharge": 4e5}
    check(scene | {"cylinders": {"pump": cylinder}}, 32, slice(1, None, 3))


# What is asked


def test_reactions_not_asked__not_in_the_kernel():
    scene = Scene.model_validate(press(bodies=bodies(), **actions()))
    machine = Machine(scene, ["reduced_inertia.max"], ["input_moment", "ram.slide"])
    assert not any(subject.startswith("pair ") for subject in machine.computed)
    assert machine.left_out["pair drive.second"] == ["reaction"]


def test_one_pair_of_the_last_group__leaves_out_earlier_groups():
    scene = Scene.model_validate(press(bodies=bodies()))
    machine = Machine(scene, fields=["drive.second.reaction"])
    assert machine.computed["pair drive.second"] == ["reaction"]
    assert not {f"pair {name}" for name in ("input", "bars.first", "bars.second", "bars.inner")} & set(machine.computed)
