"""Shaking force of a machine on its frame: its magnitude, and its orders of the crank.

The inertia forces of all links are what a machine in uniform motion does to its frame beyond its loads. As the crank
turns, the end of the shaking force draws the hodograph; each order n of it is an ellipse

    F_n exp(i n phi) + B_n exp(−i n phi),   F_n = mean of (F_x + i F_y) exp(−i n phi),  B_n with + i n phi,

whose longer half axis is |F_n| + |B_n|. Over N equally spaced positions of a cycle the means are exact for a force
whose orders add up with n to less than the positions of a turn; what lies beyond is mistaken for lower orders.

Source: J. P. Den Hartog, Mechanical Vibrations (forces of inertia and their harmonics).
"""

import math

import numpy as np

from engine.compiling.jit import routine, scalar


@scalar
def magnitudes(x: np.ndarray, y: np.ndarray, size: np.ndarray) -> None:
    """Magnitude of a vector at every position, into `size`.

    Parameters
    ----------
    x, y, size : ndarray (positions,)
    """
    for k in range(size.shape[0]):
        size[k] = math.sqrt(x[k] * x[k] + y[k] * y[k])


@routine
def order_of(x: np.ndarray, y: np.ndarray, order: int, cosines: np.ndarray, sines: np.ndarray) -> tuple[float, float]:
    """Longer half axis of the ellipse that one order of a plane vector draws.

    Parameters
    ----------
    x, y : ndarray (positions,)
        Components at equally spaced positions of a whole cycle.
    order : int
        In turns of the crank.
    cosines, sines : ndarray (positions, or a multiple of them)
        Of the crank angle over the cycle.

    Returns
    -------
    half_axis : float
        NaN if any value is.
    terms : float
        Mean magnitude of the terms it is summed of, by which its rounding is measured.
    """
    n, all_positions = x.shape[0], cosines.shape[0]
    stride = order * (all_positions // n)
    xc = xs = yc = ys = terms = 0.0
    for k in range(n):
        j = stride * k % all_positions
        xc += x[k] * cosines[j]
        xs += x[k] * sines[j]
        yc += y[k] * cosines[j]
        ys += y[k] * sines[j]
        terms += abs(x[k]) + abs(y[k])
    forward, backward = math.hypot(xc + ys, yc - xs), math.hypot(xc - ys, yc + xs)
    return (forward + backward) / n, terms / n
