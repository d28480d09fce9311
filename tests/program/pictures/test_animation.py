"""Animations: as many frames as asked for, small, endless."""

import pytest
from drawn_machines import four_bar, sliding_input
from PIL import Image

from sweeps.pictures import drawing
from sweeps.pictures.drawing import paint
from sweeps.pictures.machine.animation import machine_frames, save_animation
from sweeps.pictures.picture_error import PictureError


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


@pytest.mark.parametrize(
    ("file", "frames", "words"), [("a.mp4", 60, "are .gif files"), ("a.gif", 2, "frames = 2: allowed are 4 to 1000")]
)
def test_animation_with_wrong_settings__refused(file, frames, words, tmp_path):
    with pytest.raises(PictureError, match=words):
        save_animation(lambda count: machine_frames(four_bar(), count), tmp_path / file, frames=frames)


@pytest.mark.parametrize("scene", [four_bar(), sliding_input()], ids=["crank", "sliding input"])
def test_names_of_joints__go_along_with_them(scene, tmp_path, monkeypatch):
    poses = []

    def painted(ax, drawn, factor):
        poses.append(list(drawn))
        paint(ax, drawn, factor)

    monkeypatch.setattr(drawing, "paint", painted)
    save_animation(lambda count: machine_frames(scene, count), tmp_path / "a.gif", frames=8)
    assert len(poses) == 8
    offsets, heights = {}, {}
    for pose in poses:
        joints = {p.text: p.points[0] for p in pose if p.layer == "joints" and p.text}
        names = {p.text: p.points[0] for p in pose if p.kind == "text"}
        heights |= {p.text: p.size for p in pose if p.kind == "text"}
        assert set(names) == set(joints) != set()
        for name, place in names.items():
            offsets.setdefault(name, []).append(place - joints[name])
    for name, away in offsets.items():
        assert all(0 < abs(a) < 5 * heights[name] for a in away), name
