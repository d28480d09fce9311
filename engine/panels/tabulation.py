"""Rows of many variants, each at crank angles of its own.

The kernels of `engine.equal_positions.text.kernels` go through one set of positions, the same for every variant.
Motion needs more: nodes where a moment jumps, another angle for every variant at every instant. Here the same steps
are vectorised over variants instead of positions: a kernel fills `out[row, node, variant]` for given angles `q[node,
variant]`.
"""

import re
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from engine.compiling.jit import run_kernel
from engine.laws.tables import Table
from engine.machine.model import LinearRow, Model
from engine.scene.scene import Numbers

_SLOT = re.compile(r"\bnum__\w+")
_END = re.compile(r"\b(?:low|high|low_at|high_at)__\w+")
_FIELDS = Table._fields


class Ends(NamedTuple):
    """Ends of stroke of a slider for every variant: low and high end [m], and the crank angles there [rad]."""

    low: np.ndarray
    high: np.ndarray
    low_at: np.ndarray
    high_at: np.ndarray


class Tabulation:
    """Rows of a model at angles of each variant's own.

    Parameters
    ----------
    model : Model
    rows : mapping of str to LinearRow or str
        The rows by name: sums of terms, or variables of the program.
    given : tuple of str
        Variables that the program doesn't make: their values are passed for every variant at every angle.
    """

    def __init__(self, model: Model, rows: Mapping[str, LinearRow | str], given: tuple[str, ...] = ()) -> None:
        self.model, self.names, self.given = model, tuple(rows), given
        laws = model.moments.laws
        used = {b for row in rows.values() if isinstance(row, LinearRow) for _, b in row.terms}
        self.laws = [law for name, law in laws.items() if name in used]
        asked = {b for b in used if b not in laws} | {row for row in rows.values() if isinstance(row, str)}
        asked -= {"one", "zero"}
        names = set().union(*(step.needs for step in model.program.needed(asked)))
        # What depends on a characteristic that is searched waits for it: all is made after these then.
        self.searched = [law for law in laws.values() if law.value_row in names]
        read = {v for law in (*self.laws, *self.searched) for v in law.rows}
        self.early = model.program.needed(read if self.searched else asked | read)
        self.steps = model.program.needed(asked | read)
        self._in_loop = [self._at_position(i, row) for i, row in enumerate(rows.values())]
        self._after = [line for i, row in enumerate(rows.values()) for line in self._from_laws(i, row)]
        laws_read = [law.expression for law in self.laws] + [law.value for law in self.searched]
        text = "\n".join((*(s.line for s in self.steps), *self._in_loop, *laws_read, *sorted(read), *self._after))
        moments = model.moments
        self.tables = [t for t in moments.tables if f"table__{t}_breaks" in text]
        self.angle_tables = [t for t in moments.angle_tables if f"angle_table__{t}[" in text]
        self.slots = [s for s in model.program.slots if s in set(_SLOT.findall(text))]
        self.ends = sorted(set(_END.findall(text)))
        self.text = self._module(text)

    # The kernel's text

    def _at_position(self, row: int, what: LinearRow | str) -> str:
        if isinstance(what, str):
            return f"made[{row} * LANES + k] = {what}"
        laws = self.model.moments.laws
        terms = [c if b == "one" else f"{c} * {b}" for c, b in what.terms if b not in laws]
        terms = [what.constant, *terms] if what.constant else terms
        return f"made[{row} * LANES + k] = {' + '.join(terms) or 'zero'}"

    def _from_laws(self, row: int, what: LinearRow | str) -> list[str]:
        if isinstance(what, str):
            return []
        laws = {law.row for law in self.laws}
        terms = [f"{c} * {b}[k]" for c, b in what.terms if b in laws]
        return [f"made[{row} * LANES + k] += {' + '.join(terms)}"] if terms else []

    def _law_loops(self, load: list[str]) -> list[str]:
        """A loop for each characteristic: they are searched and branch, and would keep others from vectorising."""
        made = [(law.row, law.expression, law.clock) for law in self.laws]
        made += [(law.value_row, law.value, law.clock) for law in self.searched]
        lines = []
        for row, expression, clock in made:
            own = [line for line in load if line.split(" ")[0] in expression]
            lines += _loop([*own, f"{row}[k] = {expression.replace(clock, 'now[k]') if clock else expression}"])
        return lines

    def _of_place(self, load: list[str]) -> list[str]:
        """Lines that make all rows of a group of lanes at one place."""
        place = [*load, "cos_q, sin_q = direction_of(nodes[k])", "q = nodes[k]"]
        place += [f"{name} = lane__{name}[k]" for name in self.given]
        read = sorted({v for law in (*self.laws, *self.searched) for v in law.rows})
        lines = ["for k in range(LANES):", "    v = min(first + k, end - 1)"]
        lines += ["    nodes[k], now[k] = places[j, v], clock[j, v]"]
        lines += [f"    lane__{name}[k] = given[{i}, j, v]" for i, name in enumerate(self.given)]
        for t in self.angle_tables:
            fields = ", ".join(f"table__{t}_{f}" for f in _FIELDS)
            lines += _loop([f"angle_table__{t}[k] = table_value({fields}, nodes[k])"])
        every = [step.line for step in self.steps] + self._in_loop
        early = [step.line for step in self.early] + ([] if self.searched else self._in_loop)
        lines += _loop([*place, *early, *(f"row__{v}[k] = {v}" for v in read)])
        lines += self._law_loops(load)
        if self.searched:
            return lines + _loop([*place, *every, *self._after])
        return lines + (_loop([*load, *self._after]) if self._after else [])

    def _module(self, text: str) -> str:
        """Lanes of variants go side by side, with their numbers in small arrays that the compiler sees to be apart."""
        laws = (*self.laws, *self.searched)
        kept = sorted({f"row__{v}" for law in laws for v in law.rows} | {law.row for law in self.laws})
        kept += [law.value_row for law in self.searched] + [f"lane__{name}" for name in self.given]
        kept += [f"angle_table__{t}" for t in self.angle_tables]
        tables = [f"table__{t}_{f}" for t in (*self.tables, *self.angle_tables) for f in _FIELDS]
        load = [f"{s} = own[{i} * LANES + k]" for i, s in enumerate((*self.slots, *self.ends))]
        of_place = self._of_place(load)
        of_place += ["sums[:] = 0.0", f"for r in range({len(self.names)}):", "    if target[r] >= 0:"]
        of_place += ["        for k in range(LANES):"]
        of_place += ["            sums[target[r] * LANES + k] += made[r * LANES + k] * turned[r * LANES + k]"]
        of_place += ["for r in range(out.shape[0]):", "    for k in range(min(LANES, end - first)):"]
        of_place += ["        out[r, j, first + k] = sums[r * LANES + k]"]
        counts = (len(self.slots), len(self.ends), len(self.names))
        lines = ["sums = np.empty(out.shape[0] * LANES)", f"turned = np.empty({counts[2]} * LANES)"]
        lines += [f"own, made = np.empty({counts[0] + counts[1]} * LANES + 1), np.empty({counts[2]} * LANES)"]
        lines += [f"{r} = np.empty(LANES)" for r in ("nodes", "now", *kept)]
        lines += ["for first in range(begin, end, LANES):"]
        for array, at, count in (("P", 0, counts[0]), ("ends", counts[0], counts[1])):
            lines += [f"    for i in range({count}):", "        for k in range(LANES):"]
            lines += [f"            own[({at} + i) * LANES + k] = {array}[i, min(first + k, end - 1)]"]
        lines += [f"    for r in range({counts[2]}):", "        for k in range(LANES):"]
        lines += ["            turned[r * LANES + k] = way[r, min(first + k, end - 1)]"]
        lines += ["    for j in range(places.shape[0]):", *(f"        {line}" for line in of_place)]
        given = ["given"] if self.given else []
        arguments = ", ".join(["begin, end, P, places, clock, ends", *tables, *given, "target, way, out"])
        return "\n".join([_HEAD, f"def tabulate({arguments}):", *(f"    {line}" for line in lines), ""])

    # Evaluation

    def parameters(self, numbers: Numbers, variants: int, direction: np.ndarray) -> np.ndarray:
        """Slots at unit speed in the given direction: with them a row of order n gives the moment over |ω|ⁿ.

        Parameters
        ----------
        numbers : Numbers
        variants : int
        direction : ndarray (variants,)
            +1 or −1, the sign of the crank's speed.
        """
        unit = numbers.with_values({"input.speed": direction})
        # What overflows on the way to a parameter ends as a status, not as a warning.
        with np.errstate(all="ignore"):
            return self.model.parameters(self.slots, unit, variants, np.float64)

    def __call__(
        self,
        parameters: np.ndarray,
        ends: Mapping[str, Ends],
        q: np.ndarray,
        clock: np.ndarray | None = None,
        sums: "Sums | None" = None,
        given: np.ndarray | None = None,
    ) -> np.ndarray:
        """The rows at given crank angles, or sums of them.

        Parameters
        ----------
        parameters : ndarray (slots, variants)
        ends : mapping of slider to Ends
        q : ndarray (nodes, variants)
            Crank angles [rad].
        clock : ndarray (nodes, variants), optional
            Time [s], where a moment depends on it.
        sums : Sums, optional
            What to add up; without it every row by itself.
        given : ndarray (variables, nodes, variants), optional
            Values of the variables that are given.

        Returns
        -------
        ndarray (rows or sums, nodes, variants)
        """
        variants = parameters.shape[1]
        if sums is None:
            sums = Sums(np.arange(len(self.names)), len(self.names), np.ones((len(self.names), variants)))
        out = np.empty((sums.count, *q.shape))
        strokes = np.empty((len(self.ends), variants))
        for i, end in enumerate(self.ends):
            kind, slider = end.split("__", 1)
            strokes[i] = getattr(ends[slider], kind)
        moments = self.model.moments
        tables = [moments.tables[t] for t in self.tables] + [moments.angle_tables[t] for t in self.angle_tables]
        fields = [value for table in tables for value in table]
        clock = q if clock is None else clock
        added = (*([given] if self.given else []), sums.target, sums.way)
        run_kernel(self.text, "tabulate", variants, parameters, q, clock, strokes, *fields, *added, out)
        return out


class Sums(NamedTuple):
    """Rows added up.

    Attributes
    ----------
    target : ndarray (rows,) of int
        To which sum each row belongs; −1 where to none.
    count : int
        Number of sums.
    way : ndarray (rows, variants)
        Factor of each row.
    """

    target: np.ndarray
    count: int
    way: np.ndarray


def _loop(lines: list[str]) -> list[str]:
    return ["for k in range(LANES):", *(f"    {line}" for line in lines)]


_HEAD = '''"""Rows of one machine's structure at angles of each variant's own."""

import math

import numpy as np
from numba import njit

from engine.laws.elementary import direction_of
from engine.laws.kinematics.prp import *
from engine.laws.kinematics.rpp import *
from engine.laws.kinematics.rpr import *
from engine.laws.kinematics.rrp import *
from engine.laws.kinematics.rrr import *
from engine.laws.kinematics.vectors import *
from engine.laws.indicator_diagrams import *
from engine.laws.inertia_forces import *
from engine.compiling.jit import KERNEL_OPTIONS
from engine.laws.kinematics.links import *
from engine.laws.loads import *
from engine.laws.reduction import *
from engine.equal_positions.strokes import *
from engine.laws.tables import table_value

one, zero = 1.0, 0.0
LANES = 32


@njit(**KERNEL_OPTIONS)'''
