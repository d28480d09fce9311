"""Holzer's table of a train at a natural frequency: amplitudes, torques and twists of the mode.

Source: J. P. Den Hartog, Mechanical Vibrations, chapter 5.
"""

from typing import NamedTuple

import numpy as np

from engine.elements.torsional_trains.reduced_train import ReducedTrain


class HolzerTable(NamedTuple):
    """Holzer's table of one variant, reduced, node by node.

    Attributes
    ----------
    amplitudes : ndarray (nodes,)
        θ [rad]; the largest is 1.
    inertial : ndarray (nodes,)
        J ω² θ minus the torque of shafts to the frame [N·m].
    carried : ndarray (nodes,)
        Torque of the shaft to the parent: the sum over all nodes beyond it; 0 for the first node [N·m].
    twists : ndarray (nodes,)
        Twist of that shaft, θ − θ_parent = carried/k [rad].
    remainder : float
        Sum over all nodes, 0 at a natural frequency [N·m].
    """

    amplitudes: np.ndarray
    inertial: np.ndarray
    carried: np.ndarray
    twists: np.ndarray
    remainder: float


def holzer_table(train: ReducedTrain, frequency: float, mode: np.ndarray) -> HolzerTable:
    """Holzer's table of the first variant of a train.

    Parameters
    ----------
    train : ReducedTrain
    frequency : float
        Natural frequency [rad/s].
    mode : ndarray (nodes,)
        Mode shape, of any scale.
    """
    amplitudes = mode / mode[np.abs(mode).argmax()]
    inertial = (train.inertias[:, 0] * frequency**2 - train.ground[:, 0]) * amplitudes
    carried = inertial.copy()
    for node in range(len(train.parents) - 1, 0, -1):
        carried[train.parents[node]] += carried[node]
    remainder, carried[0] = float(carried[0]), 0.0
    stiff = train.stiffnesses[:, 0]
    twists = np.divide(carried, stiff, out=np.zeros_like(carried), where=stiff > 0.0)
    return HolzerTable(amplitudes, inertial, carried, twists, remainder)
