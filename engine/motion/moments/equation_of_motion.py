"""The equation of motion at instants, I·ε + ½ω²·dI/dφ = M(φ, ω, t), of many variants.

It is that of the systems that are integrated, at given states. Angles are turned in the scene's direction of motion; ω
may be negative.
"""

from typing import NamedTuple

import numpy as np

from engine.motion.moments.breaks import JUMP
from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.one_speed import CHANNELS

# Limits of a first step in time: relative to a time constant, to the maximum angle, and to the breakdown slip.
STIFFEST, FINER = 1.0, 2.0


class MotionAt(NamedTuple):
    """A motion at some instants, in the scene's direction of motion, each (instants, variants).

    Attributes
    ----------
    inertia : ndarray
        Reduced inertia with the flywheel [kg·m²].
    epsilon : ndarray
        Acceleration [rad/s²]; NaN if friction leaves no equilibrium.
    motors : ndarray
        Torque of the motors [N·m].
    loads : ndarray (channels, instants, variants)
        Torque of each channel of loads, with friction in the pairs among the harmful ones [N·m].
    """

    inertia: np.ndarray
    epsilon: np.ndarray
    motors: np.ndarray
    loads: np.ndarray

    @property
    def total(self) -> np.ndarray:
        """The reduced torque [N·m]."""
        return self.motors + self.loads.sum(axis=0)

    def known_better(self, total: np.ndarray) -> "MotionAt":
        """The same with a total torque that is known more accurately than from the speed, where it isn't NaN."""
        known = np.isfinite(total)
        epsilon = np.where(known, self.epsilon + (total - self.total) / self.inertia, self.epsilon)
        return self._replace(epsilon=epsilon, motors=np.where(known, total - self.loads.sum(axis=0), self.motors))


class EquationOfMotion:
    """The equation of motion of a set of variants.

    Parameters
    ----------
    dynamics : Dynamics
        With the acting actions.
    variants : Variants
    start : ndarray (variants,)
        Crank angle at which the angle turned is 0 [rad].
    who : ndarray of int, optional
        Indices of the variants that arrays are of; by default, all.
    """

    def __init__(
        self, dynamics: Dynamics, variants: Variants, start: np.ndarray, who: np.ndarray | None = None
    ) -> None:
        self.dynamics, self.variants, self.start = dynamics, variants, start
        self.who = np.arange(variants.count) if who is None else who

    def of(self, who: np.ndarray) -> "EquationOfMotion":
        """The equation for columns of variants with these indices."""
        return EquationOfMotion(self.dynamics, self.variants, self.start, who)

    def some(self, who: np.ndarray) -> "EquationOfMotion":
        """The equation of a subset of the variants, by index."""
        return EquationOfMotion(self.dynamics, self.variants.some(who), self.start[who])

    def inertia(self, turned: np.ndarray) -> np.ndarray:
        """Reduced inertia with the flywheel at angles turned, (…, variants) [kg·m²]."""
        places = self.start[self.who] + self.variants.direction[self.who] * turned
        return self.dynamics.inertia(self.variants, places, self.who)

    def with_servos(
        self, turned: np.ndarray, omega: np.ndarray, time: np.ndarray, facing: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Kinetic energy (…, variants) [J], and powers (channels, …, variants) [W], with servos."""
        names = ("energy", *(f"{name} power" for name in CHANNELS))
        energy, *powers = self.evaluated(names, True, turned, omega, time, facing)
        return energy, np.array(powers)

    def along(self, turned: np.ndarray, omega: np.ndarray, time: np.ndarray, facing: np.ndarray) -> MotionAt:
        """The motion at instants, (instants, variants) or (variants,).

        `facing`, +1 or −1, is the direction of motion that resistances oppose.
        """
        dynamics = self.dynamics
        found = np.empty((3 + len(CHANNELS), *turned.shape))
        over_angle = (facing > 0.0) & (not dynamics.in_time)
        for in_time, chosen in ((False, over_angle), (True, ~over_angle)):
            some = np.flatnonzero(chosen)
            if some.size:
                rows = (row[..., some] for row in (turned, omega, time, facing))
                names = ("inertia", "acceleration", "motors", *CHANNELS)
                found[..., some] = self.of(self.who[some]).evaluated(names, in_time, *rows)
        inertia, epsilon, motors, *loads = found
        return MotionAt(inertia, epsilon, motors, np.array(loads))

    def evaluated(
        self,
        names: tuple[str, ...],
        in_time: bool,
        turned: np.ndarray,
        omega: np.ndarray,
        time: np.ndarray,
        facing: np.ndarray,
    ) -> np.ndarray:
        """Shown nodes of the system over time, or for forward motion of that over the angle, (names, …, variants)."""
        dynamics, variants, who = self.dynamics, self.variants, self.who
        system = dynamics.by_time if in_time else dynamics.by_angle
        forward = facing > 0.0
        numbers, columns = dynamics.moving(system, variants), who
        if not forward.all():
            numbers = np.concatenate((numbers, dynamics.moving(system, variants, -1.0)), axis=1)
            columns = np.where(forward, who, who + variants.count)
        places = self.start[who] + variants.direction[who] * turned
        speed = facing * omega
        states = (turned, speed) if in_time else (0.5 * dynamics.inertia(variants, places, who) * speed**2,)
        found = system.at(numbers, places, states, [system.rows_of[name] for name in names], time, columns)
        for row, name in zip(found, names, strict=True):
            if name in ("acceleration", "motors", *CHANNELS):
                row *= facing
        return found

    def torque(self, turned: np.ndarray, energy: np.ndarray, time: np.ndarray) -> np.ndarray:
        """Reduced torque on variants that move forwards with a kinetic energy, (variants,) [N·m]."""
        system, who = self.dynamics.by_angle, self.who
        places = self.start[who] + self.variants.direction[who] * turned
        return system.at(self.dynamics.moving(system, self.variants), places, (energy,), [0], time, who)[0]

    def to_break(self, turned: np.ndarray) -> np.ndarray:
        """Distance from angles turned, (…, variants), to the nearest break, negative behind; infinite without one."""
        own, who, cycle = self.variants, self.who, self.dynamics.cycle
        breaks = own.direction[who] * (own.breaks.angles[:, who] - self.start[who])
        apart = breaks.reshape(len(breaks), *(1,) * (turned.ndim - 1), breaks.shape[1]) - turned
        # Breaks recur after a cycle, which is infinite if they do not.
        if np.isfinite(cycle):
            apart = np.mod(apart + 0.5 * cycle, cycle) - 0.5 * cycle
        apart = np.concatenate((np.where(np.isnan(apart), np.inf, apart), np.full((1, *turned.shape), np.inf)))
        return np.take_along_axis(apart, np.abs(apart).argmin(axis=0)[None], axis=0)[0]

    def break_offset(self, turned: np.ndarray) -> np.ndarray:
        """Offset at which torques are evaluated from angles turned, (…, variants) [rad]: 0 except at a break."""
        return np.where(np.abs(self.to_break(turned)) <= 2.0 * JUMP, JUMP, 0.0)

    def acceleration(
        self, turned: np.ndarray, omega: np.ndarray, time: np.ndarray, facing: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """ε [rad/s²], and the decay rate of ω [1/s], (variants,)."""
        epsilon, steepness = self.evaluated(("acceleration", "steepness"), True, turned, omega, time, facing)
        return epsilon, np.abs(steepness)

    def sets_off(self, turned: np.ndarray, time: np.ndarray) -> np.ndarray:
        """Direction in which machines at rest start: +1, −1, or 0 if resistances or a jump of a load hold them."""
        still, offset = np.zeros_like(turned), self.break_offset(turned)
        forward, backwards = (
            self.acceleration(turned + sign * offset, still, time, np.full_like(turned, sign))[0]
            for sign in (1.0, -1.0)
        )
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
            for curve, ratio in self.dynamics.drives(self.variants.numbers.of_variants(self.who)):
                for apart in curve.breakdowns:
                    near = np.abs(curve.no_load_speed / ratio - omega) + apart / ratio
                    h = np.fmin(h, FINER * spacing * near / change)
        return h
