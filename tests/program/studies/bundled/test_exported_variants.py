"""A variant written as a scene of its own has the variant's numbers; `results/reliability/round_trip.py` has all."""

from pathlib import Path

import numpy as np
import pytest
from free_link_scenes import triad_data

from engine import Machine, Scene, Verdict
from sweeps.cli.named_machine import numbers_replaced
from sweeps.study.bundled import bundled_studies
from sweeps.study.study_reader import read_study
from sweeps.text.input_files import InputError
from sweeps.text.scene_text import read_scene, with_numbers, with_values, write_scene
from sweeps.text.templates import bundled_templates

CAMPAIGN = Path(__file__).parents[4] / "results" / "reliability"
SUMMARIES = ["upper.swing", "plate.swing", "D.x.max", "required_drive_moment"]
ROD = "links.rod.length"


@pytest.mark.parametrize("name", ["triad_dwell", "crank_press", "fan_rotor", "triad", "rack_doubler", "cam"])
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


def test_variants_of_free_links__are_put_together_as_in_the_sweep(tmp_path: Path):
    scene, lengths = Scene.model_validate(triad_data()), np.array([0.15, 0.25, 0.28, 0.3])
    swept = Machine(scene, SUMMARIES, varied=[ROD]).evaluate({ROD: lengths})
    assert (swept.status == Verdict.OK).all()
    alone, otherwise = Machine(scene, SUMMARIES, varied=[ROD]), 0
    for i, length in enumerate(lengths):
        to = tmp_path / f"{i}.toml"
        to.write_text(write_scene(scene, {ROD: float(length)}), encoding="utf8")
        assert read_scene(to).near == with_values(scene, {ROD: float(length)}).near
        for made in (Machine(read_scene(to), SUMMARIES), alone):
            found = made.evaluate({ROD: lengths[i : i + 1]} if made is alone else {})
            for name in SUMMARIES:
                assert found.summaries[name][0] == swept.summaries[name][i]
        # With the place that the scene tells some of them are other machines, or none.
        kept = Machine(with_numbers(scene, {ROD: float(length)}), SUMMARIES).evaluate({})
        otherwise += kept.summaries["upper.swing"][0] != swept.summaries["upper.swing"][i]
    assert otherwise


def test_variant_whose_mode_is_not_reached__is_not_written(tmp_path: Path):
    to = tmp_path / "triad.toml"
    to.write_text(write_scene(Scene.model_validate(triad_data())), encoding="utf8")
    with pytest.raises(InputError, match="assembly mode isn't reached"):
        numbers_replaced(str(to), {"links.lower.length": 0.6}, ())
