"""Fields of runs at instants or at angles turned that are asked for, each met exactly by a step of the method."""

from collections.abc import Iterable

import numpy as np

from engine.cycle.regula_falsi import regula_falsi
from engine.motion.quantities import INSTANT, TURNED, KeptAt
from engine.motion.runs.run_progress import RunOutcome
from engine.motion.runs.watching import Piece, RunFields
from engine.words.verdicts import Verdict

# By this share a run may end before an instant at its very end: what sums of steps round.
ROUNDED = 1e-13
# While resistances hold a machine at rest it has no speed, energy or power, and what holds it isn't told apart.
AT_REST = ("speed", "acceleration", "kinetic_energy")


class RunInstants:
    """Fields of runs at asked instants or angles.

    An angle counts where it is passed for the first time. On a jump the value is that after it.

    Parameters
    ----------
    fields : RunFields
    names : iterable of str
        Of fields.
    at : KeptAt

    Attributes
    ----------
    rows : dict of str to ndarray (variants, instants)
        By field; NaN where a run hasn't come to.
    """

    def __init__(self, fields: RunFields, names: Iterable[str], at: KeptAt) -> None:
        self.fields, self.asked = fields, at.values
        self.over_time = at.quantity.name.endswith(f".{INSTANT}")
        count = fields.variants.count
        self.rows = {name: np.full((count, self.asked.size), np.nan) for name in names}
        # How many are met already, and the angle turned where each variant was seen last.
        self._met, self._turned = np.zeros(count, int), np.zeros(count)

    def see(self, who: np.ndarray, piece: Piece) -> None:
        """Look at a piece of the way of the variants `who`."""
        if self.over_time:
            self._stand(who, piece.time[0])
            upto = self._count(piece.time[-1])
        else:
            # Only forward does a machine come where it hasn't been.
            upto = np.where(piece.facing > 0.0, self._count(piece.turned[-1]), 0)
        columns, instants = _pairs(self._met[who], upto)
        if columns.size:
            self._keep(who, piece, columns, instants)
        self._met[who] = np.maximum(self._met[who], upto)
        self._turned[who] = piece.turned[-1]

    def finish(self, outcome: RunOutcome) -> None:
        """Take in what comes after the last piece: machines that stand until the time is over."""
        if self.over_time:
            still = np.flatnonzero((outcome.verdict == Verdict.OK) & (outcome.state.omega == 0.0))
            self._stand(still, outcome.state.time[still], past=True)

    def _count(self, upto: np.ndarray) -> np.ndarray:
        """How many of the asked places come no later."""
        return np.searchsorted(self.asked, upto * (1.0 + ROUNDED), side="right")

    def _keep(self, who: np.ndarray, piece: Piece, columns: np.ndarray, instants: np.ndarray) -> None:
        asked, along = self.asked[instants], piece.time if self.over_time else piece.turned
        passed = along[:, columns] <= asked * (1.0 + ROUNDED)
        nodes = np.maximum(passed.sum(axis=0) - 1, 0)
        here = [row[nodes, columns] for row in (piece.time, piece.turned, piece.omega, piece.moment)]
        lengths = self._lengths(piece, columns, nodes, asked)
        ahead = np.flatnonzero(lengths > 0.0)
        if ahead.size:
            there = piece.within.step(columns[ahead], nodes[ahead], lengths[ahead])
            for row, values in zip(here, there, strict=True):
                row[ahead] = values
        here[0 if self.over_time else 1] = asked
        time, turned, omega, moment = (row[None] for row in here)
        found = self.fields(
            who[columns], Piece(time, turned, omega, piece.facing[columns], np.empty((0, asked.size)), moment)
        )
        way = self.fields.variants.direction[who[columns]] * piece.facing[columns]
        # What resists doesn't push a machine that stands where its run begins.
        stands = (here[2] == 0.0) & (way * found["acceleration"][0] <= 0.0) if piece.within is None else None
        for name, rows in self.rows.items():
            rows[who[columns], instants] = found[name][0]
        if stands is not None and stands.any():
            self._rest(who[columns[stands]], instants[stands], here[1][stands])

    def _lengths(self, piece: Piece, columns: np.ndarray, nodes: np.ndarray, asked: np.ndarray) -> np.ndarray:
        """How long the step from a node is to the asked place (pairs,); 0 where it is the node."""
        if piece.within is None:
            return np.zeros(asked.size)
        here = (piece.time if self.over_time else piece.turned)[nodes, columns]
        if piece.within.in_time == self.over_time:
            return np.maximum(asked - here, 0.0)
        # Steps go in what isn't asked for.
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
        """Machines that stood from where they were seen last until a time, to which `past` says that they come."""
        upto = self._count(until) if past else np.searchsorted(self.asked, until, side="left")
        columns, instants = _pairs(self._met[who], upto)
        self._rest(who[columns], instants, self._turned[who[columns]])
        self._met[who] = np.maximum(self._met[who], upto)

    def _rest(self, who: np.ndarray, instants: np.ndarray, turned: np.ndarray) -> None:
        """Write down (pairs,) that machines stand."""
        for name, rows in self.rows.items():
            still = name in AT_REST or name.endswith("_power")
            rows[who, instants] = turned if name == TURNED else 0.0 if still else np.nan


def _pairs(first: np.ndarray, upto: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of columns, and of the places first … upto − 1 of each, as pairs."""
    counts = np.maximum(upto - first, 0)
    columns = np.repeat(np.arange(counts.size), counts)
    within = np.arange(columns.size) - np.repeat(np.cumsum(counts) - counts, counts)
    return columns, first[columns] + within
