"""Manufacturing outlines of a cam: profile, pitch curve and cutter path at full size, as DXF or SVG."""

from pathlib import Path

import numpy as np

from engine import CamCurves, CamElement
from sweeps.pictures.drawing.dxf import save_dxf
from sweeps.pictures.drawing.symbols import line
from sweeps.pictures.elements.element_motion import reached_curves
from sweeps.pictures.picture_error import PictureError
from sweeps.report.files.cam_tables import cam_table
from sweeps.report.files.data_files import TABLE_ENDINGS, write_table
from sweeps.text.whole_files import new_file

MM = 1e3
# Chord error below a millionth of the radius.
POINTS = 3600
# AutoCAD colour index and line type, and SVG colour.
_LOOKS = {"profile": (7, "CONTINUOUS"), "pitch": (8, "CENTER"), "cutter": (3, "DASHED"), "axis": (1, "CONTINUOUS")}
_COLOURS = {"profile": "black", "pitch": "grey", "cutter": "green", "axis": "red"}
# SVG margin [mm].
MARGIN = 5.0
# Cross at the cam's axis [m].
_CROSS = ((-3e-3 + 0j, 3e-3 + 0j), (-3e-3j, 3e-3j))


def export_cam(cam: CamElement, out: Path) -> None:
    """Write a cam by file extension: a table, or outlines as .svg or .dxf, at the start of the cam's first section.

    Parameters
    ----------
    cam : CamElement
    out : Path

    Raises
    ------
    PictureError, InputError
        The follower doesn't reach the base circle, ezdxf isn't installed, or the file can't be written.
    """
    curves = reached_curves(cam, POINTS)
    if out.suffix in TABLE_ENDINGS:
        write_table(out, cam_table(cam, curves))
        return
    lines = _outlines(cam, curves)
    if out.suffix == ".dxf":
        figures = [line(*outline, outline[0], layer=name) for name, outline in lines.items()]
        figures += [line(*ends, layer="axis") for ends in _CROSS]
        save_dxf(out, figures, {name: _LOOKS[name] for name in (*lines, "axis")})
        return
    with new_file(out, PictureError.of) as draft:
        draft.write_text(_svg({name: MM * outline for name, outline in lines.items()}), encoding="utf8")


def _outlines(cam: CamElement, curves: CamCurves) -> dict[str, np.ndarray]:
    """Closed outlines by name, without repeated points [m]."""
    lines = {"profile": curves.profile}
    if cam.follower.contact == "roller":
        lines["pitch"] = curves.pitch
    if cam.cutter_radius is not None:
        lines["cutter"] = curves.cutter
    apart = {name: np.abs(np.roll(row, -1) - row) > 1e-9 * np.abs(row).max() for name, row in lines.items()}
    return {name: row[apart[name]] for name, row in lines.items()}


def _svg(lines: dict[str, np.ndarray]) -> str:
    every = np.concatenate([*lines.values(), [0j]])
    left, right = every.real.min() - MARGIN, every.real.max() + MARGIN
    low, high = every.imag.min() - MARGIN, every.imag.max() + MARGIN
    paths = {name: "M" + " ".join(f"{p.real:.6f},{-p.imag:.6f}" for p in line) + "Z" for name, line in lines.items()}
    paths["axis"] = " ".join(f"M{a.real:g},{-a.imag:g} {b.real:g},{-b.imag:g}" for a, b in MM * np.array(_CROSS))
    drawn = "\n".join(
        f'  <path id="{name}" d="{path}" fill="none" stroke="{_COLOURS[name]}" stroke-width="0.2"/>'
        for name, path in paths.items()
    )
    width, height = right - left, high - low
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.6f}mm" height="{height:.6f}mm" '
        f'viewBox="{left:.6f} {-high:.6f} {width:.6f} {height:.6f}">\n{drawn}\n</svg>\n'
    )
