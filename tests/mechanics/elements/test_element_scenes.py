"""Machine elements in scenes, alone and beside a mechanism, and in studies and commands."""

import numpy as np
import pytest
from commands import done, refused
from each_case import refusals
from element_samples import BELT, CAR, EVERY, GUIDE, JACK, WOUND, one, results, scene
from machines import slider_crank
from numpy.testing import assert_allclose, assert_array_equal

from engine import ElementsAlone, Machine, Scene, SceneError, Verdict, made_ready, scene_numbers
from sweeps import SweepResult, read_study, run_study
from sweeps.pictures.sweep.result_pictures import result_pictures
from sweeps.study.bundled import bundled_studies
from sweeps.text.scene_text import read_scene, scene_from, write_scene
from sweeps.text.toml_text import parse_toml

# Scenes: alone, beside a mechanism, refused


def test_scene_of_elements_alone__is_made_ready_without_a_machine():
    assert isinstance(made_ready(scene(jack=JACK)), ElementsAlone)
    with pytest.raises(SceneError, match=r"input: is missing.*only machine elements"):
        Machine(scene(jack=JACK))


def test_elements_beside_a_mechanism__are_what_they_are_alone():
    both = Scene.model_validate(slider_crank(elements={"jack": JACK}))
    varied = {"elements.jack.friction": np.array([0.05, 0.1, -1.0])}
    machine = made_ready(both, ["ram.stroke", "jack.raise_moment"], ["B.x"], varied)
    outcome = machine.evaluate(varied)
    assert_array_equal(outcome.status, [Verdict.OK, Verdict.OK, Verdict.OUTSIDE_LIMITS])
    alone = ElementsAlone(scene(jack=JACK), ["jack.raise_moment"], varied=varied).evaluate(varied)
    for table in ("summaries", "errors"):
        assert_array_equal(getattr(outcome, table)["jack.raise_moment"], getattr(alone, table)["jack.raise_moment"])
    assert_allclose(outcome.summaries["ram.stroke"][:2], 0.1, rtol=1e-12)
    # With nothing asked of the mechanism, too.
    outcome = made_ready(both, ["jack.raise_moment"]).evaluate({})
    assert_allclose(outcome.summaries["jack.raise_moment"], one(JACK, "raise_moment"), rtol=0)


def test_element_that_jams_beside_a_mechanism__is_the_verdict():
    both = Scene.model_validate(slider_crank(elements={"jack": JACK, "bed": {**GUIDE, "overhang": 2.0}}))
    machine = made_ready(both, ["ram.stroke", "jack.raise_moment", "bed.drive_force"])
    outcome = machine.evaluate({})
    assert outcome.status[0] == Verdict.JAMS
    assert machine.groups[outcome.status_group[0]] == "elements.bed"
    assert made_ready(both, ["ram.stroke"]).evaluate({}).status[0] == Verdict.OK


def test_element_with_a_name_that_is_taken__is_refused():
    both = Scene.model_validate(slider_crank(elements={"rod": JACK}))
    with pytest.raises(SceneError, match=r"elements\.rod: the name 'rod' is already taken"):
        Machine(both)


TEXT = """
[elements.jack]
type = "screw"
load = "6.4 kN"
mean_diameter = "30 mm"
pitch = "4 mm"
starts = 2
thread = "square"
friction = 0.08
collar_diameter = "40 mm"
collar_friction = 0.08
"""


def read(text):
    return scene_from(parse_toml(text, "jack.toml"), text, "jack.toml", None)


def test_text_of_an_element__reads_and_writes():
    assert read(TEXT).elements["jack"] == scene(jack=JACK).elements["jack"]
    again = write_scene(scene(**EVERY), {"elements.jack.pitch": 0.005})
    numbers = {path: number.value for path, number in scene_numbers(scene(**EVERY)).items()}
    found = {path: number.value for path, number in scene_numbers(read(again)).items()}
    assert found == {**numbers, "elements.jack.pitch": 0.005}


test_numbers_that_contradict__are_refused = refusals(
    lambda element, changes: scene(it={**element, **changes}),
    (BELT, {"moment": 3.0}, "give tension or moment, one of the two"),
    (BELT, {"linear_density": 0.2}, "give speed"),
    (GUIDE, {"form": "vee"}, "vee_angle is missing: form = 'vee' needs it"),
    (GUIDE, {"vee_angle": 1.0}, "vee_angle goes with form = 'vee'"),
    (JACK, {"thread_angle": 0.5}, "one of the two"),
)


def test_scene_without_input_or_elements__is_refused():
    with pytest.raises(ValueError, match="input"):
        Scene.model_validate({"elements": {}})
    with pytest.raises(ValueError, match="input is missing"):
        Scene.model_validate({"input": None, "elements": {"jack": JACK}, "gravity": 9.81})


test_what_only_a_mechanism_has__is_refused = refusals(
    lambda ask: made_ready(scene(jack=JACK), **ask),
    ({"summaries": ["crank.swing"]}, "'crank.swing' is not a summary … only machine elements"),
    ({"summaries": ["jack.raise_momnt"]}, "did you mean 'jack.raise_moment'"),
    ({"fields": ["B.x"]}, "'B.x': machine elements have no fields … [input]"),
    ({"varied": ["elements.jack.load", "input.speed"]}, "'input.speed' is not a number of this scene"),
)


# Studies and commands


def test_commands__on_elements_alone_work_or_say_why_not(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "jack.toml").write_text(TEXT, encoding="utf8")

    told = done("check", "jack.toml")
    assert "only machine elements" in told
    assert "jack.raise_moment" in told
    assert "26.177" in done("run", "jack.toml", "--quiet")
    done("show", "results/jack.h5")
    done("export", "results/jack.h5", "--to", "jack.csv")
    done("export", "results/jack.h5", "--variant", "0", "--to", "again.toml")
    assert read_scene("again.toml").elements == read(TEXT).elements
    assert done("plot", "jack.toml") == "Wrote jack_friction.png\n"
    for words in (("animate", "jack.toml"), ("export", "jack.toml", "--to", "a.svg")):
        assert "only machine elements" in refused(*words)
    assert "def named" in done("check", "jack.toml", "--source")


def test_plot_of_a_sweep_of_elements__has_the_best_one_over_its_friction(tmp_path):
    result = run_study(read_study(bundled_studies()["screw_jack"]), tmp_path / "screw_jack.h5")
    made = result_pictures(SweepResult(result))
    assert [path.name for path in made] == ["screw_jack.png", "screw_jack_best_jack_friction.png"]
    assert all(path.stat().st_size > 10_000 for path in made)


GEARED = {
    "type": "torsional_train",
    "masses": {name: {"inertia": 1.0} for name in "abc"},
    "shafts": {"s": {"between": ["a", "b"], "stiffness": 1e4}},
    "gears": {"g": {"between": ["b", "c"], "ratio": 2.0}},
}


@pytest.mark.parametrize(
    ("element", "name", "key", "values"),
    [
        (WOUND | {"strength": 4e8}, "energy", "winding_stress", [3e8, 5e8]),
        (WOUND | {"strength": 4e8}, "energy", "strength", [4e8, 3e8]),
        (CAR, "deceleration", "rear_distance", [1.2, 2.8]),
        (GEARED, "frequency_1", "gears__g__ratio", [2.0, 0.0]),
    ],
)
def test_what_a_scene_refuses__is_outside_the_limits_in_a_variant(element, name, key, values):
    found, _, status = results(element, name, **{key: values})
    assert list(status) == [Verdict.OK, Verdict.OUTSIDE_LIMITS]
    assert np.isfinite(found[name]).tolist() == [True, False]
