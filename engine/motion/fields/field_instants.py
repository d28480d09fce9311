"""Fields of runs at requested instants or angles, each interpolated within a recorded step."""

from collections.abc import Iterable

import numpy as np

from engine.cycle.regula_falsi import regula_falsi
from engine.motion.fields.motion_fields import MotionFields
from engine.motion.fields.recorded_motion import TIME, TURNED, RecordedMotion, Snapshots
from engine.motion.quantities import TURNED as ANGLE
from engine.stepping.recorded import weighted, weights_at
from engine.stepping.records import elements_of_counts, over_all, put, some

# Relative rounding of sums of steps, by which a run may end before an instant at its very end.
ROUNDED = 1e-13
# Fields that vanish at rest (and powers); the forces that hold the machine are unknown.
AT_REST = ("speed", "acceleration", "kinetic_energy")


class FieldInstants:
    """Fields of runs at requested instants or angles.

    An angle counts when it is first passed. At a jump the value is the one after it, at the end of a run before it.

    Parameters
    ----------
    fields : MotionFields
    names : iterable of str
        Names of fields.
    asked : ndarray (instants,) or (instants, variants)
        Times [s] or angles turned [rad], ascending.
    over_time : bool
        Whether these are times.

    Attributes
    ----------
    rows : dict of str to ndarray (variants, instants)
        By field; NaN where a run has not arrived.
    """

    def __init__(self, fields: MotionFields, names: Iterable[str], asked: np.ndarray, over_time: bool) -> None:
        count = fields.variants.count
        self.fields, self.over_time = fields, over_time
        self.asked = np.broadcast_to(asked.T, (count, len(asked))).T
        self.rows = {name: np.full((count, len(asked)), np.nan) for name in names}
        # Number of instants already evaluated; state at the end of the last step.
        self._met, self._last = np.zeros(count, int), None

    def see(self, motion: RecordedMotion) -> None:
        """Evaluate a part of the motion."""
        if not motion.who.size:
            return
        who, along = motion.who, motion.samples[TIME if self.over_time else TURNED]
        first = np.diff(who, prepend=-1) != 0
        last = np.append(first[1:], True)
        # Steps over the angle don't start at rest; those of a comparison run are shifted by their error estimates.
        if self.over_time and not motion.over_angle:
            self._stand(who[first], along[0, first])
        ends = np.split(along[-1], np.flatnonzero(first)[1:])
        passed = [np.searchsorted(self.asked[:, v], own) for v, own in zip(who[first], ends, strict=True)]
        # Only forward motion reaches new angles; an instant at the end of a step belongs to the next one.
        upto = np.where(along[-1] > along[0], np.concatenate(passed), 0)
        most = len(self.asked) + 1
        ahead = most * (np.cumsum(first) - 1)
        upto = np.maximum.accumulate(ahead + np.maximum(upto, self._met[who])) - ahead
        columns, instants = _pairs(np.where(first, self._met[who], np.roll(upto, 1)), upto)
        if columns.size:
            self._keep(motion, columns, instants)
        self._met[who[last]] = upto[last]
        ends = motion.at(np.flatnonzero(last), np.ones((1, last.sum())))
        if self._last is None:
            self._last = over_all(ends, who[last], self._met.size)
        put(self._last, who[last], ends)

    def finish(self, goes_on: np.ndarray, turned: np.ndarray, omega: np.ndarray, time: np.ndarray) -> None:
        """Evaluate instants after the last step.

        Machines may remain at rest until the time is over; the last step ends before a jump at the end of the run.

        Parameters
        ----------
        goes_on : ndarray (variants,) of bool
            Whether a machine at rest stays there until its time is over.
        turned, omega, time : ndarray (variants,)
            At the end of the run.
        """
        if self.over_time:
            still = np.flatnonzero(goes_on & (omega == 0.0))
            self._stand(still, time[still], past=True)
        columns, instants = _pairs(self._met, self._count(time if self.over_time else turned))
        if columns.size:
            states = some(self._last, columns)
            found = self._evaluate(states._replace(who=columns), instants)
            # Resistances do not accelerate a machine that never sets off.
            stands = (states.omega[0] == 0.0) & (turned[columns] == 0.0)
            if stands.any():
                direction = self.fields.variants.direction[columns] * states.facing
                stands &= direction * found["acceleration"][0] <= 0.0
                self._rest(columns[stands], instants[stands], states.turned[0, stands])

    def _count(self, upto: np.ndarray) -> np.ndarray:
        """Number of requested instants of every variant up to one of each."""
        return (self.asked <= upto * (1.0 + ROUNDED)).sum(axis=0)

    def _keep(self, motion: RecordedMotion, columns: np.ndarray, instants: np.ndarray) -> None:
        row = TIME if self.over_time else TURNED
        samples, asked = motion.samples[row : row + 1, :, columns], self.asked[instants, motion.who[columns]]

        def excess(share: np.ndarray) -> np.ndarray:
            return weighted(weights_at(share[None]), samples)[0, 0] - asked

        first, last, zero = samples[0, 0], samples[0, -1], np.zeros(columns.size)
        linear = motion.over_angle and not self.over_time
        share = (asked - first) / (last - first) if linear else regula_falsi(excess, zero, zero + 1.0)
        share = np.where(asked <= first, zero, share)
        states = motion.at(columns, share[None])
        # Exactly where requested, except next to a jump.
        (states.time if self.over_time else states.turned)[0, share > 0.0] = asked[share > 0.0]
        self._evaluate(states, instants)

    def _evaluate(self, states: Snapshots, instants: np.ndarray) -> dict[str, np.ndarray]:
        """Store the fields at states (1, pairs)."""
        found = self.fields(states)
        for name, rows in self.rows.items():
            rows[states.who, instants] = found[name][0]
        return found

    def _stand(self, who: np.ndarray, until: np.ndarray, past: bool = False) -> None:
        """Evaluate machines at rest from the end of their last step to a time, inclusive if `past`."""
        asked = self.asked[:, who]
        upto = (asked <= until * (1.0 + ROUNDED) if past else asked < until).sum(axis=0)
        columns, instants = _pairs(self._met[who], upto)
        if columns.size:
            turned = np.zeros(columns.size) if self._last is None else self._last.turned[0, who[columns]]
            self._rest(who[columns], instants, turned)
        self._met[who] = np.maximum(self._met[who], upto)

    def _rest(self, who: np.ndarray, instants: np.ndarray, turned: np.ndarray) -> None:
        """Store (pairs,) the fields of machines at rest."""
        for name, rows in self.rows.items():
            still = name in AT_REST or name.endswith("_power")
            rows[who, instants] = turned if name == ANGLE else 0.0 if still else np.nan


def _pairs(first: np.ndarray, upto: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of indices: a column, and one of its instants first … upto − 1."""
    columns, within = elements_of_counts(np.maximum(upto - first, 0))
    return columns, first[columns] + within
