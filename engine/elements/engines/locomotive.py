"""A locomotive's driving axle: balance weights, and the unbalance that remains.

For each cylinder, rotating weights balance fractions s_rot and c of the masses at the crankpin and the piston pin. The
unbalanced force along the track is

    F = ω² r Re Σ ((1 − s_rot) m_rot + (1 − c) m_rec) exp(i(φ + α_k)),

which varies the tractive effort and, with the cylinders' positions as arms, sways the locomotive. Vertically, all
rotating masses and weights act, but nothing opposes the weights for the reciprocating masses: the hammer blow in the
plane of each wheel is that of the weights for c m_rec, plus that of the excess (s_rot − 1) m_rot.

For two cylinders at right angles these are the textbook's √2 (1 − c) m_rec ω² r, (a/√2) (1 − c) m_rec ω² r and
B ω² b.

Sources: R. S. Khurmi and J. K. Gupta, Theory of Machines, chapter 22 (balancing of locomotives); S. S. Rattan, Theory
of Machines, chapter 14.
"""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.element import Answers, Element, NamedRows, Numbers
from engine.elements.panels import Curve, Mark, Panel, PanelAxis
from engine.elements.rotors.unbalance import Resultant, unbalance_in_two_planes
from engine.parts.actions import Force
from engine.parts.skeleton import Angle, AngularSpeed, Length, Mass, Number, Positive
from engine.words.quantity import main_result

# Two cylinders start from every position with cranks at right angles; three and four are evenly spaced.
USUAL_THROW_ANGLES = {1: 0.0, 2: math.pi / 2, 3: math.tau / 3, 4: math.pi / 2}
# Samples of a curve; highest speed drawn, relative to the given one.
_SHOWN, _FASTEST = 361, 1.5
_SIDES = ("left", "right")
_BALANCE_ANGLE = "angle of the balance weight in the {} wheel, from the first throw in the sense of rotation"


class LocomotiveElement(Element):
    """Horizontal cylinders, `cylinder_spacing` apart, on one axle, with balance weights in the planes of its wheels.

    Each throw follows the previous one, from left to right, by `throw_angle`; `crank_angle` is the angle of the first
    throw from its cylinder's axis. `rotating_mass` (at the crankpin) and `reciprocating_mass` are for one cylinder.
    Weights at `balance_radius` balance the fractions `balanced_rotating` and `balanced_reciprocating` of them. Rods are
    assumed long: orders above the first are neglected. `wheel_load` is the static load of a wheel on its rail.
    """

    picture: ClassVar = "shaking"

    type: Literal["locomotive"]
    cylinders: Literal[1, 2, 3, 4] = 2
    cylinder_spacing: Annotated[Length, Field(ge=0)]
    wheel_spacing: Positive
    throw_angle: Angle | None = None
    stroke: Positive
    rotating_mass: Annotated[Mass, Field(ge=0)] = 0.0
    reciprocating_mass: Annotated[Mass, Field(gt=0)]
    balanced_rotating: Number = 1.0
    balanced_reciprocating: Number = 2 / 3
    balance_radius: Positive
    speed: Annotated[AngularSpeed, Field(gt=0)]
    wheel_load: Annotated[Force, Field(gt=0)] | None = None
    crank_angle: Angle | None = None

    def evaluate(self, n: Numbers) -> Answers:
        """Results with error estimates; those of usual throws, which cancel, contain the rounding of their angle."""
        return super().evaluate(self._with_throws(n))

    def _with_throws(self, n: Numbers) -> Numbers:
        return {"throw_angle": np.full_like(n["speed"], USUAL_THROW_ANGLES[self.cylinders])} | dict(n)

    def named(self, n: Numbers) -> NamedRows:
        """Results of a set of variants."""
        apart, track, stroke, radius = (n[k] for k in ("cylinder_spacing", "wheel_spacing", "stroke", "balance_radius"))
        rotating, reciprocating, speed = n["rotating_mass"], n["reciprocating_mass"], n["speed"]
        s_rot, c = n["balanced_rotating"], n["balanced_reciprocating"]
        between = self._with_throws(n)["throw_angle"]
        count, square = np.arange(self.cylinders)[:, None], speed**2
        pins = stroke / 2 * np.exp(1j * count * between)
        arms = (count - (self.cylinders - 1) / 2) * apart
        taken, upright = s_rot * rotating + c * reciprocating, (s_rot - 1) * rotating + c * reciprocating
        along = (1 - s_rot) * rotating + (1 - c) * reciprocating
        pull, sway = along * pins.sum(axis=0) * square, along * (arms * pins).sum(axis=0) * square
        weights = [-taken * part for part in _in_wheels(pins, arms, track)]
        blows = [-upright * part * square for part in _in_wheels(pins, arms, track)]
        for side, weight in zip(_SIDES, weights, strict=True):
            words = f"balance weight in the {side} wheel"
            yield main_result(f"{side}_balance_mass", words, "kg"), np.abs(weight) / radius
        for side, weight in zip(_SIDES, weights, strict=True):
            yield main_result(f"{side}_balance_angle", _BALANCE_ANGLE.format(side), "rad"), np.angle(weight)
        yield main_result("tractive_variation", "maximum unbalanced force along the track", "N"), np.abs(pull)
        yield main_result("swaying_couple", "maximum unbalanced couple about the vertical axis", "N m"), np.abs(sway)
        for side, blow in zip(_SIDES, blows, strict=True):
            yield main_result(f"{side}_hammer_blow", f"maximum change of the {side} wheel's load", "N"), np.abs(blow)
        if "wheel_load" in n:
            load, most = n["wheel_load"], np.maximum(*np.abs(blows))
            words = "minimum load of a wheel, negative where it lifts off"
            yield main_result("least_wheel_load", words, "N"), load - most
            with np.errstate(divide="ignore", invalid="ignore"):
                lifts = speed * np.sqrt(load / most)
            words = "angular speed at which a wheel lifts off"
            yield main_result("lift_off_speed", words, "rad s-1", may_be_undefined=True), lifts
        if "crank_angle" in n:
            phi, turned = n["crank_angle"], np.exp(1j * n["crank_angle"])
            primary = along * stroke / 2 * square * np.cos(phi)
            yield main_result("primary_force", "primary force of the first cylinder at the crank angle", "N"), primary
            words = "unbalanced force along the track at the crank angle"
            yield main_result("tractive_force", words, "N"), (pull * turned).real
            words = "unbalanced couple about the vertical axis at the crank angle"
            yield main_result("swaying_moment", words, "N m"), (sway * turned).real
            for side, blow in zip(_SIDES, blows, strict=True):
                words = f"unbalanced upward force in the {side} wheel at the crank angle"
                yield main_result(f"{side}_rail_force", words, "N"), (blow * turned).imag

    def panels(self) -> tuple[Panel, ...]:
        """Forces and swaying couple over a turn, hammer blows over the speed."""
        angle = np.linspace(0.0, math.tau, _SHOWN)
        turn = self.model_copy(update={"crank_angle": 0.0}).over("crank_angle", angle)
        forces = [Curve("along the track", turn["tractive_force"])]
        forces += [Curve(f"up, {side} wheel", turn[f"{side}_rail_force"]) for side in _SIDES]
        x, lifts = PanelAxis("crank angle", "rad", "φ"), self.own_values().get("lift_off_speed", math.nan)
        # A well-balanced axle would lift off far beyond all operating speeds.
        fastest = max(_FASTEST * self.speed, 1.1 * lifts if lifts < 4 * self.speed else 0.0)
        speed = np.linspace(1e-3, 1.0, _SHOWN) * fastest
        found = self.over("speed", speed)
        blows = [Curve(f"hammer blow, {side}", found[f"{side}_hammer_blow"]) for side in _SIDES]
        blows.append(Curve("along the track", found["tractive_variation"]))
        over_speed = PanelAxis("speed of the axle", "rad s-1", "ω"), PanelAxis("peak force", "N", "F")
        marks = [Mark("as given", self.speed, None)]
        marks += [] if self.wheel_load is None else [Mark("wheel load", None, self.wheel_load)]
        return (
            Panel(x, PanelAxis("unbalanced force", "N", "F"), angle, forces),
            Panel(x, PanelAxis("swaying couple", "N m", "M"), angle, (Curve("", turn["swaying_moment"]),)),
            Panel(*over_speed, speed, blows, marks),
        )


def _in_wheels(pins: np.ndarray, arms: np.ndarray, track: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Equivalent unbalances in the planes of the left and the right wheel, for unit masses at the crankpins."""
    resultant = Resultant(pins.sum(axis=0), (arms * pins).sum(axis=0), np.zeros(()))
    return unbalance_in_two_planes(resultant, -track / 2, track / 2)
