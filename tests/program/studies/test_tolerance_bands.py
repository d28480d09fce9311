"""Derivatives and tolerance bands as a study asks for them: columns, units, texts, pictures, and what is refused."""

import math
from pathlib import Path

import numpy as np
import pytest
from commands import done
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from press_texts import slider_crank_text
from slips import cases

from engine import Verdict
from sweeps import InputError, Study, SweepResult, read_study, run_study
from sweeps.pictures.style import VERMILION
from sweeps.pictures.sweep.maps import curves
from sweeps.pictures.sweep.result_pictures import sweep_data
from sweeps.run.blocks import evaluate_variants, largest_block
from sweeps.study import sensitivity

EPS = np.finfo(float).eps
SCENE = f"""\
{slider_crank_text('y = "0 mm"')}
[bodies.ram_body]
link = "ram"
mass = "2 kg"
"""
# The same paths and the same questions in all studies of a kind: few kernels serve them.
VARY = """
[vary]
"input.length" = {values = ["40 mm", "50 mm", "60 mm", "300 mm"]}
ratio = {values = [4, 5]}

[derive]
"groups.drive.first.length" = "ratio * input.length"

[outputs]
summaries = ["ram.stroke", "ram.stroke_high", "reduced_inertia.mean"]
"""
DERIVATIVES = """derivatives = ["ram.stroke_high by input.length", "ram.stroke_high by ratio",
    "ram.stroke_high by groups.drive.first.length", "reduced_inertia.mean by bodies.ram_body.mass"]
"""
TOLERANCES = """
[tolerances]
"input.length" = "0.1 mm"
"groups.drive.first.length" = {plus_minus = "0.4 mm", distribution = "normal"}
"""
HEAD = 'scene = "scene.toml"\npositions = 48\nrequire = ["input.length < \'250 mm\'"]\n'
KEPT = slice(0, 6)


def study_of(folder: Path, rest: str, scene: str = SCENE) -> Study:
    (folder / "scene.toml").write_text(scene)
    (folder / "study.toml").write_text(HEAD + rest)
    return read_study(folder / "study.toml")


def swept(folder: Path, text: str) -> SweepResult:
    return SweepResult(run_study(study_of(folder, text), folder / "study.h5"))


def one_tolerance(path: str, half: str) -> str:
    return f'[outputs]\nsummaries = ["ram.stroke"]\n[tolerances]\n"{path}" = "{half}"\n'


ALL = VARY + DERIVATIVES + TOLERANCES


@pytest.fixture(scope="module")
def result(tmp_path_factory) -> SweepResult:
    return swept(tmp_path_factory.mktemp("bands"), ALL)


def test_derivatives__take_along_what_is_derived(result):
    c = result.columns
    length, ratio = c["input.length"][KEPT], c["ratio"][KEPT]
    # The ram's highest place is r + l, here with l = ratio · r; the interpolation between positions near it is off by
    # (2π/48)⁴/384 of some crank lengths, a share of 1e-6, and its figure says so.
    for by, exact in (("input.length", 1 + ratio), ("ratio", length), ("groups.drive.first.length", 1 + 0 * length)):
        name = f"ram.stroke_high.by.{by}"
        np.testing.assert_allclose(c[name][KEPT], exact, rtol=1e-5)
        assert (np.abs(c[name][KEPT] - exact) <= c[f"{name}_error"][KEPT]).all()
    share = c["reduced_inertia.mean"][KEPT] / 2
    np.testing.assert_allclose(c["reduced_inertia.mean.by.bodies.ram_body.mass"][KEPT], share, rtol=64 * EPS)


def test_bands__worst_case_and_root_of_the_sum_of_squares(result):
    c = result.columns
    # Numbers derived from one with a tolerance don't follow it.
    for name, parts in (("ram.stroke", (0.0002, 0.0)), ("ram.stroke_high", (0.0001, 0.0004))):
        for ending, exact in (("worst_case", sum(parts)), ("rss", math.hypot(*parts))):
            band, error = (c[f"{name}.tolerance_{ending}{end}"][KEPT] for end in ("", "_error"))
            np.testing.assert_allclose(band, exact, rtol=1e-5)
            assert (np.abs(band - exact) <= error).all()
            assert (error < 1e-3 * exact).all()


def test_bands__hold_all_machines_within_tolerances(result, tmp_path):
    c, random = result.columns, np.random.default_rng(3)
    study = study_of(tmp_path, ALL)
    machine = study.sensitivity.machine
    count = 1000
    made = {path: np.full(count, c[path][2] if path in c else study.fixed[path]) for path in machine.varied}
    for tolerance in study.sensitivity.tolerances:
        made[tolerance.path] = made[tolerance.path] + tolerance.half_width * random.uniform(-1, 1, count)
    summaries = machine.evaluate(made).summaries
    for name in ("ram.stroke", "ram.stroke_high", "reduced_inertia.mean"):
        off = np.abs(summaries[name] - c[name][2])
        band, error = (c[f"{name}.tolerance_worst_case{end}"][2] for end in ("", "_error"))
        assert off.max() <= band + error
        # Of a thousand machines one comes near two limits at once.
        assert off.max() >= 0.9 * band


def test_variants_that_fail__have_their_verdict_and_no_number(result):
    c = result.columns
    assert c["status"][6:].tolist() == [Verdict.DROPPED] * 2
    assert c["status_by.ratio"].tolist() == [Verdict.OK] * 6 + [Verdict.DROPPED] * 2
    for name in result.summaries:
        assert np.isnan(c[name][6:]).all()


def test_blocks__don_t_change_a_bit(result, tmp_path, monkeypatch):
    study = study_of(tmp_path, ALL)
    monkeypatch.setattr(sensitivity, "TOGETHER", 1)
    machine = study.machine()
    parts = [evaluate_variants(study, *study.values(i, i + 2), machine.new_buffer(2)) for i in range(0, 8, 2)]
    for column in result.file.described:
        found = np.concatenate([part[column.name] for part in parts])
        assert found.tobytes() == result.columns[column.name].tobytes(), column.name


def test_result__is_listed_sorted_and_chosen_by_them(result):
    path = str(result.path)
    where = "ram.stroke_high.by.ratio > '45 mm' and ram.stroke.tolerance_rss < '1 mm'"
    shown = done("show", path, "--where", where, "--sort", "ram.stroke_high.by.ratio")
    assert "4 variants meet the condition" in shown
    assert "reduced_inertia.mean.by.bodies.ram_body.mass" in shown
    exported = result.path.with_suffix(".csv")
    done("export", path, "--to", str(exported))
    header = exported.read_text().splitlines()[0]
    assert "ram.stroke_high.by.ratio [mm]" in header
    assert "ram.stroke.tolerance_worst_case [mm]" in header


def test_checked_study__names_what_is_asked_and_counts_it_in_its_blocks(tmp_path):
    plain, study = study_of(tmp_path, VARY), study_of(tmp_path, ALL)
    # Four numbers, of which one has a tolerance and a derivative both.
    assert (study.sensitivity.evaluations, plain.sensitivity.evaluations) == (4 * 12, 0)
    parts = (VARY, VARY + DERIVATIVES, VARY + TOLERANCES, ALL)
    assert len({study_of(tmp_path, part).digest for part in parts}) == 4
    assert largest_block(study) <= largest_block(plain)
    checked = done("check", str(tmp_path / "study.toml"))
    assert "ram.stroke_high.by.ratio" in checked
    assert "reduced_inertia.mean.tolerance_rss" in checked


def test_robust_design__is_what_best_may_ask(tmp_path):
    best = '\n[best]\nminimise = "ram.stroke_high.tolerance_rss"\nwhere = "ram.stroke_high.by.ratio > \'45 mm\'"\n'
    found = swept(tmp_path, ALL + best)
    values = found.columns["ram.stroke_high.tolerance_rss"]
    assert found.best() == np.nanargmin(np.where(found.columns["input.length"] > 0.045, values, np.nan))
    # A band asks for its summary by itself.
    alone = VARY.replace('summaries = ["ram.stroke", "ram.stroke_high", ', "summaries = [") + TOLERANCES
    assert "ram.stroke" in study_of(tmp_path, alone + '[best]\nminimise = "ram.stroke.tolerance_rss"\n').summaries


def test_nonlinear_number__error_of_the_band_holds_the_second_order(tmp_path):
    # On the crank's axis the stroke depends on the guide's offset by its square alone.
    found = swept(tmp_path, one_tolerance("guides.way.y", "10 mm")).columns
    exact = math.sqrt(0.25**2 - 0.01**2) - math.sqrt(0.15**2 - 0.01**2) - 0.1
    assert found["ram.stroke.tolerance_worst_case"][0] == pytest.approx(0, abs=1e-9)
    # Besides the second order the figure holds what strokes at their positions may be off by, some 1e-6 of 0.1 m.
    assert 0.999 * exact <= found["ram.stroke.tolerance_worst_case_error"][0] <= 1.02 * exact


@pytest.mark.parametrize("half", [20, 43, 45])
def test_three_tolerances__error_of_the_band_holds_their_joint_effect(half, tmp_path):
    """Of the 130 mm by which the rod is longer than crank and offset, three tolerances leave little, or nothing."""
    three = one_tolerance("guides.way.y", f"{half} mm").replace("ram.stroke", "drive.transmission_angle")
    three += f'"input.length" = "{half} mm"\n"groups.drive.first.length" = "{half} mm"\n'
    study = study_of(tmp_path, three, SCENE.replace('way = {y = "0 mm"}', 'way = {y = "20 mm"}'))
    c = SweepResult(run_study(study, tmp_path / "study.h5")).columns
    band, error = (c[f"drive.transmission_angle.tolerance_worst_case{end}"][0] for end in ("", "_error"))
    if 3 * half > 130:
        assert np.isnan(band)
    else:
        change = math.acos(0.07 / 0.2) - math.acos((0.07 + 2e-3 * half) / (0.2 - 1e-3 * half))
        assert abs(change - band) <= error <= 1.5 * abs(change - band)


def test_tolerance_beyond_what_can_be_assembled__no_band(tmp_path):
    found = swept(tmp_path, one_tolerance("guides.way.y", "160 mm")).columns
    assert found["ram.stroke"][0] == pytest.approx(0.1)
    assert np.isnan(found["ram.stroke.tolerance_worst_case"][0])


def test_curves__show_bands_about_their_summary(tmp_path):
    vary = '[vary]\n"input.length" = {from = "40 mm", to = "60 mm", count = 5}\n'
    data = sweep_data(swept(tmp_path, vary + one_tolerance("input.length", "1 mm")), ())[0]
    assert list(data.summaries) == ["ram.stroke"]
    figure = Figure()
    curves(figure, data, "input.length", ["ram.stroke"])
    bands = [b for b in figure.axes[0].collections if np.allclose(b.get_facecolor()[0, :3], to_rgb(VERMILION))]
    labels = ["within tolerances, worst case", "within tolerances, root of sum of squares"]
    assert [b.get_label() for b in bands] == labels
    # Strokes of 80 to 120 mm, ± 2 mm.
    heights = bands[0].get_paths()[0].get_extents()
    assert (heights.ymin, heights.ymax) == (pytest.approx(78, rel=1e-5), pytest.approx(122, rel=1e-5))


# Name | what the study says besides | line and key | words of the message.
REFUSED = cases(r"""
not by | derivatives = ["ram.stroke of input.length"] | line 14: outputs.derivatives:
    | write a summary, 'by' and a number, such as 'excess_work by input.length'
summary | derivatives = ["ram.strok by input.length"] | line 14: outputs.derivatives:
    | 'ram.strok' is not a summary of this scene; did you mean 'ram.stroke'
number | derivatives = ["ram.stroke by input.lenght"] | line 14: outputs.derivatives:
    | 'input.lenght' is not a number that the scene gives; did you mean 'input.length' or 'input.speed'
mode | derivatives = ["ram.stroke by groups.drive.mode"] | line 14: outputs.derivatives:
    | 'groups.drive.mode' is one of [1, -1]: it has no derivative
place | derivatives = ["ram.slide.max_at by input.length"] | line 14: outputs.derivatives:
    | is the position of an extreme, which may jump
tolerance | [tolerances]\n"input.lenght" = "1 mm" | tolerances.input.lenght: is not a number
unit | [tolerances]\n"input.length" = "1 kg" | line 15: tolerances.input.length:
""")


@pytest.mark.parametrize("case", REFUSED)
def test_refusals__name_key_line_and_mend(case, tmp_path):
    text, *words = REFUSED[case]
    with pytest.raises(InputError) as refused:
        study_of(tmp_path, f"{VARY}{text}\n")
    assert all(word in str(refused.value) for word in words)
