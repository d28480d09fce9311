"""Deviations from wanted motions, in closed form, and a linkage that is found again by its path."""

import math

import numpy as np
import pytest
from each_case import refusals
from hypothesis import given, settings
from hypothesis import strategies as st
from machines import crank, frame, rpp, rrp

from engine import Machine, Scene, Verdict
from engine.scene.structure.ordering import order

R = 0.05
TOLD = ("deviation_rms", "deviation_max")


def machine(wanted, **parts):
    """A crank of 50 mm with a Scotch yoke."""
    return Scene.model_validate(
        {
            "points": {"O": frame(0.0, 0.0)},
            "guides": {"way": {}},
            "input": crank(length=R),
            "groups": {"yoke": rpp(("block", "A"), ("ram", "way"), math.pi / 2)},
            "wanted": {"it": wanted},
        }
        | parts
    )


def deviations(scene):
    """Both deviations, and what they may be off by."""
    outcome = Machine(scene, [f"it.{name}" for name in TOLD]).evaluate({})
    assert outcome.status[0] == Verdict.OK
    return [[float(row[0]) for row in found.values()] for found in (outcome.summaries, outcome.errors)]


def assert_told(found, expected):
    values, errors = found
    for value, error, due in zip(values, errors, expected, strict=True):
        assert abs(value - due) <= error + 1e-15
        assert error < 1e-7


COORDINATE = st.floats(-0.2, 0.2)


@settings(max_examples=15)
@given(st.lists(st.tuples(COORDINATE, COORDINATE), min_size=3, max_size=3))
def test_places_off_a_circle__are_as_far_as_their_radii_say(places):
    x, y = zip(*places, strict=True)
    apart = np.abs(np.hypot(x, y) - R)
    found = deviations(machine({"type": "path", "point": "A", "x": list(x), "y": list(y)}))
    assert_told(found, (np.sqrt(np.mean(apart**2)), apart.max()))


def test_places_on_an_exact_straight_line__are_met_and_others_missed_by_their_distance():
    # Scott Russell: crank and rod of one length; the rod's end beyond the pin stays on the line through the bearing.
    def scene(x):
        wanted = {"type": "path", "point": "P", "x": x, "y": [0.04, 0.06, 0.08]}
        parts = {
            "points": {"O": frame(0.0, 0.0), "P": {"link": "rod", "x": -R, "y": 0.0}},
            "input": crank(length=R, start=0.3, stop=1.2),
            "groups": {"drive": rrp("B", ("rod", "A", R), "block", "way")},
        }
        return machine(wanted, **parts)

    met, _ = found = deviations(scene([0.0, 0.0, 0.0]))
    # The square of a distance is known to rounding, 1e-16 of the machine's, the distance to the root of that.
    assert max(met) < 1e-8
    assert_told(found, (0.0, 0.0))
    assert_told(deviations(scene([0.003, -0.004, 0.0])), (math.sqrt(25e-6 / 3), 0.004))


def test_slide_of_a_yoke_against_a_straight_line__by_the_integral_of_their_difference():
    # The yoke's slide is −r sin φ or r cos φ as the guide lies; from 0 to 90 deg the wanted one falls evenly.
    wanted = {
        "type": "slider",
        "of": "ram",
        "over_angle": [0.0, math.pi / 2],
        "slide": [R, 0.0],
        "interpolation": "linear",
    }
    # cos φ − (1 − 2φ/π) is greatest where sin φ = 2/π; the integral of its square over the quarter is elementary.
    greatest = math.asin(2 / math.pi)
    most = math.cos(greatest) - 1 + 2 * greatest / math.pi
    square = math.pi / 4 + math.pi / 6 - 2 * (2 / math.pi)
    assert_told(deviations(machine(wanted)), (R * math.sqrt(square / (math.pi / 2)), R * most))


@pytest.mark.parametrize("offset", [0.0, 0.25, -1.0])
def test_angle_of_the_crank_against_an_even_turn__is_their_difference(offset):
    rows = {"over_angle": [1.0, 2.0, 4.0], "angle": [1.0, 1.5, 2.5], "interpolation": "linear"}
    scene = machine({"type": "link", "of": "crank", **rows, "offset": offset})
    # φ − (½ + φ/2) − offset rises evenly from −offset to 1.5 − offset over 1 to 4 rad.
    first, last = -offset, 1.5 - offset
    rms = math.sqrt((first**2 + first * last + last**2) / 3)
    assert_told(deviations(scene), (rms, max(abs(first), abs(last))))


def test_spline_through_rows_that_the_motion_passes__deviates_by_the_splines_error():
    angles = np.linspace(0.0, math.pi, 33)
    wanted = {"type": "slider", "of": "ram", "over_angle": angles.tolist(), "slide": (R * np.cos(angles)).tolist()}
    values, _ = deviations(machine(wanted))
    # A natural spline's curvature is zero at the ends, where the cosine's is not: h² r/(9 √3) there at most.
    assert 0 < values[1] < (math.pi / 32) ** 2 * R / 15


PATH = {"type": "path", "point": "A", "x": [1e-3], "y": [1e-3]}
TURN = {"type": "link", "of": "crank", "over_angle": ["0 deg", "1 deg"], "angle": ["0 deg", "1 deg"]}
SLIDE = {"type": "slider", "of": "ram", "over_angle": ["0 deg", "1 deg"], "slide": ["0 mm", "1 mm"]}


test_wanted_motion_that_is_none__is_refused = refusals(
    lambda wanted: order(machine(wanted)),
    (PATH | {"point": "Q"}, "wanted.it.point: 'Q'"),
    (PATH | {"point": "O"}, "wanted.it.point: 'O' is at rest on the frame; known are: A"),
    (PATH | {"x": [1e-3, 2e-3]}, "wanted.it: x has 2 rows, y has 1"),
    (PATH | {"x": [], "y": []}, "wanted.it: x has 0 rows; give 1 to 100 points"),
    (SLIDE | {"of": "crank"}, "wanted.it.of: 'crank' doesn't slide"),
    (TURN | {"of": "frame"}, "wanted.it.of: 'frame' doesn't move"),
    (TURN | {"angle": ["0 mm", "1 mm"]}, "wanted.it.angle … angle"),
    (TURN | {"over_angle": ["1 deg", "0 deg"]}, "wanted.it: … sort the rows"),
    (
        TURN | {"over_angle": [0, "401 deg"]},
        "wanted.it.over_angle: … 401 deg isn't within the range of the crank, 0 deg",
    ),
    ({"type": "force"}, "wanted.it: … path"),
)


def test_asked_of_a_sliding_input__is_refused():
    sliding = {"type": "slider", "link": "bar", "guide": "way", "point": "A", "speed": 0.1, "start": 0.0, "stop": 0.1}
    wanted = {"type": "slider", "of": "ram", "over_angle": [0.0, 1.0], "slide": [0.0, 1.0]}
    with pytest.raises(Exception, match="a sliding input has no crank angle"):
        Machine(machine(wanted, input=sliding), [])
