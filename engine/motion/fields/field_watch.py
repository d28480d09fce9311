"""Observation of a motion for the requested fields of a regime and their statistics."""

from collections.abc import Sequence

import numpy as np

from engine.motion.fields.field_instants import FieldInstants
from engine.motion.fields.field_statistics import MEANS, FieldStatistics
from engine.motion.fields.motion_fields import MotionFields
from engine.motion.fields.recorded_motion import Observer
from engine.motion.quantities import Asked, FieldAnswers


class FieldWatch:
    """Observers of a motion for requested fields.

    Parameters
    ----------
    fields : MotionFields
    asked : sequence of Asked
    tolerance : float
        As for `FieldStatistics`.
    at : ndarray (instants,), optional
        Times [s] or angles turned [rad] at which fields are kept.
    over_time : bool
        Whether these are times.

    Attributes
    ----------
    fields : as given
    observers : list of Observer
    instants : FieldInstants or None
    """

    def __init__(
        self,
        fields: MotionFields,
        asked: Sequence[Asked],
        tolerance: float,
        at: np.ndarray | None = None,
        over_time: bool = False,
    ) -> None:
        self.fields, self._asked = fields, [one for one in asked if one.statistic]
        kept = [one.field for one in asked if not one.statistic]
        names = [one.field for one in self._asked]
        averaged = {one.field for one in self._asked if one.statistic in MEANS}
        self._statistics = FieldStatistics(fields, names, tolerance, averaged)
        self.instants = FieldInstants(fields, kept, at, over_time) if kept else None
        self.observers: list[Observer] = [self._statistics] if names else []
        self.observers += [self.instants] if kept else []

    def answers(self, compared: "FieldWatch | None" = None) -> FieldAnswers:
        """The requested results; for a shifted motion, `compared` with the watch of the unshifted one."""
        found = self._statistics.answers(self._asked, compared._statistics if compared else None)
        return found if self.instants is None else found._replace(rows=self.instants.rows)
