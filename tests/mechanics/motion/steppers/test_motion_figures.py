"""Error figures of motion are honest; answers don't depend on threads or on the company of other variants."""

from typing import NamedTuple

import numpy as np
import pytest
from motion_scenes import ask, run, slider_crank, steady

from engine import Verdict
from engine.compiling.threads import set_threads
from engine.motion.runs.spread_errors import spread_errors
from engine.stepping.walk_task import range_of_walks

REGIMES = {
    "start": run("dc fan gravity", speed=35.0),
    "working": run("dc fan gravity cut", cycles=2.6),
    "on": steady("dc fan gravity cut rub"),
    "other": steady("induction load gravity"),
    "stop": run("brake gravity rub", rest=True),
}
QUANTITIES = {
    "start": "time angle motor_work motor_moment_rms",
    "working": "time final_speed motor_work useful_work",
    "on": "period speed_fluctuation speed_min speed_max motor_work useful_work multiplier",
    "other": "period speed_fluctuation speed_min speed_max motor_work multiplier",
    "stop": "time angle brake_heat harmful_work",
}
NAMES = [f"{regime}.{quantity}" for regime, words in QUANTITIES.items() for quantity in words.split()]


def random_machines(count: int, seed: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    ranges = {
        "moments.dc.stall_moment": (10.0, 60.0),
        "moments.dc.no_load_speed": (60.0, 200.0),
        "moments.induction.breakdown_moment": (1.0, 5.0),
        "moments.fan.coefficient": (2e-4, 2e-3),
        "groups.drive.first.length": (0.15, 0.6),
        "bodies.ram_body.mass": (0.5, 6.0),
        "bodies.eccentric.mass": (0.5, 4.0),
        "flywheel.inertia": (0.03, 3.0),
    }
    # Evenly in the logarithm.
    return {path: np.exp(rng.uniform(np.log(a), np.log(b), count)) for path, (a, b) in ranges.items()}


def test_error_figures__hold_for_nearly_all_random_machines(monkeypatch):
    machines = random_machines(80, 7)
    scene = slider_crank(REGIMES)
    found = ask(scene, " ".join(NAMES), 120, varied=machines)
    monkeypatch.setattr("engine.motion.asked_regimes.RUN_TOLERANCE", 1e-13)
    monkeypatch.setattr("engine.motion.asked_regimes.TOLERANCE", 1e-12)
    exact = ask(scene, " ".join(NAMES), 120, varied=machines)
    sound = np.array([a == b == Verdict.OK for a, b in zip(found.status, exact.status, strict=True)])
    assert sound.mean() > 0.95
    shares, ratios = {}, {}
    for name in NAMES:
        value, figure = found.values[name][sound], found.errors[name][sound]
        # The reference has an error of its own.
        error = np.abs(value - exact.values[name][sound])
        shares[name] = np.mean(error <= figure + exact.errors[name][sound])
        # Rounding of many steps is estimated roughly.
        told = error > 1e-12 * np.abs(value)
        ratios[name] = np.median(figure[told] / error[told]) if told.any() else 1.0
    assert min(shares.values()) >= 0.995, shares
    # What is estimated is a formula of lower order: with steps as small as these it errs some thousand times as much.
    assert all(1 <= ratio <= 1e5 for ratio in ratios.values()), ratios


def steep_motors(count: int, seed: int, least: float, most: float) -> dict[str, np.ndarray]:
    """Numbers of random machines with motors of breakdown slips between limits."""
    random = np.random.default_rng(seed)
    return {
        "moments.induction.breakdown_slip": np.exp(random.uniform(np.log(least), np.log(most), count)),
        "moments.induction.breakdown_moment": random.uniform(5.0, 15.0, count),
        "groups.drive.first.length": random.uniform(0.15, 0.6, count),
    }


def test_figures_of_runs_that_forget__cover_what_their_last_steps_miss():
    # Motors so steep on a bare crank that nothing of a cycle's begin is left at its end; steps are implicit. Few of
    # many end where the last step of the run for comparison is nearly as short.
    machines = steep_motors(192, 5, 0.005, 0.06) | {"regimes.go.cycles": np.linspace(1.2, 2.2, 192)}
    scene = slider_crank({"go": run("induction cut gravity", from_speed=25.0, cycles=1.6)}, flywheel=0.0)
    # With the default accuracy only rounding would be missed.
    exact = ask(scene, "go.final_speed", varied=machines, accuracy=1e-9)
    for accuracy in (1e-2, 1e-3, 1e-4, 1e-5, 1e-7):
        found = ask(scene, "go.final_speed", varied=machines, accuracy=accuracy)
        assert set(found.status) == {Verdict.OK}
        missed = abs(found.values["go.final_speed"] - exact.values["go.final_speed"])
        figure = found.errors["go.final_speed"]
        assert (missed <= figure + exact.errors["go.final_speed"]).all(), accuracy
        assert (figure <= max(0.1 * accuracy, 1e-6) * exact.values["go.final_speed"]).all(), accuracy


def test_extremes_of_speed_with_steep_motors__are_covered_where_a_step_passes_them():
    # A step from before a top to beyond it may end below its start, which is then the fastest speed found.
    machines = steep_motors(96, 2, 0.001, 0.05)
    scene, names = slider_crank({"on": steady("induction cut gravity")}), ("on.speed_min", "on.speed_max")
    exact, found = (ask(scene, " ".join(names), varied=machines, accuracy=accuracy) for accuracy in (1e-9, 1e-4))
    assert set(found.status) == {Verdict.OK}
    for name in names:
        missed = abs(found.values[name] - exact.values[name])
        assert (missed <= found.errors[name] + exact.errors[name]).all(), name
        assert (found.errors[name] <= 1e-4 * exact.values[name]).all(), name


@pytest.mark.parametrize("end", [{"cycles": 3.7}, {"time": 0.5}, {"speed": 45.0}], ids=["angle", "time", "speed"])
def test_errors_carried_along__cover_what_the_ends_of_runs_miss(end, monkeypatch):
    # Those that are to slow down to a speed take hundreds of turns.
    count = 40 if "speed" in end else 60
    machines = random_machines(count, 11) | {"flywheel.inertia": np.geomspace(0.1, 3.0, count)}
    regimes = {"go": run("dc induction fan gravity cut rub", from_speed=60.0, **end)}
    names = "time angle final_speed motor_moment_rms energy_change motor_work useful_work harmful_work motor_power"
    asked, scene = " ".join(f"go.{name}" for name in names.split()), slider_crank(regimes)
    exact = ask(scene, asked, 120, varied=machines)
    monkeypatch.setattr("engine.motion.asked_regimes.RUN_TOLERANCE", 1e-4)
    rough = ask(scene, asked, 120, varied=machines)
    sound = np.array([verdict == Verdict.OK for verdict in rough.status])
    # Not all of them slow down to that speed.
    assert sound.mean() > (0.3 if "speed" in end else 0.95)
    for name in asked.split():
        error, figure = np.abs(rough.values[name] - exact.values[name])[sound], rough.errors[name][sound]
        assert (error <= figure + exact.errors[name][sound]).all(), name
        told = error > 1e-12 * np.abs(exact.values[name][sound])
        # Magnitudes of all steps are added up, of a formula of lower order.
        assert not told.any() or np.median(figure[told] / error[told]) <= 2000.0, name


@pytest.fixture
def one_thread():
    set_threads(1)
    yield
    set_threads(0)


def differing(one: object, other: object, chosen: list | slice) -> dict[str, float]:
    """Greatest relative difference by name, of values that aren't the same to the last bit."""
    found = {}
    for name in NAMES:
        a, b = one.values[name][chosen], other.values[name]
        if not np.array_equal(a, b, equal_nan=True):
            found[name] = float(np.nanmax(np.abs(a / b - 1.0)))
    return found


def test_threads_and_company__change_nothing_to_the_last_bit(one_thread):
    machines = random_machines(77, 3)
    scene = slider_crank(REGIMES)
    together = ask(scene, " ".join(NAMES), 60, varied=machines)
    set_threads(3)
    for chosen in (slice(None), [0], [5, 60, 3]):
        some = {path: values[chosen] for path, values in machines.items()}
        assert not differing(together, ask(scene, " ".join(NAMES), 60, varied=some), chosen)


class Efficient(NamedTuple):
    """A motion with a useful work, whose efficiency is undefined where that is negative."""

    work: np.ndarray

    def shifted(self, errors: "Efficient") -> "Efficient":
        return Efficient(self.work + errors.work)

    def results(self) -> dict[str, np.ndarray]:
        return {"efficiency": np.where(self.work >= 0.0, self.work / 8.0, np.nan)}


def test_result_that_an_error_makes_undefined__may_be_anything():
    motion, errors = Efficient(np.array([1.0, 1e-12, -1.0])), Efficient(np.array([0.5, -2e-12, 0.5]))
    found = spread_errors(motion, errors, Efficient.results, lambda name: True)["efficiency"]
    np.testing.assert_array_equal(found, [0.0625, np.inf, np.nan])


def test_efficiency_of_a_useful_work_of_zero__is_covered():
    # A constant moment on a link that swings does no work over a cycle; its rounding decides if there is an efficiency.
    scene = slider_crank({"go": steady("dc oil load")}, load={"on": "rod"})
    # With a field, the motion is also computed with its errors added.
    found = ask(scene, "go.efficiency go.speed.max", varied={"moments.load.moment": np.linspace(-3.0, 3.0, 9)})
    defined = np.isfinite(found.values["go.efficiency"])
    assert defined.any()
    assert (found.errors["go.efficiency"] >= found.values["go.efficiency"])[defined].all()


def test_result_that_only_some_walks_have__may_be_anything():
    given, first, last = np.array([1.0, 1.0, np.nan, np.inf]), np.array([1.1, np.nan, 1.0, np.inf]), np.ones(4)
    found = range_of_walks([given, first, last])
    assert found[0] == pytest.approx(0.1, rel=1e-12)
    assert np.array_equal(found[1:], [np.inf, np.nan, np.inf], equal_nan=True)
