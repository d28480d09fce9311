"""Statistics of fields along recorded motion: extremes with position and instant, and means over time.

Each step is a panel, as those of a cycle, and is halved until the fields' Chebyshev series converge on it or only
rounding is left. What the series leave out gives the error estimates.

Source: L. N. Trefethen, Approximation Theory and Approximation Practice (2013), ch. 4, 8, 19.
"""

from collections.abc import Iterable

import numpy as np

from engine.cycle.panels.chebyshev import PLACES, POSITIONS
from engine.cycle.panels.sampled import panel_integrals, tails, tops
from engine.laws.rounding import EPS
from engine.motion.fields.field_instants import Fields
from engine.motion.fields.recorded_motion import RecordedMotion, Snapshots
from engine.motion.quantities import Asked, FieldAnswers

# Halvings of a step. Left coefficients that a halving doesn't reduce to this fraction are rounding, or of a jump.
HALVINGS, GAINS = 6, 0.75
# Bound of what a series leaves out, relative to its last coefficients: where it converges, and at a kink, where
# coefficients fall as 1/k².
CONVERGING, AT_A_KINK = 2.0, float(POSITIONS)
# A series exceeds its samples by at most this fraction of their range: half the excess over 1 of the Lebesgue constant
# of 17 Chebyshev points, 2.40.
EXCEEDS = 0.71
_SHARES = 0.5 + 0.5 * PLACES[:, None]
# Rows of a candidate for an extreme.
_VALUE, _BOUND, _TURNED, _TIME, _TURNED_OFF, _TIME_OFF = range(6)


class FieldStatistics:
    """Extremes of fields along recorded motion, and their means over time.

    Parameters
    ----------
    fields : Fields
    names : iterable of str
        Names of fields.
    tolerance : float
        Left coefficients that are small enough, relative to the greatest magnitude of a field.
    averaged : bool
        Whether means are requested.
    """

    def __init__(self, fields: Fields, names: Iterable[str], tolerance: float, averaged: bool = False) -> None:
        self.fields, self.names, self._averaged = fields, tuple(dict.fromkeys(names)), averaged
        self._tolerance, count = tolerance, fields.variants.count
        self._size, self._lost = np.zeros((len(self.names), count)), np.zeros((len(self.names), count), bool)
        # Candidates for −minimum and maximum of each field: their variants and their rows.
        self._tops = [[(np.zeros(0, int), np.zeros((6, 0))) for _ in range(2)] for _ in self.names]
        # ∫f dt and ∫f² dt, and what the series leave out of both.
        self._sums, self._time = np.zeros((len(self.names), 4, count)), np.zeros(count)

    def see(self, motion: RecordedMotion) -> None:
        """Evaluate a part of the motion."""
        step, low, high = np.arange(motion.who.size), np.zeros(motion.who.size), np.ones(motion.who.size)
        before = np.full((len(self.names), step.size), np.inf)
        for halvings in range(HALVINGS, -1, -1):
            if not step.size:
                break
            states = motion.at(step, low + (high - low) * _SHARES)
            rows = self.fields(states)
            curves = np.array([rows[name].T for name in self.names])
            for size, curve in zip(self._size, curves, strict=True):
                np.fmax.at(size, states.who, np.abs(curve).max(axis=1))
            left = np.where(np.isfinite(curves).all(axis=2), tails(curves), 0.0)
            rough = left > self._tolerance * self._size[:, states.who]
            divided = (rough & (left <= GAINS * before)).any(axis=0) & (halvings > 0)
            self._take(
                motion, states, (step, low, high), curves, np.where(rough, AT_A_KINK, CONVERGING) * left, ~divided
            )
            step, low, high = (np.repeat(row[divided], 2) for row in (step, low, high))
            before, middle = np.repeat(left[:, divided], 2, axis=1), 0.5 * (low + high)
            high[::2], low[1::2] = middle[::2], middle[1::2]

    def _take(
        self,
        motion: RecordedMotion,
        states: Snapshots,
        panels: tuple[np.ndarray, np.ndarray, np.ndarray],
        curves: np.ndarray,
        left: np.ndarray,
        kept: np.ndarray,
    ) -> None:
        """Count the panels `kept`: parts low … high of steps."""
        step, low, high = (row[kept] for row in panels)
        who = states.who[kept]
        if self._averaged:
            pace = motion.durations(panels[0], states)[:, kept].T * (0.5 * (high - low))[:, None]
            np.add.at(self._time, who, panel_integrals(pace))
        for i, (curve, off) in enumerate(zip(curves[:, kept], left[:, kept], strict=True)):
            np.logical_or.at(self._lost[i], who, ~np.isfinite(curve).all(axis=1))
            if self._averaged:
                first, second = curve * pace, curve * curve * pace
                missed = 2.0 * pace.max(axis=1) * off
                parts = (
                    panel_integrals(first),
                    panel_integrals(second),
                    missed,
                    2.0 * missed * np.abs(curve).max(axis=1),
                )
                for total, part in zip(self._sums[i], parts, strict=True):
                    np.add.at(total, who, part)
            for side, sign in enumerate((-1.0, 1.0)):
                self._keep_tops(i, side, motion, (step, low, high), who, sign * curve, off)

    def _keep_tops(
        self,
        i: int,
        side: int,
        motion: RecordedMotion,
        panels: tuple[np.ndarray, np.ndarray, np.ndarray],
        who: np.ndarray,
        curve: np.ndarray,
        left: np.ndarray,
    ) -> None:
        """Add the panels that may hold the maximum of a curve to the candidates, and drop those that no longer may."""
        known_who, known = self._tops[i][side]
        best, highest, lowest = np.full(len(self._time), -np.inf), curve.max(axis=1), curve.min(axis=1)
        np.fmax.at(best, known_who, known[_VALUE])
        np.fmax.at(best, who, highest)
        may = np.flatnonzero(highest + EXCEEDS * (highest - lowest) + left >= best[who])
        if not may.size:
            return
        step, low, high = (row[may] for row in panels)
        value, bound, x, apart = _peaks(curve[may], left[may], self._size[i, who[may]], self._tolerance)
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        share = np.clip(middle + half * np.array([x, x - apart, x + apart]), low, high)
        states = motion.at(step, share)
        spread = (np.abs(row[1:] - row[0]).max(axis=0) for row in (states.turned, states.time))
        new = np.array([value, bound, states.turned[0], states.time[0], *spread])
        every, rows = np.concatenate([known_who, who[may]]), np.concatenate([known, new], axis=1)
        np.fmax.at(best, who[may], value)
        kept = rows[_BOUND] >= best[every]
        self._tops[i][side] = every[kept], rows[:, kept]

    def answers(self, asked: Iterable[Asked]) -> FieldAnswers:
        """Requested statistics of all variants."""
        found, variants = FieldAnswers.none(), self.fields.variants
        known: dict[str, tuple[dict[str, np.ndarray], dict[str, np.ndarray]]] = {}
        for _, name, statistic in asked:
            if name not in known:
                known[name] = self._of(self.names.index(name), variants.count)
            values, missed = known[name]
            key = f"{name}.{statistic}"
            found.values[key], found.missed[key], found.scales[key] = (
                values[statistic],
                missed[statistic],
                values["peak"],
            )
        return found

    def _of(self, i: int, count: int) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        """Statistics of a field, and their error estimates."""
        most, beyond, values, missed = np.empty((2, count)), np.empty((2, count)), {}, {}
        with np.errstate(invalid="ignore"):
            for side, end in enumerate(("min", "max")):
                best = np.where(self._lost[i], np.nan, _highest(*self._tops[i][side], count))
                most[side], beyond[side] = best[_VALUE], best[_BOUND] - best[_VALUE]
                for key, row, off in (("at", _TURNED, _TURNED_OFF), ("time", _TIME, _TIME_OFF)):
                    values[f"{end}_{key}"], missed[f"{end}_{key}"] = best[row], best[off]
                values[f"{end}_at"] = self.fields.place(best[_TURNED])
            (low, high), (below, above) = most * [[-1.0], [1.0]], beyond
            peak = np.abs(most).max(axis=0)
            values |= {"min": low, "max": high, "range": high - low, "amplitude": (high - low) / 2, "peak": peak}
            missed |= {"min": below, "max": above, "range": below + above, "amplitude": (below + above) / 2}
            missed["peak"] = (np.abs(most) + beyond).max(axis=0) - peak
            if self._averaged:
                total, squares, off, off_squares = np.where(self._lost[i], np.nan, self._sums[i]) / self._time
                rms = np.sqrt(np.maximum(squares, 0.0))
                values |= {"mean": total, "rms": rms}
                missed |= {"mean": off, "rms": np.where(rms > 0.0, 0.5 * off_squares / rms, 0.0)}
        return values, missed


def _peaks(
    curve: np.ndarray, left: np.ndarray, size: np.ndarray, tolerance: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Maxima of curves on panels, upper bounds of both, their positions on [−1, 1], and error estimates of these.

    A curve of one sign whose series doesn't converge is followed by its signed square where that of this does: the
    magnitude of a vector has a kink where it vanishes, its square doesn't.

    Parameters
    ----------
    curve : ndarray (panels, POSITIONS)
    left : ndarray (panels,)
        Bounds of what the series leave out.
    size : ndarray (panels,)
        Greatest magnitudes of the curves.
    tolerance : float
    """
    squares = curve * np.abs(curve)
    left_of_squares = CONVERGING * tails(squares)
    one_sign = (curve >= 0.0).all(axis=1) | (curve <= 0.0).all(axis=1)
    squared = (
        one_sign & (left_of_squares <= CONVERGING * tolerance * size * size) & (left > CONVERGING * tolerance * size)
    )
    followed = np.where(squared[:, None], squares, curve)
    left, size = np.where(squared, left_of_squares, left), np.where(squared, size * size, size)
    sampled, found = followed.max(axis=1), tops(followed, np.zeros(len(curve)))
    converges = squared | (left <= CONVERGING * tolerance * size)
    # At a kink the series may exceed the curve.
    value = np.where(converges, found.values, sampled)
    bound = found.values + left
    unsure = left + tolerance * size + 8.0 * EPS * size
    apart = np.where(found.bends < 0.0, np.sqrt(2.0 * unsure / -found.bends), 2.0)
    value, bound = (np.where(squared, np.sign(row) * np.sqrt(np.abs(row)), row) for row in (value, bound))
    return value, np.maximum(bound, value), found.places, np.minimum(apart, 2.0)


def _highest(who: np.ndarray, rows: np.ndarray, count: int) -> np.ndarray:
    """The highest candidate of each variant, the earliest of equal ones; NaN for a variant without any.

    Its bound is the highest of all, and its position is as uncertain as all that may be higher are apart.
    """
    found = np.full((6, count), np.nan)
    order = np.lexsort((rows[_TIME], -rows[_VALUE], who))
    first = order[np.flatnonzero(np.diff(who[order], prepend=-1))]
    found[:, who[first]] = rows[:, first]
    np.maximum.at(found[_BOUND], who, rows[_BOUND])
    rivals = rows[_BOUND] >= found[_VALUE, who]
    for row, off in ((_TURNED, _TURNED_OFF), (_TIME, _TIME_OFF)):
        distance = np.abs(rows[row] - found[row, who])
        np.maximum.at(found[off], who[rivals], (distance + rows[off])[rivals])
    return found
