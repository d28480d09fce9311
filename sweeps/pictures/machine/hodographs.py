"""Hodographs and orders of the shaking force, such as before and after balancing."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from engine import Curve, Mark, MovingMachine, Panel, PanelAxis, Scene, Verdict
from sweeps.pictures.machine.cycle_rows import closed
from sweeps.pictures.panels import draw_panel
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import sheet, titled

ORDERS = np.arange(1, 9)
POSITIONS = 720


def hodographs(scenes: Mapping[str, Scene]) -> Figure:
    """Shaking forces over the cycle, 180 mm wide: hodographs on the left, orders on the right.

    Parameters
    ----------
    scenes : mapping of str to Scene
        Machines by label, such as "before" and "after".

    Raises
    ------
    PictureError
        A machine can't be computed or its crank doesn't turn fully.
    """
    forces = {name: closed(scene, shaking_force(scene, name)) for name, scene in scenes.items()}
    loops = [Curve(name, force.imag, places=force.real) for name, force in forces.items()]
    starts = [Mark("", force[0].real, force[0].imag) for force in forces.values()]
    origin, words = [Mark("", 0.0, None), Mark("", None, 0.0)], "Hodograph (dots: crank angle 0)"
    axes = PanelAxis("", "N", "F_x"), PanelAxis("", "N", "F_y")
    every = np.concatenate(list(forces.values())).real
    sizes = [Curve(n, order_sizes(f[:-1], scenes[n].input.revolutions)) for n, f in forces.items()]
    of_orders = PanelAxis("crank order", "1"), PanelAxis("longer half axis", "N")
    with sheet(180, 85) as figure:
        left, right = figure.subplots(1, 2)
        draw_panel(left, Panel(*axes, every, loops, [*origin, *starts], words, kind="plan"))
        draw_panel(right, Panel(*of_orders, ORDERS, sizes, title="Orders", kind="bars"))
        titles = {scene.title for scene in scenes.values()}
        title = titled(titles.pop() if len(titles) == 1 else "", "shaking force")
        figure.suptitle(title, fontweight="bold")
    return figure


def shaking_force(scene: Scene, name: str) -> np.ndarray:
    """Shaking force over the cycle as F_x + i F_y (positions,) [N]; `name` is that of the machine in messages.

    Raises
    ------
    PictureError
        The machine can't be computed, or its crank doesn't turn fully.
    """
    if scene.input is None or not scene.has_cycle:
        raise PictureError(f"no hodograph of {name}: it needs a crank that turns fully")
    machine, names = MovingMachine(scene, positions=POSITIONS), ("shaking_force_x", "shaking_force_y")
    verdict = machine.verdict(names)
    if verdict != Verdict.OK:
        raise PictureError(f"no hodograph of {name}: {verdict.sentence}")
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
