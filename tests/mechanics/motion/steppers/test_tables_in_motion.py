"""Motion under tables of many rows, against SciPy, row after row: steps end at rows, however smoothly these are joined.

Between rows SciPy's DOP853 is asked for 1e-12 of the energy; δ is a share of about a hundredth of it.
"""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from engine import Machine, Scene, Verdict

INERTIA, STALL, NO_LOAD = 0.5, 400.0, 12.0
ROWS = 48
ANGLES = 2 * math.pi * np.arange(ROWS) / ROWS
MOMENTS = -80.0 + 60.0 * np.sin(ANGLES) + 40.0 * np.random.default_rng(5).random(ROWS)


def scene(interpolation):
    table = {"type": "table", "on": "crank", "over_angle": list(ANGLES), "moment": list(MOMENTS)}
    return Scene.model_validate(
        {
            "points": {"O": {"x": 0.0, "y": 0.0}},
            "input": {"type": "crank", "pivot": "O", "pin": "A", "length": 0.1, "speed": 10.0},
            "bodies": {"wheel": {"link": "crank", "mass": 1.0, "inertia": INERTIA}},
            "moments": {
                "load": table | {"interpolation": interpolation},
                "motor": {"type": "dc_motor", "on": "crank", "no_load_speed": NO_LOAD, "stall_moment": STALL},
            },
            "regimes": {"on": {"type": "steady"}, "go": {"type": "run", "from_speed": 9.0, "cycles": 2.0}},
        }
    )


def by_rows(interpolation, energy, cycles):
    """Energy and time after so many cycles, least and greatest speed."""
    closed = np.append(ANGLES, 2 * math.pi), np.append(MOMENTS, MOMENTS[0])
    table = CubicSpline(*closed, bc_type="periodic") if interpolation == "spline" else lambda x: np.interp(x, *closed)

    def speed(e):
        return math.sqrt(2.0 * e / INERTIA)

    def rates(x, state):
        omega = speed(state[0])
        return [table(x) + STALL * (1.0 - omega / NO_LOAD), 1.0 / omega]

    state, seen = [energy, 0.0], [energy]
    for _ in range(cycles):
        for begin, end in zip(*(np.append(ANGLES, 2 * math.pi)[i : ROWS + i] for i in (0, 1)), strict=True):
            found = solve_ivp(
                rates, (begin, end), state, "DOP853", rtol=1e-12, atol=1e-14, events=lambda x, s: rates(x, s)[0]
            )
            state = found.y[:, -1]
            seen += [state[0], *(s[0] for s in found.y_events[0])]
    return *state, speed(min(seen)), speed(max(seen))


@pytest.mark.parametrize("interpolation", ["linear", "spline"])
def test_table_of_many_rows__steady_and_in_a_run(interpolation):
    names = ["on.speed_min", "on.speed_max", "on.speed_fluctuation", "on.period", "go.final_speed", "go.time"]
    outcome = Machine(scene(interpolation), names).evaluate({})
    assert outcome.status == [Verdict.OK]
    settled = brentq(lambda e: by_rows(interpolation, e, 1)[0] - e, 10.0, 36.0, xtol=1e-12, rtol=1e-14)
    _, period, least, greatest = by_rows(interpolation, settled, 1)
    energy, time, *_ = by_rows(interpolation, 0.5 * INERTIA * 81.0, 2)
    delta = 2.0 * (greatest - least) / (greatest + least)
    expected = least, greatest, delta, period, math.sqrt(2.0 * energy / INERTIA), time
    for name, value in zip(names, expected, strict=True):
        error, figure = abs(outcome.summaries[name][0] - value), outcome.errors[name][0]
        assert error <= figure + 1e-11 * value / delta
        assert figure < 1e-6 * value
