"""Pictures of the machine elements of a scene, and their tables.

An element is drawn by the diagrams that the engine gives of it, beside a layout to scale where there is one. What needs
another picture has a sheet of its own.
"""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from engine import Element, EngineElement, GearTrain, Scene, TorsionalTrain, governed_scene
from sweeps.pictures.elements.body_sheets import lever_layout, tie_layout, tilted_body_sheet
from sweeps.pictures.elements.cam_layout import cam_layout
from sweeps.pictures.elements.chain_layout import chain_layout
from sweeps.pictures.elements.elastic_sheets import compliance_sheet, machine_drive_sheet, machine_run_sheet
from sweeps.pictures.elements.engine_sheet import engine_sheet, engine_table
from sweeps.pictures.elements.gear_sheet import gear_sheet, gear_table
from sweeps.pictures.elements.governor_sheet import governor_sheet
from sweeps.pictures.elements.journal_and_roller import journal_layout, roller_layout
from sweeps.pictures.elements.panels import Layout, panel_sheet
from sweeps.pictures.elements.train_sheet import numbers_of_machine, train_sheet, train_table
from sweeps.pictures.elements.unbalance_plan import static_plan, unbalance_plan


class Shown(NamedTuple):
    """An element to be drawn, the scene it stands in, and curves of a mechanism that it governs."""

    scene: Scene
    name: str
    cycle: np.ndarray | None

    @property
    def element(self) -> Element:
        """The element itself."""
        return self.scene.elements[self.name]


class Look(NamedTuple):
    """How a kind of element is drawn.

    Attributes
    ----------
    ending : str
        Of the name of its file.
    draw : callable, optional
        Draws all of it; its diagrams are drawn unless given.
    layout : callable, optional
        Draws it to scale beside its diagrams.
    """

    ending: str
    draw: Callable[[Shown, Path, str], Figure] | None = None
    layout: Layout | None = None


def _alone(draw: Callable) -> Callable[[Shown, Path, str], Figure]:
    """A sheet of an element that knows nothing of its scene."""
    return lambda shown, target, title: draw(shown.element, target, title)


def _in_scene(draw: Callable) -> Callable[[Shown, Path, str], Figure]:
    return lambda shown, target, title: draw(shown.scene, shown.name, target, title)


_GOVERNOR = Look("governor", lambda shown, target, title: governor_sheet(shown.element, target, title, shown.cycle))
# By type; any other is drawn by its diagrams, in a file of the ending "results".
LOOKS = {
    **dict.fromkeys(("screw", "belt", "wedge", "incline", "guide", "friction_drive"), Look("friction")),
    **dict.fromkeys((f"{k}_governor" for k in ("watt", "porter", "proell", "hartnell", "table")), _GOVERNOR),
    "journal": Look("friction", layout=journal_layout),
    "roller": Look("friction", layout=roller_layout),
    "car": Look("braking"),
    "rotating_guide": Look("sliding", layout=lever_layout),
    "tethered_body": Look("pull", layout=tie_layout),
    "tilted_body": Look("views", _alone(tilted_body_sheet)),
    "wound_flywheel": Look("stresses"),
    "rotor": Look("plan", _alone(unbalance_plan)),
    "static_rotor": Look("plan", _alone(static_plan)),
    "engine": Look("orders", _alone(engine_sheet)),
    "locomotive": Look("shaking"),
    "torsional_train": Look("vibration", _in_scene(train_sheet)),
    "compliance": Look("shares", _alone(compliance_sheet)),
    "chain_drive": Look("chain", layout=chain_layout),
    "oscillator": Look("vibration"),
    "two_mass_drive": Look("transient"),
    "machine_drive": Look("cycle", _in_scene(machine_drive_sheet)),
    "cam": Look("cam", layout=cam_layout),
    "gear_train": Look("velocities", _alone(gear_sheet)),
}


def element_pictures(scene: Scene, path: Path) -> list[Path]:
    """Draw the elements of a scene, from rotors and engines to gears and screws.

    Parameters
    ----------
    scene : Scene
    path : Path
        The names of the pictures are this one's with the element's name and an ending added: that of its kind in LOOKS,
        `_run` of a drive that is followed, or `_results`.

    Returns
    -------
    list of Path
        The files made.

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written; a cam's follower doesn't reach its base circle,
        a machine has no steady motion on its elastic shaft, or there is nothing to draw.
    """
    made = []
    scene, cycles = governed_scene(scene)
    for name, element in scene.elements.items():
        title, look = f"{scene.title}: {name}" if scene.title else name, LOOKS.get(element.type, Look("results"))
        made.append(path.with_name(f"{path.stem}_{name}_{look.ending}{path.suffix}"))
        if look.draw is None:
            element_sheet(element, made[-1], title)
        else:
            look.draw(Shown(scene, name, cycles.get(name)), made[-1], title)
        if getattr(element, "run", None) is not None:
            made.append(path.with_name(f"{path.stem}_{name}_run{path.suffix}"))
            machine_run_sheet(scene, name, made[-1], title)
    return made


def element_sheet(element: Element, target: Path | str | Figure, title: str = "") -> Figure:
    """Draw the diagrams of an element, beside its layout where its kind has one.

    Parameters
    ----------
    element : Element
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, it can't be written, or there are no numbers to draw.
    """
    layout = LOOKS.get(element.type, Look("results")).layout
    return panel_sheet(element.panels(), target, title, layout and (lambda ax: layout(ax, element)))


def element_tables(scene: Scene) -> str:
    """Tables of engines' orders, of torsional trains' modes and of gear trains' shafts, in words; "" without any."""
    told = []
    for name, element in scene.elements.items():
        match element:
            case EngineElement():
                told.append(f"{name}: orders of the crank\n{engine_table(element)}")
            case TorsionalTrain():
                rows = train_table(element, numbers_of_machine(scene, name))
                told.append(f"{name}: Holzer's table, reduced to {element.layout.masses[0]}\n{rows}")
            case GearTrain():
                told.append(f"{name}: {gear_table(element)}")
    return "\n".join(told)
