"""Pressing forces in the rubbing pairs of a structural group, settled by a fixed number of passes without branches.

The equations are those of `engine.laws.friction.feedback`: n_i = |R_i| with R_i = R_i° + Σ_j B_ij n_j, where R_i° is
what pair i bears without friction in the group and B_ij what a newton that presses in pair j adds to it. In a journal
|R| is the length of the reaction; in a guide, where R stands for the normal force N and the moment M, the greater of
|N| and |M|/a. Each pass takes the directions of the reactions from the pass before and solves the linear equations that
are left. That is Newton's method: errors fall with their squares.

A fixed number of passes is straight-line code, so that variants are computed side by side. Over random groups six of
them miss less than 1e-15 in 99 % of positions where the margin against jamming is above a half, 1e-13 where it is above
a tenth, and 1e-8 below. What they leave is never hidden: `residual` is the change in the last of them, and what remains
is about its square. Where it is not small, either no forces are in equilibrium, or friction in one pair gives back more
than the whole of a force and passes alternate without end; both count as jammed.
"""

import math

from engine.compiling.decorators import scalar
from engine.laws.friction.feedback import change_of, guide_bearing

# Kinds of pairs in the arguments of these laws.
GUIDE, JOURNAL = 0.0, 1.0
# Pressing forces that still change by more than this share in the last pass belong to no equilibrium.
UNSETTLED = 1e-2
# A determinant of friction's feedback that is nothing but rounding.
JAMMED = 1e-14

# Of a pair its kind, edge, reaction without friction, and what a newton in each pair adds to the reaction.
_One = tuple[float, float, float, float, float, float]
_Two = tuple[float, float, float, float, float, float, float, float]
_Three = tuple[float, float, float, float, float, float, float, float, float, float]


@scalar
def settled_one(*pair: float) -> tuple[float, float, float]:
    """Pressing force in the only rubbing pair of a group.

    Parameters
    ----------
    *pair : float
        Six numbers: kind (`JOURNAL` or `GUIDE`); edge (of a guide the reciprocal 1/a of half of the slider's length
        [1/m], 0 where it never tilts); two components of the reaction without friction in the group (of a guide normal
        force [N] and moment [N·m]); what each newton that presses adds to either component.

    Returns
    -------
    n : float
        Pressing force [N]; NaN where the group jams.
    margin : float
        Against jamming: the determinant of friction's feedback, 1 without friction; 0 where nothing settles.
    residual : float
        Change of the pressing forces in the last pass, as a share of them all.
    """
    n, first = _pass_of_one(pair, 0.0)
    n, _ = _pass_of_one(pair, n)
    n, _ = _pass_of_one(pair, n)
    n, _ = _pass_of_one(pair, n)
    old, _ = _pass_of_one(pair, n)
    n, determinant = _pass_of_one(pair, old)
    residual = change_of(abs(n - old), abs(n))
    margin = margin_against_jamming(first, determinant, residual)
    return unless_jammed(n, margin), margin, residual


@scalar
def settled_two(*pairs: float) -> tuple[float, float, float, float]:
    """Pressing forces in two rubbing pairs of a group.

    Parameters
    ----------
    *pairs : float
        Eight numbers of the first pair, then of the second: as for `settled_one`, and what each newton that presses in
        the second pair adds to either component of the reaction.

    Returns
    -------
    n1, n2, margin, residual : float
        As for `settled_one`.
    """
    one, two = pairs[:8], pairs[8:]
    n1, n2, first = _pass_of_two(one, two, 0.0, 0.0)
    n1, n2, _ = _pass_of_two(one, two, n1, n2)
    n1, n2, _ = _pass_of_two(one, two, n1, n2)
    n1, n2, _ = _pass_of_two(one, two, n1, n2)
    old1, old2, _ = _pass_of_two(one, two, n1, n2)
    n1, n2, determinant = _pass_of_two(one, two, old1, old2)
    residual = change_of(abs(n1 - old1) + abs(n2 - old2), abs(n1) + abs(n2))
    margin = margin_against_jamming(first, determinant, residual)
    return unless_jammed(n1, margin), unless_jammed(n2, margin), margin, residual


@scalar
def settled_three(*pairs: float) -> tuple[float, float, float, float, float]:
    """Pressing forces in all three pairs of a group; ten numbers of each pair, otherwise as `settled_two`."""
    one, two, three = pairs[:10], pairs[10:20], pairs[20:]
    n1, n2, n3, first = _pass_of_three(one, two, three, 0.0, 0.0, 0.0)
    n1, n2, n3, _ = _pass_of_three(one, two, three, n1, n2, n3)
    n1, n2, n3, _ = _pass_of_three(one, two, three, n1, n2, n3)
    n1, n2, n3, _ = _pass_of_three(one, two, three, n1, n2, n3)
    old1, old2, old3, _ = _pass_of_three(one, two, three, n1, n2, n3)
    n1, n2, n3, determinant = _pass_of_three(one, two, three, old1, old2, old3)
    change = abs(n1 - old1) + abs(n2 - old2) + abs(n3 - old3)
    residual = change_of(change, abs(n1) + abs(n2) + abs(n3))
    margin = margin_against_jamming(first, determinant, residual)
    return (
        unless_jammed(n1, margin),
        unless_jammed(n2, margin),
        unless_jammed(n3, margin),
        margin,
        residual,
    )


@scalar
def bearing(kind: float, edge: float, x: float, y: float) -> tuple[float, float, float]:
    """Direction (p, q) of a reaction (x, y) and its length r: (p x + q y)/r is what presses.

    A journal's direction is the reaction itself: the equations are multiplied by r, which saves divisions. It presses
    with nothing where there is no reaction.

    Parameters
    ----------
    kind, edge, x, y : float
        As for `settled_one`.
    """
    if kind == JOURNAL:
        reaction = math.sqrt(x * x + y * y)
        return x, y, 1.0 if reaction == 0.0 else reaction
    p, q = guide_bearing(x, y, edge)
    return p, q, 1.0


@scalar
def _pass_of_one(pair: _One, n: float) -> tuple[float, float]:
    """Pressing force and determinant from the pressing force of the pass before."""
    kind, edge, x, y, x1, y1 = pair
    p, q, r = bearing(kind, edge, x + x1 * n, y + y1 * n)
    determinant = r - p * x1 - q * y1
    return (p * x + q * y) / determinant, determinant / r


@scalar
def _row_of_two(pair: _Two, n1: float, n2: float) -> tuple[float, float, float, float]:
    """Equation r n_i = back1 n1 + back2 n2 + force of a pair."""
    kind, edge, x, y, x1, y1, x2, y2 = pair
    p, q, r = bearing(kind, edge, x + x1 * n1 + x2 * n2, y + y1 * n1 + y2 * n2)
    return r, p * x1 + q * y1, p * x2 + q * y2, p * x + q * y


@scalar
def _pass_of_two(one: _Two, two: _Two, n1: float, n2: float) -> tuple[float, float, float]:
    r1, a11, a12, force1 = _row_of_two(one, n1, n2)
    r2, a21, a22, force2 = _row_of_two(two, n1, n2)
    left, right = r1 - a11, r2 - a22
    determinant = left * right - a12 * a21
    return (
        (right * force1 + a12 * force2) / determinant,
        (left * force2 + a21 * force1) / determinant,
        determinant / (r1 * r2),
    )


@scalar
def _row_of_three(pair: _Three, n1: float, n2: float, n3: float) -> tuple[float, float, float, float, float]:
    kind, edge, x, y, x1, y1, x2, y2, x3, y3 = pair
    p, q, r = bearing(kind, edge, x + x1 * n1 + x2 * n2 + x3 * n3, y + y1 * n1 + y2 * n2 + y3 * n3)
    return r, p * x1 + q * y1, p * x2 + q * y2, p * x3 + q * y3, p * x + q * y


@scalar
def _pass_of_three(
    one: _Three, two: _Three, three: _Three, n1: float, n2: float, n3: float
) -> tuple[float, float, float, float]:
    r1, a11, a12, a13, force1 = _row_of_three(one, n1, n2, n3)
    r2, a21, a22, a23, force2 = _row_of_three(two, n1, n2, n3)
    r3, a31, a32, a33, force3 = _row_of_three(three, n1, n2, n3)
    b11, b22, b33 = r1 - a11, r2 - a22, r3 - a33
    # Cofactors of the matrix of the equations.
    c11, c12, c13 = b22 * b33 - a23 * a32, a21 * b33 + a23 * a31, a21 * a32 + b22 * a31
    c21, c22, c23 = a12 * b33 + a13 * a32, b11 * b33 - a13 * a31, b11 * a32 + a12 * a31
    c31, c32, c33 = a12 * a23 + a13 * b22, b11 * a23 + a13 * a21, b11 * b22 - a12 * a21
    determinant = b11 * c11 - a12 * c12 - a13 * c13
    return (
        (c11 * force1 + c21 * force2 + c31 * force3) / determinant,
        (c12 * force1 + c22 * force2 + c32 * force3) / determinant,
        (c13 * force1 + c23 * force2 + c33 * force3) / determinant,
        determinant / (r1 * r2 * r3),
    )


@scalar
def margin_against_jamming(first: float, determinant: float, residual: float) -> float:
    """Margin against jamming: the determinant of the last pass; 0 where the pressing forces never settle.

    It is NaN only where the determinant of the first pass is, because the reactions without friction aren't known.

    Parameters
    ----------
    first, determinant : float
        Of the first and of the last pass.
    residual : float
        Change of the pressing forces in the last pass, as a share of them all.
    """
    return determinant if residual <= UNSETTLED else 0.0 * first


@scalar
def unless_jammed(n: float, margin: float) -> float:
    """A pressing force; NaN where the margin against jamming is nothing but rounding."""
    return n if margin > JAMMED else math.nan
