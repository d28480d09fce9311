"""What a computed position misses of its group: nothing but rounding, and all that it is spoilt by."""

import math
from typing import NamedTuple

import numpy as np
import pytest

from engine.laws.kinematics.prp import prp_closure, prp_position
from engine.laws.kinematics.rpp import rpp_closure, rpp_position
from engine.laws.kinematics.rpr import rpr_closure, rpr_position
from engine.laws.kinematics.rrp import rrp_closure, rrp_position
from engine.laws.kinematics.rrr import rrr_closure, rrr_position

EPS = np.finfo(float).eps
GUIDE, OTHER = (math.cos(0.3), math.sin(0.3)), (math.cos(1.9), math.sin(1.9))


class Group(NamedTuple):
    """A dyad at one position: what it is given, what is found, and what its closure is given."""

    given: tuple
    position: object
    closure: object

    def missed(self, found):
        return self.closure(self.given, found)


# Lengths about a metre. The order of the arguments is that of the laws.
GROUPS = {
    "rrr": Group(
        ((0.1, 0.2), (2.0, -0.1), 1.3, 1.7, -1.0),
        rrr_position,
        lambda g, f: rrr_closure(*g[:2], tuple(f[:2]), (g[2], *f[2:4]), (g[3], *f[4:6])),
    ),
    "rrp": Group(
        ((0.1, 0.2), (-0.4, 0.3, *GUIDE), 1.9, 0.2, 1.0),
        rrp_position,
        lambda g, f: rrp_closure(*g[:2], g[3], tuple(f[:2]), (g[2], *f[2:4]), f[4]),
    ),
    "rpr": Group(
        ((1.4, 0.9), (0.1, 0.2), 0.3, -1.0), rpr_position, lambda g, f: rpr_closure(*g[:-1], tuple(f[:2]), f[2])
    ),
    "prp": Group(
        ((0.1, 0.2, *GUIDE), 0.3, (1.1, -0.4, *OTHER), -0.2),
        prp_position,
        lambda g, f: prp_closure(*g, tuple(f[:2]), *f[2:4]),
    ),
    "rpp": Group(
        ((0.9, 1.2), (0.1, 0.2, *GUIDE), OTHER),
        rpp_position,
        lambda g, f: rpp_closure(*g, tuple(f[:2]), tuple(f[2:4]), *f[4:]),
    ),
}
# The last number that a position tells is the quality of transmission; RPP has none.
PLACES = [
    (name, i) for name, group in GROUPS.items() for i in range(len(group.position(*group.given)) - (name != "rpp"))
]


@pytest.mark.parametrize("name", GROUPS)
def test_computed_position__misses_nothing(name):
    group = GROUPS[name]
    # A few roundings of coordinates of two metres, over lengths not below 1/3 m.
    assert group.missed(group.position(*group.given)) < 40 * EPS


@pytest.mark.parametrize(("name", "place"), PLACES)
def test_spoilt_position__is_missed_by_about_as_much(name, place):
    group = GROUPS[name]
    found = list(group.position(*group.given))
    found[place] += 1e-6
    # Shares of lengths of 1/3 … 3 m.
    assert 1e-7 < group.missed(found) < 1e-5


@pytest.mark.parametrize("name", GROUPS)
def test_unknown_position__is_missed_by_an_unknown_amount(name):
    group = GROUPS[name]
    found = [math.nan] * len(group.position(*group.given))
    assert math.isnan(group.missed(found))
