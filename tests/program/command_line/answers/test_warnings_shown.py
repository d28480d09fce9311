"""Warnings where a person meets them: in check, run, report, and as columns of a study."""

import json
import re
from pathlib import Path

import h5py
import pytest
from commands import done, refused
from press_texts import COMPRESSOR, PRESS

from engine import WARNING_KINDS
from sweeps.guide.chapters import chapters

LOOSE = PRESS + COMPRESSOR.replace("6 %", "60 %").replace("7 bar", "2 bar")
CLEARANCE = "cylinders.gas.clearance: 60 % of the swept volume exceeds limits.clearance = 50 %; is it a percentage?"
STUDY = """
scene = "press.toml"
[vary]
"cylinders.gas.clearance" = [0.3, 0.4, 0.6]
[outputs]
summaries = ["required_power", "warnings", "warnings.clearance"]
[best]
minimise = "required_power"
"""


@pytest.fixture
def gas_folder(press_folder):
    Path("press.toml").write_text(LOOSE)
    return press_folder


def test_check__names_them_before_the_variants(gas_folder):
    answer = done("check", "press.toml")
    assert answer.index("Warnings\n") < answer.index(CLEARANCE) < answer.index("Variants\n")


def test_run__names_those_of_the_only_machine(gas_folder):
    assert f"Warning: {CLEARANCE}" in done("run", "press.toml", "--no-plots", "--quiet")
    assert CLEARANCE in json.loads(done("run", "press.toml", "--no-plots", "--quiet", "--json"))["warnings"]


def test_limits__of_a_scene_replace_the_usual_ones(gas_folder):
    Path("press.toml").write_text(LOOSE + "[limits]\nclearance = 0.61\n")
    assert "clearance" not in done("check", "press.toml").partition("Variants")[0]
    assert "did you mean" in refused("check", "press.toml", "--set", "limits.clearence=2")


def test_columns__are_filtered_by_where_and_run_names_those_of_the_best(gas_folder):
    Path("gas.toml").write_text(STUDY)
    answer = done("run", "gas.toml", "--no-plots", "--quiet")
    with h5py.File("results/gas.h5") as file:
        flags, count = file["warnings.clearance"][:], file["warnings"][:]
    assert list(flags) == [0.0, 0.0, 1.0]
    assert list(count - count.min()) == [0.0, 0.0, 1.0]
    best = re.search(r"cylinders\.gas\.clearance += +(\S+)", answer)[1]
    assert (CLEARANCE in answer) == (float(best) == 0.6)
    Path("gas.toml").write_text(STUDY + 'where = "warnings.clearance == 1"\n')
    assert CLEARANCE in done("run", "gas.toml", "--no-plots", "--quiet")
    Path("gas.toml").write_text(STUDY + 'where = "warnings.clearance == 0"\n')
    assert CLEARANCE not in done("run", "gas.toml", "--no-plots", "--quiet")


def test_report__lists_them(gas_folder, blank_pictures):
    done("report", "press.toml", "--out", "press.html")
    assert CLEARANCE in Path("press.html").read_text(encoding="utf8")


def test_guide__explains_every_warning():
    named = re.findall(r"^\| `(\w+)` \|", chapters()["warnings"], flags=re.M)
    assert named == [kind.name for kind in WARNING_KINDS]
