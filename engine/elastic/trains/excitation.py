"""What excites a torsional train: moments of given orders, and those of an engine's cylinders."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from engine.balancing.engines.engine_columns import ROUNDED_ORDERS, engine_torque
from engine.elastic.trains.reduced_train import ReducedTrain
from engine.elastic.trains.train_element import TorsionalTrain

Numbers = Mapping[str, np.ndarray]
EPS = float(np.finfo(float).eps)
# Orders of an engine's torque that are counted: what lies above hardly excites a train.
ENGINE_ORDERS = tuple(k / 2 for k in range(1, 25))


class TrainExcitation(NamedTuple):
    """Moments on the nodes of a reduced train, by orders of its speed.

    Attributes
    ----------
    orders : tuple of float
        Rising, above 0.
    speed : ndarray (variants,)
        [rad/s].
    moments : ndarray of complex (nodes, orders, variants)
        M(t) = Re Σ M_h e^(i h Ω t) [N·m].
    means : ndarray (nodes, variants)
        [N·m].
    error : ndarray (variants,)
        What any of these may be off by, over the greatest of its order.
    """

    orders: tuple[float, ...]
    speed: np.ndarray
    moments: np.ndarray
    means: np.ndarray
    error: np.ndarray


def excitation_orders(train: TorsionalTrain) -> tuple[float, ...]:
    """Orders above 0 that excite a train, rising."""
    found = {e.order for e in train.excitations.values() if e.order > 0}
    return tuple(sorted(found | set(ENGINE_ORDERS if train.engine is not None else ())))


def train_excitation(train: TorsionalTrain, reduced: ReducedTrain, n: Numbers) -> TrainExcitation:
    """Everything that excites a train, reduced as the train is.

    Parameters
    ----------
    train : TorsionalTrain
        What excites it; its numbers are not used.
    reduced : ReducedTrain
    n : mapping of str to ndarray (variants,)
        Its numbers by their keys, those of its engine among them.
    """
    orders, layout = excitation_orders(train), train.layout
    node_of = dict(zip(layout.masses, layout.node_of, strict=True))
    nodes, variants = reduced.inertias.shape
    moments, means = np.zeros((nodes, len(orders), variants), complex), np.zeros((nodes, variants))
    error = np.zeros(variants)
    for name, excitation in train.excitations.items():
        node, ratio = node_of[excitation.on], reduced.ratios[excitation.on]
        amplitude, phase = (n[f"excitations.{name}.{key}"] for key in ("amplitude", "phase"))
        if excitation.order == 0:
            means[node] += ratio * amplitude * np.cos(phase)
        else:
            moments[node, orders.index(excitation.order)] += ratio * amplitude * np.exp(1j * phase)
        error = np.maximum(error, EPS * (4.0 + np.abs(phase)))
    if train.engine is not None:
        of_engine = {key.removeprefix("engine."): value for key, value in n.items() if key.startswith("engine.")}
        one, _, angles = engine_torque(train.engine, of_engine, ENGINE_ORDERS)
        places = [orders.index(h) for h in ENGINE_ORDERS]
        for k, throw in enumerate(train.cylinders_at):
            node, ratio = node_of[throw], reduced.ratios[throw]
            turned = np.exp(-1j * np.multiply.outer(ENGINE_ORDERS, angles[:, k]))
            moments[node, places] += ratio * one.orders.T * turned
            means[node] += ratio * one.mean
        with np.errstate(invalid="ignore", divide="ignore"):
            sized = ROUNDED_ORDERS * one.sizes[:, 1:].max(axis=1) / np.abs(one.orders).max(axis=1)
        error = np.maximum(error, EPS * (sized + ENGINE_ORDERS[-1] * np.abs(angles).max(axis=1)))
    if train.load is not None:
        # As far as the ratio of the load's mass goes, means are reduced like all others.
        means[node_of[train.load]] -= means.sum(axis=0)
    speed = n["engine.speed"] if train.engine is not None else n["speed"]
    return TrainExcitation(orders, speed, moments, means, error)
