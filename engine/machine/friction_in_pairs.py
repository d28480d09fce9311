"""Pairs that rub: which have friction and how much of it belongs to a pressing force, as steps of a program."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.elements.element_laws import BUSHES
from engine.equal_positions.text.program import Program
from engine.machine.mechanism import Mechanism
from engine.scene.pair_friction import MATERIALS, PairFriction
from engine.scene.pairs import Pair, pairs
from engine.scene.scene import Numbers, Scene


class Rub(NamedTuple):
    """Friction in a pair.

    Attributes
    ----------
    drag : str
        Moment [N·m] or force [N] on the pair's link for each newton that presses, against its motion.
    lost : str
        Work that each newton that presses costs for each unit of the input's motion.
    edge : str
        Argument of `guide_bearing`; "" of a revolute pair.
    """

    drag: str
    lost: str
    edge: str


class Rubbing:
    """Writes how much friction belongs to a pressing force.

    Attributes
    ----------
    rubs : dict of str to Rub
        By the name of the pair; pairs that never move have none.
    """

    def __init__(self, scene: Scene, mechanism: Mechanism, program: Program) -> None:
        self.mechanism, self.program = mechanism, program
        self.rubs: dict[str, Rub] = {}
        named = {friction.pair: name for name, friction in scene.friction.items()}
        for pair in pairs(scene):
            if pair.name in named:
                self._rub(pair, f"friction.{named[pair.name]}", scene.friction[named[pair.name]])

    def _rate(self, pair: Pair) -> str:
        """Relative motion in a pair, for each unit of the input's."""
        if pair.kind == "prismatic":
            return self.mechanism.slides[pair.link].dv
        one, other = (self.mechanism.links[link].w or "zero" for link in (pair.link, pair.other))
        if one == other:
            return "zero"
        return one if other == "zero" else self.program.fresh(f"{one} - {other}")

    def _rub(self, pair: Pair, path: str, friction: PairFriction) -> None:
        p = self.program
        p.about(f"motion in {pair.name}", "velocity")
        rate = self._rate(pair)
        if rate == "zero":
            return
        drag = self._drag(pair, path, friction, rate)
        forward = p.derived("input.forward", lambda n: np.sign(n["input.speed"]) + 0.0)
        signed = p.fresh(f"constant_against_motion({drag}, {rate}) * {forward}")
        edge = ""
        if pair.kind == "prismatic":
            edge = "zero"
            if friction.length is not None:
                edge = p.derived(f"{path}.edge", lambda n: 2.0 / n[f"{path}.length"], "load")
        self.rubs[pair.name] = Rub(signed, p.fresh(f"abs({rate}) * {drag}"), edge)

    def _drag(self, pair: Pair, path: str, friction: PairFriction, rate: str) -> str:
        """Friction for each newton that presses: a slot, or a variable where it depends on the speed of sliding."""
        p = self.program
        factor, arm = _factor(pair, path, friction), _arm(pair, path)

        def drag(f: float | np.ndarray, n: Numbers) -> float | np.ndarray:
            # Pressure and friction at a right angle add up to a journal's reaction.
            root = np.sqrt(1.0 + f * f) if pair.kind == "revolute" else 1.0
            return factor(n) * arm(n) * f / root

        def kinetic(n: Numbers) -> float | np.ndarray:
            return n[f"{path}.coefficient"] if friction.material is None else MATERIALS[friction.material]

        if friction.stribeck_speed is None:
            return p.derived(f"{path}.drag", lambda n: drag(kinetic(n), n), "load")
        speed = p.derived(f"{path}.sliding", lambda n: arm(n) * n["input.speed"], "load")
        rest, end = p.number(f"{path}.static_coefficient", "load"), p.derived(f"{path}.kinetic", kinetic, "load")
        limit = p.number(f"{path}.stribeck_speed", "load")
        f = p.fresh(f"stribeck({rest}, {end}, {speed} * {rate}, {limit}, GAUSS)")
        scale = p.derived(f"{path}.scale", lambda n: factor(n) * arm(n), "load")
        root = f" / math.sqrt(one + {f} * {f})" if pair.kind == "revolute" else ""
        return p.fresh(f"{scale} * {f}{root}")


def _factor(pair: Pair, path: str, friction: PairFriction) -> Callable[[Numbers], float | np.ndarray]:
    """By how much the pressures in a pair add up to more than their resultant."""
    if friction.form == "vee":
        return lambda n: 1.0 / np.sin(n[f"{path}.vee_angle"] / 2)
    bush = BUSHES.get((friction.contact if pair.kind == "revolute" else friction.form) or "line", 1.0)
    return lambda n: bush


def _arm(pair: Pair, path: str) -> Callable[[Numbers], float | np.ndarray]:
    """Radius of a journal; 1 of a guide."""
    return (lambda n: n[f"{path}.diameter"] / 2) if pair.kind == "revolute" else (lambda n: 1.0)
