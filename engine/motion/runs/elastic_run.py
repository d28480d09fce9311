"""A run of a machine on an elastic shaft, over time: I₁φ̈₁ = M_m − T, I(φ₂)φ̈₂ + ½I′φ̇₂² = T + M, T = kq + bq̇.

The twist q = φ₁ − φ₂, both speeds and the angle turned are followed by steps of order eight, each as long as its
estimated error and the shaft's vibration allow, of all variants side by side. Resistances change sides with the
machine's speed: a step ends where it comes to a stop. There it goes on, turns back, or sticks until the shaft's moment
overcomes what resists, whichever way.

With a backlash Δ, q is counted from where the shaft is just in touch forwards. It has a moment T = kq + bq̇ in touch
forwards, T = k(q + Δ) + bq̇ in touch backwards, and none between; damping doesn't pull. A step ends where touch is lost,
as T passes 0, and where it is made.
"""

from typing import NamedTuple

import numpy as np

from engine.laws.runge_kutta import ORDER_EIGHT
from engine.motion.moments.at_speed import POLYNOMIAL, moments_at
from engine.motion.moments.equation_of_motion import EquationOfMotion
from engine.verdicts import Verdict

# State: twist, speed at the motors' end, angle turned by the machine, its speed.
TWIST, MOTOR, TURNED, MACHINE = range(4)
# A step is no longer than so many radians of the shaft's vibration, and misses so much at most.
FINEST, SUREST = 0.3, 1e-9
MOST_STEPS = 200_000
_GROWS, _SHRINKS, _SAFE = 4.0, 0.2, 0.9
# To so small a share of a step a stop is located.
_LOCATED, _ROUNDS = 1e-12, 60


class ElasticRun(NamedTuple):
    """What machines did, (variants,): greatest magnitude of the shaft's moment and when, state at the end, stops.

    Attributes
    ----------
    greatest, greatest_at : ndarray
        [N·m], [s].
    state : ndarray (4, variants)
        Twist [rad], speed at the motors' end [rad/s], angle turned [rad], speed of the machine [rad/s].
    stops, closings : ndarray
        How often the machine came to a stop on the way, and how often the backlash closed.
    verdict : ndarray of uint8
    history : ndarray (6, instants) or None
        Time, state and moment of the shaft at the ends of the steps of the first variant, where it is recorded.
    """

    greatest: np.ndarray
    greatest_at: np.ndarray
    state: np.ndarray
    stops: np.ndarray
    closings: np.ndarray
    verdict: np.ndarray
    history: np.ndarray | None


class _Going:
    """Machines on their shafts: rates of their state; `touch` says where they are in touch, +1, 0 or −1."""

    def __init__(self, form: EquationOfMotion, shaft: np.ndarray, backlash: np.ndarray, touch: np.ndarray) -> None:
        self.form, (self.stiffness, self.damping, self.own) = form, shaft
        self.backlash, self.touch = backlash, touch
        channels = len(form.dynamics.channels)
        self._unloaded = np.zeros((channels, POLYNOMIAL, 1, self.own.size))
        self._no_laws = np.zeros((len(form.dynamics.laws), 1, self.own.size))

    def moment(self, y: np.ndarray) -> np.ndarray:
        """Of the shaft."""
        twist = y[TWIST] + np.where(self.touch < 0.0, self.backlash, 0.0)
        return np.where(self.touch == 0.0, 0.0, self.stiffness * twist + self.damping * (y[MOTOR] - y[MACHINE]))

    def moment_rate(self, rates: np.ndarray) -> np.ndarray:
        """Its derivative by time."""
        rate = self.stiffness * rates[TWIST] + self.damping * (rates[MOTOR] - rates[MACHINE])
        return np.where(self.touch == 0.0, 0.0, rate)

    def rates(self, y: np.ndarray, time: np.ndarray, sense: np.ndarray) -> np.ndarray:
        """Derivatives of the state; `sense` +1 or −1 is that of the machine's motion, 0 where it sticks."""
        form = self.form
        rows, moments = form.at(y[TURNED], y[MACHINE], time, np.where(sense < 0.0, -1.0, 1.0))
        drive, channel_of = form.variants.drive, form.dynamics.channel_of_laws
        motors = moments_at(drive, channel_of, self._unloaded, self._no_laws, y[MOTOR][None]).motors[0]
        shaft = self.moment(y)
        rest = shaft + moments.loads[:, 0].sum(axis=0) - 0.5 * y[MACHINE] ** 2 * rows.inertia_phi[0]
        turning = np.where(sense == 0.0, 0.0, rest / rows.inertia[0])
        return np.stack([y[MOTOR] - y[MACHINE], (motors - shaft) / self.own, y[MACHINE], turning])

    def excess(self, y: np.ndarray, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """By how much the shaft's moment overcomes what resists a machine at rest, forwards and backwards."""
        shaft, still, one = self.moment(y), np.zeros_like(time), np.ones_like(time)
        forwards, backwards = (self.form.at(y[TURNED], still, time, way * one)[1] for way in (1.0, -1.0))
        return shaft + forwards.loads[:, 0].sum(axis=0), -shaft - backwards.loads[:, 0].sum(axis=0)

    def sets_off(self, y: np.ndarray, time: np.ndarray) -> np.ndarray:
        """Which way a machine at rest sets off, 0 where it sticks."""
        forwards, backwards = self.excess(y, time)
        return np.where(forwards > 0.0, 1.0, np.where(backwards > 0.0, -1.0, 0.0))

    def step(
        self, y: np.ndarray, time: np.ndarray, h: np.ndarray, sense: np.ndarray, first: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """State after a step, and its estimated error; `first` are the rates before it."""
        method, slopes = ORDER_EIGHT, [first]
        for s in range(1, method.stages):
            at = y + h * sum(a * k for a, k in zip(method.matrix[s], slopes, strict=False) if a != 0.0)
            slopes.append(self.rates(at, time + method.shares[method.place_of[s]] * h, sense))

        def weighted(weights: np.ndarray) -> np.ndarray:
            return h * sum(b * k for b, k in zip(weights, slopes, strict=True) if b != 0.0)

        fine, coarse = weighted(method.fine[0]), weighted(method.coarse[0])
        both = np.hypot(fine, coarse)
        return y + weighted(method.weights), np.where(both > 0.0, fine**2 / np.where(both > 0.0, both, 1.0), 0.0)

    def holding(self, y: np.ndarray) -> np.ndarray:
        """What is below 0 where touch was lost, or made; infinite without backlash."""
        twist, slip = self.stiffness * y[TWIST], self.damping * (y[MOTOR] - y[MACHINE])
        behind = twist + self.stiffness * self.backlash
        # Pressed together, and the damper not pulling.
        forwards, backwards = np.minimum(twist, twist + slip), np.minimum(-behind, -behind - slip)
        parted = -np.maximum(forwards, backwards)
        held = np.where(self.touch == 0.0, parted, self.touch * self.moment(y))
        return np.where(self.backlash > 0.0, held, np.inf)

    def touched(self, y: np.ndarray) -> np.ndarray:
        """Touch after it was lost or made."""
        sides = np.where(y[TWIST] > -0.5 * self.backlash, 1.0, -1.0)
        return np.where(self.touch == 0.0, sides, 0.0)

    def watched(self, y: np.ndarray, time: np.ndarray, sense: np.ndarray) -> np.ndarray:
        """What is below 0 where touch has changed, or a machine has turned back or, held before, been set off."""
        return np.minimum(self.turned(y, time, sense), self.holding(y))

    def turned(self, y: np.ndarray, time: np.ndarray, sense: np.ndarray) -> np.ndarray:
        """What is below 0 where a machine has turned back or, held before, been set off."""
        moving = sense * y[MACHINE]
        if not (sense == 0.0).any():
            return moving
        return np.where(sense == 0.0, -np.maximum(*self.excess(y, time)), moving)


def steps_on_shaft(frequency: np.ndarray, duration: np.ndarray) -> np.ndarray:
    """About how many steps a run takes by the shaft's vibration, (variants,); 0 where it isn't followed.

    Parameters
    ----------
    frequency : ndarray (variants,)
        Natural frequency [rad/s].
    duration : ndarray (variants,)
        [s].
    """
    steps = np.ceil(duration * frequency / FINEST)
    return np.where(steps > MOST_STEPS, 0.0, steps)


def run_on_shaft(
    form: EquationOfMotion,
    shaft: np.ndarray,
    frequency: np.ndarray,
    begin: np.ndarray,
    duration: np.ndarray,
    backlash: np.ndarray,
    coarser: float = 1.0,
    record: bool = False,
) -> ElasticRun:
    """Follow machines on their shafts.

    Parameters
    ----------
    form : EquationOfMotion
        Of the machines without what turns at the motors' end.
    shaft : ndarray (3, variants)
        Stiffness, damping, inertia at the motors' end.
    frequency : ndarray (variants,)
        Natural frequency [rad/s].
    begin : ndarray (4, variants)
        State at the begin, the twist without backlash.
    duration : ndarray (variants,)
        [s].
    backlash : ndarray (variants,)
        [rad]; a shaft that begins at rest has to close all of it.
    coarser : float
        How many times as long steps may be.
    record : bool
        Whether to keep the history of the first variant.
    """
    y, time, closings = begin.copy(), np.zeros_like(duration), np.zeros_like(duration)
    at_rest = (y[TWIST] == 0.0) & (y[MOTOR] == 0.0) & (y[MACHINE] == 0.0)
    touch = np.where(backlash > 0.0, np.where(at_rest, 0.0, np.where(y[TWIST] < 0.0, -1.0, 1.0)), 1.0)
    y[TWIST] -= np.where(touch < 1.0, backlash, 0.0)
    going = _Going(form, shaft, backlash, touch)
    sense = np.where(y[MACHINE] != 0.0, np.sign(y[MACHINE]), going.sets_off(y, time))
    longest, allowed = coarser * FINEST / frequency, SUREST * coarser**8
    h, stops = 0.1 * longest, np.zeros_like(duration)
    greatest, greatest_at = np.abs(going.moment(y)), time.copy()
    slope = going.rates(y, time, sense)
    history = [np.array([0.0, *y[:, 0], going.moment(y)[0]])]
    # No steps are lost on what so many can't follow.
    hopeless = duration > MOST_STEPS * longest
    for _ in range(MOST_STEPS):
        left = np.where(hopeless, 0.0, duration - time)
        if not (left > 0.0).any():
            break
        whole = h >= left
        h = np.where(whole, left, h)
        after, missed = going.step(y, time, h, sense, slope)
        sizes = np.maximum(np.abs(after), np.abs(y)) + np.abs(h * slope)
        sizes[TWIST] = np.maximum(sizes[TWIST], np.abs(going.moment(y)) / going.stiffness)
        sizes[TURNED] += 1.0
        sizes[MOTOR] = sizes[MACHINE] = np.maximum(sizes[MOTOR], sizes[MACHINE])
        with np.errstate(all="ignore"):
            error = np.max(np.where(sizes > 0.0, np.abs(missed) / sizes, 0.0), axis=0) / allowed
            factor = np.clip(_SAFE * error**-0.125, _SHRINKS, _GROWS)
        taken = (error <= 1.0) & (left > 0.0)
        changed = taken & (going.watched(after, time + h, sense) < 0.0)
        stopped = parted = np.zeros_like(changed)
        if changed.any():
            h = np.where(changed, _located(going, y, time, h, sense, slope), h)
            there, _ = going.step(y, time, h, sense, slope)
            after = np.where(changed, there, after)
            stopped = changed & (going.turned(after, time + h, sense) < 0.0)
            parted = changed & (going.holding(after) < 0.0)
            after[MACHINE] = np.where(stopped, 0.0, after[MACHINE])
        before_moment, before_rate = going.moment(y), going.moment_rate(slope)
        y, time = np.where(taken, after, y), np.where(taken, time + h, time)
        time = np.where(taken & whole & ~changed, duration, time)
        if stopped.any():
            stops += stopped & (sense != 0.0)
            sense = np.where(stopped, going.sets_off(y, time), sense)
        arrived = going.rates(y, time, sense)
        peak, when = _peak(before_moment, going.moment(y), before_rate * h, going.moment_rate(arrived) * h)
        if parted.any():
            closings += parted & (going.touch == 0.0)
            going.touch = np.where(parted, going.touched(y), going.touch)
            # A damper is hit with full speed.
            hit = np.abs(going.moment(y))
            peak, when = np.where(parted & (hit > peak), hit, peak), np.where(parted & (hit > peak), 1.0, when)
            sense = np.where(parted & (sense == 0.0), going.sets_off(y, time), sense)
            arrived = going.rates(y, time, sense)
        higher = taken & (peak > greatest * (1.0 + 1e-12))
        greatest, greatest_at = np.where(higher, peak, greatest), np.where(higher, time - (1.0 - when) * h, greatest_at)
        slope = np.where(taken, arrived, slope)
        h = np.minimum(np.where(np.isfinite(factor), factor, _SHRINKS) * np.maximum(h, 1e-9 * longest), longest)
        if record and taken[0]:
            history.append(np.array([time[0], *y[:, 0], going.moment(y)[0]]))
    unfinished = np.where(hopeless, Verdict.SHAFT_RIGID, Verdict.NO_END)
    verdict = np.where(time >= duration, Verdict.OK, unfinished).astype(np.uint8)
    return ElasticRun(greatest, greatest_at, y, stops, closings, verdict, np.array(history).T if record else None)


def _located(
    going: _Going, y: np.ndarray, time: np.ndarray, h: np.ndarray, sense: np.ndarray, slope: np.ndarray
) -> np.ndarray:
    """Lengths of steps to where machines stop, are set off, part or touch, by bisection with secants (Illinois)."""
    low, high = np.zeros_like(h), h.copy()
    at_low = np.maximum(going.watched(y, time, sense), 0.0)
    at_high = going.watched(going.step(y, time, h, sense, slope)[0], time + h, sense)
    for _ in range(_ROUNDS):
        if (high - low <= _LOCATED * h).all():
            break
        with np.errstate(all="ignore"):
            middle = high - at_high * (high - low) / (at_high - at_low)
        inside = (middle > low) & (middle < high)
        middle = np.where(inside, middle, 0.5 * (low + high))
        value = going.watched(going.step(y, time, middle, sense, slope)[0], time + middle, sense)
        above = value >= 0.0
        low, high = np.where(above, middle, low), np.where(above, high, middle)
        at_low, at_high = np.where(above, value, 0.5 * at_low), np.where(above, 0.5 * at_high, value)
    return high


def _peak(
    first: np.ndarray, last: np.ndarray, leaves: np.ndarray, arrives: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Greatest magnitude on a step of a cubic by values and slopes at its ends, and its place, a share of the step."""
    top, place = np.abs(last), np.ones_like(last)
    cubic, square = leaves + arrives - 2.0 * (last - first), 3.0 * (last - first) - 2.0 * leaves - arrives
    with np.errstate(all="ignore"):
        root = np.sqrt(square**2 - 3.0 * cubic * leaves)
        for flat in ((-square + root) / (3.0 * cubic), (-square - root) / (3.0 * cubic), -leaves / (2.0 * square)):
            value = np.abs(first + flat * (leaves + flat * (square + flat * cubic)))
            # The last of them is the place of a parabola, where the cubic is none.
            better = (flat > 0.0) & (flat < 1.0) & (value > top)
            top, place = np.where(better, value, top), np.where(better, flat, place)
    return top, place
