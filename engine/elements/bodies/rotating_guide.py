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
from engine.elements.element import Element, NamedRows, Numbers
from engine.elements.panels import TIME, Curve, Mark, Panel, PanelAxis, path, plan
from engine.parts.skeleton import AngularSpeed, Length, Mass, Number, Speed
from engine.words.quantity import main_result

# Samples of a curve; number of lever positions drawn.
_SHOWN, _LEVERS = 721, 8
# Range of the logarithm of the angle in which the end of the lever is sought; terms of the series for small angles;
# nodes of the quadrature, and the largest exponent for which it is used.
_FAR, _TERMS, _NODES, _NEAR = 200.0, 20, 24, 4.0


class RotatingGuide(Element):
    """A body that slides outwards on a straight lever rotating in a horizontal plane with constant `speed`.

    At time 0 it is at `start_radius` from the axis, with `start_velocity` along the lever; it leaves the lever at
    `length`.
    """

    ascending: ClassVar = {("start_radius", "length"): "the body slides out"}
    picture: ClassVar = "sliding"

    type: Literal["rotating_guide"]
    mass: Annotated[Mass, Field(gt=0)]
    speed: Annotated[AngularSpeed, Field(gt=0)]
    start_radius: Annotated[Length, Field(gt=0)]
    start_velocity: Annotated[Speed, Field(ge=0)] = 0.0
    length: Annotated[Length, Field(gt=0)]
    friction: Annotated[Number, Field(ge=0)] = 0.0

    def named(self, n: Numbers) -> NamedRows:
        """Results of a set of variants."""
        mass, w, start = n["mass"], n["speed"], n["start_radius"]
        velocity, length, friction = n["start_velocity"], n["length"], n["friction"]
        there = np.where(length > start, length, math.nan)
        own = start, velocity / w, friction
        first, second, root = _exponentials(*own)
        # The growing exponential exceeds the distance by the decaying one, which may be negative and delay the body.
        high = np.log((there + np.abs(second)) / first) * (root + friction) + 1.0
        way = there - start
        turned = np.log(high)
        turned = np.exp(regula_falsi(lambda y: np.log(_slides_out(*own, np.exp(y))[0] / way), turned - _FAR, turned))
        slid, rate = _slides_out(*own, turned)
        turned = turned - (slid - way) / rate
        rate = w * _slides_out(*own, turned)[1]
        squares, time = w * _squares(*own, turned), turned / w
        yield main_result("time", "time to the end of the lever", "s"), time
        yield main_result("turned_angle", "angle by which the lever turns meanwhile", "rad"), turned
        yield main_result("relative_speed", "speed along the lever at its end", "m s-1"), rate
        words = "speed of the body as it leaves the lever"
        yield main_result("absolute_speed", words, "m s-1"), np.hypot(rate, w * there)
        words = "angle between the body's path and the lever as it leaves"
        yield main_result("leaving_angle", words, "rad"), np.arctan2(w * there, rate)
        yield main_result("start_reaction", "reaction of the lever at the start", "N"), 2.0 * mass * w * velocity
        yield main_result("reaction", "peak reaction of the lever, at its end", "N"), 2.0 * mass * w * rate
        words = "centrifugal inertia force at the end of the lever"
        yield main_result("centrifugal_force", words, "N"), mass * w**2 * there
        words = "peak drive torque of the lever, with the body at its end"
        yield main_result("moment", words, "N m"), 2.0 * mass * w * rate * there
        work = mass * w**2 * (there - start) * (there + start)
        yield main_result("work", "work done on the lever", "J"), work
        yield main_result("friction_work", "work lost by friction", "J"), 2.0 * friction * mass * w * squares

    def panels(self) -> tuple[Panel, ...]:
        """The path seen from above; distance from the axis and reaction over the time to the end of the lever."""
        end = self.own_values()["time"]
        time = np.linspace(0.0, end, _SHOWN)
        given = (np.full(time.shape, v) for v in (self.start_radius, self.start_velocity / self.speed, self.friction))
        slid, rate = _slides_out(*given, self.speed * time)
        radius, rate = self.start_radius + slid, self.speed * rate
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


def _slides_out(
    radius: np.ndarray, reach: np.ndarray, friction: np.ndarray, turned: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Displacement along the lever [m] and its derivative by the angle `turned`.

    `radius` is the initial distance from the axis, `reach` the initial derivative.
    """
    root = np.hypot(1.0, friction)
    back = root + friction
    a, b = turned / back, -back * turned
    # For a small angle the exponentials cancel: the divided difference of (exp(z) − 1)/z from its series.
    small_a, small_b = np.minimum(a, 1.0), np.maximum(b, -1.0)
    term, power, series = np.ones_like(a), np.ones_like(a), 0.0
    for k in range(_TERMS):
        series = series + term / math.factorial(k + 2)
        power = power * small_b
        term = term * small_a + power
    far = 0.5 * (np.expm1(a) * back + np.expm1(b) / back) / root
    pushed = np.where(back * turned < 1.0, turned * turned * series, far)
    grown = -0.5 * np.exp(a) * np.expm1(-2.0 * root * turned) / root
    kept = 0.5 * (np.exp(a) / back + np.exp(b) * back) / root
    return radius * pushed + reach * grown, radius * grown + reach * kept


def _exponentials(
    radius: np.ndarray, reach: np.ndarray, friction: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Factors C₁ and C₂ of the growing and the decaying exponential [m], and √(1 + f²)."""
    root = np.hypot(1.0, friction)
    first = 0.5 * (reach + (root + friction) * radius) / root
    return first, 0.5 * (radius / (root + friction) - reach) / root, root


def _squares(radius: np.ndarray, reach: np.ndarray, friction: np.ndarray, turned: np.ndarray) -> np.ndarray:
    """Integral of the squared derivative of `_slides_out` over the lever's angle [m²]."""
    first, second, root = _exponentials(radius, reach, friction)
    back = root + friction
    with np.errstate(all="ignore"):
        both = np.where(friction * turned > 1e-18, -0.5 * np.expm1(-2.0 * friction * turned) / friction, turned)
        far = 0.5 * first**2 / back * np.expm1(2.0 * turned / back)
        far = far - 0.5 * back * second**2 * np.expm1(-2.0 * back * turned) - 2.0 * first * second * both
    # For a small angle they cancel.
    places, weights = np.polynomial.legendre.leggauss(_NODES)
    rates = (_slides_out(radius, reach, friction, 0.5 * (1.0 + y) * turned)[1] for y in places)
    near = 0.5 * turned * sum(weight * rate**2 for weight, rate in zip(weights, rates, strict=True))
    return np.where(back * turned < _NEAR, near, far)
