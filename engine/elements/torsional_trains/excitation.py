"""Excitation of a torsional train: torques of given orders, of an engine's cylinders, or of the scene's machine."""

from typing import NamedTuple

import numpy as np

from engine.cycle.measured import Measured, measured, stacked
from engine.elements.element import Element, Numbers
from engine.elements.engines.engine_torque import ROUNDED_ORDERS, engine_torque
from engine.elements.torsional_trains.reduced_train import ReducedTrain
from engine.laws.rounding import EPS

# Orders of an engine's torque that are included; higher ones hardly excite a train.
ENGINE_ORDERS = tuple(k / 2 for k in range(1, 25))
# Harmonics of the cycle of the scene's machine.
MACHINE_HARMONICS = 12


class TrainExcitation(NamedTuple):
    """Torques on the nodes of a reduced train, by orders of its speed.

    Attributes
    ----------
    orders : tuple of float
        Ascending, positive.
    speed : ndarray (variants,)
        [rad/s].
    moments : Measured complex (nodes, orders, variants)
        M(t) = Re Σ M_h e^(i h Ω t) [N·m].
    means : Measured (nodes, variants)
        Mean torques [N·m].
    """

    orders: tuple[float, ...]
    speed: np.ndarray
    moments: Measured
    means: Measured


def excitation_orders(train: Element, revolutions: int = 1) -> tuple[float, ...]:
    """Positive orders that excite a train, ascending.

    Parameters
    ----------
    train : TorsionalTrain
    revolutions : int
        Revolutions in a cycle of the machine that excites it.
    """
    found = {e.order for e in train.excitations.values() if e.order > 0}
    found |= set(ENGINE_ORDERS) if train.engine is not None else set()
    if train.machine_at is not None:
        found |= {k / revolutions for k in range(1, MACHINE_HARMONICS + 1)}
    return tuple(sorted(found))


def train_speed(train: Element, n: Numbers) -> np.ndarray:
    """Speed of a train, magnitude [rad/s]: that of its engine or of the machine that excites it, otherwise its own."""
    if train.machine_at is not None:
        return np.abs(n["machine.speed"])
    return n["engine.speed"] if train.engine is not None else n["speed"]


def train_excitation(train: Element, reduced: ReducedTrain, n: Numbers) -> TrainExcitation:
    """All excitations of a train, reduced to its first shaft.

    Parameters
    ----------
    train : TorsionalTrain
        The structure; its own numbers are not used.
    reduced : ReducedTrain
    n : mapping of str to ndarray (variants,)
        Numbers by their keys, including those of its engine or machine.
    """
    revolutions = int(n["machine.revolutions"][0]) if train.machine_at is not None else 1
    orders, layout = excitation_orders(train, revolutions), train.layout
    nodes, node_of = range(len(layout.parents)), layout.node_of
    none = measured(np.zeros(reduced.inertias.shape[1], complex))
    sums = {(node, order): none for node in nodes for order in (0.0, *orders)}

    def add(mass: str, order: float, moment: np.ndarray, error: np.ndarray) -> None:
        sums[node_of[mass], order] += reduced.ratios[mass] * Measured(moment, error)

    for name, excitation in train.excitations.items():
        amplitude, phase = (n[f"excitations.{name}.{key}"] for key in ("amplitude", "phase"))
        error = EPS * (4.0 + np.abs(phase)) * np.abs(amplitude)
        add(excitation.on, excitation.order, amplitude * np.exp(1j * phase), error)
    if train.engine is not None:
        of_engine = {key.removeprefix("engine."): value for key, value in n.items() if key.startswith("engine.")}
        one, _, angles = engine_torque(train.engine, of_engine, ENGINE_ORDERS)
        for mass, fires in zip(train.cylinders_at, angles.T, strict=True):
            add(mass, 0.0, one.mean, EPS * ROUNDED_ORDERS * one.sizes[:, 0])
            for k, order in enumerate(ENGINE_ORDERS):
                torque = one.orders[:, k]
                error = EPS * (ROUNDED_ORDERS * one.sizes[:, k + 1] + order * np.abs(fires) * np.abs(torque))
                add(mass, order, torque * np.exp(-1j * order * fires), error)
    if train.machine_at is not None:
        backwards = n["machine.speed"] < 0.0
        for k in range(MACHINE_HARMONICS + 1):
            cosine, sine, error = (n[f"machine.{part}_{k}"] for part in ("cosine", "sine", "error"))
            # cos hφ + … = Re (c − i s) e^(ihφ), with decreasing φ if the machine turns backwards.
            add(train.machine_at, k / revolutions, cosine - 1j * np.where(backwards, -sine, sine), error)
    means = [sums[node, 0.0].real for node in nodes]
    if train.load is not None:
        means[node_of[train.load]] -= stacked(means).sum()
    every = stacked([sums[node, order] for node in nodes for order in (0.0, *orders)])
    moments = every.reshape(len(nodes), 1 + len(orders), -1)[:, 1:]
    return TrainExcitation(orders, train_speed(train, n), moments, stacked(means))
