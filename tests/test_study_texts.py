"""Studies as texts: what varies, what follows from it, what is dropped, and what is refused."""

import itertools
from pathlib import Path

import numpy as np
import pytest

from sweeps.study import Study, find_study, read_study
from sweeps.textfile import InputError

SCENE = """\
title = "Crank press"

[points]
O = {x = "0 mm", y = "0 mm"}

[guides]
way = {angle = "-90 deg"}

[input]
type = "crank"
pivot = "O"
pin = "A"
length = "50 mm"
speed = "60 rpm"

[groups.slide]
type = "RRP"
inner = "B"
first = {link = "rod", joint = "A", length = "200 mm"}
second = {link = "ram", guide = "way"}

[bodies.ram]
link = "ram"
mass = "100 kg"

[forces.punch]
type = "constant"
on = "B"
angle = "90 deg"
force = "100 kN"
acts = "against"

[flywheel]
speed_fluctuation = "1/10"
"""

STUDY = """\
title = "Which crank?"
question = "How short may the crank be?"
scene = "press.toml"
positions = 48

[vary]
"input.length" = {from = "40 mm", to = "60 mm", count = 3}
bodies.ram.mass = {values = ["50 kg", "0.1 t"]}
reach = {values = [3, 4, 5]}

[derive]
"groups.slide.first.length" = "reach * input.length"

[outputs]
summaries = ["ram.stroke", "excess_work"]

[best]
minimise = "excess_work"
where = "ram.stroke > '90 mm'"
"""


@pytest.fixture
def folder(tmp_path) -> Path:
    (tmp_path / "press.toml").write_text(SCENE)
    return tmp_path


def study_of(folder: Path, text: str) -> Study:
    (folder / "study.toml").write_text(text, encoding="utf8")
    return read_study(folder / "study.toml")


def varying(folder: Path, vary: str, rest: str = "") -> Study:
    return study_of(folder, f'scene = "press.toml"\n{rest}\n[vary]\n{vary}\n')


def column(study: Study, name: str) -> list[float]:
    return study.values(0, study.design.size)[0][name].tolist()


def changed(text: str, old: str, new: str) -> str:
    assert old in text, old
    return text.replace(old, new, 1)


# What varies


def test_grid__is_the_product_of_the_axes_the_last_fastest(folder):
    study = study_of(folder, STUDY)
    grid = list(itertools.product([0.04, 0.05, 0.06], [50.0, 100.0], [3.0, 4.0, 5.0]))
    values, drop = study.values(0, study.design.size)
    assert study.design.size == len(grid) == 18
    assert not drop.any()
    for i, name in enumerate(("input.length", "bodies.ram.mass", "reach")):
        # 40 mm + 1 × 10 mm is one sum away from 50 mm.
        np.testing.assert_allclose(values[name], [point[i] for point in grid], rtol=4e-16, atol=0)
    np.testing.assert_allclose(
        values["groups.slide.first.length"], [length * reach for length, _, reach in grid], rtol=4e-16, atol=0
    )


def test_parameters__are_the_varied_and_the_derived_and_free_ones_are_no_paths(folder):
    study = study_of(folder, STUDY)
    assert study.parameters == ("input.length", "bodies.ram.mass", "reach", "groups.slide.first.length")
    assert study.paths == ("input.length", "bodies.ram.mass", "groups.slide.first.length")
    assert [study.unit(name) for name in study.parameters] == ["m", "kg", "1", "m"]


def test_free_parameters__have_the_units_of_their_values_and_expressions(folder):
    study = varying(
        folder,
        'play = {values = [0, "2 mm"]}\n'
        '"input.length" = {values = ["40 mm"]}\n'
        '[derive]\npace = "input.speed * (input.length + play)"\nturn = "2 * input.speed"\nroot = "sqrt(play)"\n'
        'energy = "bodies.ram.mass * pace**2"',
        "require = [\"energy < '1 kJ' and root > 0 and turn > 0\"]",
    )
    assert [study.unit(n) for n in ("play", "pace", "turn", "root", "energy")] == ["m", "m s-1", "rad s-1", "", "N m"]


@pytest.mark.parametrize(
    ("axis", "expected"),
    [
        ('{from = "40 mm", to = "60 mm", count = 5}', [0.04, 0.045, 0.05, 0.055, 0.06]),
        ('{from = "60 mm", to = "4 cm", count = 3}', [0.06, 0.05, 0.04]),
        ('{from = "40 mm", to = "40 mm", count = 1}', [0.04]),
        ('{from = "1 mm", to = "1 m", count = 4, spacing = "log"}', [1e-3, 1e-2, 1e-1, 1.0]),
        ('{values = ["40 mm", "0.05 m", "2 in"]}', [0.04, 0.05, 0.0508]),
    ],
)
def test_axis__has_the_values_written(axis, expected, folder):
    # One rounding each for the step, its multiple and the sum; a ratio's power adds a few.
    np.testing.assert_allclose(
        column(varying(folder, f'"input.length" = {axis}'), "input.length"), expected, rtol=4e-15
    )


@pytest.mark.parametrize(
    "written",
    [
        '"input.length" = {values = ["40 mm", "60 mm"]}',
        'input.length = {values = ["40 mm", "60 mm"]}',
        "'input.length' = {values = ['40 mm', '60 mm']}",
        'input = {length = {values = ["40 mm", "60 mm"]}}',
        '[vary.input]\nlength = {values = ["40 mm", "60 mm"]}',
        '[vary."input.length"]\nvalues = ["40 mm", "60 mm"]',
        '[vary.input.length]\nvalues = ["40 mm", "60 mm"]',
    ],
)
def test_path__may_be_quoted_or_nested(written, folder):
    study = varying(folder, written)
    assert study.paths == ("input.length",)
    assert column(study, "input.length") == [0.04, 0.06]


@pytest.mark.parametrize("derived", ['"points.O.x" = "2 * input.length"', 'points.O.x = "2 * input.length"'])
def test_derived_path__may_be_quoted_or_nested(derived, folder):
    study = varying(folder, f'"input.length" = {{values = ["40 mm"]}}\n[derive]\n{derived}')
    assert column(study, "points.O.x") == [0.08]


def test_mode_and_scale__vary_as_plain_numbers(folder):
    study = varying(folder, '"groups.slide.mode" = {values = [1, -1]}')
    assert column(study, "groups.slide.mode") == [1.0, -1.0]


CSV = '"input.length [mm]",bodies.ram.mass [kg],reach\n40,50,3\n55.5,1e2,4.25\n'


def test_variants_of_a_csv_file__go_together_and_cross_the_other_axes(folder):
    (folder / "choice.csv").write_text(CSV)
    vary = '"forces.punch.force" = {values = ["1 kN", "2 kN"]}'
    derive = '[derive]\n"groups.slide.first.length" = "reach*input.length"'
    study = varying(folder, f"{vary}\n{derive}", 'variants = "choice.csv"')
    assert study.design.size == 4
    rows = set(
        zip(column(study, "input.length"), column(study, "bodies.ram.mass"), column(study, "reach"), strict=True)
    )
    assert rows == {(0.04, 50.0, 3.0), (0.0555, 100.0, 4.25)}
    assert sorted(column(study, "forces.punch.force")) == [1e3, 1e3, 2e3, 2e3]


@pytest.mark.parametrize("method", ["random", "sobol", "latin"])
def test_sampling__draws_between_the_ends_together(method, folder):
    study = varying(
        folder,
        '"input.length" = {low = "40 mm", high = "60 mm"}\n'
        '"bodies.ram.mass" = {low = "1 kg", high = "1 t", spacing = "log"}\n'
        '"forces.punch.force" = {values = ["1 kN", "2 kN"]}\n'
        f'[sampling]\nmethod = "{method}"\ncount = 64\nseed = 5',
    )
    assert study.design.size == 128
    lengths, masses = np.array(column(study, "input.length")), np.array(column(study, "bodies.ram.mass"))
    assert len(set(zip(lengths, masses, strict=True))) == 64
    assert lengths.min() >= 0.04
    assert lengths.max() <= 0.06
    assert masses.min() >= 1
    assert masses.max() <= 1000
    # Half of a logarithmic range lies below its geometric mean: of 64 draws, each there twice, 5 σ = 2·5·4 may miss.
    assert abs((masses < 1000**0.5).sum() - 64) <= 40


def test_seed__changes_the_draw_and_nothing_else_does(folder):
    text = '"input.length" = {low = "40 mm", high = "60 mm"}\n[sampling]\nmethod = "random"\ncount = 16\nseed = '
    one, again, two = (column(varying(folder, text + s), "input.length") for s in ("1", "1", "2"))
    assert one == again
    assert one != two


def test_scene_as_a_study__is_a_single_variant_with_all_summaries(folder):
    study = read_study(folder / "press.toml")
    assert (study.design.size, study.paths, study.title) == (1, (), "Crank press")
    assert {"ram.stroke", "slide.transmission_angle", "flywheel_wittenbauer", "required_power"} <= set(study.summaries)


def test_scene_inside_the_study__is_the_scene(folder):
    inside = SCENE.replace("\n[", "\n[scene.").replace('title = "Crank press"', '[scene]\ntitle = "Crank press"', 1)
    text = STUDY.replace('scene = "press.toml"\n', "") + inside
    assert study_of(folder, text).scene == study_of(folder, STUDY).scene


# What follows and what is dropped


def test_derived_numbers__build_on_each_other_in_order(folder):
    study = varying(
        folder,
        'reach = {values = [3, 4]}\n[derive]\nshort = "input.length / 2"\n"input.length" = "short + \'10 mm\'"\n'
        '"groups.slide.first.length" = "reach * input.length"',
    )
    # input.length in the last expression is the derived one, 35 mm.
    np.testing.assert_allclose(column(study, "groups.slide.first.length"), [0.105, 0.14], rtol=1e-15)


def test_require__drops_the_variants_that_fail_any_condition(folder):
    first, second = "groups.slide.first.length < '200 mm'", "not (bodies.ram.mass == '50 kg' and reach < 4)"
    text = changed(STUDY, "positions = 48", f'positions = 48\nrequire = ["{first}", "{second}"]')
    study = study_of(folder, text)
    values, drop = study.values(0, 18)
    long = values["groups.slide.first.length"] >= 0.2
    light = (values["bodies.ram.mass"] == 50) & (values["reach"] < 4)
    assert drop.tolist() == (long | light).tolist()
    assert 0 < drop.sum() < 18


def test_undefined_condition__drops_the_variant_without_a_warning(folder):
    study = varying(
        folder,
        'reach = {values = [-1, 1]}\n[derive]\n"input.length" = "sqrt(reach) * \'1 m\'"',
        'require = ["1/reach > 0"]',
    )
    values, drop = study.values(0, 2)
    assert np.isnan(values["input.length"][0])
    assert drop.tolist() == [True, False]


@pytest.mark.parametrize("rest", ["", '[sampling]\nmethod = "sobol"\ncount = 37\nseed = 3\n'])
def test_values__do_not_depend_on_the_blocks(rest, folder):
    sampled = '"forces.punch.force" = {low = "1 kN", high = "9 kN"}\n' if rest else ""
    text = STUDY.replace("[derive]", f"{sampled}{rest}[derive]")
    study = study_of(
        folder, text.replace("positions", "require = [\"groups.slide.first.length < '240 mm'\"]\npositions")
    )
    size = study.design.size
    whole, dropped = study.values(0, size)
    for block in (1, 5, 7, size - 1):
        for start in range(0, size, block):
            stop = min(start + block, size)
            values, drop = study.values(start, stop)
            assert (drop == dropped[start:stop]).all()
            for name, array in values.items():
                assert (array == whole[name][start:stop]).all(), (name, start)


# The name of a study's content


def test_digest__stays_when_only_words_change(folder):
    digest = study_of(folder, STUDY).digest
    for old, new in (
        ('title = "Which crank?"', 'title = "Other"'),
        ("How short", "How long"),
        ("[derive]", "# a remark\n[derive]"),
        ('"40 mm", to', '"0.04 m", to'),
        ('"input.length" =', "input.length ="),
        ("minimise", "maximise"),
    ):
        assert study_of(folder, changed(STUDY, old, new)).digest == digest, new
    assert study_of(folder, STUDY).digest == digest


def test_digest__changes_with_everything_that_results_depend_on(folder):
    digests = {study_of(folder, STUDY).digest}
    changes = [
        ("count = 3", "count = 4"),
        ('"60 mm"', '"61 mm"'),
        ("count = 3}", 'count = 3, spacing = "log"}'),
        ('"0.1 t"', '"0.2 t"'),
        ("reach * input.length", "reach * input.length * 2"),
        ("positions = 48", "positions = 50"),
        ("positions = 48", 'positions = 48\nprecision = "float32"'),
        ("positions = 48", 'positions = 48\nrequire = ["reach < 5"]'),
        ('"excess_work"]', '"excess_work", "ram.stroke_time_ratio"]'),
        ('"excess_work"]', '"excess_work"]\nfields = ["B.x"]'),
        ("reach = {values = [3, 4, 5]}", "reach = {values = [3, 5, 4]}"),
    ]
    for old, new in changes:
        digests.add(study_of(folder, changed(STUDY, old, new)).digest)
    for old, new in (
        ('"200 mm"', '"201 mm"'),
        ('"100 kg"', '"101 kg"'),
        ('"against"', '"along"'),
        ('"1/10"', '"1/11"'),
    ):
        (folder / "press.toml").write_text(changed(SCENE, old, new))
        digests.add(study_of(folder, STUDY).digest)
    assert len(digests) == 1 + len(changes) + 4


def test_digest__changes_with_the_seed_and_with_the_numbers_of_a_csv_file(folder):
    sampled = '"input.length" = {low = "40 mm", high = "60 mm"}\n[sampling]\nmethod = "random"\ncount = 16\nseed = '
    assert varying(folder, sampled + "1").digest != varying(folder, sampled + "2").digest
    text = CSV.replace(",reach", "").replace(",3\n", "\n").replace(",4.25", "")
    (folder / "choice.csv").write_text(text)
    before = varying(folder, "", 'variants = "choice.csv"').digest
    (folder / "choice.csv").write_text(text.replace("55.5", "56"))
    assert varying(folder, "", 'variants = "choice.csv"').digest != before


def test_digest__stays_when_only_words_of_the_scene_change(folder):
    digest = study_of(folder, STUDY).digest
    (folder / "press.toml").write_text(SCENE.replace('title = "Crank press"', 'title = "Press"\nsource = "a book"'))
    assert study_of(folder, STUDY).digest == digest


# What is refused: name | what to change | what into | a mark of the line | key | words of the message.
SLIPS = r"""
misspelt path | "input.length" = | "input.lenght" = | lenght | vary.input.lenght | 'input.length'
nested misspelt path | bodies.ram.mass | bodies.ram.maas | maas | vary.bodies.ram.maas | 'bodies.ram.mass'
path of a text | "input.length" = | "input.pivot" = | input.pivot | vary.input.pivot | not a number
path of a table | "input.length" = | "input" = | "input" | vary.input | not a number
unused parameter | reach = | rich = | rich | vary.rich | not a number
part of a used name | reach = | rea = {values = [1]}\nreach = | rea = | vary.rea | not a number
wrong unit | "60 mm" | "60 kg" | 60 kg | vary.input.length | a length such as
bare number | "60 mm" | 60 | to = 60 | vary.input.length | no unit
decimal comma | "60 mm" | "60,5 mm" | 60,5 | vary.input.length | decimal point
unit of a free parameter | [3, 4, 5] | ["3 foo"] | 3 foo | vary.reach | 3 foo
no count | , count = 3 |  | "input.length" | vary.input.length.count | is missing
count of none | count = 3 | count = 0 | count = 0 | vary.input.length.count | at least 1
one value for two ends | count = 3 | count = 1 | count = 1 | vary.input.length | input.length
unknown key of an axis | count = 3 | cuont = 3 | cuont | vary.input.length.cuont | did you mean 'count'?
unknown spacing | count = 3 | count = 3, spacing = "logarithmic" | logarithmic | vary.input.length.spacing | linear, log
log through zero | "40 mm", to = "60 mm", count = 3 | "0 mm", to = "60 mm", count = 3, spacing = "log" | "0 mm"
    | vary.input.length | 0
no values | [3, 4, 5] | [] | reach = | vary.reach.values | 1
not an axis | {values = [3, 4, 5]} | 3 | reach = 3 | vary.reach | 3
low without sampling | count = 3 | count = 3}\n"gravity" = {low = "0 m/s2", high = "9 m/s2" | gravity | vary.gravity
    | [sampling] | method and count
sampling of nothing | [derive] | [sampling]\nmethod = "sobol"\ncount = 4\n\n[derive] | [sampling] | sampling
    | low and high
unknown method | [derive] | [sampling]\nmethod = "sobel"\ncount = 4\n\n[derive] | sobel | sampling.method
    | random, sobol, latin | 'sobol'
derived and varied | [derive] | [derive]\n"input.length" = "1" | "input.length" = "1" | derive.input.length
    | either varied or derived
derived misspelt | first.length | first.lenght | lenght | derive.groups.slide.first.lenght
    | 'groups.slide.first.length'
unknown name in an expression | reach * input | reech * input | reech | derive.groups.slide.first.length | 'reach'
expression unfinished | reach * input.length | reach * | reach * | derive.groups.slide.first.length | reach *
condition for a number | reach * input | reach < input | reach < input | derive.groups.slide.first.length
    | is a condition | number
Python in an expression | reach * input.length | __import__('os').system('touch stolen') | __import__
    | derive.groups.slide.first.length | allowed
wrong unit in an expression | reach * input.length | '3 foo' | foo | derive.groups.slide.first.length | '3 foo'
number for a condition | positions | require = ["reach + 1"]\npositions | require | require | entry 1 | condition
unknown name in a condition | positions | require = ["reach > 1", "reech > 1"]\npositions | require | require | reech
require of a text | positions | require = "reach > 1"\npositions | require | require | list
odd positions | positions = 48 | positions = 49 | positions | positions | even
text for positions | positions = 48 | positions = "many" | positions | positions | 'many'
precision | positions | precision = "float16"\npositions | float16 | precision | float64, float32
unknown summary | "ram.stroke", | "ram.strok", | [outputs] | outputs | 'ram.strok' is not a summary | 'ram.stroke'
unknown field | [outputs] | [outputs]\nfields = ["B.z"] | [outputs] | outputs | 'B.z' is not a field | 'B.x'
best of nothing | minimise = "excess_work" | minimise = "exces_work" | exces | best.minimise | 'excess_work'
best of two | minimise = "excess_work" | minimise = "excess_work"\nmaximise = "ram.stroke" | [best] | best | either
best where unfinished | > '90 mm' | > | where | best.where | >
best where unknown | ram.stroke > | ram.strok > | where | best.where | 'ram.stroke'
mass for a length | positions | require = ["input.length > '2 kg'"]\npositions | require | require
    | compares a length with a mass | input.length > '2 kg'
bare number in a sum | reach * input.length | reach * input.length + 0.1 | reach * | derive.groups.slide.first.length
    | adds a plain number to a length | '0.1 m'
derived of another dimension | reach * input.length | reach * bodies.ram.mass | reach *
    | derive.groups.slide.first.length | gives a mass, but this is a length
derived bare number | reach * input.length | 0.2 | "0.2" | derive.groups.slide.first.length | '0.2 m' or '0.2 mm'
dimension of a derived number | positions | require = ["2 * groups.slide.first.length > '1 kg'"]\npositions | require
    | require | compares a length with a mass
power that varies | reach * input.length | input.length**reach | **reach | derive.groups.slide.first.length
    | fixed number
several kinds | [3, 4, 5] | [3, "4 mm", "5 kg"] | 4 mm | vary.reach | number and length and mass | one kind
best where a mass | > '90 mm' | > '90 kg' | where | best.where | compares a length with a mass | ram.stroke
best where a bare number | > '90 mm' | > 90 | where | best.where | 90 has no unit: write '90 m' or '90 mm'
best where a number | ram.stroke > '90 mm' | ram.stroke | where | best.where | condition
no such scene | press.toml | pres.toml | scene = | scene | pres.toml | can't be read
scene that is a folder | press.toml | . | scene = | scene | can't be read
no such csv | positions | variants = "choice.csv"\npositions | variants | variants | choice.csv | can't be read
misspelt table | [vary] | [varry] | [varry] | varry | did you mean 'vary'?
not TOML | [vary] | [vary | [vary |  | not valid TOML
"""


def cases(table: str) -> dict[str, list[str]]:
    """Cells of a table by its first column; \\n stands for a line break, a line that begins with a bar goes on."""
    lines = table.strip().replace("\n    | ", " | ").splitlines()
    cells = ([cell.replace("\\n", "\n") for cell in line.split(" | ")] for line in lines)
    return {name: rest for name, *rest in cells}


@pytest.mark.parametrize("slip", cases(SLIPS))
def test_slip__is_refused_with_line_key_and_mend(slip, folder):
    old, new, marker, key, *words = cases(SLIPS)[slip]
    text = changed(STUDY, old, new)
    with pytest.raises(InputError) as caught:
        study_of(folder, text)
    error = caught.value
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


@pytest.mark.parametrize(
    ("csv", "words"),
    [
        ("input.lenght [mm]\n40\n", ("'input.length'",)),
        ("input.length\n40\n", ("no unit",)),
        ("input.length [kg]\n40\n", ("a length such as",)),
        ("input.length [mm]\n40\nfifty\n", ("line 3", "'fifty' is not a number")),
        ("input.length [mm],input.length [mm]\n40,40\n", ("input.length",)),
        ("input.length [mm]\n", ("at least one row",)),
    ],
)
def test_bad_csv_of_variants__is_refused_and_named(csv, words, folder):
    (folder / "choice.csv").write_text(csv)
    with pytest.raises(InputError) as caught:
        study_of(folder, 'scene = "press.toml"\nvariants = "choice.csv"\n')
    assert {(2, "variants")} == {(line, key) for line, key, _ in caught.value.problems}, str(caught.value)
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_condition_of_several_lines__is_refused_with_its_own_line(folder):
    require = """require = [
  "reach < 5",
  "groups.slide.first.length < '1 m'",
  "input.length < bodies.ram.mass",
]
"""
    with pytest.raises(InputError) as caught:
        study_of(folder, changed(STUDY, "positions = 48\n", require))
    assert [(line, key) for line, key, _ in caught.value.problems] == [(7, "require")]
    assert "compares a length with a mass:\n    input.length < bodies.ram.mass" in str(caught.value)


def test_row_of_a_table__is_refused_by_the_names_of_its_columns(folder):
    table = """[forces.punch]
type = "table"
on = "B"
angle = "90 deg"
over_stroke = ["0 mm", "8 mm", "1 mm"]
slider = "ram"
interpolation = "linear"
force = ["0 kN", "1 kN", "2 kN"]
"""
    start, end = SCENE.index("[forces.punch]"), SCENE.index("[flywheel]")
    (folder / "press.toml").write_text(SCENE[:start] + table + SCENE[end:])
    with pytest.raises(
        InputError, match=r"row 3: over_stroke = 0\.001 is below row 2's 0\.008; sort .* by over_stroke"
    ):
        study_of(folder, STUDY)
    (folder / "press.toml").write_text((SCENE[:start] + table + SCENE[end:]).replace(', "2 kN"]', "]"))
    with pytest.raises(InputError, match="over_stroke has 3 rows, force has 2; give one force for every over_stroke"):
        study_of(folder, STUDY)


def test_name_varied_in_two_places__is_refused(folder):
    (folder / "choice.csv").write_text("input.length [mm]\n40\n")
    with pytest.raises(InputError, match=r"input\.length"):
        varying(folder, '"input.length" = {values = ["40 mm"]}', 'variants = "choice.csv"')


def test_several_problems__are_told_at_once(folder):
    text = changed(changed(STUDY, '"60 mm"', '"60 kg"'), "[3, 4, 5]", '["x"]')
    text = changed(text, "reach * input.length", "reech * input.length")
    with pytest.raises(InputError) as caught:
        study_of(folder, text)
    assert [key for _, key, _ in caught.value.problems] == [
        "vary.input.length",
        "vary.reach",
        "derive.groups.slide.first.length",
    ]


def test_error_in_the_scene_s_file__names_that_file_and_its_line(folder):
    (folder / "press.toml").write_text(SCENE.replace('"50 mm"', "50"))
    with pytest.raises(InputError, match=r"^press\.toml, line 13: input\.length: 50 has no unit"):
        study_of(folder, STUDY)


def test_error_in_a_scene_inside_the_study__names_its_line_there(folder):
    inside = SCENE.replace("\n[", "\n[scene.").replace('title = "Crank press"', "[scene]", 1)
    text = 'positions = 48\n[vary]\n"input.length" = {values = ["1 mm"]}\n' + inside
    for old, new, key in (
        ("50 mm", "50 kg", "length"),
        ('joint = "A"', 'joint = "Z"', "joint"),
        ("mass =", "maas =", "maas"),
    ):
        broken = changed(text, old, new)
        with pytest.raises(InputError) as caught:
            study_of(folder, broken)
        line = next(i for i, row in enumerate(broken.splitlines(), 1) if new in row)
        assert caught.value.problems[0][0] == line, str(caught.value)
        assert caught.value.problems[0][1].endswith(key)


def test_unknown_study__is_refused_with_what_there_is(folder):
    with pytest.raises(InputError, match="no such file, and no bundled study"):
        find_study("crank_pres")
