"""Runs of inputs that don't turn fully: a crank between stops, a sliding input."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from engine import Machine, Scene, SceneError, Verdict, history
from sweeps.text.scene_text import scene_from
from sweeps.text.toml_text import parse_toml

RAM = """
gravity = "9.81 m/s2"
guides.way.angle = "90 deg"
bodies.load = { link = "ram", mass = "20 kg" }
input = { type = "slider", link = "ram", guide = "way", point = "P", start = "0 m", stop = "0.5 m", speed = "0.5 m/s" }
forces.oil = { type = "constant", on = "P", angle = "90 deg", force = "400 N", role = "driving" }
forces.valve = { type = "quadratic_drag", on = "P", coefficient = "30 N s2/m2" }
forces.rub = { type = "against_motion", on = "P", force = "0 N" }
"""
LEVER = """
points.O = { x = "0 mm", y = "0 mm" }
points.A = { x = "400 mm", y = "-100 mm" }
guides.way.angle = "0 deg"
input = { type = "slider", link = "rod", guide = "way", point = "P", start = "0 m", stop = "0.3 m", speed = "0.2 m/s" }
bodies.rod = { link = "rod", mass = "5 kg" }
bodies.beam = { link = "beam", mass = "12 kg", x = "150 mm", inertia = "0.1 kg m2" }
forces.oil = { type = "constant", on = "P", angle = "0 deg", force = "900 N", role = "driving" }
forces.back = { type = "constant", on = "P", angle = "180 deg", force = "700 N", role = "driving" }
forces.damper = { type = "linear_drag", on = "P", coefficient = "600 N s/m" }

[groups.pair]
type = "RRR"
inner = "C"
first = { link = "coupler", joint = "P", length = "350 mm" }
second = { link = "beam", joint = "A", length = "300 mm" }
"""
ROCKER = """
points.O = { x = "0 mm", y = "0 mm" }
input = { type = "crank", pivot = "O", pin = "A", length = "1 m", speed = "9 rpm", start = "-1 rad", stop = "1.5 rad" }
bodies.lever = { link = "crank", mass = "2 kg", x = "100 mm", inertia = "0.02 kg m2" }
moments.spring = { type = "torsion_spring", on = "crank", stiffness = "30 N m/rad", free_angle = "0 deg" }
"""
TURNING = ROCKER.replace(', start = "-1 rad", stop = "1.5 rad"', "")
# Of the greatest value: runs miss 1e-10 a step at most, and take fewer than a hundred steps.
TOLERANCE = 1e-8


def read(text: str, **regimes: str) -> Scene:
    """A scene with runs."""
    text += "".join(f"\n[regimes.{name}]\ntype = 'run'\n{keys}\n" for name, keys in regimes.items())
    return scene_from(parse_toml(text, ""), text, "", Path())


def answers(scene, names, **varied):
    outcome = Machine(scene, names, varied=varied).evaluate({key: np.asarray(v, float) for key, v in varied.items()})
    return outcome, [outcome.summaries[name] for name in names]


ENDS = ("time", "final_speed", "final_position", "end_reached", "impact_energy", "displacement")


def test_constant_force__lifts_a_mass_as_in_the_textbook():
    places = np.random.default_rng(4).uniform([[-3.0], [-2.0], [0.005]], [[1.7], [4.0], [2.0]], (3, 60))
    stop, mass, times_weight = 10.0**places
    varied = {"input.stop": stop, "bodies.load.mass": mass, "forces.oil.force": times_weight * mass * 9.81}
    scene = read(RAM, go="end_of_range = true\noff = ['valve', 'rub']")
    outcome, found = answers(scene, [f"go.{key}" for key in ENDS], **varied)
    assert (outcome.status == Verdict.OK).all()
    rise = 9.81 * (times_weight - 1.0)
    speed = np.sqrt(2.0 * rise * stop)
    expected = np.array([speed / rise, speed, stop, np.ones(60), 0.5 * mass * speed**2, stop])
    # The difference of force and weight carries their rounding, by as much as it is smaller.
    assert (np.abs(found - expected) <= TOLERANCE / (times_weight - 1.0) * expected).all()


def test_falling_mass__arrives_at_the_lower_end():
    scene = read(RAM, fall="from_position = '0.5 m'\nend_of_range = true\noff = ['oil', 'valve']")
    _, found = answers(scene, [f"fall.{key}" for key in ENDS])
    speed = np.sqrt(2.0 * 9.81 * 0.5)
    expected = [speed / 9.81, -speed, 0.0, -1.0, 10.0 * speed**2, -0.5]
    np.testing.assert_allclose(np.ravel(found), expected, rtol=TOLERANCE, atol=TOLERANCE)


def test_lever_to_and_fro__is_the_integral_by_another_method():
    keys = "end_of_range = true\noff = ['{}']"
    scene = read(LEVER, out=keys.format("back"), home=keys.format("oil"))
    names = [f"{regime}.{key}" for regime in ("out", "home") for key in ("time", "final_speed", "impact_energy")]
    _, found = answers(scene, names)
    reduced = Machine(scene, fields=["reduced_inertia", "reduced_inertia_phi"], positions=2000).evaluate({})
    q = np.linspace(0.0, 0.3, 2001)
    expected = []
    for start, stop, force in ((0.0, 0.3, 900.0), (0.3, 0.0, -700.0)):
        way = np.sign(stop - start)
        inertia, slope = (reduced.fields[key][0] for key in ("reduced_inertia", "reduced_inertia_phi"))

        def rates(t, y, force=force, inertia=inertia, slope=slope):
            mass, bend = np.interp(y[0], q, inertia), np.interp(y[0], q, slope)
            return [y[1], (force - 600.0 * y[1] - 0.5 * y[1] ** 2 * bend) / mass]

        def arrives(t, y, stop=stop, way=way):
            return way * (y[0] - stop)

        arrives.terminal = True
        run = solve_ivp(rates, (0.0, 2.0), [start, 0.0], "DOP853", events=arrives, rtol=1e-10, atol=1e-12)
        speed = run.y[1, -1]
        expected += [run.t[-1], speed, 0.5 * np.interp(stop, q, inertia) * speed**2]
    # The reference reads the inertia linearly between 2000 positions: a share of about (0.3/2000)² of it is missed.
    np.testing.assert_allclose(np.ravel(found), expected, rtol=2e-6)


def test_rocker__swings_between_its_turning_points_or_hits_its_stop():
    scene = read(ROCKER, swing="reversal = true", free="time = '0.05 s'\nfrom_angle = '1 rad'\nfrom_speed = 0")
    _, found = answers(scene, ["swing.time", "swing.angle", "swing.final_position", "free.final_position"])
    rate = np.sqrt(30.0 / (0.02 + 2.0 * 0.1**2))
    expected = [np.pi / rate, 2.0, 1.0, np.cos(rate * 0.05)]
    np.testing.assert_allclose(np.ravel(found), expected, rtol=TOLERANCE)
    short = read(ROCKER.replace("1.5 rad", "0.5 rad"), swing="reversal = true")
    _, found = answers(short, ["swing.final_speed", "swing.end_reached"])
    np.testing.assert_allclose(np.ravel(found), [rate * np.sqrt(0.75), 1.0], rtol=TOLERANCE)


def test_speed_beyond_the_range__does_not_end():
    scene = read(RAM, go="velocity = '30 m/s'\noff = ['valve', 'rub']")
    outcome, _ = answers(scene, ["go.time"], **{"forces.oil.force": [400.0, 4e5]})
    assert outcome.status.tolist() == [Verdict.NO_END, Verdict.OK]


def test_begin_outside_a_varied_range__is_a_verdict():
    scene = read(RAM, go="end_of_range = true\nfrom_position = '0.2 m'")
    outcome, _ = answers(scene, ["go.time"], **{"input.stop": [0.5, 0.1]})
    assert outcome.status.tolist() == [Verdict.OK, Verdict.OUTSIDE_LIMITS]


def test_changing_load__presses_the_input_against_its_stop_until_the_time_is_over():
    pulse = (
        "\n[forces.pulse]\ntype = 'formula'\non = 'P'\nangle = '0 deg'\nforce = '100 N * (1 + sin(3 * t / (1 s)))'\n"
    )
    scene = read(LEVER + pulse, go="end_of_range = true", stay="time = '1 s'")
    outcome, found = answers(scene, ["stay.time", "stay.final_position"])
    assert outcome.status.tolist() == [Verdict.OK]
    assert np.ravel(found).tolist() == [1.0, 0.3]


def test_history__stands_at_the_end_of_the_range():
    keys = "off = ['valve', 'rub']\n"
    scene = read(RAM, go=keys + "end_of_range = true", stay=keys + "time = '1 s'")
    seen = history(scene, fields=["input.reaction"])
    stays = seen.regime == "stay"
    assert seen.time[-1] == pytest.approx(seen.time[~stays][-1] + 1.0)
    assert (seen.angle[stays] == 0.5).all()
    assert (seen.speed[stays] == 0.0).all()
    # Beside the way of a slider that is pushed and weighed along it there is nothing.
    assert np.abs(seen.loads_on_pairs["input.reaction"]).max() < 1e-9


@pytest.mark.parametrize(
    ("text", "keys", "path", "mend"),
    [
        (RAM, "type = 'steady'", "regimes.go.type", "use type = 'run'"),
        (RAM, "type = 'run'\ncycles = 2", "regimes.go.cycles", "end_of_range = true"),
        (RAM, "type = 'run'\nspeed = '20 rpm'", "regimes.go.speed", "use velocity"),
        (RAM, "type = 'run'\ntime = '1 s'\nfrom_position = '0.6 m'", "regimes.go.from_position", "outside the range"),
        (ROCKER, "type = 'run'\ntime = '1 s'\nfrom_velocity = '1 m/s'", "regimes.go.from_velocity", "use from_speed"),
        (TURNING, "type = 'run'\nend_of_range = true", "regimes.go.end_of_range", "the crank turns fully"),
    ],
)
def test_what_has_no_meaning__is_refused(text, keys, path, mend):
    with pytest.raises((SceneError, ValueError)) as error:
        read(f"{text}\n[regimes.go]\n{keys}\n")
    assert path in str(error.value)
    assert mend in str(error.value)


FOUR_BAR = """
points.O = { x = "0 m", y = "0 m" }
points.C = { x = "2 m", y = "0 m" }
input = { type = "crank", pivot = "O", pin = "A", length = "2 m", speed = "10 rad/s" }
bodies.crank_body = { link = "crank", mass = "1 kg", inertia = "1 kg m2" }
bodies.rocker_body = { link = "rocker", mass = "1 kg", x = "1 m" }
moments.push = { type = "constant", on = "crank", moment = "5 N m" }
regimes.go = { type = "run", from_speed = "5 rad/s", from_angle = "90 deg", time = "1 ms" }

[groups.pair]
type = "RRR"
inner = "B"
first = { link = "coupler", joint = "A", length = "2 m" }
second = { link = "rocker", joint = "C", length = "2 m" }
"""


def test_runs_of_a_parallelogram__are_computed_up_to_its_change_point_and_tell_it_with_its_position():
    """The rocker turns like the crank, 1 + 1·1² kg·m² in all, so 5 N·m add 5 J to 25 J with each radian from 90° on."""
    scene = read(FOUR_BAR.replace('time = "1 ms"', "cycles = 0.1"))
    machine = Machine(scene, ["go.final_speed"], varied=["regimes.go.cycles"])
    # To near 180°, at it, past it, and on to 360°.
    turned = np.array([1e-3, 1.0, 1.5707, np.pi / 2.0, 2.0, 4.0, 40.0])
    found = machine.evaluate({"regimes.go.cycles": turned / (2.0 * np.pi)})
    assert found.status.tolist() == [Verdict.OK] * 3 + [Verdict.SINGULAR] * 4
    off = np.abs(found.summaries["go.final_speed"] - np.sqrt(25.0 + 5.0 * turned))[:3]
    # A sine of 1e-4 leaves 1e-16 / 1e-4² of accelerations to rounding.
    assert (off <= found.errors["go.final_speed"][:3]).all()
    assert (off <= [1e-12, 1e-12, 1e-7]).all()
    assert np.isnan(found.summaries["go.final_speed"][3:]).all()
    # Where the group is singular to rounding the position is known to its root.
    np.testing.assert_allclose(found.status_at[3:5], np.pi, atol=1e-5)
    at = found.status_at[5:]
    assert np.allclose(np.minimum(np.abs(at - np.pi), np.minimum(at, 2.0 * np.pi - at)), 0.0, atol=1e-5)
    assert history(scene).verdict == Verdict.OK
    past = history(read(FOUR_BAR.replace('"1 ms"', '"1 s"')))
    assert past.verdict == Verdict.SINGULAR
    assert past.time.tolist() == [0.0]


def test_what_is_asked_of_the_cycle__is_refused_for_a_position_that_no_run_reaches():
    steady = read(
        FOUR_BAR + '[regimes.on]\ntype = "steady"\n[moments.drag]\ntype = "linear_drag"\non = "crank"\n'
        'coefficient = "1 N m s/rad"\n'
    )
    for names in (["go.final_speed", "required_power"], ["go.final_speed", "on.mean_speed"]):
        assert Machine(steady, names).evaluate({}).status[0] == Verdict.SINGULAR


def test_run_of_a_four_bar_that_comes_apart__is_judged_by_the_range_it_covers():
    """Pins 2 m from O and 2 + 1 m from C at most: |AC| = 4 m sin(φ/2) stays below 3 m up to φ = 2 asin ¾ = 97.18°.

    In the very position the rocker turns infinitely fast, so that the crank stops there, whatever drives it.
    """
    limit, begin = 2.0 * np.arcsin(0.75), np.radians(60.0)
    text = FOUR_BAR.replace('"C", length = "2 m"', '"C", length = "1 m"').replace('"90 deg"', '"60 deg"')
    machine = Machine(read(text.replace('time = "1 ms"', "cycles = 0.1")), ["go.angle"], varied=["regimes.go.cycles"])
    turned = np.array([1e-3, 0.5, limit - begin - 1e-4, limit - begin, limit - begin + 1e-4, 1.0, 40.0])
    found = machine.evaluate({"regimes.go.cycles": turned / (2.0 * np.pi)})
    assert found.status.tolist() == [Verdict.OK] * 3 + [Verdict.CANNOT_ASSEMBLE] * 4
    np.testing.assert_allclose(found.summaries["go.angle"][:3], turned[:3], rtol=1e-12)
    # The group is looked at up to 1e-6 rad beyond what a run covers.
    np.testing.assert_allclose(found.status_at[3:], limit, atol=1e-6)
    # Backwards the crank moves away from the limit, forward it reaches it in any time.
    ends = {"time = '10 s'": Verdict.CANNOT_ASSEMBLE, "reversal = true": Verdict.CANNOT_ASSEMBLE}
    for end, verdict in ends.items():
        scene = read(text.replace('time = "1 ms"', end))
        assert Machine(scene, ["go.angle"]).evaluate({}).status[0] == verdict
        assert history(scene).verdict == verdict
    pulled = read(text.replace('"5 N m"', '"-5 N m"').replace('"5 rad/s"', '"0 rad/s"').replace('"1 ms"', '"1 s"'))
    assert Machine(pulled, ["go.angle"]).evaluate({}).status[0] == Verdict.OK
    assert history(pulled).verdict == Verdict.OK
