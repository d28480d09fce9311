"""`sweeps flywheel` and `sweeps balance`: counterweights, balance shafts, corrections of rotors by trial runs."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from commands import refused, said
from each_case import each
from hypothesis import given, settings
from hypothesis import strategies as st

from engine import Machine
from sweeps.report.sizing.trial_runs import correction_of, read_runs
from sweeps.text.scene_text import read_scene
from sweeps.text.templates import bundled_templates

HEAD = "plane, weight [g], weight_angle [deg], left [mm/s], left_phase [deg], right [mm/s], right_phase [deg]\n"
# S. S. Rao, Mechanical Vibrations, example 9.2, in mm/s for mils and g for ounces.
RAO = HEAD + "1, 0, 0, 8.5, 60, 6.5, 205\n1, 10, 270, 6.0, 125, 4.5, 230\n2, 12, 180, 6.0, 35, 10.5, 160\n"
TRIPLE = """
[elements.triple]
type = "engine"
layout = "in-line"
cylinders = 3
spacing = "90 mm"
stroke = "80 mm"
rod = "140 mm"
piston_mass = "400 g"
rod_mass = "500 g"
rod_centre = "40 mm"
speed = "3000 rpm"
"""
# Khurmi, 16.16: 1 mm² is 250 N·m times 3°; printed 32.7 kg·m².
AREAS = "area [mm2]\n160\n-172\n168\n-191\n197\n-162\n"
MOMENTS = "phi [deg], moment [N m]\n0, 100\n180, 100\n180, -100\n360, -100\n360, 100\n"
AMPLITUDES = "plane, weight [g], weight_angle [deg], frame [um]\n"


@pytest.fixture(autouse=True)
def folder(folder):
    for name in ("slider_crank", "rotor"):
        Path(f"{name}.toml").write_text(bundled_templates()[name].read_text(encoding="utf8"), encoding="utf8")
    texts = {"runs.csv": RAO, "triple.toml": TRIPLE, "areas.csv": AREAS, "moments.csv": MOMENTS}
    for name, text in texts.items():
        Path(name).write_text(text)
    return folder


# Counterweights


def test_counterweight__written_to_a_scene_does_what_is_said(folder):
    answer = said("balance", "slider_crank.toml", "--most", "300 g", "--radius", "50 mm", "--out", "b.toml").stdout
    assert re.search(r"crank\s+15 kg·mm\s+180\.0°\s+300 g\s+50 mm", answer)
    before, after = (
        float(Machine(read_scene(name), ["shaking_force.rms"]).evaluate({}).summaries["shaking_force.rms"][0])
        for name in ("slider_crank.toml", "b.toml")
    )
    left = re.search(r"Residual shaking force ([\d.]+) N; proven minimum .*: ([\d.]+) N", answer)
    assert after < before
    assert float(left[1]) == pytest.approx(after, rel=1e-4)
    # The mass is at its limit, which leaves no choice: the bound is what is left.
    assert left[1] == left[2]


@each(
    "line, words",
    [
        ("slider_crank.toml --criterion full", "don't balance this machine fully"),
        ("slider_crank.toml --links cramk", "did you mean 'crank'"),
        ("slider_crank.toml --place rod", "--place: 'rod': write a link and a place on it"),
        ("rotor.toml", "there are no links to balance"),
        ("", "give either a scene, study or result to balance, or --trial-runs"),
        ("slider_crank.toml --trial-runs runs.csv", "give either"),
        ("triple.toml --planes 3,4", "--planes: 3 has no unit"),
        ("triple.toml --planes 30mm", "--planes: '30mm': 2 numbers are needed"),
        ("--trial-runs runs.csv --noise 3kg", "in the unit of the readings"),
        ("--trial-runs runs.csv --noise 0.1foo", "foo"),
        ("--trial-runs runs.csv --noise=-1mm/s", "-1"),
    ],
)
def test_what_cannot_be_balanced__is_refused(folder, line, words):
    assert words in refused("balance", *line.split())


# Balance shafts


def test_engine__gets_the_shafts_that_leave_neither_force_nor_couple(folder):
    answer = said("balance", "triple.toml", "--planes", "-120 mm, 120 mm").stdout
    # The primary couple √3 m r ω² a of an in-line three with balanced rotating masses.
    mass = 0.4 + 0.5 * 40 / 140
    couple = re.search(r"couple\s+([\d.]+) N·m", answer)
    assert float(couple[1]) == pytest.approx(math.sqrt(3) * mass * 0.04 * (100 * math.pi) ** 2 * 0.09, rel=1e-4)
    # Half of it turns against the crank: on a shaft 240 mm long m r √3/2 a/240 mm in each plane.
    shaft = re.search(r"primary\s+1 × crank\s+against it\s+([\d.]+) kg·mm at 150.0°\s+\1 kg·mm at 330.0°", answer)
    assert float(shaft[1]) == pytest.approx(mass * 40 * math.sqrt(3) / 2 * 90 / 240, rel=1e-4)
    assert answer.count("2 × crank") == 2


def test_angles_of_shafts__refer_to_the_given_position_of_the_first_throw(folder):
    Path("one.toml").write_text(TRIPLE.replace("cylinders = 3", 'cylinders = 1\nthrows = ["30 deg"]'))
    answer = said("balance", "one.toml").stdout
    # Half the reciprocating mass turns with the crank: its counterweight is opposite the throw.
    assert re.search(r"the crank itself .* kg·mm at 210.0°", answer)
    assert answer.rstrip().endswith("with the throw of cylinder 1 at 30.0°.")


def test_engine_that_is_balanced__needs_no_shafts(folder):
    Path("six.toml").write_text(TRIPLE.replace("cylinders = 3", "cylinders = 6"))
    assert "No balance shafts needed" in said("balance", "six.toml").stdout


# Trial runs


@each("order", [1, -1])
def test_trial_runs__give_the_weights_of_a_textbook_in_whatever_order(folder, order):
    head, *runs = RAO.splitlines()
    Path("runs.csv").write_text("\n".join([head, *runs[::order]]))
    answer = said("balance", "--trial-runs", "runs.csv").stdout
    # The book: 10.0561 at 325.5548 degrees and 5.8774 at 68.2559 degrees.
    assert re.search(r"^1\s+10\.06 g\s+325\.6°$", answer, re.M)
    assert re.search(r"^2\s+5\.877 g\s+68\.3°$", answer, re.M)
    assert "noise" not in answer


def test_noise__leaves_in_proportion_to_it(folder):
    runs = read_runs(Path("runs.csv"))
    small, large = (correction_of(Path("runs.csv"), runs, noise).radii for noise in ("0.1 mm/s", "3 cm/s"))
    np.testing.assert_allclose(large, 300 * small, rtol=1e-12)
    answer = said("balance", "--trial-runs", "runs.csv", "--noise", "0.1 mm/s").stdout
    assert re.search(r"^1\s+10\.06 g\s+325\.6°\s+0\.51 g$", answer, re.M)


def test_holes__take_the_weights_of_trial_runs(folder):
    answer = said("balance", "--trial-runs", "runs.csv", "--holes", "12").stdout
    # Two weights 30 degrees apart at the angles of their holes.
    for weight, angle in ((10.0561, 325.5548), (5.8774, 68.2559)):
        found = re.search(rf"{weight:.4g} g .* ([\d.]+) g in (\d+), ([\d.]+) g in (\d+)", answer)
        first, hole, second, beside = (float(part) for part in found.groups())
        parts = first * np.exp(1j * np.radians(30 * (hole - 1))) + second * np.exp(1j * np.radians(30 * (beside - 1)))
        assert abs(parts - weight * np.exp(1j * np.radians(angle))) < 1e-3 * weight
    assert "at least 3 equally spaced holes" in refused("balance", "--trial-runs", "runs.csv", "--holes", "2")


@settings(max_examples=30)
@given(st.integers(0, 2**32 - 1), st.permutations(range(4)))
def test_amplitudes_of_four_runs__give_one_plane(tmp_path_factory, seed, order):
    rng = np.random.default_rng(seed)
    unbalance, first = rng.uniform(0.5, 2) * np.exp(1j * rng.uniform(0, 7)), rng.uniform(0, 360)
    size = rng.uniform(0.5, 2)
    rows = [(0.0, 0.0), *((size, first + 120 * k) for k in range(3))]
    amplitudes = [3.0 * abs(unbalance + w * np.exp(1j * np.radians(a))) for w, a in rows]
    lines = [f"2, {float(w)!r}, {float(a)!r}, {float(v)!r}" for (w, a), v in zip(rows, amplitudes, strict=True)]
    path = tmp_path_factory.mktemp("runs") / "runs.csv"
    path.write_text(AMPLITUDES + "\n".join(lines[k] for k in order))
    found = correction_of(path, read_runs(path))
    assert found.planes == (2,)
    # Squares of up to (2 + 2)², each with some roundings, over the least rise of 0.5², times 2/0.5: below 1e-12.
    assert abs(found.weights[0] + unbalance) < 1e-12
    assert found.coefficients[0, 0].real == pytest.approx(3.0, rel=1e-12)


@each(
    "table, words",
    [
        (RAO.replace("plane,", "level,"), ("line 1", "no column 'plane'", "the header is such as")),
        (RAO.replace("left_phase", "phase_left"), ("line 1", "every sensor needs an amplitude")),
        (RAO.replace("right [mm/s]", "right [um]"), ("line 1", "must use one unit", "mm/s, um")),
        (RAO.replace("weight_angle [deg]", "weight_angle [mm]"), ("weight_angle", "expected an angle")),
        (RAO.replace("1, 0, 0", "1, 1, 0"), ("exactly one run must have no trial weight", "there are 0")),
        (RAO.replace("2, 12", "1, 12"), ("each plane needs exactly one trial run",)),
        (RAO.replace("2, 12", "1.5, 12"), ("planes must be whole numbers",)),
        (RAO.replace("2, 12, 180, 6.0, 35, 10.5, 160", "2, 12, 180, 8.5, 60, 6.5, 205"), ("separate the planes",)),
        (RAO + "3, 9, 0, 1, 0, 1, 0\n", ("3 planes need at least 3 sensors",)),
        (RAO.replace("8.5", "high"), ("line 2", "high' is not a number")),
        (AMPLITUDES + "1, 0, 0, 5\n1, 1, 0, 4\n1, 1, 120, 6\n", ("without phases: one plane, one sensor",)),
        (AMPLITUDES + "1, 0, 0, 5\n1, 1, 0, 4\n1, 1, 120, 6\n1, 1, 200, 6\n", ("120 deg apart",)),
        (AMPLITUDES + "1, 0, 0, 9\n1, 1, 0, 1\n1, 1, 120, 1\n1, 1, 240, 1\n", ("no linear machine",)),
    ],
)
def test_runs_that_tell_nothing__are_refused(folder, table, words):
    Path("runs.csv").write_text(table)
    answer = refused("balance", "--trial-runs", "runs.csv")
    assert all(word in answer for word in words), answer


# Flywheels: from a table of moments, and from the areas of a diagram


def inertia_in(answer: str) -> float:
    return float(re.search(r"flywheel inertia\s+([\d.]+) kg·m²", answer)[1])


ASKED = ("--speed", "600 rpm", "--fluctuation", "2 %")


def test_areas__give_the_printed_flywheel():
    answer = said("flywheel", "areas.csv", *ASKED, "--area-energy", f"{250 * math.radians(3)!r} J").stdout
    assert inertia_in(answer) == pytest.approx(32.7, abs=0.05)
    # The sums are 160, -12, 156, -35, 162, 0.
    assert re.search(r"fastest after\s+5 areas", answer)
    assert re.search(r"slowest after\s+4 areas", answer)
    assert "mean moment" not in answer


def test_inertia_that_is_there__is_taken_off():
    # Half a turn at 100 N·m: 100 π J = I δ ω².
    asked = 100 * math.pi / (0.02 * (20 * math.pi) ** 2)
    assert inertia_in(said("flywheel", "moments.csv", *ASKED).stdout) == pytest.approx(asked, rel=1e-4)
    scale = ("--area-energy", f"{250 * math.radians(3)!r} J", "--inertia", "2.7 kg m2")
    assert inertia_in(said("flywheel", "areas.csv", *ASKED, *scale).stdout) == pytest.approx(30.0, abs=0.05)
    less = said("flywheel", "moments.csv", *ASKED, "--inertia", "1.5 kg m2").stdout
    assert inertia_in(less) == pytest.approx(asked - 1.5, rel=1e-4)


@each(
    "line, words",
    [
        ("areas.csv", "no column 'phi': the header must be 'phi [deg], moment [N m]', it has area"),
        ("moments.csv --area-energy 3J", "no column 'area': the header must be 'area [mm2]'"),
        ("areas.csv --area-energy 3", "--area-energy: 3 has no unit"),
        ("areas.csv --area-energy 0J", "give the energy of a unit of area, above 0"),
        ("moments.csv --inertia 3kg", "expected an inertia"),
    ],
)
def test_flywheel_that_cannot_be_sized__is_refused(line, words):
    assert words in refused("flywheel", *line.split(), *ASKED)
