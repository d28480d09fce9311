"""Everything that acts on each link, as the engine lists it: each link is in equilibrium over the whole cycle."""

import numpy as np
import pytest
from plan_machines import FREE, HIGHER, MACHINES, rubbing

from engine import FRAME, MovingMachine

TESTED = {name: MACHINES[name] for name in ("PRP", "turning yoke", "geared to a rocker")} | HIGHER | FREE
TESTED["rubbing yoke"] = rubbing("turning yoke")
# Forces are added up about links' origins, some tens of them with roundings of their own.
EXACT = 1e-12


@pytest.fixture(scope="module", params=TESTED)
def moving(request):
    return MovingMachine(TESTED[request.param])


def cross(one, other):
    return (one.conj() * other).imag


def test_link_forces__leave_every_moving_link_in_equilibrium(moving):
    origins = {name: origin for name, (origin, _) in moving.places.links.items()}
    forces = dict.fromkeys(origins, 0j)
    moments = dict.fromkeys(origins, 0.0)
    sizes, twists = np.zeros(moving.q.size), np.zeros(moving.q.size)
    for acting in moving.forces:
        if acting.moment is None:
            moment = cross(acting.at - origins[acting.link], acting.force)
            forces[acting.link] = forces[acting.link] + acting.force
            sizes = np.maximum(sizes, np.abs(acting.force))
        else:
            moment = acting.moment
        moments[acting.link] = moments[acting.link] + moment
        twists = np.maximum(twists, np.abs(moment))
    extent = np.ptp(np.concatenate(list(moving.places.points.values())).real)
    known = np.isfinite(sizes)
    for name in origins.keys() - {FRAME}:
        assert (np.abs(forces[name]) <= EXACT * sizes)[known].all(), name
        assert (np.abs(moments[name]) <= EXACT * np.maximum(twists, sizes * extent))[known].all(), name


def test_forces_between_links__are_opposite_at_one_point(moving):
    found = {}
    for acting in moving.forces:
        if acting.kind in ("reaction", "friction", "drive"):
            found.setdefault((acting.kind, acting.name, acting.moment is None), []).append(acting)
    assert found
    for one, other in found.values():
        assert (one.link, one.source) == (other.source, other.link)
        if one.moment is None:
            np.testing.assert_array_equal(one.at, other.at)
            np.testing.assert_array_equal(one.force, -other.force)
        else:
            np.testing.assert_array_equal(one.moment, -other.moment)
