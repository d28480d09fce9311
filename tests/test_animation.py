"""Animations: as many frames as asked for, small, endless."""

import pytest
from drawn_machines import four_bar, sliding_input
from PIL import Image

from sweeps.animation import animate
from sweeps.errors import PictureError


@pytest.mark.parametrize("scene", [four_bar(), sliding_input()], ids=["crank", "sliding input"])
def test_animation__asked_frames_small_and_endless(scene, tmp_path):
    file = tmp_path / "a.gif"
    animate(scene, file, frames=12, fps=20, paths=["B"])
    with Image.open(file) as gif:
        # Of a to-and-fro motion, the two frames before and after an end differ, so none is merged with another.
        assert gif.n_frames == 12
        assert gif.info["duration"] == 50
        assert gif.info["loop"] == 0
        assert gif.convert("RGB").getpixel((2, 2)) == (255, 255, 255)
    # 60 frames must stay below 2 MB.
    assert file.stat().st_size < 12 / 60 * 2e6


@pytest.mark.parametrize(
    ("file", "settings_", "words"),
    [("a.mp4", {}, "a .gif file"), ("a.gif", {"frames": 2}, "frames = 2"), ("a.gif", {"fps": 90}, "fps = 90")],
)
def test_animation_with_wrong_settings__refused(file, settings_, words, tmp_path):
    with pytest.raises(PictureError, match=words):
        animate(four_bar(), tmp_path / file, **settings_)
