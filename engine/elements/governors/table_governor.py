"""Governors defined by a table of their controlling force."""

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.governors.governor import Governor
from engine.elements.governors.governor_forces import Linkage, by_table
from engine.graph.nodes import Graph, Node
from engine.laws.tables import Table, make_table
from engine.parts.skeleton import Faults, Length, Number, quantity
from engine.units.display import quantity_text


class TableGovernor(Governor):
    """A governor defined by a table of its measured controlling force: the force on each ball, without friction.

    The rows are over the radius of the balls, or over the lift, which is `lift_ratio` times the increase in radius.
    """

    one_of: ClassVar = (("over_radius", "over_lift"),)

    type: Literal["table_governor"]
    over_radius: list[Length] | None = None
    over_lift: list[Length] | None = None
    controlling_force: list[quantity("force")]
    interpolation: Literal["linear", "pchip", "spline"]
    lift_ratio: Annotated[Number, Field(gt=0)]

    def _faults(self) -> Faults:
        key = "over_lift" if self.over_radius is None else "over_radius"
        rows = getattr(self, key)
        make_table(rows, self.controlling_force, self.interpolation, names=(key, "controlling_force"))
        lift = (self.greatest_radius - self.least_radius) * self.lift_ratio
        needed = (0.0, lift) if self.over_radius is None else (self.least_radius, self.greatest_radius)
        if not (rows[0] <= needed[0] and needed[1] <= rows[-1] * (1 + 1e-12)):
            yield (
                f"{key} spans {quantity_text(rows[0], 'm')} to {quantity_text(rows[-1], 'm')}, the "
                f"stops lie at {quantity_text(needed[0], 'm')} and {quantity_text(needed[1], 'm')}: give "
                "rows up to both stops, or move these"
            )

    @property
    def controlling_table(self) -> Table:
        """Table of the controlling force over radius or lift, extrapolated linearly beyond its rows."""
        rows = self.over_radius if self.over_radius is not None else self.over_lift
        table = make_table(rows, self.controlling_force, self.interpolation)
        cubic = table.coefficients.copy()
        first, last = cubic[1], cubic[-2]
        t = table.breaks[-2] - table.breaks[-3]
        cubic[0] = (0.0, 0.0, first[2], first[3])
        cubic[-1] = (0.0, 0.0, (3 * last[0] * t + 2 * last[1]) * t + last[2], np.polyval(last, t))
        return table._replace(coefficients=cubic)

    def linkage(self, graph: Graph, x: Node) -> Linkage:
        """The sleeve moves in proportion to the radius."""
        return Linkage(x, graph.zero, (x - graph.number("least_radius")) * graph.number("lift_ratio"))

    def held(self, link: Linkage, rates: Linkage, lift: Node) -> tuple[Node, Node]:
        """Twice the force of the table."""
        slope = 2.0 * by_table(self.controlling_table, lift if self.over_radius is None else link.radius)
        return slope, abs(slope)
