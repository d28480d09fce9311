"""Groups of free links, found by matching constraints to freedoms.

A link has three freedoms, and a lower pair imposes two constraints. Each constraint is matched to a freedom that it can
determine. If all are matched, constraints that depend on each other cyclically form one group, and the groups are
ordered (Dulmage–Mendelsohn decomposition). Unmatched freedoms mean that links move too freely; unmatched constraints,
that they can't move.

Source: A. L. Dulmage, N. S. Mendelsohn, Coverings of bipartite graphs, Canadian Journal of Mathematics 10 (1958).
"""

from collections.abc import Iterable, Sequence

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components, maximum_bipartite_matching

from engine.scene.pairs import Pair, free_pairs
from engine.scene.scene import Problem, Scene
from engine.scene.structure.free_groups import FreeGroup

_FREEDOMS, _CONSTRAINTS = 3, 2


def next_free_group(scene: Scene, known: Iterable[str]) -> FreeGroup | None:
    """The next group of free links attached to known links only, without a smaller group in it; None if there is none.

    Parameters
    ----------
    scene : Scene
    known : iterable of str
        Links whose motion is known.
    """
    links, pairs = _waiting(scene, set(known))
    ready = [pair for pair in pairs if {pair.link, pair.other} <= {*links, *known}]
    if not ready:
        return None
    constraints = _constraints(links, ready)
    matched = maximum_bipartite_matching(constraints, perm_type="column")
    of_freedom = _partners(matched, constraints.shape[1])
    # Constraint i needs constraint j if it acts on a freedom matched to j; the last row means "no constraint".
    rows, columns = constraints.nonzero()
    nothing = constraints.shape[0]
    needed = np.where(of_freedom[columns] < 0, nothing, of_freedom[columns])
    open_rows = np.flatnonzero(matched < 0)
    rows, needed = np.append(rows, open_rows), np.append(needed, np.full(open_rows.size, nothing))
    needs = csr_array((np.ones(rows.size), (rows, needed)), shape=(nothing + 1, nothing + 1))
    count, label = connected_components(needs, directed=True, connection="strong")
    for block in range(count):
        own = np.flatnonzero(label == block)
        if nothing not in own and (label[needed[np.isin(rows, own)]] == block).all():
            within = {links[int(matched[i]) // _FREEDOMS] for i in own}
            closed = {*known, *within}
            inside = [pair for pair in ready if pair.link in closed and pair.other in closed]
            if _FREEDOMS * len(within) == own.size == _CONSTRAINTS * len(inside):
                return _named(scene, within, inside)
    return None


def _waiting(scene: Scene, known: set[str]) -> tuple[list[str], list[Pair]]:
    """Free links whose motion is still unknown, and their pairs."""
    links = [link for link in scene.links if link not in known]
    return links, [p for p in free_pairs(scene) if p.link in links or p.other in links]


def _constraints(links: Sequence[str], pairs: Sequence[Pair]) -> csr_array:
    """Incidence of the constraints of pairs and the freedoms of links."""
    found = np.zeros((_CONSTRAINTS * len(pairs), _FREEDOMS * len(links)), np.int8)
    for i, pair in enumerate(pairs):
        for j, link in enumerate(links):
            if link in (pair.link, pair.other):
                found[_CONSTRAINTS * i : _CONSTRAINTS * (i + 1), _FREEDOMS * j : _FREEDOMS * (j + 1)] = 1
    return csr_array(found)


def _named(scene: Scene, within: set[str], pairs: list[Pair]) -> FreeGroup:
    links = tuple(link for link in scene.links if link in within)
    group = FreeGroup("", links, tuple(pairs))
    return group._replace(name=f"group_of_{max(links, key=lambda link: len(group.pairs_of(link)))}")


def why_not_grouped(scene: Scene, known: Iterable[str]) -> list[Problem]:
    """Problem of the remaining free links: they move too freely, or can't move.

    Parameters
    ----------
    scene : Scene
    known : iterable of str
        Links whose motion is known.
    """
    known = set(known)
    links, pairs = _waiting(scene, known)
    if not links:
        return []
    at = f"links.{links[0]}"
    far = sorted({name for p in pairs for name in (p.link, p.other)} - {*links, *known})
    if far:
        return [(at, f"needs {', '.join(far)}, which can't be ordered either; connect those first")]
    if not pairs:
        return [(at, f"{', '.join(links)}: no joint or guide joins this to the machine; name its joints or its guide")]
    constraints = _constraints(links, pairs)
    of_constraint = maximum_bipartite_matching(constraints, perm_type="column")
    of_freedom = maximum_bipartite_matching(constraints, perm_type="row")
    unmet, free = np.flatnonzero(of_constraint < 0), np.flatnonzero(of_freedom < 0)
    if unmet.size:
        tight, held = _reached(constraints, unmet, _partners(of_constraint, constraints.shape[1]))
        words = "can't move: {links} with the pairs {pairs} are over-constrained (W = {count}, a group has 0); leave a "
        words += "pair out, or put a link between"
    else:
        held, tight = _reached(csr_array(constraints.T), free, _partners(of_freedom, constraints.shape[0]))
        words = "moves too freely: {links} with the pairs {pairs} have W = {count} degrees of freedom; join them to "
        words += "the machine by another link, joint or guide"
    named = [links[j] for j in sorted({f // _FREEDOMS for f in held})]
    own = [pairs[i].name for i in sorted({c // _CONSTRAINTS for c in tight})]
    n, p = len(named), len(own)
    count = f"3·{n} − 2·{p} = {_FREEDOMS * n - _CONSTRAINTS * p}"
    text = words.format(links=", ".join(named), pairs=", ".join(own) or "none", count=count)
    return [(f"links.{named[0]}", text)]


def _partners(of_row: np.ndarray, columns: int) -> np.ndarray:
    """Row matched to each column, from the column matched to each row; −1 if none."""
    found = np.full(columns, -1)
    found[of_row[of_row >= 0]] = np.flatnonzero(of_row >= 0)
    return found


def _reached(adjacent: csr_array, begin: np.ndarray, partner: np.ndarray) -> tuple[set[int], set[int]]:
    """Rows and columns reached by alternating paths.

    Parameters
    ----------
    adjacent : sparse array (rows, columns)
    begin : ndarray of int
        Initial rows, without a partner.
    partner : ndarray (columns,) of int
        Row matched to each column.
    """
    rows, columns = set(begin.tolist()), set()
    waiting = list(rows)
    while waiting:
        row = waiting.pop()
        for column in adjacent.indices[adjacent.indptr[row] : adjacent.indptr[row + 1]].tolist():
            columns.add(column)
            if partner[column] >= 0 and partner[column] not in rows:
                rows.add(int(partner[column]))
                waiting.append(int(partner[column]))
    return rows, columns
