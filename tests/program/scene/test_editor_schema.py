"""The JSON Schemas for editors accept what the program accepts, and find mistakes in single keys."""

import json
import re
import tomllib
from contextlib import suppress

import jsonschema
import pytest
from click.testing import CliRunner
from each_case import each
from hypothesis import given
from hypothesis import strategies as st

from engine import DIMENSIONS, UnitError, in_text, text_pattern
from engine.units.reading import UNIT_NAMES
from sweeps.cli import main
from sweeps.report.help.editor_schema import schema_texts
from sweeps.study.bundled import bundled_studies
from sweeps.study.study_text import is_scene
from sweeps.text.input_files import InputError
from sweeps.text.scene_text import read_scene
from sweeps.text.templates import bundled_templates, template_text


@pytest.fixture(scope="module")
def schemas():
    made = {name.partition(".")[0]: json.loads(text) for name, text in schema_texts().items()}
    for schema in made.values():
        jsonschema.Draft7Validator.check_schema(schema)
    return {kind: jsonschema.Draft7Validator(schema) for kind, schema in made.items()}


def mistakes(validator, text):
    return [
        (".".join(map(str, error.absolute_path)), error.message) for error in validator.iter_errors(tomllib.loads(text))
    ]


def test_templates_and_bundled_studies__accepted(schemas):
    files = [*bundled_templates().values(), *bundled_studies().values()]
    files += [path for study in bundled_studies().values() for path in study.parent.glob("scenes/*.toml")]
    for path in dict.fromkeys(files):
        text = path.read_text(encoding="utf8")
        kind = "scene" if is_scene(tomllib.loads(text)) else "study"
        assert not mistakes(schemas[kind], text), path


WRONG = {
    "a misspelt key": ('pin = "A"', 'pinn = "A"', "input"),
    "an unknown type": ('type = "RRP"', 'type = "RRX"', "groups.drive"),
    "a missing key": ('inner = "B"', "", "groups.drive"),
    "a number without its unit": ('length = "40 mm"', "length = 40", "input.length"),
    "a misspelt unit": ('length = "40 mm"', 'length = "40 mn"', "input.length"),
    "a length of zero": ('length = "40 mm"', "length = 0", "input.length"),
    "a text instead of a table": ("[points]\nO = { x = 0, y = 0 }", '[points]\nO = "0, 0"', "points.O"),
    "a name with a hyphen": ("piston_body =", "piston-body =", "bodies"),
}


@each("right, wrong, place", WRONG.values())
def test_mistakes_in_a_scene__found_where_they_are(schemas, tmp_path, right, wrong, place):
    text = template_text("slider_crank")
    assert right in text
    text = text.replace(right, wrong, 1)
    found = mistakes(schemas["scene"], text)
    assert [where for where, _ in found if where == place or where.startswith(f"{place}.")], found
    (tmp_path / "wrong.toml").write_text(text, encoding="utf8")
    with pytest.raises(InputError):
        read_scene(tmp_path / "wrong.toml")


STUDY = 'scene = "press.toml"\n[vary]\n'


@each(
    "axis",
    [
        '"input.length" = "40 mm to 80 mm, 5"',
        'input.length = ["40 mm", "50 mm"]',
        'groups.rod.first.length = { low = "0.1 m", high = "0.2 m" }',
        'input.length = { choose = "R20", low = "40 mm", high = "80 mm" }',
        "low = [1, 2, 3]",
    ],
)
def test_axes__in_all_spellings(schemas, axis):
    assert not mistakes(schemas["study"], STUDY + axis)


@each(
    "axis",
    ['input.length = { from = "40 mm", stop = "80 mm", count = 5 }', 'input.length = { values = "40 mm" }', "a = 3"],
)
def test_axes__mistakes_found(schemas, axis):
    assert mistakes(schemas["study"], STUDY + axis)


def test_a_scene_within_a_study__checked_too(schemas):
    text = "[scene]\n" + re.sub(r"^\[", "[scene.", template_text("slider_crank"), flags=re.M)
    assert not mistakes(schemas["study"], text)
    assert mistakes(schemas["study"], text.replace('pin = "A"', 'pinn = "A"'))


PIECES = ["1", "2.5", "-3e2", "1/4", " ", "-", "/", "*", "·", "(", ")", "^", "²", "⁻¹", "%", "°", "µm", "r/min"]
PIECES += ["\N{MINUS SIGN}0"]


@given(
    st.lists(st.sampled_from([*PIECES, *UNIT_NAMES]), min_size=1, max_size=7).map("".join),
    st.sampled_from([*DIMENSIONS]),
)
def test_quantities_that_the_program_reads__match_the_pattern(text, dimension):
    for written in (text, f"2 {text}"):
        with suppress(UnitError):
            in_text(written, dimension)
            assert re.search(text_pattern(dimension), written), written


def test_schema_command__writes_what_templates_name(tmp_path):
    run = CliRunner().invoke(main, ["schema", "--out", str(tmp_path)])
    assert run.exit_code == 0, run.output
    # A second time it replaces them, as after an update.
    assert CliRunner().invoke(main, ["schema", "--out", str(tmp_path)]).exit_code == 0
    texts = schema_texts()
    for name in bundled_templates():
        named = re.match(r"#:schema (\S+)\n", template_text(name))
        assert named, f"{name} has no line for editors"
        assert (tmp_path / named[1]).read_text(encoding="utf8") == texts[named[1]]
