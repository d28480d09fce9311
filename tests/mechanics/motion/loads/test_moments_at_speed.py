"""Moments at given speeds against their laws one by one."""

import numpy as np

from engine.laws.motor_characteristics import induction_motor
from engine.motion.moments.at_speed import Drive, moments_at

EPS = np.finfo(float).eps
VARIANTS, PLACES, CHANNELS = 70, 3, 2


def given(random: np.random.Generator) -> tuple:
    """Two induction motors beside a straight one that bends, loads over powers of the speed, and two power laws."""
    line = [random.uniform(10, 30, VARIANTS), -random.uniform(0.1, 0.3, VARIANTS)]
    bends, kloss = [random.uniform(-1.0, 1.0, VARIANTS), random.uniform(2, 12, VARIANTS)], []
    for _ in range(2):
        most, slip, rotor = random.uniform(2, 5, VARIANTS), random.uniform(0.1, 0.4, VARIANTS), np.full(VARIANTS, 0.5)
        kloss += [most, slip, rotor, random.uniform(100, 200, VARIANTS), random.uniform(1, 8, VARIANTS)]
    rows = np.array([*line, *bends, *kloss])
    drive = Drive(rows, random.uniform(0.5, 3.0, (2, VARIANTS)), np.zeros((0, VARIANTS)), 1)
    loads = random.uniform(-1, 1, (CHANNELS, 3, PLACES, VARIANTS)) * np.array([5.0, 0.1, 0.01])[:, None, None]
    return drive, np.array([1, 0]), loads, random.uniform(-0.1, 0.1, (2, PLACES, VARIANTS))


def by_hand(drive: Drive, channel_of: np.ndarray, loads: np.ndarray, powers: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Moments of the motors and of the channels."""
    motors, law = drive.line[0] + drive.line[1] * w, np.vectorize(induction_motor)
    for bend, at in drive.bends:
        motors = motors + bend * np.maximum(w - at, 0.0)
    for *constants, ratio in drive.kloss:
        # The law works out what it has nowhere, too.
        with np.errstate(all="ignore"):
            motors = motors + ratio * law(*constants, ratio * w)
    of_channels = loads[:, 0] + loads[:, 1] * w + loads[:, 2] * w * w
    for law, channel in enumerate(channel_of):
        of_channels[channel] += powers[law] * np.abs(w) ** drive.exponents[law]
    return np.concatenate((motors[None], of_channels))


def test_moments__are_those_of_their_laws_and_slopes_their_derivatives():
    random = np.random.default_rng(5)
    drive, channel_of, loads, powers = given(random)
    # Motors turn up to eight times as fast, below their synchronous speed.
    w = random.uniform(2, 12, (PLACES, VARIANTS))
    found = moments_at(drive, channel_of, loads, powers, w)
    expected = by_hand(drive, channel_of, loads, powers, w)
    # Sums of some terms of up to 200 N·m.
    np.testing.assert_allclose(
        np.concatenate((found.motors[None], found.loads)), expected, rtol=0, atol=1e3 * EPS * 200
    )
    h = 1e-4 * w
    ends = [by_hand(drive, channel_of, loads, powers, w + side * h).sum(axis=0) for side in (-1.0, 1.0)]
    # Central differences: rounding of some 200 N·m over 2 h, and h² times third derivatives of up to 1e3.
    room = 1e2 * EPS * 200 / h + 1e3 * h**2
    # A bend between the ends has both slopes.
    room = room + np.where(np.abs(w - drive.bends[0, 1]) <= h, np.abs(drive.bends[0, 0]), 0.0)
    assert (np.abs(found.slope - (ends[1] - ends[0]) / (2 * h)) <= room).all()


def test_loads_of_one_place__hold_at_all():
    random = np.random.default_rng(6)
    drive, channel_of, loads, powers = given(random)
    w = random.uniform(2, 40, (PLACES, VARIANTS))
    one, all_the_same = (loads[:, :, :1], powers[:, :1]), (loads[:, :, [0] * PLACES], powers[:, [0] * PLACES])
    for part, other in zip(*(moments_at(drive, channel_of, *parts, w) for parts in (one, all_the_same)), strict=True):
        np.testing.assert_array_equal(part, other)
