"""Friction that acts back on the reactions it comes from: the pressing forces in the pairs of one structural group.

In a pair n presses: the reaction R of a journal, or of a guide the greater of |N| and |M|/a (see
`engine.laws.friction.guides`). Friction is proportional to n, and reactions are linear in friction: for the pairs i of
a group (x_i, y_i) = (x_i, y_i)° + Σ_j (X_ij, Y_ij) n_j, ° without friction, and n_i = |(x_i, y_i)| in one of the two
senses. A pass takes the directions (p_i, q_i) of the reactions as known, then n_i = p_i x_i + q_i y_i is linear,

    Σ_j (δ_ij − p_i X_ij − q_i Y_ij) n_j = p_i x_i° + q_i y_i°,

and solved exactly. It is Newton's method: errors fall with their squares, and close to jamming no slower. The matrix
is that of friction's feedback. Its determinant is 1 without friction; where it falls to 0 forces grow without bound,
and beyond that no forces are in equilibrium: the mechanism jams.

Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines, kinetostatics with friction by repeated passes;
L. Qi, J. Sun, A nonsmooth version of Newton's method, Mathematical Programming 58 (1993), for the kinks of |N|.
"""

import math

from engine.compiling.decorators import scalar

# A position whose pressing forces still change by more than this share after all passes has none in equilibrium.
UNSETTLED = 1e-6
# Passes take whole steps first; half ones after that, should kinks throw them to and fro.
WHOLE_PASSES, MOST_PASSES, HALF_WAY = 8, 40, 0.5


@scalar
def journal_bearing(x: float, y: float) -> tuple[float, float]:
    """Direction of a journal's reaction.

    Parameters
    ----------
    x, y : float
        Components of the reaction [N].

    Returns
    -------
    p, q : float
        p x + q y is the pressing force; 0 where nothing presses.
    """
    reaction = math.sqrt(x * x + y * y)
    if reaction == 0.0:
        return x, y
    return x / reaction, y / reaction


@scalar
def guide_bearing(normal: float, moment: float, edge: float) -> tuple[float, float]:
    """On what a slider bears: on one face with all its length, or with its edges on both.

    Parameters
    ----------
    normal, moment : float
        N [N] and M about the slider's middle [N·m].
    edge : float
        1/a, a half of the slider's length [1/m]; 0 where it never tilts.

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
    """Pressing force of a guide, the greater of |N| and |M|/a [N]; arguments as for `guide_bearing`."""
    return max(abs(normal), abs(moment) * edge)


@scalar
def one_pressing(a: float, force: float) -> tuple[float, float]:
    """Pressing force n = a n + force of one pair.

    Parameters
    ----------
    a : float
        What friction gives back to the force it comes from.
    force : float
        Pressing force without friction, along the direction that is taken as known [N].

    Returns
    -------
    n, determinant : float
        [N], 1 − a.
    """
    determinant = 1.0 - a
    return force / determinant, determinant


@scalar
def two_pressing(
    a11: float, a12: float, a21: float, a22: float, force1: float, force2: float
) -> tuple[float, float, float]:
    """Pressing forces of two pairs, as `one_pressing`: a_ij is what pair j gives to pair i."""
    left, right = 1.0 - a11, 1.0 - a22
    determinant = left * right - a12 * a21
    return (
        (right * force1 + a12 * force2) / determinant,
        (left * force2 + a21 * force1) / determinant,
        determinant,
    )


@scalar
def three_pressing(
    a11: float,
    a12: float,
    a13: float,
    a21: float,
    a22: float,
    a23: float,
    a31: float,
    a32: float,
    a33: float,
    force1: float,
    force2: float,
    force3: float,
) -> tuple[float, float, float, float]:
    """Pressing forces of three pairs, as `two_pressing`."""
    b11, b22, b33 = 1.0 - a11, 1.0 - a22, 1.0 - a33
    # Cofactors of the matrix I − A.
    c11, c12, c13 = b22 * b33 - a23 * a32, a21 * b33 + a23 * a31, a21 * a32 + b22 * a31
    c21, c22, c23 = a12 * b33 + a13 * a32, b11 * b33 - a13 * a31, b11 * a32 + a12 * a31
    c31, c32, c33 = a12 * a23 + a13 * b22, b11 * a23 + a13 * a21, b11 * b22 - a12 * a21
    determinant = b11 * c11 - a12 * c12 - a13 * c13
    return (
        (c11 * force1 + c21 * force2 + c31 * force3) / determinant,
        (c12 * force1 + c22 * force2 + c32 * force3) / determinant,
        (c13 * force1 + c23 * force2 + c33 * force3) / determinant,
        determinant,
    )


@scalar
def change_of(change: float, whole: float) -> float:
    """Change as a share of a force; 0 where there is neither."""
    return change / whole if change > 0.0 else change


@scalar
def freedom(determinant: float, change: float) -> float:
    """How far a group is from jamming: the determinant, 0 where the pressing forces change on and on."""
    return 0.0 * change if change > UNSETTLED else determinant


@scalar
def unless_jammed(value: float, margin: float, least: float) -> float:
    """A value where the margin against jamming is more than the least, otherwise NaN."""
    return value if margin > least else math.nan
