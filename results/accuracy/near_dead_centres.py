"""Random machines that come near a dead centre or a change point, and their references with panels graded towards it.

A length is changed so that the stretched group just reaches, with a relative margin ε from 1e-6 to 0.1, log-uniform.
"""

import numpy as np
from closed_cycle import TURN, Cycle
from random_machines import SEED, Kind, Varied

LEAST, MOST = 1e-6, 0.1
# Distances of the reference's cuts from the sharp position [rad]: the series of a panel half as long as its distance
# from there converges tenfold with every degree.
DISTANCES = 0.5 * np.longdouble(1.5) ** -np.arange(22)


def near_dead_centres(kind: Kind, varied: Varied) -> Varied:
    """Slider-cranks or crank-rockers with changed lengths of their group."""
    random = np.random.default_rng([SEED, 1, *kind.name.encode()])
    crank, rod = varied["input.length"], varied["groups.g.first.length"]
    more = 1.0 + LEAST * (MOST / LEAST) ** random.random(crank.size)
    if "groups.g.second.offset" in varied:
        return varied | {"groups.g.first.length": (crank + np.abs(varied["groups.g.second.offset"])) * more}
    rocker = varied["groups.g.second.length"]
    scale = (crank + np.hypot(varied["points.D.x"], varied["points.D.y"])) * more / (rod + rocker)
    return varied | {"groups.g.first.length": scale * rod, "groups.g.second.length": scale * rocker}


class NearCycle(Cycle):
    """A cycle whose panels get shorter towards the stretched position of the group."""

    def _breaks(self, grid: np.ndarray) -> np.ndarray:
        n = self.numbers
        if "guides.way.angle" in n:
            quarter = TURN / 4
            places = [n["guides.way.angle"] + quarter, n["guides.way.angle"] - quarter]
        else:
            places = [np.arctan2(n["points.D.y"], n["points.D.x"]) + TURN / 2]
        graded = [[at, *(at - DISTANCES), *(at + DISTANCES)] for at in places]
        breaks = np.sort(np.concatenate([super()._breaks(grid), *graded]) % TURN)
        return breaks[np.concatenate(([True], np.diff(breaks) > 1e-13))]
