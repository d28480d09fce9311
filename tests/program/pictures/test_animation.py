"""Animations: as many frames as required, small, endless, names that move little."""

import math

import numpy as np
import pytest
from cam_samples import CAMS, cam_of
from commands import done, refused
from drawn_machines import four_bar, on_moving_guide, sliding_input
from each_case import each
from PIL import Image

from engine import velocity_picture
from sweeps import read_scene
from sweeps.pictures.drawing import DrawnMotion, moving_drawing, primitives
from sweeps.pictures.elements.element_motion import element_frames
from sweeps.pictures.machine.animation import machine_frames, save_animation
from sweeps.pictures.picture_error import PictureError
from sweeps.text.templates import template_text


@pytest.mark.parametrize("scene", [four_bar(), sliding_input()], ids=["crank", "sliding input"])
def test_animation__asked_frames_small_and_endless(scene, tmp_path):
    file = tmp_path / "a.gif"
    save_animation(lambda count: machine_frames(scene, count, ["B"]), file, frames=12)
    with Image.open(file) as gif:
        # Of a to-and-fro motion, the two frames before and after an end differ, so none is merged with another.
        assert gif.n_frames == 12
        assert gif.info["duration"] == 50
        assert gif.info["loop"] == 0
        assert gif.convert("RGB").getpixel((2, 2)) == (255, 255, 255)
    # 60 frames must stay below 2 MB.
    assert file.stat().st_size < 12 / 60 * 2e6


def test_animation_that_is_no_gif__refused(tmp_path):
    with pytest.raises(PictureError, match=r"are \.gif files"):
        save_animation(lambda count: machine_frames(four_bar(), count), tmp_path / "a.mp4")


INTERVALS = 12


@pytest.mark.parametrize(
    "scene", [four_bar(), sliding_input(), on_moving_guide()], ids=["crank", "sliding input", "moving guide"]
)
def test_moving_drawing__is_the_drawing_at_each_position(scene):
    motion = DrawnMotion(scene)
    drawing = moving_drawing(motion, INTERVALS)
    assert drawing.nodes.size == INTERVALS + 1
    assert (drawing.nodes[0] == drawing.nodes[-1]) == scene.has_cycle
    for k, node in enumerate(drawing.nodes):
        expected = [p for p in primitives(motion, motion.q[node]) if p.layer != "names" or p.kind != "text"]
        found = [figure for figure in drawing.figures if figure.look.kind != "text"]
        assert len(found) == len(expected)
        left = [(p.layer, p.kind, p.fill, np.array(p.points)) for p in expected]
        for figure in found:
            look, points = figure.look, drawing.points_of(figure)[k]
            same = next(
                i
                for i, (*kind, at) in enumerate(left)
                if kind == [look.layer, look.kind, look.fill]
                and at.shape == points.shape
                and np.abs(at - points).max() < 2e-3 * motion.radius
            )
            del left[same]
        assert not left


def test_moving_drawing__rigid_figures_are_kept_once():
    drawing = moving_drawing(DrawnMotion(four_bar()), INTERVALS)
    assert all(figure.places is None for figure in drawing.figures if figure.look.kind != "text")
    names = {figure.look.text for figure in drawing.figures if figure.look.kind == "text"}
    assert names == {"O", "A", "B", "D", "P"}


def test_moving_drawing__letters_never_sit_on_outlines():
    motion = DrawnMotion(four_bar())
    drawing = moving_drawing(motion, 60)
    texts = [figure for figure in drawing.figures if figure.look.kind == "text"]
    lines = [figure for figure in drawing.figures if figure.look.kind in ("line", "polygon")]
    share = np.linspace(0, 1, 200)[:, None]
    crossed = set()
    for k in range(drawing.nodes.size):
        corners = [drawing.points_of(figure)[k] for figure in lines]
        outlines = np.concatenate([np.ravel(c[:-1] + share * np.diff(c)) for c in corners])
        for text in texts:
            away = outlines - drawing.points_of(text)[k, 0]
            letter = 0.3 * len(text.look.text) * text.look.size, 0.4 * text.look.size
            if ((np.abs(away.real) < letter[0]) & (np.abs(away.imag) < letter[1])).any():
                crossed.add((text.look.text, k))
    assert not crossed


def test_names_of_a_cycle__end_where_they_start_and_move_little():
    motion = DrawnMotion(four_bar())
    drawing = moving_drawing(motion, 120)
    for text in (figure for figure in drawing.figures if figure.look.kind == "text"):
        places = drawing.points_of(text)[:, 0] - motion.points[text.look.text][drawing.nodes]
        assert places[0] == pytest.approx(places[-1])
        assert np.abs(np.diff(places)).max() < 2.5 * text.look.size


# Cams and gear trains in motion: followers stay on their cams, wheels roll on each other.


CAM = template_text("cam")


def element_of(folder, text):
    path = folder / "scene.toml"
    path.write_text(text, encoding="utf8")
    return next(iter(read_scene(path).elements.values()))


def circles(pose, radius):
    return [p.points[0] for p in pose if p.kind == "circle" and p.size == pytest.approx(radius)]


def test_roller__touches_its_cam_at_every_position(tmp_path):
    cam = element_of(tmp_path, CAM)
    shown = element_frames(cam, 24)
    lifts = []
    for pose in shown.poses:
        profile = max((np.array(p.points) for p in pose if p.kind == "line"), key=len)
        (centre,) = circles(pose, cam.follower.roller_radius)
        # Chords of half a degree lie within the arc by a hundred-thousandth of its radius.
        assert np.abs(profile - centre).min() == pytest.approx(cam.follower.roller_radius, rel=1e-3)
        lifts.append(centre.imag)
    assert max(lifts) - min(lifts) == pytest.approx(0.018, rel=1e-3)
    assert shown.titles[0].startswith("φ = 0°")


def test_planets__roll_on_sun_and_ring(tmp_path):
    """Between two frames the spokes of both wheels of a mesh turn past their line of centres by the same arc."""
    train = element_of(tmp_path, template_text("planetary_train"))
    wheels = velocity_picture(train).wheels
    frames = 720
    poses = element_frames(train, frames).poses[:2]

    def seen(pose, name):
        """Centre and angle of the first wheel of a name."""
        centre = circles(pose, wheels[name].radius)[0]
        at = next(k for k, p in enumerate(pose) if p.kind == "circle" and p.size == pytest.approx(wheels[name].radius))
        spoke = next(p for p in pose[at:] if p.kind == "line")
        return centre, np.angle(spoke.points[1] - centre)

    turns = {}
    for name in wheels:
        (_, before), (_, after) = (seen(pose, name) for pose in poses)
        turns[name] = math.remainder(after - before, math.tau)
    (before, _), (after, _) = (seen(pose, "planet") for pose in poses)
    arm = np.angle(after / before)
    assert abs(arm) == pytest.approx(math.tau / frames, rel=1e-6)
    sun, planet, ring = (wheels[name].radius * (turns[name] - arm) for name in ("sun", "planet", "ring"))
    assert sun == pytest.approx(-planet, rel=1e-6)
    assert ring == pytest.approx(planet, rel=1e-6)
    assert len(circles(poses[0], wheels["planet"].radius)) == 3


def test_animate__of_elements_and_of_a_rocking_crank(folder):
    for name in ("cam", "planetary_train"):
        (folder / f"{name}.toml").write_text(template_text(name), encoding="utf8")
        done("animate", f"{name}.toml", "--frames", "8")
        with Image.open(folder / f"{name}.gif") as gif:
            assert gif.n_frames == 8


def test_animate__names_what_it_can_show(folder):
    (folder / "cam.toml").write_text(CAM, encoding="utf8")
    (folder / "rotor.toml").write_text(template_text("rotor"), encoding="utf8")
    assert "name a cam or gear train of this scene: cam" in refused("animate", "cam.toml", "--element", "camm")
    assert "only machine elements" in refused("animate", "rotor.toml")


@each("name", CAMS)
def test_followers_of_all_kinds__are_drawn(name):
    points = [p.points for pose in element_frames(cam_of(CAMS[name]), 6).poses for p in pose]
    assert np.isfinite(np.concatenate(points)).all()
