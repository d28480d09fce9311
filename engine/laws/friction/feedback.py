"""Feedback of friction on the reactions that cause it: the pressing forces in the pairs of one structural group.

The pressing force n of a journal is its reaction R; that of a guide is the larger of |N| and |M|/a (see
`engine.laws.friction.guides`). Friction is proportional to n, and reactions are linear in friction: for the pairs i of
a group (x_i, y_i) = (x_i, y_i)° + Σ_j (X_ij, Y_ij) n_j, ° without friction, and n_i = |(x_i, y_i)| in the norm of a
journal or of a guide. An iteration takes the directions (p_i, q_i) of the reactions as known, so
n_i = p_i x_i + q_i y_i is linear, and solves

    Σ_j (δ_ij − p_i X_ij − q_i Y_ij) n_j = p_i x_i° + q_i y_i°

exactly. This is Newton's method: it converges quadratically, also near jamming. The matrix is that of friction's
feedback. Its determinant is 1 without friction; where it falls to 0 forces grow without bound, and beyond that no
forces are in equilibrium: the mechanism jams.

Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines, kinetostatics with friction by successive approximation;
L. Qi, J. Sun, A nonsmooth version of Newton's method, Mathematical Programming 58 (1993), for the kinks of |N|.
"""

import math

from engine.compiling.decorators import scalar


@scalar
def guide_bearing(normal: float, moment: float, edge: float) -> tuple[float, float]:
    """Contact state of a slider: on one face over its full length, or with its edges on both.

    Parameters
    ----------
    normal, moment : float
        N [N] and M about the slider's middle [N·m].
    edge : float
        1/a, reciprocal of half the slider's length [1/m]; 0 if it never tilts.

    Returns
    -------
    p, q : float
        p N + q M is the pressing force, |N| or |M|/a.
    """
    if abs(moment) * edge > abs(normal):
        return 0.0 * normal, math.copysign(edge, moment)
    return math.copysign(1.0, normal), 0.0 * moment


@scalar
def guide_pressing(normal: float, moment: float, edge: float) -> float:
    """Pressing force of a guide, the larger of |N| and |M|/a [N]; arguments as in `guide_bearing`."""
    return max(abs(normal), abs(moment) * edge)


@scalar
def change_of(change: float, whole: float) -> float:
    """Change relative to a force; 0 if the change is 0."""
    return change / whole if change > 0.0 else change
