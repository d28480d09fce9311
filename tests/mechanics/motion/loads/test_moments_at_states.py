"""The equation of motion at given states, against the machine and its laws by hand."""

import numpy as np
import pytest
from motion_scenes import MOMENTS, dc_moment, kloss_moment, reduced, slider_crank, steady
from mpmath import mp

from engine import Scene, scene_numbers
from engine.mechanism.mechanics import Mechanics
from engine.motion.moments.dynamics import Dynamics, Reduction
from engine.motion.moments.equation_of_motion import EquationOfMotion
from engine.scene.scene import Numbers

ANGLES = np.array([[0.3, 1.1], [2.0, 2.9], [4.2, 5.5]])
SPEEDS = np.array([[3.0, 12.0], [8.0, 0.5], [21.0, 16.0]])


@pytest.fixture(scope="module")
def equation():
    """The equation of motion of a slider-crank, twice, that starts at φ = 0.2 rad."""
    scene = Scene.model_validate(slider_crank({"on": steady("dc induction push oil fan gravity")}))
    reduction = Reduction(Mechanics(scene))
    dynamics = Dynamics(reduction, frozenset(scene.regimes["on"].off))
    variants = reduction.variants(Numbers(scene_numbers(scene), {}), np.ones(2), np.array([0.1, 0.4]))
    return EquationOfMotion(dynamics, dynamics.driven(variants), np.full(2, 0.2))


def by_hand(phi: float, omega: float, flywheel: float) -> np.ndarray:
    """Inertia, torques of the motors and of the loads, and acceleration."""
    inertia, slope, _, weight = reduced(mp.mpf(phi), flywheel=flywheel)
    drag = MOMENTS["oil"]["coefficient"] * omega + MOMENTS["fan"]["coefficient"] * omega * abs(omega)
    motors, loads = dc_moment(omega) + kloss_moment(omega), weight + MOMENTS["push"]["moment"] - drag
    epsilon = (motors + loads - slope * omega**2 / 2) / inertia
    return np.array([inertia, motors, loads, epsilon], float)


@pytest.mark.parametrize("facing", [1.0, -1.0])
def test_moments_and_acceleration__follow_from_the_laws(equation, facing):
    found = equation.along(ANGLES - 0.2, facing * SPEEDS, np.zeros_like(ANGLES), np.full(2, facing))
    expected = np.vectorize(by_hand, signature="(),(),()->(n)")(ANGLES, facing * SPEEDS, np.array([0.1, 0.4]))
    rows = np.moveaxis(expected, 2, 0)
    for name, row, mine in zip(found._fields, (*rows[:1], rows[3], *rows[1:3]), found, strict=True):
        np.testing.assert_allclose(
            mine.reshape(row.shape), row, rtol=1e-12, atol=1e-12 * np.abs(row).max(), err_msg=name
        )


def test_decay__is_the_derivative_of_the_acceleration_by_the_speed(equation):
    at, h, one = ANGLES[0] - 0.2, 1e-4, np.ones(2)
    _, rate = equation.acceleration(at, SPEEDS[0], 0 * one, one)
    ahead, behind = (equation.acceleration(at, SPEEDS[0] + side * h, 0 * one, one)[0] for side in (1.0, -1.0))
    # Central differences: rounding of some 100 rad/s² over 2 h.
    np.testing.assert_allclose(rate, np.abs(ahead - behind) / (2.0 * h), rtol=1e-6, atol=1e-9)


def test_more_accurate_torque__replaces_that_of_the_speed(equation):
    found = equation.along(ANGLES - 0.2, SPEEDS, np.zeros_like(ANGLES), np.ones(2))
    known = np.where([[True, False]], found.total + 1.0, np.nan)
    better = found.known_better(known)
    np.testing.assert_allclose(better.total - found.total, np.array([[1.0, 0.0]] * 3), atol=1e-12)
    np.testing.assert_allclose((better.epsilon - found.epsilon) * found.inertia, np.array([[1.0, 0.0]] * 3), atol=1e-11)
