"""A scene whose governors have the data of its mechanism, so that each can be evaluated separately."""

import math

import numpy as np

from engine.elements.governors.governor import cycle_key
from engine.elements.governors.transients import CYCLE_POSITIONS
from engine.laws.governors.motion import CURVES
from engine.machine.drives.governed_engines import GovernedEngines
from engine.machine.machine import Machine
from engine.scene.scene import Numbers, Scene, scene_numbers


def governed_scene(scene: Scene) -> tuple[Scene, dict[str, np.ndarray]]:
    """A scene in which governors of its mechanism have the mechanism's data.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    scene : Scene
        With the whole inertia of these engines; unchanged if no governor governs the mechanism, or if the mechanism
        can't be evaluated.
    cycles : dict of str to ndarray
        Curves of the mechanism by the names of the governors that need them, for their panels.
    """
    governing = [name for name, element in scene.elements.items() if element.machine_needed()[0] == ".engine.machine"]
    if not governing:
        return scene, {}
    engines = GovernedEngines(scene, governing)
    outcome = Machine(scene, engines.summaries, engines.fields, positions=CYCLE_POSITIONS).evaluate({})
    found = engines.numbers(outcome, Numbers(scene_numbers(scene), {}))
    elements, cycles = dict(scene.elements), {}
    for name in governing:
        inertia = float(found[f"elements.{name}.engine.inertia"][0])
        if not math.isfinite(inertia):
            return scene, {}
        engine = elements[name].engine.model_copy(update={"machine": False, "inertia": inertia})
        elements[name] = elements[name].model_copy(update={"engine": engine})
        if engine.duration is not None:
            keys = [f"elements.{name}.{cycle_key(k)}" for k in range(CURVES * CYCLE_POSITIONS + 1)]
            cycles[name] = np.array([found[key][0] for key in keys])
    return scene.model_copy(update={"elements": elements}), cycles
