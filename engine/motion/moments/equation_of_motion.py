"""The equation of motion at instants, I·ε + ½ω²·dI/dφ = M(φ, ω, t) + M_f, of many variants.

The torque M_f equivalent to friction in pairs follows from the reactions, and these from ω² and ε; the secant method
finds ε and M_f together. Angles are turned in the scene's direction of motion; ω may be negative.
"""

from typing import NamedTuple

import numpy as np

from engine.motion.moments.at_speed import Moments
from engine.motion.moments.breaks import beside
from engine.motion.moments.dynamics import Dynamics, Rows, Variants
from engine.motion.one_speed import CHANNELS
from engine.stepping.walk import MOST_SECANTS, NEARLY_FOUND, SOLVED_TO

# The field of the loads on pairs for friction.
FRICTION_MOMENT = "friction_moment"
# Limits of a first step in time: relative to a time constant, to the maximum angle, and to the breakdown slip.
STIFFEST, FINER = 1.0, 2.0


class Attached(NamedTuple):
    """Inertia behind a coupling that turns with the crank, and torque on it, reduced to the crank.

    Attributes
    ----------
    moment : ndarray
        In the direction of motion [N·m].
    inertia : ndarray
        [kg·m²]; infinite for a crank at rest or at constant speed.
    """

    moment: np.ndarray | float
    inertia: np.ndarray | float


ALONE, UNIFORM = Attached(0.0, 0.0), Attached(0.0, np.inf)


class EquationOfMotion:
    """The equation of motion of a set of variants.

    Parameters
    ----------
    dynamics : Dynamics
        With the acting actions.
    variants : Variants
    start : ndarray (variants,)
        Crank angle at which the angle turned is 0 [rad].
    """

    def __init__(self, dynamics: Dynamics, variants: Variants, start: np.ndarray) -> None:
        self.dynamics, self.variants, self.start = dynamics, variants, start
        self._mirrored: Variants | None = None

    def some(self, who: np.ndarray) -> "EquationOfMotion":
        """The equation of a subset of the variants, by index."""
        return EquationOfMotion(self.dynamics, self.variants.some(who), self.start[who])

    def at(
        self, turned: np.ndarray, omega: np.ndarray, time: np.ndarray, facing: np.ndarray, attached: Attached = ALONE
    ) -> tuple[Rows, Moments]:
        """Rows and torques at one instant, (1, variants), as from `along`."""
        return self.along(turned[None], omega[None], time[None], facing, attached)

    def along(
        self, turned: np.ndarray, omega: np.ndarray, time: np.ndarray, facing: np.ndarray, attached: Attached = ALONE
    ) -> tuple[Rows, Moments]:
        """Rows and torques at instants, (instants, variants); the torque of friction is included in harmful loads.

        `facing`, +1 or −1, is the direction of motion that resistances oppose. Friction depends on the acceleration,
        and so on the inertia attached to the crank.
        """
        places = self.start + self.variants.direction * turned
        rows = self.dynamics.rows(self.variants, places, time, omega)
        if (facing < 0.0).any():
            forward, backwards = facing > 0.0, self._backwards(places, time, omega)
            rows = Rows(*(np.where(forward, a, b) for a, b in zip(rows, backwards, strict=True)))
        moments = self.dynamics.moments(self.variants, rows, omega)
        if self.dynamics.friction is not None:
            channel = CHANNELS.index("harmful") if self.dynamics.works else 0
            moments.loads[channel] += self._friction(places, omega, time, facing, rows, moments.total, attached)
        return rows, moments

    def _backwards(self, places: np.ndarray, time: np.ndarray, omega: np.ndarray) -> Rows:
        """Rows of machines that move backwards: resistances are reversed, odd orders of ω are not."""
        rows = self.dynamics.rows(self._mirror(), places, time, omega)
        # Computed for the opposite direction, in which ω > 0; converted back, torques, dI/dφ and each odd power of ω
        # change sign.
        signs = np.array([-1.0, 1.0, -1.0])[None, :, None, None]
        return Rows(rows.inertia, -rows.inertia_phi, signs * rows.loads, -rows.powers)

    def _mirror(self) -> Variants:
        """The variants with the opposite direction."""
        if self._mirrored is None:
            own = self.variants
            parameters = self.dynamics.reduction.tabulation.parameters(own.numbers, -own.direction, own.ends)
            self._mirrored = own._replace(direction=-own.direction, parameters=parameters)
        return self._mirrored

    def _friction(
        self,
        places: np.ndarray,
        omega: np.ndarray,
        time: np.ndarray,
        facing: np.ndarray,
        rows: Rows,
        moment: np.ndarray,
        attached: Attached,
    ) -> np.ndarray:
        """Torque of friction, in the direction of motion, at the resulting ε; `moment` is the sum of all others."""
        own, loads, way = self.variants, self.dynamics.friction, self.variants.direction
        parameters = np.require(np.where(facing > 0.0, *own.rubbing), requirements="CW")

        def rubbed(epsilon: np.ndarray) -> np.ndarray:
            return way * loads(own, parameters, places, np.abs(omega), way * epsilon, time)[FRICTION_MOMENT]

        with np.errstate(all="ignore"):
            inertia = rows.inertia + attached.inertia
            free = (moment + attached.moment - 0.5 * omega * omega * rows.inertia_phi) / inertia
            before, found = free, rubbed(free)
            # Residual of I ε = I ε_free + M_f, divided by I.
            left_before = found / inertia
            here = free + left_before
            for _ in range(MOST_SECANTS):
                found = rubbed(here)
                left = free + found / inertia - here
                pending = np.abs(left) > SOLVED_TO * (np.abs(free) + np.abs(found / inertia))
                if not pending.any():
                    break
                secant = here - left * (here - before) / (left - left_before)
                before, left_before = here, left
                here = np.where(pending & np.isfinite(secant), secant, here)
            nearly = np.abs(left) <= NEARLY_FOUND * (np.abs(free) + np.abs(found / inertia))
        return np.where(nearly, found, np.nan)

    def beside(self, turned: np.ndarray) -> np.ndarray:
        """Offset at which torques are evaluated from angles turned, (…, variants) [rad]: 0 except at a break."""
        own = self.variants
        return beside(own.direction * (own.breaks.angles - self.start), turned, self.dynamics.cycle)

    def acceleration(
        self, turned: np.ndarray, omega: np.ndarray, time: np.ndarray, facing: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """ε [rad/s²], and the decay rate of ω [1/s]."""
        rows, moments = self.at(turned, omega, time, facing)
        inertia, slope = rows.inertia[0], rows.inertia_phi[0]
        with np.errstate(all="ignore"):
            epsilon = (moments.total[0] - 0.5 * omega * omega * slope) / inertia
            return epsilon, np.abs(moments.slope[0] - omega * slope) / inertia

    def sets_off(self, turned: np.ndarray, time: np.ndarray) -> np.ndarray:
        """Direction in which machines at rest start: +1, −1, or 0 if resistances hold them."""
        still, one = np.zeros_like(turned), np.ones_like(turned)
        forward, backwards = (self.acceleration(turned, still, time, way * one)[0] for way in (1.0, -1.0))
        return np.where(forward > 0.0, 1.0, np.where(backwards < 0.0, -1.0, 0.0))

    def first_step(
        self, turned: np.ndarray, omega: np.ndarray, time: np.ndarray, facing: np.ndarray, spacing: np.ndarray
    ) -> np.ndarray:
        """Length of a first trial step [s], which turns by at most `spacing` [rad].

        From rest, the unit of time is the time for one radian. If a motor drives the speed towards an equilibrium, the
        step is finer the farther the speed is from it. Kloss's curve has its bend within the breakdown slip, however
        flat it is before.
        """
        epsilon, rate = self.acceleration(turned, omega, time, facing)
        ahead = self.acceleration(turned + facing * spacing, omega, time, facing)[0]
        speed, change = np.abs(omega), np.abs(epsilon)
        with np.errstate(all="ignore"):
            share = FINER * spacing * (1.0 + speed * rate / change) ** 0.2
            # Near an equilibrium ε is small, but may not be so slightly ahead.
            pace = np.fmax(speed + np.sqrt(change), np.sqrt(np.abs(ahead - epsilon) / spacing))
            h = np.fmin(spacing / pace, np.fmin(share, STIFFEST) / rate)
            for _, slip, _, synchronous, ratio in self.variants.drive.kloss:
                near = np.abs(synchronous / ratio - omega) + slip * synchronous / ratio
                h = np.fmin(h, FINER * spacing * near / change)
        return h
