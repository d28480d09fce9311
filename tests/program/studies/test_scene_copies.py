"""Copies of scenes with other numbers in them: what changes, what is shared, what is refused."""

import numpy as np
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


COPIED = "cam press_with_motor engine rotor torsional_train elastic_drive planetary_train watt_six_bar"


@each("name", COPIED.split())
def test_copy__is_what_its_text_says(name):
    scene, rng = scene_of(name), np.random.default_rng(1)
    numbers = {path: n for path, n in scene_numbers(scene).items() if not n.choices and n.value}
    # Numbers of other kinds of wheels mean nothing here.
    numbers = {path: n for path, n in numbers.items() if not path.endswith("_ratio")}
    new = {path: number.value * rng.uniform(0.99, 1.01) for path, number in list(numbers.items())[::3]}
    text = write_scene(scene, new)
    again = scene_from(parse_toml(text, ""), text, "", TEMPLATES)
    found, expected = (scene_numbers(made) for made in (again, with_values(scene, new)))
    assert {p: n.value for p, n in found.items()} == {p: n.value for p, n in expected.items()}


@pytest.mark.parametrize(
    ("values", "path"),
    [({"input.length": -0.1}, "input.length"), ({"groups.swing.mode": 3.0}, "groups.swing.mode")],
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
