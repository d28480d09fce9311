"""Elastic links as texts and in pictures."""

import math
from pathlib import Path

import pytest
from element_samples import element, one
from test_oscillators import ROTOR
from test_two_mass_drives import DRIVE

from engine import scene_numbers
from sweeps.pictures.elements.element_pictures import element_sheet
from sweeps.study.bundled import bundled_studies
from sweeps.text.scene_text import scene_from, write_scene
from sweeps.text.templates import TEMPLATES
from sweeps.text.toml_text import parse_toml


def test_engine_of_a_train_with_throws__is_written_with_their_units():
    text = (Path(bundled_studies()["crankshaft_vibration"]).parent / "scenes" / "crankshaft_vibration.toml").read_text()
    text = text.replace("cylinders = 4\n", 'cylinders = 4\nthrows = ["0 deg", "180 deg", "180 deg", "0 deg"]\n')
    scene = scene_from(parse_toml(text, ""), text, "", TEMPLATES)
    written = write_scene(scene)
    again = scene_from(parse_toml(written, ""), written, "", TEMPLATES)
    engines = [made.elements["crankshaft"].engine for made in (scene, again)]
    assert engines[0].throws == engines[1].throws == pytest.approx((0.0, math.pi, math.pi, 0.0))
    assert scene_numbers(again) == scene_numbers(scene)


def test_sheets__show_what_is_computed():
    data = ROTOR | {"damping_ratio": 0.05, "start": {"displacement": 0.01, "time": 0.2}}
    figure = element_sheet(element(data))
    free, forced, through = figure.axes
    factor, moved, peak = one(data, "dynamic_factor", "free_displacement", "run_through_amplitude")
    assert any(list(line.get_ydata()) == [pytest.approx(factor)] for line in forced.get_lines())
    assert any(list(line.get_ydata()) == [pytest.approx(1e3 * moved)] for line in free.get_lines())
    curve = next(line for line in through.get_lines() if line.get_label() == "passing through")
    assert curve.get_ydata().max() == pytest.approx(1e3 * peak, rel=1e-3)
    figure = element_sheet(element(DRIVE))
    moments = figure.axes[0].get_lines()[0].get_ydata()
    assert moments.max() == pytest.approx(one(DRIVE, "greatest_moment")[0], rel=1e-3)
