"""The text of a kernel whose positions lie in panels of each variant's own."""

import re

import numpy as np

from engine.equal_positions.text.demand import HALF
from engine.equal_positions.text.kernel_text import KernelText, Lines
from engine.machine.model import Model
from engine.panels import panel_rows
from engine.scene.parts import CrankInput

# Calls that go over the positions: with panels, these come first.
_OVER_PANELS = re.compile(rf"(?<![\w.])({'|'.join((*panel_rows.__all__, 'halve'))})\(")
_ANGLE_TABLE = re.compile(r"\bangle_table__(\w+)\b")
# Of the range of the input, by number of positions: the spacing of as many equal steps, and the first position.
_SPACING = ["h = length_of(panels) / n", "first = zero", "h_half = h + h"]


def over_panels(line: str) -> str:
    """A line of the mathematics with the panels that it goes over."""

    def with_panels(call: re.Match) -> str:
        half = HALF in line and call[1] != "halve"
        return f"{call[1]}(panels{HALF if half else ''}, "

    return _OVER_PANELS.sub(with_panels, line)


class PanelText(KernelText):
    """Puts the lines of a kernel into a module that lays every variant's positions into panels.

    Parameters
    ----------
    ends : tuple of str
        Ends of strokes that are given, one argument's rows in order.
    """

    def __init__(self, model: Model, slots: list[str], rows: dict[str, str], ends: tuple[str, ...]) -> None:
        super().__init__(model, "panels", np.dtype(np.float64), slots, frozenset(), rows, most=0)
        self.ends = ends

    def module(self, mathematics: Lines, diagnosis: list[str]) -> str:
        """Text of the module."""
        text = mathematics.text
        scratch = [r for r, home in self.rows.items() if home == "scratch"]
        half = [r for r, home in self.rows.items() if home == "half"]
        tables = sorted(set(_ANGLE_TABLE.findall(text)))
        arguments = ["begin", "end", "P", "edges", "short", "outer", "strokes", "rounding"]
        arguments += [*self._table_arguments(text), "values", "errors", "fields", "troubles", "checks"]
        lines = [
            f"def kernel({', '.join(arguments)}):",
            "    most = (edges.shape[1] - 1) * (LONG + 1)",
            f"    scratch = np.empty(({len(scratch) + len(tables) + 3}, most), dtype)",
            "    in_units = np.empty(most, dtype)",
            f"    halves = np.empty(({len(half) + 1}, most), dtype)",
            "    starts, starts_half = np.empty((2, edges.shape[1]), np.int64)",
            "    lengths = np.empty(edges.shape[1], dtype)",
            "    for v in range(begin, end):",
            *(f"        {line}" for line in [*self._numbers(True), *self._numbers(False)]),
            *(f"        {line}" for line in [*self._laid(scratch, half, tables), *_SPACING]),
            *(f"        {end} = strokes[{i}, v]" for i, end in enumerate(self.ends)),
        ]
        every = [*mathematics.positions, *mathematics.shape, *mathematics.variant]
        lines += [f"        {over_panels(line)}" for line in every]
        imports = ("from engine.panels.panels import LONG, Panels, halve, lay_half, lay_positions, length_of",)
        rules = f"from engine.panels.panel_rows import {', '.join(panel_rows.__all__)}"
        head = self._head().replace("\n\ndtype", "\n".join(("", *imports, rules, "", "dtype")), 1)
        return "\n".join([head, *lines, "", "", *self._diagnose(diagnosis), ""])

    def _laid(self, scratch: list[str], half: list[str], tables: list[str]) -> list[str]:
        """Positions of a variant, and the rows over them."""
        nodes = ("nodes", "cos_nodes", "sin_nodes")
        places = [f"scratch[{i}]" for i in range(3)]
        rows = [*nodes, *(f"angle_table__{t}" for t in tables), *scratch]
        lines = [
            f"pieces, n = lay_positions(edges[v], short, outer, starts, lengths, {', '.join(places)})",
            *(f"{row} = scratch[{i}, :n]" for i, row in enumerate(rows)),
            *self._in_units,
            "panels = Panels(starts[: pieces + 1], lengths[:pieces], places)",
            "n_half = lay_half(panels, starts_half, halves[0])",
            f"panels{HALF} = Panels(starts_half[: pieces + 1], lengths[:pieces], halves[0, :n_half])",
            *(f"{row} = halves[{i}, :n_half]" for i, row in enumerate(half, 1)),
        ]
        for t in tables:
            fields = ", ".join(f"table__{t}_{field}" for field in ("breaks", "coefficients", "start", "period"))
            lines += ["for k in range(n):", f"    angle_table__{t}[k] = table_value({fields}, nodes[k])"]
        return lines

    @property
    def _in_units(self) -> list[str]:
        """Places in the input's unit: those of a sliding input are fractions of its range."""
        if isinstance(self.model.scene.input, CrankInput):
            return ["places = nodes"]
        return [
            "length, places = num__input__stop - num__input__start, in_units[:n]",
            "for k in range(n): places[k] = num__input__start + length * nodes[k]",
            "for k in range(pieces): lengths[k] *= length",
        ]

    def angle_tables(self, text: str) -> tuple[str, ...]:
        """None is a row of its own: every table is searched."""
        return ()

    def tables(self, text: str) -> tuple[str, ...]:
        """Searched tables that a text uses, those over the crank angle among them."""
        return (*super().tables(text), *sorted(set(_ANGLE_TABLE.findall(text))))
