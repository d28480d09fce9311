"""Diagrams of the linear and angular velocities of a gear train, after Smirnov.

Heights are measured along the line of centres, velocities across it. All points of a shaft are on a straight line whose
slope is its angular speed. The line passes through the shaft's axis at the axis' velocity and through the pitch points,
where both wheels have the same velocity.
"""

from typing import NamedTuple

import numpy as np

from engine.elements.element import Element
from engine.elements.gears.assembly_conditions import assembly_conditions
from engine.elements.gears.gear_structure import STANDS_STILL, MeshPlace
from engine.elements.gears.train_variants import MeshSizes, train_variants
from engine.parts.skeleton import FRAME
from engine.words.verdicts import Verdict


class DrawnWheel(NamedTuple):
    """A wheel in the scheme: height of its axis and radius [m, or modules], column along the axis, ring or not."""

    axis: float
    radius: float
    column: int
    is_ring: bool


class VelocityLine(NamedTuple):
    """A shaft in the diagram: two heights [m, or modules] and the velocities there [m/s], angular speed [rad/s]."""

    heights: tuple[float, float]
    velocities: tuple[float, float]
    speed: float


class VelocityPicture(NamedTuple):
    """Velocity diagram of a gear train.

    Attributes
    ----------
    wheels : dict of str to DrawnWheel
    lines : dict of str to VelocityLine
        By shafts; planets that roll on other planets only are not on the line of centres.
    contacts : dict of str to (float, float)
        Height and velocity of the pitch point, by meshes on the line of centres.
    axes : dict of str to float
        Height of the axis of every shaft on the line of centres.
    verdict : Verdict
        On its assembly.
    """

    wheels: dict[str, DrawnWheel]
    lines: dict[str, VelocityLine]
    contacts: dict[str, tuple[float, float]]
    axes: dict[str, float]
    verdict: Verdict


def velocity_picture(train: Element) -> VelocityPicture:
    """Velocity diagram of a gear train."""
    v = train_variants(train, train.own_numbers())
    structure, sizes = v.structure, v.sizes
    speeds = dict(zip((*structure.shafts, FRAME), v.speeds.value[:, 0].tolist(), strict=True))
    heights = _heights(train, sizes)
    axes = {name: heights[structure.axes[name]] for name in structure.shafts if structure.axes[name] in heights}

    def velocity(shaft: str, height: float) -> float:
        """Velocity of the point of a shaft on the line of centres at a height."""
        if shaft == FRAME:
            return 0.0
        carrier = structure.name_of(structure.carriers[structure.shafts.index(shaft)])
        return velocity(carrier, axes[shaft]) + speeds[shaft] * (height - axes[shaft])

    wheels, contacts = {}, {}
    spans: dict[str, list[float]] = {name: [height] for name, height in axes.items()}
    for wheel, column in _columns(train).items():
        place, end = next((p, p.wheels.index(wheel)) for p in structure.meshes if wheel in p.wheels)
        axis = heights.get(structure.axes[wheel])
        if axis is not None:
            radius = float(sizes[place.name].rolling[end][0]) / 2
            wheels[wheel] = DrawnWheel(axis, radius, column, place.sense < 0 and end == 1)
    for place in structure.meshes:
        if not _on_line(place, structure.axes, heights, sizes):
            continue
        low = heights[structure.axes[place.wheels[1 if place.sense < 0 else 0]]]
        up = heights[structure.axes[place.wheels[0]]], heights[structure.axes[place.wheels[1]]]
        radii = [float(d[0]) / 2 for d in sizes[place.name].rolling]
        # The pitch point of a ring is on its pinion's side; that of external wheels is between both axes.
        point = low + radii[1] if place.sense < 0 else (up[0] + radii[0] if up[1] > up[0] else up[1] + radii[1])
        owners = [train.wheels[wheel].shaft for wheel in place.wheels]
        contacts[place.name] = point, velocity(owners[0], point)
        for owner in owners:
            if owner in spans:
                spans[owner].append(point)
        if place.central is not None:
            planet = structure.name_of((place.second, place.first)[place.central])
            spans[structure.name_of(place.carrier)].append(axes[planet])
    lines = {}
    for shaft, span in spans.items():
        ends = min(span), max(span)
        lines[shaft] = VelocityLine(ends, (velocity(shaft, ends[0]), velocity(shaft, ends[1])), speeds[shaft])
    return VelocityPicture(wheels, lines, contacts, axes, Verdict(assembly_conditions(v).verdicts[0]))


def _heights(train: Element, sizes: dict[str, MeshSizes]) -> dict[str, float]:
    """Heights of all axes on the line of centres, the first wheel's at 0; others above the wheels they mesh with."""
    structure = train.structure
    heights = {structure.axes[structure.meshes[0].wheels[0]]: 0.0}
    if structure.meshes[0].central is not None:
        heights = {structure.axes[structure.meshes[0].wheels[structure.meshes[0].central]]: 0.0}
    for _ in structure.meshes:
        for place in structure.meshes:
            if place.central is None and place.carrier != STANDS_STILL:
                continue
            known = [structure.axes[wheel] in heights for wheel in place.wheels]
            if sum(known) == 1:
                here = known.index(True)
                distance = float(sizes[place.name].distance[0])
                up = -1.0 if place.sense < 0 and here == 0 and place.central is None else 1.0
                at = heights[structure.axes[place.wheels[here]]]
                heights[structure.axes[place.wheels[1 - here]]] = at + up * distance
    return heights


def _on_line(place: MeshPlace, axes: dict[str, str], heights: dict[str, float], sizes: dict[str, MeshSizes]) -> bool:
    """Whether both axes of a mesh are on the line of centres, at the centre distance of their teeth."""
    at = [heights.get(axes[wheel]) for wheel in place.wheels]
    if None in at:
        return False
    distance = float(sizes[place.name].distance[0])
    return bool(np.isclose(abs(at[0] - at[1]), distance, rtol=1e-9, atol=0))


def _columns(train: Element) -> dict[str, int]:
    """Column along the axes of every wheel: equal for wheels in mesh, except for meshes between planets."""
    column: dict[str, int] = {}
    for place in train.structure.meshes:
        if place.central is None and place.carrier != STANDS_STILL:
            for wheel in place.wheels:
                column.setdefault(wheel, len(set(column.values())))
            continue
        known = {column[wheel] for wheel in place.wheels if wheel in column}
        own = min(known) if known else len(set(column.values()))
        for wheel, value in column.items():
            if value in known:
                column[wheel] = own
        column |= dict.fromkeys(place.wheels, own)
    order = sorted(set(column.values()))
    return {wheel: order.index(value) for wheel, value in column.items()}
