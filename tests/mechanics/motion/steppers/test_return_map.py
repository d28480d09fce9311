"""Speeds that return after a cycle, of maps in closed form."""

import numpy as np
import pytest

from engine.motion.settled.return_map import returning_speeds
from engine.stepping.walk_task import LONGEST
from engine.words.verdicts import Verdict

OK = Verdict.OK


def sought(map_of, guess, longer=1.0):
    """What is found of a map that takes speeds and whose cycles never fail."""
    guess = np.array(guess, float)

    def cycle(who, speeds):
        return map_of(speeds), np.full(who.size, OK)

    return returning_speeds(cycle, guess, np.zeros(guess.shape[1], np.uint8), longer)


@pytest.mark.parametrize("multipliers", [(0.99, 0.3), (0.5, -0.7), (0.0, 0.9999)])
def test_linear_map__returns_at_its_fixed_point_with_its_eigenvalues(multipliers):
    fixed, turn = np.array([[80.0], [75.0]]), np.array([[0.8, -0.6], [0.6, 0.8]])
    matrix = turn @ np.diag(multipliers) @ turn.T
    found = sought(lambda x: fixed + matrix @ (x - fixed), [[100.0, 50.0], [90.0, 120.0]])
    assert (found.verdict == OK).all()
    np.testing.assert_allclose(found.speeds, np.repeat(fixed, 2, axis=1), rtol=1e-12)
    # The map's rounding, over twice the distance of the starts, 3e-4.
    np.testing.assert_allclose(found.multiplier, np.abs(multipliers).max(), rtol=1e-11)


def test_curved_map__settles_at_the_upper_of_two_speeds_from_any_start_above_the_lower():
    # ω² → ω² + (ω² − 100)(900 − ω²)/2000 takes 10 and 30 to themselves, with multipliers 1.4 and 0.6.
    def map_of(x):
        return np.sqrt(x**2 + (x**2 - 100.0) * (900.0 - x**2) / 2000.0)

    found, other = (sought(map_of, [[10.5, 12.0, 29.0, 35.0]], longer) for longer in (1.0, LONGEST))
    assert (found.verdict == OK).all()
    np.testing.assert_allclose(found.speeds, 30.0, rtol=1e-12)
    np.testing.assert_allclose(found.multiplier, 0.6, rtol=1e-6)
    # Differences twice as wide miss four times as much.
    assert (np.abs(found.multiplier - 0.6) <= np.abs(other.multiplier - found.multiplier)).all()


def test_maps_without_a_fixed_point__get_a_verdict():
    for guess in ([[10.0]], [[10.0], [20.0]]):
        assert sought(lambda x: x, guess).verdict[0] == Verdict.ANY_SPEED
    assert sought(lambda x: 1.1 * x, [[10.0]]).verdict[0] == Verdict.RUNS_AWAY

    def stalling(who, speeds):
        """Lose 1 of ω² in a cycle; below 5 the cycle isn't completed."""
        return np.sqrt(np.maximum(speeds**2 - 1.0, 0.0)), np.where(speeds[0] < 5.0, Verdict.STALLS, OK)

    found = returning_speeds(stalling, np.array([[50.0, 2.0]]), np.zeros(2, np.uint8))
    assert (found.verdict == Verdict.STALLS).all()
    assert np.isnan(found.multiplier).all()
