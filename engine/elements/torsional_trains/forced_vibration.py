"""Forced vibration of a tree of masses and shafts under harmonic torques, with bounds on rounding errors.

A mass with everything beyond it has the complex dynamic stiffness S = Σ T − w² J + i w b, and through the shaft to its
parent, of complex stiffness κ = k (1 + i ψ/2π) + i w b, the stiffness T = κ S/(κ + S); torques on it are transmitted in
the ratio κ/(κ + S). From the root outwards, the angles are q = (F + κ q_parent)/(κ + S), and the torque of the shaft is
κ (S q_parent − F)/(κ + S), which avoids the difference of two nearly equal angles of a stiff shaft.

Error estimates are computed alongside: the errors of all inertias and stiffnesses, and the rounding of every operation,
to first order. They grow towards a resonance with little damping, where small changes have large effects.

Sources: J. P. Den Hartog, Mechanical Vibrations, chapter 5 (torsional vibration, Holzer's method with damping); J. H.
Wilkinson, Rounding Errors in Algebraic Processes (running error analysis).
"""

import math
from typing import NamedTuple

import numpy as np

from engine.elements.torsional_trains.reduced_train import ReducedTrain
from engine.laws.rounding import EPS

# Rounding of a few complex operations.
_STEP = 8.0 * EPS


class ForcedVibration(NamedTuple):
    """Vibration of a reduced train: complex amplitudes, as in amplitude · e^(i w t), and bounds on their errors.

    Attributes
    ----------
    angles, angle_errors : ndarray (nodes, orders, variants)
        [rad]; infinite at a resonance without damping.
    moments, moment_errors : ndarray (nodes, orders, variants)
        Torque of the shaft to the parent, k (q_parent − q); 0 for the first node [N·m].
    dissipated : ndarray (variants,)
        Mean power of all dampers [W].
    """

    angles: np.ndarray
    angle_errors: np.ndarray
    moments: np.ndarray
    moment_errors: np.ndarray
    dissipated: np.ndarray


def forced_vibration(
    train: ReducedTrain, frequencies: np.ndarray, moments: np.ndarray, moment_errors: np.ndarray
) -> ForcedVibration:
    """Steady vibration under harmonic torques on the nodes.

    Parameters
    ----------
    train : ReducedTrain
    frequencies : ndarray (orders, variants)
        Angular frequencies of the torques [rad/s].
    moments : ndarray of complex (nodes, orders, variants)
        Reduced torques [N·m].
    moment_errors : ndarray (nodes, orders, variants)
        Their error estimates [N·m].
    """
    w = frequencies
    given = EPS * (train.roundings + 2.0)
    inertial, rubbing = w**2 * train.inertias[:, None], w * (train.mass_damping + train.ground_damping)[:, None]
    ground = train.ground[:, None]
    loss = train.ground_loss[:, None] / math.tau
    shaft = train.stiffnesses[:, None] * (1.0 + 1j * train.absorptions[:, None] / math.tau)
    shaft = shaft + 1j * w * train.dampings[:, None]
    dynamic = ground - inertial + 1j * (rubbing + loss)
    dynamic_errors = (given + EPS) * (np.abs(ground) + inertial + rubbing + loss)
    pushed, pushed_errors = moments.astype(complex), given * np.abs(moments) + moment_errors
    pivots, pivot_errors = np.ones_like(dynamic), np.zeros_like(dynamic_errors)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for node in range(len(train.parents) - 1, 0, -1):
            parent, s, k, e = train.parents[node], dynamic[node], shaft[node], dynamic_errors[node]
            own = (given + EPS) * np.abs(k)
            pivot = pivots[node] = k + s
            off = pivot_errors[node] = own + e + EPS * np.abs(pivot)
            through, passed = k * s / pivot, k / pivot
            dynamic[parent] += through
            dynamic_errors[parent] += np.abs(passed) ** 2 * (e + EPS * np.abs(pivot))
            dynamic_errors[parent] += np.abs(s / pivot) ** 2 * own + _STEP * np.abs(through)
            pushed[parent] += passed * pushed[node]
            passed_off = (np.abs(s) * own + np.abs(k) * e) / np.abs(pivot) ** 2 + _STEP * np.abs(passed)
            pushed_errors[parent] += np.abs(passed) * pushed_errors[node] + passed_off * np.abs(pushed[node])
        angles, errors = np.empty_like(dynamic), np.empty_like(dynamic_errors)
        angles[0], errors[0] = _quotient(pushed[0], pushed_errors[0], dynamic[0], dynamic_errors[0])
        shaft_moments, moment_errors = np.zeros_like(dynamic), np.zeros_like(dynamic_errors)
        for node in range(1, len(train.parents)):
            parent, k, s, pivot, off = (
                train.parents[node],
                shaft[node],
                dynamic[node],
                pivots[node],
                pivot_errors[node],
            )
            q, e = angles[parent], errors[parent]
            own = (given + EPS) * np.abs(k)
            top_off = pushed_errors[node] + np.abs(k) * e + own * np.abs(q) + _STEP * np.abs(k * q)
            angles[node], errors[node] = _quotient(pushed[node] + k * q, top_off, pivot, off)
            top = s * q - pushed[node]
            top_off = np.abs(s) * e + dynamic_errors[node] * np.abs(q) + pushed_errors[node] + _STEP * np.abs(s * q)
            ratio, ratio_off = _quotient(top, top_off, pivot, off)
            shaft_moments[node] = k * ratio
            moment_errors[node] = np.abs(k) * ratio_off + own * np.abs(ratio) + _STEP * np.abs(shaft_moments[node])
        lost = (rubbing + loss) * np.abs(angles) ** 2
        stretched = np.where(train.stiffnesses[:, None] > 0.0, shaft_moments / shaft, 0.0)
        lost = lost + shaft.imag * np.abs(stretched) ** 2
        dissipated = 0.5 * (w * np.where(rubbing + loss + shaft.imag > 0.0, lost, 0.0)).sum(axis=(0, 1))
    return ForcedVibration(angles, errors, shaft_moments, moment_errors, dissipated)


def _quotient(
    top: np.ndarray, top_off: np.ndarray, below: np.ndarray, below_off: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """A quotient and its error estimate; infinite if the divisor may be 0 and the dividend is not 0."""
    least = np.abs(below) - below_off
    nothing = (top == 0.0) & (top_off == 0.0)
    bounded = (least > 0.0) & np.isfinite(top_off)
    value = np.where(bounded, top / below, math.inf)
    error = np.where(bounded, (top_off + np.abs(value) * below_off) / least + _STEP * np.abs(value), math.inf)
    return np.where(nothing, 0.0, value), np.where(nothing, 0.0, error)


def under_mean_moments(train: ReducedTrain, moments: np.ndarray, moment_errors: np.ndarray) -> ForcedVibration:
    """A train under constant torques; if nothing holds it, their resultant accelerates it as a whole.

    Parameters
    ----------
    train : ReducedTrain
    moments, moment_errors : ndarray (nodes, variants)
        Reduced constant torques and their error estimates [N·m].

    Returns
    -------
    ForcedVibration
        A single order, 0; the angles of a free train are NaN.
    """
    if train.ground.any():
        still = np.zeros((1, moments.shape[1]))
        return forced_vibration(train, still, moments[:, None], moment_errors[:, None])
    share = train.inertias / train.inertias.sum(axis=0)
    carried = share * moments.sum(axis=0) - moments
    # The error of each torque affects each shaft at most once directly and once through the acceleration.
    off = EPS * (train.roundings + 2.0 * len(train.parents) + 4.0) * np.abs(moments) + moment_errors
    errors = share * off.sum(axis=0) + off
    for node in range(len(train.parents) - 1, 0, -1):
        carried[train.parents[node]] += carried[node]
        errors[train.parents[node]] += errors[node]
    carried[0] = errors[0] = 0.0
    nowhere = np.full((*moments.shape[:1], 1, *moments.shape[1:]), math.nan)
    return ForcedVibration(nowhere, nowhere, carried[:, None], errors[:, None], np.zeros(moments.shape[1]))
