"""Minimum rms and minimum peak of vectors that are linear in unknowns, with a proven lower bound.

At each position k the residual vector is A_k z + b_k, with the shaking b and the unknowns z: balancing vectors of two
components, |z_i| ≤ most, and masses, 0 ≤ z_i ≤ most. Both problems are convex:

- minimum rms: a quadratic program, solved by orthogonal factorisation if no limit is active, else by accelerated
  projected gradients on the triangular factor;
- minimum peak (Chebyshev), a second-order cone program: |v| is the maximum of g·v over all directions g, so linear
  programs with an increasing number of directions bound it from below, and their solutions from above.

Both give a lower bound for all choices of the unknowns. It follows from multipliers by weak duality, however these were
obtained, and holds within the rounding of its sums.

Sources: S. Boyd, L. Vandenberghe, Convex Optimization (duality, chapter 5); J. E. Kelley, The cutting-plane method
for solving convex programs (1960); A. Beck, M. Teboulle, A fast iterative shrinkage-thresholding algorithm (2009).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog

from engine.laws.rounding import EPS

# Relative tolerance for linearly dependent effects of unknowns.
DEPENDENT = 1e-8
# Gap between the peak and its lower bound, relative to the peak of b, at which the search ends; maximum of programs.
GAP, PROGRAMS = 1e-9, 400
MOST_STEPS = 50_000
_TOLERANCES = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}


class Unknown(NamedTuple):
    """A balancing vector (`size` 2) of any direction and up to `most`, or a mass (`size` 1) from 0 to `most`."""

    size: int
    most: float = np.inf


class Optimum(NamedTuple):
    """The optimal unknowns.

    Attributes
    ----------
    unknowns : ndarray (unknowns,)
    value : float
        Residual: rms or peak.
    bound : float
        Proven lower bound of the minimum.
    """

    unknowns: np.ndarray
    value: float
    bound: float


class DependentError(ValueError):
    """Unknowns with linearly dependent effects; `columns` are those involved."""

    def __init__(self, columns: np.ndarray) -> None:
        self.columns = columns
        super().__init__(f"the effects of the unknowns {columns.tolist()} depend on each other")


class _Scaled(NamedTuple):
    """The problem scaled to order one: A z + b with z in units of `unit`, all divided by `size`."""

    a: np.ndarray
    b: np.ndarray
    limits: tuple[tuple[slice, int, float], ...]
    unit: np.ndarray
    size: float


def least_rms(a: np.ndarray, b: np.ndarray, unknowns: Sequence[Unknown]) -> Optimum:
    """Minimise the rms of |A_k z + b_k| over the positions.

    Parameters
    ----------
    a : ndarray (positions, parts, unknowns)
        Effect of a unit of each unknown.
    b : ndarray (positions, parts)
    unknowns : sequence of Unknown
        In the order of the columns.

    Raises
    ------
    DependentError
    """
    p = _scaled(a, b, unknowns)
    share = 1 / np.sqrt(len(b))
    rows, right = p.a.reshape(-1, p.a.shape[2]) * share, p.b.ravel() * share
    z = np.linalg.lstsq(rows, -right, rcond=None)[0]
    if np.abs(_within(p, z) - z).max(initial=0.0) > 0:
        z = _projected_gradients(p, rows, right, _within(p, z))
    left = rows @ z + right
    pull = _stationarity(p, z, rows.T @ left)
    # |A s + b|² ≥ |A z + b|² + 2 v·(s − z) + |A (s − z)|² for all s within the limits, v the remaining gradient.
    reach = np.linalg.lstsq(np.linalg.qr(rows, mode="r").T, pull, rcond=None)[0]
    bound = np.sqrt(max(left @ left - reach @ reach, 0.0))
    return Optimum(z * p.unit, float(np.linalg.norm(left)) * p.size, float(bound) * p.size)


def least_peak(a: np.ndarray, b: np.ndarray, unknowns: Sequence[Unknown]) -> Optimum:
    """Minimise the maximum of |A_k z + b_k| over the positions.

    Parameters
    ----------
    a, b, unknowns
        As in `least_rms`.

    Raises
    ------
    DependentError
    """
    p = _scaled(a, b, unknowns)
    best = least_rms(a, b, unknowns).unknowns / p.unit
    # Unknowns at least as good as the initial solution lie within this radius.
    rms = np.sqrt((p.b**2).sum() / len(p.b))
    peak = _sizes(p, best).max()
    radius = (peak + rms) / np.linalg.svd(p.a.reshape(-1, best.size) / np.sqrt(len(p.b)), compute_uv=False)[-1]
    cuts, bound, z = _Cuts(p), 0.0, best
    for _ in range(PROGRAMS):
        cuts.add(z)
        z, proven = cuts.solve(radius)
        bound = max(bound, proven)
        here = _within(p, z)
        reached = _sizes(p, here).max()
        if reached < peak:
            best, peak = here, reached
        if peak - bound <= GAP:
            break
    return Optimum(best * p.unit, float(peak) * p.size, float(bound) * p.size)


def _scaled(a: np.ndarray, b: np.ndarray, unknowns: Sequence[Unknown]) -> _Scaled:
    """Scale the problem by its largest vector, and each unknown by the amount that compensates it."""
    size = float(np.sqrt((b**2).sum(axis=1)).max()) or 1.0
    unit, limits, begin = np.ones(a.shape[2]), [], 0
    for unknown in unknowns:
        place = slice(begin, begin + unknown.size)
        effect = np.sqrt((a[:, :, place] ** 2).sum() / len(b) / unknown.size)
        unit[place] = size / effect if effect > 0 else 1.0
        limits.append((place, unknown.size, unknown.most / unit[begin]))
        begin += unknown.size
    scaled = a * unit / size
    _, spread, shapes = np.linalg.svd(scaled.reshape(-1, a.shape[2]), full_matrices=False)
    if spread.size and spread[-1] <= DEPENDENT * spread[0]:
        raise DependentError(np.flatnonzero(np.abs(shapes[-1]) > DEPENDENT**0.5))
    return _Scaled(scaled, b / size, tuple(limits), unit, size)


def _sizes(p: _Scaled, z: np.ndarray) -> np.ndarray:
    return np.sqrt(((p.a @ z + p.b) ** 2).sum(axis=1))


def _within(p: _Scaled, z: np.ndarray) -> np.ndarray:
    """Project the unknowns on their limits."""
    z = z.copy()
    for place, size, most in p.limits:
        if size == 1:
            z[place] = np.clip(z[place], 0.0, most)
        else:
            z[place] *= min(1.0, most / max(np.linalg.norm(z[place]), 1e-300))
    return z


def _stationarity(p: _Scaled, z: np.ndarray, gradient: np.ndarray) -> np.ndarray:
    """Gradient minus the reactions of the active limits; zero at the optimum (Karush–Kuhn–Tucker)."""
    left = gradient.copy()
    for place, size, most in p.limits:
        if size == 1:
            upwards, downwards = (np.inf if z[place][0] <= 0 else 0.0), (-np.inf if z[place][0] >= most else 0.0)
            left[place] -= np.clip(left[place], downwards, upwards)
        elif np.linalg.norm(z[place]) >= most * (1 - 4 * EPS):
            direction = z[place] / np.linalg.norm(z[place])
            left[place] += max(0.0, -(left[place] @ direction)) * direction
    return left


def _projected_gradients(p: _Scaled, rows: np.ndarray, right: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Least squares within limits by accelerated projected gradients, restarted on overshoot."""
    q, r = np.linalg.qr(rows)
    target, step = q.T @ right, 1 / np.linalg.norm(r, 2) ** 2
    ahead, pace = z, 1.0
    for _ in range(MOST_STEPS):
        gradient = r.T @ (r @ ahead + target)
        new = _within(p, ahead - step * gradient)
        if (ahead - new) @ (new - z) > 0:
            ahead, pace = z, 1.0
            continue
        if np.abs(new - z).max() <= EPS * np.abs(new).max() and np.abs(new - ahead).max() <= 4 * EPS:
            break
        faster = (1 + np.sqrt(1 + 4 * pace**2)) / 2
        ahead, z, pace = new + (pace - 1) / faster * (new - z), new, faster
    return z


class _Cuts:
    """Linear programs that bound the minimum peak from below: g·(A_k z + b_k) ≤ t, directions g at positions k."""

    def __init__(self, problem: _Scaled) -> None:
        self.p = problem
        n = problem.a.shape[2]
        self.slopes, self.heights = np.empty((0, n)), np.empty(0)
        self.rims, self.rim_most = np.empty((0, n)), np.empty(0)

    def add(self, z: np.ndarray) -> None:
        """Add cuts for the vectors of locally maximum length, and for violated limits."""
        p = self.p
        vectors = p.a @ z + p.b
        sizes = np.sqrt((vectors**2).sum(axis=1))
        longest = (sizes >= np.roll(sizes, 1)) & (sizes >= np.roll(sizes, -1)) & (sizes > 0)
        directions = vectors[longest] / sizes[longest, None]
        self.slopes = np.vstack((self.slopes, np.einsum("kp,kpn->kn", directions, p.a[longest])))
        self.heights = np.append(self.heights, (directions * p.b[longest]).sum(axis=1))
        for place, size, most in p.limits:
            length = np.linalg.norm(z[place])
            if size == 2 and length > most:
                rim = np.zeros(z.size)
                rim[place] = z[place] / length
                self.rims, self.rim_most = np.vstack((self.rims, rim)), np.append(self.rim_most, most)

    def solve(self, radius: float) -> tuple[np.ndarray, float]:
        """Unknowns that satisfy all cuts, and the lower bound of the peak proven by their multipliers."""
        n = self.slopes.shape[1]
        within = [(size, min(most, radius)) for _, size, most in self.p.limits for _ in range(size)]
        bounds = [(0.0 if size == 1 else -most, most) for size, most in within]
        left = np.hstack((np.vstack((self.slopes, self.rims)), np.zeros((len(self.heights) + len(self.rims), 1))))
        left[: len(self.heights), -1] = -1.0
        found = linprog(
            np.append(np.zeros(n), 1.0),
            left,
            np.append(-self.heights, self.rim_most),
            bounds=[*bounds, (0, None)],
            method="highs",
            options=_TOLERANCES,
        )
        if found.x is None:
            raise ArithmeticError(f"the linear program of the least peak failed: {found.message}")
        weights = np.maximum(-found.ineqlin.marginals[: len(self.heights)], 0.0)
        weights /= max(weights.sum(), 1e-300)
        return found.x[:-1], float(weights @ self.heights) - self._gain(weights @ self.slopes, radius)

    def _gain(self, slope: np.ndarray, radius: float) -> float:
        """Maximum decrease along a slope by unknowns within their limits and the radius."""
        gain = 0.0
        for place, size, most in self.p.limits:
            direction = np.linalg.norm(slope[place]) if size == 2 else max(0.0, -slope[place][0])
            gain += direction * min(most, radius)
        return gain
