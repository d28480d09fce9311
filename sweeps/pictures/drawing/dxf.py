"""A mechanism as a DXF drawing for CAD programs: layers, millimetres, hidden lines left out."""

import os
import sys
from collections.abc import Iterable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from engine import Scene
from sweeps.pictures.drawing import DrawnMotion, Primitive, primitives
from sweeps.pictures.picture_error import PictureError
from sweeps.text.whole_files import whole_file

if TYPE_CHECKING:
    from ezdxf.document import Drawing
    from ezdxf.layouts import Modelspace

MM = 1000.0
# Colours by AutoCAD's index (7 is black on white) and line types.
_LOOKS = {
    "frame": (7, "CONTINUOUS"),
    "hatching": (8, "CONTINUOUS"),
    "pitch": (8, "CENTER"),
    "paths": (1, "DASHED"),
    "links": (7, "CONTINUOUS"),
    "joints": (7, "CONTINUOUS"),
    "names": (5, "CONTINUOUS"),
}
# What reading a garbled list of fonts may end in.
_GARBLED = (ValueError, TypeError, LookupError, AttributeError)


def new_document() -> "Drawing":
    """An empty drawing in millimetres.

    Raises
    ------
    PictureError
        The package ezdxf isn't installed, or what it keeps of this machine's fonts is garbled and can't be removed.
    """
    fonts = Path(os.environ.get("XDG_CACHE_HOME", "~/.cache")).expanduser() / "ezdxf" / "font_manager_cache.json"
    try:
        try:
            import ezdxf
        except _GARBLED:
            # It reads its list of fonts as it is imported, and makes one where there is none.
            fonts.unlink()
            for name in [name for name in sys.modules if name.partition(".")[0] == "ezdxf"]:
                del sys.modules[name]
            import ezdxf
    except ImportError:
        raise PictureError("DXF needs the package ezdxf: pip install 'machine-sweeps[dxf]'") from None
    except (OSError, *_GARBLED):
        raise PictureError(f"DXF: ezdxf can't read its list of fonts, {fonts}: remove it") from None
    return ezdxf.new("R2010", setup=["linetypes"], units=ezdxf.units.MM)


def write_dxf(path: Path | str, drawn: Scene | DrawnMotion, phi: float, paths: Sequence[str] = ()) -> None:
    """Write a mechanism at one position as DXF (R2010, millimetres), on the layers of `sweeps.pictures.drawing`.

    Parameters
    ----------
    path : path
        File to write.
    drawn, phi, paths
        As for `sweeps.pictures.drawing.primitives`.

    Raises
    ------
    PictureError
        The package ezdxf isn't installed, the mechanism can't be drawn so, or the file can't be written.
    """
    document = new_document()
    for layer, (colour, line) in _LOOKS.items():
        document.layers.add(layer, color=colour, linetype=line)
    space = document.modelspace()
    shown = primitives(drawn, phi, paths)
    # Dashes as long as the names are high.
    document.header["$LTSCALE"] = MM * next(p.size for p in shown if p.kind == "text")
    for i, p in enumerate(shown):
        covers = [outline for q in shown[i + 1 :] if (outline := _cover(q)) is not None]
        _add(space, p, covers)
    try:
        with whole_file(path) as draft:
            document.saveas(draft)
    except OSError as error:
        raise PictureError(f"{path} can't be written: {error.strerror}") from None


def _add(space: "Modelspace", p: Primitive, covers: list[np.ndarray]) -> None:
    """Add a figure to a drawing, without what later figures hide of its lines."""
    from ezdxf.enums import TextEntityAlignment

    look = {"layer": p.layer}
    if p.kind == "text":
        text = space.add_text(p.text, height=MM * 0.7 * p.size, dxfattribs=look)
        text.set_placement(_point(p.points[0]), align=TextEntityAlignment.MIDDLE_CENTER)
    elif p.kind == "circle":
        space.add_circle(_point(p.points[0]), MM * p.size, dxfattribs=look)
        if p.fill == "solid":
            dot = space.add_hatch(dxfattribs=look)
            dot.paths.add_edge_path().add_arc(_point(p.points[0]), MM * p.size)
    elif p.layer == "paths":
        space.add_lwpolyline([_point(c) for c in p.points], dxfattribs=look)
    elif p.fill == "solid":
        corners = [_point(c) for c in p.points]
        space.add_solid([*corners, corners[-1]][:4], dxfattribs=look)
    else:
        ends = p.points + p.points[:1] if p.kind == "polygon" else p.points
        for run in _joined(_visible(pairwise(ends), covers)):
            if len(run) == 2:
                space.add_line(*(_point(c) for c in run), dxfattribs=look)
            else:
                # An outline in one piece, such as a cam's, can be taken over whole.
                closed = run[0] == run[-1]
                corners = run[:-1] if closed else run
                space.add_lwpolyline([_point(c) for c in corners], close=closed, dxfattribs=look)


def _point(c: complex) -> tuple[float, float]:
    return MM * c.real, MM * c.imag


def _cover(p: Primitive) -> np.ndarray | None:
    """Outline, counter-clockwise, of what hides the lines painted before it."""
    if p.fill == "none":
        return None
    if p.kind == "circle":
        return p.points[0] + p.size * np.exp(2j * np.pi * np.arange(24) / 24)
    corners = np.array(p.points)
    turn = (corners * np.roll(corners, 1).conj()).imag.sum()
    return corners if turn > 0 else corners[::-1]


def _visible(segments: Iterable[tuple[complex, complex]], covers: list[np.ndarray]) -> list[tuple[complex, complex]]:
    """What convex outlines leave of segments."""
    left = list(segments)
    for cover in covers:
        left = [piece for segment in left for piece in _outside(*segment, cover)]
    return left


def _joined(segments: Iterable[tuple[complex, complex]]) -> list[list[complex]]:
    """Chains of segments that each begin where the last one ends."""
    runs: list[list[complex]] = []
    for a, b in segments:
        if runs and runs[-1][-1] == a:
            runs[-1].append(b)
        else:
            runs.append([a, b])
    return runs


def _outside(a: complex, b: complex, cover: np.ndarray) -> list[tuple[complex, complex]]:
    """What a convex outline leaves of the segment from a to b (Cyrus and Beck)."""
    sides = np.roll(cover, -1) - cover
    inward = 1j * sides
    start, rate = ((a - cover) * inward.conj()).real, ((b - a) * inward.conj()).real
    # A line along a side is on the outline, not behind it.
    near = 1e-9 * np.abs(sides) ** 2
    parallel = np.abs(rate) <= near
    if (parallel & (start <= near)).any():
        return [(a, b)]
    moving = ~parallel
    at = -start[moving] / rate[moving]
    enter = max(0.0, *at[rate[moving] > 0], -1.0)
    leave = min(1.0, *at[rate[moving] < 0], 2.0)
    if leave - enter <= 1e-9:
        return [(a, b)]
    pieces = [(a, a + enter * (b - a)), (a + leave * (b - a), b)]
    return [piece for piece in pieces if abs(piece[1] - piece[0]) > 1e-9 * abs(b - a)]
