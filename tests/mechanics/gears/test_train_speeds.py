"""Speeds of gear trains against Willis' closed forms, exact fractions, and Chebyshev's count of freedoms."""

import math
from fractions import Fraction

import numpy as np
import pytest
from each_case import refusals
from element_samples import element, results, solved
from gear_samples import simple_planetary, stepped_planetary, toothed

from engine import Verdict

EPS = np.finfo(float).eps
SPEED = 100.0


def near(found, exact, roundings=128):
    """Within the error estimate, which is itself some roundings of the value."""
    value, error = found
    assert abs(Fraction(float(value)) - exact) <= Fraction(float(error))
    assert error <= roundings * EPS * abs(value)


@pytest.mark.parametrize("z", [(31623, 31624, 31623, 31622), (31622, 31623, 31624, 31623), (100, 101, 100, 99)])
def test_basic_ratio_next_to_one__costs_as_many_digits_as_it_is_near(z):
    z1, z2, z3, z4 = z
    i0 = Fraction(z2 * z4, z1 * z3)
    assert abs(i0 - 1) < Fraction(1, 9000)
    for driven, third, share in (("arm", "first", 1 - i0), ("first", "arm", 1 / (1 - i0))):
        shaft = {"first": "first_shaft", "arm": "arm"}[third]
        found = solved(stepped_planetary(*z, {driven: {"speed": SPEED}, "fourth": {"held": True}}))
        near(found[f"{shaft}.speed"], Fraction(SPEED) * share, 64 / abs(1 - i0))


def test_basic_ratio_of_one__lets_no_speed_follow():
    roles = {"first": {"speed": SPEED}, "fourth": {"held": True}}
    found, _, _ = results(stepped_planetary(40, 60, 40, 60, roles))
    assert math.isfinite(found["arm.ratio"][0])
    found, _, status = results(stepped_planetary(40, 60, 60, 40, roles))
    assert status == Verdict.NOT_FINITE
    assert np.isnan(found["arm.speed"][0])


def test_ravigneaux_set__agrees_with_its_two_basic_ratios():
    """Small sun – short planet – long planet – ring; large sun on the long planet: two Willis equations."""
    s1, s2, short, long, ring = 26, 32, 21, 20, 72
    train = {
        "type": "gear_train",
        "wheels": toothed(small=("small_shaft", s1), large=("large_shaft", s2), annulus=("out", ring))
        | toothed(short=("short_shaft", short), long=("long_shaft", long)),
        "shafts": {
            "small_shaft": {"speed": SPEED},
            "large_shaft": {"held": True},
            "short_shaft": {"carrier": "arm"},
            "long_shaft": {"carrier": "arm"},
            "arm": {},
            "out": {},
        },
        "meshes": {
            "m1": {"between": ["small", "short"]},
            "m2": {"between": ["short", "long"]},
            "m3": {"between": ["large", "long"]},
            "m4": {"between": ["long", "annulus"], "type": "internal"},
        },
    }
    found = solved(train)
    to_small, to_large = Fraction(ring, s1), -Fraction(ring, s2)
    # ω_1 − h = to_small (r − h), 0 − h = to_large (r − h): r − h = −h/to_large.
    h = Fraction(SPEED) / (1 - to_small / to_large)
    near(found["arm.speed"], h)
    near(found["out.speed"], h - h / to_large)
    near(found["arm.basic_ratio_of_small_to_annulus"], to_small)
    near(found["arm.basic_ratio_of_large_to_annulus"], to_large)
    near(found["arm.basic_ratio_of_small_to_large"], -Fraction(s2, s1))


def test_train_in_a_train__has_the_speeds_of_nested_willis_equations():
    """The planet of an outer stage is itself the carrier of an inner one."""
    train = {
        "type": "gear_train",
        "wheels": toothed(sun=("frame", 40), wheel=("inner_arm", 20), core=("core_shaft", 30), moon=("moon_shaft", 15)),
        "shafts": {
            "arm": {"speed": SPEED},
            "inner_arm": {"carrier": "arm"},
            "core_shaft": {"carrier": "arm", "speed": 7.0},
            "moon_shaft": {"carrier": "inner_arm"},
        },
        "meshes": {"m1": {"between": ["sun", "wheel"]}, "m2": {"between": ["core", "moon"]}},
    }
    found = solved(train)
    inner = Fraction(SPEED) * (1 + Fraction(40, 20))
    near(found["inner_arm.speed"], inner)
    near(found["moon_shaft.speed"], inner - Fraction(30, 15) * (7 - inner))


# What is refused


DEPENDENT = {
    "type": "gear_train",
    "wheels": toothed(a=("s", 20), b=("t", 20), c=("u", 20), d=("v", 20)),
    "shafts": {"s": {"speed": 1.0}, "t": {"speed": 2.0}, "u": {}, "v": {}},
    "meshes": {"m": {"between": ["a", "b"]}, "k": {"between": ["c", "d"]}},
}
TRAIN = simple_planetary(18, 24, 66, {"sun": {"speed": 1.0}, "ring": {"held": True}})
LOOP = {
    "type": "gear_train",
    "wheels": toothed(a=("aa", 20), b=("bb", 20), c=("cc", 20)),
    "shafts": {n * 2: {} for n in "abc"},
    "meshes": {f"{p}{q}x": {"between": [p, q]} for p, q in ("ab", "bc", "ca")},
}
ON_RING = TRAIN["shafts"] | {"sun_shaft": {"carrier": "ring_shaft", "speed": 1.0}}
FREE = simple_planetary(18, 24, 66, {"sun": {"speed": 1.0}})

test_train_that_cannot_be__is_refused_in_words = refusals(
    element,
    (FREE, "n = 4 shafts that move, p1 = 4 bearings, p2 = 2 meshes: W = 3·4 − 2·4 − 2 = 2, so this many"),
    (FREE, "those with a speed are 1: sun_shaft"),
    (DEPENDENT, "aren't independent"),
    (TRAIN | {"meshes": {"m": {"between": ["sun", "moon"]}}}, "there is no wheel 'moon'"),
    (TRAIN | {"wheels": toothed(sun=("axle", 9), planet=("idler", 9))}, "no shaft 'axle'"),
    (TRAIN | {"meshes": {"m": {"between": ["sun", "sun"]}}}, "doesn't mesh with itself"),
    (TRAIN | {"meshes": {"m": {"between": ["sun", "ring"], "type": "internal"}}}, "no wheel in mesh"),
    (TRAIN | {"shafts": ON_RING}, "don't keep their distance"),
    (LOOP, "nothing can turn"),
)
