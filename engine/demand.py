"""What the asked results need: from their expressions back to rows, and from rows back to the mathematics.

Names that this package makes carry a prefix with two underscores (`row__`, `lin__`, …); the names of a scene
can't hold two in a row, so they never meet.

- `row__V`: the program's variable V at every position;
- `lin__F`: a field that is linear in the loads; `bas__V`: one of its bases, `law__A` an action's law;
- `wrk__B`: the work of a basis;
- `ang__L`: the continuous angle of a link;
- `…_half`: the same at every second position.
"""

import re
from collections.abc import Iterable
from typing import NamedTuple

from engine.analyses import Analyses, RowStep, row_of
from engine.model import LinearRow, Model
from engine.program import Step

ROW = re.compile(r"(?<!\w)(?:row|lin|ang|law|bas|wrk)__\w+")
WORD = re.compile(r"(?<![\w.])[A-Za-z_]\w*")
HALF = "_half"


class Node(NamedTuple):
    """Lines about whole rows: what they produce and what they need. A linear row's lines depend on the form."""

    targets: tuple[str, ...]
    needs: frozenset[str]
    lines: tuple[str, ...]


def linear_name(field: str) -> str:
    """Name of the row of a field that is linear in the loads."""
    return "lin__" + field.replace(".", "__")


class Demand:
    """What the asked fields and summaries of a model need.

    Attributes
    ----------
    nodes : tuple of Node
        Everything about whole rows, each after what it needs.
    linear : dict of str to LinearRow
        Linear rows needed, by the name of the row.
    bases : frozenset of str
        Variables of the program that linear rows combine.
    row_variables : frozenset of str
        Variables of the program needed as rows.
    steps : tuple of Step
        Per-position steps, all that the above depends on.
    groups : tuple of str
        Structural groups that those evaluate, in order.
    """

    def __init__(self, model: Model, analyses: Analyses, fields: list[str], summaries: list[str]) -> None:
        self.model, self.analyses = model, analyses
        self.nodes, wanted = self._reach(self._asked(fields, summaries))
        self.linear: dict[str, LinearRow] = {
            linear_name(f): row for f, row in model.linear.items() if linear_name(f) in wanted
        }
        laws = model.moments.laws
        bases = {basis for row in self.linear.values() for _, basis in row.terms if basis not in laws}
        self.bases = frozenset(bases - {"one"})
        produced = {t for node in self.nodes for t in node.targets}
        rows = {name for name in wanted if name.startswith("row__") and name not in produced}
        self.row_variables = frozenset(name.removeprefix("row__") for name in rows)
        self.steps = tuple(self._with_sines(self.bases | self.row_variables))
        made = {t for step in self.steps for t in step.targets}
        self.groups = tuple(g for g, sine in model.mechanism.sines.items() if sine in made)

    def _asked(self, fields: list[str], summaries: list[str]) -> set[str]:
        names = {row_of(self.model, field) for field in fields}
        for name in summaries:
            result = self.analyses.results[name]
            names.update(WORD.findall(f"{result.value} {result.error}".replace("$", "")))
        return names

    def _reach(self, wanted: set[str]) -> tuple[tuple[Node, ...], set[str]]:
        """Nodes that the wanted names depend on, with the halving of rows, and all names met on the way."""
        producers = {target: node for node in self._every_node() for target in node.targets}
        reached: list[Node] = []
        pending = set(wanted)
        seen: set[str] = set()
        while pending:
            name = pending.pop()
            seen.add(name)
            node = producers.get(name)
            if node is None and name.endswith(HALF) and ROW.fullmatch(name):
                whole = name.removesuffix(HALF)
                node = Node((name,), frozenset({whole}), (f"halve({whole}, {name})",))
            if node is not None and node not in reached:
                reached.append(node)
                pending |= node.needs - seen
        return _in_order(reached), seen

    def _every_node(self) -> list[Node]:
        nodes = [node for step in self.analyses.steps for node in _at_both_resolutions(step)]
        for law in self.model.moments.laws.values():
            needs = {f"row__{r}" for r in law.rows} | set(WORD.findall(law.expression))
            lines = ("for k in range(n):", f"    {law.row}[k] = {law.expression}")
            nodes.append(Node((law.row,), frozenset(needs), lines))
        for field, row in self.model.linear.items():
            needs = {word for term in row.terms for word in WORD.findall(" ".join(term))}
            needs |= {row.constant} if row.constant else set()
            nodes.append(Node((linear_name(field),), frozenset(needs), ()))
        return nodes

    def _with_sines(self, asked: frozenset[str]) -> list[Step]:
        """Steps of the asked variables, and the transmission quality of every group that takes part."""
        program, sines = self.model.program, self.model.mechanism.sines
        subjects = {step.subject for step in program.needed(asked)}
        taking_part = {
            sine
            for sine in sines.values()
            if next(step for step in program.steps if sine in step.targets).subject in subjects
        }
        return program.needed(asked | taking_part)

    def of_variant(self) -> set[str]:
        """Rows and numbers that differ between variants of one shape: whatever depends on a load."""
        loads = {s for s, slot in self.model.program.slots.items() if slot.role == "load"}
        found = set(self.linear)
        for node in self.nodes:
            if node.needs & (found | loads):
                found.update(node.targets)
        return found


def _at_both_resolutions(step: RowStep) -> list[Node]:
    """A row step at all positions and at every second one."""
    marks = ("", HALF) if any("$" in target for target in step.targets) else ("",)
    found = []
    for mark in marks:
        targets = tuple(t.replace("$", mark) for t in step.targets)
        needs = frozenset(n.replace("$", mark) for n in step.needs) - set(targets)
        found.append(Node(targets, needs, (step.statement.replace("$", mark),)))
    return found


def _in_order(nodes: list[Node]) -> tuple[Node, ...]:
    """Nodes each after what it needs; of several orders always the same one."""
    pending = sorted(nodes, key=lambda node: node.targets)
    producible = {t for node in nodes for t in node.targets}
    done: set[str] = set()
    ordered: list[Node] = []
    while pending:
        ready = next(node for node in pending if not (node.needs & producible) - done)
        pending.remove(ready)
        ordered.append(ready)
        done.update(ready.targets)
    return tuple(ordered)


def describe(steps: Iterable[Step]) -> dict[str, list[str]]:
    """Which levels (position, velocity, acceleration) of which subjects a set of steps holds."""
    found: dict[str, list[str]] = {}
    for step in steps:
        levels = found.setdefault(step.subject, [])
        if step.level not in levels:
            levels.append(step.level)
    return found
