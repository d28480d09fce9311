"""Plan of a rotor's balancing: the polygons of unbalances and of their moments, and what the bearings' planes see."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engine import (
    RotorElement,
    StaticRotor,
    corrected_unbalance,
    permissible_unbalance,
    resultant_unbalance,
    rotor_corrections,
    rotor_unbalances,
    tolerance_shares,
    unbalance_in_two_planes,
)
from sweeps.pictures.style import BLUE, GREEN, GREY, PALE, VERMILION, sheet

# From SI: kg m to kg mm and to g mm.
KG_MM, G_MM = 1e3, 1e6


class RotorPlan(NamedTuple):
    """What is drawn of a rotor.

    Attributes
    ----------
    names : tuple of str
        Of the unbalances, then of the planes.
    unbalances, positions : ndarray (unbalances + planes,)
        Complex [kg·m], those of the planes as added, and where [m].
    corrections : int
        Number of the planes.
    bearings : ndarray (3, 2)
        Unbalance before and after, and the permissible one, in the bearings' planes [kg·m].
    """

    names: tuple[str, ...]
    unbalances: np.ndarray
    positions: np.ndarray
    corrections: int
    bearings: np.ndarray


def plan_of(rotor: RotorElement) -> RotorPlan:
    """Compute a rotor's plan.

    Parameters
    ----------
    rotor : RotorElement
    """
    n = rotor.own_numbers()
    given, where = rotor_unbalances(rotor, n)
    before = resultant_unbalance(given, where, n["centre"])
    made, planes, _ = rotor_corrections(rotor, n, before)
    bearings = n["first_bearing"], n["second_bearing"]
    after = corrected_unbalance(before, made, planes)
    states = [unbalance_in_two_planes(state, *bearings) for state in (before, after)]
    allowed = permissible_unbalance(n["grade"], n["mass"], n["speed"]) * np.array(
        tolerance_shares(n["centre"], *bearings)
    )
    return RotorPlan(
        (*rotor.unbalances, *rotor.planes),
        np.concatenate([given[0], made[0]]),
        np.concatenate([where[0], planes[0]]),
        len(rotor.planes),
        np.concatenate([np.abs(states)[..., 0], allowed.T]),
    )


def unbalance_plan(rotor: RotorElement, target: Path | str | Figure, title: str = "") -> Figure:
    """Polygons of unbalances and of moments about the first plane, and the bearings' planes before and after.

    Parameters
    ----------
    rotor : RotorElement
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's.
    """
    plan = plan_of(rotor)
    with sheet(target, 180, 78, title) as figure:
        axes = figure.subplots(1, 3, width_ratios=(1, 1, 0.7))
        _polygon(axes[0], plan, plan.unbalances * KG_MM, "Unbalances, kg·mm")
        arms = plan.positions - plan.positions[-plan.corrections]
        _polygon(
            axes[1],
            plan,
            plan.unbalances * arms * KG_MM,
            f"Moments about plane {plan.names[-plan.corrections]}, kg·mm·m",
        )
        _bearings(axes[2], plan)
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def static_plan(rotor: StaticRotor, target: Path | str | Figure, title: str = "") -> Figure:
    """Polygon of a flat rotor's unbalances, closed by the mass that balances it.

    Parameters
    ----------
    rotor : StaticRotor
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written.
    """
    given = np.array([u.mass * u.radius * np.exp(1j * u.angle) for u in rotor.unbalances.values()])
    vectors = np.append(given, -given.sum())
    plan = RotorPlan((*rotor.unbalances, "correction"), vectors, np.zeros(vectors.size), 1, np.zeros((3, 2)))
    with sheet(target, 110, 112, title) as figure:
        ax = figure.subplots()
        _polygon(ax, plan, vectors * KG_MM, "Unbalances, kg·mm")
        figure.legend(*ax.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


def _polygon(ax: Axes, plan: RotorPlan, vectors: np.ndarray, title: str) -> None:
    """Vectors one after another, the corrections closing what the unbalances leave open."""
    ends = np.cumsum(vectors)
    starts = np.concatenate([[0], ends[:-1]])
    own = len(vectors) - plan.corrections
    looks = [(BLUE, "unbalance")] * own + [(GREEN, "correction, as made")] * plan.corrections
    size = np.abs(ends).max()
    for k, (start, vector, (colour, label)) in enumerate(zip(starts, vectors, looks, strict=True)):
        if abs(vector) > 1e-9 * size:
            _arrow(ax, start, vector, colour, label if k in (0, own) else None)
            middle, aside = start + vector / 2, -1j * vector / abs(vector)
            side = {"ha": "left" if aside.real > 0 else "right", "va": "bottom" if aside.imag > 0 else "top"}
            ax.annotate(
                plan.names[k], (middle.real, middle.imag), (3 * aside.real, 3 * aside.imag), color=colour, fontsize=7,
                textcoords="offset points", **side,
            )  # fmt: skip
    _arrow(ax, 0, ends[own - 1], GREY, "resultant before", (0, (4, 2)))
    ax.plot(ends[-1].real, ends[-1].imag, "o", color=VERMILION, markersize=4, label="end: what remains, from 0")
    ax.plot(0, 0, "+", color="black", markersize=7)
    ax.set(title=title, aspect="equal", adjustable="datalim")
    ax.margins(x=0.35, y=0.25)


def _arrow(
    ax: Axes, start: complex, vector: complex, colour: str, label: str | None, dashes: tuple | str = "-"
) -> None:
    end = start + vector
    ax.plot([start.real, end.real], [start.imag, end.imag], color=colour, linestyle=dashes, linewidth=1.3, label=label)
    tip = {"arrowstyle": "-|>", "color": colour, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 8, "linewidth": 0}
    ax.annotate(
        "", (end.real, end.imag), (end.real - 0.01 * vector.real, end.imag - 0.01 * vector.imag), arrowprops=tip
    )


def _bearings(ax: Axes, plan: RotorPlan) -> None:
    """Unbalance in the bearings' planes before and after against the permissible one."""
    places = np.arange(2)
    before, after, allowed = plan.bearings * G_MM
    ax.bar(places - 0.2, before, 0.36, color=PALE, label="before")
    ax.bar(places + 0.2, after, 0.36, color=BLUE, label="after")
    for place, limit in zip(places, allowed, strict=True):
        ax.plot([place - 0.42, place + 0.42], [limit, limit], color=VERMILION, label=None if place else "permissible")
    ax.set(yscale="log", title="At the bearings, g·mm", xticks=places, xticklabels=["first", "second"])
    lowest = max(after.min(), 1e-3 * allowed.min())
    ax.set_ylim(lowest / 3, 20 * max(before.max(), allowed.max()))
    ax.grid(visible=False, axis="x")
    ax.legend(loc="upper right", fontsize=6.5)
