"""Scenes written by commands: the author's text stays what it was, but for the numbers."""

from pathlib import Path

import pytest
from commands import done, refused
from each_case import each
from hypothesis import given, settings
from hypothesis import strategies as st
from machines import frame, slider_crank
from press_texts import PRESS

from engine import Scene, SceneError, scene_numbers
from sweeps.study.bundled import bundled_studies
from sweeps.study.study_reader import read_study
from sweeps.text.edited_text import edited_scene
from sweeps.text.scene_text import read_scene, scene_from, with_values, write_scene
from sweeps.text.templates import TEMPLATES, bundled_templates, templates
from sweeps.text.toml_text import parse_toml

COMMENTED = PRESS.replace('length = "50 mm"', 'length = "5 cm"   # half the stroke').replace(
    "[input]", "# drive\n[input]"
)


def test_variant__is_written_with_the_author_s_comments_and_units(press_folder):
    Path("press.toml").write_text(COMMENTED)
    done("run", "study.toml", "--no-plots", "--quiet", "--out", "r.h5")
    # Variant 2: 60 mm, 50 kg.
    wanted = COMMENTED.replace('"5 cm"', '"6 cm"').replace('"100 kg"', '"50 kg"')
    for number, file in enumerate(("r.h5", "study.toml")):
        done("export", file, "--variant", "2", "--to", f"v{number}.toml")
        assert Path(f"v{number}.toml").read_text() == wanted


def test_scene_with_numbers_set_anew__is_written_so(press_folder):
    Path("press.toml").write_text(COMMENTED)
    done("export", "press.toml", "--set", "input.length=1 in", "--to", "v.toml")
    assert Path("v.toml").read_text() == COMMENTED.replace('"5 cm"', '"2.54 cm"')


def test_texts_that_are_there__are_not_written_over(press_folder):
    before = Path("press.toml").read_text()
    assert "exists already" in refused("export", "press.toml", "--to", "press.toml")
    assert "exists already" in refused("balance", "press.toml", "--out", "press.toml")
    assert Path("press.toml").read_text() == before
    done("export", "press.toml", "--set", "input.length=60 mm", "--to", "press.toml", "--overwrite")
    assert Path("press.toml").read_text() == before.replace("50 mm", "60 mm")


@pytest.mark.parametrize("name", templates())
@settings(max_examples=1)
@given(share=st.floats(0.9, 1.1))
def test_every_number_of_every_template__is_replaced_exactly(name, share):
    path = bundled_templates()[name]
    scene, text = read_scene(path), path.read_text(encoding="utf8")
    numbers = {p: n.value * share for p, n in scene_numbers(scene).items() if p.endswith(("mass", "length", "speed"))}
    edited = edited_scene(scene, numbers, text, TEMPLATES)
    remarks = [line.strip() for line in text.splitlines() if line.startswith("#")]
    assert all(remark in edited for remark in remarks)

    found = scene_from(parse_toml(edited, name), edited, name, TEMPLATES)
    assert found.model_dump() == with_values(scene, numbers).model_dump()


# Copies of scenes with other numbers in them


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
        with_values(read_scene(bundled_templates()["four_bar"]), values)
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
