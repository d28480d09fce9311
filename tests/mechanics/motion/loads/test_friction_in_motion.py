"""Friction in pairs in true motion, at one speed, with a clutch or a fluid coupling.

Closed forms of a rotor in its journal, balances and limits of a slider-crank. The rotor is the slider-crank without a
ram, whose other pairs are smooth, so that both share their functions.
"""

import math

import numpy as np
import pytest
from motion_scenes import (
    CLUTCH,
    FLUID,
    GRAVITY,
    INERTIA,
    MOMENTS,
    RATIO,
    Found,
    ask,
    behind,
    of,
    rotor,
    run,
    slider_crank,
    steady,
)

from engine import Machine, Scene, Verdict

MASS, COEFFICIENT, DIAMETER = 6.0, 0.2, 0.04
# Radius of the friction circle: f r over the root of 1 + f²; and the torque of friction in the journal.
ARM = COEFFICIENT * DIAMETER / 2 / math.sqrt(1.0 + COEFFICIENT**2)
HELD = MASS * GRAVITY * ARM
STALL, PUSH = "moments.dc.stall_moment", "moments.push.moment"
PAIRS = {
    "pin": {"pair": "drive.inner", "coefficient": 0.1, "diameter": 0.03},
    "crank_pin": {"pair": "drive.first", "coefficient": 0.1, "diameter": 0.04},
    "main": {"pair": "input", "coefficient": 0.08, "diameter": 0.05},
    "skirt": {"pair": "drive.second", "coefficient": 0.12, "length": 0.08},
}
JOURNAL = {name: pair | {"coefficient": 0.0} for name, pair in PAIRS.items()}
JOURNAL["main"] = {"pair": "input", "coefficient": COEFFICIENT, "diameter": DIAMETER}
FULL = 0.3
SMALL = CLUTCH | {"capacity": 0.2, "over_time": [0.0, FULL], "share": [1.0, 1.0]}


def in_journal(regimes: dict, eccentricity: float = 1e-30, speed: float = 10.0, **changes: dict) -> dict:
    """A heavy rotor in a rough journal; in balance to rounding, though not by its structure."""
    scene = rotor(regimes, speed, **changes) | {"friction": JOURNAL}
    scene["bodies"]["eccentric"] |= {"mass": MASS, "x": eccentricity}
    return scene


def rubbing(regimes: dict, share: float = 1.0, flywheel: float = 0.2, speed: float = 10.0) -> dict:
    """A slider-crank that rubs in all of its pairs."""
    friction = {name: pair | {"coefficient": share * pair["coefficient"]} for name, pair in PAIRS.items()}
    return slider_crank(regimes, speed, flywheel) | {"friction": friction}


# Asked of every run, so that machines share their functions.
RUN = "time angle final_speed motor_work useful_work harmful_work other_work energy_change work_residual"
RUN = of("go", f"{RUN} input.reaction.max drive.inner.reaction.max acceleration.max")


def turned(only: str, eccentricity: float = 1e-30, speed: float = 10.0, push: float = 0.0, **regime: object) -> Found:
    """What a rotor in a rough journal does."""
    scene = in_journal({"go": run(only, **regime)}, eccentricity, speed, push={"moment": push})
    return ask(scene, RUN)


def covered(found: Found, name: str, value: float) -> None:
    """A number is what it should be, to its own error estimate, which is small."""
    found.covers(name, value)
    assert found.figure(name) <= 1e-5 * abs(value) + 1e-9, name


# A rotor in its journal: closed forms


def test_rotor_under_its_weight__comes_to_rest_evenly():
    """Clockwise; the other rotors turn counter-clockwise."""
    found = turned("gravity", speed=-10.0, from_speed=10.0, rest=True)
    rise = HELD / INERTIA
    covered(found, "go.time", 10.0 / rise)
    covered(found, "go.angle", 10.0**2 / (2.0 * rise))
    covered(found, "go.harmful_work", 0.5 * INERTIA * 10.0**2)
    covered(found, "go.input.reaction.max", MASS * GRAVITY)


def test_unbalanced_rotor_without_weight__rubs_by_what_its_own_slowing_down_adds():
    found = turned("", 0.1, from_speed=50.0, time=2.0)
    # I ε = −ρ m e √(ω⁴ + ε²), so ε = −κ ω² with κ = k/√(1 − k²), k = ρ m e/I; then 1/ω = 1/ω₀ + κ t.
    k = ARM * MASS * 0.1 / (INERTIA + MASS * 0.1**2)
    kappa = k / math.sqrt(1.0 - k * k)
    covered(found, "go.final_speed", 1.0 / (1.0 / 50.0 + kappa * 2.0))
    covered(found, "go.angle", math.log1p(kappa * 50.0 * 2.0) / kappa)
    covered(found, "go.input.reaction.max", MASS * 0.1 * 50.0**2 * math.hypot(1.0, kappa))


def test_push_on_a_rotor__is_held_at_rest_up_to_the_moment_of_friction():
    for push, verdict in ((0.999 * HELD, Verdict.STALLS), (1.001 * HELD, Verdict.OK)):
        found = turned("push gravity", push=push, from_speed=0.0, cycles=1.0)
        assert found.status == [verdict], push
        if verdict == Verdict.OK:
            covered(found, "go.time", math.sqrt(2.0 * 2.0 * math.pi * INERTIA / (push - HELD)))


def test_rotor_behind_a_clutch__stands_until_the_clutch_overcomes_friction():
    """r C t/τ = M_f when it sets off; then I ω = r C/τ (t² − t₀²)/2 − M_f (t − t₀)."""
    until = 0.25
    go = run("gravity", from_speed=0.0, from_shaft_speed=400.0, time=until)
    scene = behind(in_journal({"go": go}), joint=SMALL | {"share": [0.0, 1.0]})
    found = ask(scene, of("go", "angle final_speed harmful_work work_residual"))
    rise = RATIO * SMALL["capacity"] / FULL
    off = HELD / rise
    assert 0.04 < off < 0.5 * until
    since = until - off
    assert found["go.final_speed"] == pytest.approx(0.5 * rise * since**2 / INERTIA, rel=1e-9)
    angle = rise * since**3 / 6.0 / INERTIA
    assert found["go.angle"] == pytest.approx(angle, rel=1e-9)
    assert found["go.harmful_work"] == pytest.approx(HELD * angle, rel=1e-9)
    assert abs(found["go.work_residual"]) <= found.figure("go.work_residual") + 1e-11


def test_clutch_weaker_than_friction__slips_and_the_crank_stands():
    weak = SMALL | {"capacity": 0.999 * HELD / RATIO}
    go = run("dc gravity", from_speed=0.0, from_shaft_speed=50.0, time=0.2)
    asked = of("go", "angle joint_slip_time work_residual")
    found = ask(behind(in_journal({"go": go}), joint=weak), asked)
    assert found["go.angle"] == 0.0
    assert found["go.joint_slip_time"] == pytest.approx(0.2, rel=1e-12)
    for_ever = run("dc gravity", from_speed=0.0, from_shaft_speed=50.0, lock_up=True)
    assert ask(behind(in_journal({"go": for_ever}), joint=weak), asked).status == [Verdict.SLIPS]


def test_steady_motion_through_a_fluid__carries_load_and_friction():
    """A constant load and constant friction: the motor's speed by its line, the crank's by the slip."""
    found = ask(
        behind(in_journal({"on": steady("dc load gravity")}), joint=FLUID),
        "on.mean_speed on.motor_shaft_mean_speed on.harmful_work on.joint_moment_peak",
    )
    factor, load = 1e-3 * 860.0 * 0.2**5 * RATIO**3, 2.0 + HELD
    motor = 100.0 / RATIO * (1.0 - load / (RATIO * MOMENTS["dc"]["stall_moment"]))
    assert found["on.motor_shaft_mean_speed"] == pytest.approx(RATIO * motor, rel=1e-9)
    assert found["on.mean_speed"] == pytest.approx(motor - load / (factor * motor), rel=1e-9)
    assert found["on.harmful_work"] == pytest.approx(2.0 * math.pi * HELD, rel=1e-9)
    assert found["on.joint_moment_peak"] == pytest.approx(load / RATIO, rel=1e-9)


# A slider-crank that rubs in all of its pairs


def test_start__motors_pay_for_energy_loads_and_friction():
    found = ask(rubbing({"go": run("dc cut gravity", speed=30.0)}), RUN)
    work = {name.rpartition(".")[2]: found[name] for name in found.values}
    assert work["harmful_work"] > 1.0
    # What the cut takes counts among what is neither useful nor harmful.
    paid = work["motor_work"] + work["other_work"] - work["useful_work"] - work["harmful_work"]
    assert paid == pytest.approx(work["energy_change"], rel=1e-6)
    assert abs(work["work_residual"]) <= found.figure("go.work_residual") + 1e-9


def random_pairs(rough: float) -> dict[str, np.ndarray]:
    """Numbers of random machines; their pins are `rough` times as rough."""
    count, rng = 64, np.random.default_rng(6)

    def around(value: float) -> np.ndarray:
        return value * rng.uniform(0.5, 2.5, count)

    varied = {"bodies.ram_body.mass": around(2.0), STALL: around(12.0), "friction.skirt.length": around(0.08)}
    for name, pair in PAIRS.items():
        varied[f"friction.{name}.coefficient"] = around(pair["coefficient"]) * (1.0 if name == "skirt" else rough)
        if name != "skirt":
            varied[f"friction.{name}.diameter"] = around(pair["diameter"])
    return varied


def missed_by_runs(regime: dict, rough: float) -> tuple[np.ndarray, np.ndarray]:
    """Errors of random machines over their estimates, and relative errors; the pins are `rough` times as rough."""
    varied = random_pairs(rough)
    names = of("go", "time angle final_speed motor_work harmful_work energy_change")
    scene, found = rubbing({"go": regime}, flywheel=0.0), {}
    for accuracy in (1e-8, 1e-3, 1e-4):
        found[accuracy] = ask(scene, names, varied=varied, accuracy=accuracy)
        assert set(found[accuracy].status) == {Verdict.OK}
    exact, beyond, relative = found.pop(1e-8), [], []
    for one in found.values():
        for name, value in one.values.items():
            off = np.abs(value - exact.values[name])
            # The angle at the end is given, and its estimate is 0.
            beyond.append(off / np.fmax(one.errors[name] + exact.errors[name], 1e-14 * np.abs(value)))
            relative.append(off / np.abs(value))
    return np.array(beyond), np.array(relative)


def test_errors_of_runs__are_within_their_estimates_where_reactions_pass_near_zero():
    """An estimate is the range of three runs, which may be small by chance; takes seconds, for hundreds of runs.

    Of these 768 results 2 exceeded it, by factors of up to 2.2, when no run was displaced, and 20 when steps passed
    kinks too.
    """
    beyond, _ = missed_by_runs(run("dc cut gravity", from_speed=30.0, cycles=3.3), 1.0)
    # At least 99.9 % of the estimates cover.
    assert (beyond > 1.0).mean() <= 1e-3
    assert beyond.max() <= 1.5


def test_runs__end_steps_where_a_slider_changes_the_edge_it_bears_on():
    """With smooth pins all kinks are the guide's; takes seconds, for hundreds of runs.

    The median error is 8e-9, and was 1e-5 when steps passed kinks.
    """
    beyond, relative = missed_by_runs(run("dc push gravity", from_speed=40.0, cycles=4.3), 0.0)
    assert beyond.max() <= 1.0
    assert np.median(relative) <= 1e-7


def test_step_up_to_a_kink__may_be_lost_in_rounding():
    """A third of these runs aimed at a kink nearer than the last digit of the angle, again and again."""
    scene = rubbing({"go": run("dc cut gravity", from_speed=30.0, cycles=1.3)}, flywheel=0.0)
    found = ask(scene, of("go", "time final_speed"), varied=random_pairs(1.0), accuracy=1e-12)
    assert set(found.status) == {Verdict.OK}


def test_steady_motion__is_in_balance_at_every_instant_and_without_friction_what_it_was():
    speed, fields = -10.0, ("input_moment", "input_moment_by_equilibrium", "friction_moment", "speed", "acceleration")
    asked = " ".join(f"on.{name}" for name in fields)
    cut = {"on": steady("dc cut gravity")}
    smooth = ask(slider_crank(cut, speed, 0.2), "on.mean_speed on.multiplier", 120, "on.speed on.input_moment")
    found = {share: ask(rubbing(cut, share, 0.2, speed), "on.mean_speed", 120, asked) for share in (1.0, 1e-12)}
    for each in found.values():
        given, needed = (each.fields[f"on.{name}"][0] for name in fields[:2])
        # What motor and flywheel give, and what the crank's equilibrium needs, friction in all pairs included.
        np.testing.assert_allclose(given, needed, rtol=0, atol=1e-10 * np.abs(given).max())
    assert found[1.0]["on.mean_speed"] < found[1e-12]["on.mean_speed"] - 1.0
    assert (found[1.0].fields["on.friction_moment"] > 0.0).all()
    room = found[1e-12].figure("on.mean_speed") + smooth.figure("on.mean_speed")
    assert found[1e-12]["on.mean_speed"] == pytest.approx(smooth["on.mean_speed"], rel=0, abs=room)
    # With friction the cycle is a run in time. Within a step of H ≤ 0.1 rad the angle is a polynomial of degree five
    # that is right at both ends up to the second derivative: its slope misses ω·H⁵/720·max|d/ds s³(1 − s)³|·ω⁽⁵⁾/ω⁶,
    # where the greatest of |d/ds s³(1 − s)³| is 0.0537 and ω⁽⁵⁾ at most 1.1 ω⁶.
    within = 0.1**5 / 720.0 * 0.0537 * 1.1 * smooth["on.mean_speed"]
    np.testing.assert_allclose(found[1e-12].fields["on.speed"], smooth.fields["on.speed"], rtol=0, atol=room + within)


def test_stop_from_the_start_of_a_steady_cycle__may_be_next_to_it():
    scene = rubbing({"on": steady("dc gravity"), "stop": run("brake", from_angle=2.0, rest=True)})
    # So strong that it stops the machine within a few turns.
    scene["moments"]["brake"] |= {"force": 2000.0}
    found = ask(scene, "stop.time", varied={"regimes.stop.from_angle": [0.0, 1e-20]})
    assert found.status == [Verdict.OK] * 2
    assert np.ptp(found.values["stop.time"]) <= found.errors["stop.time"].sum()


def test_motor_of_any_steepness__turns_a_rubbing_machine_as_at_constant_speed():
    """Explicit steps would have to be as short as its time constant, of which a turn has millions."""
    scene = rubbing({"on": steady("dc gravity")}, flywheel=0.0, speed=MOMENTS["dc"]["no_load_speed"])
    scene |= {"forces": {}, "moments": {"dc": MOMENTS["dc"] | {"stall_moment": 1e8}}}
    scene["regimes"]["on"]["off"] = []
    found = ask(scene, "on.harmful_work on.implicit_steps friction_moment.mean")
    assert found["on.implicit_steps"] == 1.0
    # The speed gives way by some 1e-7 of it.
    work, off = -2.0 * math.pi * found["friction_moment.mean"], found.figure("on.harmful_work")
    assert found["on.harmful_work"] == pytest.approx(work, rel=1e-6, abs=off)
    # Steps are judged by the speed, which a steep motor holds whatever the pairs take.
    assert off <= 1e-3 * work


@pytest.mark.parametrize(
    ("acting", "number", "weak", "strong"),
    # A motor that friction holds, and a load that turns the machine back.
    [
        ("dc gravity", "moments.dc.stall_moment", (0.5 * HELD, 0.9 * HELD), 60.0),
        ("dc push", PUSH, (-900.0, -500.0), -1.0),
    ],
)
def test_machines_whose_motor_is_too_weak__stall_alone_as_in_a_batch(acting, number, weak, strong):
    """Takes seconds, as from every speed tried each stalling motor is followed to rest with friction."""
    scene = Scene.model_validate(in_journal({"on": steady(acting)}, push={"moment": 0.0}))
    machine = Machine(scene, ["on.speed_min"], ["on.speed"], number, 120, accuracy=1e-3)
    for values in (weak[:1], (weak[0], strong, weak[1])):
        outcome = machine.evaluate({number: np.array(values)})
        stalls = np.isin(values, weak)
        assert list(outcome.status) == [Verdict.STALLS if stalled else Verdict.OK for stalled in stalls]
        assert list(np.isnan(outcome.fields["on.speed"]).all(axis=1)) == list(stalls)


def test_steady_motion_in_a_batch__has_the_same_bits_alone():
    """Steps are recorded together: their further stages must leave nothing behind for a lane whose step is refused.

    Of eight variants the sixth showed it; a batch of three or four shows nothing. Each evaluation takes seconds: steady
    running is sought by hundreds of steps with friction.
    """
    asked, count, one = (["on.speed_min", "on.motor_work", "on.friction_moment.rms"], ["on.speed"]), 8, 5
    varied = {"bodies.ram_body.mass": np.geomspace(0.3, 30.0, count)}
    varied["moments.dc.stall_moment"] = np.geomspace(60.0, 10.0, count)
    machine = Machine(Scene.model_validate(rubbing({"on": steady("dc gravity")})), *asked, varied, 120, accuracy=1e-4)
    together = machine.evaluate(varied)
    alone = machine.evaluate({path: values[one : one + 1] for path, values in varied.items()})
    for whole, part in zip(together[3:6], alone[3:6], strict=True):
        assert all(whole[name][one].tobytes() == row.tobytes() for name, row in part.items())


def test_run_that_begins_where_friction_jumps__is_looked_at_behind_the_jump():
    """At the dead centre itself the slider stands, and its guide doesn't rub."""
    near, found = 1e-7, []
    for begin in (0.0, near):
        scene = rubbing({"go": run("dc gravity", from_angle=begin, from_speed=5.0, cycles=0.1)})
        found.append(ask(scene, RUN))
    for name in ("go.acceleration.max", "go.drive.inner.reaction.max"):
        # Curves change by a few times themselves, some hundred rad/s² and N, within a radian.
        assert found[0][name] == pytest.approx(found[1][name], abs=1e4 * near), name


def test_clutch_that_holds__moves_a_rubbing_slider_crank_as_a_gear_does():
    """As a machine whose motor shaft is geared to the crank without a clutch, which goes by the system of one speed."""
    go = run("dc gravity cut", from_speed=5.0, time=0.5)
    names = "angle final_speed motor_work harmful_work useful_work other_work"
    regimes = {"go": go, "on": steady("dc gravity cut")}
    held = behind(rubbing(regimes, flywheel=0.0), joint=SMALL | {"capacity": 1e5})
    held["regimes"]["go"]["from_shaft_speed"] = 5.0 * RATIO
    loads = "drive.inner.reaction.max acceleration.min kinetic_energy.max frame.reaction_moment.min"
    asked = f"{of('go', names)} {of('go', loads)} on.mean_speed on.harmful_work"
    two = ask(held, asked)
    two.agrees(ask(behind(rubbing(regimes, flywheel=0.0)), asked))
    assert two["go.harmful_work"] > 1.0
