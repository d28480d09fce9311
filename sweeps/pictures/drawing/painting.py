"""Figures of a mechanism painted to scale on Matplotlib axes or to a file."""

from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.patches import Circle, PathPatch, Polygon
from matplotlib.path import Path as Outline
from matplotlib.patheffects import withStroke
from matplotlib.textpath import TextPath

from engine import Scene, display_unit
from sweeps.pictures.drawing.figures import default_position, figures
from sweeps.pictures.drawing.motion import DrawnMotion, position_text
from sweeps.pictures.drawing.symbols import Primitive
from sweeps.pictures.style import BLUE, MM_PER_INCH, NO_BREAK, VERMILION, sheet
from sweeps.report.readings import assembled_text

# Line width [pt] and darkness of each layer.
WIDTHS = {
    "frame": 1.0,
    "hatching": 0.5,
    "pitch": 0.6,
    "paths": 0.9,
    "links": 1.5,
    "joints": 1.1,
    "names": 0.8,
    "masses": 0.8,
    "forces": 1.1,
}
FILLS = {"none": "none", "paper": "white", "tint": "#e4e8ec", "solid": "black"}
DASHES = {"pitch": (0, (9, 2.5, 1.5, 2.5)), "paths": (0, (5, 2.5))}
# Layers painted on top.
ABOVE = ("joints", "names", "masses", "forces", "notes")
# Optional part of a title.
SCALE = "scale"
INKS = {"paths": VERMILION, "forces": BLUE}
GHOST = "#a8adb3"


def draw(
    drawn: Scene | DrawnMotion, ax: Axes, at: Sequence[float] = (), paths: Sequence[str] = (), shown: Sequence[str] = ()
) -> float:
    """Draw a mechanism to scale on Matplotlib axes.

    Parameters
    ----------
    drawn : Scene or DrawnMotion
    ax : matplotlib.axes.Axes
    at : sequence of float
        Crank angles [rad] or displacements of a sliding input [m]: the first in black, the others lightly. Default: the
        crank at 60°, a sliding input in mid-range.
    paths : sequence of str
        Points whose paths over the cycle are drawn dashed.
    shown : sequence of str
        Optional items for the first position, from `ANNOTATIONS`.

    Returns
    -------
    float
        Factor from metres to the unit of the axes.

    Raises
    ------
    PictureError
        A position can't be drawn, or an entry of `paths` or `shown` is unknown.
    """
    motion = DrawnMotion.of(drawn)
    poses = figures(motion, list(at) or [default_position(motion)], paths, shown)
    extent = bounds(q for pose in poses for q in pose)
    factor = prepare_axes(ax, extent, motion.radius)
    for pose in poses:
        paint(ax, pose, factor, ghost=pose is not poses[-1])
    return factor


def bounds(drawn: Iterable[Primitive]) -> tuple[complex, complex]:
    """Lower left and upper right corner of the box around figures, x + iy [m]."""
    reach = [
        (p.points, complex(0.37 * len(p.text), 0.5) * p.size if p.kind == "text" else complex(p.size, p.size))
        for p in drawn
    ]
    x = [c.real + s * half.real for points, half in reach for c in points for s in (-1, 1)]
    y = [c.imag + s * half.imag for points, half in reach for c in points for s in (-1, 1)]
    return complex(np.nanmin(x), np.nanmin(y)), complex(np.nanmax(x), np.nanmax(y))


def prepare_axes(ax: Axes, extent: tuple[complex, complex], radius: float) -> float:
    """Set equal scales, limits and labels; return the factor from metres to the displayed unit."""
    corners = np.array(extent)
    factor, label = display_unit("m", np.concatenate([corners.real, corners.imag]))
    limits = factor * corners + 2.5 * factor * radius * np.array([-1 - 1j, 1 + 1j])
    ax.set(xlim=limits.real, ylim=limits.imag)
    ax.set_aspect("equal")
    ax.grid(False)
    ax.set(xlabel=f"x, {label}", ylabel=f"y, {label}")
    ax.spines[["top", "right"]].set_visible(False)
    return factor


def paint(ax: Axes, drawn: Iterable[Primitive], factor: float, ghost: bool = False) -> None:
    """Paint figures on axes; secondary positions lightly."""
    for z, p in enumerate(drawn, 2):
        ink = INKS.get(p.layer, GHOST if ghost else "black")
        vertices = factor * np.column_stack([np.real(p.points), np.imag(p.points)])
        style = {
            "edgecolor": ink,
            "facecolor": {"solid": ink, "tint": "none" if ghost else FILLS["tint"]}.get(p.fill, FILLS[p.fill]),
            "linewidth": WIDTHS.get(p.layer, 0.0) * (0.6 if ghost else 1.0),
            "linestyle": "solid" if p.fill == "solid" else DASHES.get(p.layer, "solid"),
            "zorder": z / 1000 if ghost else 3 + (p.layer == "paths") + 2 * (p.layer in ABOVE) + z / 1000,
        }
        if p.kind == "text":
            ax.add_artist(_lettering(p, factor, style["zorder"]))
        elif p.kind == "circle":
            ax.add_artist(Circle(vertices[0], factor * p.size, **style))
        elif p.kind == "polygon":
            ax.add_artist(Polygon(vertices, joinstyle="round", **style))
        else:
            ax.add_artist(PathPatch(Outline(vertices), **{**style, "facecolor": "none"}, capstyle="round"))


def _lettering(p: Primitive, factor: float, zorder: float) -> PathPatch:
    """A name as letter outlines, so that it scales with the drawing."""
    family, style = ("DejaVu Sans", "normal") if p.layer == "notes" else ("DejaVu Serif", "italic")
    path = TextPath((0, 0), p.text, size=factor * p.size, prop=FontProperties(family=family, style=style))
    box = path.get_extents()
    at = p.points[0] * factor - complex(box.x0 + box.x1, box.y0 + box.y1) / 2
    moved = Outline(path.vertices + np.array([at.real, at.imag]), path.codes)
    letters = PathPatch(moved, facecolor="black", edgecolor="none", zorder=zorder)
    if p.layer == "notes":
        # A white outline interrupts the lines that a note crosses.
        letters.set_path_effects([withStroke(linewidth=2.0, foreground="white")])
    return letters


def picture(
    drawn: Scene | DrawnMotion, at: Sequence[float] = (), paths: Sequence[str] = (), shown: Sequence[str] = ()
) -> Figure:
    """Draw a mechanism on a figure, 160 mm wide at most.

    Arguments and errors as for `draw`; `SCALE` in `shown` adds the scale to the title.
    """
    motion = DrawnMotion.of(drawn)
    with sheet(160, 160) as fig:
        ax = fig.add_subplot()
        factor = draw(motion, ax, at, paths, [kind for kind in shown if kind != SCALE])
        title = ax.set_title(_title(motion, at), loc="left", wrap=True)
        width, height = np.ptp(ax.get_xlim()), np.ptp(ax.get_ylim())
        scale = min(145 / width, 200 / height)
        fig.set_size_inches((scale * width + 18) / MM_PER_INCH, (scale * height + 20) / MM_PER_INCH)
        if SCALE in shown:
            fig.draw_without_rendering()
            on_paper = ax.get_window_extent().width / fig.dpi * MM_PER_INCH / 1e3
            title.set_text(f"{title.get_text()}, scale {_scale(on_paper * factor / width)}")
    return fig


def _scale(ratio: float) -> str:
    """A drawing scale as text."""
    return f"1 : {1 / ratio:.3g}" if ratio < 1 else f"{ratio:.3g} : 1"


def _title(motion: DrawnMotion, at: Sequence[float]) -> str:
    """Title of the scene and position of its input, and where it can be assembled, if not everywhere."""
    scene = motion.scene
    # The position stays on one line.
    place = position_text(scene, at[0] if at else default_position(motion)).replace(" ", NO_BREAK)
    words = ", ".join(filter(None, (scene.title, place if at or scene.has_cycle else "")))
    return words if motion.assembled.all() else f"{words}\n{assembled_text(motion.machine.mechanics).partition(':')[0]}"
