"""Hoists, vehicles and belt conveyors as nodes: the load of the moved masses on their drum or wheel.

Masses move at r ω of the drum or wheel, so a force F along their path is a moment F r, and a mass m an inertia m r².
Sources: M. Mitschke and H. Wallentowitz, Dynamik der Kraftfahrzeuge (driving resistances); DIN 22101 (belt conveyors:
main resistances by an overall coefficient of friction f, secondary ones by a coefficient C).
"""

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from engine.graph.nodes import Node
from engine.laws.loads import constant_against_motion, lifting_factor
from engine.mechanism.actions.paths import Along, input_sense
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.link_loads import Characteristic
from engine.parts.actions import Carried, ConveyorMoment, HoistMoment
from engine.parts.bodies import STANDARD_GRAVITY
from engine.scene.masses import carried_inertia, carried_on
from engine.scene.scene import Numbers

_Value = float | np.ndarray
_OfNumbers = Callable[[Numbers], _Value]
_FORWARD_SIGNS = {"counter-clockwise": 1.0, "clockwise": -1.0}


def carried_characteristics(kinematics: Kinematics, load: Carried, at: str, along: Along) -> Iterator[Characteristic]:
    """Loads of the moved masses on their drum or wheel.

    Parameters
    ----------
    kinematics : Kinematics
    load : Carried
    at : str
        Path of the load in the scene.
    along : Along
        Motion of the drum or wheel.
    """
    graph, sign = kinematics.graph, _FORWARD_SIGNS[load.forwards]
    against = graph.held(along.switch(constant_against_motion, 1.0))

    gravity = _gravity(load, at)

    def number(words: str, value: _OfNumbers) -> Node:
        return graph.derived(f"{words} of {at}", value)

    if isinstance(load, HoistMoment):
        weight = number("moment of the weight", lambda n: n[f"{at}.mass"] * gravity(n) * n[f"{at}.drum_radius"])
        yield Characteristic(weight, graph.constant(-sign))
        efficiency = graph.number(f"{at}.efficiency")
        factor = along.switch(lifting_factor, efficiency, sign * input_sense(kinematics))
        yield Characteristic(weight, -sign * (graph.held(factor) - 1.0), role="harmful")
        return
    rubs, lifts = _conveyed(at, gravity) if isinstance(load, ConveyorMoment) else _driven(at, gravity)
    yield Characteristic(number("moment of friction", lambda n: rubs(n) * np.sign(n["input.speed"])), against)
    yield Characteristic(number("moment of the slope", lifts), graph.constant(-sign))
    if not isinstance(load, ConveyorMoment):
        drag = number("moment of the air", partial(_air_drag, at))
        yield Characteristic(drag, against * (along.velocity * along.velocity), 2)


def _gravity(load: Carried, at: str) -> _OfNumbers:
    """The load's own gravity, else the scene's; standard gravity if the scene has none."""
    if load.gravity is not None:
        return lambda n: n[f"{at}.gravity"]
    return lambda n: np.where(n["gravity"] == 0.0, STANDARD_GRAVITY, np.abs(n["gravity"]))


def _driven(at: str, gravity: _OfNumbers) -> tuple[_OfNumbers, _OfNumbers]:
    """Moments of a vehicle's rolling resistance and of the slope."""

    def weight(n: Numbers) -> _Value:
        return n[f"{at}.mass"] * gravity(n) * n[f"{at}.wheel_radius"]

    return (
        lambda n: n[f"{at}.rolling"] * weight(n) * np.cos(n[f"{at}.slope"]),
        lambda n: weight(n) * np.sin(n[f"{at}.slope"]),
    )


def _conveyed(at: str, gravity: _OfNumbers) -> tuple[_OfNumbers, _OfNumbers]:
    """Moments of a conveyor's friction and of lifting its load."""

    def arm(n: Numbers) -> _Value:
        return gravity(n) * n[f"{at}.drum_radius"]

    def friction(n: Numbers) -> _Value:
        pressed = (n[f"{at}.load_mass"] + n[f"{at}.belt_mass"]) * np.cos(n[f"{at}.incline"])
        return n[f"{at}.length_coefficient"] * n[f"{at}.friction"] * pressed * arm(n)

    return friction, lambda n: n[f"{at}.load_mass"] * np.sin(n[f"{at}.incline"]) * arm(n)


def _air_drag(at: str, n: Numbers) -> _Value:
    """Moment ½ ρ c A v² r at unit transfer velocity of the wheel, times the square of the input speed."""
    force = 0.5 * n[f"{at}.air_density"] * n[f"{at}.drag_area"]
    return force * n[f"{at}.wheel_radius"] ** 3 * n["input.speed"] * np.abs(n["input.speed"])


def turning_inertia(kinematics: Kinematics, shaft: str) -> Node:
    """Inertia of a shaft, including m r² of the masses it moves."""
    scene, own = kinematics.scene, f"shafts.{shaft}.inertia"
    if not carried_on(scene, shaft):
        return kinematics.graph.number(own)
    words = f"inertia of shaft {shaft} with what it carries"
    return kinematics.graph.derived(words, lambda n: n[own] + carried_inertia(scene, shaft, n))
