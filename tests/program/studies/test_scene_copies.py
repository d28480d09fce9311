"""Copies of scenes with other numbers in them: what changes, what is shared, what is refused."""

import pytest
from each_case import each
from machines import frame, slider_crank

from engine import Scene, SceneError, scene_numbers
from sweeps.study.bundled import bundled_studies
from sweeps.study.study_reader import read_study
from sweeps.text.scene_text import read_scene, scene_from, with_values, write_scene
from sweeps.text.templates import TEMPLATES, bundled_templates
from sweeps.text.toml_text import parse_toml


def scene_of(name: str) -> Scene:
    return read_scene(bundled_templates()[name])


@each("name", bundled_studies())
def test_copy__has_the_new_numbers_and_all_others_as_they_were(name):
    study = read_study(bundled_studies()[name])
    before = {path: number.value for path, number in scene_numbers(study.scene).items()}
    values, _ = study.values(0, 1)
    new = {path: float(values[path][0]) for path in study.paths}
    after = {path: number.value for path, number in scene_numbers(with_values(study.scene, new)).items()}
    # Places that tell assembly modes follow the variant.
    told = {path: value for path, value in after.items() if path.startswith("near.")}
    assert after == before | new | told
    assert bool(told) == bool(study.scene.near)


@pytest.mark.parametrize(
    ("values", "path"), [({"input.length": -0.1}, "input.length"), ({"groups.swing.mode": 3.0}, "groups.swing.mode")]
)
def test_number_that_is_not_allowed__is_refused_by_its_path(values, path):
    with pytest.raises(SceneError) as caught:
        with_values(scene_of("four_bar"), values)
    assert [place for place, _ in caught.value.problems] == [path]


def test_tables_of_motion__are_written_with_their_units():
    over, follower = [0.0, 1.5, 3.0], {"type": "translating", "link": "tappet", "guide": "way", "contact": "flat"}
    lift, swing = ({"over_angle": over, key: [0.0, 0.01, 0.004]} for key in ("lift", "swing"))
    inputs = {
        "ram": {"type": "slider", "guide": "way", "table": lift},
        "arm": {"type": "crank", "pivot": "C", "table": swing},
    }
    cam = {"on": "crank", "base_radius": 0.05, "table": lift, "follower": follower}
    points = {"O": frame(0, 0), "C": frame(0.2, 0)}
    machine = slider_crank(points=points, guides={"way": {"angle": 1.5}}, inputs=inputs, cams={"cam": cam}, groups={})
    scene = Scene.model_validate(machine)
    text = write_scene(scene)
    assert scene_from(parse_toml(text, ""), text, "", TEMPLATES) == scene
