"""Sheets of one machine over its cycle: indicator diagrams, and motion up to the jerk."""

import numpy as np
import pytest
from drawn_machines import scotch_yoke, slider_crank

from engine import Machine, MovingMachine
from sweeps.pictures.machine.cycle_sheets import indicator_diagrams, motion_of_part
from sweeps.pictures.picture_error import PictureError

AIR = {"type": "compressor", "piston": "piston", "bore": 0.09, "clearance": 0.06, "suction": 1e5, "discharge": 6e5}


def test_area_of_an_indicator_diagram__is_the_indicated_work():
    scene = slider_crank(cylinders={"air": AIR})
    figure = indicator_diagrams(MovingMachine(scene))
    volume, pressure = figure.axes[0].lines[0].get_data()
    # In cm³ and kPa, by trapezia between 720 positions.
    area = 1e-3 * abs(np.sum(0.5 * (pressure[1:] + pressure[:-1]) * np.diff(volume)))
    outcome = Machine(scene, summaries=["air.indicated_work"]).evaluate({})
    assert area == pytest.approx(outcome.summaries["air.indicated_work"][0], rel=1e-3)
    assert f"air: {outcome.summaries['air.indicated_work'][0]:.5g} J" in figure.axes[0].get_title()


def test_scotch_yoke__has_the_jerk_of_a_cosine():
    scene = scotch_yoke()
    radius, speed = scene.input.length, scene.input.speed
    figure = motion_of_part(MovingMachine(scene), "yoke")
    angle, jerk = figure.axes[3].lines[0].get_data()
    phi = np.radians(angle) - scene.guides["way"].angle
    assert np.abs(jerk) == pytest.approx(np.abs(radius * speed**3 * np.sin(phi)), abs=1e-8 * radius * speed**3)
    assert [line.get_ydata().size for ax in figure.axes for line in ax.lines] == [721] * 4


def test_part_that_is_none__is_refused_with_those_there_are():
    with pytest.raises(PictureError, match=r"'bar' is not a slider or link of this machine; choose from: .*piston"):
        motion_of_part(MovingMachine(slider_crank()), "bar")
