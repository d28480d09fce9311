"""Superposition of loads: over one shape of motion the work of a cycle is linear in the loads, as the moment is.

Mean, work W(φ) and jumps of each basis of the reduced moment are computed once for the shape; a variant's own are
their sums. Only the bound on hidden jumps loses by it: magnitudes add up, where jumps might cancel.

Flywheel sizes need extremes of such sums alone, so they are taken from several variants side by side, and rows of
a variant are made only where something else needs them.
"""

import re
from typing import NamedTuple

from engine.equal_positions.text.demand import HALF, WORD, Demand, Node
from engine.equal_positions.text.side_by_side import ONE, SideBySide, Terms, added, side_by_side

MOMENT = "lin__reduced_moment"
USEFUL = "lin__useful_moment"
INERTIA = "lin__reduced_inertia"

_SIZES = re.compile(r"flywheel_sizes\(\w+, \w+, (.+)\)")


class Superposed(NamedTuple):
    """Lines for the shape, lines for variants side by side, and the nodes that remain for each variant."""

    shape_lines: tuple[str, ...]
    together: SideBySide | None
    nodes: tuple[Node, ...]


def superpose(demand: Demand, outputs: str, fixed: frozenset[str]) -> Superposed:
    """Replace the passes over each variant's moment by sums over the bases of its shape.

    Parameters
    ----------
    demand : Demand
    outputs : str
        Lines that write the results, which may use rows themselves.
    fixed : frozenset of str
        Loads that are the same for all variants.
    """
    targets = {t for node in demand.nodes for t in node.targets}
    terms = {row: _terms(demand, row) for row in (MOMENT, USEFUL, INERTIA) if _is_there(demand, row)}
    if "mean_moment" not in targets or MOMENT not in terms:
        return Superposed((), None, demand.nodes)
    works = demand.model.moments.works
    sums = {
        target: _sum(target, terms) for target in targets if _kind(target) in ("mean_moment", "useful", "row__work")
    }
    bases = dict.fromkeys(b for row in (MOMENT, USEFUL) for _, b in terms.get(row, ()) if b != ONE)
    lines = [line for b in bases for line in (_known if b in works else _of_shape)(b, targets)]
    others = [(c, b) for c, b in terms[MOMENT] if b not in works]
    sums |= {d: f"{d} = 0.5 * h * ({_jumps(t)})" for d, t in (("doubt", terms[MOMENT]), ("mean_doubt", others))}
    together = None
    if {"excess", f"excess{HALF}"} <= targets:
        sums |= _of_lane(demand, terms[INERTIA])
        lines += [f"mean__{b} = mean_of({b})" for b in {b: None for _, b in terms[INERTIA]} if b not in (*bases, ONE)]
        together = side_by_side(terms[INERTIA], _working(terms[MOMENT]), fixed, _asked_sizes(demand))
        lines += together.shape
    nodes = _needed([_replaced(node, sums) for node in demand.nodes], "\n".join((outputs, *lines)))
    return Superposed(tuple(lines), together, nodes)


def _is_there(demand: Demand, row: str) -> bool:
    """Whether a linear row is wanted, or what is left of it beside moments whose work is known exactly."""
    return row in demand.linear or row.replace("lin__", "lin__other_") in demand.linear


def _terms(demand: Demand, row: str) -> Terms:
    """Loads of a linear row, each with the row of its basis."""
    laws, linear = demand.model.moments.laws, demand.model.linear[row.removeprefix("lin__")]
    terms = [(c, b if b in laws or b == ONE else f"bas__{b}") for c, b in linear.terms]
    return [(linear.constant, ONE), *terms] if linear.constant else terms


def _kind(target: str) -> str:
    return target.removesuffix(HALF)


def _working(terms: Terms, mark: str = "") -> Terms:
    """Loads with the rows of their work; a constant moment does none about its mean."""
    return [(c, f"wrk__{b}{mark}") for c, b in terms if b != ONE]


def _jumps(terms: Terms) -> str:
    return added([(f"abs({c})", b) for c, b in terms if b != ONE], "rough__{}")


def _sum(target: str, terms: dict[str, Terms]) -> str:
    """Line that makes a variant's number or row from those of the bases."""
    mark = HALF if target.endswith(HALF) else ""
    row = USEFUL if _kind(target) == "useful" else MOMENT
    if _kind(target) == "row__work":
        total = added(_working(terms[row], mark), "{}[k]")
        return f"for k in range({target}.shape[0]):\n    {target}[k] = {total}"
    return f"{target} = {added(terms[row], f'mean__{{}}{mark}')}"


def _of_lane(demand: Demand, inertia: Terms) -> dict[str, str]:
    """Lines that take from a variant's lane, or from its loads, what rows would otherwise give."""
    lines = {
        "missed": "missed = missed_by_lane(kept, lane)",
        "mean_inertia": f"mean_inertia = {added(inertia, 'mean__{}')}",
    }
    for part, mark in (("WHOLE", ""), ("HALF", HALF)):
        targets = next(node.targets for node in demand.nodes if f"excess{mark}" in node.targets)
        sizes = f"sizes_of_lane(kept, {part}, lane, {_asked_sizes(demand)})"
        lines[targets[0]] = f"{', '.join(targets)} = {sizes}"
    return lines


def _asked_sizes(demand: Demand) -> str:
    """Last arguments of `flywheel_sizes`."""
    lines = next(node.lines for node in demand.nodes if "excess" in node.targets)
    return _SIZES.search(lines[0]).group(1)


def _replaced(node: Node, sums: dict[str, str]) -> Node:
    line = sums.get(node.targets[0])
    return node if line is None else Node(node.targets, frozenset(WORD.findall(line)), tuple(line.split("\n")))


def _needed(nodes: list[Node], lines: str) -> tuple[Node, ...]:
    """Nodes that other lines still depend on, in their order."""
    wanted, kept = set(WORD.findall(lines)), []
    for node in reversed(nodes):
        if wanted.intersection(node.targets):
            kept.append(node)
            wanted |= node.needs
    return tuple(kept[::-1])


def _of_shape(basis: str, targets: set[str]) -> list[str]:
    """Mean, work and jumps of one basis, at the resolutions that are asked."""
    lines = [f"rough__{basis} = jumps_of({basis})"] if targets & {"doubt", "mean_doubt"} else []
    for mark in ("", HALF):
        if f"mean_moment{mark}" not in targets:
            continue
        if mark:
            lines.append(f"halve({basis}, {basis}{mark})")
        row, work = f"{basis}{mark}", f"wrk__{basis}{mark}"
        with_work = f"row__work{mark}" in targets
        lines.append(f"mean__{row} = " + (f"mean_and_work({row}, h{mark}, {work})" if with_work else f"mean_of({row})"))
    return lines


def _known(law: str, targets: set[str]) -> list[str]:
    """The same of a law whose work is known exactly."""
    action, lines = law.removeprefix("law__"), [f"rough__{law} = jumps_of({law})"] if "doubt" in targets else []
    for mark in ("", HALF):
        if f"mean_moment{mark}" not in targets:
            continue
        lines.append(f"mean__{law}{mark} = total__{action}{mark} / (h * n)")
        if f"row__work{mark}" in targets:
            row = f"wrk__{law}{mark}"
            exact = f"pot__{action}{mark}[k] - mean__{law}{mark} * h{mark} * k"
            lines += [f"for k in range({row}.shape[0]):", f"    {row}[k] = {exact}"]
    return lines
