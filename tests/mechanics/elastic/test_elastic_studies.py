"""Bundled studies, templates and pictures of elastic links: answers against closed forms, files, written copies."""

import math
from pathlib import Path

import numpy as np
import pytest
from element_samples import element, one
from test_oscillators import OSCILLATOR, ROTOR
from test_two_mass_drives import DRIVE, peak_of_start

from engine import ElementsAlone, Scene, Verdict, scene_numbers
from sweeps.pictures.elements.element_pictures import element_sheet, element_sheets
from sweeps.pictures.style import save_beside
from sweeps.study.bundled import bundled_studies
from sweeps.study.study_reader import read_study
from sweeps.text.scene_text import read_scene, scene_from, write_scene
from sweeps.text.templates import TEMPLATES, bundled_templates
from sweeps.text.toml_text import parse_toml


@pytest.mark.parametrize("name", ["oscillator", "torsional_train", "elastic_drive"])
def test_template__answers_everything_it_can_be_asked(name):
    scene = read_scene(bundled_templates()[name])
    names = list(ElementsAlone(scene).available_summaries)
    outcome = ElementsAlone(scene, names).evaluate({})
    assert outcome.status[0] == Verdict.OK
    for summary in names:
        assert np.isfinite(outcome.summaries[summary][0])
        assert np.isfinite(outcome.errors[summary][0])


def test_study_of_the_press__is_bounded_by_the_peak_without_damping():
    study = read_study(bundled_studies()["press_backlash"])
    count = study.design.size
    values, _ = study.values(0, count)
    scene, names = study.scene, ["drive.greatest_moment", "drive.stiffness"]
    outcome = ElementsAlone(scene, names, varied=list(study.paths)).evaluate({p: values[p] for p in study.paths})
    assert (outcome.status == Verdict.OK).all()
    drive, gap = scene.elements["drive"], values["elements.drive.backlash"]
    for k in range(0, count, 37):
        stiffness = outcome.summaries["drive.stiffness"][k]
        free = peak_of_start(
            drive.motor_inertia, drive.load_inertia, stiffness, gap[k], drive.motor_moment, drive.load_moment
        )
        # A damper that takes 1.2 of the energy in a cycle, though only of the coupling's, takes no half in half a wave.
        assert 0.7 * free < outcome.summaries["drive.greatest_moment"][k] < free


def test_study_of_the_crankshaft__has_the_coupling_mode_of_two_rigid_halves():
    study = read_study(bundled_studies()["crankshaft_vibration"])
    masses = study.scene.elements["crankshaft"].masses
    engine = sum(m.inertia for name, m in masses.items() if name != "generator")
    stiffness = study.scene.elements["crankshaft"].shafts["coupling"].stiffness
    rigid = math.sqrt(stiffness * (1 / engine + 1 / masses["generator"].inertia))
    outcome = ElementsAlone(study.scene, ["crankshaft.frequency_1"]).evaluate({})
    # The crankshaft is a hundred times stiffer than the coupling, and by that much softer than a rigid one.
    assert rigid * 0.99 < outcome.summaries["crankshaft.frequency_1"][0] < rigid


def test_engine_of_a_train_with_throws__is_written_with_their_units():
    text = (Path(bundled_studies()["crankshaft_vibration"]).parent / "scenes" / "crankshaft_vibration.toml").read_text()
    text = text.replace("cylinders = 4\n", 'cylinders = 4\nthrows = ["0 deg", "180 deg", "180 deg", "0 deg"]\n')
    scene = scene_from(parse_toml(text, ""), text, "", TEMPLATES)
    written = write_scene(scene)
    again = scene_from(parse_toml(written, ""), written, "", TEMPLATES)
    engines = [made.elements["crankshaft"].engine for made in (scene, again)]
    assert engines[0].throws == engines[1].throws == pytest.approx((0.0, math.pi, math.pi, 0.0))
    assert scene_numbers(again) == scene_numbers(scene)


def test_pictures__are_made_of_every_oscillator_and_drive(tmp_path):
    elements = {
        "plain": OSCILLATOR,
        "free": OSCILLATOR | {"damping_ratio": 2.0, "start": {"displacement": 0.01}},
        "sharp": OSCILLATOR | {"excitation": {"type": "force", "amplitude": 1.0, "speed": 20.0}},
        "away": ROTOR | {"run_through": {"start": 40.0, "acceleration": 2.0}},
        "start": DRIVE,
    }
    made = save_beside(tmp_path / "s.png", element_sheets(Scene.model_validate({"elements": elements})))
    vibrating = [f"s_{name}_vibration.png" for name in ("plain", "free", "sharp", "away")]
    assert [path.name for path in made] == [*vibrating, "s_start_transient.png"]


def test_sheets__show_what_is_computed():
    data = ROTOR | {"damping_ratio": 0.05, "start": {"displacement": 0.01, "time": 0.2}}
    figure = element_sheet(element(data))
    free, forced, through = figure.axes
    factor, moved, peak = one(data, "dynamic_factor", "free_displacement", "run_through_amplitude")
    assert any(list(line.get_ydata()) == [pytest.approx(factor)] for line in forced.get_lines())
    assert any(list(line.get_ydata()) == [pytest.approx(1e3 * moved)] for line in free.get_lines())
    curve = next(line for line in through.get_lines() if line.get_label() == "passing through")
    assert curve.get_ydata().max() == pytest.approx(1e3 * peak, rel=1e-3)
    figure = element_sheet(element(DRIVE))
    moments = figure.axes[0].get_lines()[0].get_ydata()
    assert moments.max() == pytest.approx(one(DRIVE, "greatest_moment")[0], rel=1e-3)
