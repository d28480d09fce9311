"""Fields of runs at instants and angles: closed forms, SciPy's DOP853, power balances, ends, standstill, refusals."""

import math

import numpy as np
import pytest
from each_case import refusals
from motion_scenes import (
    BY_ANGLE,
    ECCENTRIC_MASS,
    ECCENTRICITY,
    GRAVITY,
    INERTIA,
    SWUNG_INERTIA,
    WEIGHT,
    ask,
    inertia_at,
    pendulum,
    rotor,
    run,
    slider_crank,
    steady,
)
from scipy.integrate import solve_ivp

from engine import AskError, Machine, Scene

POWERS = ("motors_power", "driving_power", "useful_power", "harmful_power", "braking_power", "other_power")
# Always the same is asked, so that machines share their functions.
FIELDS = ("speed", "acceleration", "motor_moment", "load_moment", "kinetic_energy", *POWERS, "instantaneous_efficiency")


def kept(scene: dict, other: str) -> tuple:
    """Fields of the run "go", `other` among them, by their names; and what was found."""
    asked = [f"go.{name}" for name in (*FIELDS, other)]
    found = ask(scene, "go.time", 240, " ".join(asked))
    return {name.removeprefix("go."): found.fields[name][0] for name in asked}, found


def close(rows: np.ndarray, values: np.ndarray, found, name: str, sure: float, other: float = 2e-16) -> None:
    """Rows are what they should be, to their own error estimate, and both to a share of the greatest of them.

    What they are compared with is off by another share, or half a unit in the last place.
    """
    assert np.isfinite(rows).all(), name
    error, size = np.abs(rows - values).max(), np.abs(values).max()
    figure = found.figure(f"go.{name}")
    assert error <= figure + other * size, (name, error, figure)
    assert error <= sure * size, (name, error / size)
    assert figure <= 50.0 * sure * size, (name, figure / size)


# Closed forms


@pytest.mark.parametrize("speed", [10.0, -10.0])
def test_constant_moment__from_rest_by_time_and_by_angle(speed):
    way, epsilon = math.copysign(1.0, speed), 3.0 / INERTIA
    times = [0.0, 0.01, 0.2, 0.5, 1.0, 1.5]
    rows, found = kept(
        rotor({"go": run("push", from_speed=0.0, time=1.5, at={"times": times})}, speed, push={"moment": 3.0 * way}),
        "turned",
    )
    t = np.array(times)
    close(rows["speed"], epsilon * t, found, "speed", 1e-9)
    close(rows["turned"], 0.5 * epsilon * t**2, found, "turned", 1e-9)
    close(rows["acceleration"], np.full(t.size, way * epsilon), found, "acceleration", 1e-12)
    close(rows["driving_power"], 3.0 * epsilon * t, found, "driving_power", 1e-9)
    angles = [0.0, 0.1, 1.0, 5.0, 6.0]
    rows, found = kept(
        rotor({"go": run("push", from_speed=0.0, time=1.5, at={"angles": angles})}, speed, push={"moment": 3.0 * way}),
        "instant",
    )
    close(rows["speed"], np.sqrt(2.0 * epsilon * np.array(angles)), found, "speed", 1e-9)
    close(rows["instant"], np.sqrt(2.0 * np.array(angles) / epsilon), found, "instant", 1e-9)


def test_dc_motor__what_it_gives_without_a_load_is_stored():
    # I dω/dt = M₀(1 − ω/ω₀): M = M₀ e^(−t/T), T = I ω₀/M₀ = 2 s.
    t = np.linspace(0.0, 9.0, 19)
    rows, found = kept(rotor({"go": run("dc", from_speed=0.0, time=9.0, at={"times": list(t)})}), "turned")
    close(rows["motor_moment"], 20.0 * np.exp(-t / (INERTIA * 100.0 / 20.0)), found, "motor_moment", 1e-9)
    assert rows["instantaneous_efficiency"][1:] == pytest.approx(1.0, abs=1e-15)
    # At rest nothing is put in.
    assert math.isnan(rows["instantaneous_efficiency"][0])


# Another method


def by_dop853(begin: float, times: np.ndarray, only: str) -> np.ndarray:
    """Speed and angle turned of `slider_crank` under the DC motor and gravity at instants."""

    def rates(_: float, state: np.ndarray) -> list[float]:
        phi, omega = state
        inertia, slope = inertia_at(phi)
        gravity = -ECCENTRIC_MASS * ECCENTRICITY * GRAVITY * math.cos(phi)
        moment = gravity + (20.0 * (1.0 - omega / 100.0) if "dc" in only else 3.0)
        return [omega, (moment - 0.5 * omega**2 * slope) / inertia]

    found = solve_ivp(rates, (0.0, times[-1]), [0.0, begin], "DOP853", times, rtol=1e-12, atol=1e-12, first_step=1e-3)
    return found.y


@pytest.mark.parametrize(("only", "begin"), [("dc gravity", 60.0), ("dc gravity", 0.0), ("push gravity", 3.0)])
def test_slider_crank__agrees_with_dop853_at_instants_and_at_angles(only, begin):
    times = np.linspace(0.0, 0.5, 26)
    turned, speed = by_dop853(begin, times, only)
    # DOP853 misses 1e-12 in each of its some hundred steps, some of which make up for others.
    rows, found = kept(slider_crank({"go": run(only, from_speed=begin, time=0.5, at={"times": list(times)})}), "turned")
    close(rows["speed"], speed, found, "speed", 2e-10, 1e-11)
    close(rows["turned"], turned, found, "turned", 2e-10, 1e-11)
    rows, found = kept(
        slider_crank({"go": run(only, from_speed=begin, time=0.6, at={"angles": list(turned)})}), "instant"
    )
    close(rows["speed"], speed, found, "speed", 2e-10, 1e-11)
    close(rows["instant"], times, found, "instant", 2e-10, 1e-11)


# Power


def test_power__what_all_give_is_stored_and_the_efficiency_is_what_is_not_lost():
    only = "dc fan rub gravity load"
    scene = slider_crank({"go": run(only, from_speed=15.0, time=1.0, at={"times": "0 s to 1 s, 41"})})
    rows, _ = kept(scene, "turned")
    inertia, slope = np.array([inertia_at(phi) for phi in rows["turned"]]).T
    stored = rows["speed"] * (inertia * rows["acceleration"] + 0.5 * rows["speed"] ** 2 * slope)
    given = rows["motors_power"] + rows["driving_power"] + rows["other_power"]
    taken = rows["useful_power"] + rows["harmful_power"] + rows["braking_power"]
    scale = np.abs(rows["motors_power"]).max()
    # Both sides are sums of some ten numbers of that size.
    assert given - taken == pytest.approx(stored, rel=0, abs=1e-13 * scale)
    # Without weights nothing is put in but by the motor and by the kinetic energy.
    scene = slider_crank({"go": run("dc fan rub", from_speed=15.0, time=1.0, at={"times": "0 s to 1 s, 41"})})
    rows, _ = kept(scene, "turned")
    lost = rows["useful_power"] + rows["harmful_power"]
    put_in = rows["motors_power"] + np.maximum(lost - rows["motors_power"], 0.0)
    kept_back = 1.0 - rows["harmful_power"] / put_in
    assert rows["instantaneous_efficiency"] == pytest.approx(kept_back, rel=1e-12)
    assert (rows["instantaneous_efficiency"] < 1.0).all()


def test_steady_regime__its_powers_over_the_cycle_balance_and_mean_to_their_works():
    scene = slider_crank({"work": steady("dc fan rub gravity")}, 60.0, flywheel=0.5, fan={"role": "useful"})
    summaries = ["useful_work", "harmful_work", "period", "useful_power.mean", "harmful_power.mean", "efficiency"]
    summaries = " ".join(f"work.{name}" for name in summaries)
    names = [f"work.{name}" for name in (*POWERS, "instantaneous_efficiency", "instant", "speed", "kinetic_energy")]
    found = ask(scene, summaries, 240, " ".join(names))
    period = found["work.period"]
    for role in ("useful", "harmful"):
        work = f"work.{role}_work"
        found.covers(f"work.{role}_power.mean", found[work] / period, found.figure(work) / period)
    rows = {name.removeprefix("work."): found.fields[name][0] for name in names}
    assert rows["instant"][0] == 0.0
    assert (np.diff(rows["instant"]) > 0.0).all()
    assert rows["instant"][-1] < period
    assert (rows["instantaneous_efficiency"] > 0.0).all()
    assert (rows["instantaneous_efficiency"] < 1.0).all()
    # With nothing stored and given back every instant is as the cycle.
    alone = rotor({"work": steady("dc fan rub")}, 60.0, fan={"role": "useful"})
    alone["flywheel"]["inertia"] = 0.5
    found = ask(alone, summaries, 240, " ".join(names))
    assert found.fields["work.instantaneous_efficiency"][0] == pytest.approx(found["work.efficiency"], rel=1e-9)


# Ends, turning back, standing


def test_end__rows_beyond_it_are_nan_and_that_at_the_end_is_not():
    rows, found = kept(rotor({"go": run("brake", from_speed=1.0, rest=True, at={"times": "0 s to 1 s, 21"})}), "turned")
    # 0.8 N·m on 0.4 kg·m² stop 1 rad/s in 0.5 s.
    found.covers("go.time", 0.5)
    assert found.figure("go.time") <= 1e-9
    assert np.isfinite(rows["speed"]).sum() == 11
    assert np.isnan(rows["speed"][11:]).all()
    assert rows["speed"][:11] == pytest.approx(1.0 - 2.0 * np.arange(11) * 0.05, abs=1e-12)
    rows, _ = kept(rotor({"go": run("dc", from_speed=1.0, time=1.0, at={"times": [0.1, 1.0, 1.1]})}), "turned")
    assert np.isfinite(rows["speed"]).tolist() == [True, True, False]


def test_pendulum__an_angle_counts_where_it_is_passed_for_the_first_time():
    # From the horizontal down and up to the same height: half a turn, and back.
    scene = pendulum({"go": run("gravity", from_angle=math.pi, from_speed=0.0, time=3.0, at={"angles": [1.0, 3.2]})})
    rows, _ = kept(scene, "instant")
    assert rows["speed"][0] == pytest.approx(math.sqrt(2.0 * WEIGHT * math.sin(1.0) / SWUNG_INERTIA), rel=1e-9)
    assert 0.0 < rows["instant"][0] < 1.0
    assert np.isnan([row[1] for row in rows.values()]).all()


def test_standstill__a_machine_that_waits_has_no_speed_and_no_power():
    # Friction of 3.1 N·m holds it until the moment over time has grown to that, between two of the instants tested.
    changes = {"by_time": {"over_time": [0.0, 4.0, 10.0], "moment": [0.0, 6.0, 6.0]}, "rub": {"moment": 3.1}}
    scene = rotor({"go": run("by_time rub", from_speed=0.0, time=3.0, at={"times": [0.0, 1.0, 1.99, 3.0]})}, **changes)
    rows, _ = kept(scene, "turned")
    for name in ("speed", "acceleration", "kinetic_energy", "turned", *POWERS):
        assert rows[name][:3].tolist() == [0.0, 0.0, 0.0], name
    # From there I dω/dt = 1.5 t − 3.1.
    assert rows["speed"][3] == pytest.approx(0.75 * (3.0 - 3.1 / 1.5) ** 2 / INERTIA, rel=1e-9)
    # And one that nothing ever sets going stands until its time is over.
    held = rotor({"go": run("by_time rub", from_speed=0.0, time=1.0, at={"times": [0.0, 0.5, 1.0, 1.1]})}, **changes)
    rows, _ = kept(held, "turned")
    for name in ("speed", "acceleration", "turned", "motors_power"):
        assert np.array_equal(rows[name], [0.0, 0.0, 0.0, np.nan], equal_nan=True), name
    # It converts no energy, and none of it is missing.
    assert ask(held, "go.work_residual go.motor_work")["go.work_residual"] == 0.0


def test_jump__the_row_on_it_is_that_after_it():
    scene = rotor({"go": run("by_angle", from_speed=30.0, cycles=1.0, at={"angles": [0.5, 1.0, 1.5]})})
    rows, _ = kept(scene, "instant")
    # From 5 to 2 N·m over 1 rad, then from −1 to 3 over 3 rad.
    assert rows["load_moment"] == pytest.approx([3.5, -1.0, -1.0 + 4.0 * 0.5 / 3.0], rel=1e-9)


# Variants


def test_jump_at_the_end__the_row_there_is_that_before_it():
    """A run over time from the jump of a moment, a whole turn to that jump: its speed is that of the moment's work."""
    go = run("by_angle nothing", from_speed=5.0, from_angle=1.0, cycles=1.0, at={"angles": [2.0 * math.pi]})
    rows, found = kept(rotor({"go": go}), "instant")
    angles, moments = BY_ANGLE
    work = sum(0.5 * (moments[i] + moments[i + 1]) * (angles[i + 1] - angles[i]) for i in range(len(angles) - 1))
    assert rows["speed"][0] == pytest.approx(math.sqrt(25.0 + 2.0 * work / INERTIA), rel=1e-9)
    assert rows["load_moment"][0] == pytest.approx(2.0, rel=1e-9)
    assert rows["instant"][0] == pytest.approx(found["go.time"], rel=1e-12)


def test_variants__as_many_instants_in_a_piece_as_there_are_variants_may_all_be_of_one():
    # A turn is a piece: in its first the heavy rotor meets both instants, in its second the light one.
    inertias, times = np.array([0.3, 0.5]), np.array([0.76, 0.8])
    epsilon = 3.0 / inertias[:, None]
    turned, speed = (5.0 + 0.5 * epsilon * times) * times, 5.0 + epsilon * times
    assert (turned > 2.0 * math.pi).tolist() == [[True, True], [False, False]]
    scene = rotor({"go": run("push", from_speed=5.0, time=0.9, at={"times": list(times)})}, push={"moment": 3.0})
    together = ask(scene, "go.time", 240, "go.speed go.turned", {"bodies.eccentric.inertia": inertias})
    for name, true in (("go.speed", speed), ("go.turned", turned)):
        error = np.abs(together.fields[name] - true).max(axis=1)
        assert (error <= together.errors[name] + 2e-16 * true.max()).all(), name
        assert error.max() <= 1e-9 * true.max(), name
    for i in range(2):
        alone = ask(scene, "go.time", 240, "go.speed go.turned", {"bodies.eccentric.inertia": inertias[i : i + 1]})
        for name, rows in alone.fields.items():
            assert np.array_equal(rows[0], together.fields[name][i]), name
            assert alone.errors[name][0] == together.errors[name][i]


# Refusals


test_nonsense__is_refused_in_words = refusals(
    lambda at: Scene.model_validate(rotor({"go": run("dc", from_speed=1.0, time=1.0, at=at)})),
    ({}, "give times or angles"),
    ({"times": [0.0, 1.0], "angles": [1.0]}, "give times or angles"),
    ({"times": [0.0, 0.0]}, "in ascending order"),
    ({"times": [-1.0, 0.0]}, "counted from the start of the run, in ascending order"),
    ({"times": "0 s till 2 s"}, "FIRST to LAST, HOW MANY"),
    ({"times": "0 s to 2 s, 1"}, "from 2 to 100000 values"),
    ({"times": "0 m to 2 s, 3"}, "time"),
    ({"angles": []}, "from 1 to 100000 values"),
    ({"instants": [1.0]}, "unknown key; allowed: times, angles"),
)


def test_fields_of_a_run__are_kept_where_it_says_where():
    scene = Scene.model_validate(rotor({"go": run("dc", from_speed=1.0, time=1.0)}))
    with pytest.raises(AskError, match="go"):
        Machine(scene, fields=["go.speed"])
