"""Statistics of fields along recorded steps: extremes, their positions and means, against closed forms."""

import math
from types import SimpleNamespace

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.special import ellipe, iv

from engine.motion.fields.field_statistics import ROUNDED, FieldStatistics
from engine.motion.fields.recorded_motion import Snapshots
from engine.motion.quantities import Asked
from engine.stepping.system import RECORDED_AT

TURN = 2 * math.pi
STATISTICS = ("min", "max", "min_at", "max_at", "mean", "rms", "range", "peak")


class Turning:
    """A turn at unit speed in steps between given angles."""

    def __init__(self, edges: np.ndarray) -> None:
        self.who, self.length, self.begin = np.zeros(edges.size - 1, int), np.diff(edges), edges[:-1]
        turned = self.begin + RECORDED_AT[:, None] * self.length
        self.samples = np.array([turned, turned, np.ones_like(turned)])

    def at(self, step: np.ndarray, share: np.ndarray) -> Snapshots:
        turned = self.begin[step] + share * self.length[step]
        nothing = np.full_like(turned, np.nan)
        return Snapshots(self.who[step], turned, turned, np.ones(step.size), np.ones_like(turned), nothing)

    def durations(self, step: np.ndarray, states: Snapshots) -> np.ndarray:
        return np.broadcast_to(self.length[step], states.time.shape)


class Curve:
    """A field that is a function of the angle."""

    cycle = TURN

    def __init__(self, curve) -> None:
        self.variants, self._curve = SimpleNamespace(count=1), curve

    def __call__(self, states: Snapshots) -> dict[str, np.ndarray]:
        return {"curve": self._curve(states.turned)}

    def place(self, turned: np.ndarray) -> np.ndarray:
        return np.mod(turned, TURN)


def measured(curve, tolerance: float, edges: np.ndarray, asked=STATISTICS) -> dict[str, tuple[float, float]]:
    """Statistics of a function of the angle, with their error estimates."""
    statistics = FieldStatistics(Curve(curve), ["curve"], tolerance, ["curve"] if "mean" in asked else [])
    statistics.see(Turning(edges))
    found = statistics.answers([Asked("", "curve", key) for key in asked])
    return {key: (found.values[f"curve.{key}"][0], found.missed[f"curve.{key}"][0]) for key in asked}


def agree(found: dict, exact: dict, tolerance: float) -> None:
    """Every number is the exact one within its error estimate and the rounding of the values."""
    peak = max(abs(exact["min"]), abs(exact["max"]))
    exact = exact | {"range": exact["max"] - exact["min"], "peak": peak}
    for key, value in exact.items():
        got, error = found[key]
        apart = abs(math.remainder(got - value, TURN)) if key.endswith("_at") else abs(got - value)
        assert apart <= error + 1e-13 * max(peak, 1.0), (key, got, value, error)
    # Estimates that say something: of the order of the tolerance, or of the resolution of a kink.
    assert found["max"][1] <= 40 * max(tolerance, 1e-12) * peak


edges = st.integers(6, 40).map(lambda n: np.linspace(0.0, TURN, n + 1))
tolerances = st.sampled_from([1e-4, 1e-6, 1e-8, 1e-10])


@given(edges, tolerances, st.floats(0.0, TURN), st.floats(-0.95, 0.95))
@example(np.linspace(0.0, TURN, 7), 1e-4, 0.1, 0.0)
@example(np.linspace(0.0, TURN, 7), 1e-8, 0.0, 1e-8)
# The first cusp is a little beyond the edge of a step, in coefficients of a smooth curve.
@example(np.linspace(0.0, TURN, 13), 1e-4, 0.0, 6e-8)
@settings(max_examples=20)
def test_magnitude_that_vanishes__two_cusps(edges, tolerance, phase, level):
    found = measured(lambda x: np.abs(np.cos(x - phase) - level), tolerance, edges)
    top = phase + (math.pi if level >= 0.0 else 0.0)
    mean = 2 / math.pi * (math.sqrt(1 - level**2) + level * math.asin(level))
    exact = {"min": 0.0, "max": 1.0 + abs(level), "mean": mean, "rms": math.sqrt(0.5 + level**2)}
    agree(found, exact | ({"max_at": top} if abs(level) > 1e-6 else {}), tolerance)
    # It vanishes at one of two positions.
    at = [phase + side * math.acos(level) for side in (-1, 1)]
    assert min(abs(math.remainder(found["min_at"][0] - x, TURN)) for x in at) <= found["min_at"][1]
    assert found["min"][1] <= 0.02
    # Without the square of one sign, the estimate of a kink has to cover it.
    lower = measured(lambda x: np.abs(np.cos(x - phase) - level) - 0.5, tolerance, edges)
    assert abs(lower["min"][0] + 0.5) <= lower["min"][1] + 1e-13


@given(edges, tolerances, st.floats(0.0, TURN), st.floats(1e-3, 3.0))
@settings(max_examples=20)
def test_magnitude_that_nearly_vanishes__two_dips(edges, tolerance, phase, least):
    # The length of (sin, b): its mean is an elliptic integral.
    found = measured(lambda x: np.hypot(np.sin(x - phase), least), tolerance, edges)
    whole = math.hypot(1.0, least)
    mean = 2 / math.pi * whole * ellipe(1.0 / whole**2)
    agree(found, {"min": least, "max": whole, "mean": mean, "rms": math.sqrt(0.5 + least**2)}, tolerance)
    # Without means its square is followed.
    extremes = measured(lambda x: np.hypot(np.sin(x - phase), least), tolerance, edges, ("min", "max", "range", "peak"))
    agree(extremes, {"min": least, "max": whole}, tolerance)


@given(edges, tolerances, st.floats(0.0, TURN), st.floats(0.01, 40.0), st.sampled_from([-1.0, 1.0]))
@settings(max_examples=20)
def test_sharp_peak__of_an_exponential(edges, tolerance, phase, steepness, sign):
    k = sign * steepness
    found = measured(lambda x: np.exp(k * np.cos(x - phase) - abs(k)), tolerance, edges)
    scale = math.exp(-abs(k))
    exact = {"min": math.exp(-2 * abs(k)), "max": 1.0, "mean": scale * iv(0, k), "rms": scale * math.sqrt(iv(0, 2 * k))}
    agree(found, exact | {"max_at": phase + (0.0 if k > 0.0 else math.pi)}, tolerance)
    # By a change of the tolerance the position changes by the root of two of it over the curvature k.
    assert found["max_at"][1] <= 10.0 * math.sqrt(2.0 * tolerance / steepness)


def test_constant_field__its_extremes_are_anywhere():
    found = measured(lambda x: np.full_like(x, 3.0), 1e-8, np.linspace(0.0, TURN, 9))
    assert found["min"][0] == found["max"][0] == 3.0
    # The rounding of one value, and as much of the last coefficients.
    assert found["max"][1] <= 2.0 * ROUNDED * 3.0
    assert found["max_at"][1] >= math.pi


def test_field_that_is_zero__at_an_instant_and_over_a_step():
    statistics = FieldStatistics(Curve(np.zeros_like), ["curve"], 1e-8)
    for edges in ([0.0, 0.0], [0.0, 1.0]):
        statistics.see(Turning(np.array(edges)))
    found = statistics.answers([Asked("", "curve", key) for key in ("max", "max_at", "range")])
    assert [found.values[f"curve.{key}"][0] for key in ("max", "max_at", "range")] == [0.0, 0.0, 0.0]


def test_infinite_value__no_statistics():
    with np.errstate(divide="ignore", invalid="ignore"):
        found = measured(lambda x: 1.0 / (x - math.pi), 1e-8, np.linspace(0.0, TURN, 9))
    assert all(math.isnan(value) for value, _ in found.values())
