"""Non-circular wheels, put together from nodes: motion of the driven one, pitch point and curvature of both."""

from typing import NamedTuple

from engine.graph.nodes import Node, Return
from engine.laws.elementary import direction_of
from engine.laws.kinematics.noncircular_wheels import (
    driven_pitch_curve,
    driving_pitch_curve,
    elliptical_wheels,
    polar_curvature,
    wheel_harmonic,
)
from engine.mechanism.assembly import Assembly, Turning
from engine.mechanism.vectors import Vector, named


class NoncircularMotion(NamedTuple):
    """A non-circular wheel and its driver at a position.

    Attributes
    ----------
    rate : Node
        Ratio of its speed to the driver's, by magnitude.
    pitch_point : Vector
        [m]
    tangent : Vector
        Common to both pitch curves at the pitch point.
    away : Vector
        Their normal, towards this wheel.
    radius, driver_radius : Node
        Of the pitch curves at the pitch point [m].
    curvature, driver_curvature : Node
        Of the pitch curves there, positive where they are convex [1/m].
    """

    rate: Node
    pitch_point: Vector
    tangent: Vector
    away: Vector
    radius: Node
    driver_radius: Node
    curvature: Node
    driver_curvature: Node


def add_noncircular_wheel(assembly: Assembly, name: str) -> NoncircularMotion:
    """Add a non-circular wheel of the scene to a mechanism.

    Parameters
    ----------
    assembly : Assembly
    name : str
        Of the wheel.
    """
    wheel, graph, at = assembly.scene.noncircular_wheels[name], assembly.graph, f"noncircular_wheels.{name}"
    driver, pivot = assembly.links[wheel.geared_to], assembly.points[wheel.pivot]
    lobes, mean = float(wheel.driver_lobes), wheel.driver_lobes / wheel.lobes
    turned = assembly.angles[wheel.geared_to] - assembly.number(f"{at}.begin")
    lead, *rates = _law(assembly, name, lobes * turned)
    rate, slope, bend = (mean * lobes**order * node for order, node in enumerate(rates))
    rate = named(rate, f"{name}_ratio")
    angle = assembly.number(f"{at}.phase") - mean * (turned + lead * (1.0 / lobes))
    assembly.angles[name] = angle
    u = Vector(*graph.apply(direction_of, angle))
    graph.returns((*u, lead, *rates), Return(f"{at}.lobes", assembly.turns(name)))
    w, e = -(rate * driver.w), -(slope * (driver.w * driver.w) + rate * driver.e)
    assembly.link(name, Turning(pivot, u, w, e))
    # Where the driven wheel would stand, velocities of what drives it the other way are infinite: a dead centre.
    assembly.sines[name] = rate
    assembly.solutions[name] = (rate,)
    line = pivot.r - driver.origin.r
    distance = line.length
    along = line * (graph.one / distance)
    own, other = (
        graph.apply(curve, distance, rate, slope, bend) for curve in (driven_pitch_curve, driving_pitch_curve)
    )
    radius, first, _ = other
    # The pitch point moves along the line of centres as the driver's pitch curve turns away under it.
    tangent = radius * along.normal - first * along
    tangent = tangent * (graph.one / tangent.length)
    return NoncircularMotion(
        rate,
        (driver.origin.r + radius * along).called(f"{name}_pitch_point"),
        tangent,
        -tangent.normal,
        own[0],
        radius,
        graph.apply(polar_curvature, *own),
        graph.apply(polar_curvature, *other),
    )


def _law(assembly: Assembly, name: str, angle: Node) -> tuple[Node, ...]:
    """Lead of the driven wheel beyond an even motion of the ratio 1, and three derivatives of its angle."""
    law, graph, at = assembly.scene.noncircular_wheels[name].law, assembly.graph, f"noncircular_wheels.{name}.law"
    if law.type == "elliptical":
        return graph.apply(elliptical_wheels, angle, assembly.number(f"{at}.eccentricity"))
    lead, rate, slope, bend = graph.zero, graph.one, graph.zero, graph.zero
    for key, harmonic in law.harmonics.items():
        coefficients = (assembly.number(f"{at}.harmonics.{key}.{part}") for part in ("cosine", "sine"))
        added = graph.apply(wheel_harmonic, angle, float(harmonic.order), *coefficients)
        lead, rate, slope, bend = (one + two for one, two in zip((lead, rate, slope, bend), added, strict=True))
    return lead, rate, slope, bend
