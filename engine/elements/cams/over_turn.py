"""Extremes over the turn of a cam with their positions, and the mean of its torque, on Chebyshev panels.

Initially each smooth piece of the turn is one panel. A panel is cut where friction causes a kink, and halved until
polynomials represent every quantity sought; the peaks of the polynomials are the extremes.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from engine.cycle.panels.chebyshev import PLACES
from engine.cycle.panels.sampled import Tops, panel_integrals, root_inside, tails, tops
from engine.elements.cams.positions import CamVariants, at_positions
from engine.laws.rounding import EPS
from engine.words.verdicts import Verdict

# Truncation error of the polynomials relative to the peak; most halvings of a piece, and most halvings next to an
# extreme.
_TOLERANCE, _HALVINGS, _MOST_HALVINGS = 1e-12, 10, 20
# Most panels halved at once, in addition to two for each piece: more are due to rounding, not to peaks or kinks.
_CROWD = 64
# Values that differ by fewer rounding units of the peak are equal.
_EQUAL = 16
# How far a polynomial may exceed its samples, relative to their range.
_BEYOND = 0.25


class Sought(NamedTuple):
    """Maximum of sign × quantity over the turn: in rises (1), returns (−1) or everywhere (0)."""

    quantity: str
    sign: int
    direction: int = 0


class PeakPlaces(NamedTuple):
    """Positions of extremes (sought, variants): piece and local variable u, NaN if there is none.

    `blurs` times the square root of a value's error estimate is the error estimate of its position [rad]. The true
    extremes exceed the values there by up to `missed`.
    """

    pieces: np.ndarray
    u: np.ndarray
    blurs: np.ndarray
    missed: np.ndarray


class Measures(NamedTuple):
    """Extremes over the turn of some variants: positions, verdicts, integrals of the torque.

    `moment` is the mean torque, `moment_size` the mean of its magnitude and `moment_missed` the truncation error
    (variants,).
    """

    places: PeakPlaces
    verdicts: np.ndarray
    moment: np.ndarray
    moment_size: np.ndarray
    moment_missed: np.ndarray


class _Panels(NamedTuple):
    """Panels: piece, variant and both ends (panels,); samples of the quantities (quantities, panels, PLACES)."""

    p: np.ndarray
    v: np.ndarray
    left: np.ndarray
    right: np.ndarray
    values: np.ndarray

    def of(self, some: np.ndarray) -> "_Panels":
        return _Panels(*(part[some] for part in self[:-1]), self.values[:, some])


@np.errstate(all="ignore")
def measure(cams: CamVariants, sought: Sequence[Sought]) -> Measures:
    """Find the extremes over the turn."""
    turn, variants = cams.turn, cams.lowest.size
    stands = turn.whole & (cams.lowest > 0.0) & (cams.lowest < np.inf)
    verdicts = np.where(stands, Verdict.OK, np.where(turn.whole, Verdict.CANNOT_ASSEMBLE, Verdict.OUTSIDE_LIMITS))
    dynamic = any(s.quantity == "moment" for s in sought)
    names = list(dict.fromkeys(s.quantity for s in sought))
    p, v = (part[:, stands].ravel() for part in np.indices(turn.before.shape))
    left, right = turn.first[p], turn.last[p]
    taken, best = [], np.full((2, variants, len(names)), -np.inf)
    for halved in range(_MOST_HALVINGS + 1):
        u = 0.5 * (left + right)[:, None] + 0.5 * (right - left)[:, None] * PLACES
        found = at_positions(cams, p[:, None], v[:, None], u)
        for failed, verdict in (
            (dynamic and np.isinf(found["force"]).any(axis=1), Verdict.JAMS),
            (~found["reached"].all(axis=1), Verdict.CANNOT_ASSEMBLE),
        ):
            verdicts[v[failed]] = verdict
        panels = _Panels(p, v, left, right, np.array([found[name] for name in names]))
        both = np.array([panels.values.max(axis=-1).T, -panels.values.min(axis=-1).T])
        for most, here in zip(best, both, strict=True):
            np.maximum.at(most, v, here)
        scale = np.abs(best).max(axis=0)
        matters = (both >= best[:, v]).any(axis=0) | (halved < _HALVINGS)
        rough = (matters & (_TOLERANCE * scale[v] < tails(panels.values).T)).any(axis=1)
        rough &= (verdicts[v] == Verdict.OK) & (halved < _MOST_HALVINGS)
        rough &= np.bincount(v[rough], minlength=variants)[v] <= _CROWD + 2 * turn.first.size
        taken.append(panels.of(~rough))
        cut = np.zeros(rough.sum())
        for kink in found["kinks"]:
            cut = np.where(cut == 0.0, root_inside(kink[rough]), cut)
        p, v, left, right, cut = (np.concatenate([part] * 2) for part in (*(x[rough] for x in panels[:-1]), cut))
        middle = 0.5 * (left + right) + 0.5 * (right - left) * cut
        half = np.arange(p.size) < p.size // 2
        left, right = np.where(half, left, middle), np.where(half, middle, right)
        if not p.size:
            break
    panels = _Panels(*(np.concatenate(parts, axis=-1 - (k == 4)) for k, parts in enumerate(zip(*taken, strict=True))))
    places = [_greatest(cams, panels, s, (names.index(s.quantity), scale[:, names.index(s.quantity)])) for s in sought]
    moment = np.zeros((3, variants))
    if dynamic:
        samples = panels.values[names.index("moment")]
        rates = 0.5 * (panels.right - panels.left) * turn.angle[panels.p, panels.v] / math.tau
        parts = panel_integrals(samples), panel_integrals(np.abs(samples)), tails(samples)
        for row, part in zip(moment, parts, strict=True):
            np.add.at(row, panels.v, rates * part)
    return Measures(PeakPlaces(*map(np.array, zip(*places, strict=True))), verdicts.astype(np.uint8), *moment)


def _greatest(
    cams: CamVariants, panels: _Panels, s: Sought, which: tuple[int, np.ndarray]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Piece, u, blur and missed of an extreme (variants,); the first over the turn if several are equal."""
    quantity, scale = which
    directions = cams.turn.directions[panels.p]
    some = np.flatnonzero((directions == s.direction) | (s.direction == 0))
    p, v, left, right = (part[some] for part in panels[:-1])
    values = s.sign * panels.values[quantity, some]
    high = values.max(axis=1)
    best = np.full(scale.size, -np.inf)
    np.maximum.at(best, v, high)
    near = ~(high + _BEYOND * (high - values.min(axis=1)) < best[v]) & ~np.isnan(high)
    p, v, left, right = (part[near] for part in (p, v, left, right))
    equal = _EQUAL * EPS * np.where(np.isfinite(scale), scale, 0.0)
    noise = equal[v]
    found = tops(values[near], noise)
    # Near a jump the polynomial overshoots.
    rough, high = tails(values[near]) > _TOLERANCE * scale[v], values[near].argmax(axis=1)
    sampled = Tops(values[near].max(axis=1), PLACES[high], found.bends)
    found = Tops(*(np.where(rough, one, other) for one, other in zip(sampled, found, strict=True)))
    np.maximum.at(best, v, found.values)
    u = 0.5 * (left + right) + 0.5 * (right - left) * found.places
    order = np.lexsort((cams.turn.cam_angle(p, v, u), found.values < best[v] - noise, v))
    variants, first = np.unique(v[order], return_index=True)
    k = order[first]
    angles = cams.turn.angle[p, v] * 0.5 * (right - left)
    blurs = angles * np.sqrt(2.0 / found.bends)
    pieces, places, blur = np.zeros(scale.size, int), *np.full((2, scale.size), np.nan)
    pieces[variants], places[variants], blur[variants] = p[k], u[k], blurs[k]
    # A sample may be taken for its peak, and a peak for a higher one.
    return pieces, places, blur, 2.0 * equal
