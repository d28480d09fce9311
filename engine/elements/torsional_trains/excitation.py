"""Excitation of a torsional train: torques of given orders, of an engine's cylinders, or of the scene's machine."""

from typing import NamedTuple

import numpy as np

from engine.elements.element import Element, Numbers
from engine.elements.engines.made_engine import ROUNDED_ORDERS, engine_torque
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
    moments : ndarray of complex (nodes, orders, variants)
        M(t) = Re Σ M_h e^(i h Ω t) [N·m].
    means : ndarray (nodes, variants)
        Mean torques [N·m].
    moment_errors, mean_errors : ndarray
        Their error estimates, of the same shapes [N·m].
    """

    orders: tuple[float, ...]
    speed: np.ndarray
    moments: np.ndarray
    means: np.ndarray
    moment_errors: np.ndarray
    mean_errors: np.ndarray


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
    node_of = dict(zip(layout.masses, layout.node_of, strict=True))
    nodes, variants = reduced.inertias.shape
    moments, means = np.zeros((nodes, len(orders), variants), complex), np.zeros((nodes, variants))
    moment_errors, mean_errors = np.zeros(moments.shape), np.zeros(means.shape)

    def add(mass: str, order: float, moment: np.ndarray, error: np.ndarray) -> None:
        node, ratio = node_of[mass], reduced.ratios[mass]
        if order == 0:
            means[node] += ratio * np.real(moment)
            mean_errors[node] += np.abs(ratio) * error
        else:
            place = orders.index(order)
            moments[node, place] += ratio * moment
            moment_errors[node, place] += np.abs(ratio) * error

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
    if train.load is not None:
        means[node_of[train.load]] -= means.sum(axis=0)
        mean_errors[node_of[train.load]] += mean_errors.sum(axis=0)
    return TrainExcitation(orders, train_speed(train, n), moments, means, moment_errors, mean_errors)
