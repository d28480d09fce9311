"""A body that slides on a lever rotating in a horizontal plane: relative motion, inertia forces, reaction.

For an observer on the lever, the centrifugal force mω²r drives the body outwards. The Coriolis force 2mωṙ presses it
against the lever, which exerts the reaction N and the friction fN:

    r̈ + 2fω ṙ − ω² r = 0,   N = 2mωṙ,   r = C₁e^(λ₁t) + C₂e^(λ₂t),   λ = ω(−f ± √(1 + f²)),

without friction r = r₀ cosh ωt + (v₀/ω) sinh ωt. The drive of the lever does the work ∫N r ω dt = mω²(r² − r₀²): one
half becomes the body's energy of rotation with the lever, the other its energy of sliding and frictional heat,
∫2fmωṙ² dt.

Source: I. V. Meshchersky, Problems in Theoretical Mechanics (relative motion of a point).
"""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.cycle.regula_falsi import regula_falsi
from engine.elements.element import Columns, Element, ElementResult, Numbers
from engine.elements.panels import TIME, Curve, Mark, Panel, PanelAxis, path, plan
from engine.parts.skeleton import AngularSpeed, Length, Mass, Number, Speed

# Samples of a curve; number of lever positions drawn.
_SHOWN, _LEVERS = 721, 8


class RotatingGuide(Element):
    """A body that slides outwards on a straight lever rotating in a horizontal plane with constant `speed`.

    At time 0 it is at `start_radius` from the axis, with `start_velocity` along the lever; it leaves the lever at
    `length`.
    """

    ascending: ClassVar = {("start_radius", "length"): "the body slides out"}
    picture: ClassVar = "sliding"
    RESULTS: ClassVar = (
        ElementResult("time", "time to the end of the lever", "s"),
        ElementResult("turned_angle", "angle by which the lever turns meanwhile", "rad"),
        ElementResult("relative_speed", "speed along the lever at its end", "m s-1"),
        ElementResult("absolute_speed", "speed of the body as it leaves the lever", "m s-1"),
        ElementResult("leaving_angle", "angle between its path and the lever there", "rad"),
        ElementResult("start_reaction", "reaction of the lever at the start", "N"),
        ElementResult("reaction", "peak reaction of the lever, at its end", "N"),
        ElementResult("centrifugal_force", "centrifugal force of inertia at the end of the lever", "N"),
        ElementResult("moment", "peak torque that turns the lever, at its end", "N m"),
        ElementResult("work", "work done on the lever", "J"),
        ElementResult("friction_work", "work lost by friction", "J"),
    )

    type: Literal["rotating_guide"]
    mass: Annotated[Mass, Field(gt=0)]
    speed: Annotated[AngularSpeed, Field(gt=0)]
    start_radius: Annotated[Length, Field(gt=0)]
    start_velocity: Annotated[Speed, Field(ge=0)] = 0.0
    length: Annotated[Length, Field(gt=0)]
    friction: Annotated[Number, Field(ge=0)] = 0.0

    def values(self, n: Numbers) -> Columns:
        """Results of a set of variants by name."""
        mass, w, start = n["mass"], n["speed"], n["start_radius"]
        velocity, length, friction = n["start_velocity"], n["length"], n["friction"]
        there = np.where(length > start, length, math.nan)
        root = np.hypot(1.0, friction)
        out = w / (root + friction)
        first = (velocity + w * (root + friction) * start) / (out + w * (root + friction))
        back, second = -w * (root + friction), start - first
        # The growing exponential exceeds the distance by the decaying one, which may be negative and delay the body.
        high = np.log((there + np.abs(second)) / first) / out + 1.0 / w
        time = regula_falsi(lambda t: slides_out(w, start, velocity, friction, t)[0] - there, 0.0 * w, high)
        radius, rate = slides_out(w, start, velocity, friction, time)
        time = time - (radius - there) / rate
        _, rate = slides_out(w, start, velocity, friction, time)
        slowing = -2.0 * friction * w
        with np.errstate(all="ignore"):
            both = np.where(-slowing * time > 1e-18, np.expm1(slowing * time) / slowing, time)
        squares = 0.5 * out * first**2 * np.expm1(2.0 * out * time)
        squares = squares + 0.5 * back * second**2 * np.expm1(2.0 * back * time)
        squares = squares + 2.0 * out * back * first * second * both
        return {
            "time": time,
            "turned_angle": w * time,
            "relative_speed": rate,
            "absolute_speed": np.hypot(rate, w * there),
            "leaving_angle": np.arctan2(w * there, rate),
            "start_reaction": 2.0 * mass * w * velocity,
            "reaction": 2.0 * mass * w * rate,
            "centrifugal_force": mass * w**2 * there,
            "moment": 2.0 * mass * w * rate * there,
            "work": mass * w**2 * (there - start) * (there + start),
            "friction_work": 2.0 * friction * mass * w * squares,
        }

    def panels(self, given: Numbers | None = None) -> tuple[Panel, ...]:
        """The path seen from above; distance from the axis and reaction over the time to the end of the lever."""
        end = self.own_values()["time"]
        time = np.linspace(0.0, end, _SHOWN)
        given = (np.full(time.shape, v) for v in (self.speed, self.start_radius, self.start_velocity, self.friction))
        radius, rate = slides_out(*given, time)
        reaction = 2.0 * self.mass * self.speed * rate
        rows = (PanelAxis("distance", "m", "r"), radius), (PanelAxis("reaction", "N", "R"), reaction)
        over_time = (Panel(TIME, y, time, (Curve("", row),), (Mark("", end, row[-1]),)) for y, row in rows)
        turned = np.exp(1j * self.speed * time)
        leaves = (rate[-1] + 1j * self.speed * radius[-1]) * turned[-1]
        track = radius * turned
        beyond = track[-1] + 0.5 * self.length * leaves / np.abs(leaves)
        levers = [path("", (0.0, self.length * turn), True) for turn in turned[:: (_SHOWN - 1) // _LEVERS]]
        lines = (*levers, path("path", track), path("velocity as it leaves", (track[-1], beyond)))
        return plan(lines, "From above"), *over_time


def slides_out(
    speed: np.ndarray, radius: np.ndarray, velocity: np.ndarray, friction: np.ndarray, time: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Distance from the axis and velocity along the lever after a given time.

    Parameters
    ----------
    speed : ndarray
        Angular speed of the lever [rad/s].
    radius, velocity : ndarray
        Initial values [m], [m/s].
    friction : ndarray
        Coefficient of friction.
    time : ndarray
        [s].

    Returns
    -------
    radius, velocity : ndarray
        [m], [m/s].
    """
    root = np.hypot(1.0, friction)
    out, back = speed / (root + friction), -speed * (root + friction)
    first = (velocity - back * radius) / (out - back)
    second = radius - first
    growing, fading = first * np.exp(out * time), second * np.exp(back * time)
    return growing + fading, out * growing + back * fading
