"""Whether a mechanism can be assembled all through its cycle, and if not, over which ranges of the input."""

from typing import NamedTuple

import numpy as np

from engine.machine.machine import Machine
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
    machine = Machine(scene, fields=fields, positions=positions)
    outcome = machine.evaluate({})
    whole = np.ones(machine.nodes.size, bool)
    for field in outcome.fields.values():
        whole &= np.isfinite(field[0])
    nodes = machine.input_values
    step = nodes[1] - nodes[0]
    if whole.all():
        return [AssemblyRange(nodes[0], nodes[-1] + step if machine.has_cycle else nodes[-1])]
    edges = np.flatnonzero(np.diff(np.concatenate(([0], whole.astype(int), [0]))))
    ranges = [AssemblyRange(nodes[a], nodes[b - 1]) for a, b in edges.reshape(-1, 2)]
    if machine.has_cycle and len(ranges) > 1 and whole[0] and whole[-1]:
        turn = nodes[-1] + step
        ranges = [AssemblyRange(ranges[-1].start - turn, ranges[0].stop), *ranges[1:-1]]
    return ranges
