"""Extremes of every number against 80 digits: near dead centres, tiny and huge, fast and slow; and the laws of scale.

Tolerances of the slider-crank's fields are those of its closed form, see `extreme_slider_crank`. Summaries are off by
no more than their own error estimates.
"""

import math

import mpmath as mp
import numpy as np
import pytest
from closed_forms import rocker_swing
from extreme_slider_crank import (
    CASES,
    EPS,
    FIELDS,
    NUMBERS,
    POSITIONS,
    ROUNDINGS,
    SLIDER_CRANK,
    SUMMARIES,
    Closed,
    Cycle,
    paths,
    usual,
)
from hypothesis import given, settings
from hypothesis import strategies as st
from machines import four_bar, frame

from engine import Machine, Scene, Verdict
from engine.compiling.threads import set_threads, threads
from engine.machine.measuring.measuring import CLOSELY


@pytest.fixture(scope="module")
def machines() -> dict[type, Machine]:
    scene, fields = Scene.model_validate(SLIDER_CRANK), [name for name, _ in FIELDS.values()]
    return {
        dtype: Machine(scene, SUMMARIES, fields, [path for path, _, _ in NUMBERS.values()], POSITIONS, dtype)
        for dtype in EPS
    }


@pytest.mark.parametrize("name", CASES)
def test_fields_of_an_extreme__are_the_closed_form(machines, name):
    numbers = usual(**CASES[name])
    outcomes = {dtype: machine.evaluate(paths([numbers])) for dtype, machine in machines.items()}
    with mp.workdps(80):
        closed = Closed(machines[np.float64].nodes, numbers)
        for dtype, outcome in outcomes.items():
            assert outcome.status[0] == Verdict.OK
            for key, true_row in closed.rows.items():
                row = outcome.fields[FIELDS[key][0]][0]
                for got, true, slack in zip(row, true_row, closed.slack[key], strict=True):
                    assert abs(mp.mpf(float(got)) - true) <= slack * EPS[dtype], (dtype, key, got, true)


@pytest.mark.parametrize("name", CASES)
def test_work_in_an_extreme__is_the_closed_form(machines, name):
    numbers = usual(**CASES[name])
    kept = {dtype: machine.evaluate(paths([numbers])) for dtype, machine in machines.items()}
    figure = kept[np.float64].errors["excess_work"][0]
    for dtype, outcome in kept.items():
        if outcome.status[0] != Verdict.OK:
            continue
        with mp.workdps(80):
            cycle = Cycle(numbers)
            places = [mp.mpf(float(phi)) for phi in machines[dtype].nodes]
            true = [cycle.work(phi) for phi in places]
            # A position of its own is rounded, too, and moves the work by the moment there.
            moved = [abs(cycle.moment(phi, cycle.transfer(phi)[1])) * float(phi) for phi in places]
        # Between the positions of panels it is off by what their series leave of the moment.
        series = 2 * math.pi * CLOSELY * np.abs(outcome.fields["reduced_moment"]).max()
        for got, value, of_place in zip(outcome.fields["work"][0], true, moved, strict=True):
            room = EPS[dtype] * abs(value) + ROUNDINGS * EPS[np.float64] * of_place
            assert abs(mp.mpf(float(got)) - value) <= figure + series + room, (got, value)


@pytest.mark.parametrize("name", CASES)
def test_summaries_of_an_extreme__are_those_of_the_continuous_cycle(machines, name):
    numbers = usual(**CASES[name])
    outcome = machines[np.float64].evaluate(paths([numbers]))
    assert outcome.status[0] == Verdict.OK
    # At a ratio of 1e-6 the closed form of the drag's work loses 24 digits.
    with mp.workdps(80):
        true = Cycle(numbers).summaries()
        for key, value in true.items():
            got, figure = mp.mpf(float(outcome.summaries[key][0])), outcome.errors[key][0]
            assert (mp.isnan(value) and mp.isnan(got)) or abs(got - value) <= figure, (key, got, value, figure)
    # The figures aren't large because nothing is known: near a dead centre a rounding of the rod's length moves the
    # ram's speed by 1/cos² of that; a stroke is a difference of places as far off as the rod is long.
    r, rod, offset = numbers["r"], numbers["l"], abs(numbers["h"])
    share = 1e-9 + 16 * EPS[np.float64] * rod**2 / ((rod - r - offset) * (rod + r + offset))
    for key, least in (("excess_work", 0.0), ("flywheel_excess_work", 0.0), ("ram.stroke", 40 * EPS[np.float64] * rod)):
        # One in a hundred more for where panels are cut.
        assert outcome.errors[key][0] <= 1.01 * share * abs(outcome.summaries[key][0]) + least, key


def test_summaries_beside_fields_in_single_precision__are_in_double(machines):
    varied = paths([usual(**changes) for changes in CASES.values()])
    single, double = (machines[dtype].evaluate(varied) for dtype in (np.float32, np.float64))
    well = single.status == Verdict.OK
    for name in SUMMARIES:
        np.testing.assert_array_equal(single.summaries[name][well], double.summaries[name][well], err_msg=name)
        np.testing.assert_array_equal(single.errors[name][well], double.errors[name][well], err_msg=name)


# Numbers without a machine


@pytest.mark.parametrize("dtype", EPS)
@pytest.mark.parametrize(
    ("changes", "verdict"),
    [
        ({"l": 0.05}, Verdict.SINGULAR),
        ({"l": 0.0499999}, Verdict.CANNOT_ASSEMBLE),
        ({"r": 0.0}, Verdict.OUTSIDE_LIMITS),
        ({"m": -1e-12}, Verdict.OUTSIDE_LIMITS),
        ({"d": 2.0}, Verdict.OUTSIDE_LIMITS),
        ({"w": math.inf}, Verdict.OUTSIDE_LIMITS),
        ({"F": math.nan}, Verdict.OUTSIDE_LIMITS),
        ({"m": 1e300, "w": 1e200}, Verdict.NOT_FINITE),
        ({"F": 1e308, "r": 1e3, "l": 4e3}, Verdict.NOT_FINITE),
        # Of squares that are infinite it isn't known whether links reach.
        ({"l": 1e200}, Verdict.CANNOT_ASSEMBLE),
    ],
)
def test_every_variant_impossible__says_why_and_gives_no_summary(machines, changes, verdict, dtype):
    outcome = machines[dtype].evaluate(paths([usual(**changes)] * 7))
    assert (outcome.status == verdict).all()
    for name in ("excess_work", "flywheel_wittenbauer", "speed_fluctuation"):
        assert np.isnan(outcome.summaries[name]).all(), name
        assert np.isnan(outcome.errors[name]).all(), name


# Change points


FOUR_BAR = four_bar(O=frame(0.0, 0.0), D=frame(1.0, 0.0))
LENGTHS = ("points.O.x", "points.D.x", "input.length", "groups.bars.first.length", "groups.bars.second.length")


@pytest.mark.parametrize("dtype", EPS)
@pytest.mark.parametrize("kind", ["parallelogram", "kite", "stretched", "folded"])
def test_change_point_of_decimal_lengths__is_singular_with_a_finite_position(kind, dtype):
    rng = np.random.default_rng(3)
    origin, crank = rng.uniform(-0.2, 0.2, 300).round(2), rng.uniform(0.1, 0.4, 300).round(3)
    ground, rocker = rng.uniform(1.0, 1.5, 300).round(3), rng.uniform(0.5, 0.9, 300).round(3)
    first, second = {
        "parallelogram": (ground, crank),
        "kite": (crank, ground),
        # In line at 180°, where the crank's pin is farthest from the rocker's pivot, and at 0°, where it is nearest.
        "stretched": (ground + crank - rocker, rocker),
        "folded": (ground - crank + rocker, rocker),
    }[kind]
    machine = Machine(Scene.model_validate(FOUR_BAR), [], ["B.x", "B.y"], LENGTHS, 8, dtype)
    outcome = machine.evaluate(dict(zip(LENGTHS, (origin, origin + ground, crank, first, second), strict=True)))
    assert (outcome.status == Verdict.SINGULAR).all()
    # Within a few of the shortest panels.
    off = np.abs(outcome.status_at[:, None] - np.array([0.0, math.pi, 2 * math.pi])).min(axis=1)
    assert off.max() < 4e-6
    assert all(np.isfinite(row).all() for row in outcome.fields.values())


@pytest.mark.parametrize("accuracy", [None, 1e-2])
def test_four_bar_near_a_dead_centre__is_ok_down_to_the_limit_of_its_transmission(accuracy):
    # In line at 180° but for a surplus of the links' reach: sin² μ grows with it, here from (2e-7)² to (0.07)².
    surplus = np.logspace(-14, -3, 34)
    ground, crank, rocker = (np.full(surplus.shape, length) for length in (1.25, 0.25, 0.75))
    machine = Machine(Scene.model_validate(FOUR_BAR), [], ["B.x", "B.y"], LENGTHS, 8, accuracy=accuracy)
    lengths = (np.zeros(surplus.shape), ground, crank, ground + crank - rocker + surplus, rocker)
    assert (machine.evaluate(dict(zip(LENGTHS, lengths, strict=True))).status == Verdict.OK).all()


@pytest.mark.parametrize(("miss", "verdict"), [(1e-12, Verdict.CANNOT_ASSEMBLE), (-1e-12, Verdict.OK)])
def test_four_bar_off_its_change_point_by_1e_12__is_judged_by_the_side(miss, verdict):
    machine = Machine(Scene.model_validate(FOUR_BAR), [], ["B.x"], LENGTHS, 8)
    outcome = machine.evaluate(
        dict(zip(LENGTHS, map(np.array, ([0.0], [1.0 + miss], [0.3], [0.7], [0.6])), strict=True))
    )
    assert outcome.status == verdict


# Links of most unequal lengths, and far away


@pytest.mark.parametrize(("crank", "coupler", "rocker"), [(1e-3, 1.0, 0.8), (1e-3, 1.0, 1.0), (0.3, 1.0, 0.8)])
@pytest.mark.parametrize("origin", [0.0, 1e6, -3e6])
def test_links_one_to_a_thousand_and_origins_far_away__swing_as_their_triangles(origin, crank, coupler, rocker):
    machine = Machine(Scene.model_validate(FOUR_BAR), ["rocker.swing"], [], LENGTHS)
    lengths = (origin, origin + 1.0, crank, coupler, rocker)
    outcome = machine.evaluate({path: np.array([value]) for path, value in zip(LENGTHS, lengths, strict=True)})
    assert outcome.status[0] == Verdict.OK
    with mp.workdps(50):
        true = rocker_swing(crank, coupler, rocker, mp.mpf(origin + 1.0) - mp.mpf(origin))
        off = abs(mp.mpf(float(outcome.summaries["rocker.swing"][0])) - true)
    # Coordinates are rounded as they are far away, and the rocker's length makes angles of them.
    assert off <= outcome.errors["rocker.swing"][0] + 16 * EPS[np.float64] * (1.0 + abs(origin)) / rocker
    assert outcome.errors["rocker.swing"][0] <= 1e-8 * float(true) + 32 * EPS[np.float64] * abs(origin)


# Laws of scale

decades = {"lengths": st.floats(-6, 6), "masses": st.floats(-12, 9), "speeds": st.floats(-9, 5)}


@settings(max_examples=15)
@given(st.floats(0.05, 0.9), st.floats(-2, 2), st.floats(-3, 0), *decades.values())
def test_scaled_machine__has_scaled_results(machines, ratio, mass, fluctuation, lengths, masses, speeds):
    base = usual(l=0.05 / ratio, m=3.0 * 10**mass, d=10**fluctuation)
    scale = [10.0**power for power in (lengths, masses, speeds)]

    def factor(powers: tuple) -> float:
        return math.prod(s**p for s, p in zip(scale, powers, strict=True))

    other = {name: base[name] * factor(powers) for name, (_, _, powers) in NUMBERS.items()}
    outcome = machines[np.float64].evaluate(paths([base, other]))
    assert (outcome.status == Verdict.OK).all()
    # Numbers scaled and results scaled back are off by some EPS; 1/cos² of the rod's angle makes more of it, once for
    # each of the three powers of the root in an acceleration.
    grown = 40 * EPS[np.float64] / (1 - ratio**2) ** 1.5
    moment = np.abs(outcome.fields["reduced_moment"][0]).max()
    for field, powers in FIELDS.values():
        one, two = outcome.fields[field]
        atol = POSITIONS * grown * np.abs(one).max() + (4 * math.pi * CLOSELY * moment if field == "work" else 0.0)
        np.testing.assert_allclose(two / factor(powers), one, rtol=0, atol=atol, err_msg=field)
    sizes = {name: outcome.summaries[name] for name in SUMMARIES}
    # Loads and inertia forces may cancel in a sum: what rounding does to either is left.
    largest = abs(sizes["flywheel_excess_work"][0]) + np.abs(outcome.fields["reduced_inertia"][0]).max() / base["d"]
    scales = {name: largest for name in sizes if name.startswith("flywheel")}
    scales |= {"speed_fluctuation": 2.0, "ram.stroke": 0.05 / ratio}
    for name, (one, two) in sizes.items():
        of_one, of_two = outcome.errors[name] / [1.0, factor(SUMMARIES[name])]
        atol = of_one + of_two + grown * scales.get(name, 2 * math.pi * moment * max(1.0, base["w"]))
        np.testing.assert_allclose(two / factor(SUMMARIES[name]), one, rtol=0, atol=atol, err_msg=name)


# Regimes

MOTOR = {"dc": {"type": "dc_motor", "on": "crank", "stall_moment": 60.0, "no_load_speed": 20.0}}
REGIMES = {
    "go": {"type": "run", "cycles": 3.0},
    "on": {"type": "steady"},
    "stop": {"type": "run", "rest": True, "off": ["dc", "push"]},
}
OF_REGIMES = {
    **{f"go.{name}": powers for name, powers in {"time": (0, 0, -1), "final_speed": (0, 0, 1)}.items()},
    **{f"on.{name}": (0, 0, 1) for name in ("mean_speed", "speed_min", "speed_max")},
    **{"on.period": (0, 0, -1), "on.multiplier": (0, 0, 0), "on.motor_moment_peak": (2, 1, 2)},
    **{"stop.time": (0, 0, -1), "stop.angle": (0, 0, 0), "stop.energy_change": (2, 1, 2)},
}


@pytest.fixture(scope="module")
def moving() -> Machine:
    moments = {**MOTOR, "rub": {"type": "against_motion", "on": "crank", "moment": 3.0}}
    scene = SLIDER_CRANK | {"moments": moments, "regimes": REGIMES, "flywheel": {"inertia": 0.5}}
    varied = [path for path, _, _ in NUMBERS.values() if path != "flywheel.speed_fluctuation"]
    return Machine(Scene.model_validate(scene), OF_REGIMES, [], [*varied, *OF_MOTION], 48)


OF_MOTION = {
    "moments.dc.stall_moment": (60.0, (2, 1, 2)),
    "moments.dc.no_load_speed": (20.0, (0, 0, 1)),
    "moments.rub.moment": (3.0, (2, 1, 2)),
    "flywheel.inertia": (0.5, (2, 1, 0)),
}
SCALES = [(1e-6, 1, 1), (1e6, 1, 1), (1, 1e-12, 1), (1, 1e9, 1), (1, 1, 1e-9), (1, 1, 1e4), (1e-6, 1e-12, 1e4)]


def test_scaled_motion__goes_the_same_way(moving):
    scales = np.array([(1, 1, 1), *SCALES], float).T
    numbers = {path: (value, powers) for path, value, powers in NUMBERS.values()} | OF_MOTION

    def factors(powers: tuple) -> np.ndarray:
        return np.prod([s**p for s, p in zip(scales, powers, strict=True)], axis=0)

    outcome = moving.evaluate({path: numbers[path][0] * factors(numbers[path][1]) for path in moving.varied})
    assert (outcome.status == Verdict.OK).all(), outcome.status
    for name, powers in OF_REGIMES.items():
        found = outcome.summaries[name] / factors(powers)
        # The same steps, each of some hundred roundings, some two hundred of them.
        np.testing.assert_allclose(found, found[0], rtol=2e4 * EPS[np.float64], err_msg=name)


# Threads


@pytest.mark.parametrize("shapes", [1, 60])
def test_threads_and_chunks__change_no_bit(machines, shapes):
    rng = np.random.default_rng(5)
    variants = [usual(m=rng.uniform(0.1, 9), F=rng.uniform(-900, 900), l=0.1 + 0.01 * (i % shapes)) for i in range(150)]
    machine, varied = machines[np.float64], paths(variants)
    before = threads()
    try:
        found = []
        for count in (1, 2, 3, 5):
            set_threads(count)
            outcome = machine.evaluate(varied)
            found.append({k: v.copy() for k, v in (outcome.summaries | outcome.errors | outcome.fields).items()})
    finally:
        set_threads(before if before != threads() else 0)
    for other in found[1:]:
        for name, row in other.items():
            assert row.tobytes() == found[0][name].tobytes(), name
    for cut in (slice(0, 20), slice(20, 90), slice(90, 150)):
        part = machine.evaluate({path: values[cut] for path, values in varied.items()})
        for name, row in (part.summaries | part.errors | part.fields).items():
            assert row.tobytes() == found[0][name][cut].tobytes(), name
