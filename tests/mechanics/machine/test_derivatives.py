"""Derivatives of summaries by numbers of the scene: closed forms, mpmath at 50 digits, and their own figures."""

import math

import mpmath
import numpy as np
import pytest
from element_samples import JACK, scene
from hypothesis import given, settings
from hypothesis import strategies as st
from machines import slider_crank as crank_and_ram
from mpmath import mpf

from engine import Machine, Outcome, Scene, Verdict, made_ready
from engine.machine.derivatives import LADDERS, Move, derivatives_along, scale_of, unit_over
from engine.machine.extrapolation import Differences, derivative_of

EPS = np.finfo(float).eps
POSITIONS = 96
LENGTH, ROD, OFFSET, MASS, FORCE = (
    "input.length",
    "groups.drive.first.length",
    "guides.way.y",
    "bodies.ram_body.mass",
    "forces.push.force",
)
MEANS = ("ram.slide.mean", "ram.slide.rms", "reduced_inertia.mean")
SUMMARIES = (*MEANS, "ram.stroke", "excess_work", "ram.stroke_time_ratio", "reduced_inertia.max")
NOMINAL = {LENGTH: 0.05, ROD: 0.2, OFFSET: 0.01, MASS: 2.0, FORCE: 300.0}


def slider_crank() -> Scene:
    """An offset slider-crank whose ram alone has a mass, pushed one way by a constant force."""
    parts = {
        "guides": {"way": {"y": NOMINAL[OFFSET]}},
        "bodies": {"ram_body": {"link": "ram", "mass": NOMINAL[MASS]}},
        "flywheel": {"speed_fluctuation": 0.02},
        "forces": {"push": {"type": "constant", "on": "B", "angle": 0.0, "force": NOMINAL[FORCE]}},
    }
    return Scene.model_validate(crank_and_ram(NOMINAL[LENGTH], NOMINAL[ROD], 6.0, "drive", **parts))


@pytest.fixture(scope="module")
def machine() -> Machine:
    return Machine(slider_crank(), SUMMARIES, varied=list(NOMINAL), positions=POSITIONS)


def derivatives(machine: object, varied: dict, by: str):
    """Derivatives by one number alone."""

    def moved(values: np.ndarray, variants: np.ndarray) -> dict[str, np.ndarray]:
        return {path: numbers[variants] for path, numbers in varied.items()} | {by: values}

    return derivatives_along(machine, Move(varied[by], scale_of(machine.scene, varied, by), moved))


def found(machine: Machine, by: str, **numbers: float):
    """Derivatives by one number, of one variant."""
    values = NOMINAL | {path.replace("__", "."): value for path, value in numbers.items()}
    return derivatives(machine, {path: np.array([value]) for path, value in values.items()}, by)


def stroke(length, rod, offset):
    """Between the two positions where crank and rod are in line."""
    return mpmath.sqrt((rod + length) ** 2 - offset**2) - mpmath.sqrt((rod - length) ** 2 - offset**2)


def reference(function, by: str, numbers: dict):
    """Derivative of a function of (length, rod, offset, mass) by one of them."""
    with mpmath.workdps(50):
        order = (LENGTH, ROD, OFFSET, MASS)
        values = [mpf(numbers[path]) for path in order]

        def along(x):
            return function(*(x if path == by else value for path, value in zip(order, values, strict=True)))

        return mpmath.diff(along, values[order.index(by)])


# Extrapolation by itself


def sampled(function, at: float, scale: float, error: float = 0.0) -> Differences:
    steps = np.array(LADDERS[0])
    places = at + scale * steps[:, None] * np.array([1.0, -1.0])
    with np.errstate(invalid="ignore"):
        value = function(places)
    here, errors = function(np.array([at])), np.full((1, *places.shape), error)
    return Differences(steps, (places - at)[None], here, errors[:, 0, 0], value[None], errors)


@given(
    st.sampled_from(
        [
            (np.sin, np.cos),
            (np.exp, np.exp),
            (lambda x: 1 / (3 - x), lambda x: 1 / (3 - x) ** 2),
            (lambda x: x**3, lambda x: 3 * x**2),
            (lambda x: 7 * x, lambda x: 7 + 0 * x),
        ]
    ),
    st.floats(-1.5, 1.5),
    st.floats(0.01, 1.0),
)
@settings(max_examples=60)
def test_smooth_function__derivative_within_a_small_figure(pair, at, scale):
    function, slope = pair
    made = derivative_of(sampled(function, at, scale), 4 * EPS)
    exact = slope(np.array([at]))[0]
    assert abs(made.value[0] - exact) <= made.error[0]
    # Steps down to 2⁻⁷ of the scale magnify 4 roundings 2⁹ EPS at most, or leave (2⁻²…2⁻⁷)⁸ of the eighth power.
    size = abs(function(np.array([at]))[0]) + 1
    assert made.error[0] <= 1e-11 * size / scale


@pytest.mark.parametrize("at", [0.0, 1e-4, -0.003, 0.1])
def test_kink_within_the_steps__figure_covers_the_slope_there(at):
    made = derivative_of(sampled(np.abs, at, 1.0), 4 * EPS)
    assert abs(made.value[0] - np.sign(at)) <= made.error[0]


@given(st.floats(1e-9, 1e-3), st.integers(0, 2**32 - 1))
@settings(max_examples=40)
def test_noise_within_the_error_figure__is_covered(noise, seed):
    random = np.random.default_rng(seed)
    made = derivative_of(
        sampled(lambda x: np.sin(x) + random.uniform(-noise, noise, x.shape), 0.7, 1.0, noise), 4 * EPS
    )
    assert abs(made.value[0] - math.cos(0.7)) <= made.error[0]
    # Weights over steps of 2⁻³ and 2⁻⁴ add up to 24; windows that differ and the sides that do count as much each.
    assert made.error[0] <= 1e-9 + 500 * noise


@pytest.mark.parametrize("side", [0, 1])
def test_one_side_missing__differences_to_the_other(side):
    samples = sampled(np.exp, 0.3, 1.0)
    samples.value[0, :, side] = np.nan
    made = derivative_of(samples, 4 * EPS)
    assert abs(made.value[0] - math.exp(0.3)) <= made.error[0]
    # Four steps down to 2⁻⁷: their product 2⁻²² times the fifth derivative over 5!, twice for the coarser window.
    assert made.error[0] < 1e-6


def test_error_figure_small_by_chance_at_one_step__counts_as_at_those_beside():
    noise = 1e-6
    samples = sampled(np.sin, 0.7, 1.0, noise)
    samples.error[0, 2] = 0.0
    # Over the longest step of 1/4 a function off by ± noise may have a slope of twice that, over the step.
    assert derivative_of(samples, 4 * EPS).error[0] >= 2 * noise / 0.25


# Neighbours


class Stub:
    """Answers with a function of one number; another verdict where a condition isn't met."""

    asked_summaries = ("f",)
    dtype = np.dtype(float)

    def __init__(self, function, fails, verdict):
        self.function, self.fails, self.verdict = function, fails, verdict

    def evaluate(self, varied):
        x = varied["x"]
        status = np.where(self.fails(x), np.uint8(self.verdict), np.uint8(Verdict.OK))
        found = {"f": self.function(x)}
        return Outcome(status, status.astype(int), x, found, {"f": 0 * x}, {})

    def along(self, at):
        place = np.array([at])
        return derivatives_along(self, Move(place, np.ones(1), lambda values, variants: {"x": values}))


def test_neighbours_that_fail__don_t_count_though_they_have_numbers():
    stub = Stub(lambda x: np.where(x > 0.31, 1e6, np.exp(x)), lambda x: x > 0.31, Verdict.SINGULAR)
    made = stub.along(0.3)
    assert made.status[0] == Verdict.OK
    assert abs(made.values["f"][0] - math.exp(0.3)) <= made.errors["f"][0] < 1e-9


@pytest.mark.parametrize("room", [0.3, 3e-3, 1e-3])
def test_little_room_to_both_sides__shorter_steps(room):
    stub = Stub(np.exp, lambda x: abs(x - 0.3) > room, Verdict.CANNOT_ASSEMBLE)
    made = stub.along(0.3)
    assert made.status[0] == Verdict.OK
    # 16 roundings over the longest steps that fit, of which there is one in four, and magnified some ten times.
    assert abs(made.values["f"][0] - math.exp(0.3)) <= made.errors["f"][0] < 1e3 * EPS / min(room, 0.01)
    assert Stub(np.exp, lambda x: x != 0.3, Verdict.JAMS).along(0.3).status[0] == Verdict.JAMS


# Against closed forms


@given(st.floats(0.002, 0.5), st.floats(1.02, 10.0), st.floats(-0.5, 0.5), st.sampled_from([LENGTH, ROD, OFFSET]))
@settings(max_examples=15)
def test_any_slider_crank__within_its_figure(machine, length, ratio, share, by):
    offset = share * length
    rod = ratio * (length + abs(offset))
    numbers = NOMINAL | {LENGTH: length, ROD: rod, OFFSET: offset}
    made = derivatives(machine, {path: np.array([value]) for path, value in numbers.items()}, by)
    exact = reference(lambda r, rod, e, m: stroke(r, rod, e), by, numbers)
    assert made.status[0] == Verdict.OK
    assert abs(made.values["ram.stroke"][0] - exact) <= made.errors["ram.stroke"][0]
    # The work of a constant force swings by force times stroke; its extremes lie between positions.
    work = NOMINAL[FORCE] * exact
    assert abs(made.values["excess_work"][0] - work) <= made.errors["excess_work"][0]


def test_mass__linear_to_rounding_and_from_none_on(machine):
    names = ("reduced_inertia.mean", "reduced_inertia.max")
    made, none = found(machine, MASS), found(machine, MASS, bodies__ram_body__mass=0.0)
    values = machine.evaluate({path: np.array([value]) for path, value in NOMINAL.items()}).summaries
    for name in names:
        # Steps of a quarter and less of the mass: some roundings of the sum, magnified four times.
        assert made.values[name][0] == pytest.approx(values[name][0] / NOMINAL[MASS], rel=64 * EPS)
        assert none.values[name][0] == pytest.approx(made.values[name][0], rel=64 * EPS)
    assert none.status[0] == Verdict.OK


def test_number_that_plays_no_part__zero(machine):
    made = found(machine, MASS)
    assert made.values["ram.stroke"][0] == 0
    assert made.errors["ram.stroke"][0] <= 2**6 * EPS


# Where there is a kink, a limit, or no neighbour


def test_quick_return_of_a_central_slider_crank__kink_is_told(machine):
    kink = found(machine, OFFSET, guides__way__y=0.0)
    beside = found(machine, OFFSET, guides__way__y=0.005)
    slope = beside.values["ram.stroke_time_ratio"][0]
    assert slope > 1
    # It grows to both sides.
    assert kink.errors["ram.stroke_time_ratio"][0] > slope
    assert abs(kink.values["ram.stroke_time_ratio"][0]) < kink.errors["ram.stroke_time_ratio"][0]
    assert beside.errors["ram.stroke_time_ratio"][0] < 0.1 * slope


def test_next_to_the_limit_of_assembly__one_side_or_none(machine):
    # Crank and rod all but equal: any offset, and any shorter rod, can't be assembled.
    short = {"groups__drive__first__length": 0.05 * (1 + 1e-9), "guides__way__y": 0.0}
    none, one = found(machine, OFFSET, **short), found(machine, ROD, **short)
    assert none.status[0] == Verdict.CANNOT_ASSEMBLE
    assert np.isnan(none.values["ram.stroke"][0])
    assert one.status[0] == Verdict.OK
    # (l + r) − (l − r) doesn't depend on l.
    assert abs(one.values["ram.stroke"][0]) <= one.errors["ram.stroke"][0]


def test_variant_that_fails__has_its_own_verdict(machine):
    failed = found(machine, LENGTH, input__length=0.3)
    assert failed.status[0] == Verdict.CANNOT_ASSEMBLE
    assert all(np.isnan(values[0]) for values in (*failed.values.values(), *failed.errors.values()))


def test_machine_elements__exact_where_linear():
    name, load = "jack.raise_moment", "elements.jack.load"
    alone = made_ready(scene(jack=JACK), [name], (), [load])
    values = {load: np.array([6400.0, 100.0])}
    made = derivatives(alone, values, load)
    # Moments are in proportion to the load.
    np.testing.assert_allclose(made.values[name], alone.evaluate(values).summaries[name] / values[load], rtol=64 * EPS)


@pytest.mark.parametrize(
    ("path", "value", "expected"),
    [
        (ROD, 0.2, 0.2),
        (OFFSET, 0.0, 0.05),
        (OFFSET, 3.0, 0.05),
        ("guides.way.angle", 0.0, 1.0),
        (MASS, 0.0, 2.0),
        ("input.speed", -6.0, 6.0),
        # A tenth below its limit of 2: the longest step, a quarter of the scale, goes half of the way.
        ("flywheel.speed_fluctuation", 1.9, 0.2),
        ("flywheel.speed_fluctuation", 2.0, 2.0),
    ],
)
def test_scale__of_the_number_or_of_its_surroundings(path, value, expected):
    assert scale_of(slider_crank(), {path: np.array([value])}, path) == pytest.approx([expected])


@pytest.mark.parametrize(
    ("above", "below", "expected"),
    [
        ("J", "m", "J m-1"),
        ("N m", "m", "N"),
        ("m", "m", "1"),
        ("1", "kg", "kg-1"),
        ("kg m2", "1", "kg m2"),
        ("W", "rad s-1", "W s rad-1"),
        ("kg m2", "kg m2", "1"),
        ("m", "m2", "m-1"),
    ],
)
def test_unit_of_a_derivative__quotient(above, below, expected):
    assert unit_over(above, below) == expected


def test_kink_at_the_place__figure_holds_the_jump():
    made = derivative_of(sampled(lambda x: np.where(x > 0, 3 * x, x), 0.0, 1.0), 4 * EPS)
    # Slopes of 1 and 3 differ by 2; their mean is all that differences to both sides can tell.
    assert made.error[0] == pytest.approx(2, rel=1e-6)
