"""What there is to ask and to write: `sweeps quantities`, `sweeps help`."""

import re

import pytest
from commands import done, refused, row

from engine import Machine, Scene, described_dimension, scene_numbers
from sweeps import read_scene
from sweeps.report.help.key_help import key_text
from sweeps.study.study_text import StudyText
from sweeps.text.templates import bundled_templates, templates


def test_quantities__lists_all_that_the_machine_offers(press_folder):
    machine = Machine(read_scene("press.toml"))
    told = {line.split()[0] for line in done("quantities", "press.toml").splitlines() if line.startswith("  ")}
    assert told == {*machine.available_summaries, *machine.available_fields}


def test_quantities__tells_symbol_unit_and_meaning_of_what_is_asked_by_name_or_by_words(press_folder):
    line = row(done("quantities", "press.toml", "ram.velocity"), "ram.velocity")
    assert line == ["ram.velocity", "v_ram", "m/s", "velocity", "of", "slider", "ram"]
    assert "maximum velocity of slider ram" in done("quantities", "press.toml", "ram.velocity.max")
    found = [line for line in done("quantities", "press.toml", "STROKE", "high").splitlines() if line[:2] == "  "]
    assert found
    assert all("stroke" in line and "high" in line for line in found)
    message = refused("quantities", "press.toml", "ram.velocty")
    assert "'ram.velocity'" in message
    assert len(message.splitlines()) == 1


@pytest.mark.parametrize("asked", ["input.length", "groups.drive.first.length", "vary.input.length.from", "compressor"])
def test_help__explains_paths_of_the_user_and_types(asked):
    assert "required" in done("help", asked)


def test_help__explains_a_named_table():
    assert "type: one of" in done("help", "elements.cam")


def test_help__tells_unit_limit_default_and_example():
    text = key_text("cylinders.gas.bore")
    assert "length, '80 mm', greater than 0" in text
    assert 'bore = "80 mm"' in text
    assert "default: 101.325 kPa" in key_text("ambient")
    # π/2 and 40° as people type them.
    assert re.search(r"angle, '30 deg', at least 0, less than 90 ° +default: 40 °\n", key_text("limits"))
    assert '"high" or "low"' in key_text("cylinders.gas.head")


def test_help__knows_every_number_of_every_template():
    """Paths of numbers in scenes, found by reading them, against paths found by walking the models."""
    found = {}
    for name in templates():
        for path, number in scene_numbers(read_scene(bundled_templates()[name])).items():
            # Without the name that the user gave.
            parts = path.split(".")
            found[parts[0], *parts[2:-1], parts[-1], number.dimension] = path
    for (*keys, dimension), path in found.items():
        if "numbers" not in keys and dimension != "number":
            assert f"'{described_dimension(dimension).example}'" in key_text(path), path


def test_help__knows_every_key_at_the_top():
    listed = done("help")
    for key in {*Scene.model_fields, *StudyText.model_fields}:
        assert f"  {key} " in listed
        assert key_text(key)


def test_help__of_an_unknown_key_names_what_is_near():
    assert "did you mean 'input.length'" in refused("help", "inptu.lenght")
