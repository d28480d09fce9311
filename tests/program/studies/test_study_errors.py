"""Studies that are refused: the message names the file, the line, the key, what is wrong and the mend."""

from pathlib import Path

import pytest
from each_case import each
from press_texts import PRESS_WITH_FLYWHEEL as SCENE
from slips import changed
from study_samples import STUDY, study_of

from sweeps.text.input_files import InputError


def refused(folder: Path, text: str) -> InputError:
    with pytest.raises(InputError) as caught:
        study_of(folder, text)
    return caught.value


def test_condition_of_several_lines__is_refused_with_its_own_line(study_folder):
    require = """require = [
  "reach < 5",
  "groups.slide.first.length < '1 m'",
  "input.length < bodies.ram.mass",
]
"""
    error = refused(study_folder, changed(STUDY, "positions = 48\n", require))
    assert [(line, key) for line, key, _ in error.problems] == [(7, "require")]
    assert "compares a length with a mass:\n    input.length < bodies.ram.mass" in str(error)


def test_row_of_a_table__is_refused_by_the_names_of_its_columns(study_folder):
    table = """[forces.punch]
type = "table"
on = "B"
angle = "90 deg"
over_stroke = ["0 mm", "8 mm", "1 mm"]
slider = "ram"
interpolation = "linear"
force = ["0 kN", "1 kN", "2 kN"]
"""
    scene = SCENE[: SCENE.index("[forces.punch]")] + table + SCENE[SCENE.index("[flywheel]") :]
    (study_folder / "press.toml").write_text(scene)
    words = r"row 3: over_stroke is below that of row 2; sort .* by over_stroke"
    with pytest.raises(InputError, match=words):
        study_of(study_folder, STUDY)
    (study_folder / "press.toml").write_text(scene.replace(', "2 kN"]', "]"))
    with pytest.raises(InputError, match="over_stroke has 3 rows, force has 2; give one force for every over_stroke"):
        study_of(study_folder, STUDY)


def test_several_problems__are_told_at_once(study_folder):
    text = changed(changed(STUDY, '"60 mm"', '"60 kg"'), "[3, 4, 5]", '["x"]')
    text = changed(text, "reach * input.length", "reech * input.length")
    keys = [key for _, key, _ in refused(study_folder, text).problems]
    assert keys == ["vary.input.length", "vary.reach", "derive.groups.slide.first.length"]


def test_refused_name__is_not_unknown_as_well(study_folder):
    (study_folder / "sizes.csv").write_text("width\nx\n")
    expressions = """[derive]
double = "2 * width"
"bodies.ram.mass" = "double * 1 kg"
"""
    for given, key in (('[vary]\nwidth = ["x"]\n', "vary.width"), ('variants = "sizes.csv"\n', "variants")):
        text = f"scene = 'press.toml'\nrequire = 'double > 1'\n{given}{expressions}"
        assert [key for _, key, _ in refused(study_folder, text).problems] == [key]
    text = f"scene = 'press.toml'\nrequire = 'double > 1'\n{expressions}"
    assert [key for _, key, _ in refused(study_folder, text).problems] == ["derive.double"]


def test_error_in_a_scene_inside_the_study__names_its_line_there(study_folder):
    inside = SCENE.replace("\n[", "\n[scene.").replace('title = "Crank press"', "[scene]", 1)
    text = 'positions = 48\n[vary]\n"input.length" = {values = ["1 mm"]}\n' + inside
    slips = [("50 mm", "50 kg", "length"), ('joint = "A"', 'joint = "Z"', "joint"), ("mass =", "maas =", "maas")]
    for old, new, key in slips:
        broken = changed(text, old, new)
        found = refused(study_folder, broken).problems[0]
        assert found[0] == next(i for i, row in enumerate(broken.splitlines(), 1) if new in row)
        assert found[1].endswith(key)


@each(
    "added, path, value, words",
    [
        (
            '[flywheel.wheel]\ntype = "disc"\n',
            "flywheel.wheel.width_ratio",
            "0.3",
            "width_ratio goes with type = 'mean rim'",
        ),
        ('[shafts.s]\ngeared_to = "crank"\nratio = 2\n', "shafts.s.phase", '"10 deg"', "without pivot"),
        ('[springs.s]\nbetween = ["O", "B"]\ndamping = "10 N s/m"\n', "springs.s.free_length", '"1 m"', "stiffness"),
    ],
)
def test_number_that_means_nothing_there__does_not_vary(tmp_path, added, path, value, words):
    (tmp_path / "scene.toml").write_text(f"{SCENE}\n{added}", encoding="utf8")
    text = f'scene = "scene.toml"\npositions = 48\n\n[{{}}]\n"{path}" = {{}}\n\n[outputs]\nsummaries = ["ram.stroke"]\n'
    for table, given in (("vary", f"{{values = [{value}]}}"), ("derive", f"'{value.strip(chr(34))}'")):
        message = str(refused(tmp_path, text.format(table, given)))
        assert words in message
        assert f"{table}.{path}: can't vary in this scene" in message


def test_number_that_another_one_gives_a_meaning__varies_with_it(tmp_path):
    added = '[springs.s]\nbetween = ["O", "B"]\ndamping = "10 N s/m"\n'
    (tmp_path / "scene.toml").write_text(f"{SCENE}\n{added}", encoding="utf8")
    axes = '"springs.s.free_length" = "1 m to 2 m, 3"\n"springs.s.stiffness" = "10 N/m to 20 N/m, 3"\n'
    assert study_of(tmp_path, f'scene = "scene.toml"\npositions = 48\n\n[vary]\n{axes}').design.size == 9
