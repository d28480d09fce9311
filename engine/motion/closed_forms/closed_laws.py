"""Motion with constant inertia under moments that are constant or follow the speed, in closed form.

Time, angle and speed at the end of a run follow from formulas (`engine.motion.closed_forms.closed_forms`,
`engine.motion.closed_forms.induction_run_up`), and so do the works: ∫dφ,
∫ω dφ and ∫ω² dφ for moments that grow with ω⁰, ω¹ and ω². What is never reached is NaN.

All speeds are in the direction of motion, moments positive where they drive.
"""

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from engine.compiling.decorators import scalar
from engine.compiling.running import over_variants
from engine.laws.motor_characteristics import induction_motor
from engine.motion.cases import MomentLaw
from engine.motion.closed_forms.closed_forms import (
    constant_moment,
    constant_moment_to_angle,
    constant_moment_to_speed,
    linear_moment,
    linear_moment_squares,
    linear_moment_to_speed,
    quadratic_moment,
    quadratic_moment_to_speed,
)
from engine.motion.closed_forms.induction_run_up import induction_motor_over_slip, induction_motor_to_slip
from engine.motion.runs.run_progress import Ends

CONSTANT, LINEAR, SQUARE = int(MomentLaw.CONSTANT), int(MomentLaw.LINEAR), int(MomentLaw.SQUARE)
ROUNDS = 60


class End(IntEnum):
    """How a run ends."""

    TIME = 0
    SPEED = 1
    ANGLE = 2


TO_TIME, TO_SPEED = int(End.TIME), int(End.SPEED)


class MotionEquation(NamedTuple):
    """Coefficients of the equation of motion, each last (variants,).

    Attributes
    ----------
    inertia : ndarray (variants,)
    line : ndarray (2, variants)
        Moment of the motors, line[0] + line[1]·ω.
    kloss : ndarray (motors, 5, variants)
        Constants of induction motors, as in `Drive`.
    loads : ndarray (channels, 3, variants)
        Moments over ω⁰, ω¹ and ω².
    """

    inertia: np.ndarray
    line: np.ndarray
    kloss: np.ndarray
    loads: np.ndarray


class Motion(NamedTuple):
    """How a run goes, in closed form; arrays (variants,) unless said, NaN where there is none.

    Attributes
    ----------
    time, angle, omega : ndarray
        At the end [s], [rad], [rad/s].
    works : ndarray (channels + 1, variants)
        [J], of the motors and each channel.
    squares : ndarray
        ∫M² dt of the motors [N²·m²·s].
    slowest, fastest, peak : ndarray
        Least and greatest speed [rad/s], greatest moment of the motors by magnitude [N·m].
    """

    time: np.ndarray
    angle: np.ndarray
    omega: np.ndarray
    works: np.ndarray
    squares: np.ndarray
    slowest: np.ndarray
    fastest: np.ndarray
    peak: np.ndarray


def speed_motion(law: MomentLaw, balance: MotionEquation, omega: np.ndarray, ends: Ends) -> Motion:
    """Motion under a moment that is constant or follows the speed.

    Parameters
    ----------
    law : MomentLaw
        CONSTANT, LINEAR (DC motors too), SQUARE, or KLOSS: one induction motor and constant loads until a speed.
    balance : MotionEquation
    omega : ndarray (variants,)
        Speed at the begin [rad/s].
    ends : Ends
    """
    return _kloss(balance, omega, ends) if law == MomentLaw.KLOSS else _polynomial(law, balance, omega, ends)


def _goal(ends: Ends) -> tuple[End, np.ndarray]:
    if ends.standing:
        return End.SPEED, np.zeros_like(ends.speed)
    if np.isfinite(ends.time).all():
        return End.TIME, ends.time
    return (End.SPEED, ends.speed) if np.isfinite(ends.speed).all() else (End.ANGLE, ends.turned)


# Constant moment, falling with the speed or with its square


def _polynomial(law: MomentLaw, balance: MotionEquation, omega: np.ndarray, ends: Ends) -> Motion:
    sums = balance.loads.sum(axis=0)
    sums[:2] += balance.line
    end, goal = _goal(ends)
    out = np.empty((4, omega.size))
    polynomial_runs(omega.size, int(law), int(end), balance.inertia, sums, omega, goal, out)
    time, angle, last, integral = out
    line, loads = balance.line, balance.loads
    higher = loads[:, 2] if law == MomentLaw.SQUARE else loads[:, 1]
    works = np.concatenate(((line[0] * angle + line[1] * integral)[None], loads[:, 0] * angle + higher * integral))
    squares = line[0] ** 2 * time + line[1] * (2.0 * line[0] * angle + line[1] * integral)
    peak = np.maximum(np.abs(line[0] + line[1] * omega), np.abs(line[0] + line[1] * last))
    return _one_way(time, angle, omega, last, works, squares, peak)


@over_variants
def polynomial_runs(
    begin: int,
    end: int,
    law: int,
    ending: int,
    inertia: np.ndarray,
    sums: np.ndarray,
    omega: np.ndarray,
    goal: np.ndarray,
    out: np.ndarray,
) -> None:
    """Time, angle, speed at the end of runs, and ∫ω dφ (of a fan ∫ω² dφ), into out[:, begin … end − 1].

    `sums` (3, variants) holds the moments over ω⁰, ω¹ and ω².
    """
    for v in range(begin, end):
        i, m0, falls, w0 = inertia[v], sums[0, v], -(sums[2, v] if law == SQUARE else sums[1, v]), omega[v]
        if ending == TO_TIME:
            time = goal[v]
            w, angle = after(law, i, m0, falls, w0, time)
        elif ending == TO_SPEED:
            w = goal[v]
            time, angle = until_speed(law, i, m0, falls, w0, w)
        else:
            angle = goal[v]
            time, w = until_angle(law, i, m0, falls, w0, angle)
        out[0, v], out[1, v], out[2, v], out[3, v] = time, angle, w, 0.0
        if law == LINEAR:
            out[3, v] = linear_moment_squares(i, m0, falls, w0, time)
        elif law == SQUARE:
            # d(ω²)/dφ = 2 (m0 − falls·ω²)/I is linear.
            out[3, v] = linear_moment(i, m0 + m0, falls + falls, w0 * w0, angle)[1]


@scalar
def after(law: int, inertia: float, m0: float, falls: float, omega0: float, t: float) -> tuple[float, float]:
    """Speed and angle at time t under M = m0, m0 − falls·ω or m0 − falls·ω²."""
    if law == CONSTANT:
        return constant_moment(inertia, m0, omega0, t)
    if law == LINEAR:
        return linear_moment(inertia, m0, falls, omega0, t)
    return quadratic_moment(inertia, m0, falls, omega0, t)


@scalar
def until_speed(law: int, inertia: float, m0: float, falls: float, omega0: float, omega: float) -> tuple[float, float]:
    """Time and angle to a speed; the moment as of `after`."""
    if law == CONSTANT:
        return constant_moment_to_speed(inertia, m0, omega0, omega)
    if law == LINEAR:
        return linear_moment_to_speed(inertia, m0, falls, omega0, omega)
    return quadratic_moment_to_speed(inertia, m0, falls, omega0, omega)


@scalar
def until_angle(law: int, inertia: float, m0: float, falls: float, omega0: float, angle: float) -> tuple[float, float]:
    """Time to an angle and the speed there, NaN where it isn't reached; the moment as of `after`.

    By Newton's method on the time. A machine that slows down is always later than its tangent; one that speeds up is
    later than with its first acceleration, and after one step beyond the end comes back to it from there.
    """
    if law == CONSTANT:
        return constant_moment_to_angle(inertia, m0, omega0, angle)
    first = m0 - falls * (omega0 if law == LINEAR else omega0 * omega0)
    t = angle / omega0 if first <= 0.0 else constant_moment_to_angle(inertia, first, omega0, angle)[0]
    for _ in range(ROUNDS):
        omega, phi = after(law, inertia, m0, falls, omega0, t)
        if not omega > 0.0:
            break
        change = (angle - phi) / omega
        t += change
        if abs(change) <= 4e-16 * t:
            return t, after(law, inertia, m0, falls, omega0, t)[0]
    return np.nan, np.nan


# Induction motor and constant load


def _kloss(balance: MotionEquation, omega: np.ndarray, ends: Ends) -> Motion:
    load, out = -balance.loads[:, 0].sum(axis=0), np.empty((4, omega.size))
    kloss_runs(omega.size, balance.kloss[0], load, balance.inertia, omega, ends.speed, out)
    time, angle, motor_impulse, peak = out
    rise = ends.speed - omega
    of_loads = balance.loads[:, 0] * angle
    gained = 0.5 * balance.inertia * rise * (ends.speed + omega)
    works = np.concatenate(((gained + load * angle)[None], of_loads))
    # I dω = (M − M_L) dt, so ∫M² dt = I ∫(M + M_L) dω + M_L² ∫dt.
    squares = balance.inertia * (motor_impulse + load * rise) + load * load * time
    return _one_way(time, angle, omega, ends.speed, works, squares, peak)


def _one_way(
    time: np.ndarray,
    angle: np.ndarray,
    omega: np.ndarray,
    last: np.ndarray,
    works: np.ndarray,
    squares: np.ndarray,
    peak: np.ndarray,
) -> Motion:
    """Motion that speeds up or slows down throughout, as it does under moments that follow the speed alone."""
    slowest, fastest = np.minimum(omega, last), np.maximum(omega, last)
    return Motion(time, angle, last, works, np.where(squares < 0.0, 0.0, squares), slowest, fastest, peak)


@over_variants
def kloss_runs(
    begin: int,
    end: int,
    kloss: np.ndarray,
    load: np.ndarray,
    inertia: np.ndarray,
    omega: np.ndarray,
    speed: np.ndarray,
    out: np.ndarray,
) -> None:
    """Time, angle, ∫M dω and greatest |M| of the motor on the way to a speed, into out[:, begin … end − 1]."""
    for v in range(begin, end):
        most, slip_b, rotor, synchronous, ratio = kloss[0, v], kloss[1, v], kloss[2, v], kloss[3, v], kloss[4, v]
        slip0, slip = (synchronous - ratio * omega[v]) / synchronous, (synchronous - ratio * speed[v]) / synchronous
        own = inertia[v] / ratio / ratio
        time, angle = induction_motor_to_slip(own, most, slip_b, rotor, synchronous, load[v] / ratio, slip0, slip)
        out[0, v], out[1, v] = time, angle / ratio
        out[2, v] = synchronous * induction_motor_over_slip(most, slip_b, rotor, slip0, slip)
        peak = 0.0
        for s in (slip0, slip, slip_b, -slip_b):
            if min(slip0, slip) <= s <= max(slip0, slip):
                moment = induction_motor(most, slip_b, rotor, synchronous, synchronous * (1.0 - s))
                peak = max(peak, abs(ratio * moment))
        out[3, v] = peak
