"""Ranges of the input over which a mechanism can be assembled, and assembly modes at the first position."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from engine.machine.one_machine.moving_machine import MovingMachine
from engine.mechanism.groups.seed_tables import AssemblyMode, ModeNotGiven
from engine.mechanism.mechanics import Mechanics
from engine.scene.scene import Numbers, Scene, scene_numbers
from engine.scene.structure.ordering import order

# Positions at which assembly is examined; ends of ranges are accurate to one interval.
_EXAMINED = 7200


def assembly_modes(scene: Scene) -> dict[str, tuple[AssemblyMode, ...] | None]:
    """The real assembly modes of every group of free links, in the order of the groups.

    None for a group that depends on one whose mode the scene doesn't select.

    Parameters
    ----------
    scene : Scene

    Raises
    ------
    SceneError
        The scene can't be ordered.
    """
    found: dict[str, tuple[AssemblyMode, ...] | None] = {}
    for name, tables in Mechanics(scene).kinematics.seed_tables.items():
        try:
            found[name] = tables.modes
        except ModeNotGiven:
            found[name] = None
    return found


def near_of_variant(scene: Scene, values: Mapping[str, float]) -> dict[str, float] | None:
    """Numbers under `near` that select a variant's assembly modes when the variant is a separate scene.

    Parameters
    ----------
    scene : Scene
    values : mapping of path to float
        Numbers (SI) that replace the scene's.

    Returns
    -------
    dict of path to float, or None
        None if a mode of the scene isn't reached in the variant, or the scene doesn't select one.
    """
    if not scene.links or not values:
        return {}
    numbers = Numbers(scene_numbers(scene), {path: np.array([value], float) for path, value in values.items()})
    found: dict[str, float] = {}
    for tables in Mechanics(scene, frozenset(values)).kinematics.seed_tables.values():
        try:
            places = tables.near_points(numbers)
        except ModeNotGiven:
            return None
        if places is None:
            return None
        for name, place in places.items():
            found |= {f"near.{name}.{axis}": value for axis, value in zip("xy", place, strict=True)}
    return found


class AssemblyRange(NamedTuple):
    """A range of the input over which the mechanism can be assembled [rad, or m for a sliding input]."""

    start: float
    stop: float


def assembly_ranges(mechanics: Mechanics) -> list[AssemblyRange]:
    """Ranges of the input over which every structural group can be assembled.

    Parameters
    ----------
    mechanics : Mechanics

    Returns
    -------
    list of AssemblyRange
        One range over the whole cycle if the input moves freely; empty if the mechanism can't be assembled anywhere. A
        range that contains φ = 0 of a full circle has a negative start.
    """
    scene = mechanics.scene
    fields = [f"{group}.transmission" for group in (*scene.groups, *order(scene).free_groups, *scene.cams)]
    machine = MovingMachine(scene, positions=_EXAMINED, known=mechanics)
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
