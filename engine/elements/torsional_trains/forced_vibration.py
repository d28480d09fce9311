"""Forced vibration of a tree of masses and shafts under harmonic torques, with bounds on rounding errors.

A mass with everything beyond it has the complex dynamic stiffness S = Σ T − w² J + i w b, and through the shaft to its
parent, of complex stiffness κ = k (1 + i ψ/2π) + i w b, the stiffness T = κ S/(κ + S); torques on it are transmitted in
the ratio κ/(κ + S). From the root outwards, the angles are q = (F + κ q_parent)/(κ + S), and the torque of the shaft is
κ (S q_parent − F)/(κ + S), which avoids the difference of two nearly equal angles of a stiff shaft.

Sources: J. P. Den Hartog, Mechanical Vibrations, chapter 5 (torsional vibration, Holzer's method with damping).
"""

import math
from typing import NamedTuple

import numpy as np

from engine.cycle.measured import Measured, measured, propagated, where
from engine.elements.torsional_trains.reduced_train import ReducedTrain


class ForcedVibration(NamedTuple):
    """Vibration of a reduced train: complex amplitudes, as in amplitude · e^(i w t).

    Attributes
    ----------
    angles : list of Measured (orders, variants)
        Angle of each node [rad]; infinite at a resonance without damping.
    moments : list of Measured (orders, variants)
        Torque of the shaft from each node to its parent, k (q_parent − q); 0 for the first node [N·m].
    dissipated : Measured (variants,)
        Mean power of all dampers [W].
    """

    angles: list[Measured]
    moments: list[Measured]
    dissipated: Measured


def forced_vibration(train: ReducedTrain, frequencies: np.ndarray, moments: Measured) -> ForcedVibration:
    """Steady vibration under harmonic torques on the nodes.

    Parameters
    ----------
    train : ReducedTrain
    frequencies : ndarray (orders, variants)
        Angular frequencies of the torques [rad/s].
    moments : Measured complex (nodes, orders, variants)
        Reduced torques [N·m].
    """
    w, nodes = frequencies, range(len(train.parents))
    losses = w * (train.mass_damping + train.ground_damping)[:, None] + train.ground_loss[:, None] / math.tau
    springs = train.stiffnesses[:, None] * (1.0 + 1j * train.absorptions[:, None] / math.tau)
    stiffness = train.known(springs + 1j * w * train.dampings[:, None])
    held, inertial, damped = (train.known(x) for x in (train.ground[:, None], w**2 * train.inertias[:, None], losses))
    dynamic = [held[node] - inertial[node] + 1j * damped[node] for node in nodes]
    pushed = [moments[node] for node in nodes]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for node in nodes[:0:-1]:
            parent, k, s = train.parents[node], stiffness[node], dynamic[node]
            dynamic[parent] += _in_series(k, s)
            pushed[parent] += k / (k + s) * pushed[node]
        angles, carried = [_or_infinite(pushed[0], dynamic[0])], [measured(np.zeros_like(dynamic[0].value))]
        for node in nodes[1:]:
            k, s, q = stiffness[node], dynamic[node], angles[train.parents[node]]
            angles.append(_or_infinite(pushed[node] + k * q, k + s))
            carried.append(k * _or_infinite(s * q - pushed[node], k + s))
        power = measured(np.zeros(w.shape))
        for node in nodes:
            twist = carried[node] / stiffness[node]
            for loss, angle in ((losses[node], angles[node]), (stiffness[node].value.imag, twist)):
                lost = train.known(0.5 * w * loss) * abs(angle) ** 2
                power += where(loss > 0.0, lost, measured(0.0))
    return ForcedVibration(angles, carried, power.sum())


def _in_series(k: Measured, s: Measured) -> Measured:
    """Stiffness of two springs in series."""
    own, other = s.value / (k + s).value, k.value / (k + s).value
    return propagated(k.value * own, (own**2, k), (other**2, s))


def _or_infinite(top: Measured, below: Measured) -> Measured:
    """A quotient; infinite if the divisor may be 0 and the dividend is not 0."""
    nothing, found = (top.value == 0.0) & (top.error == 0.0), top / below
    infinite = ~np.isfinite(found.error)
    return where(nothing, measured(0.0), where(infinite, measured(math.inf), found))


def under_mean_moments(train: ReducedTrain, moments: Measured) -> ForcedVibration:
    """A train under constant torques; if nothing holds it, their resultant accelerates it as a whole.

    Parameters
    ----------
    train : ReducedTrain
    moments : Measured (nodes, variants)
        Reduced constant torques [N·m].

    Returns
    -------
    ForcedVibration
        A single order, 0; the angles of a free train are NaN.
    """
    nodes, still = range(len(train.parents)), np.zeros((1, *moments.shape[1:]))
    if train.ground.any():
        # Hysteresis absorbs energy in cycles only.
        springs = train._replace(absorptions=0.0 * train.absorptions, ground_loss=0.0 * train.ground_loss)
        return forced_vibration(springs, still, moments[:, None])
    share = train.known(train.inertias / train.inertias.sum(axis=0))
    # The torque that accelerates a mass minus the one that acts on it.
    carried = [share[node] * moments.sum() - moments[node] for node in nodes]
    for node in nodes[:0:-1]:
        carried[train.parents[node]] += carried[node]
    carried[0] = measured(still[0])
    return ForcedVibration([measured(still + math.nan)] * len(nodes), [m[None] for m in carried], measured(still[0]))
