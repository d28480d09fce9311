"""Deviations from a wanted motion: of points from a path, of a motion from rows over the crank angle."""

import numpy as np

from engine.cycle import measured as numbers
from engine.cycle.measured import Measured
from engine.graph.nodes import Node
from engine.laws.elementary import angle_of, direction_of
from engine.laws.tables import entry
from engine.mechanism.actions.tables import rows_over_angle
from engine.mechanism.mechanics import Mechanics
from engine.mechanism.vectors import Vector
from engine.parts.requirements import WantedAngle, WantedPath, WantedSlide
from engine.quantities.expressions import Expression, Extreme, Formula, Integral, maximum, peak, sqrt
from engine.quantities.register import Declared, Field, Summary, answer_summary, known


def declare(mechanics: Mechanics) -> Declared:
    """Deviations of all wanted motions, as rms and maximum."""
    for name, wanted in mechanics.scene.wanted.items():
        if isinstance(wanted, WantedPath):
            what, units = f"distance of the wanted points of {name} from the path of {wanted.point}", "m"
            squared = _squared_distances(mechanics, wanted)
            rms, most = Formula(_rms, squared), sqrt(maximum(*squared))
        else:
            what, units = f"deviation of {wanted.of} from {name}", "rad" if isinstance(wanted, WantedAngle) else "m"
            ends = [wanted.over_angle[0], wanted.over_angle[-1]]
            inside = rows_over_angle(mechanics.kinematics, ends, [1.0, 1.0], "linear", "zero")
            curve = inside * _deviation(mechanics, name, wanted)
            yield Field(f"{name}.deviation", f"{what}, 0 outside its rows", units, known(curve), "Δ")
            rms, most = sqrt(Integral(curve * curve) / Integral(inside)), peak(curve)
        yield Summary(f"{name}.deviation_rms", f"{what}, rms", units, known(rms), "Δrms")
        yield answer_summary(f"{name}.deviation_max", f"{what}, maximum", units, known(most), "Δmax")


def _squared_distances(mechanics: Mechanics, wanted: WantedPath) -> tuple[Expression, ...]:
    """Square of the distance of each wanted point from the path."""
    graph, kinematics = mechanics.graph, mechanics.kinematics
    at = kinematics.coordinates(kinematics.points[wanted.point].r)
    begin = graph.store(np.array([wanted.x, wanted.y]))
    places = len(wanted.x)
    found = []
    for i in range(places):
        place = Vector(*(graph.apply(entry, graph.memory, begin + float(k)) for k in (i, i + places)))
        away = at - place
        found.append(Extreme(away.dot(away), "least"))
    return tuple(found)


def _deviation(mechanics: Mechanics, name: str, wanted: WantedSlide | WantedAngle) -> Node:
    """Motion minus the rows and the offset."""
    kinematics, graph = mechanics.kinematics, mechanics.graph
    rows = rows_over_angle(kinematics, wanted.over_angle, wanted.wanted, wanted.interpolation, "hold")
    due = rows + graph.number(f"wanted.{name}.offset")
    if isinstance(wanted, WantedSlide):
        return kinematics.slides[wanted.of].d - due
    along, ahead = Vector(*graph.apply(direction_of, due)), kinematics.links[wanted.of].u
    return graph.apply(angle_of, along.dot(ahead), along.cross(ahead))


def _rms(*squares: Measured) -> Measured:
    return numbers.sqrt(sum(squares) / len(squares))
