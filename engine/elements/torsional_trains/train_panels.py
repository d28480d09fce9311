"""Diagrams of a torsional train: its modes along the train, and its Campbell diagram."""

import math

import numpy as np

from engine.elements.element import Element, Numbers
from engine.elements.panels import Curve, Mark, Panel, PanelAxis
from engine.elements.torsional_trains.excitation import TrainExcitation, train_excitation
from engine.elements.torsional_trains.natural_frequencies import NaturalVibration, natural_vibration
from engine.elements.torsional_trains.reduced_train import ReducedTrain, reduced_train

# Most modes and orders in one diagram; highest speed drawn, relative to the train's speed.
_MOST_MODES, _MOST_ORDERS, _FASTEST = 6, 16, 1.5
# An order gets a dot if its work on a mode is above this fraction of the maximum.
_FELT = 0.05
_HERTZ = 1.0 / math.tau


def train_panels(train: Element, n: Numbers) -> tuple[Panel, ...]:
    """Modes along a train and, if it is excited, its Campbell diagram.

    Parameters
    ----------
    train : TorsionalTrain
    n : mapping of str to ndarray (1,)
        Its numbers, including those of the machine that excites it.
    """
    reduced = reduced_train(train, n)
    natural = natural_vibration(reduced, train.reported_modes)
    modes = _modes(train, reduced, natural)
    if not train.is_excited:
        return (modes,)
    excitation = train_excitation(train, reduced, n)
    return (modes, _campbell(excitation, natural)) if excitation.orders else (modes,)


def _modes(train: Element, reduced: ReducedTrain, natural: NaturalVibration) -> Panel:
    """Modes, linear along each shaft; shaft length is drawn in proportion to compliance, plus a visible minimum."""
    layout, parents = train.layout, reduced.parents
    compliance = 1.0 / reduced.stiffnesses[1:, 0]
    places = np.zeros(len(parents))
    for node in range(1, len(parents)):
        places[node] = places[parents[node]] + 0.25 + 0.75 * compliance[node - 1] / compliance.max()
    names = ["\n".join(m for m, at in layout.node_of.items() if at == k) for k in range(len(places))]
    # Both ends of each shaft, and a gap after it.
    ends = np.array([(parents[node], node, node) for node in range(1, len(places))] or [(0, 0, 0)]).ravel()
    gap = np.arange(ends.size) % 3 == 2
    curves, marks = [], [Mark("", None, 0.0)]
    for k in range(min(len(natural.frequencies), _MOST_MODES)):
        mode, words = natural.modes[k, :, 0], f"{k + 1}: {natural.frequencies[k, 0] * _HERTZ:.4g} Hz"
        if np.isnan(mode).any():
            words += ", mode not determined"
        shape = mode / mode[np.abs(mode).argmax()]
        curves.append(Curve(words, np.where(gap, np.nan, shape[ends]), places=places[ends]))
    free = "it turns freely" if layout.is_free else "held to the frame"
    title = f"Modes along the train ({free})"
    return Panel(
        PanelAxis("", "1"), PanelAxis("relative amplitude", "1", "θ"), places, curves, marks, title, names=names
    )


def _campbell(excitation: TrainExcitation, natural: NaturalVibration) -> Panel:
    """Natural frequencies as horizontal lines, orders as rays, dots where an order excites a mode at resonance."""
    speed, orders = float(excitation.speed[0]), np.array(excitation.orders)
    fastest, levels = _FASTEST * speed, natural.frequencies[:_MOST_MODES, 0]
    top = 1.15 * max(levels[levels <= orders.max() * fastest], default=levels[0])
    # Work of each order on each mode, |Σ q M_h|, relative to the maximum over the orders.
    work = np.abs(np.nan_to_num(natural.modes[: len(levels), :, 0], nan=1.0) @ excitation.moments.value[:, :, 0])
    most = work.max(axis=1, keepdims=True)
    felt = work >= _FELT * np.where(most > 0.0, most, 1.0)
    seen = levels < top
    both = np.array([0.0, fastest])
    curves = [Curve(f"mode {k + 1}", np.full(2, level * _HERTZ)) for k, level in enumerate(levels[seen])]
    strongest = np.argsort(-(work / np.where(most > 0.0, most, 1.0))[seen].max(axis=0), kind="stable")[:_MOST_ORDERS]
    for order in np.sort(orders[strongest]):
        ends = np.array([0.0, min(fastest, top / order)])
        curves.append(Curve(f"{order:g}", order * ends * _HERTZ, True, ends))
    marks = [Mark("as given", speed, None)]
    for k, i in zip(*np.nonzero(felt & seen[:, None]), strict=True):
        if i in strongest and levels[k] < orders[i] * fastest:
            marks.append(Mark("", levels[k] / orders[i], levels[k] * _HERTZ))
    axes = PanelAxis("speed", "rad s-1", "ω"), PanelAxis("frequency", "Hz", "f")
    return Panel(
        *axes, both, curves, marks, "Campbell diagram (rays: orders; dots: excited)", (0.0, 1.05 * top * _HERTZ)
    )
