"""Numbers that variants are given: what a scene refuses its variants don't get past, and what is no row of numbers."""

import numpy as np
import pytest
from each_case import refusals
from machines import changed, crank, frame, on, rrp

from engine import AskError, Machine, NonZero, Scene, SceneError, Verdict, scene_numbers
from engine.machine.checks import MOST_POSITIONS

SCENE = {
    "points": {"O": frame(0.0, 0.0), "C": on("rod", 0.2, 0.0), "P": frame(0.1, 0.03)},
    "guides": {"way": {"angle": 0}, "table": {"y": -0.3}},
    "input": crank(length=0.05, speed=30.0),
    "shafts": {"second": {"geared_to": "crank", "ratio": 2.0, "inertia": 0.1}},
    "groups": {"drive": rrp("B", ("rod", "A", 0.2), "piston", "way")},
    "pinions": {"wheel": {"rack": "piston", "pivot": "P", "radius": 0.03}},
    "bodies": {"piston_body": {"link": "piston", "mass": 2.0}},
}
NUMBERS = scene_numbers(Scene.model_validate(SCENE))
NEVER_ZERO = [path for path, number in NUMBERS.items() if any(isinstance(m, NonZero) for m in number.limits)]


def test_numbers_that_must_not_be_zero__are_these():
    assert NEVER_ZERO == ["input.speed", "shafts.second.ratio", "pinions.wheel.radius"]


@pytest.mark.parametrize("path", NUMBERS)
def test_variant_of_zero__is_outside_limits_where_the_scene_refuses_zero(path):
    try:
        Scene.model_validate(changed(SCENE, {path: 0.0}))
    except SceneError:
        refused = True
    else:
        refused = False
    machine = Machine(Scene.model_validate(SCENE), ["piston.stroke"], varied=[path])
    # Nothing is computed of dropped variants, but their numbers are looked at.
    limits = machine.evaluate({path: np.zeros(1)}, np.ones(1, bool)).status
    assert limits[0] == Verdict.DROPPED
    if refused:
        assert machine.evaluate({path: np.zeros(1)}).status[0] == Verdict.OUTSIDE_LIMITS
    else:
        assert NUMBERS[path].value == 0.0 or path not in NEVER_ZERO


TWO = ("input.length", "groups.drive.first.length")
GOOD = [0.05, 0.06]


test_what_is_no_row_of_numbers__is_refused_by_name = refusals(
    lambda given: Machine(Scene.model_validate(SCENE), ["piston.stroke"], varied=TWO).evaluate(given),
    ({TWO[0]: [0.05 + 0.01j, 0.06], TWO[1]: [0.2, 0.2]}, "'input.length' has complex values"),
    ({TWO[0]: np.ma.array([0.05, 0.06], mask=[0, 1]), TWO[1]: [0.2, 0.2]}, "'input.length' has masked values"),
    ({TWO[0]: GOOD, TWO[1]: [0.2, 0.2, 0.2]}, "'groups.drive.first.length' has 3 values, 'input.length' has 2"),
    ({TWO[0]: GOOD, TWO[1]: []}, "'groups.drive.first.length' has 0 values, 'input.length' has 2"),
    ({TWO[0]: [GOOD, GOOD], TWO[1]: [0.2, 0.2]}, "'input.length' has 2 × 2 values"),
    ({TWO[0]: np.full((2, 1), 0.05), TWO[1]: [0.2, 0.2]}, "'input.length' has 2 × 1 values"),
    ({TWO[0]: [GOOD, [0.05]], TWO[1]: [0.2, 0.2]}, "'input.length': rows differ in length"),
    ({TWO[0]: ["50 mm", "60 kg"], TWO[1]: [0.2, 0.2]}, "'input.length': expected a length such as '80 mm'"),
    ({TWO[0]: ["50 mm", 0.06], TWO[1]: [0.2, 0.2]}, "'input.length': 0.06 has no unit"),
    ({TWO[0]: "50", TWO[1]: [0.2, 0.2]}, '50 has no unit: write "50 mm"'),
    ({TWO[0]: [True, False], TWO[1]: [0.2, 0.2]}, "'input.length' has non-numeric values, such as True"),
    ({TWO[0]: [None, 0.05], TWO[1]: [0.2, 0.2]}, "give numbers in SI units, or texts with units such as '50 mm'"),
    ({TWO[0]: GOOD}, "no values are given for 'groups.drive.first.length'"),
    ({"input.lenght": GOOD, TWO[1]: [0.2, 0.2]}, "'input.lenght' is not varied by this machine"),
    (GOOD, "give values by path, such as {'input.length': [...]}"),
)


def test_texts_with_units__are_numbers():
    machine = Machine(Scene.model_validate(SCENE), "piston.stroke", varied=TWO[0], accuracy="1 %")
    found = [machine.evaluate({TWO[0]: given}).summaries["piston.stroke"] for given in ("50 mm", ["5 cm"], [0.05])]
    assert found[0] == found[1] == found[2]
    assert machine.evaluate({TWO[0]: ["50 mm", "6 cm"]}).status.tolist() == [Verdict.OK, Verdict.OK]


def test_outcome__has_the_units_of_what_is_asked():
    outcome = Machine(Scene.model_validate(SCENE), ["piston.stroke"], ["B.vx"]).evaluate({})
    assert outcome.units == {"piston.stroke": "m", "B.vx": "m s-1"}
    assert "1 ok; summaries piston.stroke [m]; fields B.vx [m s-1]" in repr(outcome)


def test_millimetres_taken_for_metres__are_remarked():
    machine = Machine(Scene.model_validate(SCENE), ["piston.stroke"], varied=[TWO[0]])
    outcome = machine.evaluate({TWO[0]: [35.0, 40.0]})
    assert outcome.remarks[0].startswith("input.length = 35 m is ")
    assert "2 can't be assembled; input.length = 35 m is" in repr(outcome)
    assert "so write '35 mm'" in repr(outcome)
    # Failing lengths near the scene's own, and ones that work, are not remarked.
    assert not machine.evaluate({TWO[0]: [0.5, 40.0]}).remarks
    assert not machine.evaluate({TWO[0]: [0.05, 40.0]}).remarks


test_what_makes_no_machine__is_refused_in_words = refusals(
    lambda make: make(Scene.model_validate(SCENE)),
    (lambda scene: Machine("press.toml"), "'press.toml' is not a scene; read one from a file"),
    (lambda scene: Machine(scene, "piston.strok"), "did you mean 'piston.stroke'"),
    (lambda scene: Machine(scene, accuracy="high"), "accuracy: expected a number"),
    (lambda scene: Machine(scene, accuracy=5), "accuracy = 5: a share between 0 and 1 is needed"),
    *((lambda scene, n=n: Machine(scene, positions=n), "even number") for n in (0, 1, 7, 9, 8.0)),
    (lambda scene: Machine(scene, positions=MOST_POSITIONS + 2), "at most 1048576 are allowed"),
)


def test_help__shows_the_public_interface_alone():
    shown = {name for name in dir(Machine) if not name.startswith("_")}
    assert shown == {
        *("available_fields", "available_summaries", "computed", "evaluate", "groups", "has_cycle", "has_regimes"),
        *("input_values", "left_out", "new_buffer", "nodes", "numbers_kept", "source"),
    }
    assert all(getattr(Machine, name).__doc__ for name in shown)


@pytest.mark.parametrize("drop", [np.zeros(3, bool), np.zeros((2, 2), bool), np.array([0, 1]), True])
def test_what_to_drop__is_told_for_each_variant(drop):
    machine = Machine(Scene.model_validate(SCENE), ["piston.stroke"], varied=TWO)
    with pytest.raises(AskError, match="give True or False for each of the 2 variants"):
        machine.evaluate({TWO[0]: GOOD, TWO[1]: [0.2, 0.2]}, drop)
