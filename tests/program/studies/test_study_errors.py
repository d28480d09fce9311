"""Studies that are refused: the message names the file, the line, the key, what is wrong and the mend."""

from pathlib import Path

import pytest
from each_case import each
from press_texts import PRESS_WITH_FLYWHEEL as SCENE
from slips import cases, changed
from study_samples import STUDY, study_of

from sweeps.text.input_files import InputError

# Name | what to change | what into | a mark of the line | key | words of the message.
SLIPS = cases(r"""
nested misspelt path | bodies.ram.mass | bodies.ram.maas | maas | vary.bodies.ram.maas | 'bodies.ram.mass'
path of a text | "input.length" = | "input.pivot" = | input.pivot | vary.input.pivot | not a number
part of a used name | reach = | rea = {values = [1]}\nreach = | rea = | vary.rea | not a number
wrong unit | "60 mm" | "60 kg" | 60 kg | vary.input.length | a length such as
no count | , count = 3 |  | "input.length" | vary.input.length.count | is missing
count of none | count = 3 | count = 0 | count = 0 | vary.input.length.count | at least 1
one value for two ends | count = 3 | count = 1 | count = 1 | vary.input.length | input.length
unknown key of an axis | count = 3 | cuont = 3 | cuont | vary.input.length.cuont | did you mean 'count'?
log through zero | "40 mm", to = "60 mm", count = 3 | "0 mm", to = "60 mm", count = 3, spacing = "log" | "0 mm"
    | vary.input.length | 0
not an axis | {values = [3, 4, 5]} | 3 | reach = 3 | vary.reach | 3 | a list
range without a count | {values = [3, 4, 5]} | "3 to 5" | reach = | vary.reach | '3 to 5' | how many
unknown series | {values = [3, 4, 5]} | {choose = "R30", low = 1, high = 5} | R30 | vary.reach.choose
    | 'R30' is not allowed | R5, R10, R20, R40, IEC
series without a range | {values = [3, 4, 5]} | {choose = "R20", low = "3 mm"} | R20 | vary.reach.high | is missing
list of nothing | {values = [3, 4, 5]} | {choose = []} | reach = | vary.reach.choose | at least 1
series of lengths for a mass | {values = ["50 kg", "0.1 t"]} | {choose = "R20", low = "5 kg", high = "9 kg"} | R20
    | vary.bodies.ram.mass | 'R20' is a series of lengths | list the sizes: ['1.2 kg', …]
series from zero | from = "40 mm", to = "60 mm", count = 3 | choose = "R20", low = "0 mm", high = "60 mm" | R20
    | vary.input.length | low '0 mm' must be above 0
series downwards | from = "40 mm", to = "60 mm", count = 3 | choose = "R20", low = "60 mm", high = "40 mm" | R20
    | vary.input.length | not above high '40 mm'
series between its sizes | from = "40 mm", to = "60 mm", count = 3 | choose = "R5", low = "41 mm", high = "44 mm" | R5
    | vary.input.length | no size of 'R5' lies from '41 mm' to '44 mm'; nearest: 40 mm and 63 mm
list of several kinds | {values = [3, 4, 5]} | {choose = [3, "4 mm"]} | 4 mm | vary.reach | number and length
low without sampling | count = 3 | count = 3}\n"gravity" = {low = "0 m/s2", high = "9 m/s2" | gravity | vary.gravity
    | [sampling] | method and count
sampling of nothing | [derive] | [sampling]\nmethod = "sobol"\ncount = 4\n\n[derive] | [sampling] | sampling
    | low and high
derived and varied | [derive] | [derive]\n"input.length" = "1" | "input.length" = "1" | derive.input.length
    | either varied or derived
unknown name in an expression | reach * input | reech * input | reech | derive.groups.slide.first.length | 'reach'
expression unfinished | reach * input.length | reach * | reach * | derive.groups.slide.first.length | reach *
condition for a number | reach * input | reach < input | reach < input | derive.groups.slide.first.length
    | is a condition | number
Python in an expression | reach * input.length | __import__('os').system('touch stolen') | __import__
    | derive.groups.slide.first.length | allowed
number for a condition | positions | require = ["reach + 1"]\npositions | require | require | condition
require in best | where = | require = | require | best.require | did you mean 'where'? | before they are computed
odd positions | positions = 48 | positions = 49 | positions | positions | even
precision | positions | field_precision = "float16"\npositions | float16 | field_precision | float64, float32
unknown field | [outputs] | [outputs]\nfields = ["B.z"] | [outputs] | outputs | 'B.z' is not a field | 'B.x'
best without a name | minimise = "excess_work" | minimise = "" | minimise = "" | best.minimise
    | an expression is missing
best of an expression | minimise = "excess_work" | minimise = "2 * excess_work" | minimise | best.minimise | [optimise]
best where a list | "ram.stroke > '90 mm'" | ["reach > 1",\n"ram.stroke > 90 kg"] | 90 kg | best.where
    | compares a length with a mass
best of two | minimise = "excess_work" | minimise = "excess_work"\nmaximise = "ram.stroke" | [best] | best | either
derived of another dimension | reach * input.length | reach * bodies.ram.mass | reach *
    | derive.groups.slide.first.length | gives a mass, but this is a length
dimension of a derived number | positions | require = ["2 * groups.slide.first.length > '1 kg'"]\npositions | require
    | require | compares a length with a mass
power that varies | reach * input.length | input.length**reach | **reach | derive.groups.slide.first.length
    | fixed number
several kinds | [3, 4, 5] | [3, "4 mm", "5 kg"] | 4 mm | vary.reach | number and length and mass | one dimension
best where a number | ram.stroke > '90 mm' | ram.stroke | where | best.where | condition
scene that is a folder | press.toml | . | scene = | scene | can't be read
no such csv | positions | variants = "choice.csv"\npositions | variants | variants | choice.csv | can't be read
""")


def refused(folder: Path, text: str) -> InputError:
    with pytest.raises(InputError) as caught:
        study_of(folder, text)
    return caught.value


@each("slip", SLIPS)
def test_slip__is_refused_with_line_key_and_mend(slip, study_folder):
    old, new, marker, key, *words = SLIPS[slip]
    text = changed(STUDY, old, new)
    error = refused(study_folder, text)
    if key:
        lines = [line for line, path, _ in error.problems if path == key]
        assert lines, str(error)
        marked = {i for i, line in enumerate(text.splitlines(), 1) if marker in line}
        assert marked.intersection(lines), str(error)
        assert "study.toml, line " in str(error)
    for word in words:
        assert word in str(error), str(error)
    assert "pydantic" not in str(error)
    assert not Path("stolen").exists()


@each(
    "csv, words",
    [
        ("input.length [kg]\n40\n", ("choice.csv, line 1: column input.length: expected a length such as",)),
        ("input.length [mm],input.length [mm]\n40,40\n", ("input.length",)),
        ("input.length [mm]\n", ("at least one row",)),
    ],
)
def test_bad_csv_of_variants__is_refused_and_named(csv, words, study_folder):
    (study_folder / "choice.csv").write_text(csv)
    error = refused(study_folder, 'scene = "press.toml"\nvariants = "choice.csv"\n')
    assert {(2, "variants")} == {(line, key) for line, key, _ in error.problems}, str(error)
    assert all(word in str(error) for word in words), str(error)


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
        ('[flywheel.wheel]\ntype = "disc"\n', "flywheel.wheel.width_ratio", "0.3", "belongs to a wheel of type"),
        ('[shafts.s]\ngeared_to = "crank"\nratio = 2\n', "shafts.s.phase", '"10 deg"', "without a pivot"),
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
