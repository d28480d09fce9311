"""Scenes written by commands: the author's text stays what it was, but for the numbers."""

from pathlib import Path

import pytest
from commands import done, refused
from hypothesis import given, settings
from hypothesis import strategies as st
from press_texts import PRESS

from engine import scene_numbers
from sweeps.text.edited_text import edited_scene
from sweeps.text.scene_text import read_scene, scene_from, with_values
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
@settings(max_examples=1, deadline=None)
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
