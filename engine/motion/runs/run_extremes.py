"""Extremes of fields in runs, with the position and the instant of each."""

from collections.abc import Iterable

import numpy as np

from engine.motion.moments.piecewise import extremes_along, of_extremes
from engine.motion.quantities import Asked, FieldAnswers
from engine.motion.runs.watching import Piece, RunFields


class RunExtremes:
    """Minima and maxima of fields in runs.

    Parameters
    ----------
    fields : RunFields
    names : iterable of str
        Names of fields.
    """

    def __init__(self, fields: RunFields, names: Iterable[str]) -> None:
        self.fields, self.names = fields, tuple(dict.fromkeys(names))
        shape = 2, len(self.names), fields.variants.count
        # −minimum and maximum, and their upper bounds.
        self._most, self._bound = np.full(shape, -np.inf), np.full(shape, -np.inf)
        self._turned, self._time, self._pause = (np.full(shape, np.nan) for _ in range(3))

    def see(self, who: np.ndarray, piece: Piece) -> None:
        """Evaluate a piece of the motion of the variants `who`."""
        rows, columns, nodes = self.fields(who, piece), np.arange(who.size), piece.time.shape[0]
        for i, name in enumerate(self.names):
            for side, (most, node, beyond) in enumerate(extremes_along(rows[name], piece.steps)):
                at = np.where(np.isfinite(node), node, 0.0).astype(int)
                # NaN replaces a number for good.
                more = (most > self._most[side, i, who]) | np.isnan(most)
                those = who[more]
                self._most[side, i, those] = most[more]
                self._turned[side, i, those] = piece.turned[at, columns][more]
                self._time[side, i, those] = piece.time[at, columns][more]
                near = piece.time[np.minimum(at + 1, nodes - 1), columns] - piece.time[np.maximum(at - 1, 0), columns]
                self._pause[side, i, those] = near[more]
                self._bound[side, i, who] = np.fmax(self._bound[side, i, who], beyond)

    def answers(self, asked: Iterable[Asked], spacing: np.ndarray) -> FieldAnswers:
        """Requested extremes of all variants.

        Parameters
        ----------
        asked : iterable of Asked
        spacing : ndarray (variants,)
            Distance between nodes [rad].
        """
        found, cycle = FieldAnswers.none(), self.fields.dynamics.cycle
        way, start = self.fields.variants.direction, self.fields.start
        for _, name, statistic in asked:
            i, key = self.names.index(name), f"{name}.{statistic}"
            values, missed = of_extremes(self._most[:, i], self._bound[:, i])
            for side, end in enumerate(("min", "max")):
                place = start + way * self._turned[side, i]
                values[f"{end}_at"] = np.mod(place, cycle) if np.isfinite(cycle) else place
                values[f"{end}_time"] = self._time[side, i]
                missed[f"{end}_at"], missed[f"{end}_time"] = spacing, self._pause[side, i]
            found.values[key], found.missed[key] = values[statistic], missed[statistic]
            found.scales[key] = values["peak"]
        return found
