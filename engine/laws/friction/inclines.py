"""Friction on inclined faces: a load on a slope, and the two faces of a groove.

Two surfaces with slope t = tan α not above f = tan φ are self-locking: a force inside the friction cone, within φ of
the normal, cannot slide one on the other, however large it is. Tangents of sums of angles are computed from t and f,
tan(α + φ) = (t + f)/(1 − t f), so that without friction, and at the limit of self-locking, only rounding is left.

Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines, friction in kinematic pairs; R. S. Khurmi and
J. K. Gupta, Theory of Machines, chapter 10.
"""

import numpy as np

Value = float | np.ndarray


def push_up(slope: Value, friction: Value) -> np.ndarray:
    """Horizontal force that moves a load up a slope, over the load: tan(α + φ); infinite where it jams."""
    left = 1 - slope * friction
    return np.where(left > 0.0, (slope + friction) / left, np.inf)


def push_down(slope: Value, friction: Value) -> Value:
    """Horizontal force that moves a load down a slope, over the load: tan(φ − α), negative where it has to be held."""
    return (friction - slope) / (1 + slope * friction)


def in_groove(friction: Value, angle: Value) -> Value:
    """Coefficient of friction relative to the force that presses into a groove with an angle between its faces."""
    return friction / np.sin(angle / 2)
