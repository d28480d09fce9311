"""Worked problems with printed answers, from textbooks; the tolerance is half a unit of the last printed digit.

Khurmi: R. S. Khurmi and J. K. Gupta, Theory of Machines; inputs and answers as in the public notebooks of its
examples (FOSSEE Textbook Companions, "Theory Of Machines", chapters 5 and 16). Where a problem gives its diagram as
a figure, areas and shapes are those that reproduce the energies printed there.
Norton: R. L. Norton, Design of Machinery. Meriam: J. L. Meriam and L. G. Kraige, Engineering Mechanics: Dynamics.
"""

import math

import numpy as np
import pytest
from machines import crank, frame, on, rpr, rrp

from engine import Machine, Scene
from engine.cycle.turning_moment import fluctuation, turning_moment_from_areas, turning_moment_from_table

DEGREE = math.pi / 180


def rpm(n):
    return n * math.pi / 30


# Flywheels by areas


@pytest.mark.parametrize(
    ("areas", "energy", "speed", "delta", "inertia"),
    [
        # Khurmi 16.4: 36 kg at 0.15 m, 5 N·m and 1° a mm; printed δ = 0.3 %.
        ([295, -685, 40, -340, 960, -270], 5 * DEGREE, 1800, (0.003, 5e-4), 36 * 0.15**2),
        # Khurmi 16.1: 6500 kg at 1.8 m and 56 kJ; printed 121 and 119 rpm, δ = 2/120.
        ([1, -1], 56e3, 120, (2 / 120, 1 / 120), 6500 * 1.8**2),
    ],
    ids=["Khurmi 16.4", "Khurmi 16.1"],
)
def test_fluctuation_by_areas__is_the_printed_one(areas, energy, speed, delta, inertia):
    found = turning_moment_from_areas(areas, energy, rpm(speed), 0.02)
    printed, tolerance = delta
    assert fluctuation(found.excess_work, inertia, rpm(speed)) == pytest.approx(printed, abs=tolerance)


@pytest.mark.parametrize(
    ("areas", "energy", "speed", "delta", "printed", "tolerance"),
    [
        # Khurmi 16.5: 600 N·m and 3° a mm, radius 0.5 m; printed 183 kg (182 where it is cut off).
        ([52, -124, 92, -140, 85, -72, 107], 600 * 3 * DEGREE, 600, 0.03, 0.25 * 182.5, 0.25),
        # Khurmi 16.16: 250 N·m and 3° a mm; printed 32.7 kg·m².
        ([160, -172, 168, -191, 197, -162], 250 * 3 * DEGREE, 600, 0.02, 32.7, 0.05),
        # Khurmi 16.3: coefficient of fluctuation of energy 0.1 of 300 kW at 90 rpm, radius 2 m; printed 5628 kg.
        ([1, -1], 0.1 * 300e3 * 60 / 90, 90, 0.01, 4 * 5628, 4),
    ],
    ids=["Khurmi 16.5", "Khurmi 16.16", "Khurmi 16.3"],
)
def test_flywheel_by_areas__is_the_printed_one(areas, energy, speed, delta, printed, tolerance):
    found = turning_moment_from_areas(areas, energy, rpm(speed), delta)
    assert found.flywheel_inertia == pytest.approx(printed, abs=tolerance)


# Flywheels by straight lines


def test_khurmi_16_9__four_strokes_as_triangles():
    # 20 kW at 300 rpm, expansion three times the compression's work; printed 255.4 kg·m² for ±2 %.
    cycle = 20e3 * 60 / 150
    power, compression = 2 * 1.5 * cycle / math.pi, 2 * 0.5 * cycle / math.pi
    phi = np.array([0, 90, 180, 540, 630, 720]) * DEGREE
    found = turning_moment_from_table(phi, [0, power, 0, 0, -compression, 0], rpm(300), 0.04)
    assert found.mean_moment * rpm(300) == pytest.approx(20e3, rel=1e-12)
    assert found.flywheel_inertia == pytest.approx(255.4, abs=0.05)


# Flywheels of scenes: a crank with an engine's and a load's moment over its angle


def driven(engine, load, speed, wheel):
    """A crank with two moments as splines over its angle, by 2° from 0 to 360°."""
    phi = np.linspace(0, 360, 181)

    def table(moment, role):
        values = (moment(phi * DEGREE) * np.ones(181)).tolist()
        return {"type": "table", "on": "crank", "over_angle": [f"{a} deg" for a in phi], "moment": values,
                "interpolation": "spline", "role": role}  # fmt: skip

    return Scene.model_validate(
        {
            "points": {"O": frame(0.0, 0.0)},
            "input": crank(speed=f"{speed} rpm"),
            "moments": {"engine": table(engine, "driving"), "load": table(load, "useful")},
            "flywheel": wheel,
        }
    )


def solve(scene, *asked):
    outcome = Machine(scene, asked, positions=3600).evaluate({})
    assert outcome.status[0] == 0
    return [outcome.summaries[name][0] for name in asked]


def test_khurmi_16_11__engine_by_harmonics():
    # T = 20 000 + 9500 sin 2θ − 5700 cos 2θ at 180 rpm; printed 377 kW, 11 078 J (cut off from 11 078.8), and
    # 3121 kg·m² for ±0.5 %, after rounding δω² from 3.553 to 3.55.
    scene = driven(lambda t: 20_000 + 9500 * np.sin(2 * t) - 5700 * np.cos(2 * t), lambda t: 0, 180,
                  {"speed_fluctuation": 0.01})  # fmt: skip
    power, excess, wheel = solve(scene, "required_power", "excess_work", "flywheel_wittenbauer")
    assert -power == pytest.approx(377e3, abs=500)
    assert excess == pytest.approx(11_078.8, abs=0.5)
    assert wheel == pytest.approx(3121 * 3.55 / (0.01 * rpm(180) ** 2), abs=1)


def test_khurmi_16_12__engine_against_a_varying_load():
    # T = 5000 + 600 sin 2θ against 5000 + 500 sin θ, 500 kg at 0.4 m, 150 rpm; printed 1204 J and δ = 6.1 %.
    scene = driven(lambda t: 5000 + 600 * np.sin(2 * t), lambda t: -5000 - 500 * np.sin(t), 150,
                  {"inertia": 500 * 0.16})  # fmt: skip
    excess, delta, useful = solve(scene, "excess_work", "speed_fluctuation", "mean_useful_moment")
    assert excess == pytest.approx(1204, abs=0.5)
    assert delta == pytest.approx(0.061, abs=5e-4)
    assert useful == pytest.approx(5000, rel=1e-9)


# Quick returns


def slotted_lever(distance, radius, lever=0.45):
    """A crank at O drives a slotted lever pivoted below it; P is the lever's end."""
    return Scene.model_validate(
        {
            "points": {"O": frame(0.0, 0.0), "C": frame(0.0, -distance), "P": on("lever", lever, 0.0)},
            "guides": {"way": {"y": -distance}},
            "input": crank(length=radius, speed=1.0),
            "groups": {
                "g": rpr(("block", "A"), ("lever", "C")),
                "out": rrp("B", ("rod", "P", 4 * lever), "ram", "way"),
            },
        }
    )


@pytest.mark.parametrize(
    ("distance", "radius", "ratio", "tolerance"),
    [(0.3, 0.12, 1.7, 0.05), (0.24, 0.12, 2, 1e-5), (0.3, 0.15, 2, 1e-5), (0.0757, 0.03, 1.7, 2e-3)],
    ids=["Khurmi 5.1", "Khurmi 5.2", "Sarkar 1.2", "Khurmi 5.3"],
)
def test_slotted_lever__has_the_printed_time_ratio(distance, radius, ratio, tolerance):
    assert solve(slotted_lever(distance, radius), "lever.swing_time_ratio") == [pytest.approx(ratio, abs=tolerance)]


def test_whitworth_khurmi_5_4__has_the_printed_time_ratio():
    # Centres 50 mm, driving crank 75 mm, the slotted link's pivot on the line of stroke; printed 2.735.
    scene = slotted_lever(0.05, 0.075, 0.04)
    found, turning = solve(scene, "ram.stroke_time_ratio", "lever.angle.range")
    assert found == pytest.approx(2.735, abs=5e-4)
    assert turning == pytest.approx(2 * math.pi, abs=0.01)
