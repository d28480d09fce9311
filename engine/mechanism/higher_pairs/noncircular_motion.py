"""Non-circular wheels as nodes: motion of the driven wheel, pitch point, and curvature of both pitch curves."""

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
        Magnitude of the ratio of its speed to the driver's.
    pitch_point : Vector
        [m]
    tangent : Vector
        Common tangent of both pitch curves at the pitch point.
    away : Vector
        Common normal, towards this wheel.
    radius, driver_radius : Node
        Radii of the pitch curves at the pitch point [m].
    curvature, driver_curvature : Node
        Curvatures of the pitch curves there, positive if convex [1/m].
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
    """Add the non-circular wheel `name` of the scene to a mechanism."""
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
    # At a ratio of zero the velocity of the driver would be infinite if the driven wheel drove: a dead centre.
    assembly.sines[name] = rate
    assembly.solutions[name] = (rate,)
    line = pivot.r - driver.origin.r
    distance = line.length
    along = line * (graph.one / distance)
    own, other = (
        graph.apply(curve, distance, rate, slope, bend) for curve in (driven_pitch_curve, driving_pitch_curve)
    )
    radius, first, _ = other
    # As the driver's pitch curve turns, the pitch point moves along the line of centres.
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
    """Lead of the driven wheel over constant motion at ratio 1, and three derivatives of its angle."""
    law, graph, at = assembly.scene.noncircular_wheels[name].law, assembly.graph, f"noncircular_wheels.{name}.law"
    if law.type == "elliptical":
        return graph.apply(elliptical_wheels, angle, assembly.number(f"{at}.eccentricity"))
    lead, rate, slope, bend = graph.zero, graph.one, graph.zero, graph.zero
    for key, harmonic in law.harmonics.items():
        coefficients = (assembly.number(f"{at}.harmonics.{key}.{part}") for part in ("cosine", "sine"))
        added = graph.apply(wheel_harmonic, angle, float(harmonic.order), *coefficients)
        lead, rate, slope, bend = (one + two for one, two in zip((lead, rate, slope, bend), added, strict=True))
    return lead, rate, slope, bend
