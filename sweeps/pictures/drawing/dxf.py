"""DXF drawing of a mechanism: layers, millimetres or inches, hidden lines removed."""

import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from engine import Scene, table_unit
from sweeps.pictures.drawing import DrawnMotion, Primitive, primitives
from sweeps.pictures.picture_error import PictureError
from sweeps.text.whole_files import new_file

if TYPE_CHECKING:
    from ezdxf.document import Drawing
    from ezdxf.layouts import Modelspace

# Drawing units per metre.
_MM, _IN = 1000.0, 1.0 / 0.0254
# AutoCAD colour index (7 is black on white) and line type.
_LOOKS = {
    "frame": (7, "CONTINUOUS"),
    "hatching": (8, "CONTINUOUS"),
    "pitch": (8, "CENTER"),
    "paths": (1, "DASHED"),
    "links": (7, "CONTINUOUS"),
    "joints": (7, "CONTINUOUS"),
    "names": (5, "CONTINUOUS"),
}
# Errors from a corrupt font list.
_GARBLED = (ValueError, TypeError, LookupError, AttributeError)


def per_metre() -> float:
    """Drawing units per metre: inches in the inch-pound system, otherwise millimetres."""
    return _IN if table_unit("m")[1] in ("in", "ft") else _MM


def new_document() -> "Drawing":
    """An empty drawing in inches or millimetres, as for `per_metre`.

    Raises
    ------
    PictureError
        ezdxf isn't installed, or its font list is corrupt and can't be removed.
    """
    fonts = Path(os.environ.get("XDG_CACHE_HOME", "~/.cache")).expanduser() / "ezdxf" / "font_manager_cache.json"
    try:
        try:
            import ezdxf
        except _GARBLED:
            # On import it reads or creates its font list.
            fonts.unlink()
            for name in [name for name in sys.modules if name.partition(".")[0] == "ezdxf"]:
                del sys.modules[name]
            import ezdxf
    except ImportError:
        raise PictureError("DXF needs the package ezdxf: pip install 'machine-sweeps[dxf]'") from None
    except (OSError, *_GARBLED):
        raise PictureError(f"DXF: ezdxf can't read its font list {fonts}: delete that file") from None
    units = ezdxf.units.IN if per_metre() == _IN else ezdxf.units.MM
    return ezdxf.new("R2010", setup=["linetypes"], units=units)


def write_dxf(path: Path | str, drawn: Scene | DrawnMotion, phi: float) -> None:
    """Write a mechanism at one position as DXF (R2010, mm or inches), on the layers of `sweeps.pictures.drawing`.

    Parameters
    ----------
    path : path
        File to write.
    drawn, phi
        As for `sweeps.pictures.drawing.primitives`.

    Raises
    ------
    PictureError
        ezdxf isn't installed, the mechanism can't be drawn, or the file can't be written.
    """
    save_dxf(path, primitives(drawn, phi), _LOOKS)


def save_dxf(path: Path | str, shown: Sequence[Primitive], looks: Mapping[str, tuple[int, str]]) -> None:
    """Write figures as DXF (R2010, mm or inches), without the lines that later ones hide.

    Parameters
    ----------
    path : path
        File to write.
    shown : sequence of Primitive
    looks : mapping of str to (int, str)
        AutoCAD colour index and line type of each layer.

    Raises
    ------
    PictureError
        ezdxf isn't installed, or the file can't be written.
    """
    document = new_document()
    for layer, (colour, line) in looks.items():
        document.layers.add(layer, color=colour, linetype=line)
    space = document.modelspace()
    for p in shown:
        if p.kind == "text":
            # Dash length equals text height.
            document.header["$LTSCALE"] = per_metre() * p.size
    for i, p in enumerate(shown):
        covers = [outline for q in shown[i + 1 :] if (outline := _cover(q)) is not None]
        _add(space, p, covers)
    with new_file(path, PictureError.of) as draft:
        document.saveas(draft)


def _add(space: "Modelspace", p: Primitive, covers: list[np.ndarray]) -> None:
    """Add a figure to a drawing without the lines that later figures hide."""
    from ezdxf.enums import TextEntityAlignment

    look = {"layer": p.layer}
    if p.kind == "text":
        text = space.add_text(p.text, height=per_metre() * 0.7 * p.size, dxfattribs=look)
        text.set_placement(_point(p.points[0]), align=TextEntityAlignment.MIDDLE_CENTER)
    elif p.kind == "circle":
        space.add_circle(_point(p.points[0]), per_metre() * p.size, dxfattribs=look)
        if p.fill == "solid":
            dot = space.add_hatch(dxfattribs=look)
            dot.paths.add_edge_path().add_arc(_point(p.points[0]), per_metre() * p.size)
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
                # A closed outline, such as a cam's, stays one polyline.
                closed = run[0] == run[-1]
                corners = run[:-1] if closed else run
                space.add_lwpolyline([_point(c) for c in corners], close=closed, dxfattribs=look)


def _point(c: complex) -> tuple[float, float]:
    return per_metre() * c.real, per_metre() * c.imag


def _cover(p: Primitive) -> np.ndarray | None:
    """Counter-clockwise outline that hides earlier lines."""
    if p.fill == "none":
        return None
    corners = p.outline(24)[:-1]
    turn = (corners * np.roll(corners, 1).conj()).imag.sum()
    return corners if turn > 0 else corners[::-1]


def _visible(segments: Iterable[tuple[complex, complex]], covers: list[np.ndarray]) -> list[tuple[complex, complex]]:
    """Segments clipped to outside convex outlines."""
    left = list(segments)
    for cover in covers:
        left = [piece for segment in left for piece in _outside(*segment, cover)]
    return left


def _joined(segments: Iterable[tuple[complex, complex]]) -> list[list[complex]]:
    """Chains of connected segments."""
    runs: list[list[complex]] = []
    for a, b in segments:
        if runs and runs[-1][-1] == a:
            runs[-1].append(b)
        else:
            runs.append([a, b])
    return runs


def _outside(a: complex, b: complex, cover: np.ndarray) -> list[tuple[complex, complex]]:
    """Parts of the segment from a to b outside a convex outline (Cyrus and Beck)."""
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
