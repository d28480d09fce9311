"""A body on an elastic tie about a fixed point: peak tie force after an impulse, compared with a slow spin-up.

Set off across the tie of length r₀ with the speed v, the body moves in a straight line at first and stretches the tie,
which deflects it. Angular momentum and energy are conserved: m v r₀ = m r² φ̇ and, at the maximum of r,
½m v² = ½m(r φ̇)² + ½c(r − r₀)²; with x = (r − r₀)/r₀ and κ = c r₀²/(m v²)

    κ x (1 + x)² = 2 + x,   F = c r₀ x.

After a slow spin-up to the speed v on its circle, the tie force is F = m v²/r = c(r − r₀). For a stiff tie the impulse
causes 2mv²/r₀, twice as much. The tie bursts where F equals its strength, which limits v; for an elastic tie the limit
after an impulse is closer to that of a spin-up.

Source: J. P. Den Hartog, Mechanics (conservation of energy and of moment of momentum).
"""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field
from scipy.integrate import solve_ivp

from engine.cycle.regula_falsi import regula_falsi
from engine.elements.element import Element, NamedRows, Numbers
from engine.elements.panels import VELOCITY, Curve, Mark, Panel, PanelAxis, circle, path, plan
from engine.parts.actions import Force, Stiffness
from engine.parts.skeleton import Length, Mass, Speed
from engine.words.quantity import main_result

# Samples of a curve.
_SHOWN = 721


class TetheredBody(Element):
    """A body on an elastic tie about a fixed point, set off by an impulse across it or spun up slowly.

    `length` is the unstretched length of the tie, `strength` the force at which it bursts, `speed` that of the body. A
    thin rim of radius R and section A corresponds to a tie of length R, stiffness 2πEA/R and 2π times the strength of
    its section.
    """

    picture: ClassVar = "pull"

    type: Literal["tethered_body"]
    mass: Annotated[Mass, Field(gt=0)]
    length: Annotated[Length, Field(gt=0)]
    stiffness: Annotated[Stiffness, Field(gt=0)]
    strength: Annotated[Force, Field(gt=0)]
    speed: Annotated[Speed, Field(gt=0)]

    def named(self, n: Numbers) -> NamedRows:
        """Results of a set of variants."""
        mass, length, stiffness, strength, speed = (n[k] for k in ("mass", "length", "stiffness", "strength", "speed"))
        stretch = length * _relative_stretch(stiffness * length**2 / (mass * speed**2))
        # The positive root of c y² + c r₀ y − m v² = 0.
        taut, doubled = stiffness * length, 2.0 * mass * speed**2
        slow = doubled / (taut + np.sqrt(taut**2 + 2.0 * stiffness * doubled))
        last = strength / stiffness
        by_spin_up = np.sqrt(strength * (length + last) / mass)
        by_impulse = (length + last) * np.sqrt(strength / (mass * (2.0 * length + last)))
        yield main_result("impulse", "impulse that gives the speed at once", "N s"), mass * speed
        yield main_result("impulse_stretch", "peak stretch of the tie after the impulse", "m"), stretch
        yield main_result("impulse_force", "peak force in the tie after the impulse", "N"), stiffness * stretch
        yield main_result("spin_up_stretch", "stretch of the tie, spun up slowly to the speed", "m"), slow
        yield main_result("spin_up_force", "force in the tie, spun up slowly to the speed", "N"), stiffness * slow
        words = "peak force after the impulse over that of a slow spin-up"
        yield main_result("dynamic_factor", words, "1"), stretch / slow
        words = "speed at which the tie bursts, given by an impulse"
        yield main_result("impulse_burst_speed", words, "m s-1"), by_impulse
        yield main_result("spin_up_burst_speed", "speed at which the tie bursts, spun up slowly", "m s-1"), by_spin_up
        words = "whether the impulse bursts the tie (1 or 0)"
        yield main_result("bursts_by_impulse", words, "1", exact=True), (speed > by_impulse).astype(float)
        words = "whether a slow spin-up to the speed bursts the tie (1 or 0)"
        yield main_result("bursts_by_spin_up", words, "1", exact=True), (speed > by_spin_up).astype(float)

    def panels(self) -> tuple[Panel, ...]:
        """The path after the impulse, and the peak tie force over the speed."""
        own, kinds = self.own_values(), {"impulse": "by an impulse", "spin_up": "spun up slowly"}
        bursts = {kind: own[f"{kind}_burst_speed"] for kind in kinds}
        speed = np.linspace(0.0, 1.15 * max(self.speed, *bursts.values()), _SHOWN + 1)[1:]
        found = self.over("speed", speed)
        curves = [Curve(words, found[f"{kind}_force"]) for kind, words in kinds.items()]
        marks = [Mark("", at, self.strength) for at in bursts.values()]
        marks += [Mark("strength of the tie", None, self.strength), Mark("its speed", self.speed, None)]
        x, y = VELOCITY, PanelAxis("peak pull", "N", "F")
        pull = Panel(x, y, speed, curves, marks, limits=(0.0, 2.2 * self.strength))
        track = self._track()
        farthest = track[np.abs(track).argmax()]
        slow = self.length + own["spin_up_stretch"]
        lines = (
            circle("tie without force", self.length),
            circle("spun up slowly", slow),
            path("after the impulse", track),
            path("peak pull", (0.0, farthest)),
        )
        return plan(lines, "Along the axis"), pull

    def _track(self) -> np.ndarray:
        """The path after the impulse, for about one turn."""
        last = math.tau * self.length / self.speed

        def motion(_: float, state: np.ndarray) -> tuple[complex, complex]:
            place, velocity = state
            return velocity, self.stiffness / self.mass * (self.length / abs(place) - 1.0) * place

        begin = self.length + 0j, 1j * self.speed
        return solve_ivp(motion, (0.0, last), begin, rtol=1e-8, max_step=last / _SHOWN).y[0]


def _relative_stretch(stiffness: np.ndarray) -> np.ndarray:
    """The x of κ x (1 + x)² = 2 + x."""
    # At 2/κ and at 1/√κ the left side exceeds the right one.
    high = np.minimum(2.0 / stiffness, 1.0 / np.sqrt(stiffness))
    return regula_falsi(lambda x: stiffness * x * (1.0 + x) ** 2 - 2.0 - x, 0.0 * high, high)
