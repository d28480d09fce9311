"""Hodographs and orders of the shaking force, such as before and after balancing."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from engine import MovingMachine, Scene, Verdict, display_unit, has_cycle
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import PALETTE, sheet

ORDERS = np.arange(1, 9)
POSITIONS = 720


def hodographs(scenes: Mapping[str, Scene], target: Path | str | Figure) -> Figure:
    """Shaking forces over the cycle, 180 mm wide: hodographs on the left, orders on the right.

    Parameters
    ----------
    scenes : mapping of str to Scene
        Machines by label, such as "before" and "after".
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.

    Raises
    ------
    PictureError
        A machine can't be computed or its crank doesn't turn fully, or unknown picture format.
    """
    forces = {name: shaking_force(scene) for name, scene in scenes.items()}
    factor, unit = display_unit("N", np.abs(np.concatenate(list(forces.values()))))
    with sheet(target, 180, 85) as figure:
        left, right = figure.subplots(1, 2)
        _hodographs(left, forces, factor, unit)
        _orders(right, {n: order_sizes(f, scenes[n].input.revolutions) for n, f in forces.items()}, factor, unit)
        titles = {scene.title for scene in scenes.values()}
        title = titles.pop() if len(titles) == 1 else ""
        figure.suptitle(f"{title}: shaking force" if title else "Shaking force", fontweight="bold")
    return figure


def shaking_force(scene: Scene) -> np.ndarray:
    """Shaking force over the cycle as F_x + i F_y (positions,) [N].

    Raises
    ------
    PictureError
        The machine can't be computed, or its crank doesn't turn fully.
    """
    if scene.input is None or not has_cycle(scene):
        raise PictureError("no hodograph: the scene needs a crank that turns fully")
    machine, names = MovingMachine(scene, positions=POSITIONS), ("shaking_force_x", "shaking_force_y")
    verdict = machine.verdict(names)
    if verdict != Verdict.OK:
        raise PictureError(f"no hodograph of this machine: {verdict.sentence}")
    x, y = machine.fields(names).values()
    return x + 1j * y


def order_sizes(force: np.ndarray, revolutions: int) -> np.ndarray:
    """Longer half axes of the ellipses of the shaking force's `ORDERS`.

    Parameters
    ----------
    force : ndarray of complex (positions,)
        Over a cycle of `revolutions` crank turns.
    revolutions : int
    """
    parts = np.abs(np.fft.fft(force)) / force.size
    return parts[ORDERS * revolutions] + parts[-ORDERS * revolutions]


def _hodographs(axes: Axes, forces: Mapping[str, np.ndarray], factor: float, unit: str) -> None:
    for (name, force), colour in zip(forces.items(), PALETTE, strict=False):
        loop = np.append(force, force[0]) * factor
        axes.plot(loop.real, loop.imag, color=colour, label=name)
        # Crank at 0.
        axes.plot(loop[0].real, loop[0].imag, "o", color=colour, markersize=3.5)
    axes.plot(0, 0, "+", color="black", markersize=7)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel(f"$F_x$, {unit}")
    axes.set_ylabel(f"$F_y$, {unit}")
    axes.set_title("Hodograph (dot: crank angle 0)", loc="left")


def _orders(axes: Axes, sizes: Mapping[str, np.ndarray], factor: float, unit: str) -> None:
    width = 0.8 / len(sizes)
    for i, ((name, size), colour) in enumerate(zip(sizes.items(), PALETTE, strict=False)):
        axes.bar(ORDERS - 0.4 + width * (i + 0.5), size * factor, width, color=colour, label=name)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.grid(visible=False, axis="x")
    axes.set_xlabel("crank order")
    axes.set_ylabel(f"longer half axis, {unit}")
    axes.set_title("Orders", loc="left")
    axes.legend(loc="upper right")
