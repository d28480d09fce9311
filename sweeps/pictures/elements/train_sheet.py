"""Plots of a torsional train: modes, shaft torques over speed; Holzer tables."""

import math

import numpy as np
from matplotlib.figure import Figure

import engine
from sweeps.pictures.panels import panel_sheet
from sweeps.pictures.style import PALETTE
from sweeps.text.tables import column, table

# Number of speeds for shaft torques, and the range in multiples of the train's speed.
SPEEDS, FASTEST = 1201, 1.5
HERTZ, RPM = 1 / math.tau, 30 / math.pi
Numbers = dict[str, np.ndarray]


def train_sheet(scene: engine.Scene, name: str, title: str = "") -> Figure:
    """Modes along the train; with excitation, also a Campbell diagram and shaft torques over speed.

    Parameters
    ----------
    scene : Scene
    name : str
        Name of its torsional train.
    title : str
    """
    train, given = scene.elements[name], numbers_of_machine(scene, name)
    panels = train.panels(given)
    if train.is_excited:
        panels += (_moments(scene, name, float(engine.train_speed(train, train.own_numbers() | given)[0])),)
    return panel_sheet(panels, title)


def numbers_of_machine(scene: engine.Scene, name: str) -> Numbers:
    """Excitation of a train by the machine of its scene, as one variant; empty for other trains.

    Parameters
    ----------
    scene : Scene
    name : str
        Name of the train.
    """
    if scene.elements[name].machine_at is None:
        return {}
    return engine.numbers_for_trains(engine.Machine(scene, [f"{name}.frequency_1"]))


def _moments(scene: engine.Scene, name: str, speed: float) -> engine.Panel:
    """Peak alternating shaft torques over speed."""
    train, own = scene.elements[name], f"elements.{name}"
    path = "input.speed" if train.machine_at is not None else f"{own}.engine.speed" if train.engine else f"{own}.speed"
    speeds = np.linspace(0.02, FASTEST, SPEEDS) * speed
    asked = {f"{name}.{shaft}.alternating_moment": shaft for shaft in train.shafts}
    found = engine.made_ready(scene, asked, varied=[path]).evaluate({path: speeds}).summaries
    curves = [engine.Curve(shaft, found[summary]) for summary, shaft in asked.items()]
    finite = np.concatenate([row[np.isfinite(row)] for row in found.values()])
    highest = sorted(curves, key=lambda curve: -np.nanmax(np.where(np.isfinite(curve.values), curve.values, 0.0)))
    # Lightly damped resonances would hide everything else.
    top = min(float(finite.max()), 8 * float(np.quantile(finite, 0.9)))
    axes = engine.PanelAxis("speed", "rad s-1", "ω"), engine.PanelAxis("alternating torque", "N m", "M")
    marks, shown = (engine.Mark("given speed", speed, None),), highest[: len(PALETTE)]
    return engine.Panel(*axes, speeds, shown, marks, "Shaft torque over speed", (0.0, 1.08 * top))


def train_table(train: engine.TorsionalTrain, machine: Numbers) -> str:
    """Holzer table of each mode, as text.

    Parameters
    ----------
    train : TorsionalTrain
    machine : dict of str to ndarray (1,)
        Excitation by the machine, from `numbers_of_machine`.
    """
    reduced = engine.reduced_train(train, train.own_numbers() | machine)
    natural = engine.natural_vibration(reduced, train.reported_modes)
    texts = []
    for k, frequency in enumerate(natural.frequencies[:, 0]):
        head = f"Mode {k + 1}: {frequency * HERTZ:.6g} Hz, {frequency * RPM:.6g} per minute"
        mode = natural.modes[k, :, 0]
        if np.isnan(mode).any():
            texts.append(f"{head}; mode undetermined, another frequency is too close")
            continue
        texts.append(f"{head}\n{_holzer_text(train, reduced, engine.holzer_table(reduced, frequency, mode))}")
    return "\n".join(texts)


def _holzer_text(train: engine.TorsionalTrain, reduced: engine.ReducedTrain, found: engine.HolzerTable) -> str:
    layout = train.layout
    nodes = np.arange(len(layout.parents))[::-1]
    masses = [" + ".join(m for m, at in layout.node_of.items() if at == node) for node in nodes]
    # No shaft leads to the root.
    carried, stiffnesses, twists = (
        np.where(nodes > 0, row[nodes], np.nan) for row in (found.carried, reduced.stiffnesses[:, 0], found.twists)
    )
    columns = (
        ["mass", *masses],
        column("J", "kg m2", reduced.inertias[nodes, 0]),
        column("θ", "1", found.amplitudes[nodes]),
        column("J ω² θ", "N m", found.inertial[nodes]),
        ["shaft", *(layout.shaft_to[node] for node in nodes[:-1]), "–"],
        column("torque", "N m", carried),
        column("k", "N m rad-1", stiffnesses),
        column("twist", "1", twists),
    )
    left = found.remainder / np.abs(found.inertial).max()
    return f"{table([*zip(*columns, strict=True)], '  ')}\n  remainder {left:.1e} of the largest J ω² θ"
