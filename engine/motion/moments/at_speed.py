"""M(φ, ω, t) at given speeds: of motors by their characteristics, of loads by powers of the speed.

What depends on the crank angle and on time is tabulated, a row for each power of the speed; what depends on the speed
alone belongs to the variant. Every stepper takes its moments from here, for variants side by side. Angles are turned
in the direction of motion, so that a moment is positive where it drives; a speed may be negative.
"""

from typing import NamedTuple

import numba
import numpy as np
from numba import types

from engine.compiling.blocks import gather, hand_out, in_lanes
from engine.compiling.decorators import driver, inlined
from engine.compiling.running import prepare, spread
from engine.compiling.widths import LANES
from engine.cycle.panels.lanes import Memory, rows
from engine.laws.elementary import power
from engine.laws.motor_characteristics import induction_motor, induction_motor_slope

# Rows of a block's drive: the motors with a straight characteristic together, then constants of each induction motor.
LEVEL, FALL, KLOSS = range(3)
PER_MOTOR = 5
# Rows of loads in a block: over ω⁰, ω¹ and ω².
POLYNOMIAL = 3


# Between two speeds, where several motors together are looked at.
SPEEDS_BETWEEN = 33


class Drive(NamedTuple):
    """What depends on the speed alone, for every variant.

    Attributes
    ----------
    rows : ndarray (2 + 5 motors, variants)
        Moment of the motors with a straight characteristic, reduced, rows[0] + rows[1]·ω; then of each induction motor
        breakdown moment, breakdown slip, rotor ratio, synchronous speed, and speed ratio to the crank.
    exponents : ndarray (laws, variants)
        Powers of ω of the power laws.
    """

    rows: np.ndarray
    exponents: np.ndarray

    @property
    def line(self) -> np.ndarray:
        """Of the straight characteristic, (2, variants)."""
        return self.rows[:KLOSS]

    @property
    def kloss(self) -> np.ndarray:
        """Constants of the induction motors, (motors, 5, variants)."""
        motors = (self.rows.shape[0] - KLOSS) // PER_MOTOR
        return self.rows[KLOSS:].reshape(motors, PER_MOTOR, self.rows.shape[1])

    def some(self, chosen: np.ndarray) -> "Drive":
        """Of some of the variants, by index."""
        return Drive(*(np.ascontiguousarray(part[..., chosen]) for part in self))


@inlined
def straight_motors(drive: Memory, lane: int, speed: float) -> float:
    """Moment of the motors with a straight characteristic."""
    return drive[LEVEL, lane] + drive[FALL, lane] * speed


@inlined
def polynomial(loads: Memory, begin: int, lane: int, speed: float) -> float:
    """Moment of loads over ω⁰, ω¹ and ω², whose rows follow each other from `begin` on."""
    return loads[begin, lane] + speed * (loads[begin + 1, lane] + speed * loads[begin + 2, lane])


@inlined
def polynomial_slope(loads: Memory, begin: int, lane: int, speed: float) -> float:
    """Derivative of `polynomial` by the speed."""
    return loads[begin + 1, lane] + 2.0 * speed * loads[begin + 2, lane]


@inlined
def add_induction_motors(wide: int, drive: Memory, motors: int, speed: Memory, moment: Memory) -> None:
    """Add the moments of induction motors at a speed of each lane.

    Parameters
    ----------
    wide : int
        In how many lanes.
    drive : rows (2 + 5 motors, LANES)
    motors : int
        How many there are.
    speed, moment : row (LANES,)
    """
    for motor in range(motors):
        k = KLOSS + PER_MOTOR * motor
        for lane in range(wide):
            ratio = drive[k + 4, lane]
            moment[lane] += ratio * induction_motor(
                drive[k, lane], drive[k + 1, lane], drive[k + 2, lane], drive[k + 3, lane], ratio * speed[lane]
            )


@inlined
def add_induction_slopes(wide: int, drive: Memory, motors: int, speed: Memory, slope: Memory) -> None:
    """Add their derivatives by the speed; parameters as of `add_induction_motors`."""
    for motor in range(motors):
        k = KLOSS + PER_MOTOR * motor
        for lane in range(wide):
            ratio = drive[k + 4, lane]
            slope[lane] += (ratio * ratio) * induction_motor_slope(
                drive[k, lane], drive[k + 1, lane], drive[k + 2, lane], drive[k + 3, lane], ratio * speed[lane]
            )


@inlined
def add_power(wide: int, load: Memory, exponent: Memory, speed: Memory, moment: Memory) -> None:
    """Add the moment of a load over a power of the speed; all are rows, (LANES,)."""
    for lane in range(wide):
        moment[lane] += load[lane] * power(abs(speed[lane]), exponent[lane])


@inlined
def add_power_slope(wide: int, load: Memory, exponent: Memory, speed: Memory, slope: Memory) -> None:
    """Add its derivative by the speed; parameters as of `add_power`."""
    for lane in range(wide):
        w, n = speed[lane], exponent[lane]
        slope[lane] += n * (load[lane] * power(abs(w), n)) / w


class Moments(NamedTuple):
    """Moment of the motors, of each channel of loads [N·m], and ∂M/∂ω of all of them [N·m·s]."""

    motors: np.ndarray
    loads: np.ndarray
    slope: np.ndarray

    @property
    def total(self) -> np.ndarray:
        """The reduced moment."""
        return self.motors + self.loads.sum(axis=0)


def moments_at(
    drive: Drive, channel_of: np.ndarray, loads: np.ndarray, powers: np.ndarray, omega: np.ndarray
) -> Moments:
    """Moments at given places and speeds of many variants.

    Parameters
    ----------
    drive : Drive
    channel_of : ndarray (laws,) of int
        Channel of each power law.
    loads : ndarray (channels, 3, places or 1, variants)
        Over ω⁰, ω¹ and ω²; those of one place hold at all.
    powers : ndarray (laws, places or 1, variants)
        Over ω to a power of its own.
    omega : ndarray (places, variants)
        [rad/s].
    """
    found = np.empty((2 + loads.shape[0], *omega.shape))
    if omega.size:
        parts = (drive.rows, drive.exponents, channel_of, loads, powers, omega)
        given = [part if part.flags.carray else np.array(part, order="C") for part in parts]
        count = len(given[0]) + len(given[1]) + POLYNOMIAL + 1 + len(found)

        def arguments() -> tuple:
            return (*given, rows(count), found)

        if not moments_of_blocks.overloads:
            prepare(moments_of_blocks, [types.intp, types.intp, *(numba.typeof(part) for part in arguments())])
        spread(moments_of_blocks, -(-omega.shape[1] // LANES), arguments)
    return Moments(found[0], found[2:], found[1])


@driver
def moments_of_blocks(
    begin: int,
    end: int,
    drives: np.ndarray,
    every_exponent: np.ndarray,
    channel_of: np.ndarray,
    loads: np.ndarray,
    powers: np.ndarray,
    omega: np.ndarray,
    room: np.ndarray,
    found: np.ndarray,
) -> None:
    """Moments of the motors, ∂M/∂ω, and moments of each channel into `found`, for blocks begin … end − 1 of variants.

    Arguments are those of `moments_at`, and memory for a block.
    """
    drive, exponents = in_lanes(room), in_lanes(room[drives.shape[0] :])
    after = room[drives.shape[0] + every_exponent.shape[0] :]
    place, speeds, moments = in_lanes(after), in_lanes(after[POLYNOMIAL:]), in_lanes(after[POLYNOMIAL + 1 :])
    motors, speed, of_motors, slope = (drives.shape[0] - KLOSS) // PER_MOTOR, speeds[0], moments[0], moments[1]
    for b in range(begin, end):
        first = b * LANES
        gather(drives, first, drive)
        gather(every_exponent, first, exponents)
        for j in range(omega.shape[0]):
            at = j if loads.shape[2] > 1 else 0
            gather(omega[j : j + 1], first, speeds)
            for lane in range(LANES):
                of_motors[lane] = straight_motors(drive, lane, speed[lane])
                slope[lane] = drive[FALL, lane]
            add_induction_motors(LANES, drive, motors, speed, of_motors)
            add_induction_slopes(LANES, drive, motors, speed, slope)
            for channel in range(loads.shape[0]):
                gather(loads[channel, :, at], first, place)
                for lane in range(LANES):
                    moments[2 + channel, lane] = polynomial(place, 0, lane, speed[lane])
                    slope[lane] += polynomial_slope(place, 0, lane, speed[lane])
            for law in range(powers.shape[0]):
                gather(powers[law, at : at + 1], first, place)
                add_power(LANES, place[0], exponents[law], speed, moments[2 + channel_of[law]])
                add_power_slope(LANES, place[0], exponents[law], speed, slope)
            hand_out(moments, first, found[:, j])


def greatest_moment(drive: Drive, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Greatest moment of the motors by magnitude, at any speed between two of each variant.

    Parameters
    ----------
    drive : Drive
    low, high : ndarray (variants,)
        [rad/s].
    """
    # A straight characteristic alone is greatest at one of its ends.
    several = len(drive.kloss) + drive.line.any() > 1
    share = np.linspace(0.0, 1.0, SPEEDS_BETWEEN if several else 2)[:, None]
    speeds = [low + share * (high - low)]
    for _, slip, _, synchronous, ratio in drive.kloss:
        # Motor and generator are strongest at the breakdown slip.
        speeds += [np.clip(synchronous / ratio * (1.0 + way * slip), low, high)[None] for way in (-1.0, 1.0)]
    none = np.zeros((1, POLYNOMIAL, 1, low.size))
    at = np.concatenate(speeds)
    motors = moments_at(drive, np.zeros(0, np.int64), none, np.zeros((0, 1, low.size)), at).motors
    return np.abs(motors).max(axis=0)
