"""Mass and moment of inertia of a scene's bodies: given, from their shapes, or from the period of a swing."""

import math
from collections.abc import Mapping

import numpy as np

from engine.laws.masses.moments_of_inertia import (
    Value,
    bifilar_inertia,
    compound_inertia,
    disc_inertia,
    plate_inertia,
    ring_inertia,
    rod_inertia,
    trifilar_inertia,
)
from engine.parts.actions import Carried
from engine.scene.scene import Scene


def inertia_from_swing(scene: Scene, name: str, numbers: Mapping[str, Value]) -> Value:
    """Moment of inertia of a body with a swing, about its mass centre [kg·m²], for every variant.

    Only arithmetic is used, so that numbers may carry error estimates. Negative if the body swings faster than a point
    mass.
    """
    at, mass = f"bodies.{name}.swing", numbers[f"bodies.{name}.mass"]
    period, weight = numbers[f"{at}.period"], mass * numbers[f"{at}.gravity"]
    match scene.bodies[name].swing.type:
        case "compound":
            return compound_inertia(mass, weight, numbers[f"{at}.distance"], period)
        case "bifilar":
            return bifilar_inertia(weight, numbers[f"{at}.spacing"], numbers[f"{at}.length"], period)
        case _:
            return trifilar_inertia(weight, numbers[f"{at}.radius"], numbers[f"{at}.length"], period)


def _volume(kind: str, at: str, n: Mapping[str, Value]) -> Value:
    match kind:
        case "rod":
            return n[f"{at}.area"] * n[f"{at}.length"]
        case "disc":
            return math.pi / 4 * n[f"{at}.diameter"] ** 2 * n[f"{at}.thickness"]
        case "ring":
            ring = n[f"{at}.diameter"] ** 2 - n[f"{at}.inner_diameter"] ** 2
            return math.pi / 4 * ring * n[f"{at}.thickness"]
        case _:
            return n[f"{at}.length"] * n[f"{at}.width"] * n[f"{at}.thickness"]


def body_mass(scene: Scene, name: str, numbers: Mapping[str, Value]) -> Value:
    """Mass of a body [kg], given or from density and shape, for every variant."""
    body = scene.bodies[name]
    if body.mass is not None:
        return numbers[f"bodies.{name}.mass"]
    return numbers[f"bodies.{name}.density"] * _volume(body.shape.type, f"bodies.{name}.shape", numbers)


def carried_inertia(scene: Scene, link: str, numbers: Mapping[str, Value]) -> Value:
    """Inertia m r² of all masses moved by the hoists, vehicles and conveyors on a link [kg·m²], for every variant."""
    total = 0.0
    for name, load in carried_on(scene, link).items():
        radius = numbers[f"moments.{name}.{load.radius}"]
        total = total + sum(numbers[f"moments.{name}.{mass}"] for mass in load.masses) * radius**2
    return total


def carried_on(scene: Scene, link: str) -> dict[str, Carried]:
    """Hoists, vehicles and conveyors on a link, by name."""
    return {n: moment for n, moment in scene.moments.items() if isinstance(moment, Carried) and moment.on == link}


def body_inertia(scene: Scene, name: str, numbers: Mapping[str, Value]) -> Value:
    """Moment of inertia of a body about its mass centre [kg·m²], for every variant.

    0 if none is given; NaN if a swing is faster than that of a point mass.
    """
    body, at = scene.bodies[name], f"bodies.{name}.shape"
    if body.swing is not None:
        found = inertia_from_swing(scene, name, numbers)
        return np.where(found < 0.0, np.nan, found)
    if body.shape is None:
        return 0.0 if body.inertia is None else numbers[f"bodies.{name}.inertia"]
    mass = body_mass(scene, name, numbers)
    match body.shape.type:
        case "rod":
            return rod_inertia(mass, numbers[f"{at}.length"])
        case "disc":
            return disc_inertia(mass, numbers[f"{at}.diameter"])
        case "ring":
            return ring_inertia(mass, numbers[f"{at}.diameter"], numbers[f"{at}.inner_diameter"])
        case _:
            return plate_inertia(mass, numbers[f"{at}.length"], numbers[f"{at}.width"])


def centre_along(scene: Scene, body: str, numbers: Mapping[str, Value]) -> Value:
    """Coordinate of a body's mass centre along its link: as given, else the middle of a rod, or the origin."""
    part = scene.bodies[body]
    if part.x is not None:
        return numbers[f"bodies.{body}.x"]
    if part.shape is not None and part.shape.type == "rod":
        return numbers[f"bodies.{body}.shape.length"] / 2
    return 0.0
