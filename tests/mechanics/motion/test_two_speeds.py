"""Motion at two speeds, with a clutch or a fluid coupling between the crank and a shaft."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from each_case import refusals
from motion_scenes import (
    CLUTCH,
    FLUID,
    INERTIA,
    MOMENTS,
    RATIO,
    SHAFT_INERTIA,
    ask,
    behind,
    inertia_at,
    of,
    rotor,
    run,
    slider_crank,
    steady,
)
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from engine import Scene, Verdict, history

# Asked of runs, whatever is looked at, so that machines share their functions.
NAMES = "time angle final_speed energy_change work_residual clutch_heat clutch_slip_angle clutch_moment_peak"
NAMES += " clutch_slip_time clutch_lock_up_time clutch_lock_up_speed motor_shaft_final_speed"


def coupled(scene: dict, inertia: float = SHAFT_INERTIA, open_in: str = "", **clutch: object) -> dict:
    """A sample machine with its motor behind a clutch, open in some of its regimes."""
    return behind(scene, inertia, open_in, clutch=CLUTCH | clutch)


# Constant moments and inertias: closed forms


def slipping(*rows: np.ndarray) -> tuple[np.ndarray, ...]:
    """Time until the speeds agree, angle of the crank until then, and the least speed of both sides."""
    own, ratio, capacity, crank, shaft, inertia, load = rows
    slip, reduced = shaft / ratio - crank, ratio**2 * own
    pull = np.sign(slip) * ratio * capacity
    change = (load + pull) / inertia
    time = slip / (change + pull / reduced)
    end = crank + change * time
    return time, crank * time + 0.5 * change * time**2, np.minimum(np.minimum(crank, shaft), end)


def test_two_rotating_masses__come_to_one_speed_with_the_heat_of_the_closed_form():
    """u' = (M₂ − C)/J − (M₁ + C)/I is constant, and so is the moment on either side."""
    rng, n = np.random.default_rng(7), 4000
    own, ratio, capacity = 10 ** rng.uniform(-6, 3, n), 10 ** rng.uniform(-1, 2, n), 10 ** rng.uniform(-2, 4, n)
    crank, shaft = 10 ** rng.uniform(-1, 3, n), 10 ** rng.uniform(0, 4, n)
    inertia, load = 10 ** rng.uniform(-6, 3, n), rng.uniform(-0.5, 0.5, n) * capacity * ratio
    time, turned, slowest = slipping(own, ratio, capacity, crank, shaft, inertia, load)
    # Neither side comes to rest on the way, which is short.
    sound = np.flatnonzero((slowest > 0.0) & (time > 0.0) & (turned < 30.0))[:100]
    assert sound.size == 100
    every = (own, ratio, capacity, crank, shaft, inertia, load, time, turned)
    own, ratio, capacity, crank, shaft, inertia, load, time, turned = (row[sound] for row in every)
    scene = coupled(rotor({"go": run("load", from_speed=1.0, from_shaft_speed=1.0, lock_up=True)}))
    varied = {
        "bodies.eccentric.inertia": inertia,
        "shafts.motor_shaft.inertia": own,
        "shafts.motor_shaft.ratio": ratio,
        "couplings.clutch.capacity": capacity,
        "regimes.go.from_speed": crank,
        "regimes.go.from_shaft_speed": shaft,
        "moments.load.moment": load,
    }
    found = ask(scene, of("go", NAMES), varied=varied)
    assert set(found.status) == {Verdict.OK}
    slip, most = shaft / ratio - crank, ratio * capacity
    change = (load + np.sign(slip) * most) / inertia
    heat = 0.5 * most * np.abs(slip) * time
    expected = {
        "time": time,
        "clutch_slip_time": time,
        "clutch_heat": heat,
        "clutch_slip_angle": 0.5 * ratio * np.abs(slip) * time,
        "clutch_moment_peak": capacity,
        "clutch_lock_up_speed": crank + change * time,
        "energy_change": load * turned - heat,
    }
    # What is a difference rounds as its terms do. Slip is one of speeds, which may lie near each other.
    energy = 0.5 * inertia * crank**2 + 0.5 * own * shaft**2 + np.abs(load * turned)
    sizes = {"energy_change": energy, "clutch_lock_up_speed": crank + np.abs(change * time)}
    worth = 1.0 + np.abs(crank / slip)
    for key, value in expected.items():
        size = sizes.get(key, np.abs(value))
        off = np.abs(found.values[f"go.{key}"] - value) / (size * worth)
        assert off.max() < 1e-9, key
        # Figures hold, but for the rounding of the closed form itself.
        allowed = found.errors[f"go.{key}"] + 1e-13 * size * worth
        assert (np.abs(found.values[f"go.{key}"] - value) <= allowed).all(), key
    assert np.abs(found.values["go.work_residual"]).max() < 1e-10


# Against an independent simulation


def reference(capacity: float, engagement: float, until: float, shaft_speed: float) -> dict:
    """The slider-crank from rest by SciPy, phase by phase: time, both speeds, heat, slip time, and phases."""
    own, motor = RATIO**2 * SHAFT_INERTIA, MOMENTS["dc"]
    oil, fan = MOMENTS["oil"]["coefficient"], MOMENTS["fan"]["coefficient"]

    def limit(t: float) -> float:
        return RATIO * capacity * min(t / engagement, 1.0)

    def sides(y: np.ndarray) -> tuple[float, float, float]:
        whole, slope = inertia_at(y[0])
        crank = -oil * y[1] - fan * y[1] ** 2 - 0.5 * y[1] ** 2 * slope
        drive = RATIO * motor["stall_moment"] * (1 - RATIO * y[2] / motor["no_load_speed"])
        return whole, crank, drive

    def transmitted(y: np.ndarray) -> float:
        whole, crank, drive = sides(y)
        return drive - own * (crank + drive) / (whole + own)

    def slipping(way: int) -> Callable[[float, np.ndarray], list[float]]:
        def rates(t: float, y: np.ndarray) -> list[float]:
            whole, crank, drive = sides(y)
            pull = way * limit(t)
            return [y[1], (crank + pull) / whole, (drive - pull) / own, pull * (y[2] - y[1]), 1.0]

        return rates

    def together(_: float, y: np.ndarray) -> list[float]:
        whole, crank, drive = sides(y)
        change = (crank + drive) / (whole + own)
        return [y[1], change, change, 0.0, 0.0]

    t, y, mode, phases = 0.0, np.array([0.0, 0.0, shaft_speed / RATIO, 0.0, 0.0]), 1, [1]
    while t < until:
        if mode:
            end = lambda t, y: y[2] - y[1]  # noqa: E731
            end.direction = -mode
        else:
            end = lambda t, y: abs(transmitted(y)) - limit(t)  # noqa: E731
            end.direction = 1
        end.terminal = True
        stops = engagement if t < engagement else until
        how = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13, "max_step": 0.01, "events": end}
        gone = solve_ivp(slipping(mode) if mode else together, (t, stops), y, **how)
        t, y = float(gone.t[-1]), gone.y[:, -1].copy()
        if gone.status == 1:
            if mode:
                y[2] = y[1]
            need = transmitted(y)
            mode = 0 if mode and abs(need) <= limit(t) else int(math.copysign(1, need))
            phases.append(mode)
    return {"final_speed": y[1], "motor_shaft_final_speed": RATIO * y[2], "angle": y[0], "clutch_heat": y[3]} | {
        "clutch_slip_time": y[4],
        "phases": phases,
    }


def test_start_of_a_slider_crank__goes_as_an_independent_simulation_does():
    """Of the lower capacities the clutch slips again and again as the ram is sped up and slowed down."""
    capacities = np.array([0.15, 0.2, 0.3, 3.0])
    scene = coupled(slider_crank({"go": run("dc oil fan", from_speed=0.0, from_shaft_speed=90.0, time=1.2)}))
    scene["couplings"]["clutch"]["engagement"] = 0.3
    varied = {"couplings.clutch.capacity": capacities}
    names = "angle final_speed motor_shaft_final_speed clutch_heat clutch_slip_time work_residual clutch_moment_peak"
    found = ask(scene, of("go", names), varied=varied)
    assert found.status == [Verdict.OK] * 4
    phases = []
    for i, capacity in enumerate(capacities):
        known = reference(capacity, 0.3, 1.2, 90.0)
        phases.append(len(known.pop("phases")))
        for key, value in known.items():
            assert found.values[f"go.{key}"][i] == pytest.approx(value, rel=2e-8), (key, capacity)
            # SciPy's own error, with a relative tolerance of 1e-12 a step over some hundred steps, and its events.
            allowed = found.errors[f"go.{key}"][i] + 1e-8 * abs(value)
            assert abs(found.values[f"go.{key}"][i] - value) <= allowed
    assert max(phases) > 4
    assert np.abs(found.values["go.work_residual"]).max() < 1e-9
    assert (found.values["go.clutch_moment_peak"] <= capacities * (1 + 1e-9)).all()


def test_light_shaft_of_a_slipping_clutch__takes_implicit_steps():
    """J ω' = M₀ (1 − ω/ω₀) − C comes to its speed within microseconds; the crank speeds up evenly."""
    own, until, capacity, motor = 4e-6, 0.1, 4.0, MOMENTS["dc"]
    scene = coupled(rotor({"go": run("dc", from_speed=0.0, from_shaft_speed=90.0, time=until)}), own, capacity=capacity)
    # Of a line alone the slope is a constant of the machine.
    regime, moments = scene["regimes"]["go"], scene["moments"]
    regime["off"] = [name for name in regime["off"] if name not in moments]
    scene["moments"] = {"dc": moments["dc"]}
    found = ask(scene, of("go", "final_speed motor_shaft_final_speed clutch_heat motor_work implicit_steps"))
    stall, fastest = motor["stall_moment"], motor["no_load_speed"]
    speed, decay, rise = fastest * (1.0 - capacity / stall), stall / fastest / own, RATIO * capacity / INERTIA
    turned = speed * until + (90.0 - speed) / decay
    work = capacity * turned + 0.5 * own * (speed**2 - 90.0**2)
    expected = {"final_speed": rise * until, "motor_shaft_final_speed": speed, "motor_work": work}
    expected["clutch_heat"] = capacity * (turned - 0.5 * RATIO * rise * until**2)
    assert speed > RATIO * rise * until
    assert found["go.implicit_steps"] == 1.0
    for key, value in expected.items():
        assert found[f"go.{key}"] == pytest.approx(value, rel=1e-9), key
        found.covers(f"go.{key}", value, 1e-13 * value)


# From one first step, those of the three walks are 4ᵏ, 2·16ᵏ and √2·8ᵏ times as long, and the last one ends where the
# motion does. The error of a step is as the ninth power of its length. For any duration up to 1e4 first steps, the
# range of the errors of the walks is at least this fraction of that of the finest (for 5.41 of them).
LEAST_RANGE = 0.757


def test_short_slip_of_a_clutch__is_covered_however_few_its_steps():
    """J ω' = M₀ (1 − ω/ω₀) − C slows the shaft down exponentially until it meets the crank, which speeds up evenly."""
    own, capacity, motor, starts = 4e-3, 30.0, MOMENTS["dc"], np.geomspace(5.0, 300.0, 64)
    regime = run("dc", from_speed=0.0, from_shaft_speed=90.0, lock_up=True)
    scene, varied = coupled(rotor({"go": regime}), own, capacity=capacity), {"regimes.go.from_shaft_speed": starts}
    found = ask(scene, "go.time go.angle", varied=varied, accuracy=1e-3)
    stall, fastest = motor["stall_moment"], motor["no_load_speed"]
    speed, decay, rise = fastest * (1.0 - capacity / stall), stall / fastest / own, RATIO**2 * capacity / INERTIA

    def apart(time: float, start: float) -> float:
        return speed + (start - speed) * math.exp(-decay * time) - rise * time

    times = np.array([brentq(apart, 0.0, 1.0, start, xtol=1e-19, rtol=1e-15) for start in starts])
    off = np.abs(found.values["go.time"] - times) - 2e-15 * times
    assert (LEAST_RANGE * off <= found.errors["go.time"]).all()
    off = np.abs(found.values["go.angle"] - 0.5 * rise / RATIO * times**2) - 4e-15 * found.values["go.angle"]
    assert (LEAST_RANGE * off <= found.errors["go.angle"]).all()


def test_run_behind_a_clutch__ends_after_its_cycles_wherever_it_locks():
    """It locks after 0.73 rad; that angle plus the rounded rest isn't the end where the end has an odd last bit."""
    scene = coupled(rotor({"go": run("dc", from_speed=2.0, from_shaft_speed=90.0, cycles=2.0)}))
    cycles = np.random.default_rng(3).uniform(0.28, 0.315, 64)
    found = ask(scene, of("go", "angle clutch_slip_time"), varied={"regimes.go.cycles": cycles})
    assert set(found.status) == {Verdict.OK}
    np.testing.assert_allclose(found.values["go.angle"], 2.0 * math.pi * cycles, rtol=1e-15)


def test_load_that_sags_before_its_clutch_grips__is_caught():
    """ω' = (−L + C t/T)/I up to T, and (C − L)/I then: back, to rest, and forth, in implicit steps by a light shaft."""
    load, capacity, rising, until, motor = 18.0, 4.0, 0.01, 0.1, MOMENTS["dc"]
    go = run("dc load", from_speed=0.0, from_shaft_speed=80.0, time=until)
    scene = coupled(rotor({"go": go}, load={"moment": -load}), 4e-6, capacity=capacity, engagement=rising)
    found = ask(scene, of("go", "final_speed speed_min motor_shaft_final_speed implicit_steps"))
    most = RATIO * capacity
    expected = {
        "final_speed": (most * (until - 0.5 * rising) - load * until) / INERTIA,
        "speed_min": -0.5 * load**2 * rising / most / INERTIA,
        "motor_shaft_final_speed": motor["no_load_speed"] * (1.0 - capacity / motor["stall_moment"]),
    }
    assert found["go.implicit_steps"] == 1.0
    for key, value in expected.items():
        found.covers(f"go.{key}", value, 1e-13 * abs(value))


# What becomes of it


def test_capacity_below_the_load__never_brings_the_sides_together():
    scene = coupled(slider_crank({"go": run("dc rub", from_shaft_speed=90.0, lock_up=True)}))
    varied = {"couplings.clutch.capacity": [0.99 * 0.4 / RATIO, 2.0 * 0.4 / RATIO]}
    found = ask(scene, "go.work_residual", varied=varied)
    assert found.status == [Verdict.SLIPS, Verdict.OK]


def test_clutch_between_sides_at_rest__slips_where_one_is_held_and_the_other_pulls_beyond_its_capacity():
    """A motor on a crank held by friction, and a load against a shaft held by friction: together both would stand."""
    capacity, until, motor = 4.0, 0.01, MOMENTS["dc"]
    still = {"from_speed": 0.0, "from_shaft_speed": 0.0, "time": until}
    scene = rotor({"go": run("dc rub", **still)}, rub={"moment": 200.0})
    found = ask(coupled(scene, capacity=capacity), of("go", NAMES))
    # J ω' = M₀ (1 − ω/ω₀) − C.
    stall, fastest = motor["stall_moment"], motor["no_load_speed"]
    speed = fastest * (1.0 - capacity / stall) * -math.expm1(-stall / fastest / SHAFT_INERTIA * until)
    assert found["go.motor_shaft_final_speed"] == pytest.approx(speed, rel=1e-9)
    assert found["go.final_speed"] == 0.0
    scene = rotor({"go": run("load rub", **still)}, rub={"moment": 20.0, "on": "motor_shaft"})
    loads = np.array([-40.0, -20.0])
    found = ask(coupled(scene, capacity=capacity), of("go", NAMES), varied={"moments.load.moment": loads})
    assert found.status == [Verdict.OK] * 2
    slipping = np.minimum(loads + RATIO * capacity, 0.0) / INERTIA * until
    assert found.values["go.final_speed"] == pytest.approx(slipping, rel=1e-9)
    assert (found.values["go.motor_shaft_final_speed"] == 0.0).all()


SLIPS = [{"lock_up": True}, {"rest": True}, {"speed": 30.0}, {"cycles": 3.0}]
FALLS = [*((run("dc load", from_shaft_speed=80.0, **end), 4.0, Verdict.SLIPS) for end in SLIPS)]
FALLS += [(run("load", from_speed=0.0, rest=True), 90.0, Verdict.NO_END)]


@pytest.mark.parametrize(("go", "capacity", "verdict"), FALLS)
def test_load_that_falls__is_known_to_fall_for_ever_after_a_cycle(go, capacity, verdict):
    scene = coupled(rotor({"go": go}, load={"moment": -40.0}), capacity=capacity)
    assert ask(scene, of("go", NAMES)).status == [verdict]
    assert history(Scene.model_validate(scene)).angle[-1] == pytest.approx(-4.0 * math.pi)


def test_clutch_that_slips_on__is_told_of_a_crank_that_slows_down_where_its_cycles_begin():
    # The motor's side slips at 0.8 N·m · 7.5, which carries the drag at 7.5 rad/s; the eccentric rises from φ = 0 on.
    scene = slider_crank({"go": run("dc oil gravity", speed=10.0)}, oil={"coefficient": 0.8})
    scene = coupled(scene, capacity=0.8)
    assert ask(scene, of("go", NAMES)).status == [Verdict.SLIPS]
    # By I/(0.8 N·m·s) < 0.1 s the crank forgets within an eighth of a turn all but a share of 1/e.
    assert history(Scene.model_validate(scene)).angle[-1] < math.log(1e16) / 8.0 * 2.0 * math.pi


def test_steady_motion__slips_where_the_clutch_holds_less_than_it_takes():
    scene = coupled(slider_crank({"work": steady("dc oil")}))
    most = ask(scene, "work.clutch_moment_peak work.mean_speed")
    peak, figure = most["work.clutch_moment_peak"], most.figure("work.clutch_moment_peak")
    found = ask(scene, "work.mean_speed", varied={"couplings.clutch.capacity": [peak - 2 * figure, peak + 2 * figure]})
    assert found.status == [Verdict.SLIPS, Verdict.OK]
    # In a run it slips from just there, once it goes as in steady motion.
    runs = coupled(slider_crank({"work": steady("dc oil"), "on": run("dc oil", cycles=2.0)}))
    names = "on.clutch_heat on.clutch_moment_peak on.work_residual"
    found = ask(runs, names, varied={"couplings.clutch.capacity": [4.0, 1.01 * peak]})
    assert found.status == [Verdict.OK] * 2
    assert found.values["on.clutch_heat"] == pytest.approx(0.0, abs=1e-12)
    off = np.abs(found.values["on.clutch_moment_peak"] - peak)
    assert (off <= figure + found.errors["on.clutch_moment_peak"]).all()


def test_regimes_of_a_press__spin_up_couple_and_brake():
    """The motor alone, then with the machine, then the machine braked with the clutch open."""
    regimes = {"spin": run("dc", time=1.0), "start": run("dc rub", lock_up=True), "stop": run("brake", rest=True)}
    scene = coupled(rotor(regimes), open_in="spin stop")
    names = "spin.motor_shaft_final_speed spin.final_speed start.time start.final_speed start.motor_shaft_final_speed"
    found = ask(scene, f"{names} stop.time stop.brake_heat stop.motor_shaft_final_speed")
    decay = MOMENTS["dc"]["stall_moment"] / (MOMENTS["dc"]["no_load_speed"] * SHAFT_INERTIA)
    assert found["spin.motor_shaft_final_speed"] == pytest.approx(100.0 * -math.expm1(-decay), rel=1e-9)
    assert found["spin.final_speed"] == 0.0
    speed = found["start.final_speed"]
    assert found["start.motor_shaft_final_speed"] == pytest.approx(RATIO * speed, rel=1e-12)
    assert found["stop.time"] == pytest.approx(0.4 * speed / 0.8, rel=1e-9)
    assert found["stop.brake_heat"] == pytest.approx(0.2 * speed**2, rel=1e-9)
    assert found["stop.motor_shaft_final_speed"] == pytest.approx(RATIO * speed, rel=1e-12)
    seen = history(Scene.model_validate(scene))
    assert seen.verdict == Verdict.OK
    ends = {name: np.flatnonzero(seen.regime == name)[-1] for name in regimes}
    assert seen.shaft_speed[ends["spin"]] == pytest.approx(found["spin.motor_shaft_final_speed"], rel=1e-9)
    assert seen.speed[ends["start"]] == pytest.approx(speed, rel=1e-9)
    slips = (seen.regime == "start") & (seen.shaft_speed > RATIO * seen.speed * (1 + 1e-9))
    assert seen.coupling_moment[slips] == pytest.approx(RATIO * 4.0, rel=1e-9)


def test_sides_without_inertia__are_told():
    scene = coupled(rotor({"go": run("dc", time=0.1)}))
    assert ask(scene, "go.time", varied={"shafts.motor_shaft.inertia": [0.0]}).status == [Verdict.NO_INERTIA]


def test_clutch_open_and_nothing_driving__leaves_the_machine_standing():
    scene = coupled(rotor({"go": run("dc", speed=5.0)}), open_in="go")
    assert ask(scene, "go.time").status == [Verdict.STALLS]


# A fluid coupling

STEADY = "mean_speed motor_shaft_mean_speed fluid_slip fluid_heat fluid_moment_peak multiplier speed_fluctuation"
STEADY += " period motor_work work_residual return_residual"


def test_steady_motion_through_a_fluid__balances_motor_and_load():
    """Under a constant load both speeds are constant, the motor's by its line and the crank's by the slip."""
    found = ask(behind(rotor({"work": steady("dc load")}), fluid=FLUID), of("work", STEADY))
    factor, load = 1e-3 * 860.0 * 0.2**5 * RATIO**3, 2.0
    motor = 100.0 / RATIO * (1.0 - load / (RATIO * MOMENTS["dc"]["stall_moment"]))
    crank = motor - load / (factor * motor)
    assert found["work.motor_shaft_mean_speed"] == pytest.approx(RATIO * motor, rel=1e-9)
    assert found["work.mean_speed"] == pytest.approx(crank, rel=1e-9)
    assert found["work.fluid_slip"] == pytest.approx(1.0 - crank / motor, rel=1e-9)
    assert found["work.fluid_heat"] == pytest.approx(2.0 * math.pi * load * (motor / crank - 1.0), rel=1e-9)
    assert found["work.fluid_moment_peak"] == pytest.approx(load / RATIO, rel=1e-9)
    assert abs(found["work.work_residual"]) < 1e-10
    # Of the linear equations of small disturbances over the time of a cycle, at constant load, in the crank's angle.
    own = RATIO**2 * SHAFT_INERTIA
    fall = RATIO**2 * MOMENTS["dc"]["stall_moment"] / 100.0
    a, b = -factor * motor, factor * (2.0 * motor - crank)
    rates = np.linalg.eigvals([[a / 0.4, b / 0.4], [-a / own, -(b + fall) / own]])
    expected = math.exp(max(rates.real) * 2.0 * math.pi / crank)
    # What steps miss by what the cycles begin apart: 1e-9 over 3e-4.
    assert found["work.multiplier"] == pytest.approx(expected, abs=1e-5)
    found.covers("work.multiplier", expected)


KNOTS, SHARES = [0.0, 0.03, 0.1, 1.0], [0.0, 0.002, 0.005, 0.008]


def through_knots(density: float, until: float, shaft_speed: float) -> dict:
    """The slider-crank from rest through a fluid coupling by SciPy, from knot to knot of the coupling's table."""
    own, motor, factor = RATIO**2 * SHAFT_INERTIA, MOMENTS["dc"], density * 0.2**5 * RATIO**3
    t, y, way, piece, pieces = 0.0, np.array([0.0, 0.0, shaft_speed / RATIO, 0.0, 0.0, 0.0]), 1, 2, []
    while t < until:
        rise = (SHARES[piece + 1] - SHARES[piece]) / (KNOTS[piece + 1] - KNOTS[piece])

        def slip(y: np.ndarray, way: int = way) -> float:
            return 1.0 - (y[1] / y[2] if way > 0 else y[2] / y[1])

        def rates(_: float, y: np.ndarray, way: int = way, piece: int = piece, rise: float = rise) -> list[float]:
            whole, slope = inertia_at(y[0])
            crank = -MOMENTS["fan"]["coefficient"] * y[1] ** 2 - 0.5 * y[1] ** 2 * slope
            drive = RATIO * motor["stall_moment"] * (1 - RATIO * y[2] / motor["no_load_speed"])
            pull = way * factor * (SHARES[piece] + rise * (slip(y) - KNOTS[piece])) * max(y[1], y[2]) ** 2
            apart = y[2] - y[1]
            return [y[1], (crank + pull) / whole, (drive - pull) / own, pull * apart, way * apart, y[2]]

        low = lambda _, y: slip(y) - KNOTS[piece]  # noqa: B023, E731
        high = lambda _, y: KNOTS[piece + 1] - slip(y)  # noqa: B023, E731
        for end in (low, high):
            end.terminal, end.direction = True, -1
        how = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13, "max_step": 0.002, "events": (low, high)}
        gone = solve_ivp(rates, (t, until), y, **how)
        t, y = float(gone.t[-1]), gone.y[:, -1]
        pieces.append(way * (piece + 1))
        if gone.t_events[1].size:
            piece += 1
        elif gone.t_events[0].size:
            way, piece = (way, piece - 1) if piece else (-way, 0)
    ends = {"angle": y[0], "final_speed": y[1], "motor_shaft_final_speed": RATIO * y[2], "fluid_heat": y[3]}
    return ends | {"fluid_slip_angle": RATIO * y[4], "fluid_slip": y[4] / y[5], "pieces": pieces}


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9])
def test_start_through_a_fluid__goes_as_an_independent_simulation_from_knot_to_knot(tolerance, monkeypatch):
    """The ram speeds up and slows down the crank, so that either side is the faster one in turn."""
    monkeypatch.setattr("engine.motion.asked_regimes.RUN_TOLERANCE", tolerance)
    scene = slider_crank({"go": run("dc fan", from_speed=0.0, from_shaft_speed=90.0, time=1.2)})
    scene = behind(scene, fluid=FLUID | {"slip": KNOTS, "coefficient": SHARES})
    densities = np.array([8.0, 10.0, 14.0, 40.0])
    names = "angle final_speed motor_shaft_final_speed fluid_heat fluid_slip_angle fluid_slip work_residual"
    found = ask(scene, of("go", names), varied={"couplings.fluid.density": densities})
    assert found.status == [Verdict.OK] * 4
    for i, density in enumerate(densities):
        known = through_knots(density, 1.2, 90.0)
        pieces = known.pop("pieces")
        assert len(pieces) > 10
        assert min(pieces) < 0 < max(pieces)
        for key, value in known.items():
            # SciPy's own error, with a relative tolerance of 1e-12 a step over some hundred steps, and its events.
            error, own = abs(found.values[f"go.{key}"][i] - value), 1e-9 * abs(value)
            assert error <= found.errors[f"go.{key}"][i] + own, (key, density)
            assert error <= tolerance * abs(value) + own, (key, density)
    assert np.abs(found.values["go.work_residual"]).max() < 1e-9


def through_oil(slope: float, own: float, speeds: np.ndarray, *cycles: float) -> np.ndarray:
    """Both speeds, heat of the coupling, work of the motor and time after some cycles, by SciPy's stiff method."""
    own, oil, motor = RATIO**2 * own, MOMENTS["oil"]["coefficient"], MOMENTS["dc"]
    factor = slope * 860.0 * 0.2**5 * RATIO**3

    def rates(phi: float, y: np.ndarray) -> list[float]:
        whole, change = inertia_at(phi)
        pull = factor * y[1] * (y[1] - y[0])
        drive = RATIO * motor["stall_moment"] * (1.0 - RATIO * y[1] / motor["no_load_speed"])
        crank = -2.0 - oil * y[0] - 0.5 * y[0] ** 2 * change + pull
        every = [crank / whole, (drive - pull) / own, pull * (y[1] - y[0]), drive * y[1], 1.0]
        return [value / y[0] for value in every]

    begin = [*speeds, 0.0, 0.0, 0.0]
    ends = 2.0 * math.pi * np.array(cycles)
    return solve_ivp(rates, (0.0, ends[-1]), begin, "LSODA", ends, rtol=1e-11, atol=1e-13).y.T


def test_steep_fluid_coupling__goes_as_a_stiff_integrator_does():
    """The coupling pulls the speeds together within a thousandth of a cycle, and less."""
    slopes, own = np.array([0.1, 1.0]), np.array([4e-4, 4e-5])
    go = run("dc oil load", from_speed=9.0, from_shaft_speed=99.0, cycles=1.3)
    scene = behind(slider_crank({"go": go, "work": steady("dc oil load")}), fluid=FLUID)
    # λ by a table isn't varied: a coupling of another density drives as one of another slope does.
    varied = {"couplings.fluid.density": 860.0 * slopes / 1e-3, "shafts.motor_shaft.inertia": own}
    names = "final_speed motor_shaft_final_speed fluid_heat motor_work time"
    asked = of("go", f"{names} implicit_steps") + " work.fluid_heat work.period work.return_residual"
    found = ask(scene, asked, varied=varied)
    assert found.status == [Verdict.OK] * 2
    assert (found.values["go.implicit_steps"] == 1.0).all()
    for i in range(2):
        ((first, second, heat, work, time),) = through_oil(slopes[i], own[i], np.array([9.0, 99.0 / RATIO]), 1.3)
        for key, value in zip(names.split(), (first, RATIO * second, heat, work, time), strict=True):
            # SciPy's own error: 1e-11 a step, over some thousand steps.
            assert found.values[f"go.{key}"][i] == pytest.approx(value, rel=1e-8), (key, i)
            allowed = found.errors[f"go.{key}"][i] + 1e-8 * abs(value)
            assert abs(found.values[f"go.{key}"][i] - value) <= allowed, (key, i)
        # Cycles forget their begin within the first.
        before, after = through_oil(slopes[i], own[i], np.array([13.0, 13.0]), 2.0, 3.0)
        assert found.values["work.fluid_heat"][i] == pytest.approx(after[2] - before[2], rel=1e-6)
        assert found.values["work.period"][i] == pytest.approx(after[4] - before[4], rel=1e-7)
    assert np.abs(found.values["work.return_residual"]).max() < 1e-9


def test_run_that_ends_after_a_knot__is_covered_by_its_figures():
    """All walks start anew at a knot; each divides the rest into other steps."""
    regime = run("dc fan", from_speed=3.0, from_shaft_speed=90.0, time=1.0)
    scene = behind(slider_crank({"go": regime}), 4e-4, fluid=FLUID | {"slip": KNOTS, "coefficient": SHARES})
    names, varied = of("go", "final_speed motor_shaft_final_speed"), {"regimes.go.time": np.linspace(0.2, 0.5, 128)}
    exact, found = (ask(scene, names, varied=varied, accuracy=accuracy) for accuracy in (1e-11, 1e-4))
    for name, values in found.values.items():
        off = np.abs(values - exact.values[name]) - exact.errors[name]
        assert (LEAST_RANGE * off <= found.errors[name]).all()


def test_load_beyond_what_a_fluid_drives__stalls():
    scene, varied = behind(rotor({"work": steady("dc load")}), fluid=FLUID), {"moments.load.moment": [-2.0, -2000.0]}
    assert ask(scene, of("work", STEADY), varied=varied).status == [Verdict.OK, Verdict.STALLS]


# What is refused


def without_meaning(change):
    scene = coupled(rotor({}))
    scene["forces"], scene["moments"] = {}, {}
    scene["regimes"] = {"go": {"type": "run", "lock_up": True}}
    ask(scene | change, "go.time")


DC = {"type": "dc_motor", "no_load_speed": 9.0, "stall_moment": 1.0}
BY = {"type": "formula", "moment": "1 N m * sin(phi)"}
test_what_has_no_meaning__is_refused = refusals(
    without_meaning,
    ({"couplings": {"clutch": CLUTCH | {"shaft": "crank"}}}, "'crank' is not a shaft geared to the crank"),
    ({"couplings": {"a": CLUTCH, "b": CLUTCH}}, "keep only one coupling"),
    ({"couplings": {"fluid": FLUID}}, "no friction clutch is engaged here"),
    ({"couplings": {}}, "no friction clutch is engaged here"),
    ({"shafts": {"motor_shaft": {"geared_to": "crank", "ratio": 2.0, "pivot": "O"}}}, "has a pivot"),
    ({"moments": {"m": BY | {"on": "motor_shaft"}}}, "may depend on that speed only"),
    (
        {"moments": {"m": BY | {"on": "crank", "moment": "-1 N m s * motor_shaft.angular_velocity"}}},
        "'motor_shaft' turns at a separate speed",
    ),
    ({"moments": {"m": DC | {"on": "motor_shaft"}, "n": DC | {"on": "crank"}}}, "motors are on both of its sides"),
)


test_engagement_given_wrongly__is_refused = refusals(
    lambda change: Scene.model_validate(coupled(rotor({}), **change)),
    ({"over_time": [0.0, 1.0]}, "over_time and share belong together"),
    ({"over_time": [0.0, 1.0], "share": [0.0, 1.0], "engagement": 1.0}, "engagement and over_time are given"),
    ({"over_time": [1.0, 0.5], "share": [0.0, 1.0]}, "must rise from 0 s"),
)


@pytest.mark.parametrize("accuracy", [1e-2, 1e-6])
def test_clutch_that_slips_for_a_moment__is_seen_between_the_ends_of_a_step(accuracy):
    """A locked clutch accelerates its shaft with the crank: it slips where that takes more than its capacity."""
    own = RATIO**2 * SHAFT_INERTIA
    go = run("", from_speed=5.0, from_shaft_speed=5.0 * RATIO, time=1.2)
    scene = coupled(rotor({"go": go}))
    jolt = {"type": "formula", "on": "crank", "moment": "m * exp(-((t - at) / width)^2)"}
    scene["moments"]["jolt"] = jolt | {"numbers": {"m": "20 N m", "at": "0.61 s", "width": "0.11 s"}}
    needed = 20.0 * own / (INERTIA + own)
    capacity = needed / RATIO * np.linspace(0.9, 1.1, 40)
    names = of("go", "clutch_slip_time clutch_moment_peak clutch_heat motor_shaft_final_speed")
    found, exact = (
        ask(scene, names, varied={"couplings.clutch.capacity": capacity}, accuracy=wanted)
        for wanted in (accuracy, 1e-11)
    )
    assert ((found.values["go.clutch_slip_time"] > 0.0) == (capacity < needed / RATIO)).all()
    assert (found.values["go.clutch_moment_peak"] <= capacity * (1 + 1e-9)).all()
    for name in names.split():
        off = np.abs(found.values[name] - exact.values[name])
        assert (off <= 2 * found.errors[name] + exact.errors[name] + 1e-12 * exact.values[name]).all(), name


def test_steady_motion_through_a_fluid__is_what_a_run_comes_to():
    """What is left of a disturbance after a cycle is 1e-9 of it here, so that three of them forget their begin."""
    to_it = {"early": run("dc oil load", from_speed=9.0, cycles=3.0), "last": run("dc oil load", cycles=1.0)}
    scene = behind(slider_crank({**to_it, "work": steady("dc oil load")}), fluid=FLUID)
    names = "speed_min speed_max fluid_heat motor_work fluid_slip fluid_moment_peak"
    loads = "drive.inner.reaction.max input_moment.min acceleration.max frame.reaction_moment.max"
    names = f"{names} {loads}"
    fields = "work.speed work.instant work.kinetic_energy"
    own = of("work", "return_residual multiplier speed_fluctuation")
    found = ask(scene, f"{of('work', names)} {of('last', names)} {own}", fields=fields)
    assert found.status == [Verdict.OK]
    low, high = found["work.speed_min"], found["work.speed_max"]
    assert found["work.speed_fluctuation"] == pytest.approx(2.0 * (high - low) / (high + low), rel=1e-12)
    assert abs(found["work.multiplier"]) < 1e-6
    for name in names.split():
        figure = found.figure(f"work.{name}") + found.figure(f"last.{name}")
        assert abs(found[f"work.{name}"] - found[f"last.{name}"]) <= figure + 1e-9 * abs(found[f"work.{name}"]), name
    assert found["work.return_residual"] < 1e-9
    # dt/dφ = 1/ω, by the trapezoidal rule for what is periodic.
    speeds, instants = found.fields["work.speed"][0], found.fields["work.instant"][0]
    period = np.mean(1.0 / speeds) * 2.0 * math.pi
    assert instants[0] == pytest.approx(0.0, abs=1e-12)
    assert instants[60] / period == pytest.approx(np.mean(1.0 / speeds[:60]) / 2 / np.mean(1.0 / speeds), rel=1e-2)
    assert found.values["last.input_moment.min"][0] > 0.0
    seen = history(Scene.model_validate(behind(slider_crank({"work": steady("dc oil load")}), fluid=FLUID)))
    assert seen.verdict == Verdict.OK
    assert (seen.shaft_speed > RATIO * seen.speed).all()
    assert np.ptp(seen.angle) == pytest.approx(2.0 * math.pi, rel=1e-12)
