"""A torsional train to be looked at: its modes along the train, its Campbell diagram, its shafts; Holzer's tables."""

import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from engine import (
    HolzerTable,
    Machine,
    NaturalVibration,
    ReducedTrain,
    Scene,
    TorsionalTrain,
    TrainExcitation,
    holzer_table,
    is_excited,
    made_ready,
    natural_vibration,
    reduced_train,
    train_excitation,
    train_speed,
)
from sweeps.pictures.style import GREY, PALE, PALETTE, VERMILION, sheet
from sweeps.text.engineer_units import engineer_unit
from sweeps.text.tables import table

# Modes and orders that one diagram can show.
MOST_MODES, MOST_ORDERS = 6, 16
# Speeds at which the moments of shafts are computed, up to so many times the speed of the train.
SPEEDS, FASTEST = 1201, 1.5
# An order that does less on a mode than this share of what the greatest does leaves it cold.
FELT = 0.05
HERTZ = 1 / math.tau
RPM = 30 / math.pi

Numbers = dict[str, np.ndarray]


def train_sheet(scene: Scene, name: str, target: Path | str | Figure, title: str = "") -> Figure:
    """Modes along the train; where something excites it, also a Campbell diagram and moments of the shafts over speed.

    Parameters
    ----------
    scene : Scene
    name : str
        The train among its elements.
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written.
    """
    train, numbers = scene.elements[name], _numbers(scene, name)
    reduced = reduced_train(train, numbers)
    natural = natural_vibration(reduced, train.reported_modes)
    with sheet(target, 180, 170 if is_excited(train) else 90, title) as figure:
        if is_excited(train):
            grid = figure.add_gridspec(2, 2)
            _modes(figure.add_subplot(grid[0, :]), train, reduced, natural)
            _campbell(figure.add_subplot(grid[1, 0]), train, numbers, reduced, natural)
            _moments(figure.add_subplot(grid[1, 1]), scene, name, float(train_speed(train, numbers)[0]))
        else:
            _modes(figure.add_subplot(), train, reduced, natural)
    return figure


def _places(train: TorsionalTrain, reduced: ReducedTrain) -> np.ndarray:
    """Where the nodes stand along the train: shafts as long as they give way, but none too short to be seen."""
    compliance = np.zeros(len(reduced.parents))
    compliance[1:] = 1.0 / reduced.stiffnesses[1:, 0]
    greatest = compliance.max() or 1.0
    places = np.zeros(len(reduced.parents))
    for node in range(1, len(reduced.parents)):
        places[node] = places[reduced.parents[node]] + 0.25 + 0.75 * compliance[node] / greatest
    return places


def _modes(ax: Axes, train: TorsionalTrain, reduced: ReducedTrain, natural: NaturalVibration) -> None:
    """Train as discs on a line, and above them the modes, straight along each shaft."""
    layout, places = train.layout, _places(train, reduced)
    names = [
        "\n".join(m for m, at in zip(layout.masses, layout.node_of, strict=True) if at == node)
        for node in range(len(layout.parents))
    ]
    edges = [(parent, node) for node, parent in enumerate(layout.parents) if parent >= 0]
    lowest = _train_drawing(ax, train, reduced, places, edges, names)
    for k in range(min(len(natural.frequencies), MOST_MODES)):
        mode, colour = natural.modes[k, :, 0], PALETTE[k % len(PALETTE)]
        label = f"{k + 1}: {natural.frequencies[k, 0] * HERTZ:.4g} Hz"
        if np.isnan(mode).any():
            ax.plot([], [], color=colour, label=f"{label}, mode not determined")
            continue
        q = mode / mode[np.abs(mode).argmax()]
        for i, (a, b) in enumerate(edges):
            ax.plot(places[[a, b]], q[[a, b]], color=colour, label=None if i else label)
            if q[a] * q[b] < 0.0:
                crossing = places[a] + (places[b] - places[a]) * q[a] / (q[a] - q[b])
                ax.plot(crossing, 0.0, "o", color="white", markeredgecolor=colour, markersize=4, zorder=4)
        ax.plot(places, q, ".", color=colour, markersize=5, label=None if edges else label)
    ax.axhline(0.0, color="black", linewidth=0.7)
    ax.set(ylim=(lowest, 1.15), yticks=[-1, 0, 1], xticks=[], ylabel="amplitude, reduced")
    ax.grid(visible=False)
    ax.margins(x=0.06)
    free = "the whole train turns freely" if layout.is_free else "held to the frame"
    ax.set_title(f"Modes along the train ({free}; circles: nodes; shafts as long as they give way)")
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), title="frequency")


def _train_drawing(
    ax: Axes, train: TorsionalTrain, reduced: ReducedTrain, places: np.ndarray, edges: list, names: list[str]
) -> float:
    """The train below the modes: discs as high as the fourth root of their inertias, as discs of one width are.

    Returns where it ends below.
    """
    sizes = 0.04 + 0.2 * (reduced.inertias[:, 0] / reduced.inertias[:, 0].max()) ** 0.25
    # Each branch in a row of its own, with room for the names of its discs.
    room = 0.55 + 0.14 * max(name.count("\n") for name in names)
    row = np.zeros(len(places), int)
    begun: set[int] = set()
    for parent, node in edges:
        row[node] = row.max() + 1 if parent in begun else row[parent]
        begun.add(parent)
    heights = -1.4 - room * row
    width = 0.01 * max(float(np.ptp(places)), 1.0)
    for a, b in edges:
        ax.plot(places[[a, a, b]], heights[[a, b, b]], color=GREY, linewidth=2, zorder=2)
    for x, y, size, name in zip(places, heights, sizes, names, strict=True):
        disc = Rectangle((x - width, y - size), 2 * width, 2 * size, facecolor=PALE, edgecolor="black", linewidth=0.6)
        disc.set_zorder(3)
        ax.add_patch(disc)
        ax.annotate(name, (x, y - size), (0, -2), textcoords="offset points", ha="center", va="top", fontsize=6.5)
    for _, mass in train.layout.grounded:
        node = train.layout.node_of[train.layout.masses.index(mass)]
        ax.annotate("frame", (places[node], heights[node] + sizes[node]), ha="center", va="bottom", fontsize=6.5)
    return float(heights.min()) - room


def _numbers(scene: Scene, name: str) -> Numbers:
    """Numbers of a train as one variant, with those of the machine that excites it."""
    train = scene.elements[name]
    return train.own_numbers() | numbers_of_machine(scene, name)


def numbers_of_machine(scene: Scene, name: str) -> Numbers:
    """What the machine of a scene gives a train that it excites, as one variant; nothing to others.

    Parameters
    ----------
    scene : Scene
    name : str
        The train among its elements.
    """
    if scene.elements[name].machine_at is None:
        return {}
    return Machine(scene, [f"{name}.frequency_1"]).numbers_for_trains()


def _strengths(excitation: TrainExcitation, modes: np.ndarray) -> np.ndarray:
    """How much each order does on each mode, |Σ q M_h|, over the greatest of all orders (modes, orders)."""
    work = np.abs(np.nan_to_num(modes[:, :, 0], nan=1.0) @ excitation.moments[:, :, 0])
    greatest = work.max(axis=1, keepdims=True)
    return work / np.where(greatest > 0.0, greatest, 1.0)


def _campbell(
    ax: Axes, train: TorsionalTrain, numbers: Numbers, reduced: ReducedTrain, natural: NaturalVibration
) -> None:
    """Natural frequencies as levels, orders as rays, marks where they meet, full where the mode feels the order."""
    excitation = train_excitation(train, reduced, numbers)
    speed, orders = float(excitation.speed[0]), np.array(excitation.orders)
    if not orders.size:
        ax.set_axis_off()
        return
    fastest, levels = FASTEST * speed, natural.frequencies[:MOST_MODES, 0]
    top = 1.15 * max(levels[levels <= orders.max() * fastest], default=levels[0])
    strengths = _strengths(excitation, natural.modes[: len(levels)])
    for k, level in enumerate(levels[levels < top]):
        colour = PALETTE[k % len(PALETTE)]
        ax.axhline(level * HERTZ, color=colour, linewidth=1.1)
        ax.annotate(
            f"{k + 1}", (0.008, level * HERTZ), (0, 1), xycoords=("axes fraction", "data"),
            textcoords="offset points", va="bottom", color=colour, fontsize=7,
        )  # fmt: skip
    shown = np.sort(np.argsort(-strengths[levels < top].max(axis=0), kind="stable")[:MOST_ORDERS])
    for i in shown:
        order, end = orders[i], min(fastest, top / orders[i])
        ax.plot([0, end * RPM], [0, order * end * HERTZ], color=GREY, linewidth=0.7)
        ax.annotate(f"{order:g}", (end * RPM, order * end * HERTZ), (1, 1), textcoords="offset points", fontsize=6.5)
        for k, level in enumerate(levels):
            if level < min(top, order * fastest):
                look = "black" if strengths[k, i] >= FELT else "white"
                ax.plot(level / order * RPM, level * HERTZ, "o", color=look, markeredgecolor="black", markersize=3)
    ax.axvline(speed * RPM, color=VERMILION, linewidth=0.9, linestyle=(0, (6, 2)))
    ax.set(xlim=(0, 1.06 * fastest * RPM), ylim=(0, 1.05 * top * HERTZ), xlabel="speed, rpm", ylabel="frequency, Hz")
    ax.set_title("Campbell diagram (rays: orders; full dots: excited)")


def _moments(ax: Axes, scene: Scene, name: str, speed: float) -> None:
    """Alternating moments of the shafts over the speed."""
    train, own = scene.elements[name], f"elements.{name}"
    path = "input.speed" if train.machine_at is not None else f"{own}.engine.speed" if train.engine else f"{own}.speed"
    speeds = np.linspace(0.02, FASTEST, SPEEDS) * speed
    asked = {f"{name}.{shaft}.alternating_moment": shaft for shaft in train.shafts}
    found = made_ready(scene, asked, varied=[path]).evaluate({path: speeds}).summaries
    curves = {shaft: found[summary] for summary, shaft in asked.items()}
    values = np.array(list(curves.values()))
    finite = values[np.isfinite(values)]
    factor, unit = engineer_unit("N m", np.array([np.quantile(finite, 0.98)]))
    highest = sorted(curves, key=lambda shaft: -np.nanmax(np.where(np.isfinite(curves[shaft]), curves[shaft], 0.0)))
    for k, shaft in enumerate(highest[: len(PALETTE)]):
        ax.plot(speeds * RPM, factor * curves[shaft], color=PALETTE[k], label=shaft, linewidth=1.0)
    ax.axvline(speed * RPM, color=VERMILION, linewidth=0.9, linestyle=(0, (6, 2)))
    # Resonances with hardly any damping would hide everything else.
    top = min(float(finite.max()), 8 * float(np.quantile(finite, 0.9)))
    ax.set(xlim=(0, 1.04 * speeds[-1] * RPM), ylim=(0, 1.08 * factor * top), xlabel="speed, rpm")
    ax.set(ylabel=f"alternating moment, {unit}")
    ax.set_title("Shafts over the speed (dashed: as given)")
    ax.legend(loc="upper left")


def train_table(train: TorsionalTrain, machine: Numbers) -> str:
    """Holzer's table of every mode, as columns of plain text.

    Parameters
    ----------
    train : TorsionalTrain
    machine : dict of str to ndarray (1,)
        What a machine that excites it gives it, from `numbers_of_machine`.
    """
    reduced = reduced_train(train, train.own_numbers() | machine)
    natural = natural_vibration(reduced, train.reported_modes)
    texts = []
    for k, frequency in enumerate(natural.frequencies[:, 0]):
        head = f"Mode {k + 1}: {frequency * HERTZ:.6g} Hz, {frequency * RPM:.6g} per minute"
        mode = natural.modes[k, :, 0]
        if np.isnan(mode).any():
            texts.append(f"{head}; another frequency is so near that its mode is not determined")
            continue
        texts.append(f"{head}\n{_holzer_text(train, reduced, holzer_table(reduced, frequency, mode))}")
    return "\n".join(texts)


def _holzer_text(train: TorsionalTrain, reduced: ReducedTrain, found: HolzerTable) -> str:
    layout = train.layout
    rows = [("mass", "J, kg·m²", "θ", "J ω² θ, N·m", "shaft", "its moment, N·m", "k, N·m/rad", "twist")]
    for node in reversed(range(len(layout.parents))):
        masses = " + ".join(m for m, at in zip(layout.masses, layout.node_of, strict=True) if at == node)
        own = (f"{reduced.inertias[node, 0]:.5g}", f"{found.amplitudes[node]:.5f}", f"{found.inertial[node]:.5g}")
        shaft = ("", "", "", "")
        if node:
            numbers = found.carried[node], reduced.stiffnesses[node, 0], found.twists[node]
            shaft = (layout.shaft_to[node], *(f"{number:.5g}" for number in numbers))
        rows.append((masses, *own, *shaft))
    size = np.abs(found.inertial).max()
    return f"{table(rows, '  ')}\n  remainder {found.remainder:.1e} N·m, of {size:.3g}"
