"""Superposition of loads: over one shape of motion the work of a cycle is linear in the loads, as the moment is.

Mean, work W(φ) and jumps of each basis of the reduced moment are computed once for the shape; a variant's own are
their sums. Only the bound on hidden jumps loses by it: magnitudes add up, where jumps might cancel.
"""

from typing import NamedTuple

from engine.demand import HALF, Demand, Node

MOMENT = "lin__reduced_moment"
USEFUL = "lin__useful_moment"


class Superposed(NamedTuple):
    """Lines for the shape, and the nodes that remain for each variant."""

    shape_lines: tuple[str, ...]
    nodes: tuple[Node, ...]


def superpose(demand: Demand, outputs: str) -> Superposed:
    """Replace the passes over each variant's moment by sums over the bases of its shape.

    Parameters
    ----------
    demand : Demand
    outputs : str
        Lines that write the results, which may use the moment's row themselves.
    """
    targets = {t for node in demand.nodes for t in node.targets}
    laws = demand.model.moments.laws
    terms = {
        row: [(c, b if b in laws else f"bas__{b}") for c, b in demand.linear[row].terms]
        for row in (MOMENT, USEFUL)
        if row in demand.linear
    }
    if "mean_moment" not in targets or MOMENT not in terms:
        return Superposed((), demand.nodes)
    sums = {
        target: _sum(target, terms) for target in targets if _kind(target) in ("mean_moment", "useful", "row__work")
    }
    jumps = " + ".join(f"abs({c}) * rough__{b}" for c, b in terms[MOMENT] if b != "bas__one")
    sums["doubt"] = f"doubt = 0.5 * h * ({jumps or 'zero'})"
    nodes = [_replaced(node, sums) for node in demand.nodes]
    used = {name for node in nodes for name in node.needs} | {r for r in terms if r in outputs}
    dropped = {row + mark for row in terms for mark in ("", HALF)} - used
    kept = tuple(node for node in nodes if not dropped.issuperset(node.targets))
    bases = dict.fromkeys(b for row in terms.values() for _, b in row if b != "bas__one")
    return Superposed(tuple(line for b in bases for line in _of_shape(b, targets)), kept)


def _kind(target: str) -> str:
    return target.removesuffix(HALF)


def _sum(target: str, terms: dict[str, list[tuple[str, str]]]) -> str:
    """Line that makes a variant's number or row from those of the bases."""
    mark = HALF if target.endswith(HALF) else ""
    row = USEFUL if _kind(target) == "useful" else MOMENT
    if _kind(target) == "row__work":
        total = " + ".join(f"{c} * wrk__{b}{mark}[k]" for c, b in terms[row] if b != "bas__one") or "zero"
        return f"for k in range({target}.shape[0]):\n    {target}[k] = {total}"
    total = " + ".join(f"{c} * mean__{b}{mark}" if b != "bas__one" else c for c, b in terms[row]) or "zero"
    return f"{target} = {total}"


def _replaced(node: Node, sums: dict[str, str]) -> Node:
    line = sums.get(node.targets[0])
    if line is None:
        return node
    needs = frozenset(n for n in node.needs if _kind(n) not in (MOMENT, USEFUL, "mean_moment"))
    return Node(node.targets, needs, tuple(line.split("\n")))


def _of_shape(basis: str, targets: set[str]) -> list[str]:
    """Mean, work and jumps of one basis, at the resolutions that are asked."""
    lines = [f"rough__{basis} = roughness({basis}, True)"] if "doubt" in targets else []
    for mark in ("", HALF):
        if f"mean_moment{mark}" not in targets:
            continue
        if mark:
            lines.append(f"halve({basis}, {basis}{mark})")
        lines.append(f"mean__{basis}{mark} = mean_of({basis}{mark})")
        if f"row__work{mark}" in targets:
            lines.append(f"cumulative_work({basis}{mark}, mean__{basis}{mark}, h{mark}, wrk__{basis}{mark})")
    return lines
