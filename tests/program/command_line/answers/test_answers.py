"""What commands answer: error estimates where they matter."""

import math
import re
from pathlib import Path

import pytest
from commands import done, said
from each_case import each
from element_samples import JACK, scene

from sweeps import write_scene
from sweeps.report.sweep_result import SweepResult

STUDY = """\
title = "Jack"
scene = "jack.toml"
[vary]
"elements.jack.load" = {{ values = ["10 kN", "20 kN", "30 kN"] }}
"elements.jack.mean_diameter" = {{ values = ["33 mm", "{diameter}"] }}
[outputs]
summaries = ["jack.raise_moment", "jack.lead_angle"]
[best]
minimise = "jack.raise_moment"
where = "{where}"
"""


@pytest.fixture
def jack(folder):
    """A function that runs the study of a jack, and returns the answer."""
    Path("jack.toml").write_text(write_scene(scene(jack=JACK)))

    def run(diameter: str, where: str, *options: str) -> str:
        Path("study.toml").write_text(STUDY.format(diameter=diameter, where=where))
        return done("run", "study.toml", "--no-plots", "--replace", "--out", "r.h5", *options)

    return run


def row(text: str, name: str) -> str:
    """The line of a summary in an answer."""
    return next(line for line in text.splitlines() if line.strip().startswith(name))


def test_errors_option__shows_all_of_one_command_only(jack):
    assert "±" not in jack("30 mm", "jack.raise_moment > '1 N m'")
    assert re.search(
        r"jack.lead_angle +→ +[\d.]+ ± \d+e-\d+ °", jack("30 mm", "jack.raise_moment > '1 N m'", "--errors")
    )
    assert "±" not in done("show", "r.h5")
    assert "±" in done("show", "r.h5", "--errors")


def test_errors__are_shown_of_a_tie(jack):
    text = jack("33 mm", "jack.raise_moment > '1 N m'")
    assert re.search(r"Answer: minimum jack.raise_moment .*: [\d.]+ ± \d+e-\d+ N·m, variant 0:", text)
    assert "Another variant ties" in text
    assert "±" not in row(text, "jack.lead_angle")
    listed = done("show", "r.h5").splitlines()
    assert ["±" in line for line in listed if re.match(r"\d +\d", line)][:3] == [True, True, False]


def test_errors__are_shown_where_a_condition_depends_on_them(folder):
    """A slot's block presses square on it: 90° to the rounding of an inverse cosine, √ε, far below a millionth."""
    done("new", "crank_shaper", "--out", "shaper.toml")
    study = """scene = "shaper.toml"
[vary]
"input.length" = { values = ["80 mm", "90 mm"] }
[outputs]
summaries = ["ram.stroke", "slot.transmission_angle"]
[best]
maximise = "ram.stroke"
where = "WHERE"
"""
    for where, shown in (("slot.transmission_angle >= '90 deg'", True), ("slot.transmission_angle >= '89 deg'", False)):
        Path("study.toml").write_text(study.replace("WHERE", where))
        text = done("run", "study.toml", "--no-plots", "--replace", "--out", "r.h5")
        assert ("±" in row(text, "slot.transmission_angle")) == shown, text


# Answers first


def test_answers_of_a_press__are_what_its_user_asks_in_the_order_of_reading(press_folder):
    text = done("run", "press.toml", "--no-plots", "--out", "r.h5")
    names = [line.split()[0] for line in text.splitlines() if "→" in line]
    motion = ["ram.stroke", "ram.stroke_time_ratio", "slide.transmission_angle", "ram.velocity.peak"]
    forces = ["input.reaction.peak", "slide.first.reaction.peak", "slide.inner.reaction.peak"]
    drive = ["input_moment.peak", "required_drive_moment", "required_power", "excess_work"]
    assert [name for name in names if name in {*motion, *forces, *drive}] == [*motion, *forces, *drive]
    # At the near dead centre the ram's acceleration is r ω² (1 + r/l).
    speed = 2 * math.pi
    peak = 0.05 * speed**2 * (1 + 50 / 200)
    assert re.search(rf"→ +{peak:.5g} m/s² +peak acceleration of slider ram", row(text, "ram.acceleration.peak"))
    assert "stroke of slider ram" in row(text, "ram.stroke ")


def test_checks_and_further_results__need_all(press_folder):
    text = done("run", "press.toml", "--no-plots", "--out", "r.h5")
    hidden = ("equilibrium_residual", "input_moment_disagreement", "error_magnification")
    assert not any(name in text for name in hidden)
    assert f"{len(hidden) + 1} more with `sweeps show r.h5 --all`." in text
    assert all(name in done("show", "r.h5", "--all") for name in hidden)
    assert all(name in done("run", "press.toml", "--no-plots", "--out", "r.h5", "--json") for name in hidden)
    assert not any(name in done("show", "r.h5") for name in hidden)
    checked = done("check", "press.toml")
    assert not any(name in checked for name in hidden)
    assert f"  {len(hidden) + 1} more with --all\n" in checked
    assert all(f"  {name}\n" in done("check", "press.toml", "--all") for name in hidden)


def test_helper_numbers__need_all_unless_a_condition_limits_them(jack):
    Path("study.toml").write_text(STUDY.format(diameter="30 mm", where="jack.raise_moment > '1 N m'"))
    study = Path("study.toml").read_text()
    derive = '[derive]\nhelper = "2 * elements.jack.load"\nlimited = "1.5 * helper"\n'
    require = """require = ["limited < '70 kN'"]\n"""
    Path("study.toml").write_text(require + study.replace("[outputs]", f"{derive}[outputs]"))
    text = done("run", "study.toml", "--no-plots", "--out", "r.h5")
    assert "limited  " in text
    assert "helper" not in text
    assert "helper" in done("show", "r.h5", "--all")
    assert "helper" not in done("show", "r.h5")


def test_check_that_a_study_limits__is_shown(press_folder):
    study = Path("study.toml").read_text().replace('where = "', 'where = "equilibrium_residual < 1 and ')
    study = study.replace('"excess_work"]', '"excess_work", "equilibrium_residual"]')
    Path("check.toml").write_text(study)
    assert "equilibrium_residual" in done("run", "check.toml", "--no-plots", "--out", "c.h5")
    assert "equilibrium_residual" in done("check", "check.toml")


# No answer


def no_answer(where: str, *options: str) -> str:
    """What a run says, with exit code 1, of a jack's study that no variant answers."""
    Path("study.toml").write_text("".join(options) + STUDY.format(diameter="30 mm", where=where))
    answer = said("run", "study.toml", "--no-plots", "--replace", "--out", "r.h5")
    assert answer.exit_code == 1, answer.output
    shown = said("show", "r.h5")
    assert shown.exit_code == 1
    lines = answer.stdout[answer.stdout.index("No variant") : answer.stdout.index("Files (")]
    assert lines in shown.stdout
    return lines


def test_no_answer__counts_what_each_condition_excludes_and_names_the_closest(jack):
    jack("30 mm", "jack.raise_moment > '1 N m'")
    moments = SweepResult(Path("r.h5")).columns["jack.raise_moment"]
    # The torque grows with the load: the least is that of 10 kN on 30 mm, above a limit of four fifths of it by 25 %.
    assert moments.argmin() == 1
    limit = 0.8 * moments[1]
    text = no_answer(f"jack.raise_moment <= '{limit:.17g} N m'")
    assert text.startswith("No variant meets all conditions. Of 6 variants, the conditions exclude:")
    assert f"jack.raise_moment <= '{limit:.17g} N m': 6" in text
    assert f"Closest: variant 1, which exceeds jack.raise_moment ≤ {limit:.17g} N m by 25 %." in text


def test_closest__keeps_to_choices_of_parameters(jack):
    jack("30 mm", "jack.raise_moment > '1 N m'")
    moments = SweepResult(Path("r.h5")).columns["jack.raise_moment"]
    # Of variants with 30 kN, 4 and 5, though those with 10 kN miss the torque by less.
    text = no_answer(f"elements.jack.load == '30 kN' and jack.raise_moment < '{moments[0] * 0.9:.6g} N m'")
    assert "Closest: variant 5, which exceeds jack.raise_moment < " in text
    assert "elements.jack.load == '30 kN': 4" in text


def test_all_dropped__names_the_closest_to_what_is_required(jack):
    text = no_answer("jack.raise_moment > '1 N m'", """require = ["elements.jack.load >= '40 kN'"]\n""")
    assert "Closest: variant 4, which falls short of elements.jack.load ≥ 40 kN by 25 %." in text


# Ends of ranges


def test_best_at_the_end_of_a_range__is_reported(jack):
    # The torque grows with the load; a diameter of two listed values is a choice, and so is a fixed load.
    end = "At the end of its range: elements.jack.load = 10 kN (minimum of 10 kN … 30 kN); a wider range may give"
    assert end in jack("30 mm", "jack.raise_moment > '1 N m'")
    assert end in done("show", "r.h5")
    assert "At the end" not in jack("30 mm", "elements.jack.load == '10 kN'")
    assert "At the end" not in jack("30 mm", "elements.jack.load > '15 kN'")


@each("least, end", [("10.1 kN", " (near the minimum of "), ("10.5 kN", "")])
def test_best_of_a_sample__is_reported_within_a_hundredth_of_its_range(jack, least, end):
    # The torque grows with the load, so the best is the first above the limit: of 1024 samples of 20 kN one every
    # 0.02 kN, and 1 % of the range is 0.2 kN.
    jack("30 mm", "jack.raise_moment > '1 N m'")
    Path("sample.toml").write_text(
        f"""scene = "jack.toml"
        vary = {{ "elements.jack.load" = {{ low = "10 kN", high = "30 kN" }} }}
        sampling = {{ method = "sobol", count = 1024 }}
        outputs = {{ summaries = ["jack.raise_moment"] }}
        best = {{ minimise = "jack.raise_moment", where = "elements.jack.load >= '{least}'" }}"""
    )
    text = done("run", "sample.toml", "--no-plots")
    assert ("At the end of its range: elements.jack.load = 10" in text) == bool(end)
    assert end in text
