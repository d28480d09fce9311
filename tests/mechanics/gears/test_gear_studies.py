"""The template of a planetary train, and the pictures of its velocities."""

import numpy as np
import pytest
from element_samples import element
from gear_samples import simple_planetary

from engine import velocity_picture
from sweeps.pictures.elements.gear_sheet import gear_sheet, gear_table
from sweeps.text.scene_text import read_scene
from sweeps.text.templates import bundled_templates

TRAIN = element(simple_planetary(24, 30, 84, {"sun": {"speed": 10.0}, "ring": {"speed": -3.0}}))


def test_template__makes_a_train_that_fits():
    scene = read_scene(bundled_templates()["planetary_train"])
    told = gear_table(next(iter(scene.elements.values())))
    assert "W = 3·3 − 2·3 − 2 = 1" in told
    assert "1450" in told


def test_picture_of_linear_velocities__has_one_velocity_at_every_contact():
    picture = velocity_picture(TRAIN)
    assert picture.axes == {"sun_shaft": 0.0, "idler": 27.0, "arm": 0.0, "ring_shaft": 0.0}
    for mesh, height, shafts in (("outer", 12, ("sun_shaft", "idler")), ("inner", 42, ("idler", "ring_shaft"))):
        assert picture.contacts[mesh][0] == pytest.approx(height)
        for shaft in shafts:
            line = picture.lines[shaft]
            at = line.velocities[0] + line.speed * (height - line.heights[0])
            assert at == pytest.approx(picture.contacts[mesh][1], rel=1e-12)
    # The arm's line ends in the planet's axis, on the planet's line.
    arm, idler = picture.lines["arm"], picture.lines["idler"]
    assert arm.velocities[1] == pytest.approx(idler.velocities[0] + idler.speed * (27 - idler.heights[0]), rel=1e-12)


def test_rays_of_angular_velocities__are_parallel_to_lines_of_linear_ones():
    figure = gear_sheet(TRAIN)
    figure.draw_without_rendering()
    _, linear, angular = figure.axes

    def slopes(ax):
        found = set()
        for line in ax.lines:
            ends = ax.transData.transform(np.column_stack(line.get_data()).astype(float))
            step = ends[-1] - ends[0]
            if abs(step[0]) > 1e-6 and abs(step[1]) > 1e-6:
                found.add(round(step[0] / step[1], 6))
        return found

    assert len(slopes(linear)) == 4
    assert slopes(linear) == slopes(angular)
