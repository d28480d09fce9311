"""The least base circle of a cam whose follower swings: its pressure angle and curvature keep their limits.

At each position of the cam the pressure angle sets the arm an interval of angles ψ, in closed form. The curvature may
be kept, lost and kept again as ψ grows. So the least angle ψ₀ is approached from below: where the profile is curved
most, the next ψ is sought at which the limit is kept, until it is kept all around. No step passes an angle at which it
is, so that ψ₀ is the least.
"""

import math

import numpy as np
from numba import types

from engine.compiling.decorators import driver, routine
from engine.compiling.running import prepare
from engine.elements.cams.cam_extremes import (
    ANSWERS,
    EQUAL,
    HALVINGS,
    SAMPLES,
    TurnExtreme,
    over_turn,
    pieces_of_turn,
)
from engine.elements.cams.cam_places import (
    ARM,
    DISTANCE,
    DYNAMIC,
    EPS,
    FLAT,
    LIMIT_RADIUS,
    LIMITED,
    QUANTITIES,
    ROLLER,
    SENSE,
)
from engine.elements.cams.pieces import (
    BETA,
    FROM,
    ORIGIN,
    PIECE_NUMBERS,
    PIECES_OF_A_SECTION,
    TO,
    TURN,
    motion_in,
    sizes_in,
)
from engine.laws.cams.profiles import curvature_room, face_room
from engine.verdicts import Verdict

# Positions whose curvature is limited, one after the other, and steps to the angle at which each keeps it. Both come
# nearer as Newton's method does.
_POSITIONS, _STEPS = 60, 200
# Share of a turn within which a cam angle is that where two pieces meet.
_SAME = 1e-9
_CURVED, _HOLLOW, _OK = int(TurnExtreme.CURVED), int(TurnExtreme.HOLLOW), int(Verdict.OK)


@routine
def _room(
    traits: np.ndarray, numbers: np.ndarray, row: int, psi: float, s1: float, s2: float
) -> tuple[float, float, float]:
    """How far a position is within its limit of curvature, its derivative by ψ and a bound of the second one."""
    sense, d = float(traits[SENSE]), numbers[row, DISTANCE]
    if traits[FLAT] == 1:
        return face_room(psi, s1, s2, d, sense, numbers[row, LIMIT_RADIUS])
    return curvature_room(psi, s1, s2, numbers[row, ARM], d, sense, numbers[row, LIMIT_RADIUS] + numbers[row, ROLLER])


@routine
def _next_angle(
    traits: np.ndarray, numbers: np.ndarray, row: int, psi: float, s1: float, s2: float, m1: float, m2: float
) -> tuple[float, float]:
    """The next arm angle that keeps the curvature of a position, and what it carries of rounding; NaN if there is none.

    Below the parabola that the bound of the second derivative allows no root can lie: the step to its root is safe.
    """
    step = 0.0
    for _ in range(_STEPS):
        room, slope, bound = _room(traits, numbers, row, psi, s1, s2)
        if room >= 0.0:
            break
        step = (math.sqrt(slope * slope - 2.0 * bound * room) - slope) / bound
        if slope > 0.0:
            step = -2.0 * room / (math.sqrt(slope * slope - 2.0 * bound * room) + slope)
        psi += step
        if not psi < math.pi:
            return math.nan, 0.0
        if step <= EPS * psi:
            break
    room, slope, bound = _room(traits, numbers, row, psi, s1, s2)
    more1, _, _ = _room(traits, numbers, row, psi, s1 + math.sqrt(EPS) * m1, s2)
    more2, _, _ = _room(traits, numbers, row, psi, s1, s2 + math.sqrt(EPS) * m2)
    size = (abs(more1 - room) + abs(more2 - room)) / math.sqrt(EPS) + bound
    return psi, size / max(slope, math.sqrt(bound * size * EPS))


@driver
def _find_least_arm_angles(
    kinds: np.ndarray,
    directions: np.ndarray,
    traits: np.ndarray,
    numbers: np.ndarray,
    tabled: np.ndarray,
    angles: np.ndarray,
    rounding: np.ndarray,
    values: np.ndarray,
    sizes: np.ndarray,
    places: np.ndarray,
    spreads: np.ndarray,
    pieces: np.ndarray,
    samples: np.ndarray,
    stack: np.ndarray,
) -> None:
    """Raise `angles` of a set of variants, and with them their `rounding`; the rest is room to work in."""
    flat = traits[FLAT] == 1
    extreme = _HOLLOW if flat else _CURVED
    for row in range(numbers.shape[0]):
        count = pieces_of_turn(kinds, directions, numbers, row, tabled, pieces)
        psi = angles[row]
        angles[row] = math.nan
        limit = numbers[row, LIMIT_RADIUS] + (0.0 if flat else numbers[row, ROLLER])
        for _ in range(_POSITIONS):
            verdict = over_turn(
                traits, numbers, row, pieces, count, psi, rounding[row], values, sizes, places, spreads, samples, stack
            )
            if verdict != _OK:
                break
            found, size = values[row, extreme], sizes[row, extreme]
            # The flat face's radius stands there with its sign turned, the pitch curve's curvature as it is.
            least = -limit if flat else 1.0 / limit
            if not found > least + EQUAL * EPS * size:
                angles[row] = psi
                break
            below = psi
            for i in range(count):
                psi = _raised(traits, numbers, row, pieces, i, places[row, extreme], below, psi, rounding)
            if not psi > below:
                angles[row] = psi
                break


@routine
def _raised(
    traits: np.ndarray,
    numbers: np.ndarray,
    row: int,
    pieces: np.ndarray,
    i: int,
    place: float,
    psi: float,
    so_far: float,
    rounding: np.ndarray,
) -> float:
    """The angle ψ₀ ≥ ψ at which a piece keeps the limit at a cam angle, if that is in it and above the one so far."""
    begin = pieces[i, ORIGIN] + pieces[i, BETA] * pieces[i, FROM]
    end = pieces[i, ORIGIN] + pieces[i, BETA] * pieces[i, TO]
    # Both pieces that meet at an angle count: which of them is curved more, the angle doesn't tell.
    near = _SAME * TURN
    angle = place
    if place - TURN >= begin - near:
        angle = place - TURN
    elif place + TURN <= end + near:
        angle = place + TURN
    if math.isnan(so_far) or angle < begin - near or angle > end + near:
        return so_far
    u = min(max((angle - pieces[i, ORIGIN]) / pieces[i, BETA], pieces[i, FROM]), pieces[i, TO])
    s, s1, s2, _ = motion_in(pieces, i, u)
    m0, m1, m2, _ = sizes_in(pieces, i)
    above, off = _next_angle(traits, numbers, row, psi + s, s1, s2, m1, m2)
    if above - s <= so_far:
        return so_far
    rounding[row] = off + m0 + above
    return above - s


def least_arm_angles(
    sections: tuple[np.ndarray, np.ndarray, np.ndarray],
    traits: np.ndarray,
    numbers: np.ndarray,
    begin: np.ndarray,
    rounding: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Least arm angles, from given ones upwards, at which the curvature of cams keeps its limit.

    Parameters
    ----------
    sections : tuple
        From `engine.elements.cams.cam_columns.cam_sections`.
    traits : ndarray of int
    numbers : ndarray (variants, NUMBERS + 2 sections)
    begin, rounding : ndarray (variants,)
        Angles where the displacement is zero, and the magnitudes whose rounding they carry.

    Returns
    -------
    angles, rounding : ndarray (variants,)
        Angles NaN where none keeps the limit.
    """
    kinds, directions, tabled = sections
    bare = traits.copy()
    bare[[DYNAMIC, LIMITED]] = 0
    angles, rounding = begin.copy(), rounding.copy()
    room = np.empty((4, numbers.shape[0], ANSWERS))
    pieces = np.empty((max(len(tabled), PIECES_OF_A_SECTION * kinds.size), PIECE_NUMBERS))
    samples, stack = np.empty((SAMPLES + 1, 2 * QUANTITIES)), np.empty((2 * HALVINGS + 4, 2))
    prepare(_find_least_arm_angles, _TYPES)
    _find_least_arm_angles(kinds, directions, bare, numbers, tabled, angles, rounding, *room, pieces, samples, stack)
    return angles, rounding


_ROW, _INTEGERS, _TABLE = types.float64[::1], types.int64[::1], types.float64[:, ::1]
_TYPES = (*(_INTEGERS,) * 3, *(_TABLE,) * 2, *(_ROW,) * 2, *(_TABLE,) * 7)
