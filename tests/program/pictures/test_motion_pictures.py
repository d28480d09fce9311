"""Pictures and tables of true motion: what they show is what the engine computes, and energy is conserved in them."""

import csv
import math
from functools import cache

import numpy as np
import pytest
from drawn_machines import slider_crank

from engine import Machine, Verdict, history, quantity_text, show_units
from sweeps.pictures.machine.motion_diagrams import MOST_INSTANTS, _thinned, courses, cycle_diagrams, history_diagrams
from sweeps.pictures.picture_files import machine_pictures
from sweeps.report.files.data_files import write_table
from sweeps.report.files.exports import history_table
from sweeps.report.regime_words import failure_text

RPM = 30 / math.pi
MOMENTS = {
    "motor": {"type": "dc_motor", "on": "crank", "stall_moment": 20.0, "no_load_speed": 12.0},
    "oil": {"type": "linear_drag", "on": "crank", "coefficient": 0.3},
    "brake": {"type": "block_brake", "on": "crank", "force": 200.0, "friction": 0.3, "radius": 0.1, "blocks": 2},
}
PUSH = {"push": {"type": "constant", "on": "B", "angle": math.pi, "force": 100.0, "acts": "against", "role": "useful"}}
REGIMES = {
    "start": {"type": "run", "off": ["push", "brake"], "speed": 8.0},
    "work": {"type": "steady", "off": ["brake"]},
    "stop": {"type": "run", "off": ["motor", "push"], "rest": True},
}


def machine(**changes):
    parts = {"moments": MOMENTS, "forces": PUSH, "regimes": REGIMES, "flywheel": {"inertia": 0.5}}
    return slider_crank(title="Small press", **parts | changes)


SCENE = machine()


@cache
def seen():
    return history(SCENE, fields=["input.reaction"])


@cache
def sheet():
    return history_diagrams(SCENE, seen()).axes


TIMES = ("start.time", "work.period", "stop.time")
STEADY = ("work.mean_speed", "work.speed_fluctuation")


@cache
def summaries():
    """Values and error estimates of all that is looked at, by one machine."""
    outcome = Machine(SCENE, [*TIMES, *STEADY]).evaluate({})
    return {name: (float(value[0]), float(outcome.errors[name][0])) for name, value in outcome.summaries.items()}


def lines_of(axes):
    return {line.get_label(): line.get_xydata().T for line in axes.lines}


def test_history_sheet__has_a_column_for_each_regime_as_long_as_it_lasts():
    assert len(sheet()) == 15
    assert [ax.get_title() for ax in sheet()[:3]] == ["start", "work (one cycle)", "stop"]
    for ax, name in zip(sheet()[:3], TIMES, strict=True):
        value, error = summaries()[name]
        # The picture goes by 360 positions, the summary by 720: of order four, its error is 16 times as large.
        assert ax.lines[0].get_xdata()[[0, -1]] == pytest.approx([0, value], abs=32 * error + 1e-9)
        assert ax.get_xlim() == pytest.approx((0, value), rel=1e-6)


def test_history_sheet__goes_from_rest_to_the_asked_speed_and_back():
    ends = [ax.lines[0].get_ydata()[[0, -1]] for ax in sheet()[:3]]
    assert ends[0] == pytest.approx([0, 8 * RPM], abs=1e-9)
    assert ends[1][0] == pytest.approx(ends[1][1], rel=1e-9)
    assert ends[2] == pytest.approx([ends[1][1], 0], abs=1e-9)


def test_history_sheet__works_add_up_to_the_change_of_energy():
    for ax in sheet()[9:12]:
        lines = lines_of(ax)
        energy = lines.pop("kinetic energy E")[1]
        total = sum(row[1] - row[1][0] for row in lines.values())
        # Trapezoids over 360 steps a cycle: h²/12·M″ with h = 0.017 and moments that change by their own size within
        # about a radian leave 3e-5 of the works; where the push sets in, M jumps within a step's thousandth.
        assert total == pytest.approx(energy - energy[0], abs=1e-3 * np.ptp(energy) + 1e-3)


def test_history_sheet__shows_only_what_acts():
    assert [set(lines_of(ax)) for ax in sheet()[3:6]] == [
        {"motors", "harmful resistances"},
        {"motors", "useful resistances", "harmful resistances"},
        {"harmful resistances", "brakes"},
    ]
    brake = lines_of(sheet()[5])["brakes"][1]
    assert brake == pytest.approx(-2 * 200.0 * 0.3 * 0.1, rel=1e-12)
    power, speed = lines_of(sheet()[8])["brakes"][1], sheet()[2].lines[0].get_ydata() / RPM
    assert power == pytest.approx(brake * speed, rel=1e-12)


def test_history_sheet__draws_the_reactions_that_the_history_keeps():
    axes = sheet()
    assert axes[12].get_title(loc="left") == "input: joint O"
    for ax, name in zip(axes[12:], REGIMES, strict=True):
        (line,) = ax.lines
        drawn = line.get_ydata()
        assert drawn == pytest.approx(seen().loads_on_pairs["input.reaction"][seen().regime == name], rel=1e-12)


def test_cycle_sheet__marks_mean_speed_and_fluctuation():
    axes = cycle_diagrams(SCENE, next(part for part in courses(seen()) if part.name == "work")).axes
    mean, delta = (summaries()[name][0] for name in STEADY)
    assert axes[0].get_title() == f"δ = {delta:.5g}, mean speed {quantity_text(mean, 'rad s-1')}"
    speed, middle, low, high = (line.get_ydata() for line in axes[0].lines)
    assert middle[0] == pytest.approx(mean * RPM, rel=1e-9)
    assert 2 * (high[0] - low[0]) / (high[0] + low[0]) == pytest.approx(delta, rel=1e-9)
    # Extremes lie between nodes: h²/8·ω″ with h = 0.017 rad is 4e-5 of the range.
    assert [speed.min(), speed.max()] == pytest.approx([low[0], high[0]], abs=1e-3 * np.ptp(speed))
    assert axes[0].lines[0].get_xdata()[[0, -1]] == pytest.approx([0, 360])
    # The brake is off.
    assert {"motors", "brakes"} & {*lines_of(axes[3])} == {"motors"}


def test_machine_that_does_not_start__is_a_page_that_says_why():
    scene = machine(moments=MOMENTS | {"rub": {"type": "against_motion", "on": "crank", "moment": 30.0}})
    seen = history(scene)
    assert seen.verdict == Verdict.STALLS
    figure = history_diagrams(scene, seen)
    assert figure.axes == []
    text = " ".join(figure.get_suptitle().split())
    assert "regime start: the machine does not start at φ = 0 °: 20 N·m drives it there, 30 N·m holds it" in text
    assert "a stronger motor" in text
    told = failure_text(SCENE, Verdict.STALLS)
    assert told.startswith("the machine stalls")
    assert told.endswith("(with 240 positions and the scene's flywheel it runs)")


def test_machine_that_runs_away__shows_its_start_and_says_where_it_fails(tmp_path):
    motor = {"type": "constant", "on": "crank", "moment": 20.0, "role": "driving"}
    scene = machine(moments={"motor": motor, "brake": MOMENTS["brake"]})
    made = machine_pictures(scene, tmp_path / "a.png")
    assert [path.name for path in made] == ["a.png", "a_diagrams.png", "a_history.png"]
    figure = history_diagrams(scene, history(scene))
    assert [ax.get_title() for ax in figure.axes[:1]] == ["start"]
    told = " ".join(figure.get_suptitle().split())
    assert "regime work: the machine runs away" in told
    assert "the loads balance the drive at no speed" in told
    assert "add a load" in told


def test_long_row__keeps_its_extremes_when_thinned():
    rng = np.random.default_rng(1)
    row, x = rng.normal(size=7 * MOST_INSTANTS + 3), np.arange(7.0 * MOST_INSTANTS + 3)
    row[12_345], row[54_321] = 50.0, -60.0
    thin_x, thin = _thinned(x, row)
    assert thin.size <= 2 * MOST_INSTANTS
    assert (thin.max(), thin.min()) == (50.0, -60.0)
    assert abs(thin_x[thin.argmax()] - 12_345) <= 8
    short = np.arange(10.0)
    assert _thinned(short, short)[1] is short


# As a table


def test_table_of_the_history__holds_the_equation_of_motion(tmp_path):
    table, ended = history_table(SCENE)
    assert ended == ""
    show_units({"system": "SI"})
    write_table(tmp_path / "h.csv", table)
    show_units({})
    header, *rows = csv.reader((tmp_path / "h.csv").read_text(encoding="utf8").splitlines())
    first = "regime,time [s],angle [deg],speed [rad s-1],acceleration [rad s-2],motor_moment [N m],driving_moment [N m]"
    assert ",".join(header).startswith(first)
    assert header[-1] == "energy [J]"
    assert list(dict.fromkeys(row[0] for row in rows)) == ["start", "work", "stop"]
    number = {name: np.array([float(row[i]) for row in rows]) for i, name in enumerate(header) if i}
    moment = sum(values for name, values in number.items() if name.endswith("_moment [N m]"))
    chosen = np.array([row[0] == "work" for row in rows])
    omega, epsilon, phi = (number[n][chosen] for n in header[3:5] + header[2:3])
    phi = np.radians(phi)
    # I and dI/dφ from the fields of the machine at uniform speed, at angles that the history shares with them.
    fields = ["reduced_inertia", "reduced_inertia_phi"]
    rows_of = Machine(SCENE, fields=fields, positions=360).evaluate({}).fields
    node = phi * 180 / math.pi
    shared = np.flatnonzero(np.abs(node - np.round(node)) < 1e-9)
    assert shared.size > 300
    at = np.round(node[shared]).astype(int) % 360
    inertia, slope = (rows_of[name][0][at] for name in fields)
    left = (inertia + 0.5) * epsilon[shared] + 0.5 * slope * omega[shared] ** 2
    # Both sides are sums of a few terms of at most 20 N·m in rounding.
    assert left == pytest.approx(moment[chosen][shared], abs=1e-10)
