"""What a change of load does: against SciPy's integration with events, and by its limits."""

import math

import numpy as np
import pytest
from element_samples import element, results
from governed_motion import GovernedMotion
from governor_samples import ENGINE, HARTNELL, PORTER, TABLE
from machines import slider_crank
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline, PPoly

from engine import MovingMachine, Scene, SceneError, Verdict, governed_scene, made_ready

FOLLOWED = ENGINE | {"new_load": 200.0, "duration": 4.0}
SWITCHED = {"type": "full and shut", "full": 400.0, "switch": 0.05}
CASES = {
    "calm": PORTER | {"damping": 400.0, "engine": FOLLOWED},
    "geared": PORTER | {"damping": 900.0, "engine": FOLLOWED | {"ratio": 1.6, "self_regulation": 4.0}},
    "geared, friction": PORTER | {"friction": 6.0, "damping": 400.0, "engine": FOLLOWED | {"ratio": 1.3}},
    "friction": PORTER | {"friction": 6.0, "damping": 400.0, "engine": FOLLOWED},
    "much friction": PORTER | {"friction": 40.0, "damping": 50.0, "engine": FOLLOWED},
    # So stiff that implicit steps follow; the third has settled to rounding after half of its time.
    "thick oil": PORTER | {"friction": 6.0, "damping": 2e4, "engine": FOLLOWED},
    "thick oil, valve": PORTER | {"damping": 1e4, "engine": FOLLOWED | {"throttle": SWITCHED, "self_regulation": 4.0}},
    "thick oil, settled": PORTER | {"damping": 2e4, "engine": FOLLOWED | {"self_regulation": 4.0, "duration": 120.0}},
    "stops": PORTER | {"friction": 2.0, "damping": 50.0, "engine": FOLLOWED | {"inertia": 5.0}},
    "stops, no friction": PORTER | {"damping": 50.0, "engine": FOLLOWED | {"inertia": 5.0}},
    "more load": PORTER | {"friction": 3.0, "damping": 500.0, "engine": FOLLOWED | {"load": 100.0, "new_load": 330.0}},
    "valve": PORTER | {"damping": 400.0, "engine": FOLLOWED | {"throttle": SWITCHED}},
    "valve, friction": PORTER | {"friction": 5.0, "damping": 400.0, "engine": FOLLOWED | {"throttle": SWITCHED}},
    # The sleeve falls, rises for a moment and falls again, all within one step.
    "valve, short reversal": PORTER
    | {
        "ball_mass": 1.54,
        "sleeve_mass": 10.6,
        "stiffness": 2940.0,
        "preload": 14.6,
        "friction": 1.39,
        "damping": 124.0,
        "engine": FOLLOWED
        | {"inertia": 4.83, "ratio": 1.37, "new_load": 37.0, "throttle": SWITCHED | {"switch": 0.0252}},
    },
}


def panels_over_time(governor, **given):
    """Time and speed of the engine as drawn."""
    speeds = next(panel for panel in governor.panels(**given) if panel.x.symbol == "t")
    return speeds.places, speeds.curves[0].values


@pytest.mark.parametrize("name", CASES)
def test_change_of_load__is_what_another_method_finds(name):
    governor = CASES[name]
    engine = governor["engine"]
    found, errors, status = results(governor)
    assert status[0] == Verdict.OK
    motion = GovernedMotion(governor)
    regimes, speeds, hits = motion.follow(engine["load"], engine["new_load"], engine["duration"])
    after = motion.speed_at(motion.steady(engine["new_load"])) / motion.ratio

    def speed_at(time):
        return next(r for r in regimes if time <= r.t_max)(time)[2]

    # Events are found to 1e-13 s or so, and each may shift what follows by a little of the speed.
    for key, wanted in (("highest_speed", speeds.max()), ("lowest_speed", speeds.min())):
        assert abs(found[key][0] - wanted) <= errors[key][0] < 1e-6 * wanted, key
    assert [found["inner_stop_hits"][0], found["outer_stop_hits"][0]] == hits
    beyond = found["highest_speed"] - after if engine["new_load"] < engine["load"] else after - found["lowest_speed"]
    assert_allclose(found["overshoot"], beyond / after, rtol=1e-9)
    # Instant by instant.
    time, speed = panels_over_time(element(governor))
    assert time[-1] == pytest.approx(engine["duration"])
    other = np.array([speed_at(t) for t in time])
    assert np.abs(speed - other).max() <= 4 * errors["highest_speed"][0]
    before = found["working_speed"][0] - found["steady_speed_change"][0]
    assert before == pytest.approx(motion.speed_at(motion.steady(engine["load"])) / motion.ratio, rel=1e-10)
    settled = found["settling_time"][0]
    if abs(speed[-1] - after) > 0.01 * after:
        assert np.isnan(settled)
    else:
        assert abs(speed_at(settled) - after) == pytest.approx(0.01 * after, abs=1e-5)
        assert (np.abs(other[time > settled] - after) <= 0.01 * after).all()
    late = time >= 0.75 * engine["duration"]
    # A valve switches some dozen times; where the other method's events come about a little late, so does the swing.
    assert abs(found["hunting"][0] - np.ptp(other[late]) / 2 / after) <= 4 * errors["hunting"][0] + 1e-8


def test_table_governor__moves_its_engine_as_scipy_does():
    governor = TABLE | {"interpolation": "linear", "damping": 900.0, "engine": FOLLOWED | {"duration": 1.0}}
    ratio, ball, sleeve = TABLE["lift_ratio"], TABLE["ball_mass"], TABLE["sleeve_mass"]
    engine, own = governor["engine"], 2.0 * ball + sleeve * ratio**2
    drop = engine["throttle"]["full"] / ((TABLE["greatest_radius"] - TABLE["least_radius"]) * ratio)

    def force(radius):
        return np.interp(radius, TABLE["over_radius"], TABLE["controlling_force"])

    def rates(_, y):
        radius, velocity, omega = y
        moment = engine["throttle"]["full"] - drop * ratio * (radius - TABLE["least_radius"]) - engine["new_load"]
        turning = (moment - 4.0 * ball * radius * velocity * omega) / (engine["inertia"] + 2.0 * ball * radius**2)
        pull = 2.0 * ball * radius * omega**2 - 2.0 * force(radius) - ratio**2 * governor["damping"] * velocity
        return velocity, pull / own, turning

    radius = TABLE["least_radius"] + (engine["throttle"]["full"] - engine["load"]) / (drop * ratio)
    begin = radius, 0.0, math.sqrt(force(radius) / (ball * radius))
    other = solve_ivp(rates, (0.0, 1.0), begin, "DOP853", rtol=1e-11, atol=1e-13, max_step=1e-3)
    assert other.y[0].max() < TABLE["greatest_radius"]
    found, errors, status = results(governor)
    assert status[0] == Verdict.OK
    # SciPy's steps pass over the kinks of the table, each with an error below 1e-8.
    assert abs(found["highest_speed"][0] - other.y[2].max()) <= errors["highest_speed"][0] + 1e-6
    assert panels_over_time(element(governor))[1][-1] == pytest.approx(other.y[2][-1], rel=1e-7)


def test_just_beside_the_critical_damping__it_decays_or_grows():
    first, _, _ = results(PORTER | {"damping": 100.0, "engine": ENGINE})
    critical = first["critical_damping"][0]
    # So small a change that the stops are far.
    engine = FOLLOWED | {"new_load": 150.0, "load": 150.15, "duration": 40.0}
    found, _, _ = results(PORTER | {"engine": engine}, damping=critical * np.array([0.97, 1.03]))
    swing = found["highest_speed"] - found["lowest_speed"]
    hunting = 2 * found["hunting"] * found["working_speed"]
    assert hunting[0] > 0.9 * swing[0]
    assert hunting[1] < 0.7 * swing[1]


# The engine is a mechanism

ANGLES = [k * math.pi / 6 for k in range(12)]


def crank_engine(**changes):
    """A slider-crank with a heavy ram, driven unevenly, that its governor throttles."""
    engine = {key: value for key, value in FOLLOWED.items() if key != "inertia"}
    engine |= {
        "machine": True,
        "throttled": ["steam"],
        "inertia": 6.0,
        "duration": 2.0,
        "settling_band": 0.05,
    } | changes
    return slider_crank(
        0.15,
        0.6,
        18.0,
        guides={"way": {"angle": math.pi / 2}},
        gravity=9.81,
        bodies={"ram_body": {"link": "ram", "mass": 60.0}},
        moments={
            "steam": {
                "type": "table",
                "on": "crank",
                "role": "driving",
                "interpolation": "spline",
                "over_angle": ANGLES,
                "moment": [300.0 + 200.0 * math.cos(2 * a - 1.0) + 50.0 * math.sin(a) for a in ANGLES],
            }
        },
        elements={"it": PORTER | {"damping": 400.0, "engine": engine}},
    )


@pytest.mark.parametrize("friction", [0.0, 8.0])
def test_machine_with_its_true_inertia_and_moments__is_what_another_method_finds(friction):
    parts = crank_engine()
    parts["elements"]["it"]["friction"] = friction
    scene = Scene.model_validate(parts)
    names = [f"it.{key}" for key in ("highest_speed", "lowest_speed", "hunting")]
    outcome = made_ready(scene, names).evaluate({})
    assert outcome.status[0] == Verdict.OK
    fields = MovingMachine(scene).fields(["reduced_inertia", "reduced_moment", "steam.moment"])
    inertia, moment, steam = fields.values()
    other = moment - steam
    rows = np.stack([inertia - inertia.mean(), steam / steam.mean(), other - other.mean()])
    phi = np.linspace(0, math.tau, rows.shape[1] + 1)
    curves = CubicSpline(phi, np.append(rows, rows[:, :1], axis=1).T, bc_type="periodic")
    governor = scene.elements["it"].model_dump(exclude_none=True)
    governor["engine"]["inertia"] += inertia.mean()
    motion = GovernedMotion(governor)
    # All with their slopes in one polynomial, evaluated once a rate.
    slopes = np.concatenate([np.zeros_like(curves.c[:1]), curves.derivative().c])[..., :1]
    whole = PPoly(np.concatenate([curves.c, slopes], axis=-1), phi, "periodic")

    def at(angle: float) -> tuple[float, float, float, float]:
        change, share, rest, slope = whole(angle).tolist()
        return change, slope, share, rest

    motion.curves = at
    regimes, speeds, _ = motion.follow(300.0, 200.0, 2.0)
    value, error = ({k.removeprefix("it."): v[0] for k, v in t.items()} for t in (outcome.summaries, outcome.errors))
    for key, wanted in (("highest_speed", speeds.max()), ("lowest_speed", speeds.min())):
        # Both go through curves at equally spaced angles, with an error of the fourth power of their spacing.
        assert abs(value[key] - wanted) <= error[key] + 1e-7, key
        assert error[key] < 1e-5 * wanted
    drawn, cycles = governed_scene(scene)
    time, speed = panels_over_time(drawn.elements["it"], cycle=cycles["it"])
    assert abs(speed.max() - value["highest_speed"]) <= error["highest_speed"]
    other = np.array([next(r for r in regimes if t <= r.t_max)(t)[2] for t in time])
    assert np.abs(speed - other).max() <= 4 * error["highest_speed"] + 1e-6
    # The speed ripples about a mean that settles: it isn't the smooth motion of a constant inertia.
    assert value["hunting"] > 0.01


def test_machine_in_a_mirror__is_governed_alike():
    """It turns backwards, and its weight points up."""
    names, parts = ["it.highest_speed", "it.lowest_speed", "it.hunting"], crank_engine()
    steam = parts["moments"]["steam"]
    moment = [-m for m in [*steam["moment"][:1], *reversed(steam["moment"][1:])]]
    mirrored = parts | {"gravity": 0.0, "base": {"acceleration_y": -9.81}, "guides": {"way": {"angle": -math.pi / 2}}}
    mirrored |= {"input": parts["input"] | {"speed": -18.0}, "moments": {"steam": steam | {"moment": moment}}}
    one, other = (made_ready(Scene.model_validate(each), names).evaluate({}) for each in (parts, mirrored))
    assert other.status[0] == Verdict.OK
    for name in names:
        room = one.errors[name][0] + other.errors[name][0]
        assert other.summaries[name][0] == pytest.approx(one.summaries[name][0], rel=0, abs=room), name


def test_machine_whose_throttled_actions_do_not_drive__is_undefined():
    parts = crank_engine()
    parts["moments"]["steam"]["moment"] = [-m for m in parts["moments"]["steam"]["moment"]]
    outcome = made_ready(Scene.model_validate(parts), ["it.highest_speed"]).evaluate({})
    assert outcome.status[0] == Verdict.NOT_FINITE
    assert np.isnan(outcome.summaries["it.highest_speed"][0])


def test_throttled_action_that_is_not_there__is_named():
    with pytest.raises(SceneError, match=r"elements\.it\.engine\.throttled.*did you mean 'steam'"):
        made_ready(Scene.model_validate(crank_engine(throttled=["stem"])), ["it.highest_speed"])
    with pytest.raises(ValueError, match="throttled names actions of the scene's mechanism"):
        element(PORTER | {"engine": ENGINE | {"throttled": ["steam"]}})


def test_dashpot_that_all_but_holds_the_sleeve__is_followed():
    stiff = PORTER | {"engine": FOLLOWED | {"self_regulation": 50.0}}
    found, _, status = results(stiff, damping=[1e5, 1e9, 1e12])
    assert not status.any()
    before, inertia = (found["working_speed"] - found["steady_speed_change"])[0], ENGINE["inertia"]

    def risen(inertia: float) -> float:
        """Speed with the throttle as it was, which rises by (1 − e^(−s t / I)) ΔM/s."""
        return before + (1.0 - math.exp(-50.0 * FOLLOWED["duration"] / inertia)) * 100 / 50

    slow, slower, slowest = found["highest_speed"]
    # The balls add at most 2 · 5 kg · (0.2 m)² to the inertia; a sleeve that moves closes the throttle.
    assert slow < slower < slowest
    assert risen(inertia + 0.4) < slowest < risen(inertia)


@pytest.mark.parametrize(
    ("governor", "engine", "settles_in"),
    [
        (PORTER | {"damping": 2e3}, FOLLOWED, 20.0),
        (PORTER | {"damping": 2e3}, FOLLOWED | {"self_regulation": 20.0}, 4.0),
        (HARTNELL | {"damping": 2e4}, FOLLOWED | {"inertia": 21.3, "new_load": 264.6, "self_regulation": 20.0}, 20.0),
    ],
)
def test_engine_that_has_settled__runs_on_for_hours(governor, engine, settles_in):
    found, errors, status = results(governor | {"engine": engine | {"duration": settles_in}})
    long = governor | {"engine": engine | {"duration": 36e3}}
    later, more, same = results(long)
    assert status[0] == same[0] == Verdict.OK
    for key in ("highest_speed", "lowest_speed", "overshoot", "settling_time"):
        assert abs(later[key][0] - found[key][0]) <= errors[key][0] + more[key][0], key
    # Below the errors of steps, 1e-9 of the speed.
    assert later["hunting"][0] <= more["hunting"][0] < 1e-7
    time, speed = panels_over_time(element(long))
    assert time[-1] == 36e3
    assert speed[-1] == pytest.approx(later["working_speed"][0], rel=1e-9)


def test_sleeve_that_rests_for_hours__limits_no_steps():
    engine = FOLLOWED | {"duration": 36e3, "self_regulation": 20.0}
    found, _, status = results(PORTER | {"friction": 200.0, "engine": engine})
    assert status[0] == Verdict.OK
    # Friction holds the sleeve: the speed approaches its new value, by ΔM/s above the former.
    before = (found["working_speed"] - found["steady_speed_change"])[0]
    assert found["highest_speed"][0] == pytest.approx(before + 100 / 20, rel=1e-6)
