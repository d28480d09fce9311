"""The equation of motion in time, I·ε + ½ω²·dI/dφ = M(φ, ω, t), by the method of Dormand and Prince of order eight.

For what the energy form can't do: start from rest, the last of a run-down, ω through zero, moments that depend on
time. Every stage evaluates the machine at the angles it comes to, for all variants at once; nothing is interpolated.
The step of each variant follows its motion, by the estimated error.

Angles here are turned in the direction of motion that the scene gives; ω may be negative.
"""

from typing import NamedTuple

import numba
import numpy as np
from numba import types

from engine.compiling.nothing import nothing
from engine.compiling.running import prepare, spread
from engine.compiling.tiles import FILLS_TILE, TileFunction
from engine.compiling.widths import LANES
from engine.laws.runge_kutta import ORDER_EIGHT
from engine.motion.moments.at_speed import Moments
from engine.motion.moments.dynamics import Dynamics, Rows, Variants
from engine.motion.steppers.places import form_of, source_of
from engine.motion.steppers.rubbing import Rubbing, new_rubbing_room
from engine.motion.steppers.time_lanes import (
    AFTER,
    FASTEST,
    FOUND,
    MISSED,
    MOTOR,
    OMEGA_AFTER,
    SLOWEST,
    SQUARES,
    new_time_room,
    step_in_time,
)

# In place of a function where no pair rubs.
NO_FUNCTION = TileFunction(nothing)
# Product of step and decay rate with which a first step is tried.
STIFFEST = 1.0
# Share of a time constant that it takes, in units of the angle it may turn.
FINER = 2.0


class State(NamedTuple):
    """State of each variant, (variants,): angle turned [rad], speed [rad/s], time [s]; works (sorts, variants) [J].

    `works` holds the work of the motors and of each channel of loads, `squares` the integral of the motors' moment
    squared over time [N²·m²·s].
    """

    turned: np.ndarray
    omega: np.ndarray
    time: np.ndarray
    works: np.ndarray
    squares: np.ndarray


def state_at(turned: np.ndarray, omega: np.ndarray, time: np.ndarray, channels: int) -> State:
    """State without works yet."""
    return State(turned, omega, time, np.zeros((channels + 1, turned.size)), np.zeros(turned.size))


class Step(NamedTuple):
    """A step: the state after it, what it misses by what it may miss, and the least and greatest speed on the way."""

    after: State
    missed: np.ndarray
    slowest: np.ndarray
    fastest: np.ndarray


class TimeForm:
    """Steps of a set of variants in time.

    Parameters
    ----------
    dynamics : Dynamics
        With the actions at work.
    variants : Variants
    start : ndarray (variants,)
        Crank angle where the angle turned is 0 [rad].
    """

    def __init__(self, dynamics: Dynamics, variants: Variants, start: np.ndarray) -> None:
        self.dynamics, self.variants, self.start = dynamics, variants, start
        self._mirrored: Variants | None = None

    def at(self, turned: np.ndarray, omega: np.ndarray, time: np.ndarray, facing: np.ndarray) -> tuple[Rows, Moments]:
        """Rows and moments at an instant, (1, variants), as `along` gives them."""
        return self.along(turned[None], omega[None], time[None], facing)

    def along(
        self, turned: np.ndarray, omega: np.ndarray, time: np.ndarray, facing: np.ndarray
    ) -> tuple[Rows, Moments]:
        """Rows and moments at instants, (instants, variants); `facing` +1 or −1 is the way that resistances resist."""
        places = self.start + self.variants.direction * turned
        rows = self.dynamics.rows(self.variants, places, time)
        if (facing < 0.0).any():
            rows = _choose(facing > 0.0, rows, self._backwards(places, time))
        moments = self.dynamics.moments(self.variants, rows, omega)
        return rows, moments

    def _backwards(self, places: np.ndarray, time: np.ndarray) -> Rows:
        """Rows of machines that turn against their direction: resistances change sides, odd orders of ω don't."""
        rows = self.dynamics.rows(self._mirror(), places, time)
        # Made for the opposite direction, in which ω > 0; back in our own: moments and dI/dφ change sign, and so does
        # each odd power of ω.
        signs = np.array([-1.0, 1.0, -1.0])[None, :, None, None]
        return Rows(rows.inertia, -rows.inertia_phi, signs * rows.loads, -rows.powers)

    def _mirror(self) -> Variants:
        """The variants as if they turned the other way."""
        if self._mirrored is None:
            own = self.variants
            parameters = self.dynamics.reduction.tabulation.parameters(own.numbers, -own.direction, own.ends)
            self._mirrored = own._replace(direction=-own.direction, parameters=parameters)
        return self._mirrored

    def acceleration(
        self, turned: np.ndarray, omega: np.ndarray, time: np.ndarray, facing: np.ndarray
    ) -> tuple[np.ndarray, ...]:
        """ε [rad/s²], the powers of the motors and channels [W], the motors' moment, and the decay rate of ω [1/s]."""
        rows, moments = self.at(turned, omega, time, facing)
        inertia, slope = rows.inertia[0], rows.inertia_phi[0]
        with np.errstate(all="ignore"):
            epsilon = (moments.total[0] - 0.5 * omega * omega * slope) / inertia
            rate = np.abs(moments.slope[0] - omega * slope) / inertia
        powers = np.concatenate((moments.motors, moments.loads[:, 0])) * omega
        return epsilon, powers, moments.motors[0], rate

    def step(self, state: State, h: np.ndarray, facing: np.ndarray, goal: np.ndarray, tolerance: float) -> Step:
        """One step of the given length.

        A step up to a jump of the moments must not look beyond it: no stage goes farther than the goal.

        Parameters
        ----------
        state : State
        h : ndarray (variants,)
            [s].
        facing : ndarray (variants,)
            +1 or −1, the sign of ω throughout the step.
        goal : ndarray (variants,)
            Angle turned, ahead, that is not passed [rad].
        tolerance : float
            What may be missed, as a share of the angle turned and of the speed or its change.
        """
        dynamics, own = self.dynamics, self.variants
        form = form_of(dynamics, len(own.drive.kloss))
        source, tabulation = source_of(dynamics, form), dynamics.reduction.tabulation
        parameters = self.parameters_facing(facing)
        given = np.array(
            [self.start, own.direction, own.flywheel, state.turned, state.omega, state.time, h, facing, goal], float
        )
        found = np.empty((FOUND + form.channels, own.count))
        parts = parameters, own.drive.rows, own.drive.exponents, given
        parts = [np.require(part, requirements="CW") for part in parts]

        rub, rubbing, own_numbers, curves = self._rubbing(facing)

        def arguments() -> tuple:
            room = new_rubbing_room(own_numbers.shape[0], curves)
            room = new_time_room(form, parameters.shape[0], source.target.size, room)
            fill, laws = tabulation.function("curves_at"), dynamics.channel_of_laws
            return fill, source, ORDER_EIGHT, form, laws, tolerance, *parts, found, rub, rubbing, own_numbers, room

        if not step_in_time.overloads:
            kinds = [FILLS_TILE if part is rub else numba.typeof(part) for part in arguments()[1:]]
            prepare(step_in_time, [types.intp, types.intp, FILLS_TILE, *kinds])
        spread(step_in_time, -(-own.count // LANES), arguments)
        works = state.works + np.concatenate((found[MOTOR : MOTOR + 1], found[FOUND:]))
        after = State(found[AFTER], found[OMEGA_AFTER], state.time + h, works, state.squares + found[SQUARES])
        return Step(after, found[MISSED], found[SLOWEST], found[FASTEST])

    def parameters_facing(self, facing: np.ndarray) -> np.ndarray:
        """Numbers of the rows, (numbers, variants), for machines that move forward or backwards."""
        if not (facing < 0.0).any():
            return self.variants.parameters
        return np.where(facing > 0.0, self.variants.parameters, self._mirror().parameters)

    def _rubbing(self, facing: np.ndarray) -> tuple[TileFunction, Rubbing, np.ndarray, int]:
        """Functions, source, numbers (numbers, variants) and curves of the friction in pairs; here there is none."""
        nowhere = np.zeros(0, np.int64)
        return NO_FUNCTION, Rubbing(np.zeros(1), nowhere, nowhere, -1, -1), np.zeros((1, facing.size)), 1

    def at_rest(self, state: State) -> np.ndarray:
        """Which way a machine at rest sets off: +1, −1, or 0 where resistances hold it."""
        still, ways = np.zeros_like(state.omega), []
        for facing in (np.ones_like(still), -np.ones_like(still)):
            ways.append(self.acceleration(state.turned, still, state.time, facing)[0])
        return np.where(ways[0] > 0.0, 1.0, np.where(ways[1] < 0.0, -1.0, 0.0))

    def first_step(self, state: State, spacing: float, facing: np.ndarray) -> np.ndarray:
        """Length of a step to try first, which turns no farther than `spacing` [rad].

        From rest, time is counted in units of the time that one radian takes. Where a motor pulls the speed towards
        its own, the more finely the farther off it is. Kloss' curve bends within the breakdown slip, however little it
        falls before.
        """
        epsilon, _, _, rate = self.acceleration(state.turned, state.omega, state.time, facing)
        ahead = self.acceleration(state.turned + facing * spacing, state.omega, state.time, facing)[0]
        speed, change = np.abs(state.omega), np.abs(epsilon)
        with np.errstate(all="ignore"):
            share = FINER * spacing * (1.0 + speed * rate / change) ** 0.2
            # About an equilibrium ε is small, but not so a little farther on.
            pace = np.fmax(speed + np.sqrt(change), np.sqrt(np.abs(ahead - epsilon) / spacing))
            h = np.fmin(spacing / pace, np.fmin(share, STIFFEST) / rate)
            for _, slip, _, synchronous, ratio in self.variants.drive.kloss:
                near = np.abs(synchronous / ratio - state.omega) + slip * synchronous / ratio
                h = np.fmin(h, FINER * spacing * near / change)
        return h


def _choose(forward: np.ndarray, one: Rows, other: Rows) -> Rows:
    return Rows(*(np.where(forward, a, b) for a, b in zip(one, other, strict=True)))
