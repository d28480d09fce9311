"""Passes over the positions that settle the pressing forces in the rubbing pairs of a group; see friction.feedback.

Every pass is a vectorised loop over the positions; they are repeated until nothing changes any more. Groups are
settled one after another, last first, as their reactions are found: none feels the friction of one before it.
"""

from collections.abc import Callable
from typing import NamedTuple

_SOLVE = {1: "one", 2: "two", 3: "three"}


class Settling(NamedTuple):
    """The rubbing pairs of a group and how friction in each acts back on all of them.

    Attributes
    ----------
    group : str
    rows : tuple of str
        Row of the pressing force of each pair.
    free : tuple of (str, str)
        Variables of each pair's reaction without friction in the group: two components, or normal force and moment.
    backs : tuple of tuple of (str, str)
        [i][j]: what a newton that presses in pair j adds to the reaction of pair i.
    edges : tuple of str
        Arguments of `guide_bearing`, "" of a revolute pair.
    """

    group: str
    rows: tuple[str, ...]
    free: tuple[tuple[str, str], ...]
    backs: tuple[tuple[tuple[str, str], ...], ...]
    edges: tuple[str, ...]

    @property
    def inputs(self) -> frozenset[str]:
        """Variables that the passes read as rows."""
        pairs = [*self.free, *(pair for row in self.backs for pair in row)]
        return frozenset(name for pair in pairs for name in pair)

    @property
    def margin(self) -> str:
        """Row of the margin against jamming."""
        return f"mrg__{self.group}"

    @property
    def passes(self) -> str:
        """Number of passes."""
        return f"passes__{self.group}"

    @property
    def residual(self) -> str:
        """Greatest change in the last pass."""
        return f"residual__{self.group}"

    @property
    def targets(self) -> tuple[str, ...]:
        """Rows and numbers that the passes produce."""
        return (*self.rows, self.margin, self.passes, self.residual)

    def lines(self, over_positions: Callable[[list[str]], list[str]]) -> list[str]:
        """All passes, from no friction to none that changes; jammed positions are undefined then.

        Parameters
        ----------
        over_positions : callable
            Makes the loop over the positions k from its lines.
        """
        left = f"{self.residual} > settled and changes == changes"
        started = over_positions([f"{row}[k] = zero" for row in self.rows])
        ended = over_positions([f"{row}[k] = unless_jammed({row}[k], {self.margin}[k], jammed)" for row in self.rows])
        return [
            *started,
            f"{self.passes}, {self.residual}, changes = zero, one, zero",
            f"while {left} and {self.passes} < MOST_PASSES:",
            f"    {self.passes} += one",
            f"    share = one if {self.passes} <= WHOLE_PASSES else HALF_WAY",
            f"    {self.residual}, changes = zero, zero",
            *(f"    {line}" for line in over_positions(self._one_pass())),
            *ended,
        ]

    def _one_pass(self) -> list[str]:
        """Lines of a pass at position k."""
        order, residual = range(len(self.rows)), self.residual
        lines = [f"{name} = row__{name}[k]" for name in sorted(self.inputs)]
        lines += [f"old{i} = {row}[k]" for i, row in enumerate(self.rows)]
        lines += [f"p{i}, q{i} = {self._bearing(i)}" for i in order]
        given = [f"p{i} * {self.backs[i][j][0]} + q{i} * {self.backs[i][j][1]}" for i in order for j in order]
        forces = [f"p{i} * {self.free[i][0]} + q{i} * {self.free[i][1]}" for i in order]
        found = ", ".join(f"new{i}" for i in order)
        lines.append(f"{found}, determinant = {_SOLVE[len(self.rows)]}_pressing({', '.join((*given, *forces))})")
        change = " + ".join(f"abs(new{i} - old{i})" for i in order)
        whole = " + ".join(f"abs(new{i})" for i in order)
        lines += [f"change = change_of({change}, {whole})", "changes += change"]
        lines.append(f"{residual} = larger({residual}, change)")
        lines += [f"{row}[k] = old{i} + share * (new{i} - old{i})" for i, row in enumerate(self.rows)]
        return [*lines, f"{self.margin}[k] = freedom(determinant, change)"]

    def _bearing(self, i: int) -> str:
        """Direction of the reaction of a pair with the pressing forces of the pass before."""
        x, y = (
            " + ".join([self.free[i][axis], *(f"{back[axis]} * old{j}" for j, back in enumerate(self.backs[i]))])
            for axis in (0, 1)
        )
        if self.edges[i]:
            return f"guide_bearing({x}, {y}, {self.edges[i]})"
        return f"journal_bearing({x}, {y})"
