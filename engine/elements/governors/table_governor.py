"""Governors by a table of their controlling force."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from engine.elements.governors.governed_engine import check_rows
from engine.elements.governors.governor import Governor
from engine.elements.governors.places import Holding
from engine.laws.tables import Table, make_table
from engine.parts.skeleton import Length, Number, quantity
from engine.units.display import quantity_text


class TableGovernor(Governor):
    """A governor by a table of its controlling force, found by experiment: the force on each ball, without friction.

    The rows stand over the radius of the balls, or over the lift, which is `lift_ratio` times the radius gained.
    """

    geometry: ClassVar = ("lift_ratio",)

    type: Literal["table_governor"]
    over_radius: list[Length] | None = None
    over_lift: list[Length] | None = None
    controlling_force: list[quantity("force")]
    interpolation: Literal["linear", "pchip", "spline"]
    lift_ratio: Annotated[Number, Field(gt=0)]

    @model_validator(mode="after")
    def _table_spans_the_range(self) -> "TableGovernor":
        if (self.over_radius is None) == (self.over_lift is None):
            raise ValueError("give over_radius or over_lift, one of the two")
        key = "over_lift" if self.over_radius is None else "over_radius"
        rows = getattr(self, key)
        check_rows(rows, self.controlling_force, self.interpolation, (key, "controlling_force"))
        lift = (self.greatest_radius - self.least_radius) * self.lift_ratio
        needed = (0.0, lift) if self.over_radius is None else (self.least_radius, self.greatest_radius)
        if not (rows[0] <= needed[0] and needed[1] <= rows[-1] * (1 + 1e-12)):
            raise ValueError(
                f"{key} spans {quantity_text(rows[0], 'm')} to {quantity_text(rows[-1], 'm')}, the "
                f"stops lie at {quantity_text(needed[0], 'm')} and {quantity_text(needed[1], 'm')}: give "
                "rows up to both stops, or move these"
            )
        return self

    @property
    def holding(self) -> Holding:
        """Over what the controlling force is tabled."""
        return Holding.OVER_RADIUS if self.over_radius is not None else Holding.OVER_LIFT

    @property
    def controlling_table(self) -> Table:
        """Table of the controlling force over the radius or the lift."""
        rows = self.over_radius if self.over_radius is not None else self.over_lift
        return make_table(rows, self.controlling_force, self.interpolation)
