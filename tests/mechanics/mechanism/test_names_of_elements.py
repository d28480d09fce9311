"""Elements of different kinds may have one name: nothing else follows from it."""

import pytest

from engine import Machine
from sweeps.text.scene_text import read_scene
from sweeps.text.templates import template_text


@pytest.mark.parametrize("name", ["way", "O"])
def test_group_named_as_a_guide_or_a_point__moves_as_under_any_name(name, tmp_path):
    path, found = tmp_path / "scene.toml", []
    text = template_text("scotch_yoke")
    assert "[groups.drive" in text
    for changed in (text, text.replace("[groups.drive", f"[groups.{name}")):
        path.write_text(changed)
        found.append(Machine(read_scene(path), ["yoke.stroke"]).evaluate({}).summaries["yoke.stroke"][0])
    assert found[0] == found[1] == pytest.approx(0.1, rel=1e-12)
