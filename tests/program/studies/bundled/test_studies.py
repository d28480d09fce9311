"""Templates and bundled studies: they read, assemble, and give numbers that a hand calculation confirms."""

import functools
import math
import re
from typing import NamedTuple

import numpy as np
from each_case import each

from engine import Machine, Verdict, any_quantity, scene_numbers
from engine.laws.friction.coefficients import WORN_IN
from engine.parts.formulas.expressions import parse
from sweeps import read_scene, read_study
from sweeps.study.bundled import bundled_studies
from sweeps.text.templates import bundled_templates, template_text, templates

# Those that every summary is asked of; elements on a machine and alone have tests of their own.
TEMPLATE_NAMES = [name for name, path in bundled_templates().items() if not read_scene(path).elements]
STUDY_NAMES = ("compressor", "crank_press", "four_stroke_engine", "jaw_crusher", "shaper", "stirling_engine")
FRICTION_STUDY_NAMES = ("engine_bearings", "toggle_press")
TURN = 2 * math.pi


# Asked along with everything else, so that one kernel serves all tests of a machine.
FIELDS = {
    "offset_slider_crank": ("saw.slide_phi", "cutting.moment"),
    **dict.fromkeys(("whitworth", "crank_shaper", "shaper"), ("ram.slide_phi", "cutting.moment")),
    "stephenson_six_bar": ("feeder.angle",),
    "toggle": ("B.x",),
    "hybrid_five_bar": ("input_moment_by_equilibrium", "second.driving_moment", "second.angle_phi", "B.x", "B.y"),
}


# Of this all summaries are asked, of each other template those that a test of it needs.
WHOLE = "slider_crank"


@functools.cache
def template(name):
    """Summaries of a template with error estimates; its fields, and its scene."""
    scene = read_scene(bundled_templates()[name])
    # Eight of each bearing: more than all others together, and a compiler's time grows faster than their number.
    of_bearings = ("load_direction_of", "load_spread_of", "unloaded_arc_of", "unloaded_middle_of")
    machine = Machine(scene)
    asked = [n for n in machine.available_summaries if not n.rpartition(".")[2].startswith(of_bearings)]
    if name != WHOLE:
        needed = ("power", "transmission_angle", "stroke", "stroke_time_ratio", "swing", "mass", "width", "diameter")
        asked = [n for n in asked if n.endswith(needed)]
    outcome = Machine(scene, asked, FIELDS.get(name, ())).evaluate({})
    assert outcome.status[0] == Verdict.OK
    values = {k: (v[0], outcome.errors[k][0]) for k, v in outcome.summaries.items()}
    return values, {k: v[0] for k, v in outcome.fields.items()}, scene


def close(value, exact, relative=1e-12):
    """Whether a summary lies within its own error estimate, and rounding, of what it should be."""
    return abs(value[0] - exact) <= value[1] + relative * abs(exact)


# Templates


@each("name", templates())
def test_template__says_first_what_to_change(name):
    text = template_text(name)
    assert templates()[name]
    opening = text[: text.index("How to read this file")]
    assert opening.startswith("#:schema scene.schema.json\n# ")
    assert "# Change first: " in opening


# Links that rest at an end of their swing or stroke, or whose guide lies midway in the arc of their joint.
TIED_ENDS = {"crank_shaper": ("drag_link",), "dwell_slide": ("slide", "rod", "lever")}


@each("name", TEMPLATE_NAMES)
def test_template__assembles_with_every_summary_finite(name):
    values, _, _ = template(name)
    # A link that goes round has no swing: the crank always, Whitworth's slotted link and its block, wheels in mesh.
    others = {
        "whitworth": ["slotted", "block"],
        "elliptical_wheels": ["first", "second"],
        "hybrid_five_bar": ["second"],
    }
    turning = ("crank", *others.get(name, ()))
    for summary, (value, error) in values.items():
        link, _, kind = summary.partition(".")
        # An end of a swing that is held for a while, or taken twice a turn, divides the turn anywhere: its ratio of
        # times is undefined.
        undivided = kind.endswith("_time_ratio") and link in TIED_ENDS.get(name, ())
        if (link in turning and kind.startswith("swing")) or undivided:
            assert math.isnan(value)
        else:
            assert math.isfinite(value)
            assert math.isfinite(error)


@each("name", TEMPLATE_NAMES)
def test_template__is_of_sensible_proportions(name):
    values, _, scene = template(name)
    # Textbooks ask for 40 deg, 30 deg at the least.
    assert all(values[f"{group}.transmission_angle"][0] > math.radians(30) for group in scene.groups)
    if name == "hybrid_five_bar":
        # One motor and one flywheel mean nothing to drives that keep to laws of their own.
        return
    names = ("required_power", "wheel_mass", "wheel_width", "wheel_diameter")
    power, mass, width, diameter = (values[n][0] for n in names)
    assert 5 < power < 5000
    assert 1 < mass < 200
    assert width < diameter / 4


def test_variants_of_a_slide_with_dwells__have_the_same_bits_alone():
    # Each turning point of slide and lever that lies close to another adds positions to the scan of its own variant.
    _, _, scene = template("dwell_slide")
    path = "inputs.slide.sections.back.angle"
    machine = Machine(scene, ["slide.stroke_low_at", "lever.swing_low_at", "input_moment.peak"], (), [path])
    angles = np.array([0.959, 1.08, 1.1])
    every = machine.evaluate({path: angles})
    for k, angle in enumerate(angles):
        alone = machine.evaluate({path: np.array([angle])})
        for mine, others in ((alone.summaries, every.summaries), (alone.errors, every.errors)):
            for name, row in mine.items():
                assert np.array_equal(row, others[name][[k]], equal_nan=True), name
    assert (every.errors["slide.stroke_low_at"] > 0.0).all()


def lever_at(slid):
    """Angle of the lever of dwell_slide, by the law of cosines."""
    arm = complex(slid + 0.040, 0.050) - complex(0.330, 0.170)
    distance = abs(arm)
    between = math.acos((distance**2 + 0.120**2 - 0.140**2) / (2 * distance * 0.120))
    return math.atan2(arm.imag, arm.real) % TURN + between


def times(half):
    """Ratio of times where the way back takes so much less than half of the turn."""
    return (math.pi + 2 * half) / (math.pi - 2 * half)


# Of the offset saw: the way there takes so much more than half of the turn.
LAG = math.asin(70 / 160) - math.asin(70 / 280)
SAW = math.sqrt(0.280**2 - 0.070**2) - math.sqrt(0.160**2 - 0.070**2)
DWELL_SWING = abs(lever_at(0.110 + 0.080) - lever_at(0.110))
# Stroke, ratio of times, and power: the work of the load over its way, times the turns a second.
CLOSED = {
    "slider_crank": {"piston.stroke": 2 * 0.040, "required_power": 2000 * 2 * 0.040 * 180 / 60},
    "scotch_yoke": {"yoke.stroke": 2 * 0.050, "required_power": 1500 * 2 * 0.050 * 150 / 60},
    # The driven crank is at its dead centres a quarter turn off its fastest place: tan(θ/2) = (1 − e)/(1 + e).
    "elliptical_wheels": {
        **{"ram.stroke": 2 * 0.060, "required_power": 800 * 4 * 0.060 * 120 / 60},
        "ram.stroke_time_ratio": TURN / (4 * math.atan((1 - 0.3) / (1 + 0.3))) - 1,
    },
    "rack_doubler": {"table.stroke": 4 * 0.050, "required_power": 300 * 8 * 0.050 * 120 / 60},
    "dwell_slide": {"slide.stroke": 0.080, "required_power": 20 * 2 * DWELL_SWING * 100 / 60},
    "offset_slider_crank": {
        **{"saw.stroke": SAW, "saw.stroke_time_ratio": times(LAG / 2), "required_power": 400 * SAW * 90 / 60}
    },
    "whitworth": {
        **{"ram.stroke": 2 * 0.090, "ram.stroke_time_ratio": times(math.asin(50 / 75))},
        "required_power": 1200 * 2 * 0.090 * 45 / 60,
    },
    "crank_shaper": {
        **{"ram.stroke": 2 * 0.420 * 90 / 240, "ram.stroke_time_ratio": times(math.asin(90 / 240))},
        "required_power": 2000 * (0.300 - 0.015) * 40 / 60,
    },
}


@each("name", CLOSED)
def test_template__has_the_stroke_the_times_and_the_power_of_closed_forms(name):
    values, _, _ = template(name)
    for summary, exact in CLOSED[name].items():
        assert close(values[summary], exact), summary


def test_hybrid_five_bar_template__needs_the_power_of_both_drives():
    """What a servo and a motor take on average is the work of the load along the path of its joint."""
    values, fields, _ = template("hybrid_five_bar")
    own, second, rate, x, y = fields.values()
    path = np.append(x + 1j * y, x[0] + 1j * y[0])
    # Chords of the path are shorter than its arcs, by a share of the square of half a degree.
    assert close(values["required_power"], 150 * np.abs(np.diff(path)).sum() * 120 / 60, relative=1e-4)
    assert np.isclose((own + second * rate).mean() * 4 * math.pi, values["required_power"][0], rtol=1e-4)
    assert np.abs(second).max() > 1.0


def cuts_slowly(rate, moment):
    """Whether a resistance acts on the stroke that takes more of the turn, and there alone."""
    slow = 1 if np.count_nonzero(rate > 0) > np.count_nonzero(rate < 0) else -1
    cutting = moment != 0
    return cutting.any() and (np.sign(rate[cutting]) == slow).all()


@each("name", ["offset_slider_crank", "whitworth", "crank_shaper"])
def test_quick_return_template__cuts_on_the_slow_stroke(name):
    assert cuts_slowly(*template(name)[1].values())


def test_toggle_template__spends_half_of_force_times_way_and_does_not_pass_through():
    values, fields, _ = template("toggle")
    assert close(values["required_power"], 400e3 * 0.002 / 2 * 60 / 60)
    # The knee comes within 2 mm of straight (the line x = 0) and stays on the crank's side.
    assert -0.0021 < fields["B.x"].max() < -0.0015


@each("name, swings", [("watt_six_bar", {"bell_crank": 74, "agitator": 172}), ("stephenson_six_bar", {"feeder": 38})])
def test_six_bar_template__swings_as_its_comment_says(name, swings):
    values, _, _ = template(name)
    assert {link: round(math.degrees(values[f"{link}.swing"][0])) for link in swings} == swings


def test_stephenson_six_bar_template__dwells_as_its_comment_says():
    _, fields, _ = template("stephenson_six_bar")
    angle = np.degrees(np.concatenate([fields["feeder.angle"]] * 2))
    assert min(np.ptp(angle[k : k + 200]) for k in range(720)) < 0.2


# Bundled studies


class Sample(NamedTuple):
    """Some variants of a study from all over its design space, none of them dropped, and the scene as it is, last."""

    values: dict
    summaries: dict
    errors: dict
    fields: dict


@functools.cache
def study(name):
    return read_study(bundled_studies()[name])


@functools.cache
def sample(name, count=12, places=4):
    s = study(name)
    starts = np.linspace(0, s.design.size - count, places).astype(int)
    parts = [s.values(int(start), int(start) + count) for start in starts]
    keep = ~np.concatenate([drop for _, drop in parts])
    values = {key: np.concatenate([part[key] for part, _ in parts])[keep] for key in parts[0][0]}
    nominal = scene_numbers(s.scene)
    tried = {path: np.append(values[path], nominal[path].value) for path in s.paths}
    outcome = Machine(s.scene, s.summaries, FIELDS.get(name, ()), s.paths, s.positions).evaluate(tried)
    assert (outcome.status == Verdict.OK).all()
    return Sample(values, outcome.summaries, outcome.errors, outcome.fields)


def variants(name):
    """Parameters, summaries and error estimates of sampled variants."""
    s = sample(name)
    return s.values, *({k: v[:-1] for k, v in table.items()} for table in (s.summaries, s.errors))


@each("name", bundled_studies())
def test_study__asks_one_question_and_chooses_by_columns_that_it_has(name):
    s = study(name)
    # One sentence, to be read aloud in one breath.
    assert s.question.index("?") == len(s.question) - 1
    assert not re.search(r"[.;:!] ", s.question)
    assert len(s.question.split()) <= 45
    assert s.title
    assert s.best.goal in s.summaries
    assert set(parse(s.best.condition, any_quantity).names) <= {*s.parameters, *s.summaries}


@each("name", [*STUDY_NAMES, *FRICTION_STUDY_NAMES])
def test_study__gives_finite_numbers_all_over_its_design_space(name):
    found = sample(name)
    assert len(found.values[study(name).parameters[0]]) > 10
    assert 1000 <= study(name).design.size <= 20000
    assert all(np.isfinite(v).all() for v in (*found.summaries.values(), *found.errors.values()))


@each("name", STUDY_NAMES)
def test_study__drops_some_variants_and_keeps_many(name):
    _, drop = study(name).values(0, study(name).design.size)
    assert 0.2 < drop.mean() < 0.7


def test_crank_press_study__has_the_power_and_flywheel_of_a_hand_calculation():
    values, o, e = variants("crank_press")
    speed, r, scale = values["input.speed"], values["input.length"], values["forces.punching.scale"]
    rod = values["groups.drive.first.length"]
    # Trapezium of the force: full over 2.4 mm, with flanks of 0.8 and 1.6 mm; then stripping and friction.
    punching = scale * 703.7e3 * (0.0024 + (0.0008 + 0.0016) / 2)
    work = punching + 28e3 * 0.009 + 250 * TURN
    assert np.allclose(o["ram.stroke"], 2 * r, rtol=1e-9, atol=0)
    assert (abs(o["required_power"] - work * speed / TURN) <= e["required_power"] + 1e-9).all()
    # The excess is the work of the punch, less what the mean moment supplies while it is in the plate: from 9 to
    # 4.2 mm above the bottom, angles by the law of cosines. That leaves out stripping, the weight of the ram, and the
    # ends of the push, where the moment is below its mean: 10 %.
    into, out = (np.arccos(((r + rod - h) ** 2 + r**2 - rod**2) / (2 * r * (r + rod - h))) for h in (0.009, 0.0042))
    excess = punching - (work / TURN - 250) * (into - out)
    assert np.allclose(o["excess_work"], excess, rtol=0.1, atol=0)
    assert np.allclose(o["flywheel_excess_work"], o["excess_work"] / (0.1 * speed**2), rtol=1e-12, atol=0)
    # A rim of 1 m outer and 0.8 m inner diameter on a shaft 7.5 times as fast.
    mass = o["flywheel_wittenbauer"] / 7.5**2 / ((0.5**2 + 0.4**2) / 2)
    assert np.allclose(o["wheel_mass"], mass, rtol=1e-9, atol=0)


def test_stirling_study__does_the_work_of_schmidts_theory():
    """p = S/(1 + b cos ψ) against dV = −½ V sin φ: work π V S sin θ (1/√(1 − b²) − 1)/b, of both volumes in turn."""
    values, o, e = variants("stirling_engine")
    volumes = {side: values[f"{side}_volume"] for side in ("hot", "cold")}
    warm, alpha, ratio = 0.378 * volumes["hot"], values["v_angle"], 0.378
    swing = np.hypot(warm + volumes["cold"] * np.cos(alpha), volumes["cold"] * np.sin(alpha)) / 2
    theta = np.arctan2(volumes["cold"] * np.sin(alpha), warm + volumes["cold"] * np.cos(alpha))
    mean = (warm + volumes["cold"]) / 2 + 40e-6
    b, pressure = swing / mean, 11e5 * (mean - swing) / mean
    work = math.pi * volumes["hot"] * pressure * np.sin(theta) * (1 / np.sqrt(1 - b**2) - 1) / b
    # Clockwise, so that what drives is negative. What the cold side takes is the work times the temperatures' ratio.
    for side, share in (("hot", 1.0), ("cold", -ratio)):
        apart = np.abs(o[f"{side}_gas.moment.mean"] + share * work / TURN)
        assert (apart <= e[f"{side}_gas.moment.mean"] + 1e-12 * work).all()
    speed = 1000 * TURN / 60
    power = (work * (1 - ratio) / TURN - 0.5 - 0.01 * speed) * speed
    assert np.allclose(o["required_power"], -power, rtol=1e-11, atol=0)
    assert np.allclose(o["hot.stroke"], 2 * values["input.length"], rtol=1e-12, atol=0)


def test_compressor_study__does_the_indicated_work_of_the_closed_form():
    values, o, e = variants("compressor")
    n, p1, p2, clearance = 1.13, 101.4e3, 910.1e3, 0.05
    drawn_in = 1 + clearance - clearance * (p2 / p1) ** (1 / n)
    swept = math.pi / 4 * values["cylinders.air.bore"] ** 2 * o["piston.stroke"]
    # Every variant delivers the same.
    assert np.allclose(swept * drawn_in * values["input.speed"] / TURN, 0.4311 / 60, rtol=1e-9, atol=0)
    work = n / (n - 1) * p1 * swept * drawn_in * ((p2 / p1) ** ((n - 1) / n) - 1)
    assert (abs(-o["air.moment.mean"] * TURN - work) <= e["air.moment.mean"] * TURN + 1e-9).all()
    power = (work + 2 * TURN) * values["input.speed"] / TURN
    assert (abs(o["required_power"] - power) <= e["required_power"] + 1e-9).all()


def test_shaper_study__keeps_stroke_and_return_ratio():
    values, o, e = variants("shaper")
    assert (abs(o["ram.stroke"] - 0.450) <= e["ram.stroke"] + 1e-12).all()
    ratio = values["time_ratio"]
    assert (abs(o["ram.stroke_time_ratio"] - ratio) <= e["ram.stroke_time_ratio"] + 1e-9).all()
    # Chip over nine tenths of the stroke, ways over both strokes, friction over the turn.
    work = values["forces.cutting.scale"] * 3000 * 0.405 + 180 * 0.900 + 30 * TURN
    assert (abs(o["required_power"] - work * values["input.speed"] / TURN) <= e["required_power"] + 1e-9).all()
    assert cuts_slowly(*(field[-1] for field in sample("shaper").fields.values()))


def test_jaw_crusher_study__moves_the_jaw_as_its_toggles_slope():
    values, o, _ = variants("jaw_crusher")
    # Small displacements: each of two toggles spreads by 2 e tan(slope), the jaw takes 1100 mm of its 1500 mm.
    rise = np.tan(np.radians(values["slope_in_degrees"]))
    small = 4 * values["input.length"] * rise * 1100 / 1500
    # Beyond that, terms of the order of (e / toggle)^2, magnified by the slope, and the jaw's own small angle.
    beyond = (values["input.length"] / (values["groups.rear.second.length"] * rise)) ** 2
    assert (abs(o["S.x.range"] / small - 1) <= 0.02 + beyond / 2).all()


# Friction in pairs


@each("name", FRICTION_STUDY_NAMES)
def test_study_with_friction__is_far_from_jamming(name):
    assert (sample(name).summaries["jamming_margin"] > 0.5).all()


def test_toggle_press_study__has_the_force_of_leaning_bars():
    values, o, e = variants("toggle_press")
    load, bar, reach, f = 100e3, 0.150, values["reach"], values["coefficient"]
    circle = WORN_IN * np.array(values["pin"]) / 2 * np.sin(np.arctan(f))
    # Of the bars' forces the upper leans by one friction circle, the lower by two; the ways by their angle.
    alpha = np.arcsin(reach / bar)
    upper, lower = np.tan(alpha + np.arcsin(circle / bar)), np.tan(alpha + np.arcsin(2 * circle / bar))
    expected = load / (1 - f * lower) * (upper + lower)
    assert (abs(o["input_moment_with_friction.min"] - expected) <= 1e-9 * load).all()
    assert (abs(o["input_moment.min"] - load * 2 * np.tan(alpha)) <= 1e-9 * load).all()
    works = sum(o[f"{pair}.friction_work"] for pair in ("knee.first", "press.first", "press.inner", "press.second"))
    np.testing.assert_allclose(works, o["friction_loss"], rtol=1e-12)
    assert (e["friction_loss"] <= 0.01 * o["friction_loss"]).all()
