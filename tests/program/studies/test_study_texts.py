"""Studies as texts: what varies, what follows from it, what is dropped, and the name of their content."""

import itertools
from pathlib import Path

import numpy as np
import pytest
from each_case import each
from press_texts import PRESS_WITH_FLYWHEEL as SCENE
from slips import changed
from study_samples import STUDY, study_of, varying

from sweeps import Study, read_study
from sweeps.text.input_files import InputError


def column(study: Study, name: str) -> list[float]:
    return study.values(0, study.design.size)[0][name].tolist()


# What varies


def test_grid__is_the_product_of_the_axes_the_last_fastest(study_folder):
    study = study_of(study_folder, STUDY)
    grid = list(itertools.product([0.04, 0.05, 0.06], [50.0, 100.0], [3.0, 4.0, 5.0]))
    values, drop = study.values(0, study.design.size)
    assert study.design.size == len(grid) == 18
    assert not drop.any()
    for i, name in enumerate(("input.length", "bodies.ram.mass", "reach")):
        assert values[name].tolist() == [point[i] for point in grid]
    rods = [length * reach for length, _, reach in grid]
    np.testing.assert_allclose(values["groups.slide.first.length"], rods, rtol=4e-16, atol=0)


def test_parameters__are_the_varied_and_the_derived_and_free_ones_are_no_paths(study_folder):
    study = study_of(study_folder, STUDY)
    assert study.parameters == ("input.length", "bodies.ram.mass", "reach", "groups.slide.first.length")
    assert study.paths == ("input.length", "bodies.ram.mass", "groups.slide.first.length")
    assert [study.unit(name) for name in study.parameters] == ["m", "kg", "1", "m"]


def test_free_parameters__have_the_units_of_their_values_and_expressions(study_folder):
    study = varying(
        study_folder,
        'play = {values = [0, "2 mm"]}\n'
        '"input.length" = {values = ["40 mm"]}\n'
        '[derive]\npace = "input.speed * (input.length + play)"\nturn = "2 * input.speed"\nroot = "sqrt(play)"\n'
        'energy = "bodies.ram.mass * pace**2"',
        "require = [\"energy < '1 kJ' and root > 0 and turn > 0\"]",
    )
    assert [study.unit(n) for n in ("play", "pace", "turn", "root", "energy")] == ["m", "m s-1", "rad s-1", "", "N m"]


@each(
    "axis, expected",
    [
        ('{from = "40 mm", to = "60 mm", count = 5}', [0.04, 0.045, 0.05, 0.055, 0.06]),
        ('{from = "60 mm", to = "4 cm", count = 3}', [0.06, 0.05, 0.04]),
        ('"40 mm to 6 cm, 5"', [0.04, 0.045, 0.05, 0.055, 0.06]),
        ('["40 mm", "6 cm"]', [0.04, 0.06]),
        ('{from = "40 mm", to = "40 mm", count = 1}', [0.04]),
        ('{from = "1 mm", to = "1 m", count = 4, spacing = "log"}', [1e-3, 1e-2, 1e-1, 1.0]),
        ('{values = ["40 mm", "0.05 m", "2 in"]}', [0.04, 0.05, 0.0508]),
        ("{values = [1, -1]}", [1.0, -1.0]),
    ],
)
def test_axis__has_the_values_written(axis, expected, study_folder):
    name = "groups.slide.mode" if expected[-1] == -1 else "input.length"
    found = column(varying(study_folder, f'"{name}" = {axis}'), name)
    # One rounding each for the step, its multiple and the sum; a ratio's power adds a few.
    np.testing.assert_allclose(found, expected, rtol=4e-15)


@each(
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
def test_path__may_be_quoted_or_nested(written, study_folder):
    study = varying(study_folder, written)
    assert study.paths == ("input.length",)
    assert column(study, "input.length") == [0.04, 0.06]


CSV = '"input.length [mm]",bodies.ram.mass [kg],reach\n40,50,3\n55.5,1e2,4.25\n'


def test_variants_of_a_csv_file__go_together_and_cross_the_other_axes(study_folder):
    (study_folder / "choice.csv").write_text(CSV)
    vary = '"forces.punch.force" = {values = ["1 kN", "2 kN"]}'
    derive = '[derive]\n"groups.slide.first.length" = "reach*input.length"'
    study = varying(study_folder, f"{vary}\n{derive}", 'variants = "choice.csv"')
    assert study.design.size == 4
    rows = zip(*(column(study, name) for name in ("input.length", "bodies.ram.mass", "reach")), strict=True)
    assert set(rows) == {(0.04, 50.0, 3.0), (0.0555, 100.0, 4.25)}
    assert sorted(column(study, "forces.punch.force")) == [1e3, 1e3, 2e3, 2e3]


@each("method", ["random", "sobol", "latin"])
def test_sampling__draws_between_the_ends_together(method, study_folder):
    study = varying(
        study_folder,
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


def test_scene_as_a_study__is_a_single_variant_with_all_summaries(study_folder):
    study = read_study(study_folder / "press.toml")
    assert (study.design.size, study.paths, study.title) == (1, (), "Crank press")
    assert {"ram.stroke", "slide.transmission_angle", "flywheel_wittenbauer", "required_power"} <= set(study.summaries)


def test_scene_inside_the_study__is_the_scene(study_folder):
    inside = SCENE.replace("\n[", "\n[scene.").replace('title = "Crank press"', '[scene]\ntitle = "Crank press"', 1)
    text = STUDY.replace('scene = "press.toml"\n', "") + inside
    assert study_of(study_folder, text).scene == study_of(study_folder, STUDY).scene


# What follows and what is dropped


def test_derived_numbers__build_on_each_other_in_order(study_folder):
    study = varying(
        study_folder,
        'reach = {values = [3, 4]}\n[derive]\nshort = "input.length / 2"\n"input.length" = "short + \'10 mm\'"\n'
        '"groups.slide.first.length" = "reach * input.length"',
    )
    # input.length in the last expression is the derived one, 35 mm.
    np.testing.assert_allclose(column(study, "groups.slide.first.length"), [0.105, 0.14], rtol=1e-15)


@pytest.mark.parametrize("first", ["input.length", "half"])
def test_number_derived_further_below__is_not_read_before(study_folder, first):
    lines = f'"groups.slide.first.length" = "4 * {first}"\n"{first}" = "reach * \'8 mm\'"\n'
    text = f"reach = {{values = [3]}}\n[derive]\n{lines}"
    with pytest.raises(InputError, match=f"{first} is derived further below: move its line above this one"):
        varying(study_folder, text)


def test_require__drops_the_variants_that_fail_any_condition(study_folder):
    first, second = "groups.slide.first.length < '200 mm'", "not (bodies.ram.mass == '50 kg' and reach < 4)"
    text = changed(STUDY, "positions = 48", f'positions = 48\nrequire = ["{first}", "{second}"]')
    study = study_of(study_folder, text)
    values, drop = study.values(0, 18)
    long = values["groups.slide.first.length"] >= 0.2
    light = (values["bodies.ram.mass"] == 50) & (values["reach"] < 4)
    assert drop.tolist() == (long | light).tolist()
    assert 0 < drop.sum() < 18


# The name of a study's content


def test_digest__stays_when_only_words_change(study_folder):
    digest = study_of(study_folder, STUDY).digest
    for old, new in (
        ('title = "Which crank?"', 'title = "Other"'),
        ("How short", "How long"),
        ("[derive]", "# a remark\n[derive]"),
        ('"40 mm", to', '"0.04 m", to'),
        ('"input.length" =', "input.length ="),
        ("minimise", "maximise"),
    ):
        assert study_of(study_folder, changed(STUDY, old, new)).digest == digest, new
    words = changed(SCENE, 'title = "Crank press"', 'title = "Press"\nsource = "a book"')
    (study_folder / "press.toml").write_text(words)
    assert study_of(study_folder, STUDY).digest == digest


def test_digest__changes_with_everything_that_results_depend_on(study_folder):
    digests = {study_of(study_folder, STUDY).digest}
    changes = [
        ("count = 3", "count = 4"),
        ('"60 mm"', '"61 mm"'),
        ("count = 3}", 'count = 3, spacing = "log"}'),
        ('"0.1 t"', '"0.2 t"'),
        ("reach * input.length", "reach * input.length * 2"),
        ("positions = 48", "positions = 50"),
        ("positions = 48", 'positions = 48\nfield_precision = "float32"'),
        ("positions = 48", 'positions = 48\nrequire = ["reach < 5"]'),
        ('"excess_work"]', '"excess_work", "ram.stroke_time_ratio"]'),
        ('"excess_work"]', '"excess_work"]\nfields = ["B.x"]'),
        ("reach = {values = [3, 4, 5]}", "reach = {values = [3, 5, 4]}"),
    ]
    for old, new in changes:
        digests.add(study_of(study_folder, changed(STUDY, old, new)).digest)
    of_scene = {"200 mm": "201 mm", "100 kg": "101 kg", "against": "along", "1/10": "1/11"}
    for old, new in of_scene.items():
        (study_folder / "press.toml").write_text(changed(SCENE, f'"{old}"', f'"{new}"'))
        digests.add(study_of(study_folder, STUDY).digest)
    assert len(digests) == 1 + len(changes) + 4


def test_digest__changes_with_the_seed_and_with_the_numbers_of_a_csv_file(study_folder):
    sampled = '"input.length" = {low = "40 mm", high = "60 mm"}\n[sampling]\nmethod = "random"\ncount = 16\nseed = '
    assert varying(study_folder, sampled + "1").digest != varying(study_folder, sampled + "2").digest
    text = CSV.replace(",reach", "").replace(",3\n", "\n").replace(",4.25", "")
    (study_folder / "choice.csv").write_text(text)
    before = varying(study_folder, "", 'variants = "choice.csv"').digest
    (study_folder / "choice.csv").write_text(text.replace("55.5", "56"))
    assert varying(study_folder, "", 'variants = "choice.csv"').digest != before


# Studies that are refused: the message names the file, the line, the key, what is wrong and the mend.


def refused(folder: Path, text: str) -> InputError:
    with pytest.raises(InputError) as caught:
        study_of(folder, text)
    return caught.value


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


DAMPER = '[springs.s]\nbetween = ["O", "B"]\ndamping = "10 N s/m"\n'


def test_number_that_means_nothing_there__does_not_vary(tmp_path):
    (tmp_path / "scene.toml").write_text(f"{SCENE}\n{DAMPER}", encoding="utf8")
    text = 'scene = "scene.toml"\n[{}]\n"springs.s.free_length" = {}\n[outputs]\nsummaries = ["ram.stroke"]\n'
    for table, given in (("vary", '["1 m"]'), ("derive", "'1 m'")):
        message = str(refused(tmp_path, text.format(table, given)))
        assert "stiffness" in message
        assert f"{table}.springs.s.free_length: can't vary in this scene" in message


def test_number_that_another_one_gives_a_meaning__varies_with_it(tmp_path):
    (tmp_path / "scene.toml").write_text(f"{SCENE}\n{DAMPER}", encoding="utf8")
    axes = '"springs.s.free_length" = "1 m to 2 m, 3"\n"springs.s.stiffness" = "10 N/m to 20 N/m, 3"\n'
    assert study_of(tmp_path, f'scene = "scene.toml"\npositions = 48\n\n[vary]\n{axes}').design.size == 9
