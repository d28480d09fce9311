"""Formulas of loads in scenes: what they may say, what is answered where they can't be used, and their numbers."""

import math

import numpy as np
import pytest
from each_case import each
from hypothesis import given, settings
from hypothesis import strategies as st
from press_texts import slider_crank_text

import sweeps
from engine import Scene, SceneError, evaluate_tree, order_groups, scene_numbers
from engine.parts.formulas.expressions import parse
from engine.parts.formulas.speed_powers import NoPowerError, powers_of_speed
from sweeps import InputError, read_scene, read_study, run_study, write_scene


def text_of(force, moment, numbers, regimes):
    return f"""
{slider_crank_text(speed="300 rpm")}
[forces.cut]
type = "formula"
on = "B"
angle = "180 deg"
force = "{force}"
numbers = {{ {numbers} }}

[moments.fan]
type = "formula"
on = "crank"
moment = "{moment}"
{regimes}
"""


FORCE, MOMENT, NUMBERS = "k * ram.slide", "12 N m + 3 N m s2 * omega^2", 'k = "3 kN/mm", n = 2'
LINE_OF_FORCE, LINE_OF_MOMENT = 25, 31


def read(tmp_path, force=FORCE, moment=MOMENT, numbers=NUMBERS, regimes=""):
    path = tmp_path / "machine.toml"
    path.write_text(text_of(force, moment, numbers, regimes), encoding="utf8")
    return read_scene(path)


def refused(tmp_path, **parts):
    with pytest.raises(InputError) as caught:
        read(tmp_path, **parts)
    return str(caught.value)


def test_formulas__are_read_with_their_numbers(tmp_path):
    scene = read(tmp_path)
    numbers = scene_numbers(scene)
    assert numbers["forces.cut.numbers.k"].value == 3e6
    assert numbers["forces.cut.numbers.k"].dimension == "stiffness"
    assert numbers["forces.cut.numbers.n"][:2] == (2.0, "number")


FORCES = [
    *("0", "k * ram.slide", "-3 kN * sign(v) * abs(v / (1 m/s))^1.5", "2kN if ram.from_high < 10mm and v > 0 else 0"),
    *("k * ram.stroke * (ram.from_low / ram.stroke)^n", "1 kN * exp(-t / (2 s)) * cos(rod.angle - 30 deg)"),
    *("gravity * 2 kg + forces.cut.numbers.k * input.length", "5 N s/m * (v + A.vx + ram.velocity)"),
    *("min(k * 1 mm, 2 bar * 3 cm2)", "3 N m s2 / ram.stroke_high * rod.angular_velocity^2"),
]


@each("force", FORCES)
def test_formula_that_is_a_force__is_taken_and_written_again(tmp_path, force):
    scene = read(tmp_path, force=force)
    path = tmp_path / "again.toml"
    path.write_text(write_scene(scene), encoding="utf8")
    assert scene.forces["cut"].force == force
    assert read_scene(path) == scene


@each(
    "force, words",
    [
        ("3 kN/mm", "gives a stiffness, but this is a force"),
        ("5", "gives a plain number, but this is a force; 5 has no unit: write '5 N' or '5 kN'"),
        ("1 N + ram.slide", "adds a length to a force"),
        ("1 N if v > 3 mm else 0", "compares a speed with a length"),
        ("1 N * (ram.slide / (1 m))^phi + 1 N * ram.slide^phi", "the power of a length must be a fixed number"),
        ("1 N / 0", "not a finite number"),
        ("1 N * log(0 * v / (1 m/s))", "not a finite number, whatever the values of its names"),
        ("1 N if phi == 0 else 0", "== holds at isolated points at most; compare by < or >"),
        ("1 N * ram.slied / (1 mm)", "unknown name 'ram.slied'; did you mean 'ram.slide'"),
        ("1 N * x", "a formula may use k, n, phi, v, omega, t, gravity, numbers given in [forces.cut.numbers]"),
        ("1 N * x", "SLIDER.slide, .velocity, .stroke, .stroke_low, .stroke_high, .from_low, .from_high"),
        ("3 kN / mm * ram.slide", "'mm' is a unit: write it after a number"),
        ("1 N * ram.acceleration", "'ram.acceleration' can't be used: accelerations follow from the loads"),
        ("1 N * input.speed / omega", "'input.speed' is only the mean speed"),
        ("v > 0", "'v > 0' is a condition; a number is needed: write A if v > 0 else B"),
        ("3 Nn", "'Nn' is not a valid unit here, or an operator is missing before it"),
        ("ram.angle * 1 N * O.x", "unknown name 'O.x'"),
    ],
)
def test_formula_that_cannot_be_used__is_answered_at_its_line(tmp_path, force, words):
    message = refused(tmp_path, force=force)
    assert words in message, message
    assert f"line {LINE_OF_FORCE}: forces.cut.force" in message


def test_moment_that_is_a_force__is_refused(tmp_path):
    message = refused(tmp_path, moment="3 N")
    assert f"line {LINE_OF_MOMENT}: moments.fan.moment: '3 N' gives a force, but this is a moment or energy" in message
    assert "unknown name 'v'" in refused(tmp_path, moment="3 N s * v")


@each(
    "numbers, words",
    [
        ('k = "3 kN/mm", t = "2 s"', "'t' already has a meaning in formulas"),
        ('k = "3 kN/mn"', "unknown unit 'mn': did you mean"),
        ("k = { value = 3.0, dimension = 'length' }", "expected a number"),
        ('k = "3 kN"', "gives a moment or energy, but this is a force"),
        ('"k 2" = "3 kN"', "is not a name"),
    ],
)
def test_wrong_number__is_answered(tmp_path, numbers, words):
    message = refused(tmp_path, numbers=numbers)
    assert words in message, message


REGIMES = '[regimes.work]\ntype = "{}"\noff = []\n'


@each("jump", ["v > 2 m/s", "abs(v) > 2 m/s and v > 0", "sign(v - 1 m/s) > 0", "2 N <= 1 N s/m * v"])
def test_regimes__take_no_jump_at_a_speed(tmp_path, jump):
    force = f"-5 N if {jump} else 0 N"
    read(tmp_path, force=force)
    message = refused(tmp_path, force=force, regimes=REGIMES.format("steady"))
    assert "about which a motion could hover for ever; switch 'cut' off in regimes.work" in message
    # Where it bends, or the motion turns round, nothing hovers.
    for force in ("-5 N * max(0, v / (2 m/s) - 1)", "-5 N if v > 0 else 0 N"):
        read(tmp_path, force=force, regimes=REGIMES.format("steady"))


def test_steady_regime__takes_no_time(tmp_path):
    timed = "1 N * sin(2 rad/s * t)"
    message = refused(tmp_path, force=timed, regimes=REGIMES.format("steady"))
    assert "regimes.work.off: 'cut' depends on time: no motion is periodic" in message
    read(tmp_path, force=timed, regimes=REGIMES.format("run") + 'time = "1 s"\n')


def test_sliding_input__has_no_crank_angle():
    scene = {
        "points": {"O": {"x": 0, "y": 0}},
        "guides": {"way": {}},
        "input": {"type": "slider", "link": "ram", "guide": "way", "point": "B", "start": 0, "stop": 1, "speed": 1},
        "forces": {"push": {"type": "formula", "on": "B", "angle": 0, "force": "1 N * phi"}},
    }
    with pytest.raises(SceneError, match="unknown name 'phi'"):
        order_groups(Scene.model_validate(scene))
    scene["forces"]["push"]["force"] = "1 N * ram.slide / ram.stroke"
    order_groups(Scene.model_validate(scene))


# Powers of the speed

VELOCITIES = ("v", "w")
OF_FIRST_ORDER = ["v", "w", "(v + w)", "abs(v)", "(x * v)", "max(v, w)", "min(v, 0)", "sqrt(v^2 + w^2)"]
OF_NO_ORDER = ["x", "y", "2.5", "sign(v)", "(1 if v > w else y)", "(x if v > 0 and not w < 0 else 0)"]
products = st.recursive(
    st.sampled_from([*OF_FIRST_ORDER, *OF_NO_ORDER]),
    lambda inner: st.one_of(
        st.tuples(st.sampled_from(["({} * {})", "({} + {})", "({} - {})", "({} if v > 0 else {})"]), inner, inner),
        st.tuples(st.sampled_from(["({} / (2 + x))", "-{}", "({})^2", "({})^3", "({} / abs(v))"]), inner),
    ).map(lambda parts: parts[0].format(*parts[1:])),
    max_leaves=5,
)


@settings(max_examples=80)
@given(products, st.floats(0.1, 9.0), st.sampled_from([1.0, -1.0]), st.floats(-2, 2), st.floats(-2, 2))
def test_sum_of_powers__is_the_formula_at_any_speed(text, speed, sense, v, w):
    if abs(v) < 1e-3 or abs(w) < 1e-3 or abs(v - w) < 1e-3:
        return
    tree, still = parse(text).tree, {"x": 0.7, "y": -1.3}
    whole = evaluate_tree(tree, {**still, "v": speed * sense * v, "w": speed * sense * w})
    try:
        powers = powers_of_speed(tree, VELOCITIES)
    except NoPowerError:
        return
    at_unit = {**still, "v": sense * v, "w": sense * w}
    parts = [evaluate_tree(part, at_unit) * speed ** float(n) for n, part in powers.items()]
    # A handful of operations; of a sum, what it cancels.
    size = sum(abs(part) for part in parts) + abs(whole) + (1 + 1 / abs(v)) ** 6 * (3 * (1 + speed)) ** 6
    assert abs(sum(parts) - whole) <= 1e-13 * size


@each(
    "text, orders",
    [
        ("v * abs(v)", {2}),
        ("x + 2 * v + 3 * v^2", {0, 1, 2}),
        ("(x + v)^2", {0, 1, 2}),
        ("abs(v)^1.5 * sign(v)", {1.5}),
        ("x / v", {-1}),
        ("atan2(v, w) + sign(v)", {0}),
        ("v^2 if v > 0 else x", {0, 2}),
    ],
)
def test_orders__are_those_of_the_text(text, orders):
    assert {float(n) for n in powers_of_speed(parse(text).tree, VELOCITIES)} == orders


OTHERS = ["exp(v)", "sin(v)", "max(v, x)", "x if v > 1 else 0", "v^x", "2^v", "abs(x + v)", "1 / (x + v)"]


@each("text", [*OTHERS, "(x + v)^0.5", "((((x + v)^8)^8)^8)^8"])
def test_other_dependence__is_no_sum_of_powers(text):
    with pytest.raises(NoPowerError):
        powers_of_speed(parse(text).tree, VELOCITIES)


# Studies of loads by formula: their numbers vary, are derived, and results are differentiated by them.


SCENE = f"""
{slider_crank_text(speed="300 rpm")}
[forces.buffer]
type = "formula"
on = "B"
angle = "0 deg"
force = "-k * (ram.slide - x0) - c * (ram.slide - x0)^3 if ram.slide > x0 and v > 0 else 0"
numbers = {{ k = "8 N/mm", x0 = "240 mm", c = "2 N/mm3" }}

[moments.fan]
type = "formula"
on = "crank"
moment = "-m * omega^2"
numbers.m = "3e-3 N m s2"
"""
STUDY = """
question = "How far out, how stiff?"
scene = "machine.toml"

[vary]
"forces.buffer.numbers.x0" = { from = "200 mm", to = "240 mm", count = 3 }
"forces.buffer.numbers.c" = { values = ["1 N/mm3", "5 kN/cm3"] }

[derive]
"forces.buffer.numbers.k" = "8 N/mm if forces.buffer.numbers.x0 > 210 mm else 3 N/mm"

[outputs]
summaries = ["buffer.moment.mean", "required_power"]
derivatives = ["buffer.moment.mean by forces.buffer.numbers.x0", "required_power by moments.fan.numbers.m"]
"""
HIGH, SPEED = 0.25, 10 * math.pi


def test_study__varies_derives_and_differentiates_by_numbers_of_formulas(tmp_path):
    (tmp_path / "machine.toml").write_text(SCENE, encoding="utf8")
    (tmp_path / "study.toml").write_text(STUDY, encoding="utf8")
    run_study(read_study(tmp_path / "study.toml"), tmp_path / "study.h5")
    data = sweeps.read(tmp_path / "study.h5")
    x0, k, c = (data[f"forces.buffer.numbers.{name}"].values for name in ("x0", "k", "c"))
    np.testing.assert_allclose(x0, np.repeat([0.2, 0.22, 0.24], 2), rtol=1e-15)
    np.testing.assert_allclose(k, np.repeat([3e3, 8e3, 8e3], 2), rtol=1e-15)
    np.testing.assert_allclose(c, np.tile([1e9, 5e9], 3), rtol=1e-15)
    assert data["forces.buffer.numbers.c"].attrs["units"] == "kg m-2 s-2"
    depth = HIGH - x0
    mean = -(k * depth**2 / 2 + c * depth**4 / 4) / (2 * math.pi)
    np.testing.assert_allclose(data["buffer.moment.mean"].values, mean, rtol=1e-11)
    np.testing.assert_allclose(data["required_power"].values, -(mean - 3e-3 * SPEED**2) * SPEED, rtol=1e-11)
    by_place = data["buffer.moment.mean.by.forces.buffer.numbers.x0"].values
    figure = data["buffer.moment.mean.by.forces.buffer.numbers.x0_error"].values
    # Along the study, what is derived from the place moves with it: not here, but where the condition turns over.
    slope = (k * depth + c * depth**3) / (2 * math.pi)
    assert (np.abs(by_place - slope) <= figure + 1e-9 * slope).all()
    by_fan = data["required_power.by.moments.fan.numbers.m"].values
    np.testing.assert_allclose(by_fan, SPEED**3, rtol=1e-9)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('to = "240 mm"', 'to = "240 N"'), "expected a length such as '80 mm', got 'N'"),
        (('["1 N/mm3", "5 kN/cm3"]', '["1 N/mm3", "5 kN/cm2"]'), "expected a quantity in kg m-2 s-2"),
        (
            ("numbers.c", "numbers.cc"),
            "numbers.cc: is not a number that the scene gives; did you mean",
        ),
        (('"8 N/mm if', '"8 N if'), "gives a force or a stiffness"),
    ],
)
def test_wrong_value_of_a_number__is_answered(tmp_path, change, words):
    (tmp_path / "machine.toml").write_text(SCENE, encoding="utf8")
    (tmp_path / "study.toml").write_text(STUDY.replace(*change), encoding="utf8")
    with pytest.raises(InputError, match=words.replace("(", r"\(")):
        read_study(tmp_path / "study.toml")
