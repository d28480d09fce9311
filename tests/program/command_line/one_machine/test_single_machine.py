"""One machine at the command line: its fields at one place, plotted, exported, with numbers set anew."""

import csv
import json
import math
import re
import tomllib
from pathlib import Path

import numpy as np
import press_texts
import pytest
from commands import done, refused, said
from hypothesis import given, settings
from hypothesis import strategies as st
from motion_scenes import INERTIA, rotor

from engine import Machine, Scene
from sweeps import InputError, read_scene, readings_at, readings_in_time
from sweeps.text.scene_text import scene_from

# Tests of pictures look at what is drawn.
pytestmark = pytest.mark.usefixtures("blank_pictures")

CRANK, ROD = 0.05, 0.2
PRESS = scene_from(tomllib.loads(press_texts.PRESS), "", "press", Path())
# Of lengths of some decimetres in double precision.
ROUNDING = 1e-15


def slide(angle: float, crank: float = CRANK) -> float:
    """Height of the press's point B: guide along −y, x = r cos φ."""
    return crank * math.sin(angle) - math.sqrt(ROD**2 - (crank * math.cos(angle)) ** 2)


@pytest.fixture
def press(press_folder):
    return read_scene("press.toml")


@settings(max_examples=10)
@given(st.lists(st.integers(-720_00, 720_00), min_size=20, max_size=100))
def test_reading__at_hundredths_of_a_degree_is_exact(hundredths):
    angles = [math.radians(each / 100) for each in hundredths]
    found = readings_at(PRESS, angles, ["B.y"]).values["B.y"]
    assert found == pytest.approx([slide(angle) for angle in angles], abs=4 * ROUNDING)


# Of a curve f, h²/8 f″ with h = 2π/36000; |y″| of B is at most r(1 + r/l)/(1 − r²/l²)^1.5 < 0.07 m.
BY_LINES = (2 * math.pi / 36_000) ** 2 / 8 * 0.07


@settings(max_examples=10)
@given(st.lists(st.floats(-20, 20), min_size=20, max_size=100))
def test_reading__elsewhere_is_as_near_as_straight_lines_are(angles):
    found = readings_at(PRESS, angles, ["B.y"]).values["B.y"]
    assert found == pytest.approx([slide(angle) for angle in angles], abs=BY_LINES)


def test_reading__of_angles_follows_the_link_from_the_begin_of_the_cycle():
    found = readings_at(PRESS, np.radians([350, 359.999]), ["crank.angle"]).values["crank.angle"]
    assert np.degrees(found) == pytest.approx([350, 359.999], abs=1e-12)


def test_show_at__tells_the_main_fields_or_all_without_rounding(press):
    every, few = (said("show", "press.toml", "--at", "90 deg", *also).stdout for also in (["--all"], []))
    assert {line.split()[0] for line in every.splitlines()[1:]} == set(Machine(press).available_fields)
    *lines, more = few.splitlines()[1:]
    names = {line.split()[0] for line in lines}
    assert names >= {"B.x", "rod.angle", "ram.velocity", "input.reaction", "frame.reaction_x", "input_moment"}
    assert not names & {"B.x_phi", "B.vx", "input.reaction_x", "shaking_force_x", "ram.inertia_force_x"}
    assert more == f"{len(every.splitlines()) - 1 - len(lines)} more with --all."
    # The crank's x is 3e-18 m there.
    assert "e-" not in every


def test_show_at__takes_evenly_spaced_angles(press_folder):
    answers = [done("show", "press.toml", "--at", at, "--columns", "B.y") for at in ("0 to 90, 4", "0, 30, 60, 90")]
    assert answers[0] == answers[1]
    assert "from 2 to 100000 positions" in refused("show", "press.toml", "--at", "0 to 90, 0")


def test_show_at__in_json_has_several_angles_and_numbers_set_anew(press_folder):
    answer = said("show", "press.toml", "--at", "0, 1 rad", "--columns", "B.y", "--json", "--set", "input.length=60 mm")
    told = json.loads(answer.stdout)
    assert told["phi"]["values"] == [0, 1]
    assert told["B.y"]["unit"] == "m"
    assert told["B.y"]["values"] == pytest.approx([slide(0, 0.06), slide(1, 0.06)], abs=1.5 * BY_LINES)


def test_show_at__of_a_machine_that_assembles_in_part_says_where(press_folder):
    lines = said("show", "press.toml", "--at", "0, 90 deg", "--set", "input.length=0.5 m").stdout.splitlines()
    # |cos φ| ≤ l/r, found in steps of 0.05°.
    ends = [float(end) for end in re.findall(r"[\d.]+(?= °)", lines[0])]
    reach = math.degrees(math.acos(ROD / 0.5))
    assert ends == pytest.approx([reach, 180 - reach, 180 + reach, 360 - reach], abs=0.05)
    names = {line.split()[0]: line for line in lines[2:-2]}
    assert " – " in names["B.y"]
    assert "work" not in names
    assert re.fullmatch(r"\d+ more are undefined here\.", lines[-1])


def test_reading__outside_the_range_of_the_input_is_refused():
    scene = Scene.model_validate(PRESS.model_dump() | {"input": PRESS.input.model_dump() | {"start": 0, "stop": 1}})
    with pytest.raises(InputError, match="outside the input range"):
        readings_at(scene, [1.5])
    assert readings_at(scene, [0.25], ["B.y"]).values["B.y"][0] == pytest.approx(slide(0.25), abs=4 * ROUNDING)


def test_reading_in_time__of_a_rotor_under_a_constant_moment():
    """φ = M t²/2J, ω = M t/J, which cubics follow exactly."""
    half = {"type": "run", "only": "push", "time": 0.5}
    scene = Scene.model_validate(rotor({"go": half, "on": half}))
    found = readings_in_time(scene, [0.0, 0.123, 0.5, 1.0])
    rate, t = 3.0 / INERTIA, np.array([0.0, 0.123, 0.5, 1.0])
    # Steps of the run keep to 1e-9 or better.
    assert found.values["angle"] == pytest.approx(rate * t**2 / 2, rel=1e-8, abs=1e-12)
    assert found.values["speed"] == pytest.approx(rate * t, rel=1e-8, abs=1e-12)
    assert found.regimes == ["go", "go", "on", "on"]
    with pytest.raises(InputError, match="last from 0 to 1 s"):
        readings_in_time(scene, [1.1])


# Numbers and settings of studies


def test_run_with_numbers_set_anew__has_their_results(press_folder):
    answer = said("run", "press.toml", "--no-plots", "--json", "--set", "input.length='60 mm'", "--accuracy", "1 %")
    told = json.loads(answer.stdout)
    assert told["status"] == {"ok": 1}
    assert told["listed"][0]["values"]["ram.stroke"] == pytest.approx(0.12, rel=1e-12)
    assert told["listed"][0]["values"]["accuracy_reached"] == 1
    assert told["files"] == ["results/press_input_length_60_mm.h5"]


def test_show_json__has_the_best_and_what_is_listed(press_result):
    told = json.loads(said("show", press_result, "--json", "--limit", "2").stdout)
    assert told["variants"] == 8
    assert told["status"] == {"ok": 6, "cannot_assemble": 2}
    assert len(told["listed"]) == 2
    assert told["listed"][0]["variant"] == told["best"]
    assert told["units"]["input.length"] == "m"
    assert done("show", press_result, "--at", "30").startswith(f"variant {told['best']} of {press_result}:\n")


# Pictures and tables


def test_plot__draws_any_field_over_the_cycle_or_over_another(press_folder):
    done("plot", "press.toml", "-y", "B.vy,rod.angle", "--out", "over.svg")
    assert said("plot", "press.toml", "-x", "A.x", "-y", "A.y").stdout == "Wrote press_A_y.png\n"
    assert Path("over.svg").stat().st_size > 0
    assert "did you mean 'B.vy'" in refused("plot", "press.toml", "-y", "B.vz")
    assert "-y B.vx" in refused("plot", "press.toml", "-x", "B.vy")


def test_table_of_positions__holds_every_field(press):
    done("export", "press.toml", "--to", "p.csv", "--positions", "8")
    header, *rows = csv.reader(Path("p.csv").read_text().splitlines())
    assert {name.partition(" ")[0] for name in header} == {"phi", *Machine(press).available_fields}
    height = [1e-3 * float(row[header.index("B.y [mm]")]) for row in rows]
    assert height == pytest.approx([slide(k * math.pi / 4) for k in range(8)], abs=4 * ROUNDING)
