"""Cams and gear trains in motion: followers stay on their cams, wheels roll on each other."""

import math

import numpy as np
import pytest
from commands import done, refused
from each_case import each
from PIL import Image

from engine import velocity_picture
from sweeps import read_scene
from sweeps.pictures.elements.element_motion import element_frames
from sweeps.text.templates import template_text

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


@each("follower", ["translating", "oscillating"])
@each("contact", ["roller", "knife edge", "flat"])
def test_followers_of_all_kinds__are_drawn(tmp_path, follower, contact):
    own = {
        "translating": 'type = "translating"',
        "oscillating": 'type = "oscillating"\narm = "60 mm"\npivot_distance = "80 mm"',
    }[follower]
    own = own.replace('arm = "60 mm"\n', "") if contact == "flat" else own
    roller = 'roller_radius = "10 mm"\n' if contact == "roller" else ""
    lift = 'lift = "10 mm"' if follower == "translating" else 'swing = "8 deg"'
    text = f"""[elements.cam]
type = "cam"
base_radius = "40 mm"
speed = "60 rpm"
[elements.cam.follower]
{own}
contact = "{contact}"
{roller}
[elements.cam.sections]
rise = {{ type = "rise", law = "cycloidal", angle = "120 deg", {lift} }}
back = {{ type = "return", law = "cycloidal" }}
"""
    shown = element_frames(element_of(tmp_path, text), 6)
    points = np.concatenate([p.points for pose in shown.poses for p in pose])
    assert np.isfinite(points).all()
