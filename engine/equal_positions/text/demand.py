"""What the asked results need: from their expressions back to rows, and from rows back to the mathematics.

Names that this package makes carry a prefix with two underscores (`row__`, `lin__`, …); the names of a scene
can't hold two in a row, so they never meet.

- `row__V`: the program's variable V at every position;
- `lin__F`: a field that is linear in the loads; `bas__V`: one of its bases, `law__A` an action's law;
- `val__A`: the characteristic of an action's law alone;
- `wrk__B`: the work of a basis; `pot__A` that of an action, known exactly, and `total__A` over the cycle;
- `prs__P`: the force that presses in a pair P with friction; `mrg__G` the margin of a group against jamming;
- `ang__L`: the continuous angle of a link;
- `…_half`: the same at every second position.
"""

import re
from collections.abc import Iterable
from typing import NamedTuple

from engine.equal_positions.analyses import Analyses, RowStep, row_of
from engine.equal_positions.text.program import Step
from engine.equal_positions.text.settling import Settling
from engine.machine.model import LinearRow, Model

ROW = re.compile(r"(?<!\w)(?:row|lin|ang|law|val|bas|wrk|pot|prs|mrg)__\w+")
WORD = re.compile(r"(?<![\w.])[A-Za-z_]\w*")
HALF = "_half"
SECOND = 2


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
        Per-position steps, all that the above and `late` depend on.
    late : dict of str to int
        Variables needed as rows that wait for other rows, and the number of the loop over the positions that makes
        them: the second one once the characteristics of laws are there, later ones as friction settles.
    settlings : dict of str to Settling
        Passes of friction, by each row and number that they produce.
    settled : tuple of str
        Groups whose friction is needed.
    groups : tuple of str
        Structural groups that the steps evaluate, in order.
    separable : bool
        Whether loads enter the steps nowhere, so that variants of one shape may share them.
    """

    def __init__(
        self,
        model: Model,
        analyses: Analyses,
        fields: list[str],
        summaries: list[str],
        given: frozenset[str] = frozenset(),
    ) -> None:
        self.model, self.analyses, self._given = model, analyses, given
        self.settlings = {t: s for s in model.reactions.settlings.values() for t in s.targets}
        self._loops = _loops_of(model.program.steps, self.settlings)
        self.nodes, wanted = self._reach(self._asked(fields, summaries))
        self.linear: dict[str, LinearRow] = {
            linear_name(f): row for f, row in model.linear.items() if linear_name(f) in wanted
        }
        laws = model.moments.laws
        bases = {basis for row in self.linear.values() for _, basis in row.terms if basis not in laws}
        self.bases = frozenset(bases - {"one"})
        self.late = {v: loop for v, loop in self._loops.items() if f"row__{v}" in wanted}
        self.settled = tuple(g for g, s in model.reactions.settlings.items() if wanted.intersection(s.targets))
        produced = {t for node in self.nodes for t in node.targets}
        rows = {name for name in wanted if name.startswith("row__") and name not in produced}
        self.row_variables = frozenset(name.removeprefix("row__") for name in rows)
        self.steps = tuple(self._with_sines(self.bases | self.row_variables | self.late.keys()))
        loads = {s for s, slot in model.program.slots.items() if slot.role == "load"}
        self.separable = not any(step.needs & loads for step in self.steps)
        made = {t for step in self.steps for t in step.targets}
        self.groups = tuple(g for g, sine in model.mechanism.sines.items() if sine in made)

    @property
    def first_steps(self) -> list[Step]:
        """Steps of the first loop over the positions: all that nothing waits for."""
        sines = {self.model.mechanism.sines[group] for group in self.groups}
        return self.model.program.needed(self.bases | self.row_variables | sines)

    def loop_of(self, node: Node) -> int:
        """Number of the later loop over the positions that fills the rows of a node; 0 if none does."""
        return self.late.get(node.targets[0].removeprefix("row__"), 0)

    def later_loop(self, number: int) -> list[str]:
        """Lines of a later loop at position k.

        The second one takes the steps of the first that it depends on once more; those after it read them as rows.
        """
        made = sorted(v for v, loop in self.late.items() if loop == number)
        steps, read = (self.model.program.needed(made), set()) if number == SECOND else self._last_steps(made)
        reads = [f"{name} = row__{name}[k]" for name in sorted(read)]
        return [*reads, *(step.line for step in steps), *(f"row__{v}[k] = {v}" for v in made)]

    def _last_steps(self, variables: list[str]) -> tuple[list[Step], set[str]]:
        """Steps of their own loop that some variables depend on, and variables of earlier loops that those need."""
        loop = self._loops[variables[0]]
        kept, wanted, made = [], set(variables), set()
        for step in reversed(self.model.program.steps):
            if wanted.intersection(step.targets):
                if self._loops.get(step.targets[0], 0) == loop:
                    kept.append(step)
                    wanted |= step.needs
                else:
                    made.update(wanted.intersection(step.targets))
        return kept[::-1], made

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
            node = None if name in self._given else producers.get(name)
            if node is None and name.endswith(HALF) and ROW.fullmatch(name):
                whole = name.removesuffix(HALF)
                node = Node((name,), frozenset({whole}), (f"halve({whole}, {name})",))
            if node is not None and node not in reached:
                reached.append(node)
                pending |= node.needs - seen
        return _in_order(self._merged(reached)), seen

    def _merged(self, reached: list[Node]) -> list[Node]:
        """All rows of a later loop in one node; characteristics that are rows themselves not evaluated twice."""
        nodes = {node.targets[0]: node for node in reached}
        loops = {row: self._loops.get(row.removeprefix("row__"), 0) for row in nodes}
        for number in sorted(set(loops.values()) - {0}):
            late = [nodes.pop(row) for row, loop in loops.items() if loop == number]
            targets = tuple(sorted(node.targets[0] for node in late))
            nodes[targets[0]] = Node(targets, frozenset().union(*(node.needs for node in late)), ())
        for law in self.model.moments.laws.values():
            if {law.row, law.value_row} <= nodes.keys():
                known = law.expression.replace(law.value, f"{law.value_row}[k]")
                nodes[law.row] = _law_node(law.row, known)
        return list(nodes.values())

    def _every_node(self) -> list[Node]:
        nodes = [node for step in self.analyses.steps for node in _at_both_resolutions(step)]
        for law in self.model.moments.laws.values():
            nodes += [_law_node(law.row, law.expression), _law_node(law.value_row, law.value)]
        values = _values_behind(self.model.program.steps)
        nodes += [Node((f"row__{v}",), values[v], ()) for v, loop in self._loops.items() if loop == SECOND]
        nodes += [self._settled_node(v) for v, loop in self._loops.items() if loop > SECOND]
        nodes += [_passes(settling) for settling in self.model.reactions.settlings.values()]
        for field, row in self.model.linear.items():
            needs = {word for term in row.terms for word in WORD.findall(" ".join(term))}
            needs |= {row.constant} if row.constant else set()
            nodes.append(Node((linear_name(field),), frozenset(needs), ()))
        return nodes

    def _settled_node(self, variable: str) -> Node:
        """Row of a variable that waits for friction to settle."""
        steps, read = self._last_steps([variable])
        pressing = {name for step in steps for name in step.needs if name in self.settlings}
        return Node((f"row__{variable}",), frozenset({f"row__{name}" for name in read} | pressing), ())

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


def _law_node(row: str, expression: str) -> Node:
    """A row evaluated position by position in a loop of its own."""
    return Node((row,), frozenset(WORD.findall(expression)), ("for k in range(n):", f"    {row}[k] = {expression}"))


def _passes(settling: Settling) -> Node:
    """The pressing forces of a group."""
    return Node(settling.targets, frozenset(f"row__{name}" for name in settling.inputs), ())


def _loops_of(steps: Iterable[Step], settlings: dict[str, Settling]) -> dict[str, int]:
    """Number of the loop over the positions that makes each variable which the first one can't make."""
    found: dict[str, int] = {}
    for step in steps:
        loops = [SECOND for name in step.needs if name.startswith("val__")]
        loops += [found[name] for name in step.needs & found.keys()]
        for row in step.needs & settlings.keys():
            loops.append(1 + max([SECOND, *(found.get(name, 0) for name in settlings[row].inputs)]))
        if loops:
            found |= dict.fromkeys(step.targets, max(loops))
    return found


def _values_behind(steps: Iterable[Step]) -> dict[str, frozenset[str]]:
    """Rows of characteristics on which variables depend, by each variable that does."""
    found: dict[str, frozenset[str]] = {}
    for step in steps:
        values = {name for name in step.needs if name.startswith("val__")}
        values = values.union(*(found[name] for name in step.needs & found.keys()))
        if values:
            found |= dict.fromkeys(step.targets, frozenset(values))
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
