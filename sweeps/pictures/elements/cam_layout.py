"""A cam with its follower, to scale."""

import math

import numpy as np
from matplotlib.axes import Axes

from engine import CamElement, cam_curves, display_unit
from sweeps.pictures.drawing import bounds, paint
from sweeps.pictures.elements.element_motion import follower_figures, hinge_radius
from sweeps.pictures.style import BLUE, GREEN, GREY, VERMILION

DEGREES = 180 / np.pi


def cam_layout(ax: Axes, cam: CamElement) -> None:
    """The cam at its maximum pressure angle, or velocity, during the rise, with the contact normal."""
    curves = cam_curves(cam)
    shown = curves.first if cam.follower.contact == "flat" else np.abs(curves.pressure_angle)
    factor, unit = display_unit("m", np.abs(curves.profile))
    at = int(np.argmax(np.where(curves.first > 0, shown, -1.0)))
    turned = np.exp(1j * curves.sense * curves.angle[at])
    profile, pitch, cutter = (factor * line * turned for line in (curves.profile, curves.pitch, curves.cutter))
    base = factor * cam.base_radius * np.exp(1j * np.linspace(0, math.tau, 200))
    ax.fill(profile.real, profile.imag, facecolor="#eef1f4", edgecolor="black", linewidth=1.2, zorder=2)
    ax.plot(base.real, base.imag, color=GREY, linewidth=0.6, linestyle=(0, (4, 3)), label="base circle", zorder=3)
    if cam.follower.contact == "roller":
        ax.plot(pitch.real, pitch.imag, color=GREY, linewidth=0.6, linestyle=(0, (8, 2, 1, 2)), label="pitch curve")
    # A grinding wheel's path would dwarf the cam.
    if cam.cutter_radius is not None and cam.cutter_radius <= cam.base_radius:
        ax.plot(cutter.real, cutter.imag, color=GREEN, linewidth=0.7, label="cutter centre")
    ax.plot(0, 0, "+", color="black", markersize=8, zorder=4)
    contact, centre = factor * curves.contact[at], factor * curves.follower[at]
    size = float(np.abs(profile).max())
    pivot = None if cam.translating else factor * cam.follower.pivot_distance
    follower = follower_figures(cam, curves, at, hinge_radius(curves))
    paint(ax, follower, factor)
    ax.update_datalim(factor * np.array([(c.real, c.imag) for c in bounds(follower)]))
    normal = centre - contact if cam.follower.contact == "roller" else 0
    if normal:
        along = normal / abs(normal)
        motion = 1j if cam.translating else -1j * (centre - pivot) / abs(centre - pivot)
        for direction, colour, label in ((along, VERMILION, "normal"), (motion, BLUE, "follower motion")):
            ends = np.array([centre, centre + 0.55 * size * direction])
            ax.plot(ends.real, ends.imag, color=colour, linewidth=1.0, zorder=6, label=label)
    arrow = {"arrowstyle": "-|>", "color": "black", "connectionstyle": f"arc3,rad={0.5 * curves.sense}"}
    ends = [0.45 * cam.base_radius * factor * np.exp(1j * curves.sense * a) for a in (-0.9, 0.7)]
    ax.annotate("", (ends[1].real, ends[1].imag), (ends[0].real, ends[0].imag), arrowprops=arrow, zorder=5)
    ax.set(aspect="equal", xlabel=unit)
    alpha = "" if cam.follower.contact == "flat" else f", α = {DEGREES * abs(curves.pressure_angle[at]):.1f}°"
    ax.set_title(f"Drawn at {DEGREES * curves.angle[at]:.1f}°{alpha}")
    ax.margins(0.06)
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=2)
