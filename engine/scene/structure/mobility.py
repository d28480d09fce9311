"""Mobility of a mechanism by Chebyshev's formula, W = 3n − 2p₁ − p₂."""

from typing import NamedTuple

from engine.parts.skeleton import FRAME
from engine.scene.pairs import own_drives, pairs
from engine.scene.scene import Scene


class Mobility(NamedTuple):
    """Moving links n, lower pairs p₁ and higher pairs p₂ of a mechanism.

    Bare shafts, which only pass on torque and inertia, don't belong to it; the gear of a second input driven from the
    crank counts as a higher pair.
    """

    links: int
    lower_pairs: int
    higher_pairs: int

    @property
    def degrees_of_freedom(self) -> int:
        """W = 3n − 2p₁ − p₂."""
        return 3 * self.links - 2 * self.lower_pairs - self.higher_pairs


def mobility(scene: Scene) -> Mobility:
    """Links and pairs of a mechanism.

    Parameters
    ----------
    scene : Scene
    """
    lower = pairs(scene)
    links = {link for pair in lower for link in (pair.link, pair.other)} - {FRAME}
    wheels = [shaft for shaft in scene.shafts.values() if shaft.carrier or shaft.pivot]
    higher = [*wheels, *scene.noncircular_wheels, *scene.racks, *scene.pinions, *scene.cams]
    geared = len(scene.inputs) - len(own_drives(scene))
    return Mobility(len(links), len(lower), len(higher) + geared)
