"""Animations: as many frames as required, small, endless, names that move little."""

import numpy as np
import pytest
from drawn_machines import four_bar, on_moving_guide, sliding_input
from PIL import Image

from engine import has_cycle
from sweeps.pictures.drawing import DrawnMotion, moving_drawing, primitives
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


INTERVALS = 12


@pytest.mark.parametrize(
    "scene", [four_bar(), sliding_input(), on_moving_guide()], ids=["crank", "sliding input", "moving guide"]
)
def test_moving_drawing__is_the_drawing_at_each_position(scene):
    motion = DrawnMotion(scene)
    drawing = moving_drawing(motion, INTERVALS)
    assert drawing.nodes.size == INTERVALS + 1
    assert (drawing.nodes[0] == drawing.nodes[-1]) == has_cycle(scene)
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
