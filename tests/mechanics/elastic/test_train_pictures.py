"""Sheets and tables of torsional trains show what the engine computes."""

import math

import numpy as np
import pytest
from element_samples import element, scene, solved
from train_samples import BRANCHED, chain, free

from sweeps.pictures.elements.element_pictures import element_sheets, element_tables
from sweeps.pictures.elements.train_sheet import train_sheet, train_table
from sweeps.pictures.style import save_beside

EXCITED = chain([1.0, 2.0, 0.5], [4e4, 9e4], speed=60.0, excitations={"e": {"on": "m0", "order": 2, "amplitude": 30.0}})


def test_sheet__has_modes_levels_and_moments_of_the_train():
    figure = train_sheet(scene(it=EXCITED), "it", "Drive")
    modes, campbell, moments = figure.axes
    found = solved(EXCITED)
    # Both ends of each shaft, and a gap.
    shape = modes.get_lines()[0].get_ydata()
    assert shape[[0, 1, 4]] == pytest.approx([found[f"mode_1.m{i}"][0] for i in range(3)], abs=1e-12)
    levels = {line.get_ydata()[0] for line in campbell.get_lines() if np.ptp(line.get_ydata()) == 0}
    assert any(level == pytest.approx(found["frequency_1"][0] / math.tau) for level in levels)
    curve = next(line for line in moments.get_lines() if line.get_label() == "s0")
    rpm, values = curve.get_data()
    at = np.abs(rpm - 60.0 * 30 / math.pi).argmin()
    there = solved(EXCITED | {"speed": rpm[at] * math.pi / 30}, "s0.alternating_moment")["s0.alternating_moment"][0]
    assert values[at] in (pytest.approx(there), pytest.approx(there / 1e3))


@pytest.mark.parametrize("train", [free(BRANCHED), chain([1.0], []) | {"shafts": {
    "bar": {"between": ["m0", "frame"], "stiffness": 1e3}}}])  # fmt: skip
def test_files_and_tables__are_made_of_branched_and_single_trains(train, tmp_path):
    (made,) = save_beside(tmp_path / "scene.png", element_sheets(scene(it=train)))
    assert made.name == "scene_it_vibration.png"
    assert made.stat().st_size > 10_000
    assert "Holzer" in element_tables(scene(it=train))


def test_holzers_table__adds_up_to_nothing():
    text = train_table(element(EXCITED), {})
    assert text.count("Mode") == 2
    for line in text.splitlines():
        if "remainder" in line:
            words = line.split()
            assert abs(float(words[1])) < 1e-12


def test_table_of_equal_branches__says_that_modes_are_open():
    masses = {"hub": {"inertia": 5.0}, "a": {"inertia": 1.0}, "b": {"inertia": 1.0}, "c": {"inertia": 1.0}}
    shafts = {f"to_{x}": {"between": ["hub", x], "stiffness": 1e4} for x in "abc"}
    text = train_table(element({"type": "torsional_train", "masses": masses, "shafts": shafts}), {})
    assert text.count("undetermined") == 2
