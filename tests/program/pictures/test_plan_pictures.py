"""Plans as pictures: scales that hold on paper, letters clear of each other, loads of bearings, files."""

import math
from itertools import combinations

import numpy as np
import pytest
from commands import done
from drawn_machines import crank, four_bar
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from plan_machines import MACHINES, MECHANISMS, motion_of

from engine import Machine, Scene
from sweeps.pictures.drawing import DrawnMotion
from sweeps.pictures.drawing.racks import rack_shapes
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.plans.bearing_loads import bearing_load, least_loaded, shares
from sweeps.pictures.plans.files import bearing_pictures, plan_pictures, reaction_pictures
from sweeps.pictures.plans.forces.force_plan import force_plan, force_polygon
from sweeps.pictures.plans.forces.free_body import LONGEST, free_body
from sweeps.pictures.plans.kinematic_plans import draw_plan
from sweeps.pictures.plans.mechanism_plan import mechanism_plan
from sweeps.pictures.plans.paper import round_scale
from sweeps.pictures.plans.polygons import accelerations, velocities
from sweeps.pictures.plans.pose import pose_at
from sweeps.pictures.style import BLUE, MM_PER_INCH
from sweeps.study.bundled import bundled_studies
from sweeps.text.scene_text import read_scene
from sweeps.text.templates import bundled_templates

# Bearings


def heavy_crank():
    scene = {"points": {"O": {"x": 0, "y": 0}}, "gravity": 10.0, "input": crank(speed=1e-6)}
    return Scene.model_validate(scene | {"bodies": {"disc": {"link": "crank", "mass": 3.0}}})


def test_peak_of_a_bearing__is_that_of_the_results():
    """It may lie where a valve opens, between two of the positions drawn."""
    scene = read_scene(bundled_studies()["compressor"].parent / "scenes" / "compressor.toml")
    motion = DrawnMotion(scene)
    outcome = Machine(scene, ["input.reaction.peak"]).evaluate({})
    peak, error = outcome.summaries["input.reaction.peak"][0], outcome.errors["input.reaction.peak"][0]
    assert motion.peak_force("input") == pytest.approx(peak, rel=1e-9, abs=error)


def test_load_of_a_heavy_wheel__stands_in_the_frame_and_turns_in_the_shaft():
    motion = DrawnMotion(heavy_crank())
    frame, shaft = bearing_load(motion, "input.reaction"), bearing_load(motion, "input", "crank")
    assert np.allclose(frame.force, 30j, rtol=0, atol=1e-10)
    assert np.allclose(shaft.force, 30j * np.exp(-1j * motion.q), rtol=0, atol=1e-10)
    assert shares(frame)[90] == 1.0
    # 20 of 720 positions in 10°; one on an edge may go to either side.
    assert shares(shaft) == pytest.approx(np.full(360, 1 / 36), abs=1.01 / 720)
    # The middle of 240 whole degrees.
    assert least_loaded(frame) == pytest.approx(math.radians(270.5))


def test_bearing_load_of_a_guide__refused():
    with pytest.raises(PictureError, match=r"'drive\.second' is not a revolute pair"):
        bearing_load(motion_of("slider_crank"), "drive.second")


# Drawing


@given(st.floats(1e-12, 1e12))
@settings(max_examples=200)
def test_round_scale__at_most_half_as_large_again_and_one_of_the_series(least):
    scale = round_scale(least)
    # The series' widest step is from 1 to 1.5.
    assert least * (1 - 1e-9) <= scale <= 1.5 * least * (1 + 1e-9)
    digits = scale / 10.0 ** math.floor(math.log10(scale) + 1e-9)
    assert min(abs(digits - step) for step in (1, 1.5, 2, 2.5, 3, 4, 5, 6, 7.5, 10)) < 1e-9


def axes_on_paper(width=98.0, height=120.0):
    figure = Figure(figsize=(width / MM_PER_INCH, height / MM_PER_INCH))
    return figure.add_axes((0, 0, 1, 1))


def arrows_on_paper(ax):
    """Lengths on paper [mm] of shafts with their heads."""
    to_mm = MM_PER_INCH / ax.figure.dpi
    corners = [ax.transData.transform(patch.get_xy()) * to_mm for patch in ax.patches if hasattr(patch, "get_xy")]
    shafts = [line for line in ax.lines if line.get_zorder() == 7]
    starts = [ax.transData.transform(np.column_stack(line.get_data()))[0] * to_mm for line in shafts]
    return [math.dist(start, tip[0]) for start, tip in zip(starts, corners, strict=True)]


def test_vectors_on_paper__as_long_as_the_scale_says():
    ax = axes_on_paper()
    loads = force_plan(pose_at(motion_of("slider_crank"), 1.0), "drive", ax)
    (note,) = [text.get_text() for text in ax.texts if "mu_F" in text.get_text()]
    value, unit = note.split("= ")[1].removesuffix("/mm").split(" ")
    per_mm = float(value) * {"N": 1.0, "kN": 1e3}[unit]
    expected = [abs(load.force) / per_mm for load in loads]
    assert arrows_on_paper(ax) == pytest.approx([length for length in expected if length >= 0.4], rel=1e-9)


@pytest.mark.parametrize(
    "name", [*MECHANISMS, "PRP", "moving guide", "geared five-bar", "turning yoke", "racks", "planets", "rubbing cam"]
)
def test_plans_of_every_template__drawn_with_letters_clear_of_each_other(name):
    pose = pose_at(motion_of(name))
    drawn = [(draw_plan, (plan,)) for plan in (velocities(pose), accelerations(pose))]
    drawn += [(force_plan, (pose, group)) for group in pose.scene.groups if force_polygon(pose, group)]
    for draw, arguments in drawn:
        ax = axes_on_paper()
        draw(*arguments, ax)
        renderer = FigureCanvasAgg(ax.figure).get_renderer()
        boxes = [text.get_window_extent(renderer) for text in ax.texts]
        assert len(boxes) > 2
        page = ax.figure.bbox
        for box in boxes:
            assert box.x0 >= page.x0 - 1
            assert box.x1 <= page.x1 + 1
        for one, two in combinations(boxes, 2):
            wide = min(one.x1, two.x1) - max(one.x0, two.x0)
            high = min(one.y1, two.y1) - max(one.y0, two.y0)
            # Boxes hold the room of letters that aren't there, above and below: a third of a line may be shared.
            assert min(wide, high) < 4, (draw.__name__, one, two)


def test_mechanism_plan__numbers_of_racks_stand_at_their_bars():
    """However far the bar lies from the axes of its link: within the widest gap of letters, and their own size."""
    ax = axes_on_paper()
    pose = pose_at(motion_of("racks"), 0.6)
    paper = mechanism_plan(pose, ax)
    for rack in pose.scene.racks:
        middle = np.mean(next(p.points for p in rack_shapes(pose.motion, pose.k) if p.link == rack))
        (text,) = [t for t in ax.texts if t.get_text() == str(pose.number(rack)) and t.get_color() == BLUE]
        assert abs(complex(*text.get_position()) - middle) < 10 * paper.per_mm


def test_free_body__an_arrow_for_each_load_none_longer_than_the_longest():
    ax = axes_on_paper()
    loads = free_body(pose_at(motion_of("four_bar"), 1.0), "coupler", ax)
    lengths = arrows_on_paper(ax)
    forces, moments = sum(not load.is_moment for load in loads), sum(load.is_moment for load in loads)
    assert (forces, moments) == (4, 1)
    assert len(lengths) == forces + moments
    assert max(lengths) == pytest.approx(LONGEST, rel=1e-9)
    assert {text.get_text() for text in ax.texts} >= {load.text for load in loads}


# Files


def test_plan_pictures__a_sheet_for_each_plan(tmp_path, blank_pictures):
    made = plan_pictures(MACHINES["slider_crank"], tmp_path / "press.svg", math.radians(40))
    sheets = """velocity acceleration forces_crank forces_drive reactions bearing_input bearing_drive_first
    bearing_drive_inner"""
    assert [path.name for path in made] == [f"press_{sheet}.svg" for sheet in sheets.split()]


def test_plan_pictures_of_a_machine_without_masses_and_forces__kinematics_alone(tmp_path, blank_pictures):
    made = plan_pictures(four_bar(), tmp_path / "a.png")
    assert [path.name for path in made] == ["a_velocity.png", "a_acceleration.png"]


def test_reaction_pictures__bearings_of_the_fields_alone(tmp_path, blank_pictures):
    scene = MACHINES["slider_crank"]
    made = reaction_pictures(scene, tmp_path / "a.png", ["drive.inner.reaction", "ram.slide"])
    assert [path.name for path in made] == ["a_reactions.png", "a_bearing_drive_inner.png"]
    assert reaction_pictures(scene, tmp_path / "b.png", ["ram.slide"]) == []


def test_bearing_pictures__those_named_once_each(tmp_path, blank_pictures):
    made = bearing_pictures(MACHINES["slider_crank"], tmp_path / "a.svg", ("drive.inner", "input", "drive.inner"))
    assert [path.name for path in made] == ["a_bearing_drive_inner.svg", "a_bearing_input.svg"]
    with pytest.raises(PictureError, match="input is unloaded"):
        bearing_pictures(four_bar(), tmp_path / "b.svg", ["input"])


def test_plot_with_plans__made_at_the_first_angle_asked(folder, monkeypatch):
    asked = []
    monkeypatch.setattr("sweeps.pictures.plans.files.plan_pictures", lambda *arguments: asked.append(arguments) or [])
    scene = str(bundled_templates()["four_bar"])
    done("plot", scene, "--plans", "--at", "90,120", "--out", "a.svg")
    ((_, path, at),) = asked
    assert path.name == "a.svg"
    assert at == pytest.approx(math.pi / 2)


def test_position_that_cannot_be_drawn__refused():
    with pytest.raises(PictureError, match="outside the input's range"):
        pose_at(motion_of("sliding input"), 5.0)
