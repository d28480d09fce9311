"""Error figures where the change from half the positions says too little: jumps, dead centres."""

import math

import numpy as np
import pytest
from engine.equal_positions.rows_machine import RowsMachine as Machine
from engine.equal_positions.strokes import cubic_doubt, stroke_ends
from hypothesis import given, settings
from hypothesis import strategies as st

from engine import Scene

few = settings(deadline=None, max_examples=60)


def angles(n):
    return 2 * math.pi * np.arange(n) / n


@few
@given(st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6), st.sampled_from([24, 48, 96]), st.floats(0.0, 6.2))
def test_cubic_doubt__bounds_the_error_of_dead_centres(parts, n, first):
    # Harmonics that fall off, so that there is one top; the fourth derivative is a difference over three steps.
    def wave(phi):
        d, v, a = np.cos(phi), -np.sin(phi), -np.cos(phi)
        for m, (c, s) in enumerate(zip(parts[:3], parts[3:], strict=True), start=2):
            c, s = 0.3 * c / m**3, 0.3 * s / m**3
            d = d + c * np.cos(m * phi) + s * np.sin(m * phi)
            v = v + m * (s * np.cos(m * phi) - c * np.sin(m * phi))
            a = a - m * m * (c * np.cos(m * phi) + s * np.sin(m * phi))
        return d, v, a

    phi, h = first + angles(n), 2 * math.pi / n
    d, v, _ = wave(phi)
    _, high, _, at = stroke_ends(d, v, first, h, True)
    true = at
    for _ in range(5):
        _, slope, bend = wave(true)
        true = true - slope / bend
    value, place = cubic_doubt(v, first, h, at, 1e-15, True)
    # Of the bound's second derivative at the ends of the step, a tenth may be missing at 24 positions.
    assert abs(high - wave(true)[0]) <= 1.2 * value + 1e-15
    assert abs(at - true) <= 1.2 * place + 1e-15


def machine(summaries, positions, moments=None):
    scene = Scene.model_validate(
        {
            "points": {"O": {"x": 0, "y": 0}},
            "guides": {"way": {}},
            "input": {"type": "crank", "pivot": "O", "pin": "A", "length": 0.05, "speed": 1.0},
            "groups": {
                "g": {
                    "type": "RRP",
                    "inner": "B",
                    "first": {"link": "rod", "joint": "A", "length": 0.06},
                    "second": {"link": "ram", "guide": "way"},
                }
            },
            "moments": moments or {},
        }
    )
    outcome = Machine(scene, summaries, positions=positions).evaluate({})
    return [(outcome.summaries[name][0], outcome.errors[name][0]) for name in summaries]


@pytest.mark.parametrize("positions", [46, 50, 54, 90, 358])
def test_transmission_angle__is_within_its_figure_between_positions(positions):
    # The least angle, acos(r/l) at φ = 90°, lies in the middle of a step, also of a step of half the positions.
    [(angle, figure)] = machine(["g.transmission_angle"], positions)
    assert 0.0 < angle - math.acos(5 / 6) <= figure


@pytest.mark.parametrize("positions", range(40, 80, 2))
def test_rms__of_a_high_pulse_is_within_its_figure(positions):
    begin, end, high = 1.0, 1.3, 100.0
    pulse = {"type": "table", "on": "crank", "interpolation": "linear"}
    pulse |= {"over_angle": [0.0, begin, begin, end, end], "moment": [1.0, 1.0, high, high, 1.0]}
    [(rms, figure)] = machine(["reduced_moment.rms"], positions, {"pulse": pulse})
    true = math.sqrt((high**2 * (end - begin) + 2 * math.pi - (end - begin)) / (2 * math.pi))
    assert abs(rms - true) <= figure
