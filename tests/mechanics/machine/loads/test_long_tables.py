"""Tables of loads are memory: more rows print no other code, take no more numbers, and change no result."""

import math

import numpy as np
import pytest
from machines import slider_crank

from engine import Machine, Scene, Verdict

ASKED = ["required_power", "flywheel_wittenbauer", "input_moment.peak"]
STROKE = 0.1
PLACES = {
    "over the angle": ({}, "over_angle", 2 * math.pi),
    "from the guide": ({"slider": "piston", "measured_from": "guide"}, "over_stroke", STROKE),
    "from the low end": ({"slider": "piston", "measured_from": "low end"}, "over_stroke", STROKE),
    "from the high end": ({"slider": "piston", "measured_from": "high end"}, "over_stroke", STROKE),
}


def machine_with(place, rows, interpolation="linear"):
    """A slider-crank with a table of straight lines between twenty rows, further rows on these lines."""
    keys, axis, length = PLACES[place]
    corners = np.linspace(0.0, length, 21)
    values = 1000.0 * (1.0 + np.sin(3.0 * corners / length * 2 * math.pi))
    begin = 0.15 if place == "from the guide" else 0.0
    x = np.linspace(0.0, length, 20 * rows + 1)
    table = {axis: (begin + x).tolist(), "force": np.interp(x, corners, values).tolist()}
    load = {"type": "table", "on": "B", "angle": math.pi, "interpolation": interpolation} | keys | table
    scene = slider_crank(
        speed=30.0,
        slider="piston",
        bodies={"piston_body": {"link": "piston", "mass": 2.0}},
        forces={"load": load},
        flywheel={"speed_fluctuation": 0.02},
    )
    return Machine(Scene.model_validate(scene), ASKED, varied=["input.length"])


@pytest.mark.parametrize("interpolation", ["linear", "pchip", "spline"])
@pytest.mark.parametrize("place", PLACES)
def test_rows_of_a_table__are_no_code_and_no_numbers(place, interpolation):
    short, long = machine_with(place, 1, interpolation), machine_with(place, 50, interpolation)
    assert long.source() == short.source()
    assert long.numbers_kept == short.numbers_kept


@pytest.mark.parametrize("place", PLACES)
def test_rows_on_the_lines_of_a_table__change_no_result(place):
    lengths = {"input.length": np.array([0.045, STROKE / 2])}
    short, long = (machine_with(place, rows).evaluate(lengths) for rows in (1, 10))
    assert (long.status == Verdict.OK).all()
    for name in ASKED:
        apart = np.abs(long.summaries[name] - short.summaries[name])
        # Values between the corners are rounded.
        rounding = 1e-13 * np.abs(short.summaries[name])
        assert (apart <= long.errors[name] + short.errors[name] + rounding).all(), name
