"""Crank-rockers along a path: one that a linkage draws is found again, and the error told is that of the scene."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from commands import refused, said
from each_case import refusals

from engine import MovingMachine
from sweeps import read_scene
from sweeps.synthesis.paths import four_bar_along


def drawn(places):
    """Path of a coupler point of a crank-rocker of 60, 198, 144 and 216 mm, by trigonometry [m]."""
    pins = 0.06 * np.exp(2j * np.pi * np.arange(places) / places)
    to = 0.216 - pins
    inside = (0.198**2 + abs(to) ** 2 - 0.144**2) / (2 * 0.198 * abs(to))
    along = to / abs(to) * np.exp(1j * np.arccos(inside))
    return 0.1 + (pins + (0.1 + 0.08j) * along) * np.exp(0.4j)


def test_path_of_a_linkage__is_found_again_by_the_command(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    wanted = drawn(40)
    rows = [f"{1e3 * place.real!r}, {1e3 * place.imag!r}" for place in wanted.tolist()]
    Path("wanted.csv").write_text("\n".join(["x [mm], y [mm]", *rows]))
    assert said("synthesise", "path", "wanted.csv", "--out", "found.toml").exit_code == 0
    text = Path("found.toml").read_text()
    rms, greatest = map(float, re.search(r"deviation (\S+) mm\n# \(rms\) and (\S+) mm", text).groups())
    machine = MovingMachine(read_scene("found.toml"), positions=7200)
    path = np.array([1, 1j]) @ [*machine.fields(["P.x", "P.y"]).values()]
    apart = 1e3 * np.array([abs(path - place).min() for place in wanted])
    # Nearest of 7200 places instead of the nearest between them: half a step of about 0.1 mm at right angles to it.
    told = [math.sqrt(np.mean(apart**2)), apart.max()]
    assert told == pytest.approx([rms, greatest], abs=0.05 * 0.05 / max(greatest, 0.05) + 0.01 * greatest)
    # The path is 150 mm long and 110 mm wide; a linkage that draws it exists, so that the search comes near.
    assert greatest < 1.0


test_path_that_is_none__is_refused = refusals(
    four_bar_along,
    ([0, 1, 1j], "five finite points"),
    ([0, 1, 1j, math.nan, 2], "finite"),
    ([0, 1, 2, 3, 4], "collinear"),
    ([1 + 1j] * 6, "collinear"),
)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("x [mm], z [mm]\n1, 2\n", "no column 'y'"),
        ("x [kg], y [mm]\n1, 2\n", "length"),
        ("x [mm], y [mm]\n1, a", "is not a number"),
    ],
)
def test_table_that_is_none__is_refused(tmp_path, monkeypatch, table, words):
    monkeypatch.chdir(tmp_path)
    Path("wanted.csv").write_text(table)
    assert words in refused("synthesise", "path", "wanted.csv")
    assert not Path("path.toml").exists()
