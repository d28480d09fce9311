import math

import numpy as np
import pytest
from cycle_machines import CRANK, FORCE, INERTIA, MASS, OFFSET, ROD, SPEED, WHEEL, press, press_numbers, slide
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq, minimize_scalar

TURN = 2.0 * math.pi
# Half squares of speeds for Wittenbauer's tangents, in rows of P that the press doesn't use.
FAST, SLOW, MIDDLE = 22, 23, 24
CURVES = {"works": (1,), "combinations": ((1, 0, FAST), (1, 0, SLOW), (1, 0, MIDDLE))}
PRESS = press(integrals=(1,), fluctuations=((1, 0, SPEED, WHEEL),), **CURVES)


def numbers_of(variants, delta=0.05, **given):
    """P of presses with the rows of half squares of speeds."""
    numbers = np.vstack([press_numbers(variants, **given), np.zeros((3, variants))])
    speed = numbers[SPEED]
    numbers[FAST], numbers[SLOW] = 0.5 * (speed * (1.0 + 0.5 * delta)) ** 2, 0.5 * (speed * (1.0 - 0.5 * delta)) ** 2
    numbers[MIDDLE] = 0.5 * speed**2
    return numbers


class Exact:
    """Work about the mean and inertia of one press in closed form.

    The force acts while the slider approaches between its levels; the slider's way is known at every position.
    """

    def __init__(self, numbers):
        self.p = numbers
        near = math.sqrt((numbers[ROD] - numbers[CRANK]) ** 2 - numbers[OFFSET] ** 2)
        far = math.sqrt((numbers[ROD] + numbers[CRANK]) ** 2 - numbers[OFFSET] ** 2)
        self.levels = near + numbers[11] * (far - near), near + numbers[12] * (far - near)
        self.out = math.asin(numbers[OFFSET] / (numbers[ROD] + numbers[CRANK]))
        self.inner = math.pi - math.asin(numbers[OFFSET] / (numbers[ROD] - numbers[CRANK]))
        self.mean = numbers[FORCE] * (self.levels[0] - self.levels[1]) / TURN
        ends = {"a": self.out, "b": self.inner, "xtol": 1e-15}
        self.cuts = [brentq(lambda q, at=at: self.place(q) - at, **ends) for at in self.levels]

    def place(self, q):
        return float(slide(self.p, q))

    def rate(self, q):
        y = self.p[CRANK] * math.sin(q) - self.p[OFFSET]
        return -self.p[CRANK] * math.sin(q) - y * self.p[CRANK] * math.cos(q) / math.sqrt(self.p[ROD] ** 2 - y * y)

    def work(self, q):
        # By how far the slider has come since the force set in; on its way out there is none.
        near, far = self.levels
        come = 0.0 if q <= self.cuts[1] else (max(self.place(q), near) if q < self.cuts[0] else near) - far
        return self.p[FORCE] * come - self.mean * q

    def inertia(self, q):
        return self.p[INERTIA] + self.p[MASS] * self.rate(q) ** 2

    def extreme(self, slope, sign):
        """Greatest sign · (W − slope (I − I_1)) and its place."""
        first = self.inertia(0.0)

        def value(q):
            return sign * (self.work(q) - slope * (self.inertia(q) - first))

        best = -math.inf
        for a, b in zip([0.0, *self.cuts[::-1]], [*self.cuts[::-1], TURN], strict=True):
            for i in range(40):
                low, high = a + (b - a) * max(i - 1, 0) / 40, a + (b - a) * min(i + 2, 40) / 40
                asked = {"bounds": (low, high), "method": "bounded", "options": {"xatol": 1e-9}}
                for q in (minimize_scalar(lambda q: -value(q), **asked).x, low, high):
                    if value(q) > best:
                        best, at = value(q), q
        return best, at

    def fluctuation(self):
        omega, whole = self.p[SPEED], self.inertia(0.0) + self.p[WHEEL]

        def excess(delta):
            fast, slow = 0.5 * (omega * (1.0 + 0.5 * delta)) ** 2, 0.5 * (omega * (1.0 - 0.5 * delta)) ** 2
            return self.extreme(fast, 1.0)[0] + self.extreme(slow, -1.0)[0] - delta * omega**2 * whole

        return brentq(excess, 0.0, 2.0, xtol=1e-13)


@pytest.fixture(scope="module")
def presses():
    rng = np.random.default_rng(1)
    return numbers_of(
        6,
        crank=rng.uniform(0.02, 0.15, 6),
        rod=rng.uniform(0.3, 0.6, 6),
        offset=rng.uniform(-0.08, 0.08, 6),
        mass=rng.uniform(1.0, 30.0, 6),
        force=rng.uniform(100.0, 3000.0, 6),
        speed=rng.uniform(5.0, 30.0, 6),
        wheel=rng.uniform(0.5, 5.0, 6),
    )


def test_works_and_their_combinations_with_the_inertia_against_closed_forms(presses):
    found = PRESS.evaluate(presses)
    for k in range(presses.shape[1]):
        exact = Exact(presses[:, k])
        scale = abs(exact.mean) * TURN + presses[FAST, k] * presses[MASS, k] * presses[CRANK, k] ** 2
        # Extremes of the reference are found to about the square of 1e-9.
        assert abs(found.works.greatest.value[0, k] - exact.extreme(0.0, 1.0)[0]) < 1e-14 * scale
        for i, row in enumerate((FAST, SLOW, MIDDLE)):
            for side, sign in (("greatest", 1.0), ("least", -1.0)):
                value, at = exact.extreme(presses[row, k], sign)
                off = abs(getattr(found.combinations, side).value[i, k] - sign * value)
                assert off <= getattr(found.combinations, side).error[i, k] + 2e-15 * scale
                assert getattr(found.combinations, side).error[i, k] < 1e-11 * scale
                assert abs(getattr(found.combinations, f"{side}_at").value[i, k] - at) < 1e-6


def test_speed_fluctuation_against_a_bracketed_root(presses):
    found = PRESS.evaluate(presses).fluctuations
    for k in range(3):
        exact = Exact(presses[:, k]).fluctuation()
        assert abs(found.delta.value[0, k] - exact) <= found.delta.error[0, k] + 2e-13
        assert found.delta.error[0, k] < 1e-11 * exact


def speeds(numbers, found):
    """Speed over the cycle that follows from the energy at the first position, at many positions."""
    exact = Exact(numbers)
    delta, top = found.fluctuations.delta.value[0, 0], found.fluctuations.top.value[0, 0]
    fastest = numbers[SPEED] * (1.0 + 0.5 * delta)
    first = 0.5 * fastest**2 * (exact.inertia(0.0) + numbers[WHEEL]) - top
    positions = np.append(np.linspace(0.0, TURN, 4001), exact.cuts)
    energies = np.array([first + exact.work(q) for q in positions])
    inertias = np.array([exact.inertia(q) + numbers[WHEEL] for q in positions])
    return np.sqrt(2.0 * energies / inertias), fastest, numbers[SPEED] * (1.0 - 0.5 * delta)


@settings(max_examples=15, deadline=None)
@given(st.floats(0.01, 0.12), st.floats(0.1, 30.0), st.floats(1.0, 3000.0), st.floats(5.0, 50.0), st.floats(0.5, 100.0))
def test_speeds_that_follow_from_the_energy_have_this_mean_and_fluctuation(crank, mass, force, speed, wheel):
    numbers = numbers_of(1, crank=crank, mass=mass, force=force, speed=speed, wheel=wheel)
    found = PRESS.evaluate(numbers)
    if np.isnan(found.fluctuations.delta.value[0, 0]):
        return
    over, fastest, slowest = speeds(numbers[:, 0], found)
    # Of 4001 positions none is more than 8e-4 rad from an extreme; what is missed is of second order.
    swing = fastest - slowest
    assert abs(over.max() - fastest) < 1e-4 * swing + 1e-12 * speed
    assert abs(over.min() - slowest) < 1e-4 * swing + 1e-12 * speed


def test_a_machine_that_would_stop_within_the_cycle_has_no_fluctuation():
    numbers = numbers_of(2, force=np.array([1e6, 1.0]), speed=1.0, wheel=0.1)
    found = PRESS.evaluate(numbers).fluctuations
    assert np.array_equal(np.isnan(found.delta.value[0]), [True, False])
    assert np.array_equal(np.isnan(found.fastest_at.value[0]), [True, False])


def test_loads_that_act_nowhere_do_no_work_at_all():
    found = PRESS.evaluate(numbers_of(3, force=0.0, mass=np.array([0.0, 5.0, 5.0])))
    assert np.all(found.works.range.value == 0.0)
    assert np.all(found.works.greatest.value == 0.0)
    # With a constant inertia the speed is constant, too.
    assert found.fluctuations.delta.value[0, 0] == 0.0
    assert np.all(found.combinations.range.value[:, 0] == 0.0)
    assert np.all(found.fluctuations.delta.value[0, 1:] > 1e-4)


def test_a_small_fluctuation_loses_no_digits():
    # A flywheel so heavy that δ is 1e-11: the differences of energies are as small a part of the energies.
    numbers = numbers_of(1, mass=0.0, force=300.0, wheel=1e10)
    found = PRESS.evaluate(numbers)
    # With a constant inertia δ = A_exc / (I ω²), to second order in δ.
    exact = found.works.range.value[0] / ((0.5 + 1e10) * numbers[SPEED] ** 2)
    assert np.allclose(found.fluctuations.delta.value[0], exact, rtol=1e-14)
    assert found.fluctuations.delta.value[0, 0] < 1e-11
