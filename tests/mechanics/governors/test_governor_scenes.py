"""Governors in scenes, studies, commands and pictures."""

import math

import numpy as np
import pytest
from element_samples import element, results
from governor_samples import ENGINE, EVERY_GOVERNOR, PORTER, PROELL, TABLE
from machines import slider_crank
from numpy.testing import assert_allclose

from engine import Scene, Verdict, governed_scene, made_ready, scene_numbers, warnings_in_words
from sweeps.pictures.elements.element_pictures import element_sheet, element_sheets
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import save_beside
from sweeps.text.scene_text import scene_from, write_scene
from sweeps.text.toml_text import parse_toml

STEPPED = {"type": "table", "over_lift": [0.0, 0.02, 0.06, 0.1], "moment": [400.0, 390.0, 100.0, 0.0],
           "interpolation": "pchip"}  # fmt: skip
GOVERNED = PORTER | {"damping": 600.0, "engine": ENGINE | {"duration": 2.0}}


def read(text):
    return scene_from(parse_toml(text, "governor.toml"), text, "governor.toml", None)


def test_governors__are_written_and_read():
    governors = EVERY_GOVERNOR | {"governed": PORTER | {"engine": ENGINE | {"throttle": STEPPED}}}
    scene = Scene.model_validate({"elements": governors})
    again = read(write_scene(scene, {"elements.governed.engine.inertia": 33.0}))
    before, after = ({p: n.value for p, n in scene_numbers(s).items()} for s in (scene, again))
    assert after == before | {"elements.governed.engine.inertia": 33.0}
    for key in ("over_radius", "controlling_force"):
        assert getattr(again.elements["table"], key) == getattr(scene.elements["table"], key)
    assert again.elements["governed"].engine.throttle == scene.elements["governed"].engine.throttle


def test_governor_of_the_machine__has_the_inertia_of_its_mechanism():
    """A slider-crank's mean reduced inertia, by the mean of its own curve, with its flywheel and what is given."""
    engine = {key: value for key, value in ENGINE.items() if key != "inertia"} | {"duration": 2.0}
    governor = PORTER | {"damping": 600.0, "engine": engine | {"machine": True, "inertia": 3.0}}
    bodies = {"crank_body": {"link": "crank", "mass": 3.0, "inertia": 4.0}, "ram_body": {"link": "ram", "mass": 800.0}}
    wheels = np.array([10.0, 20.0, 30.0])
    both = Scene.model_validate(slider_crank(elements={"it": governor}, bodies=bodies, flywheel={"inertia": 20.0}))
    names = [f"it.{key}" for key in ("decay_rate", "hunting_frequency", "critical_inertia")]
    varied = {"flywheel.inertia": wheels}
    outcome = made_ready(both, names, varied=varied).evaluate(varied)
    assert (outcome.status == Verdict.OK).all()
    curve = made_ready(both, fields=["reduced_inertia"]).evaluate({}).fields["reduced_inertia"][0]
    alone = PORTER | {"damping": 600.0, "engine": engine | {"inertia": 1.0}}
    # A periodic curve's mean over equally spaced angles is exact but for rounding.
    found, _, _ = results(alone, engine__inertia=3.0 + wheels + curve.mean())
    for name in names:
        assert_allclose(outcome.summaries[name], found[name.removeprefix("it.")], rtol=1e-9, err_msg=name)
    drawn = governed_scene(both)[0].elements["it"].engine
    assert (drawn.machine, drawn.inertia) == (False, pytest.approx(23.0 + curve.mean(), rel=1e-12))
    alone = Scene.model_validate({"elements": {"it": GOVERNED}})
    assert governed_scene(alone) == (alone, {})


def test_machine_that_fails__fails_alike_whatever_is_asked():
    engine = ENGINE | {"machine": True, "inertia": 3.0}
    bodies = {"ram_body": {"link": "ram", "mass": 800.0}}
    scene = Scene.model_validate(
        slider_crank(elements={"it": PORTER | {"damping": 600.0, "engine": engine}}, bodies=bodies)
    )
    varied = {"groups.g.first.length": np.array([0.2, 0.03])}
    of_governor, of_machine = (
        made_ready(scene, [name], varied=varied).evaluate(varied)[:3] for name in ("it.decay_rate", "ram.stroke")
    )
    assert of_governor[0].tolist() == [Verdict.OK, Verdict.CANNOT_ASSEMBLE]
    for one, other in zip(of_governor, of_machine, strict=True):
        np.testing.assert_array_equal(one, other)


def test_governor_of_no_machine__is_refused():
    engine = {"machine": True, "throttle": {"type": "linear", "full": 400.0}, "load": 300.0}
    with pytest.raises(ValueError, match=r"elements\.it\.engine\.machine: the scene has no crank that turns fully"):
        element(PORTER | {"engine": engine})
    with pytest.raises(ValueError, match="machine = true for the scene's own"):
        element(PORTER | {"engine": engine | {"machine": False}})


# Pictures and commands


def test_curves__have_their_stops_and_stretches():
    governor = PROELL | {"least_radius": 0.15}
    force, speed = element(governor).panels()
    found, _, _ = results(governor)
    assert [mark.place for mark in force.marks] == [pytest.approx(0.15), pytest.approx(0.2)]
    stable, unstable = (force.places[np.isfinite(curve.values)] for curve in force.curves[:2])
    assert unstable.max() < found["stable_from"][0] < stable.min()
    assert [unstable.min(), stable.max()] == [pytest.approx(0.15, rel=1e-12), pytest.approx(0.2, rel=1e-12)]
    between = (force.places > 0.15 * (1.0 - 1e-12)) & (force.places < 0.2 * (1.0 + 1e-12))
    whole, spindle = force.curves[2].values[between], np.fmax(*(curve.values for curve in speed.curves[:2]))
    assert_allclose(whole, 10.0 * spindle**2 * force.places[between], rtol=1e-12)


def lines(ax):
    return {line.get_label(): line for line in ax.lines}


def test_sheet__shows_what_is_computed():
    governor = element(GOVERNED)
    force, speed, diagram, change, _ = element_sheet(governor, "governor").axes
    found, _, _ = results(GOVERNED)
    rays = [t.get_text() for t in force.texts]
    assert rays == [f"{found[key][0] * 30 / math.pi:.4g} rpm" for key in ("least_speed", "greatest_speed")]
    y = change.lines[0].get_ydata()
    assert y.max() * math.pi / 30 == pytest.approx(found["highest_speed"][0], rel=1e-9)
    marker = next(line for line in diagram.lines if line.get_marker() == "o")
    assert marker.get_xydata()[0] == pytest.approx([found[f"vyshnegradsky_{axis}"][0] for axis in "xy"])
    stable = lines(force)["stable"].get_xydata()
    assert stable[np.isfinite(stable[:, 1]), 0].min() == pytest.approx(150, abs=0.5)
    assert speed.get_xlabel() == "lift of the sleeve s, mm"


def test_speeds_that_hardly_differ__share_a_label():
    force = element_sheet(element(PROELL | {"least_radius": 0.17, "greatest_radius": 0.172})).axes[0]
    assert [text.get_text().count("rpm") for text in force.texts if text.get_text()] == [1]


def test_no_oscillation__is_shown_where_the_discriminant_says():
    from engine.laws.governors.stability import oscillates

    figure = element_sheet(element(GOVERNED))
    drawn = lines(figure.axes[2])
    edges = [drawn[f"no oscillation {side}"].get_data() for side in ("above", "below")]
    for x in np.linspace(0.5, 5.9, 12):
        for y in np.linspace(0.5, 5.9, 12):
            # Points within a pixel of the edge apart.
            near = {oscillates(x + dx, y + dy) for dx in (-0.03, 0.03) for dy in (-0.03, 0.03)}
            if len(near) == 1:
                low, high = (np.interp(x, *edge) for edge in edges)
                assert (low < y < high) == (not oscillates(x, y)), (x, y)


def test_sheet_of_a_governor_that_does_not_work__says_why():
    unstable = element(TABLE | {"controlling_force": [300.0, 310.0, 315.0, 320.0]})
    figure = element_sheet(unstable)
    assert "stable nowhere between its stops" in figure.axes[0].get_title()
    assert set(lines(figure.axes[0])) >= {"unstable", "stops"}
    with pytest.raises(PictureError, match="no results to draw"):
        element_sheet(element(PORTER | {"upper_arm": 0.1}))


def test_element_that_cannot_be_drawn__leaves_the_pictures_of_the_others(tmp_path):
    elements = {"short": PORTER | {"upper_arm": 0.1}, "sound": PORTER}
    with pytest.raises(PictureError, match=r"elements\.short: .*no results to draw"):
        save_beside(tmp_path / "sheet.svg", element_sheets(Scene.model_validate({"elements": elements})))
    assert [path.name for path in tmp_path.iterdir()] == ["sheet_sound_governor.svg"]


def test_friction_at_the_sleeve__is_a_force_and_no_coefficient():
    assert warnings_in_words(Scene.model_validate({"elements": {"it": PORTER | {"friction": 20.0}}})) == []
