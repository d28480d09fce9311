"""Whether a mechanism can be assembled all through its cycle, and if not, over which ranges of the input."""

from typing import NamedTuple

import numpy as np

from engine.machine.moving_machine import MovingMachine
from engine.scene.scene import Scene
from engine.scene.structure.ordering import order


class AssemblyRange(NamedTuple):
    """A range of the input over which the mechanism can be assembled [rad; m of a sliding input]."""

    start: float
    stop: float


def assembly_ranges(scene: Scene, positions: int = 7200) -> list[AssemblyRange]:
    """Ranges of the input over which every structural group can be assembled.

    Parameters
    ----------
    scene : Scene
    positions : int
        Positions looked at: the ends of the ranges are exact to one interval.

    Returns
    -------
    list of AssemblyRange
        One range over the whole cycle if the input turns (or slides) freely; empty if nothing assembles. A range
        that runs through φ = 0 of a full circle is given with a negative start.
    """
    fields = [f"{group}.transmission" for group in (*scene.groups, *order(scene).free_groups, *scene.cams)]
    machine = MovingMachine(scene, positions=positions)
    nodes, turns = machine.q, machine.mechanics.has_cycle
    whole = np.ones(nodes.size, bool)
    for row in machine.fields(fields).values():
        whole &= np.isfinite(row)
    step = nodes[1] - nodes[0]
    if whole.all():
        return [AssemblyRange(nodes[0], nodes[-1] + step if turns else nodes[-1])]
    edges = np.flatnonzero(np.diff(np.concatenate(([0], whole.astype(int), [0]))))
    ranges = [AssemblyRange(nodes[a], nodes[b - 1]) for a, b in edges.reshape(-1, 2)]
    if turns and len(ranges) > 1 and whole[0] and whole[-1]:
        turn = nodes[-1] + step
        ranges = [AssemblyRange(ranges[-1].start - turn, ranges[0].stop), *ranges[1:-1]]
    return ranges
