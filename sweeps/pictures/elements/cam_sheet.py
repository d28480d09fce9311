"""Sheet of a cam: the cam with its follower, and the courses of motion, pressure angle, curvature and forces."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engine import CamCurves, CamElement, cam_curves
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import BLUE, GREEN, GREY, ORANGE, PALE, VERMILION, sheet
from sweeps.text.engineer_units import engineer_unit

DEGREES = 180 / np.pi
# Curvatures beyond this many times the base circle's are left out of the diagram: edges have infinite ones.
MOST_CURVED = 30.0


def cam_sheet(cam: CamElement, target: Path | str | Figure, title: str = "") -> Figure:
    """Draw a cam with its follower, and courses over the turn.

    Parameters
    ----------
    cam : CamElement
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The cam can't be drawn, or the file's ending isn't a picture's, or it can't be written.
    """
    curves = cam_curves(cam)
    if not curves.angle.size:
        raise PictureError(f"{title or 'the cam'}: its follower doesn't reach the base circle; enlarge base_radius")
    with sheet(target, 180, 125, title) as figure:
        left, right = figure.subfigures(1, 2, width_ratios=(1, 1.15))
        _cam_with_follower(left.subplots(), cam, curves)
        _courses(right, cam, curves)
    return figure


def _cam_with_follower(ax: Axes, cam: CamElement, curves: CamCurves) -> None:
    """The cam at the angle of its greatest pressure angle, or velocity, on the rise; the contact's normal marked."""
    shown = curves.first if cam.follower.contact == "flat" else np.abs(curves.pressure_angle)
    at = int(np.argmax(np.where(curves.first > 0, shown, -1.0)))
    turned = np.exp(1j * curves.sense * curves.angle[at])
    profile, pitch, cutter = (1e3 * line * turned for line in (curves.profile, curves.pitch, curves.cutter))
    base = 1e3 * cam.base_radius * np.exp(1j * np.linspace(0, 2 * np.pi, 200))
    ax.fill(profile.real, profile.imag, facecolor="#eef1f4", edgecolor="black", linewidth=1.2, zorder=2)
    ax.plot(base.real, base.imag, color=GREY, linewidth=0.6, linestyle=(0, (4, 3)), label="base circle", zorder=3)
    if cam.follower.contact == "roller":
        ax.plot(pitch.real, pitch.imag, color=GREY, linewidth=0.6, linestyle=(0, (8, 2, 1, 2)), label="pitch curve")
    # The path of a grinding wheel would dwarf the cam.
    if cam.cutter_radius is not None and cam.cutter_radius <= cam.base_radius:
        ax.plot(cutter.real, cutter.imag, color=GREEN, linewidth=0.7, label="cutter's centre")
    ax.plot(0, 0, "+", color="black", markersize=8, zorder=4)
    contact, centre = 1e3 * curves.contact[at], 1e3 * curves.follower[at]
    size = float(np.abs(profile).max())
    pivot = None if cam.translating else 1e3 * cam.follower.pivot_distance
    _follower(ax, cam, contact, centre, size, pivot)
    normal = centre - contact if cam.follower.contact == "roller" else 0
    if normal:
        along = normal / abs(normal)
        motion = 1j if cam.translating else -1j * (centre - pivot) / abs(centre - pivot)
        for direction, colour, label in ((along, VERMILION, "normal"), (motion, BLUE, "motion of the follower")):
            ends = np.array([centre, centre + 0.55 * size * direction])
            ax.plot(ends.real, ends.imag, color=colour, linewidth=1.0, zorder=6, label=label)
    arrow = {"arrowstyle": "-|>", "color": "black", "connectionstyle": f"arc3,rad={0.5 * curves.sense}"}
    ends = [0.45 * cam.base_radius * 1e3 * np.exp(1j * curves.sense * a) for a in (-0.9, 0.7)]
    ax.annotate("", (ends[1].real, ends[1].imag), (ends[0].real, ends[0].imag), arrowprops=arrow, zorder=5)
    ax.set(aspect="equal", xlabel="mm")
    alpha = "" if cam.follower.contact == "flat" else f", α = {DEGREES * abs(curves.pressure_angle[at]):.1f}°"
    ax.set_title(f"At {DEGREES * curves.angle[at]:.1f}°{alpha}")
    ax.margins(0.06)
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=2)


def _follower(ax: Axes, cam: CamElement, contact: complex, centre: complex, size: float, pivot: float | None) -> None:
    """Roller, edge or face, and the stem or arm that carries it."""
    look = {"color": "black", "linewidth": 1.6, "zorder": 5, "solid_capstyle": "round"}
    if cam.follower.contact == "roller":
        roller = centre + abs(centre - contact) * np.exp(1j * np.linspace(0, 2 * np.pi, 120))
        ax.fill(roller.real, roller.imag, facecolor="white", edgecolor="black", linewidth=1.2, zorder=4)
        ax.plot(centre.real, centre.imag, "o", color="black", markersize=3, zorder=6)
    if cam.translating:
        if cam.follower.contact == "flat":
            half = 0.55 * size
            ax.plot([-half, half], [contact.imag] * 2, **look)
            centre = 1j * contact.imag
        ax.plot([centre.real] * 2, [centre.imag, centre.imag + 0.9 * size], **look)
        return
    end = centre if cam.follower.contact != "flat" else pivot + 1.35 * (contact - pivot)
    ax.plot([pivot, end.real], [0, end.imag], **look)
    ax.plot(pivot, 0, "o", color="black", markerfacecolor="white", markersize=6, zorder=6)


def _courses(figure: Figure, cam: CamElement, curves: CamCurves) -> None:
    """Courses over the cam's angle, one above the other."""
    flat, dynamic = cam.follower.contact == "flat", cam.follower.moved is not None
    stroke, rate = ("m", "m") if cam.translating else ("rad", "1")
    curvature = np.where(np.abs(curves.curvature) * cam.base_radius < MOST_CURVED, curves.curvature, np.nan)
    rows = [
        ("s", curves.displacement, stroke, BLUE),
        ("s′", curves.first, rate, BLUE),
        ("s″", curves.second, rate, BLUE),
        *([] if flat else [("α", curves.pressure_angle, "rad", VERMILION)]),
        ("κ", curvature, "", ORANGE),
        *([("N", curves.force, "N", GREEN), ("M", curves.moment, "N m", GREEN)] if dynamic else []),
    ]
    axes = figure.subplots(len(rows), 1, sharex=True)
    angle = DEGREES * curves.angle
    ends = [0.0]
    for section in cam.sections.values():
        rest = 2 * np.pi - sum(s.angle or 0.0 for s in cam.sections.values())
        ends.append(ends[-1] + DEGREES * (rest if section.angle is None else section.angle))
    for ax, (name, values, units, colour) in zip(axes, rows, strict=True):
        factor, unit = (1e-3, "1/mm") if name == "κ" else engineer_unit(units, values)
        for end in ends:
            ax.axvline(end, color=PALE, linewidth=0.8)
        ax.plot(angle, factor * values, color=colour)
        ax.set_ylabel(f"{name}, {unit}" if unit not in ("", "1") else name)
        ax.axhline(0, color="black", linewidth=0.5)
    axes[-1].set(xlabel="angle of the cam, °", xlim=(0, 360), xticks=range(0, 361, 60))
    figure.align_ylabels(axes)
