"""Statistics of fields along recorded motion: extremes with position and instant, and means over time.

Each step is a panel, as those of a cycle, and is halved until the fields' Chebyshev series converge on it or only
rounding is left. What the series leave out gives the error estimates.

Source: L. N. Trefethen, Approximation Theory and Approximation Practice (2013), ch. 4, 8, 19.
"""

from collections.abc import Collection, Iterable
from typing import NamedTuple

import numpy as np

from engine.cycle.panels.chebyshev import COARSE, DEGREE, PLACES
from engine.cycle.panels.sampled import finer, last_coefficients, panel_integrals, tails, tops
from engine.laws.rounding import EPS
from engine.motion.fields.motion_fields import MotionFields
from engine.motion.fields.recorded_motion import TURNED, RecordedMotion
from engine.motion.moments.breaks import JUMP
from engine.motion.quantities import Asked, FieldAnswers
from engine.stepping.records import on_arrays, over_all, some

# Maximum halvings of a step. A step is halved only if doubling its positions reduced the left coefficients to this
# fraction: neither reduces those that are rounding or due to a jump.
HALVINGS, REDUCED = 6, 0.5
# Limits of the sum of all coefficients left out, relative to the last ones: of a smooth curve, whose coefficients fall
# at least as k⁻⁶; and of one with a kink, relative to n of them, which fall as k⁻² and may by chance be small.
LEAST_LEFT, MOST_LEFT, SMOOTH = 2.0, 4.0, 6.0
# Last coefficient of a smooth curve as a fraction of the two before it.
FALLING = 0.25
# Rounding of values at one position, relative to the peak of a field.
ROUNDED = 16.0 * EPS
# Tolerance from which half as many positions are tried first.
COARSELY = 1e-8
# A series exceeds its samples by at most this fraction of their range: half the excess over 1 of the Lebesgue constant
# of 17 Chebyshev points, 2.40.
EXCEEDS = 0.71
MEANS = ("mean", "rms")
# Differences of both extremes, as shares of the range.
RANGES = {"range": 1.0, "amplitude": 0.5}
_SHARES, _FIRST_INTERVAL = 0.5 + 0.5 * PLACES[:, None], PLACES[1] - PLACES[0]


class _Panels(NamedTuple):
    """Parts of steps, (panels,) each, with fields there.

    Attributes
    ----------
    step : ndarray of int
    low, high : ndarray
        Ends of the part, as fractions of the step.
    who : ndarray of int
        Variants.
    pace : ndarray (POSITIONS, panels)
        Time per unit of the position on [−1, 1] [s].
    curves : ndarray (fields, POSITIONS, panels)
    left : ndarray (fields, panels)
        Bounds of the sums of all coefficients left out.
    known : ndarray of bool
        Whether the fields were evaluated at all positions, not at half of them.
    """

    step: np.ndarray
    low: np.ndarray
    high: np.ndarray
    who: np.ndarray
    pace: np.ndarray
    curves: np.ndarray
    left: np.ndarray
    known: np.ndarray


class _Tops(NamedTuple):
    """Candidates for extremes, (candidates,) each.

    Attributes
    ----------
    owner : ndarray of int
        Number of the extreme: of a side, −minimum or maximum, of a field and of a variant.
    value, bound, off : ndarray
        Peak, upper bound of the values nearby, and error estimate of the peak.
    turned, turned_off : ndarray
        Angle turned there, and its error estimate [rad].
    time, time_off : ndarray
        Time from the start of the run, and its error estimate [s].
    """

    owner: np.ndarray
    value: np.ndarray
    bound: np.ndarray
    off: np.ndarray
    turned: np.ndarray
    turned_off: np.ndarray
    time: np.ndarray
    time_off: np.ndarray


class FieldStatistics:
    """Extremes of fields along recorded motion, and their means over time.

    Parameters
    ----------
    fields : MotionFields
    names : iterable of str
        Names of fields.
    tolerance : float
        Left coefficients that are small enough, relative to the peak of a field.
    averaged : collection of str
        Fields whose means are requested.
    """

    def __init__(
        self, fields: MotionFields, names: Iterable[str], tolerance: float, averaged: Collection[str] = ()
    ) -> None:
        self.fields, self.names = fields, tuple(dict.fromkeys(names))
        self._averaged = np.array([name in averaged for name in self.names], bool)[:, None]
        self._tolerance, shape = tolerance, (len(self.names), fields.variants.count)
        self._size, self._lost = np.zeros(shape), np.zeros(shape, bool)
        self._best, self._tops = np.full(2 * self._size.size, -np.inf), _Tops(np.zeros(0, int), *np.zeros((7, 0)))
        # ∫f dt and ∫f² dt, and error estimates of both.
        self._sums, self._time = np.zeros((4, *shape)), np.zeros(shape[1])

    # A field may be infinite or NaN.
    @np.errstate(all="ignore")
    def see(self, motion: RecordedMotion) -> None:
        """Evaluate a part of the motion."""
        step, low, high, made = np.arange(motion.who.size), np.zeros(motion.who.size), np.ones(motion.who.size), []
        first = COARSE if self._tolerance >= COARSELY else DEGREE
        for degree in [first, *([DEGREE] if first == COARSE else ()), *[DEGREE] * HALVINGS]:
            if not step.size:
                break
            panels, rough = self._panels(motion, step, low, high, degree)
            divided = rough.any(axis=0) & (len(made) < HALVINGS + (first == COARSE))
            made.append(some(panels, ~divided))
            parts = 1 if degree == COARSE else 2
            step, low, high = (np.repeat(row[divided], parts) for row in (step, low, high))
            if parts == 2:
                middle = 0.5 * (low + high)
                high[::2], low[1::2] = middle[::2], middle[1::2]
        if made:
            self._take(motion, on_arrays(lambda *rows: np.concatenate(rows, axis=-1), *made))

    def _panels(
        self, motion: RecordedMotion, step: np.ndarray, low: np.ndarray, high: np.ndarray, degree: int
    ) -> tuple[_Panels, np.ndarray]:
        """Evaluate parts of steps, and whether more positions are worth while for fields, (fields, panels)."""
        states = motion.at(step, low + (high - low) * _SHARES[:: DEGREE // degree])
        who, rows = states.who, self.fields(states)
        curves = np.array([rows[name] for name in self.names])
        sampled = curves.swapaxes(1, 2)
        finite = np.isfinite(sampled).all(axis=2)
        for size, curve in zip(self._size, np.abs(sampled).max(axis=2), strict=True):
            np.fmax.at(size, who, curve)
        left, reduces = _left_out(np.where(finite[..., None], sampled, 0.0), degree)
        rough = (reduces | (degree == COARSE)) & (left > self._tolerance * self._size[:, who])
        rough &= self._averaged | self._may_hold(sampled, who, left).any(axis=0)
        pace = 0.5 * (high - low) * motion.durations(step, states)
        if degree == COARSE:
            # The square of a polynomial through so few positions converges whether or not that of the field does.
            curves, pace = (np.moveaxis(finer(np.moveaxis(row, -2, -1)), -1, -2) for row in (curves, pace))
        else:
            field, panel = np.nonzero(rough & ~self._averaged)
            squared, _, left_of_squares = _squared(sampled[field, panel], left[field, panel])
            enough = np.sqrt(left_of_squares) <= self._tolerance * self._size[field, who[panel]]
            rough[field, panel] = ~(squared & enough)
        return _Panels(step, low, high, who, pace, curves, left, np.full(step.size, degree == DEGREE)), rough

    def _take(self, motion: RecordedMotion, panels: _Panels) -> None:
        """Count all panels of a part of the motion."""
        curves, who, pace = panels.curves.swapaxes(1, 2), panels.who, panels.pace.T
        for lost, curve in zip(self._lost, curves, strict=True):
            np.logical_or.at(lost, who, ~np.isfinite(curve).all(axis=1))
        np.add.at(self._time, who, panel_integrals(pace))
        for i in np.flatnonzero(self._averaged):
            first, missed = curves[i] * pace, 2.0 * pace.max(axis=1) * panels.left[i]
            parts = panel_integrals(first), panel_integrals(curves[i] * first)
            for total, part in zip(
                self._sums[:, i], (*parts, missed, 2.0 * missed * np.abs(curves[i]).max(axis=1)), strict=True
            ):
                np.add.at(total, who, part)
        self._find_tops(motion, panels, curves)

    def _owners(self, who: np.ndarray) -> np.ndarray:
        """Numbers of the extremes of variants, (2, fields, …)."""
        fields, count = self._size.shape
        return count * np.arange(2 * fields).reshape(2, fields, 1) + who

    def _may_hold(self, curves: np.ndarray, who: np.ndarray, left: np.ndarray) -> np.ndarray:
        """Which panels may hold −minimum and maximum of fields, (2, fields, panels).

        Parameters
        ----------
        curves : ndarray (fields, panels, POSITIONS)
        who : ndarray (panels,) of int
        left : ndarray (fields, panels)
        """
        high, low, owner = curves.max(axis=2), curves.min(axis=2), self._owners(who)
        highest = np.array([-low, high])
        np.fmax.at(self._best, owner.ravel(), highest.ravel())
        return highest + EXCEEDS * (high - low) + left + ROUNDED * self._size[:, who] >= self._best[owner]

    def _find_tops(self, motion: RecordedMotion, panels: _Panels, curves: np.ndarray) -> None:
        """Add the panels that may hold an extreme to the candidates, and drop those that no longer may."""
        may, signs = self._may_hold(curves, panels.who, panels.left), np.array([-1.0, 1.0])
        side, field, panel = np.nonzero(may)
        owner = self._owners(panels.who)[may]
        curve = signs[side, None] * curves[field, panel]
        size, left = self._size[field, panels.who[panel]], panels.left[field, panel]
        peaks = _peaks(curve, left, panels.known[panel], size, self._tolerance)
        low, high = panels.low[panel], panels.high[panel]
        # Ends at jumps are evaluated a little inside the step.
        reach = np.abs(np.diff(motion.samples[TURNED][[0, -1]], axis=0)[0, panels.step[panel]]) * (high - low)
        ends = np.where(peaks.place < 0.0, curve[:, 1] - curve[:, 0], curve[:, -1] - curve[:, -2])
        slope = np.where((np.abs(peaks.place) == 1.0) & (reach > 0.0), ends / (0.5 * reach * _FIRST_INTERVAL), 0.0)
        inside = JUMP * np.abs(slope)
        x = peaks.place + np.array([[0.0], [-1.0], [1.0]]) * peaks.apart
        states = motion.at(panels.step[panel], low + (high - low) * (0.5 + 0.5 * np.clip(x, -1.0, 1.0)))
        spread = [np.abs(row[1:] - row[0]).max(axis=0) for row in (states.turned, states.time)]
        bound, off = peaks.bound + inside, peaks.off + inside
        found = peaks.value, bound, off, states.turned[0], spread[0], states.time[0], spread[1]
        np.fmax.at(self._best, owner, peaks.value)
        every = _Tops(*(np.concatenate(rows) for rows in zip(self._tops, (owner, *found), strict=True)))
        self._tops = some(every, every.bound >= self._best[every.owner])

    def answers(self, asked: Iterable[Asked], compared: "FieldStatistics | None" = None) -> FieldAnswers:
        """Requested statistics of all variants.

        For a motion shifted by error estimates, ranges differ from those `compared` by the changes of both extremes:
        all shifts have one sign, but errors need not.
        """
        found, variants = FieldAnswers.none(), self.fields.variants
        known: dict[str, tuple[dict[str, np.ndarray], dict[str, np.ndarray]]] = {}
        for _, name, statistic in asked:
            if name not in known:
                known[name] = self._of(self.names.index(name), variants.count)
            values, missed = known[name]
            if compared is not None and statistic in RANGES:
                others, _ = compared._of(self.names.index(name), variants.count)
                apart = sum(np.abs(values[end] - others[end]) for end in ("min", "max"))
                values = values | {key: others[key] + share * apart for key, share in RANGES.items()}
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
                best = self._extremes(side, i)
                most[side], beyond[side] = best.value, best.off
                values |= {f"{end}_at": self.fields.place(best.turned), f"{end}_time": best.time}
                missed |= {f"{end}_at": best.turned_off, f"{end}_time": best.time_off}
            (low, high), (below, above) = most * [[-1.0], [1.0]], beyond
            peak = np.abs(most).max(axis=0)
            values |= {"min": low, "max": high, "range": high - low, "amplitude": (high - low) / 2, "peak": peak}
            missed |= {"min": below, "max": above, "range": below + above, "amplitude": (below + above) / 2}
            missed["peak"] = (np.abs(most) + beyond).max(axis=0) - peak
            if self._averaged[i]:
                total, squares, off, off_squares = np.where(self._lost[i], np.nan, self._sums[:, i]) / self._time
                rms = np.sqrt(np.maximum(squares, 0.0))
                values |= {"mean": total, "rms": rms}
                missed |= {"mean": off, "rms": np.where(rms > 0.0, 0.5 * off_squares / rms, 0.0)}
        return values, missed

    def _extremes(self, side: int, i: int) -> _Tops:
        """−Minima or maxima of a field, (variants,): the highest candidates, the earliest of equal ones.

        Their errors cover all candidates that may be higher, and the distance to them. NaN for a variant without any.
        """
        count = self._size.shape[1]
        first = (side * len(self.names) + i) * count
        tops = some(self._tops, (self._tops.owner >= first) & (self._tops.owner < first + count))
        who = tops.owner - first
        order = np.lexsort((tops.time, -tops.value, who))
        order = order[np.flatnonzero(np.diff(who[order], prepend=-1))]
        found = over_all(some(tops, order), who[order], count)
        np.maximum.at(found.bound, who, tops.bound)
        np.maximum.at(found.off, who, tops.bound - found.value[who])
        turned = np.abs(tops.turned - found.turned[who])
        if np.isfinite(self.fields.cycle):
            turned = np.abs(turned - self.fields.cycle * np.round(turned / self.fields.cycle))
        np.maximum.at(found.turned_off, who, turned + tops.turned_off)
        np.maximum.at(found.time_off, who, np.abs(tops.time - found.time[who]) + tops.time_off)
        return on_arrays(lambda row: np.where(self._lost[i], np.nan, row), found)


class _Peaks(NamedTuple):
    """Maxima of curves on panels, (panels,): values, upper bounds, errors; positions on [−1, 1] and their errors."""

    value: np.ndarray
    bound: np.ndarray
    off: np.ndarray
    place: np.ndarray
    apart: np.ndarray


def _left_out(values: np.ndarray, degree: int = DEGREE) -> tuple[np.ndarray, np.ndarray]:
    """Bounds of the sums of all coefficients that series leave out, and whether more positions would reduce them, (…).

    Coefficients that fall as k⁻ᵖ leave out n/(p − 1) times the last ones; half as many positions give p.

    Parameters
    ----------
    values : ndarray (…, degree + 1)
    degree : int
    """
    *others, end = last_coefficients(values, degree)
    before = np.maximum(*others)
    last, coarse = np.maximum(before, end), tails(values[..., ::2], degree // 2)
    order = np.log2(coarse / last)
    # A kink close to an end of the panel leaves all coefficients equal, the very last half as large by its definition.
    smooth = (order > SMOOTH) & (end <= FALLING * before)
    share = np.where(smooth, np.maximum(degree / (order - 1.0), LEAST_LEFT), MOST_LEFT * degree)
    return np.where(last > 0.0, share * last, 0.0), last <= REDUCED * coarse


def _squared(curve: np.ndarray, left: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Which curves are represented by their signed squares, the squares, and bounds of the coefficients left out.

    These are curves of one sign that their squares represent more closely: the magnitude of a vector has a kink where
    it vanishes, its square doesn't.

    Parameters
    ----------
    curve : ndarray (panels, POSITIONS)
    left : ndarray (panels,)
        Bounds of the sums of all coefficients that the curves themselves leave out.
    """
    squares = curve * np.abs(curve)
    left_of_squares, _ = _left_out(squares)
    one_sign = (curve <= 0.0).all(axis=1) | (curve >= 0.0).all(axis=1)
    return one_sign & (np.sqrt(left_of_squares) < left), squares, left_of_squares


def _peaks(curve: np.ndarray, left: np.ndarray, known: np.ndarray, size: np.ndarray, tolerance: float) -> _Peaks:
    """Maxima of curves on panels.

    Parameters
    ----------
    curve : ndarray (panels, POSITIONS)
    left : ndarray (panels,)
        Bounds of the sums of all coefficients left out.
    known : ndarray (panels,) of bool
        As in `_Panels`; squares of series have no coefficients of their own.
    size : ndarray (panels,)
        Peaks of the fields.
    tolerance : float
    """
    rounding = ROUNDED * size
    squared, squares, left_of_squares = _squared(curve, left)
    squared &= known
    followed = np.where(squared[:, None], squares, curve)
    size = np.where(squared, size * size, size)
    # A small value is lost in the rounding of the squares' series.
    left = np.where(squared, left_of_squares + ROUNDED * size, left)
    found = tops(followed, ROUNDED * size)
    # At a kink the series may exceed the curve.
    top = np.where(squared | (left <= tolerance * size), found.values, followed.max(axis=1))
    top = np.where((curve <= 0.0).all(axis=1), np.minimum(top, 0.0), top)
    unsure = left + (tolerance + ROUNDED) * size
    apart = np.sqrt(2.0 * unsure / found.bends)
    limits = found.values + left, top, top - left
    bound, value, least = (np.where(squared, np.sign(row) * np.sqrt(np.abs(row)), row) for row in limits)
    bound = np.maximum(bound, value) + rounding
    return _Peaks(value, bound, np.maximum(bound - value, value - least), found.places, np.fmin(apart, 2.0))
