"""The bundled study of a planetary reducer, its template, and the pictures of velocities."""

import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from gear_samples import scene_with, simple_planetary, tips_keep_clear

from engine import Verdict, velocity_picture
from sweeps.pictures.elements.gear_sheet import gear_sheet, gear_table
from sweeps.pictures.picture_files import machine_pictures
from sweeps.report.sweep_result import SweepResult
from sweeps.run.runner import run_study
from sweeps.study.bundled import bundled_studies
from sweeps.study.study_reader import read_study
from sweeps.text.scene_text import read_scene
from sweeps.text.templates import bundled_templates


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    path = tmp_path_factory.mktemp("reducer") / "planetary_reducer.h5"
    return SweepResult(run_study(read_study(bundled_studies()["planetary_reducer"]), path))


def test_reducer_study__keeps_what_can_be_assembled(result):
    fits = 0
    for sun, planet, k, module in itertools.product(range(17, 41), range(17, 71), (3, 4, 5), (1, 1.25, 1.5, 2, 2.5)):
        ring = sun + 2 * planet
        far = (sun + planet) * math.sin(math.pi / k) > planet + 2
        clear = tips_keep_clear(sun, planet) and tips_keep_clear(planet, ring, -1)
        fits += module * ring <= 170 and (sun + ring) % k == 0 and far and clear
    assert (result.columns["status"] == Verdict.OK).sum() == fits


def test_reducer_study__answers_its_question(result):
    """Every variant of ratio 5 again, by the closed forms of a simple planetary train."""

    def efficiency_of(z1, z2, sense):
        alpha = math.radians(20)
        ends = []
        for z, side in ((z1, 1), (z2, sense)):
            tip = math.acos(z * math.cos(alpha) / (z + 2 * side))
            ends.append(side * z * (math.tan(tip) - math.tan(alpha)) / math.tau)
        e1, e2 = ends
        # From the end of the path to its beginning a pitch later; |s| goes on beyond the pitch point.
        single = (1 - e1) * abs(1 - e1) + (1 - e2) * abs(1 - e2)
        return 1 - 0.06 * math.pi * (1 / z1 + sense / z2) * (e1**2 + e2**2 + single) / 2

    best = (0.0,)
    for sun, planet, k, module in itertools.product(range(17, 41), range(17, 71), (3, 4, 5), (1, 1.25, 1.5, 2, 2.5)):
        ring = sun + 2 * planet
        ratio = 1 + ring / sun
        if not 4.95 < ratio < 5.05 or (sun + ring) % k or module * ring > 170:
            continue
        if (sun + planet) * math.sin(math.pi / k) <= planet + 2:
            continue
        if not (tips_keep_clear(sun, planet) and tips_keep_clear(planet, ring, -1)):
            continue
        both = efficiency_of(sun, planet, 1) * efficiency_of(planet, ring, -1)
        share = (1 + ring / sun * both) / ratio
        m, arm = module * 1e-3, 1 / ratio
        spin = arm - sun / planet * (1 - arm)
        discs = [7850 * 0.024 * math.pi / 4 * ((m * z) ** 2 - bore**2) for z, bore in ((sun, 0), (planet, 0.012))]
        i_sun = discs[0] * (m * sun) ** 2 / 8
        i_planet = discs[1] * ((m * planet) ** 2 + 0.012**2) / 8
        inertia = i_sun + k * (i_planet * spin**2 + discs[1] * (m * (sun + planet) / 2 * arm) ** 2) + 0.003 * arm**2
        # The sun's moment with losses drives; what its teeth carry is more than what is due to the planets.
        pull = 60 / ratio / share / (m * sun / 2) / k
        if inertia < 5e-4 and pull < 8e6 * 0.024 * m:
            best = max(best, (share, sun, planet, k, module))
    found = {name: column[result.best()] for name, column in result.columns.items()}
    assert found["reducer.efficiency"] == pytest.approx(best[0], rel=1e-12)
    wheels = "elements.reducer.wheels"
    keys = f"{wheels}.sun.teeth", f"{wheels}.planet.teeth", "elements.reducer.shafts.arm.planets"
    chosen = [*(found[key] for key in keys), found["elements.reducer.module"]]
    assert chosen[:3] == list(best[1:4])
    assert chosen[3] == pytest.approx(best[4] * 1e-3)


def train_of(scene):
    return next(iter(scene.elements.values()))


def test_template__makes_a_train_that_fits():
    scene = read_scene(bundled_templates()["planetary_train"])
    told = gear_table(train_of(scene))
    assert "W = 3·3 − 2·3 − 2 = 1" in told
    assert "1450" in told


def test_picture_of_linear_velocities__has_one_velocity_at_every_contact():
    train = train_of(scene_with(simple_planetary(24, 30, 84, {"sun": {"speed": 10.0}, "ring": {"speed": -3.0}})))
    picture = velocity_picture(train)
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
    train = train_of(scene_with(simple_planetary(24, 30, 84, {"sun": {"speed": 10.0}, "ring": {"speed": -3.0}})))
    figure = gear_sheet(train)
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


def test_pictures_of_a_scene__are_those_of_its_trains(tmp_path):
    scene = read_scene(bundled_templates()["planetary_train"])
    made = machine_pictures(scene, tmp_path / "train.png")
    assert [path.name for path in made] == ["train_velocities.png"]
    assert Path(made[0]).stat().st_size > 20_000
