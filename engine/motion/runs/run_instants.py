"""Fields of runs at requested instants or angles, each interpolated within a recorded step."""

from collections.abc import Iterable

import numpy as np

from engine.cycle.regula_falsi import regula_falsi
from engine.motion.quantities import TURNED
from engine.motion.runs.run_progress import RunOutcome
from engine.motion.runs.watching import Piece, RunFields
from engine.stepping.records import elements_of_counts
from engine.words.verdicts import Verdict

# Relative rounding of sums of steps, by which a run may end before an instant at its very end.
ROUNDED = 1e-13
# Fields that vanish at rest (and powers); the forces that hold the machine are unknown.
AT_REST = ("speed", "acceleration", "kinetic_energy")


class RunInstants:
    """Fields of runs at requested instants or angles.

    An angle counts when it is first passed. At a jump the value is the one after it, at the end of a run before it.

    Parameters
    ----------
    fields : RunFields
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

    def __init__(self, fields: RunFields, names: Iterable[str], asked: np.ndarray, over_time: bool) -> None:
        count = fields.variants.count
        self.fields, self.over_time = fields, over_time
        self.asked = np.broadcast_to(asked.T, (count, len(asked))).T
        self.rows = {name: np.full((count, len(asked)), np.nan) for name in names}
        # Number of instants already evaluated; time, angle turned, speed and torque at the end of the last piece.
        self._met, self._last = np.zeros(count, int), np.zeros((4, count))

    def see(self, who: np.ndarray, piece: Piece) -> None:
        """Evaluate a piece of the motion of the variants `who`."""
        if self.over_time:
            self._stand(who, piece.time[0])
            upto = self._count(who, piece.time[-1])
        else:
            # Only forward motion reaches new angles.
            upto = np.where(piece.facing > 0.0, self._count(who, piece.turned[-1]), 0)
        columns, instants = _pairs(self._met[who], upto)
        if columns.size:
            self._keep(who, piece, columns, instants)
        self._met[who] = np.maximum(self._met[who], upto)
        self._last[:, who] = [row[-1] for row in (piece.time, piece.turned, piece.omega, piece.moment)]

    def finish(self, outcome: RunOutcome) -> None:
        """Evaluate instants after the last piece.

        Machines may remain at rest until the time is over; the last piece ends before a jump at the end of the run.
        """
        if self.over_time:
            still = np.flatnonzero((outcome.verdict == Verdict.OK) & (outcome.state.omega == 0.0))
            self._stand(still, outcome.state.time[still], past=True)
            return
        every = np.arange(self._met.size)
        columns, instants = _pairs(self._met, self._count(every, outcome.state.turned))
        if columns.size:
            self._evaluate(columns, instants, self._last[:, columns], np.ones(columns.size))

    def _count(self, who: np.ndarray, upto: np.ndarray) -> np.ndarray:
        """Number of requested instants of variants up to one of each."""
        return (self.asked[:, who] <= upto * (1.0 + ROUNDED)).sum(axis=0)

    def _keep(self, who: np.ndarray, piece: Piece, columns: np.ndarray, instants: np.ndarray) -> None:
        asked, along = self.asked[instants, who[columns]], piece.time if self.over_time else piece.turned
        passed = along[:, columns] <= asked * (1.0 + ROUNDED)
        nodes = np.maximum(passed.sum(axis=0) - 1, 0)
        here = np.array([row[nodes, columns] for row in (piece.time, piece.turned, piece.omega, piece.moment)])
        lengths = self._lengths(piece, columns, nodes, asked)
        ahead = np.flatnonzero(lengths > 0.0)
        if ahead.size:
            here[:, ahead] = piece.within.step(columns[ahead], nodes[ahead], lengths[ahead])
        here[0 if self.over_time else 1] = asked
        found = self._evaluate(who[columns], instants, here, piece.facing[columns])
        way = self.fields.variants.direction[who[columns]] * piece.facing[columns]
        # Resistances do not accelerate a machine that is at rest at the start of its run.
        stands = (here[2] == 0.0) & (way * found["acceleration"][0] <= 0.0) if piece.within is None else None
        if stands is not None and stands.any():
            self._rest(who[columns[stands]], instants[stands], here[1][stands])

    def _evaluate(
        self, who: np.ndarray, instants: np.ndarray, here: np.ndarray, facing: np.ndarray
    ) -> dict[str, np.ndarray]:
        """Store (pairs,) the fields of variants in states (4, pairs): time, angle turned, speed and torque."""
        *states, moment = here[:, None]
        found = self.fields(who, Piece(*states, facing, np.empty((0, who.size)), moment))
        for name, rows in self.rows.items():
            rows[who, instants] = found[name][0]
        return found

    def _lengths(self, piece: Piece, columns: np.ndarray, nodes: np.ndarray, asked: np.ndarray) -> np.ndarray:
        """Length of the step from a node to the requested place (pairs,); 0 at the node."""
        if piece.within is None:
            return np.zeros(asked.size)
        here = (piece.time if self.over_time else piece.turned)[nodes, columns]
        if piece.within.in_time == self.over_time:
            return np.maximum(asked - here, 0.0)
        # The independent variable of the steps differs from the requested one.
        other = piece.turned if self.over_time else piece.time
        farthest = other[np.minimum(nodes + 1, len(other) - 1), columns] - other[nodes, columns]
        found, between = np.zeros(asked.size), np.flatnonzero((asked > here) & (farthest > 0.0))
        own, at, aim = columns[between], nodes[between], asked[between]

        def excess(length: np.ndarray) -> np.ndarray:
            there = piece.within.step(own, at, np.maximum(length, 0.0))
            return there[0 if self.over_time else 1] - aim

        found[between] = regula_falsi(excess, np.zeros(between.size), farthest[between])
        return found

    def _stand(self, who: np.ndarray, until: np.ndarray, past: bool = False) -> None:
        """Evaluate machines at rest from the end of their last piece to a time, inclusive if `past`."""
        upto = self._count(who, until) if past else (self.asked[:, who] < until).sum(axis=0)
        columns, instants = _pairs(self._met[who], upto)
        self._rest(who[columns], instants, self._last[1, who[columns]])
        self._met[who] = np.maximum(self._met[who], upto)

    def _rest(self, who: np.ndarray, instants: np.ndarray, turned: np.ndarray) -> None:
        """Store (pairs,) the fields of machines at rest."""
        for name, rows in self.rows.items():
            still = name in AT_REST or name.endswith("_power")
            rows[who, instants] = turned if name == TURNED else 0.0 if still else np.nan


def _pairs(first: np.ndarray, upto: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Indices of columns, and of the places first … upto − 1 of each, as pairs."""
    columns, within = elements_of_counts(np.maximum(upto - first, 0))
    return columns, first[columns] + within
