"""A variant written as a scene of its own has the variant's numbers; `results/reliability/round_trip.py` has all."""

import math
from pathlib import Path

import numpy as np
import pytest
from commands import refused
from free_link_scenes import triad_data

from engine import Machine, Scene, Verdict, scene_numbers
from sweeps import SweepResult, read_scene, read_study, run_study, write_scene
from sweeps.study.bundled import STUDIES, bundled_studies
from sweeps.text.scene_text import with_numbers, with_values
from sweeps.text.templates import bundled_templates

CAMPAIGN = Path(__file__).parents[4] / "results" / "reliability"
SUMMARIES = ["upper.swing", "plate.swing", "D.x.max", "required_drive_moment"]
ROD = "links.rod.length"


@pytest.mark.parametrize("name", ["crank_press", "fan_rotor", "rack_doubler", "cam"])
def test_variant_as_a_scene_of_its_own__has_the_same_numbers(name, tmp_path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.syspath_prepend(str(CAMPAIGN))
    from round_trip import drawn_values, varied_values, written_again

    studies = bundled_studies()
    study = read_study(studies.get(name) or bundled_templates()[name])
    values = drawn_values(study) if name in studies else varied_values(study)
    found = list(written_again(study, values, tmp_path))
    assert found
    for again in found:
        assert again.texts[0] == again.texts[1], again


def test_variant_of_free_links__is_put_together_as_in_the_sweep(tmp_path: Path):
    scene, length = Scene.model_validate(triad_data()), 0.3
    alone = Machine(scene, SUMMARIES, varied=[ROD])
    swept = alone.evaluate({ROD: np.array([0.15, length])})
    assert (swept.status == Verdict.OK).all()
    (path := tmp_path / "scene.toml").write_text(write_scene(scene, {ROD: length}), encoding="utf8")
    again = read_scene(path)
    assert again.near == with_values(scene, {ROD: length}).near
    for found in (Machine(again, SUMMARIES).evaluate({}), alone.evaluate({ROD: np.array([length])})):
        for name in SUMMARIES:
            assert found.summaries[name][0] == swept.summaries[name][1]
    # With the place that the scene tells it is another machine.
    kept = Machine(with_numbers(scene, {ROD: length}), SUMMARIES).evaluate({})
    assert kept.summaries["upper.swing"][0] != swept.summaries["upper.swing"][1]


def test_variant_without_a_text__is_written_in_the_units_of_its_field():
    study = read_study(bundled_studies()["crank_press"])
    lines = write_scene(study.scene, {"input.length": 0.045, "input.speed": math.pi}).splitlines()
    for line in ('angle = "-90 deg"', 'length = "45 mm"', 'speed = "30 rpm"', 'mass = "300 kg"'):
        assert line in lines


UNREACHED = """
title = "Legs"
scene = "triad.toml"
positions = 24

[vary]
"links.lower.length" = {values = ["0.2 m", "0.6 m"]}

[outputs]
summaries = ["upper.swing"]
"""


# Of a result and of a study, for numbers, a text and a picture; each puts the variant together once, for 3 s.
COMMANDS = ("show r.h5 --variant 1 --at 10", "export study.toml --variant 1 --to t.toml", "plot r.h5 --variant 1")


def test_variant_whose_mode_is_not_reached__is_no_machine_for_any_command(folder):
    """Put together by the scene's own near it would be another machine than the one that the sweep refuses."""
    Path("triad.toml").write_text(write_scene(Scene.model_validate(triad_data())), encoding="utf8")
    Path("study.toml").write_text(UNREACHED, encoding="utf8")
    result = SweepResult(run_study(read_study(Path("study.toml")), "r.h5"))
    assert result.columns["status"].tolist() == [Verdict.OK, Verdict.MODE_NOT_REACHED]
    for command in COMMANDS:
        assert "can't be assembled in the scene's assembly mode" in refused(*command.split()), command
    assert {path.name for path in Path().iterdir()} == {"r.h5", "study.toml", "triad.toml"}


VARIANTS = 64
FINE = 1e-12
DIMENSIONS = ("length", "mass", "inertia", "force", "moment", "pressure", "angular_speed", "stiffness")
CASES = {
    "friction/scenes/engine_bearings": """mechanical_efficiency drive.first.friction_work
    drive.first.load_direction_of_crank drive.inner.reaction_along.rms""",
    "gears_and_cams/scenes/elliptical_wheels": """input.reaction_across.rms drive.first.load_direction_of_rod
    drive.first.reaction_direction.min_at drive.first.reaction_direction.max drive.first.reaction_direction.range""",
}


def varied_numbers(scene):
    """All numbers of a kind that may be any, varied at random."""
    rng, numbers = np.random.default_rng(5), scene_numbers(scene)
    chosen = {p: n for p, n in numbers.items() if n.dimension in DIMENSIONS and n.value and "ratio" not in p}
    chosen = {p: n for p, n in chosen.items() if not p.startswith(("regimes", "near"))}
    return {path: n.value * (1.0 + 0.12 * rng.uniform(-1.0, 1.0, VARIANTS)) for path, n in chosen.items()}


@pytest.mark.parametrize("name", CASES)
def test_estimates__cover_what_a_tighter_accuracy_changes(name):
    scene, names = read_scene(STUDIES / f"{name}.toml").model_copy(update={"elements": {}}), CASES[name].split()
    varied, cycle = varied_numbers(scene), 2.0 * math.pi * scene.input.revolutions
    found = [Machine(scene, names, (), list(varied), accuracy=a).evaluate(varied) for a in (FINE, None, 1e-3)]
    works = np.all([o.status == 0 for o in found], axis=0)
    assert works.sum() > VARIANTS / 2
    missed = {}
    for outcome in found[1:]:
        for summary in names:
            # Neither result is exact: both estimates count. A cycle's first and last position are one.
            allowed = outcome.errors[summary] + found[0].errors[summary]
            off = abs(outcome.summaries[summary] - found[0].summaries[summary])
            off = np.minimum(off, abs(cycle - off)) if summary.endswith("_at") else off
            missed[summary] = missed.get(summary, 0) + int((off > allowed)[works].sum())
    assert missed == dict.fromkeys(names, 0)
