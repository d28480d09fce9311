"""From what is asked to the source of a kernel: a readable straight line of the mathematics.

Three forms of the same mathematics. `whole`: every variant evaluated from its own numbers. `factorised`: variants
that share the numbers which decide the shape of the motion are evaluated together; the bases of I, dI/dφ and M
are computed once for the shape and combined for each variant's masses and loads.
"""

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from engine.equal_positions.analyses import Analyses, row_of
from engine.equal_positions.text.apart import is_long, said_apart
from engine.equal_positions.text.demand import HALF, ROW, Demand, Node
from engine.equal_positions.text.kernel_text import Form, KernelText, Lines, spacing
from engine.equal_positions.text.program import Step
from engine.equal_positions.text.superposition import superpose
from engine.machine.model import LinearRow, Model
from engine.scene.scene import scene_numbers

_SLOT = re.compile(r"\bnum__\w+")
_TROUBLED = "troubled = total_of(row__troubled)"


class Source(NamedTuple):
    """A kernel's text and how to call it.

    Attributes
    ----------
    text : str
        Body of a module with the functions `kernel` and `diagnose`.
    slots : tuple of str
        Columns of the parameter array; those of shape first.
    shape_slots : int
        How many of the slots decide the shape of the motion.
    tables, angle_tables : tuple of str
        Names of the tables passed as arguments, in order.
    groups : tuple of str
        Structural groups that are evaluated, in order: what `diagnose` counts.
    steps : tuple of Step
        The per-position steps kept.
    """

    text: str
    slots: tuple[str, ...]
    shape_slots: int
    tables: tuple[str, ...]
    angle_tables: tuple[str, ...]
    groups: tuple[str, ...]
    steps: tuple[Step, ...]


class KernelWriter:
    """Writes the kernel of a model for asked fields and summaries."""

    def __init__(
        self, model: Model, analyses: Analyses, fields: list[str], summaries: list[str], ends: tuple[str, ...] = ()
    ) -> None:
        self.model, self.analyses = model, analyses
        self.fields, self.summaries, self.ends = fields, summaries, ends
        self.demand = Demand(model, analyses, fields, summaries, frozenset(ends))
        self.of_variant = self.demand.of_variant()
        self._fixed = _fixed_loads(model)

    def source(self, form: Form, dtype: np.dtype, most: int) -> Source:
        """The kernel's source in one of its forms, for rows of at most so many positions."""
        positions = self._position_loop(form)
        outputs, shape, variant = self._outputs(form, _TROUBLED in positions and bool(self._watched)), [], []
        shape_lines, together, nodes = (), None, self.demand.nodes
        if form == "factorised":
            shape_lines, together, nodes = superpose(self.demand, "\n".join(outputs), self._fixed)
        for node in nodes:
            lines = self._lines_of(node, form)
            (variant if self.of_variant.intersection(node.targets) else shape).extend(lines)
        shape += shape_lines
        variant += outputs
        lines = Lines(positions, shape, together, variant)
        body = lines.text
        diagnosis = self._diagnosis()
        slots = self._slots("\n".join((body, *diagnosis, *spacing(self.model))))
        homes = self._homes(body, form)
        writer = KernelText(self.model, form, dtype, slots, self._fixed, homes, most)
        return Source(
            writer.module(lines, diagnosis),
            tuple(slots),
            sum(self.model.program.slots[s].role == "shape" for s in slots),
            writer.tables(body),
            writer.angle_tables(body),
            self.demand.groups,
            self.demand.steps,
        )

    def _position_loop(self, form: Form) -> list[str]:
        """The vectorised loop over positions; `troubled` counts groups that are singular or can't be assembled."""
        demand, sines = self.demand, self.model.mechanism.sines
        inner = [step.line for step in demand.first_steps]
        inner += [f"row__{v}[k] = {v}" for v in sorted(demand.row_variables)]
        if form == "factorised":
            inner += [f"bas__{b}[k] = {b}" for b in sorted(demand.bases)]
        else:
            for target, row in demand.linear.items():
                terms = self._terms(row, in_laws=False)
                if terms or not row.terms:
                    inner.append(f"{target}[k] = {' + '.join(terms) or 'zero'}")
        troubles = " + ".join(f"(zero if abs({sines[g]}) >= least_sine else one)" for g in demand.groups)
        if is_long(inner) and troubles:
            # A running sum would make the compiler work on several vectors at once, for which there are no registers.
            # What isn't finite spoils this one, so that many rows needn't be read again for it.
            troubles += f" + zero * ({' + '.join(self._watched)})" if self._watched else ""
            return [*_over_positions([*inner, f"row__troubled[k] = {troubles}"]), _TROUBLED]
        # One addition to the running count: a second would have to wait for the first.
        inner += [f"troubled += {troubles}"] if troubles else []
        return ["troubled = zero", *(_over_positions(inner) if inner else [])]

    @property
    def _watched(self) -> list[str]:
        """Variables of the asked fields, if the first loop over positions makes them all."""
        asked = {row_of(self.model, field).removeprefix("row__") for field in self.fields}
        return sorted(asked) if asked <= self.demand.row_variables else []

    def _lines_of(self, node: Node, form: Form) -> Sequence[str]:
        """Lines of a node: its own, those of a linear row, a later loop over the positions, or passes of friction."""
        if node.targets[0] in self.demand.linear:
            return self._linear_lines(node, form)
        settling = self.demand.settlings.get(node.targets[0])
        if settling is not None:
            return settling.lines(_over_positions)
        loop = self.demand.loop_of(node)
        return _over_positions(self.demand.later_loop(loop)) if loop else node.lines

    def _terms(self, row: LinearRow, in_laws: bool) -> list[str]:
        """Terms of a linear row at position k: those of laws, or its constant and those of the position loop."""
        laws = self.model.moments.laws
        if in_laws:
            return [f"{c} * {b}[k]" for c, b in row.terms if b in laws]
        terms = [f"{c} * {b}" if b != "one" else c for c, b in row.terms if b not in laws]
        return [row.constant, *terms] if row.constant else terms

    def _linear_lines(self, node: Node, form: Form) -> tuple[str, ...]:
        """What completes a linear row after the position loop."""
        target = node.targets[0]
        row = self.demand.linear[target]
        laws = self._terms(row, in_laws=True)
        if form != "factorised":
            terms, started = laws, bool(self._terms(row, in_laws=False))
        else:
            known = self.model.moments.laws
            bases = [f"{c} * bas__{b}[k]" if b != "one" else c for c, b in row.terms if b not in known]
            terms = [*([row.constant] if row.constant else []), *bases, *laws] or ["zero"]
            started = False
        if not terms:
            return ()
        return ("for k in range(n):", f"    {target}[k] {'+=' if started else '='} {' + '.join(terms)}")

    def _outputs(self, form: Form, watched: bool) -> list[str]:
        """Lines that write the results; `watched` where the count of troubles shows whether fields are finite."""
        lines = []
        for i, name in enumerate(self.summaries):
            result = self.analyses.results[name]
            lines.append(f"values[v, {i}] = {result.value.replace('$', '')}")
            lines.append(f"errors[v, {i}] = {result.error.replace('$', '')} + rounding * abs(values[v, {i}])")
        rows = [row_of(self.model, field) for field in self.fields]
        for i, row in enumerate(rows):
            # Two fields may be the same row (a block turns with its slot): it is computed in place once, then copied.
            if row in rows[:i] or not self._is_direct(row, form):
                lines += ["for k in range(n):", f"    fields[{i}, v, k] = {row}[k]"]
        lines.append("troubles[v] = troubled")
        if watched:
            return [*lines, "checks[v] = troubled"]
        if form == "factorised":
            # Rows are named one by one: those that no output names aren't made for each variant.
            checks = " + ".join(f"mean_of({row})" for row in dict.fromkeys(rows))
            return [*lines, f"checks[v] = {checks or 'zero'}"]
        checks = ("checks[v] = zero", "for i in range(fields.shape[0]):", "    checks[v] += mean_of(fields[i, v])")
        return [*lines, *checks]

    def _is_direct(self, row: str, form: Form) -> bool:
        """Whether an asked field is computed in its place in the results, not copied there."""
        return form != "factorised" or row in self.of_variant

    def _homes(self, text: str, form: Form) -> dict[str, str]:
        """Where each row is kept: in the asked fields, in scratch, or in scratch of half the length."""
        homes: dict[str, str] = {}
        for i, field in enumerate(self.fields):
            row = row_of(self.model, field)
            if self._is_direct(row, form):
                homes.setdefault(row, f"fields[{i}, v]")
        for row in sorted(set(ROW.findall(text)) - set(homes)):
            homes[row] = "half" if row.endswith(HALF) else "scratch"
        return homes

    def _slots(self, text: str) -> list[str]:
        used = set(_SLOT.findall(text))
        slots = [s for s in self.model.program.slots.values() if s.variable in used]
        return [s.variable for s in sorted(slots, key=lambda s: s.role != "shape")]

    def _diagnosis(self) -> list[str]:
        """Position by position: the first group that can't be assembled, else the one nearest to singular."""
        sines = [self.model.mechanism.sines[g] for g in self.demand.groups]
        steps = [step.line for step in self.model.program.needed(sines)]
        lines = [*_places(steps), *steps]
        for i, sine in enumerate(sines):
            lines += [
                f"if math.isnan({sine}):",
                f"    least, group, place = -one, {i}, k",
                "    break",
                f"if abs({sine}) < least:",
                f"    least, group, place = abs({sine}), {i}, k",
            ]
        return lines


def _fixed_loads(model: Model) -> frozenset[str]:
    """Loads that are the same for all variants: no array enters where all that varies is one."""
    known = scene_numbers(model.scene)
    numbers = model.numbers({path: np.array([known[path].value]) for path in model.varied})
    with np.errstate(all="ignore"):
        return frozenset(
            s for s, slot in model.program.slots.items() if slot.role == "load" and np.ndim(slot.compute(numbers)) == 0
        )


def _over_positions(lines: list[str]) -> list[str]:
    """The vectorised loop over positions."""
    lines = [*_places(lines), *lines]
    return ["for k in range(n):", *(f"    {line}" for line in (said_apart(lines) if is_long(lines) else lines))]


def _places(lines: list[str]) -> list[str]:
    """Reading of the input's position, as far as the lines use it."""
    text = "\n".join(lines)
    names = {"q": "nodes", "cos_q": "cos_nodes", "sin_q": "sin_nodes"}
    return [f"{name} = {table}[k]" for name, table in names.items() if re.search(rf"\b{name}\b", text)]
