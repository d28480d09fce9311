"""Error figures of elements: against a change of every number, one by one, and against more digits."""

import math

import numpy as np
import pytest
from element_samples import BELT, EVERY, element
from engine_samples import EPS
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from engine import ElementsAlone, Scene

NUDGE = 2.0**-26
some = settings(max_examples=8)
places, angles = st.floats(-2.0, 2.0), st.floats(-7.0, 7.0)


def figures(element):
    """Results, their error estimates, and what one rounding of every number moves them by, added up."""
    it = Scene.model_validate({"elements": {"it": element}}).elements["it"]
    names = [r.name for r in it.results if not r.exact]
    outcome = ElementsAlone(Scene(elements={"it": it}), [f"it.{n}" for n in names]).evaluate({})
    decided = [r.name for r in it.results if r.exact]
    turning = np.array([name.endswith(".angle") for name in names])

    def found(numbers, wanted):
        values = it.evaluate(numbers).values
        return np.array([values[name][0] for name in wanted])

    given = it.own_numbers()
    before, moved, choices = found(given, names), np.zeros(len(names)), found(given, decided)
    for key, number in given.items():
        greater = given | {key: number * (1 + NUDGE)}
        if not np.array_equal(found(greater, decided), choices, equal_nan=True):
            # Two ways to fill the holes are as good as each other.
            continue
        change = np.abs(found(greater, names) - before)
        # An angle that a little would carry round begins again at 0.
        change[turning] = np.minimum(change, math.tau - change)[turning]
        moved += change * EPS / NUDGE
    errors = np.array([outcome.errors[f"it.{n}"][0] for n in names])
    return dict(zip(names, np.stack([before, errors, moved], axis=1).tolist(), strict=True))


@st.composite
def rotors(draw):
    unbalances = {
        name: {"mass": draw(st.floats(0.01, 1)), "radius": 0.3, "angle": draw(angles), "position": draw(places)}
        for name in draw(st.sampled_from(["a", "ab", "abcd"]))
    }
    holes = draw(st.sampled_from([{}, {"holes": 8, "piece": 0.03, "first_hole": draw(angles)}]))
    first = draw(places)
    planes = {
        name: {"position": first + k * draw(st.floats(0.1, 1)), "radius": 0.2 + 0.1 * k, "angle_error": 0.1, **holes}
        for k, name in enumerate(draw(st.sampled_from(["l", "lr", "lmr"])))
    }
    bearing, centre = draw(places), draw(places)
    other = bearing + draw(st.floats(0.1, 2)) * draw(st.sampled_from([1, -1]))
    # Over a bearing, the standard's shares leap from those of a rotor between them to those of an overhung one.
    assume(min(abs(centre - bearing), abs(centre - other)) > 1e-6)
    return {
        "type": "rotor",
        "mass": 100.0,
        "speed": draw(st.floats(10, 1000)),
        "centre": centre,
        "first_bearing": bearing,
        "second_bearing": other,
        "unbalances": unbalances,
        "planes": planes,
        "rolling_arm": 1e-5,
    }


# A change of a number by 2⁻²⁶ of it is itself found but to 2⁻²⁶ by the difference: 4 EPS/NUDGE · 2⁻⁵² of the result's
# size, which the figures' own room covers.
TURNED_MOMENT = {
    "type": "rotor",
    "mass": 100.0,
    "speed": 10.0,
    "centre": 0.0,
    "first_bearing": 1.0,
    "second_bearing": 2.0,
    "unbalances": {
        "a": {"mass": 0.3125, "radius": 0.3, "angle": 5.75, "position": 0.0},
        "b": {"mass": 0.25, "radius": 0.3, "angle": 2.0, "position": 1.0},
    },
    "planes": {"l": {"position": 0.0, "radius": 0.2, "angle_error": 0.1}},
    "rolling_arm": 1e-05,
}


@some
@given(rotors())
@example(TURNED_MOMENT)
def test_figures_of_a_rotor__cover_the_rounding_of_all_its_numbers(rotor):
    for name, (found, error, moved) in figures(rotor).items():
        if math.isfinite(found) and math.isfinite(moved):
            assert moved <= error, name


def test_figures_of_a_common_rotor__are_some_dozen_roundings():
    unbalances = {
        "a": {"mass": 0.1, "radius": 0.3, "angle": 0.3, "position": 0.2},
        "b": {"mass": 0.2, "radius": 0.2, "angle": 2.0, "position": 0.7},
    }
    planes = {"left": {"position": 0.25, "radius": 0.3}, "right": {"position": 0.75, "radius": 0.25}}
    rotor = {"type": "rotor", "mass": 100.0, "speed": 150.0, "centre": 0.4, "first_bearing": 0.0, "second_bearing": 1.0}
    for name, (found, error, _) in figures(rotor | {"unbalances": unbalances, "planes": planes}).items():
        # Those are differences that cancel.
        if not any(word in name for word in ("after", "at_worst", "allowance")):
            assert error <= 4000 * EPS * abs(found), name


ENGINE = {
    "type": "engine",
    "stroke": 0.08,
    "piston_mass": 0.4,
    "rod_mass": 0.5,
    "rod_centre": 0.04,
    "throw_mass": 0.3,
    "balanced_reciprocating": 0.4,
    "spacing": 0.1,
    "rod_distance": 0.03,
    "speed": 300.0,
}
GAS = {"bore": 0.08, "clearance": 0.12, "intake": 0.9e5, "exhaust": 1.05e5, "peak": 50e5}
LINKS = {"knuckle_radius": 0.06, "link_rod": 0.2, "link_rod_mass": 0.3, "link_rod_centre": 0.05}
ORDER = {"firing_order": (1, 4, 2, 5, 3, 6)}
LAYOUTS = [
    {"layout": "in-line", "cylinders": 4, "gas": GAS, "rod_inertia": 0.001},
    {"layout": "V", "cylinders": 2, "bank_angle": 1.1, "pin_offset": 0.4},
    {"layout": "V", "cylinders": 6, "bank_angle": 2.5, "gas": GAS, "gudgeon_offset": 0.01, **ORDER},
    {"layout": "W", "cylinders": 12, "bank_angle": 1.0},
    {"layout": "boxer", "cylinders": 6},
    # The rod's share at the piston takes away nearly all of the piston's mass.
    {"layout": "in-line", "cylinders": 1, "rod_mass": 0.9, "rod_centre": -0.039996},
    {"layout": "radial", "cylinders": 5, **LINKS},
]


@pytest.mark.parametrize("layout", LAYOUTS, ids=lambda keys: f"{keys['layout']} {keys['cylinders']}")
@pytest.mark.parametrize("rod", [0.0400004, 0.14])
def test_figures_of_an_engine__cover_the_rounding_of_all_its_numbers(layout, rod):
    rod += layout.get("gudgeon_offset", 0.0)
    for name, (found, error, moved) in figures(ENGINE | layout | {"rod": rod}).items():
        assert math.isfinite(found), name
        # Differences of rounding noise are no derivatives: figures leave room for them, sizes of nothing don't move.
        assert moved <= error, name


RUNNING = {**BELT, "moment": 3.0, "speed": 20.0, "linear_density": 0.2}
del RUNNING["tension"]


@pytest.mark.parametrize("data", [RUNNING, *(data for name, data in EVERY.items() if name != "egg")])
def test_error_figures_of_numbers_of_all_sizes__hold_against_more_digits(data):
    it, rng, many = element(data), np.random.default_rng(5), 1000
    powers = {key: 10.0 ** (rng.normal(0.0, 1.5, many) * rng.integers(0, 2, many)) for key in it.own_numbers()}
    n = {key: number * powers[key] for key, number in it.own_numbers().items()}
    with np.errstate(all="ignore"):
        found, wide = it.evaluate(n), it.values({key: number.astype(np.longdouble) for key, number in n.items()})
        for name, row in wide.items():
            # Below the least normal number float64 has fewer digits.
            missed = np.abs(found.values[name] - row) > found.errors[name] + 1e-290
            assert not missed[np.isfinite(row)].any(), name
