"""M(φ, ω, t) at given speeds: of motors by their characteristics, of loads by powers of the speed.

Terms that depend on crank angle and time are tabulated, one row for each power of the speed; terms that depend only on
the speed are numbers of the variant. Angles are turned in the direction of motion, so a positive torque drives; the
speed may be negative.
"""

from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import gather, hand_out, in_lanes
from engine.compiling.decorators import driver
from engine.compiling.running import spread
from engine.compiling.widths import LANES
from engine.cycle.panels.lanes import rows
from engine.laws.elementary import power
from engine.laws.motor_characteristics import BENDS, PER_BEND, PER_MOTOR, motors_at

# Rows of loads in a block: coefficients of ω⁰, ω¹ and ω².
POLYNOMIAL = 3


# Samples between two speeds for the peak torque of several motors together.
SPEEDS_BETWEEN = 33


class Drive(NamedTuple):
    """Terms that depend only on the speed, for every variant.

    Attributes
    ----------
    rows : ndarray (2 + 2 bends + 5 induction motors, variants)
        Reduced torque rows[0] + rows[1]·ω of the motors with a linear characteristic; change of slope and speed of each
        bend; then for each induction motor breakdown torque, breakdown slip, rotor ratio, synchronous speed, and speed
        ratio to the crank.
    exponents : ndarray (laws, variants)
        Exponents of ω of the power laws.
    no_load_speeds : ndarray (motors, variants)
        No-load speed of every motor, reduced to the crank [rad/s].
    bent : int
        Number of bends.
    """

    rows: np.ndarray
    exponents: np.ndarray
    no_load_speeds: np.ndarray
    bent: int

    @property
    def line(self) -> np.ndarray:
        """Linear characteristic, (2, variants)."""
        return self.rows[:BENDS]

    @property
    def bends(self) -> np.ndarray:
        """Changes of slope and speeds of the bends, (bends, 2, variants)."""
        return self.rows[BENDS:][: PER_BEND * self.bent].reshape(self.bent, PER_BEND, self.rows.shape[1])

    @property
    def kloss(self) -> np.ndarray:
        """Constants of the induction motors, (motors, 5, variants)."""
        rows = self.rows[BENDS + PER_BEND * self.bent :]
        return rows.reshape(len(rows) // PER_MOTOR, PER_MOTOR, self.rows.shape[1])

    def some(self, chosen: np.ndarray) -> "Drive":
        """A subset of the variants, by index."""
        return Drive(*(np.ascontiguousarray(part[..., chosen]) for part in self[:3]), self.bent)


class Moments(NamedTuple):
    """Torque of the motors, of each channel of loads [N·m], and ∂M/∂ω of their sum [N·m·s]."""

    motors: np.ndarray
    loads: np.ndarray
    slope: np.ndarray

    @property
    def total(self) -> np.ndarray:
        """The reduced torque."""
        return self.motors + self.loads.sum(axis=0)


def moments_at(
    drive: Drive, channel_of: np.ndarray, loads: np.ndarray, powers: np.ndarray, omega: np.ndarray
) -> Moments:
    """Torques at given positions and speeds of many variants.

    Parameters
    ----------
    drive : Drive
    channel_of : ndarray (laws,) of int
        Channel of each power law.
    loads : ndarray (channels, 3, places or 1, variants)
        Coefficients of ω⁰, ω¹ and ω²; a single place applies to all.
    powers : ndarray (laws, places or 1, variants)
        Coefficients of the power laws.
    omega : ndarray (places, variants)
        [rad/s].
    """
    found = np.empty((2 + loads.shape[0], *omega.shape))
    if omega.size:
        parts = (drive.rows, drive.exponents, channel_of, loads, powers, omega)
        arrays = (part if part.flags.carray else np.array(part, order="C") for part in parts)
        given = AtSpeed(*arrays, found, drive.bent)
        count = len(drive.rows) + len(drive.exponents) + POLYNOMIAL + 1 + len(found)

        def arguments() -> tuple:
            return given, rows(count)

        spread(moments_of_blocks, -(-omega.shape[1] // LANES), arguments)
    return Moments(found[0], found[2:], found[1])


class AtSpeed(NamedTuple):
    """Arguments of `moments_at`; `found` receives the motors' torque, ∂M/∂ω and the torque of each channel."""

    drives: np.ndarray
    exponents: np.ndarray
    channel_of: np.ndarray
    loads: np.ndarray
    powers: np.ndarray
    omega: np.ndarray
    found: np.ndarray
    bent: int


@driver
def moments_of_blocks(begin: int, end: int, given: AtSpeed, room: np.ndarray) -> None:
    """Torques of the blocks begin … end − 1 of variants; `room` is scratch memory for a block."""
    drives, loads, powers, omega = given.drives, given.loads, given.powers, given.omega
    channel_of, found = given.channel_of, given.found
    drive, exponents = in_lanes(room), in_lanes(room[drives.shape[0] :])
    after = room[drives.shape[0] + given.exponents.shape[0] :]
    place, speeds, moments = in_lanes(after), in_lanes(after[POLYNOMIAL:]), in_lanes(after[POLYNOMIAL + 1 :])
    speed, of_motors, slope = speeds[0], moments[0], moments[1]
    rows = BENDS + PER_BEND * given.bent, drives.shape[0]
    for b in range(begin, end):
        first = b * LANES
        gather(drives, first, drive)
        gather(given.exponents, first, exponents)
        for j in range(omega.shape[0]):
            at = j if loads.shape[2] > 1 else 0
            gather(omega[j : j + 1], first, speeds)
            for lane in range(LANES):
                of_motors[lane], slope[lane] = motors_at(drive, lane, rows, speed[lane])
            for channel in range(loads.shape[0]):
                gather(loads[channel, :, at], first, place)
                for lane in range(LANES):
                    w = speed[lane]
                    moments[2 + channel, lane] = place[0, lane] + w * (place[1, lane] + w * place[2, lane])
                    slope[lane] += place[1, lane] + 2.0 * w * place[2, lane]
            for law in range(powers.shape[0]):
                gather(powers[law, at : at + 1], first, place)
                for lane in range(LANES):
                    w, n = speed[lane], exponents[law, lane]
                    moment = place[0, lane] * power(abs(w), n)
                    moments[2 + channel_of[law], lane] += moment
                    slope[lane] += n * moment / w
            hand_out(moments, first, found[:, j])


def greatest_moment(drive: Drive, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Peak torque of the motors, by magnitude, between two speeds of each variant.

    Parameters
    ----------
    drive : Drive
    low, high : ndarray (variants,)
        [rad/s].
    """
    # A linear characteristic alone has its peak at one of the ends.
    several = len(drive.kloss) + drive.line.any() > 1
    share = np.linspace(0.0, 1.0, SPEEDS_BETWEEN if several else 2)[:, None]
    speeds = [low + share * (high - low)]
    speeds += [np.clip(at, low, high)[None] for _, at in drive.bends]
    for _, slip, _, synchronous, ratio in drive.kloss:
        # Motor and generator torque peak at the breakdown slip.
        speeds += [np.clip(synchronous / ratio * (1.0 + way * slip), low, high)[None] for way in (-1.0, 1.0)]
    none = np.zeros((1, POLYNOMIAL, 1, low.size))
    at = np.concatenate(speeds)
    motors = moments_at(drive, np.zeros(0, np.int64), none, np.zeros((0, 1, low.size)), at).motors
    return np.abs(motors).max(axis=0)
