"""Kinks of pair friction: where a slider changes the edge it bears on, or a rod from push to pull, against dense rows.

A slider-crank with friction in its guide alone. Between its kinks all curves are smooth, and rows know nothing of
panels: their mean gives works, and their extremes, looked at once more closely, those of the curves.
"""

import math

import numpy as np
import pytest
from machines import on, slider_crank

from engine import Machine, MovingMachine, Scene, Verdict
from engine.scene.scene import Numbers, scene_numbers

SPEED, LENGTH, ROWS, MANY = 30.0, 0.1, 2000, 200_000
CURVES = ["g.second.friction_force", "input_moment_with_friction"]
SUMMARIES = ["friction_loss", "g.second.friction_work", *(f"{field}.{s}" for field in CURVES for s in ("min", "max"))]
# Force on the ram, guide's offset, distance of the force's line from the ram's joint; pieces of a turn between kinks.
CASES = {
    "in line": (-900.0, 0.0, 0.0, 2),
    "guide off the axis": (-900.0, 0.03, 0.0, 5),
    "push and pull": (-40.0, 0.0, 0.0, 4),
    "push and pull, guide off the axis": (-40.0, -0.02, 0.0, 7),
    "tilted": (-900.0, 0.02, 0.01, 6),
    "tilted, push and pull": (-60.0, 0.01, 0.02, 11),
}


def rubbing_scene(force: float, offset: float, aside: float) -> Scene:
    scene = slider_crank(
        0.05,
        0.16,
        SPEED,
        bodies={"ram": {"link": "ram", "mass": 2.0}},
        forces={"load": {"type": "constant", "on": "K", "angle": 0.0, "force": force}},
        friction={"way": {"pair": "g.second", "coefficient": 0.2, **({"length": LENGTH} if aside else {})}},
    )
    scene["points"]["K"] = on("ram", 0.0, aside)
    scene["groups"]["g"]["second"]["offset"] = offset
    return Scene.model_validate(scene)


def extreme(scene: Scene, curve: str, sign: float) -> float:
    """Over all rows of a turn, then over as many between the neighbours of the best one, and so on."""
    for _ in range(4):
        machine = MovingMachine(scene, positions=ROWS)
        row = sign * machine.fields([curve])[curve]
        k = int(np.argmax(row))
        near = {"start": machine.q[max(k - 1, 0)], "stop": machine.q[min(k + 1, ROWS - 1)]}
        scene = scene.model_copy(update={"input": scene.input.model_copy(update=near)})
    return sign * row[k]


@pytest.mark.parametrize("name", CASES)
def test_friction__is_right_between_its_kinks_and_takes_few_panels(name):
    *numbers, pieces = CASES[name]
    scene = rubbing_scene(*numbers)
    machine = Machine(scene, SUMMARIES)
    outcome = machine.evaluate({})
    assert outcome.status[0] == Verdict.OK
    power = MovingMachine(scene, positions=MANY).fields(["g.second.friction_power"])["g.second.friction_power"]
    loss = power.mean() * 2 * math.pi / SPEED
    expected = [loss, loss, *(extreme(scene, curve, sign) for curve in CURVES for sign in (-1, 1))]
    sizes = [loss, loss, *[max(map(abs, expected[2:4]))] * 2, *[max(map(abs, expected[4:]))] * 2]
    for summary, value, size in zip(SUMMARIES, expected, sizes, strict=True):
        found, figure = outcome.summaries[summary][0], outcome.errors[summary][0]
        # A kink costs a mean (2π/MANY)²/8 of its change of slope.
        assert abs(found - value) <= figure + 5e-10 * size, (summary, found, value, figure)
        assert abs(found - value) <= 1e-9 * size
    # No panel is longer than a fifth of the turn, and beside kinks there are one or two more to each piece.
    panels = machine._measuring(machine._measuring.numbers(Numbers(scene_numbers(scene), {}), 1)).outcome.panels[0]
    assert panels <= 5 + 2 * pieces
