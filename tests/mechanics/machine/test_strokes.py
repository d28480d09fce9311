"""Strokes, swings, time ratios and transmission angles of whole machines against closed forms."""

import math

import numpy as np
import pytest
from machines import crank, frame, on, rpr, rrp, rrr

from engine import Machine, Scene, Verdict
from engine.cycle.measured import Measured
from engine.quantities.chapters.strokes import quick_return_ratio

EPS = np.finfo(float).eps
TURN = 2 * math.pi


def apart(a, b):
    """Distance of two crank angles."""
    return abs((a - b + math.pi) % TURN - math.pi)


def within_figures(outcome, name, exact, room):
    """Each value is off by no more than its own figure, and by rounding of the closed form."""
    found, figures = outcome.summaries[name], outcome.errors[name]
    off = apart(found, exact) if name.endswith("_at") else np.abs(found - exact)
    np.testing.assert_array_less(off, figures + room + 1e-300, err_msg=name)


# The quick-return ratio


def test_quick_return_ratio__of_an_end_that_may_be_at_either_of_two_places_is_undefined():
    # A slide that comes to its far end twice in a turn, half a turn apart.
    found = quick_return_ratio(Measured(0.0), Measured(math.pi / 2, math.pi))
    assert math.isnan(found.value)
    assert math.isnan(found.error)
    # From the earlier of two ties the ratio is 1.02, from the other 2.45.
    found = quick_return_ratio(Measured(4.01181, 1.35762), Measured(0.90846, 1e-13))
    assert math.isnan(found.value)


# Machines


def scene(groups, points, length, guides=None, **more):
    return Scene.model_validate(
        {
            "points": {"O": frame(0.0, 0.0)} | points,
            "guides": guides or {},
            "input": crank(length=length, speed=10.0, revolutions=2),
            "groups": groups,
        }
        | more
    )


SLIDER_CRANK = rrp("B", ("rod", "A", 0.2), "ram", "way", 0.01)


def test_offset_slider_crank__has_the_stroke_and_time_ratio_of_its_triangles():
    asked = ["ram.stroke", "ram.stroke_low_at", "ram.stroke_high_at", "ram.stroke_time_ratio", "g.transmission_angle"]
    rng = np.random.default_rng(3)
    r, rod = rng.uniform(0.01, 0.08, 60), rng.uniform(0.12, 0.5, 60)
    offset = rng.uniform(-0.95, 0.95, 60) * (rod - r)
    varied = {"input.length": r, "groups.g.first.length": rod, "groups.g.second.offset": offset}
    outcome = Machine(scene({"g": SLIDER_CRANK}, {}, 0.05, {"way": {}}), asked, varied=list(varied)).evaluate(varied)
    assert (outcome.status == Verdict.OK).all()
    far, near = np.sqrt((rod + r) ** 2 - offset**2), np.sqrt((rod - r) ** 2 - offset**2)
    high, low = np.arcsin(offset / (rod + r)), np.pi + np.arcsin(offset / (rod - r))
    ratio = (np.pi + np.abs(low - high - np.pi)) / (np.pi - np.abs(low - high - np.pi))
    # Roots of differences: rounding is some EPS of the longest length squared, over the root.
    within_figures(outcome, "ram.stroke", far - near, 8 * EPS * (rod + r) ** 2 / near)
    steep = 8 * EPS * (rod + r) ** 2 / near**2
    within_figures(outcome, "ram.stroke_high_at", high, steep)
    within_figures(outcome, "ram.stroke_low_at", low, steep)
    within_figures(outcome, "ram.stroke_time_ratio", ratio, 4 * steep * (1 + ratio) ** 2)
    # Rod against guide: sin β = (r + |e|)/l at a crank across the guide.
    sine = (r + np.abs(offset)) / rod
    within_figures(outcome, "g.transmission_angle", np.arccos(sine), 8 * EPS / np.sqrt((1 - sine) * (1 + sine)))
    for name in ("ram.stroke", "g.transmission_angle"):
        assert (outcome.errors[name] <= 1e-9 * outcome.summaries[name]).all()


ROCKER = rrr("B", ("rod", "A", 0.2), ("rocker", "D", 0.15))


def test_crank_rocker__has_the_swing_of_its_dead_centres():
    names = ["rocker.swing", "rocker.swing_time_ratio", "rod.swing", "g.transmission_angle"]
    rng = np.random.default_rng(4)
    a, b, c = rng.uniform(0.01, 0.05, 100), rng.uniform(0.18, 0.25, 100), rng.uniform(0.13, 0.17, 100)
    d = np.full(100, 0.22)
    varied = {"input.length": a, "groups.g.first.length": b, "groups.g.second.length": c, "points.D.x": d}
    machine = Machine(scene({"g": ROCKER}, {"D": {"x": 0.22, "y": 0}}, 0.05), names, varied=list(varied))
    outcome = machine.evaluate(varied)

    def triangle(side, other, opposite):
        return np.arccos((side**2 + other**2 - opposite**2) / (2 * side * other))

    # Crank and coupler in line, stretched and folded: triangles of sides b ± a, c, d.
    swing = triangle(d, c, b + a) - triangle(d, c, b - a)
    between = triangle(d, b - a, c) - triangle(d, b + a, c)
    ratio = (np.pi + np.abs(between)) / (np.pi - np.abs(between))
    # Angles of triangles whose cosines stay below 0.99: some tens of EPS.
    within_figures(outcome, "rocker.swing", swing, 64 * EPS)
    within_figures(outcome, "rocker.swing_time_ratio", ratio, 512 * EPS)
    # Least transmission angle with the crank along the line of centres, one way or the other.
    angle = np.array([triangle(b, c, d - a), triangle(b, c, d + a)])
    within_figures(outcome, "g.transmission_angle", np.minimum(angle, np.pi - angle).min(axis=0), 64 * EPS)
    assert np.isfinite(outcome.summaries["rod.swing"]).all()


def test_swing_of_a_link_that_turns_round__is_undefined():
    # A double crank: the fixed link is the shortest, so all others turn round.
    names = ["rocker.swing", "rocker.swing_time_ratio", "rod.swing", "rocker.angle_phi.mean"]
    outcome = Machine(scene({"g": ROCKER}, {"D": {"x": 0.05, "y": 0}}, 0.18), names).evaluate({})
    assert outcome.status[0] == Verdict.OK
    for name in names[:3]:
        assert np.isnan([outcome.summaries[name][0], outcome.errors[name][0]]).all()
    # Once for each turn of the crank.
    assert abs(outcome.summaries["rocker.angle_phi.mean"][0] - 1.0) <= outcome.errors["rocker.angle_phi.mean"][0]


@pytest.mark.parametrize(("pivot", "crank"), [(0.22, 0.05), (0.05, 0.18)], ids=["swings", "turns round"])
def test_statistics_of_an_angle__are_those_of_its_rows(pivot, crank):
    links, of = ("rocker.angle", "rod.angle"), ("mean", "rms", "min", "max", "range")
    names = [f"{link}.{s}" for link in links for s in of]
    drawn = scene({"g": ROCKER}, {"D": {"x": pivot, "y": 0}}, crank).model_dump(exclude_none=True)
    del drawn["input"]["revolutions"]
    outcome = Machine(Scene.model_validate(drawn), names, links, positions=7200).evaluate({})
    assert outcome.status[0] == Verdict.OK
    for link in links:
        row, h = outcome.fields[link][0], TURN / 7200
        turn = TURN * round((row[-1] - row[0]) / TURN)
        closed = np.append(row, row[0] + turn)
        size = np.abs(closed).max()
        # The rates are the same at both ends, so that the trapezoid rule is exact for the angle, and all but for its
        # square, whose rate changes by 2 ψ′ times the turn: h²/12 of that.
        of_square = abs(h**2 / 12 * 2 * turn * (row[1] - row[0]) / h) / TURN
        mean, square = ((0.5 * (rows[0] + rows[-1]) + rows[1:-1].sum()) / 7200 for rows in (closed, closed**2))
        found = {s: (outcome.summaries[f"{link}.{s}"][0], outcome.errors[f"{link}.{s}"][0]) for s in of}
        assert abs(found["mean"][0] - mean) <= found["mean"][1] + 64 * EPS * size
        rms, figure = found["rms"]
        assert abs(rms**2 - square) <= 2 * rms * figure + 2 * of_square + 64 * EPS * size**2
        # The second derivatives of these angles are below 10; an extreme lies within half a step of a position.
        for name, sign, top in (("max", 1, closed.max()), ("min", -1, closed.min())):
            value, figure = found[name]
            assert -figure - 4 * EPS * size <= sign * (value - top) <= 10 * h**2 / 8 + figure
        assert all(figure <= 1e-8 * size for _, figure in found.values())


def test_oscillating_slotted_lever__has_the_time_ratio_of_its_tangents():
    lever = rpr(("block", "A"), ("lever", "D"))
    rng = np.random.default_rng(5)
    distance = rng.uniform(0.15, 0.6, 100)
    asked = ["lever.swing", "lever.swing_time_ratio", "block.stroke", "g.transmission_angle"]
    machine = Machine(
        scene({"g": lever}, {"D": {"x": 0, "y": -0.24}}, 0.12), asked, varied=["points.D.y", "input.length"]
    )
    share = rng.uniform(0.05, 0.9, 100)
    outcome = machine.evaluate({"points.D.y": -distance, "input.length": share * distance})
    half = np.arcsin(share)
    ratio = (np.pi + 2 * half) / (np.pi - 2 * half)
    within_figures(outcome, "lever.swing", 2 * half, 64 * EPS)
    within_figures(outcome, "lever.swing_time_ratio", ratio, 64 * EPS * (1 + ratio) ** 2)
    within_figures(outcome, "block.stroke", 2 * share * distance, 8 * EPS)
    within_figures(outcome, "g.transmission_angle", np.pi / 2, 8 * EPS)


SECTIONS = {
    "out": {"type": "rise", "law": "3-4-5", "angle": 1.3, "lift": 0.02},
    "stay": {"type": "dwell", "angle": 1.1},
    "back": {"type": "return", "law": "3-4-5", "angle": 1.7},
    "rest": {"type": "dwell"},
}


def test_end_of_a_stroke_that_is_a_dwell__may_be_anywhere_in_it():
    slide = {"type": "slider", "guide": "way", "start": 0.1, "begin": 0.4, "sections": SECTIONS}
    machine = scene({}, {}, 0.05, {"way": {}}, inputs={"ram": slide}).model_dump(exclude_none=True)
    del machine["input"]["revolutions"]
    names = ["ram.stroke", "ram.stroke_high_at", "ram.stroke_low_at"]
    outcome = Machine(Scene.model_validate(machine), names).evaluate({})
    within_figures(outcome, "ram.stroke", 0.02, 4 * EPS)
    dwells = {"high": (0.4 + 1.3, 0.4 + 2.4), "low": (0.4 + 4.1, 0.4 + TURN)}
    for side, (begin, end) in dwells.items():
        at, figure = outcome.summaries[f"ram.stroke_{side}_at"][0], outcome.errors[f"ram.stroke_{side}_at"][0]
        # Laws begin so gently that a few degrees of them are flat to rounding: sixteen EPS are 10u³ at u = 7e-6.
        assert all(apart(at, place) <= figure + 1e-4 for place in (begin, end))
        assert figure < 2 * (end - begin)


def test_time_ratio_of_what_repeats_with_the_cycle_alone__is_not_told():
    """On a shaft that turns once in two turns of the crank there is a way out and a way back in two turns."""
    groups = {"g": SLIDER_CRANK, "h": rrp("E", ("bar", "D", 0.2), "valve", "way", 0.01)}
    points = {"C": frame(0.0, 0.02), "D": on("half", 0.03, 0.0)}
    shafts = {"half": {"geared_to": "crank", "ratio": -0.5, "pivot": "C"}}
    machine = Machine(scene(groups, points, 0.05, {"way": {}}, shafts=shafts))
    assert "ram.stroke_time_ratio" in machine.available_summaries
    assert "valve.stroke" in machine.available_summaries
    assert not {"valve.stroke_time_ratio", "bar.swing_time_ratio"} & set(machine.available_summaries)


# Ranges of the input that aren't a cycle


@pytest.mark.parametrize(("start", "stop"), [(0.2, 0.9), (0.2, 2.0), (-1.0, 4.0), (3.3, 3.4), (-0.5, 0.5)])
def test_limited_crank__has_the_stroke_of_its_range(start, stop):
    machine = scene({"g": SLIDER_CRANK | {"second": {"link": "ram", "guide": "way"}}}, {}, 0.05, {"way": {}})
    limited = machine.model_dump(exclude_none=True)
    limited["input"] |= {"start": start, "stop": stop}
    del limited["input"]["revolutions"]
    names = ["ram.stroke", "ram.stroke_low", "ram.stroke_high", "ram.stroke_low_at", "ram.stroke_high_at"]
    outcome = Machine(Scene.model_validate(limited), names).evaluate({})

    def place(q):
        return 0.05 * math.cos(q) + math.sqrt(0.04 - (0.05 * math.sin(q)) ** 2)

    # In line: dead centres are multiples of π.
    turns = [k * math.pi for k in range(-1, 3) if start < k * math.pi < stop]
    low, high = (better([start, stop, *turns], key=place) for better in (min, max))
    exact = (place(high) - place(low), place(low), place(high), low, high)
    for name, value in zip(names, exact, strict=True):
        within_figures(outcome, name, value, 8 * EPS)
    if start == -stop:
        # Both ends of the range are the low end.
        assert 2 * stop <= outcome.errors["ram.stroke_low_at"][0] < 2.01 * stop


@pytest.mark.parametrize(("inside", "turns"), [(False, 1), (True, 1), (False, 2), (True, 3)])
def test_swing_that_ends_where_the_cycle_does__has_its_ratio(inside, turns):
    """Rocker at its end where crank and rod are in line: the frame leans so that this is at the crank angle 0."""
    r, rod, rocker, base = 0.1, 0.25, 0.2, 0.3

    def aside(reach):
        """Angle between the frame and the line from the crank's pivot to the joint of rod and rocker."""
        return math.acos((reach**2 + base**2 - rocker**2) / (2 * reach * base))

    far, near = aside(rod + r), aside(rod - r) + math.pi
    beside = np.array([0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-8, -1e-8, 1e-5, -1e-5])
    lean = beside - (near if inside else far)
    dyad = rrr("B", ("rod", "A", rod), ("rocker", "D", rocker))
    points = {"O": frame(0.0, 0.0), "D": frame(base, 0.0)}
    names = ["rocker.swing_time_ratio", "rocker.swing_low_at", "rocker.swing_high_at"]
    given = scene({"g": dyad}, points, r)
    given = given.model_copy(update={"input": given.input.model_copy(update={"revolutions": turns})})
    machine = Machine(given, names, varied=["points.D.x", "points.D.y"])
    outcome = machine.evaluate({"points.D.x": base * np.cos(lean), "points.D.y": base * np.sin(lean)})
    assert (outcome.status == Verdict.OK).all()
    up = (near - far) % TURN
    slow = max(up, TURN - up)
    # The angle of the frame is rounded, and with it the place of the end.
    within_figures(outcome, "rocker.swing_time_ratio", slow / (TURN - slow), 64 * EPS)
    within_figures(outcome, f"rocker.swing_{'high' if inside else 'low'}_at", beside, 64 * EPS)
    for name in names:
        assert (outcome.errors[name] < 1e-7).all(), name


@pytest.mark.parametrize("turns", [1, 2])
def test_end_of_a_stroke_that_is_reached_twice_in_a_turn__is_the_first_and_may_be_the_other(turns):
    """A rocker stretches with the rod of a slide within its swing, twice in a turn: in exact numbers the ends tie."""
    rng = np.random.default_rng(7)
    length, toward = rng.uniform(0.05, 0.07, 64), rng.uniform(1.7, 1.9, 64)
    rod = rrp("C", ("link", "B", 0.3), "ram", "way")
    data = scene({"g": ROCKER, "h": rod}, {"D": frame(0.22, 0.0)}, 0.06, {"way": {"x": 0.22, "angle": 1.8}})
    data = data.model_copy(update={"input": data.input.model_copy(update={"revolutions": turns})})
    varied = {"input.length": length, "guides.way.angle": toward}
    asked = ["ram.stroke_high", "ram.stroke_high_at", "ram.stroke_low_at", "ram.stroke_time_ratio"]
    outcome = Machine(data, asked, varied=list(varied)).evaluate(varied)
    assert (outcome.status == Verdict.OK).all()
    x, y = 0.22 + 0.15 * np.cos(toward), 0.15 * np.sin(toward)
    far = np.hypot(x, y)
    beside = np.arccos((length**2 + far**2 - 0.2**2) / (2 * length * far))
    ends = np.sort((np.arctan2(y, x) + [[1], [-1]] * beside) % TURN, axis=0)
    within_figures(outcome, "ram.stroke_high", 0.45, 64 * EPS)
    at, off = outcome.summaries["ram.stroke_high_at"], outcome.errors["ram.stroke_high_at"]
    np.testing.assert_allclose(at, ends[0], rtol=0, atol=1e-6)
    np.testing.assert_array_less(apart(at, ends[1]), off + 1e-12)
    low = Measured(outcome.summaries["ram.stroke_low_at"])
    found, figure = outcome.summaries["ram.stroke_time_ratio"], outcome.errors["ram.stroke_time_ratio"]
    for end in ends:
        assert not (np.abs(quick_return_ratio(low, Measured(end)).value - found) > figure + 1e-9).any()
    assert (outcome.errors["ram.stroke_low_at"] < 1e-9).all()
