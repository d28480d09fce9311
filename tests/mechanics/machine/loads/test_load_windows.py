"""Loads that act over a window of the cycle, however narrow and wherever it lies: closed forms of piecewise moments.

A moment that is constant within windows of the crank angle has a mean, a root mean square and a work W(φ) about the
mean that are sums over the windows; W is a broken line with corners at the windows' ends, so its extremes lie there. A
force over a window of the stroke does the work force × width, however the crank gets through it.
"""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from machines import frame, on, slider_crank

from engine import Machine, Scene, Verdict

TURN = 2 * math.pi
SPEED, FLUCTUATION = 10.0, 0.02
R, ROD = 0.05, 0.2

# A crank with a disc; everything else is a window's.
CRANK = slider_crank(
    R,
    ROD,
    SPEED,
    bodies={"disc": {"link": "crank", "mass": 1.0, "inertia": 0.5}},
    flywheel={"speed_fluctuation": FLUCTUATION},
)


def rows_of(windows: list[tuple[float, float, float]]) -> tuple[list[float], list[float]]:
    """A table over the crank angle of moments constant within windows that don't overlap, zero elsewhere."""
    cuts = [0.0, *(at for window in windows for at in window[:2]), TURN]
    levels = [0.0, *(level for *_, moment in windows for level in (moment, 0.0))]
    pieces = [(ends, level) for ends, level in zip(pairwise(cuts), levels, strict=True) if ends[0] < ends[1]]
    angles, moments = [at for ends, _ in pieces for at in ends], [level for _, level in pieces for _ in range(2)]
    # A jump where the cycle closes needs the first row's value last.
    if moments[-1] != moments[0]:
        angles.append(TURN)
        moments.append(moments[0])
    # As many rows for up to three windows, so that all machines share their functions.
    widest, more = int(np.argmax(np.diff(angles))), 15 - len(angles)
    angles[widest + 1 : widest + 1] = np.linspace(*angles[widest : widest + 2], more + 2)[1:-1].tolist()
    moments[widest + 1 : widest + 1] = moments[widest : widest + 1] * more
    return angles, moments


def exactly(windows: list[tuple[float, float, float]]) -> dict[str, float]:
    """Summaries of windows that don't overlap, by hand."""
    mean = sum(m * (b - a) for a, b, m in windows) / TURN
    square = sum(m * m * (b - a) for a, b, m in windows) / TURN
    work, at, corners = 0.0, 0.0, [0.0]
    for a, b, m in windows:
        work -= mean * (a - at)
        corners.append(work)
        work += (m - mean) * (b - a)
        corners.append(work)
        at = b
    excess = max(corners) - min(corners)
    wheel = excess / (FLUCTUATION * SPEED**2)
    levels = [m for _, _, m in windows] + ([0.0] if sum(b - a for a, b, _ in windows) < TURN else [])
    return {
        "required_drive_moment": -mean,
        "required_power": -mean * SPEED,
        "excess_work": excess,
        "flywheel_excess_work": wheel,
        # All inertia is constant: the three methods agree but for the disc, which excess work leaves out.
        "flywheel_merzalov": wheel - 0.5,
        "flywheel_wittenbauer": wheel - 0.5,
        "speed_fluctuation": FLUCTUATION if wheel > 0.5 else excess / (0.5 * SPEED**2),
        "reduced_moment.min": min(levels),
        "reduced_moment.max": max(levels),
        "reduced_moment.mean": mean,
        "reduced_moment.rms": math.sqrt(square),
    }


SUMMARIES = list(exactly([]))


def machine_with(windows: list[tuple[float, float, float]]) -> Machine:
    """The crank under windows that don't overlap."""
    angles, moments = rows_of(windows)
    load = {"type": "table", "on": "crank", "interpolation": "linear", "over_angle": angles, "moment": moments}
    return Machine(Scene.model_validate({**CRANK, "moments": {"window": load}}), SUMMARIES)


def assert_within_figures(outcome: object, expected: dict[str, float]) -> None:
    assert outcome.status[0] == Verdict.OK
    for name, value in expected.items():
        found, figure = outcome.summaries[name][0], outcome.errors[name][0]
        # Ends of windows are floats themselves: what their rounding does to a corner isn't the machine's error.
        room = 1e-13 * (1.0 + abs(value)) * 64
        assert abs(found - value) <= figure + room, (name, found, value, figure)
        assert figure <= 1e-6 * max(abs(value), 1.0), (name, found, figure)


@st.composite
def some_windows(draw: st.DrawFn) -> list[tuple[float, float, float]]:
    """One to three windows anywhere, at least 1e-4 rad wide, that don't overlap; the ends of the cycle included."""
    places = draw(st.lists(st.floats(0.0, TURN), min_size=2, max_size=6))
    places = sorted({round(p, 6) for p in places} | ({0.0} if draw(st.booleans()) else set()))
    # None but the very end so close to it that what is left would be narrower than a window.
    inside = [p for p in places if p < TURN - 1e-3]
    places = [*inside, TURN] if len(inside) < len(places) or draw(st.booleans()) else inside
    found, at = [], 0
    while at + 1 < len(places):
        begin = places[at]
        width = draw(st.sampled_from([1e-4, 1e-3, 1e-2, 10.0]))
        end = min(begin + width, places[at + 1])
        if end - begin >= 1e-4:
            found.append((begin, end, draw(st.sampled_from([-30.0, -1.0, 2.0, 50.0]))))
        at += 2
    return found


@settings(max_examples=10)
@given(some_windows())
@example([(1.0, 1.0001, -30.0)])
@example([(0.0, 1e-4, -30.0)])
@example([(TURN - 1e-4, TURN, 50.0)])
@example([(0.0, 0.3, -30.0), (TURN - 0.3, TURN, -30.0)])
def test_windows_of_the_crank_angle__are_never_missed(windows):
    if not windows:
        return
    outcome = machine_with(windows).evaluate({})
    assert_within_figures(outcome, exactly(windows))


FORCE, FROM, TO = 1000.0, 0.01, 0.03
HEAVY = 200.0


def behind_a_fast_shaft() -> Scene:
    """A ram whose crank is on a shaft geared to the input, and what cuts in each of its strokes."""
    cut = {"type": "table", "on": "B", "angle": 0.2, "slider": "ram", "measured_from": "high end", "acts": "against"}
    cut |= {"over_stroke": [FROM, TO], "force": [FORCE, FORCE], "interpolation": "linear", "outside": "zero"}
    drive = slider_crank(
        R,
        ROD,
        SPEED,
        points={"O": frame(0.0, 0.0), "Q": frame(0.3, 0.0), "P": on("fast", R, 0.0)},
        guides={"way": {"x": 0.3, "angle": 0.2}},
        shafts={"fast": {"geared_to": "crank", "ratio": 1.0, "pivot": "Q", "phase": 0.3}},
        bodies={"disc": {"link": "crank", "mass": 1.0, "inertia": HEAVY}},
        forces={"cut": cut},
        regimes={"run": {"type": "run", "from_speed": SPEED, "from_angle": 0.0, "cycles": 1}},
    )
    drive["groups"]["g"]["first"]["joint"] = "P"
    return Scene.model_validate(drive)


def test_windows_behind_a_shaft_of_any_ratio__each_stroke_does_its_work():
    """Of shafts with up to 120 windows in a cycle and in a run."""
    scene, rng = behind_a_fast_shaft(), np.random.default_rng(3)
    # In 35 and 59 intervals of a turn, as in any other whole number, such shafts are where they were.
    ratios = np.concatenate([[1.0, 35.0, 59.0, 70.0, 118.0, 120.0], np.arange(2, 119, 4), -rng.integers(1, 121, 28)])
    varied = {"shafts.fast.ratio": ratios, "shafts.fast.phase": rng.permutation(np.r_[np.zeros(21), rng.random(43)])}
    asked = ["ram.stroke", "required_drive_moment", "run.final_speed"]
    machine = Machine(scene, asked, varied=list(varied))
    found = machine.evaluate(varied)
    assert (found.status == Verdict.OK).all()
    work = FORCE * (TO - FROM) * np.abs(ratios)
    exact = {"ram.stroke": 2.0 * R, "required_drive_moment": work / TURN}
    exact["run.final_speed"] = np.sqrt(SPEED**2 - 2.0 * work / HEAVY)
    for name, value in exact.items():
        # Of the reference a few roundings. Runs take moments 1e-10 rad of the crank beside each break.
        room = (1e-10 if name == "run.final_speed" else 1e-15) * np.abs(value)
        assert (np.abs(found.summaries[name] - value) <= found.errors[name] + room).all(), name
        assert (found.errors[name] <= 1e-9 * np.abs(value)).all(), name
    for i in (0, 1, 3, 5):
        alone = machine.evaluate({path: values[i : i + 1] for path, values in varied.items()})
        for name in asked:
            assert alone.summaries[name][0] == found.summaries[name][i]
            assert alone.errors[name][0] == found.errors[name][i]


@pytest.mark.parametrize("speed", [10.0, -10.0])
def test_no_load_at_all__gives_exact_zeros(speed):
    scene = {**CRANK, "input": {**CRANK["input"], "speed": speed}}
    outcome = Machine(Scene.model_validate(scene), SUMMARIES).evaluate({})
    for name in ("required_drive_moment", "required_power", "excess_work", "reduced_moment.rms"):
        assert outcome.summaries[name][0] == 0.0
        # Of squares below the least number that is kept in full nothing is known but that.
        assert outcome.errors[name][0] <= 1.5e-154
    assert np.isfinite(outcome.summaries["flywheel_wittenbauer"][0])
