"""Animated GIFs."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from PIL import Image

from engine import Scene, quantity_text
from sweeps.pictures import drawing
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import VERMILION, house_style
from sweeps.text.whole_files import new_file

DOTS_PER_INCH = 100
LARGEST_WIDTH, LARGEST_HEIGHT = 6.4, 6.4
# Time of a frame [ms]; browsers slow down ones below 20.
PACE = 50


class Frames(NamedTuple):
    """Positions of something that moves; `radius` is that of a hinge [m]."""

    poses: list[list[drawing.Primitive]]
    titles: list[str]
    radius: float


def machine_frames(scene: Scene, frames: int, paths: Sequence[str] = ()) -> Frames:
    """Positions of a mechanism over its motion; a limited input moves back and forth.

    Parameters
    ----------
    scene : Scene
    frames : int
    paths : sequence of str
        Points whose paths are drawn.

    Raises
    ------
    PictureError
        A position can't be drawn, or a point doesn't exist.
    """
    motion = drawing.DrawnMotion(scene)
    moments = _moments(motion, frames)
    poses = [[p for p in drawing.figures(motion, [at], paths)[-1] if p.layer != "names"] for at in moments]
    nodes = [motion.node(at) for at in moments]
    # The first position follows the last one.
    names = drawing.names_of_points(motion, [*nodes, nodes[0]], [*poses, poses[0]])
    whole = [[*pose, *beside] for pose, beside in zip(poses, names[:-1], strict=True)]
    return Frames(whole, [_instant(motion, at) for at in moments], motion.radius)


def save_animation(frames_of: Callable[[int], Frames], path: Path | str, frames: int = 60) -> None:
    """Write a motion as a looping GIF.

    Parameters
    ----------
    frames_of : callable
        Makes the frames of a cycle, by their number.
    path : path
        File to write (.gif).
    frames : int
        Frames per cycle; all are in memory at once.

    Raises
    ------
    PictureError
        The file's name doesn't end in .gif, or it can't be written.
    """
    if Path(path).suffix.lower() != ".gif":
        raise PictureError(f"{path}: animations are .gif files")
    pictures = _pictures(frames_of(frames))
    indexed = [picture.quantize(palette=_palette(), dither=Image.Dither.NONE) for picture in pictures]
    with new_file(path, PictureError.of) as draft:
        indexed[0].save(draft, save_all=True, append_images=indexed[1:], duration=PACE, loop=0)


def _moments(motion: drawing.DrawnMotion, frames: int) -> np.ndarray:
    """Positions of the frames, descending if the input runs backwards."""
    if motion.scene.has_cycle:
        share = np.arange(frames) / frames
        cycle = motion.q[-1] + motion.q[1]
        return cycle * (share if motion.numbers["input.speed"] >= 0 else -share)
    swing = (1 - np.cos(math.tau * np.arange(frames) / frames)) / 2
    return motion.q[0] + (motion.q[-1] - motion.q[0]) * swing


def _instant(motion: drawing.DrawnMotion, at: float) -> str:
    """Input position, and over a cycle the time at mean speed."""
    if not motion.scene.has_cycle:
        return drawing.position_text(motion.scene, at)
    time = quantity_text(float(at / motion.numbers["input.speed"]), "s")
    return f"{drawing.position_text(motion.scene, at)}, t = {time}"


def _palette() -> Image.Image:
    """The colours of a drawing and their blends with white for smoothed edges."""
    inks = np.array([to_rgb("black"), to_rgb(VERMILION)])
    shades = 1 - np.linspace(0, 1, 20)[:, None] * (1 - inks[:, None])
    shades = np.append(shades.reshape(-1, 3), [to_rgb(drawing.FILLS["tint"])], axis=0)
    holder = Image.new("P", (1, 1))
    holder.putpalette(np.rint(255 * shades).astype(int).ravel().tolist())
    return holder


def _pictures(shown: Frames) -> list[Image.Image]:
    """Each pose with its title, on fixed axes."""
    with house_style():
        figure = Figure(dpi=DOTS_PER_INCH, layout="constrained")
        canvas, ax = FigureCanvasAgg(figure), figure.add_subplot()
        factor = drawing.prepare_axes(ax, drawing.bounds(p for pose in shown.poses for p in pose), shown.radius)
        width, height = np.ptp(ax.get_xlim()), np.ptp(ax.get_ylim())
        scale = min((LARGEST_WIDTH - 0.7) / width, (LARGEST_HEIGHT - 0.6) / height)
        figure.set_size_inches(scale * width + 0.7, scale * height + 0.8)
        pictures = []
        for pose, title in zip(shown.poses, shown.titles, strict=True):
            ax.set_title(title, loc="left")
            for patch in list(ax.patches):
                patch.remove()
            drawing.paint(ax, pose, factor)
            canvas.draw()
            # The layout is fixed after the first frame.
            figure.set_layout_engine("none")
            pictures.append(Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB"))
    return pictures
