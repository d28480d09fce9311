"""Quantities, keys and forces found by the words an engineer uses for them."""

from pathlib import Path

import pytest
from commands import done, refused
from each_case import each
from press_texts import PRESS

from engine import AskError, Machine, Scene, nearest_names
from sweeps import read_scene
from sweeps.study.bundled import STUDIES

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


@pytest.mark.parametrize(
    ("words", "found"),
    [
        ("torque", "  moments "),
        ("quick return", "`sweeps guide gears`"),
        ("counterweight", "`sweeps guide balancing`"),
        ("units", 'value: "mm" or "SI" or "US"'),
        ("dwell", 'type = "dwell"'),
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
SLOW = Scene.model_validate(
    {
        "points": {"O": {"x": 0, "y": 0}},
        "guides": {"way": {}},
        "input": {"type": "crank", "pivot": "O", "pin": "A", "length": 0.05, "speed": 1.0},
        "groups": {
            "slide": {
                "type": "RRP",
                "inner": "B",
                "first": {"link": "rod", "joint": "A", "length": 0.2},
                "second": {"link": "ram", "guide": "way"},
            }
        },
        "forces": {"punch": {"type": "constant", "on": "B", "angle": 0.0, "force": 1000.0}},
    }
)


def test_letter_of_a_joint__names_its_force():
    letters = ["O.reaction.max", "A.reaction.max", "B.reaction.max"]
    outcome = Machine(SLOW, letters, ["A.reaction_x"]).evaluate({})
    # The rod leans by arcsin(50/200) at most: F = P/cos β.
    greatest = 1000.0 / (1.0 - 0.25**2) ** 0.5
    assert [outcome.summaries[name][0] for name in letters] == pytest.approx([greatest] * 3)
    assert outcome.fields["A.reaction_x"] is outcome.fields["slide.first.reaction_x"]
    assert outcome.units["B.reaction.max"] == "N"


def test_letter_of_a_joint__is_taken_wherever_a_name_is(press_folder):
    study = Path("study.toml").read_text()
    study = study.replace('"ram.stroke", "excess_work"', '"ram.stroke", "excess_work", "A.reaction.peak"')
    study = study.replace(
        "where = \"ram.stroke > '90 mm'\"", "where = \"A.reaction.peak > '1 N' and ram.stroke > '90 mm'\""
    )
    Path("study.toml").write_text(study)
    assert "peak crankpin force (joint A): crank on rod" in done("run", "study.toml", "--no-plots")
    assert "A.reaction" not in done(
        "show", "results/study.h5", "--sort", "A.reaction.peak", "--columns", "A.reaction.peak"
    )
    assert "meet" in done("show", "results/study.h5", "--where", "A.reaction.peak < '1 kN'")
    done("export", "results/study.h5", "--to", "table.csv", "--columns", "A.reaction.peak")
    assert "slide.first.reaction.peak" in Path("table.csv").read_text()
    assert "slide.second" not in done("show", "press.toml", "--at", "30", "--columns", "B.reaction")
    assert "slide.inner.reaction.peak" in done("quantities", "press.toml", "B.reaction.peak")
    assert "did you mean" in refused("show", "press.toml", "--at", "30", "--columns", "X.reaction")


def test_letter_of_a_joint_of_three_links__is_answered_with_the_pairs_in_it():
    knee = Scene.model_validate(
        {
            **SLOW.model_dump(exclude_unset=True, exclude={"groups", "forces"}),
            "points": {"O": {"x": 0, "y": 0}, "D": {"x": 0.15, "y": 0.1}},
            "groups": {
                "knee": {
                    "type": "RRR",
                    "inner": "C",
                    "first": {"link": "rod", "joint": "A", "length": 0.2},
                    "second": {"link": "rocker", "joint": "D", "length": 0.15},
                },
                "slide": {
                    "type": "RRP",
                    "inner": "B",
                    "first": {"link": "strut", "joint": "C", "length": 0.3},
                    "second": {"link": "ram", "guide": "way"},
                },
            },
        }
    )
    with pytest.raises(AskError, match=r"joint C holds 2 pairs; ask for knee\.inner\.reaction .* or slide\.first\.rea"):
        Machine(knee, ["C.reaction.peak"])
    assert Machine(knee, ["D.reaction.peak"]).asked_summaries == ["knee.second.reaction.peak"]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("input.reaction", "main-bearing force (joint O): frame on crank"),
        ("slide.first.reaction", "crankpin force (joint A): crank on rod"),
        ("slide.second.reaction", "side thrust of ram (guide way), positive to the left of its direction"),
    ],
)
def test_force__has_the_name_of_its_bearing(press_folder, name, words):
    assert Machine(read_scene("press.toml")).available_fields[name].long_name == words


def test_motor_called_motor__is_named_once(press_folder):
    motor = '[moments.motor]\ntype = "induction_motor"\non = "crank"\npower = "4 kW"\nrated_speed = "58 rpm"\n'
    Path("press.toml").write_text(PRESS + motor + 'synchronous_speed = "60 rpm"\nbreakdown_ratio = 2.5\n')
    words = Machine(read_scene("press.toml")).available_summaries["motor.rated_moment"].long_name
    assert words == "rated torque of motor, at its own shaft"
