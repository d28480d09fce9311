"""Motors by a table of their torque over their speed: in every regime, against formulas, closed forms and phases."""

import math

import machines
import numpy as np
import pytest
from element_samples import figures
from motion_scenes import CLUTCH, INERTIA, RATIO, SHAFT_INERTIA, ask, behind, rotor, run, slider_crank, steady
from scipy.integrate import solve_ivp

# Rises to a hump, falls through zero, and brakes on the line of its last rows.
SPEED, MOMENT = [0.0, 20.0, 60.0, 90.0, 100.0], [8.0, 6.0, 12.0, 7.5, 0.0]
TABLE = {"type": "table_motor", "speed": SPEED, "moment": MOMENT}
# The same on the crank, in steps of its slope.
SLOPES = (np.diff(MOMENT) / np.diff(SPEED)).tolist()
FORMULA = f"{RATIO} * (8 N m + ({SLOPES[0]!r} N m s) * {RATIO} * omega"
for change, knot in zip(np.diff(SLOPES).tolist(), SPEED[1:-1], strict=True):
    FORMULA += f" + ({change!r} N m s) * max({RATIO} * omega - {knot} rad/s, 0 rad/s)"
FORMULA += ")"


def torque(speed: float) -> float:
    """By hand, the last line going on."""
    return float(np.interp(speed, SPEED, MOMENT)) + min(100.0 - speed, 0.0) * 0.75


def driven(scene: dict) -> dict:
    """A sample machine with the motor by the table, on its shaft, and with the formula of it on the crank."""
    scene["moments"]["dc"] = TABLE | {"on": "motor_shaft"}
    scene["moments"]["said"] = {"type": "formula", "on": "crank", "role": "driving", "moment": FORMULA}
    for name, regime in scene["regimes"].items():
        regime["off"] = [*regime["off"], "dc" if name.startswith("said") else "said"]
    return scene


START, WORK = run("dc rub cut", from_speed=1.0, cycles=3.0), steady("dc rub oil cut")
REGIMES = {"start": START, "work": WORK, "said_start": START, "said_work": WORK}
ASKED = "start.time start.final_speed start.speed_min work.mean_speed work.speed_min work.speed_max work.multiplier"


def test_regimes_under_a_table__are_those_under_its_formula():
    # What the formula does is no motor's work, though that of a driving moment.
    pairs = {name: f"said_{name}" for name in ASKED.split()} | {"start.motor_work": "said_start.driving_work"}
    found = ask(driven(slider_crank(REGIMES)), " ".join([*pairs, *pairs.values(), "start.motor_moment_peak"]))
    # At the hump, reduced to the crank: more than at both ends.
    assert found["start.motor_moment_peak"] == pytest.approx(RATIO * 12.0, rel=1e-12)
    for name, said in pairs.items():
        found.covers(name, found[said], found.figure(said) + 1e-13 * abs(found[said]))
        assert found.figure(name) <= 1e-5 * abs(found[name])


def test_torque_at_the_speed_of_the_scene__is_that_of_the_table():
    for speed in (1.0, 7.0, 14.0):
        scene = rotor({}, speed)
        scene["moments"]["dc"] = TABLE | {"on": "motor_shaft"}
        found = ask(scene, "motor_moment")
        induction = ask({**rotor({}, speed), "moments": {"dc": rotor({})["moments"]["induction"]}}, "motor_moment")
        both = RATIO * torque(RATIO * speed) + induction["motor_moment"]
        assert found["motor_moment"] == pytest.approx(both, rel=1e-13)


def test_start_through_a_clutch__goes_as_a_general_integrator_does():
    capacity, load = 1.5, 0.4
    scene = driven(rotor({"start": run("dc rub", from_speed=0.0, from_shaft_speed=80.0, time=0.4)}))
    scene = behind(scene, clutch=CLUTCH | {"capacity": capacity})
    found = ask(scene, "start.final_speed start.motor_shaft_final_speed start.clutch_heat")

    def rates(_: float, y: np.ndarray) -> list[float]:
        return [(RATIO * capacity - load) / INERTIA, (torque(y[1]) - capacity) / SHAFT_INERTIA]

    gone = solve_ivp(rates, (0.0, 0.4), [0.0, 80.0], method="DOP853", rtol=1e-12, atol=1e-12, max_step=1e-3)
    # Bends cost the general integrator some of its digits.
    for name, value in zip(("final_speed", "motor_shaft_final_speed"), gone.y[:, -1], strict=True):
        found.covers(f"start.{name}", value, 1e-9 * value)


def test_start_on_an_elastic_shaft__is_that_of_two_masses():
    shaft = {"stiffness": 400.0, "damping": 0.4}
    table = {"speed": [0.0, 2.0, 5.0, 20.0], "moment": [80.0, 60.0, 140.0, 0.0]}
    two = {"type": "two_mass_drive", "motor_inertia": 0.2, "load_inertia": INERTIA, "time": 0.3, **shaft}
    names = ("greatest_moment", "greatest_moment_at", "motor_speed", "load_speed")
    expected, room = zip(*figures(two | {"motor": {"type": "table"} | table}, *names), strict=True)
    scene = machines.slider_crank(0.05, 0.2, 12.0, "drive") | {"moments": {"m": {"type": "table_motor", **table}}}
    scene["moments"]["m"]["on"] = "crank"
    scene["bodies"] = {"wheel": {"link": "crank", "mass": 0.0, "x": 0.0, "inertia": INERTIA}}
    # Steady motion, whose results go with those of the run, needs a load.
    scene["moments"]["load"] = {"type": "linear_drag", "on": "crank", "coefficient": 1.0}
    start = {"begin": "at rest", "time": 0.3, "off": ["load"]}
    scene["elements"] = {"d": {"type": "machine_drive", "motor_inertia": 0.2, **shaft, "run": start}}
    keys = ["d.run_greatest_moment", "d.run_greatest_at", "d.run_motor_speed", "d.run_machine_speed", "d.mean_speed"]
    found = ask(scene, " ".join(keys))
    for key, value, off in zip(keys, expected, room, strict=False):
        found.covers(key, value, off)
    # 1 N·m·s against a torque that falls from 140 N·m at 5 rad/s to nothing at 20 rad/s.
    speed = 140.0 / 15.0 * 20.0 / (1.0 + 140.0 / 15.0)
    assert found["d.mean_speed"] == pytest.approx(speed, rel=1e-9)
    assert math.isfinite(found.figure("d.mean_speed"))


@pytest.mark.parametrize("width", [1e-3, 2e-9, 1e-12])
def test_motor_whose_torque_falls_steeply__reaches_a_speed_beyond(width):
    scene = rotor({"start": run("dc", from_speed=0.0, speed=60.0)})
    rows = {"speed": [0.0, 50.0, 50.0 + width, 100.0], "moment": [20.0, 20.0, 10.0, 0.0]}
    scene["moments"]["dc"] = TABLE | rows | {"on": "crank"}
    # 20 N·m to 50 rad/s, then 0.2 N·m·s (100 rad/s − ω), but for the time that the fall takes.
    expected = INERTIA * (50.0 / 20.0 + 5.0 * math.log(50.0 / 40.0))
    assert ask(scene, "start.time")["start.time"] == pytest.approx(expected, rel=1e-9, abs=0.1 * INERTIA * width)
