"""From what is asked to a compiled kernel: a readable straight-line source, and its compilation.

Two forms of the same mathematics. `whole`: every variant evaluated from its own numbers. `factorised`: variants
that share the numbers which decide the shape of the motion are evaluated together; the bases of I, dI/dφ and M
are computed once for the shape and combined for each variant's masses and loads.
"""

import re
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from engine.analyses import Analyses, Result, row_of
from engine.kernel_text import Form, KernelText
from engine.model import Model
from engine.program import Step

_ROW = re.compile(r"\b(?:row|lin|ang|law|bas)_\w+")
_SLOT = re.compile(r"\bnum_\w+")
_WORD = re.compile(r"(?<![\w.])[A-Za-z_]\w*")


class Node(NamedTuple):
    """Lines about whole rows: what they produce and what they need."""

    targets: tuple[str, ...]
    needs: frozenset[str]
    lines: tuple[str, ...]


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

    def __init__(self, model: Model, analyses: Analyses, fields: list[str], summaries: list[str]) -> None:
        self.model, self.analyses = model, analyses
        self.fields, self.summaries = fields, summaries
        self.nodes = self._needed_nodes()

    # What is needed

    def _results(self) -> list[Result]:
        return [self.analyses.results[name] for name in self.summaries]

    def _asked_names(self) -> set[str]:
        names = {row_of(self.model, field) for field in self.fields}
        for result in self._results():
            for expression in (result.value, result.error):
                names.update(_WORD.findall(expression.replace("$", "")))
        for result in self._results():
            names.update(_WORD.findall(result.error.replace("$", "")))
        return names

    def _all_nodes(self) -> list[Node]:
        """Every node that could be needed, in an order that respects their needs."""
        nodes = []
        for step in self.analyses.steps:
            if not step.targets[0].startswith(("low_", "low_turn_", "ang_")):
                continue
            nodes += self._both(step)
        for law in self.model.moments.laws.values():
            needs = {f"row_{r}" for r in law.rows} | set(_WORD.findall(law.expression))
            nodes.append(
                Node(
                    (law.row,),
                    frozenset(needs),
                    ("for k in range(n):", f"    {law.row}[k] = {law.expression}"),
                )
            )
        for name, row in self.model.linear.items():
            target = "lin_" + name.replace(".", "__")
            needs = {word for term in row.terms for word in _WORD.findall(" ".join(term))}
            nodes.append(Node((target,), frozenset(needs | ({row.constant} if row.constant else set())), ()))
        for step in self.analyses.steps:
            if not step.targets[0].startswith(("low_", "low_turn_", "ang_")):
                nodes += self._both(step)
        return nodes

    @staticmethod
    def _both(step: object) -> list[Node]:
        """A row step at full and at half resolution."""
        found = []
        marked = any("$" in t for t in step.targets)
        for mark in ("", "_half") if marked else ("",):
            targets = tuple(t.replace("$", mark) for t in step.targets)
            needs = frozenset(n.replace("$", mark) for n in step.needs) - set(targets)
            found.append(Node(targets, needs, (step.statement.replace("$", mark),)))
        return found

    def _needed_nodes(self) -> list[Node]:
        """Nodes on which the asked results depend, with the halving of rows where it is needed."""
        everything = self._all_nodes()
        produced = {t for node in everything for t in node.targets}
        wanted, kept = self._asked_names(), []
        for node in reversed(everything):
            if wanted.intersection(node.targets):
                kept.append(node)
                wanted |= node.needs
        halves = sorted(n for n in wanted if n.endswith("_half") and n not in produced and _ROW.fullmatch(n))
        # A halved row may itself be produced by a node that nothing else asked for.
        missing = {h.removesuffix("_half") for h in halves} - wanted
        for node in reversed(everything):
            if missing.intersection(node.targets) and node not in kept:
                kept.append(node)
                missing |= node.needs
        self.wanted = wanted | missing | {h.removesuffix("_half") for h in halves}
        kept = [node for node in everything if node in kept]
        kept += [
            Node((h,), frozenset({h.removesuffix("_half")}), (f"halve({h.removesuffix('_half')}, {h})",))
            for h in halves
        ]
        return kept

    # Writing

    def source(self, form: Form, dtype: np.dtype) -> Source:
        """The kernel's source in one of its two forms."""
        bases, base_rows, kept = self._vectorised(form)
        steps = self.model.program.needed(bases | base_rows | self._sines_wanted(kept, bases | base_rows))
        groups, doubts = self._doubts(steps)
        per_variant = self._variant_level()
        body_a = self._position_loop(form, steps, base_rows, bases, doubts)
        geometry, variant = [], []
        for node in self._in_order(kept, form, base_rows):
            (variant if per_variant.intersection(node.targets) else geometry).extend(node.lines)
        variant += self._outputs(form, per_variant)
        everything = "\n".join((*body_a, *geometry, *variant))
        diagnosis = self._diagnosis(groups)
        slots = self._slots("\n".join((everything, *diagnosis)))
        writer = KernelText(self.model, form, dtype, slots, self._rows(everything, form, per_variant))
        text = writer.module(body_a, geometry, variant, diagnosis, len(self.fields))
        shape = sum(self.model.program.slots[s].role == "shape" for s in slots)
        return Source(
            text,
            tuple(slots),
            shape,
            writer.tables(everything),
            writer.angle_tables(everything),
            groups,
            tuple(steps),
        )

    def _linear_wanted(self) -> dict[str, object]:
        return {
            "lin_" + name.replace(".", "__"): row
            for name, row in self.model.linear.items()
            if "lin_" + name.replace(".", "__") in self.wanted
        }

    def _vectorised(self, form: Form) -> tuple[set[str], set[str], list[Node]]:
        """Bases and variables that the position loop must produce, and the nodes that follow it."""
        laws = self.model.moments.laws
        variables = {r.removeprefix("row_") for r in self.wanted if r.startswith("row_")}
        produced = {t for node in self.nodes for t in node.targets}
        base_rows = {v for v in variables if f"row_{v}" not in produced and not v.endswith("_half")}
        bases = {b for row in self._linear_wanted().values() for _, b in row.terms if b not in laws}
        return bases - {"one"}, base_rows, self.nodes

    def _sines_wanted(self, kept: list[Node], asked: set[str]) -> set[str]:
        """Transmission qualities of the groups that the asked variables depend on."""
        steps = self.model.program.needed(asked)
        targets = {t for step in steps for t in step.targets}
        return {sine for sine in self.model.mechanism.sines.values() if sine in targets or self._drives(sine, steps)}

    def _drives(self, sine: str, steps: list[Step]) -> bool:
        """Whether the step that makes a group's sine shares its subject with kept steps."""
        step = next(s for s in self.model.program.steps if sine in s.targets)
        return any(s.subject == step.subject for s in steps)

    def _doubts(self, steps: list[Step]) -> tuple[tuple[str, ...], list[str]]:
        targets = {t for step in steps for t in step.targets}
        groups = tuple(g for g, sine in self.model.mechanism.sines.items() if sine in targets)
        return groups, [self.model.mechanism.sines[g] for g in groups]

    def _position_loop(
        self, form: Form, steps: list[Step], base_rows: set[str], bases: set[str], doubts: list[str]
    ) -> list[str]:
        """The vectorised loop over positions."""
        inner = [step.line for step in steps]
        inner += [f"row_{v}[k] = {v}" for v in sorted(base_rows)]
        if form == "factorised":
            inner += [f"bas_{b}[k] = {b}" for b in sorted(bases)]
        else:
            laws = self.model.moments.laws
            for target, row in self._linear_wanted().items():
                terms = [f"{c} * {b}" if b != "one" else c for c, b in row.terms if b not in laws]
                terms = [row.constant, *terms] if row.constant else terms
                if terms or not row.terms:
                    inner.append(f"{target}[k] = {' + '.join(terms) or 'zero'}")
        inner += [f"doubt += one / ({sine} * {sine})" for sine in doubts]
        if not inner:
            return ["doubt = zero"]
        text = "\n".join(inner)
        places = ["q = nodes[k]"] if re.search(r"\bq\b", text) else []
        places += [f"{f}_q = {f}_nodes[k]" for f in ("cos", "sin") if re.search(rf"\b{f}_q\b", text)]
        return ["doubt = zero", "for k in range(n):", *(f"    {line}" for line in (*places, *inner))]

    def _in_order(self, kept: list[Node], form: Form, base_rows: set[str]) -> list[Node]:
        """Nodes with their lines, each after what it needs."""
        nodes = [self._with_lines(node, form) for node in kept]
        pending, done, ordered = list(nodes), set(), []
        producible = {t for node in nodes for t in node.targets}
        while pending:
            ready = [n for n in pending if not ((n.needs & producible) - done)]
            for node in ready:
                ordered.append(node)
                done.update(node.targets)
                pending.remove(node)
            if not ready:
                raise AssertionError(f"circular rows: {[n.targets for n in pending]}")
        return ordered

    def _with_lines(self, node: Node, form: Form) -> Node:
        """Lines of a linear row: its law terms, or all its terms where bases are combined per variant."""
        target = node.targets[0]
        row = self._linear_wanted().get(target)
        if row is None or node.lines:
            return node
        laws = self.model.moments.laws
        if form == "whole":
            terms = [f"{c} * {b}[k]" for c, b in row.terms if b in laws]
            first = not row.constant and len(terms) == len(row.terms)
        else:
            terms = [f"{c} * {b if b in laws else 'bas_' + b}[k]" if b != "one" else c for c, b in row.terms]
            terms = [row.constant, *terms] if row.constant else terms
            terms, first = terms or ["zero"], True
        if not terms:
            return node._replace(lines=())
        sign = "=" if first else "+="
        return node._replace(lines=("for k in range(n):", f"    {target}[k] {sign} {' + '.join(terms)}"))

    def _variant_level(self) -> set[str]:
        """Rows and numbers that differ between variants of one shape."""
        loads = {s for s, slot in self.model.program.slots.items() if slot.role == "load"}
        found = set(self._linear_wanted())
        grown = True
        while grown:
            grown = False
            for node in self.nodes:
                depends = node.needs & (found | loads)
                if depends and not found.issuperset(node.targets):
                    found.update(node.targets)
                    grown = True
        return found

    def _outputs(self, form: Form, per_variant: set[str]) -> list[str]:
        lines = []
        for i, name in enumerate(self.summaries):
            result = self.analyses.results[name]
            lines.append(f"values[v, {i}] = {result.value.replace('$', '')}")
            lines.append(f"errors[v, {i}] = {result.error.replace('$', '')} + rounding * abs(values[v, {i}])")
        for i, field in enumerate(self.fields):
            row = row_of(self.model, field)
            if form == "factorised" and row not in per_variant:
                lines += ["for k in range(n):", f"    fields[{i}, v, k] = {row}[k]"]
        lines.append("doubts[v] = doubt")
        check = " + ".join(f"mean_of({row_of(self.model, field)})" for field in self.fields)
        lines.append(f"checks[v] = {check or 'zero'}")
        return lines

    def _rows(self, text: str, form: Form, per_variant: set[str]) -> dict[str, str]:
        """Where each row is kept: in the fields asked, or in scratch."""
        homes: dict[str, str] = {}
        for i, field in enumerate(self.fields):
            row = row_of(self.model, field)
            if form == "whole" or row in per_variant:
                homes[row] = f"fields[{i}, v]"
        for row in sorted(set(_ROW.findall(text))):
            if row not in homes:
                homes[row] = "half" if row.endswith("_half") else "scratch"
        return homes

    def _slots(self, text: str) -> list[str]:
        used = set(_SLOT.findall(text))
        slots = [s for s in self.model.program.slots.values() if s.variable in used]
        return [s.variable for s in sorted(slots, key=lambda s: s.role != "shape")]

    def _diagnosis(self, groups: tuple[str, ...]) -> list[str]:
        """Position by position: the first group that can't be assembled, else the one nearest to singular."""
        sines = [self.model.mechanism.sines[g] for g in groups]
        lines = []
        steps = [s.line for s in self.model.program.needed(sines)]
        text = "\n".join(steps)
        lines += ["q = nodes[k]"] if re.search(r"\bq\b", text) else []
        lines += [f"{f}_q = {f}_nodes[k]" for f in ("cos", "sin") if re.search(rf"\b{f}_q\b", text)]
        lines += steps
        for i, sine in enumerate(sines):
            lines += [
                f"if math.isnan({sine}):",
                f"    least, group, place = -one, {i}, k",
                "    break",
                f"if abs({sine}) < least:",
                f"    least, group, place = abs({sine}), {i}, k",
            ]
        return lines


def describe(steps: Iterable[Step]) -> dict[str, list[str]]:
    """Which levels (position, velocity, acceleration) of which subjects a set of steps holds."""
    found: dict[str, list[str]] = {}
    for step in steps:
        levels = found.setdefault(step.subject, [])
        if step.level not in levels:
            levels.append(step.level)
    return found
