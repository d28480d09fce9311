"""The energy form and the form in time: conservation, references at 30 digits, orders, agreement with each other."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from motion_scenes import ask, reduced, run, slider_crank
from mpmath import mp

REFERENCE = json.loads((Path(__file__).parents[1] / "oracles" / "motion_reference.json").read_text())


def order(errors: list[float]) -> float:
    """Order from errors with twice as many steps each time: of the first to the last."""
    return math.log2(errors[0] / errors[-1]) / (len(errors) - 1)


# Energy


def test_unloaded_machine__keeps_its_energy_over_1e5_revolutions():
    def found(cycles: float) -> tuple:
        scene = slider_crank({"go": run("", from_speed=20.0, from_angle=0.3, cycles=cycles, at_most=2e5)})
        return ask(scene, "go.time go.final_speed go.energy_change go.speed_max", 60)

    short, whole, both = found(0.3), found(1.0), found(1e5 + 0.3)
    assert whole["go.energy_change"] == 0.0
    # The angle is known to 2π·1e5·1.1e-16 rad, where ½ω²·dI/dφ is some 2 J/rad.
    assert abs(both["go.energy_change"]) <= 7e-11 * 4
    assert both["go.final_speed"] == pytest.approx(short["go.final_speed"], rel=7e-11)
    assert both["go.speed_max"] == whole["go.speed_max"]
    # 6e6 additions, each rounded by at most 1.1e-16; the angle of the last piece is known to 2π·1e5·1.1e-16.
    assert both["go.time"] == pytest.approx(1e5 * whole["go.time"] + short["go.time"], rel=6e6 * 1.1e-16)


def test_unloaded_machine__a_turn_takes_the_integral_of_one_over_omega():
    with mp.workdps(30):
        energy = reduced(0)[0] * 200
        time = mp.quad(lambda phi: mp.sqrt(reduced(phi)[0] / (2 * energy)), mp.linspace(0, 2 * mp.pi, 9))
        slow = mp.sqrt(2 * energy / max(reduced(phi)[0] for phi in mp.linspace(0, mp.pi, 2001)))
    found = ask(slider_crank({"go": run("", from_speed=20.0, cycles=1.0)}), "go.time go.speed_min", 120)
    # Simpson's rule over a whole period of a smooth function: all its harmonics below the 120th integrate exactly.
    assert found["go.time"] == pytest.approx(float(time), rel=1e-14)
    # At nodes: h²/8·ω″ beside the true one at most, with ω″ some 5·ω.
    assert found["go.speed_min"] == pytest.approx(float(slow), rel=2e-3)


# Two machines against mpmath at 30 digits

MACHINES = {"dc": ("dc fan gravity", 20.0, 0.0), "induction": ("induction load gravity", 15.0, 0.5)}


def three_turns(name: str, positions: int, more: str = "") -> dict[str, float]:
    only, begin, flywheel = MACHINES[name]
    scene = slider_crank({"go": run(only + more, from_speed=begin, cycles=3.0)}, flywheel=flywheel)
    found = ask(scene, "go.time go.final_speed", positions)
    return {
        "omega": found["go.final_speed"],
        "time": found["go.time"],
        "omega_figure": found.figure("go.final_speed"),
        "time_figure": found.figure("go.time"),
    }


@pytest.mark.parametrize("more", ["", " nothing"], ids=["energy form", "time form"])
@pytest.mark.parametrize("name", MACHINES)
def test_three_turns__as_mpmath_at_30_digits_with_order_4(name, more):
    counts = (60, 120, 240) if more else (240, 480, 960)
    found = [three_turns(name, positions, more) for positions in counts]
    for key in ("omega", "time"):
        errors = [abs(f[key] - float(REFERENCE[name][key])) / float(REFERENCE[name][key]) for f in found]
        # Rates of some 3 a radian: (3·h)⁴/120 on the way.
        assert errors[-1] <= 20 * (3 * 2 * math.pi / counts[-1]) ** 4 / 120, (key, errors)
        assert order(errors) >= 3.7 or errors[-1] < 1e-11, (key, errors)
        # Half the change is the figure of a method of order two; with the fewest steps order four doesn't show yet.
        for error, f in zip(errors[1:], found[1:], strict=True):
            assert error * float(REFERENCE[name][key]) <= f[f"{key}_figure"]


# Orders


def values(only: str, name: str, counts: tuple[int, ...], regime: dict, **parts: object) -> np.ndarray:
    return np.array([ask(slider_crank({"go": regime | {"only": only}}, **parts), name, n)[name] for n in counts])


def orders(found: np.ndarray) -> float:
    """Order from values with twice as many steps each time; infinite where they differ by rounding only."""
    changes = np.abs(np.diff(found))
    if changes[-1] <= 1e-11 * abs(found[-1]):
        return math.inf
    return math.log2(changes[0] / changes[-1]) / (changes.size - 1)


@pytest.mark.parametrize("name", ["go.time", "go.final_speed"])
def test_energy_form__order_4_with_smooth_moments(name):
    regime = run("", from_speed=20.0, cycles=2.3)
    assert orders(values("dc fan gravity", name, (120, 240, 480), regime, flywheel=0.05)) >= 3.8


@pytest.mark.parametrize("name", ["go.time", "go.final_speed"])
def test_energy_form__keeps_its_order_across_jumps(name):
    regime = run("", from_speed=30.0, cycles=2.3)
    found = values("dc fan gravity cut by_angle", name, (240, 480, 960, 1920), regime, flywheel=0.05)
    # The pieces beside a break vary in length, so that single ratios scatter: over two of them.
    assert orders(found) >= 3.5


@pytest.mark.parametrize("name", ["go.time", "go.final_speed"])
def test_time_form__keeps_order_4_at_least_with_smooth_moments(name):
    regime = run("", from_speed=20.0, cycles=1.3)
    assert orders(values("dc fan gravity nothing", name, (60, 120, 240), regime, flywheel=0.05)) >= 3.8


@pytest.mark.parametrize("name", ["go.time", "go.angle"])
def test_run_from_rest__order_4(name):
    regime = run("", speed=30.0)
    found = values("dc fan", name, (60, 120, 240, 480), regime, flywheel=0.5)
    assert orders(found) >= 3.5


@pytest.mark.parametrize("name", ["go.time", "go.angle"])
def test_run_to_rest__order_4(name):
    regime = run("", from_speed=30.0, rest=True)
    found = values("brake", name, (60, 120, 240, 480), regime, flywheel=0.5)
    assert orders(found) >= 3.0


@pytest.fixture
def implicit(monkeypatch):
    """Every stretch in the energy form goes by the implicit method."""
    monkeypatch.setattr(
        "engine.motion.steppers.stepping._is_steep",
        lambda dynamics, variants, tables, course: np.ones(variants.count, bool),
    )


@pytest.mark.parametrize("name", MACHINES)
def test_implicit_form__as_mpmath_at_30_digits_with_order_4(name, implicit):
    found = [three_turns(name, positions) for positions in (120, 240, 480)]
    for key in ("omega", "time"):
        errors = [abs(f[key] - float(REFERENCE[name][key])) / float(REFERENCE[name][key]) for f in found]
        # Lobatto IIIC errs by h⁵/(2!·3!·…) a step, less than RK4 in the explicit form.
        assert errors[-1] <= 20 * (3 * 2 * math.pi / 480) ** 4 / 120, (key, errors)
        assert order(errors) >= 3.7 or errors[-1] < 1e-11, (key, errors)


# One form against the other


@pytest.mark.parametrize(
    ("only", "regime"),
    [
        ("dc fan gravity", {"from_speed": 20.0, "cycles": 2.3}),
        ("induction load gravity cut", {"from_speed": 15.0, "time": 0.9}),
        ("dc fan cut", {"speed": 40.0}),
        ("brake gravity cut", {"from_speed": 20.0, "speed": 10.0}),
        ("rub cut", {"from_speed": 10.0, "rest": True}),
    ],
)
def test_energy_form_and_time_form__agree_within_their_figures(only, regime):
    names = "go.time go.angle go.final_speed go.motor_work go.useful_work go.harmful_work"
    energy, time = (
        ask(slider_crank({"go": run(only + more, **regime)}, flywheel=0.5), names, 240) for more in ("", " nothing")
    )
    for name in names.split():
        sum_of_figures = energy.figure(name) + time.figure(name)
        assert abs(energy[name] - time[name]) <= 3 * sum_of_figures + 1e-12 * abs(energy[name]), name
        # Figures alone could be large.
        assert energy[name] == pytest.approx(time[name], rel=2e-6, abs=1e-9), name
