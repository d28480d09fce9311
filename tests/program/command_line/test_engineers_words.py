"""Quantities, keys and forces found by the words an engineer uses, by `sweeps quantities` and `sweeps help`."""

import re
from pathlib import Path

import pytest
from commands import done, refused, row
from each_case import each
from machines import frame, rrp, rrr, slider_crank

from engine import AskError, Machine, Scene, described_dimension, nearest_names, scene_numbers
from sweeps import read_scene
from sweeps.report.help.key_help import key_text
from sweeps.study.bundled import STUDIES
from sweeps.study.study_text import StudyText
from sweeps.text.templates import bundled_templates, templates

COMPRESSOR, SHAPER = "flywheels/scenes/compressor.toml", "flywheels/scenes/shaper.toml"
REDUCER = "gears_and_cams/scenes/planetary_reducer.toml"
PRESS_MOTOR, BEARINGS = "motion/scenes/press_drive.toml", "friction/scenes/engine_bearings.toml"

# A machine, what its user types, and a quantity that it finds.
ASKED = [
    (COMPRESSOR, "torque", "input_moment"),
    (COMPRESSOR, "main bearing", "input.reaction"),
    (COMPRESSOR, "crankpin", "drive.first.reaction"),
    (COMPRESSOR, "wrist pin", "drive.inner.reaction"),
    (COMPRESSOR, "thrust", "drive.second.reaction"),
    (COMPRESSOR, "efficiency", "air.volumetric_efficiency"),
    (COMPRESSOR, "counterweight", "shaking_force"),
    (COMPRESSOR, "equivalent inertia", "reduced_inertia"),
    (COMPRESSOR, "coefficient of fluctuation", "speed_fluctuation"),
    (COMPRESSOR, "dead centre", "piston.stroke_low"),
    (SHAPER, "quick return", "ram.stroke_time_ratio"),
    (SHAPER, "dwell", "ram.stroke"),
    (REDUCER, "Kutzbach", "reducer.mobility"),
    (REDUCER, "Willis", "reducer.arm.basic_ratio_of_sun_to_ring"),
    (PRESS_MOTOR, "motor torque", "start.motor_moment_peak"),
    (BEARINGS, "efficiency", "mechanical_efficiency"),
]


@each("scene, words, name", ASKED)
def test_word__finds_the_quantity(scene, words, name):
    found = {line.split()[0] for line in done("quantities", str(STUDIES / scene), *words.split()).splitlines()}
    assert name in found


@each(
    "words, found",
    [
        ("torque", "  moments "),
        ("quick return", "`sweeps guide gears`"),
        ("counterweight", "`sweeps guide balancing`"),
        ("units", 'value: "mm" or "SI" or "US"'),
        ("dwell", 'type = "dwell"'),
        ("toggle", "`sweeps run toggle_press`"),
        ("emergency stop", "`sweeps run emergency_stop`"),
        ("slider crank", "`sweeps new slider_crank`"),
        ("critical speed", "`sweeps guide elastic`"),
        ("torsional vibration", "`sweeps guide elastic`"),
    ],
)
def test_help__searches_keys_and_guide_for_words(words, found):
    assert found in done("help", *words.split())


def test_crankpin__is_no_other_pin():
    lines = done("quantities", str(STUDIES / COMPRESSOR), "crankpin")
    assert "drive.first.reaction" in lines
    assert "drive.inner.reaction" not in lines


def test_word_of_no_quantity__is_answered_with_where_to_search(press_folder):
    assert "`sweeps help units` searches keys and guide" in refused("quantities", "press.toml", "units")


def test_misnamed_quantity__is_answered_with_the_name_it_has_here(press_folder):
    known = ["input_moment", "input.reaction", "speed_fluctuation", "required_drive_moment"]
    asked = ["input.torque", "input.bearing", "coefficient_of_fluctuation", "required_torque"]
    assert [nearest_names(name, known)[0] for name in asked] == known
    study = Path("study.toml").read_text().replace('"ram.stroke", "excess_work"', '"required_torque"')
    Path("study.toml").write_text(study)
    assert "'required_drive_moment'" in refused("check", "study.toml")


# The force in a joint by its letter

# In line without friction and with a massless rod: its force at the crank is the punch's, and the main bearing's too.
PUSHED = slider_crank(0.05, 0.2, 1.0, "slide") | {
    "forces": {"punch": {"type": "constant", "on": "B", "angle": 0.0, "force": 1000.0}}
}


def test_letter_of_a_joint__names_its_force():
    letters = ["O.reaction.max", "A.reaction.max", "B.reaction.max"]
    outcome = Machine(Scene.model_validate(PUSHED), letters, ["A.reaction_x"]).evaluate({})
    # The rod leans by arcsin(50/200) at most: F = P/cos β.
    greatest = 1000.0 / (1.0 - 0.25**2) ** 0.5
    assert [outcome.summaries[name][0] for name in letters] == pytest.approx([greatest] * 3)
    assert outcome.fields["A.reaction_x"] is outcome.fields["slide.first.reaction_x"]
    assert outcome.units["B.reaction.max"] == "N"


def test_letter_of_a_joint__is_taken_wherever_a_name_is(press_folder):
    study = Path("study.toml").read_text()
    study = study.replace('"ram.stroke", "excess_work"', '"ram.stroke", "excess_work", "A.reaction.peak"')
    study = study.replace('where = "', "where = \"A.reaction.peak > '1 N' and ")
    Path("study.toml").write_text(study)
    assert "peak crankpin force (joint A): crank on rod" in done("run", "study.toml", "--no-plots")
    shown = done("show", "results/study.h5", "--sort", "A.reaction.peak", "--columns", "A.reaction.peak")
    assert "A.reaction" not in shown
    assert "meet" in done("show", "results/study.h5", "--where", "A.reaction.peak < '1 kN'")
    done("export", "results/study.h5", "--to", "table.csv", "--columns", "A.reaction.peak")
    assert "slide.first.reaction.peak" in Path("table.csv").read_text()
    assert "slide.second" not in done("show", "press.toml", "--at", "30", "--columns", "B.reaction")
    assert "slide.inner.reaction.peak" in done("quantities", "press.toml", "B.reaction.peak")
    assert "did you mean" in refused("show", "press.toml", "--at", "30", "--columns", "X.reaction")


def test_letter_of_a_joint_of_three_links__is_answered_with_the_pairs_in_it():
    points = {"O": frame(0.0, 0.0), "D": frame(0.15, 0.1)}
    groups = {"knee": rrr("C", ("rod", "A", 0.2), ("rocker", "D", 0.15))}
    groups |= {"slide": rrp("B", ("strut", "C", 0.3), "ram", "way")}
    knee = Scene.model_validate(slider_crank(points=points, groups=groups))
    with pytest.raises(AskError, match=r"joint C holds 2 pairs; ask for knee\.inner\.reaction .* or slide\.first\.rea"):
        Machine(knee, ["C.reaction.peak"])
    assert Machine(knee, ["D.reaction.peak"]).asked_summaries == ["knee.second.reaction.peak"]


def test_force__has_the_name_of_its_bearing(press_folder):
    fields = Machine(read_scene("press.toml")).available_fields
    assert fields["input.reaction"].long_name == "main-bearing force (joint O): frame on crank"
    thrust = fields["slide.second.reaction"].long_name
    assert thrust == "side thrust of ram (guide way), positive to the left of its direction"


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


def test_help__explains_paths_of_the_user_and_types():
    for asked in ("input.speed", "groups.drive.first.length", "vary.input.length.from", "compressor"):
        assert "required" in done("help", asked)
    assert "type: one of" in done("help", "elements.cam")


def test_help__tells_unit_limit_default_and_example():
    text = key_text("cylinders.gas.bore")
    assert "length, '80 mm', greater than 0" in text
    assert 'bore = "80 mm"' in text
    assert "default: 101.325 kPa" in key_text("ambient")
    # π/2 and 40° as people type them.
    assert re.search(r"angle, '30 deg', at least 0, less than 90 ° +default: 40 °\n", key_text("limits"))
    assert '"high" or "low"' in key_text("cylinders.gas.head")
    # Once for all types of forces.
    assert key_text("acts").count("limits the force to motion") == 1


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
    assert "try fewer, such as `sweeps help flywheel`" in refused("help", "flywheel", "recipe")
