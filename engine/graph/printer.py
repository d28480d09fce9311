"""Print nodes as the text of a function: straight-line arithmetic at one position, and the loops around it.

There are two orders of loops. Functions in lanes fill a tile of positions × lanes, with one variant in each lane;
summaries are computed from them. Functions over positions fill the rows of one variant after another; kept fields are
computed from them. Compilers and people read the printed text; this program never parses it.
"""

from collections.abc import Iterable, Mapping, Sequence

from engine.compiling.blocks import LANES
from engine.graph.nodes import (
    Application,
    Constant,
    Found,
    Given,
    Held,
    LawResult,
    Node,
    Number,
    NumberTable,
    Operation,
    Position,
    Stage,
    Sum,
    TableMemory,
    name_of,
    reached,
)

# Maximum depth of an expression; deeper subexpressions get a name.
DEEPEST = 5
# Up to this many rows at arbitrary distances the compiler recognises as separate; more are filled at a fixed distance
# first.
FEW_ROWS = 4
# Positions filled at a fixed distance before they are copied: few, so that the next ones are computed while these are
# written to memory.
CHUNK = 16

# Names used around the statements: loop variables, arguments, modules.
_TAKEN = {"P", "T", "apart", "c", "cos_q", "dtype", "first", "i", "k", "l", "last", "looked_up", "math", "n", "np", "p"}
_TAKEN |= {"positions", "q"}
_TAKEN |= {"row", "rows", "sin_q", "t", "tile", "v", *(f"row{c}" for c in range(FEW_ROWS))}


class Statements:
    """Statements that compute nodes at one position.

    Parameters
    ----------
    outputs : sequence of Node
    stage : Stage
        Nodes that change less often are read from the numbers.
    inline_held : bool
        Whether held nodes are computed at the position itself instead of being read.
    looked_up : sequence of Node
        Nodes that were computed before and are read.
    taken : iterable of str
        Names used by other statements of the function.

    Attributes
    ----------
    statements : list of str
    values : list of str
        Expression for each output.
    reads : dict of Node to str
        Name of each number that the statements read.
    tables : dict of Node to str
        Name of the index at which each table of numbers begins; `apart` is the distance between its entries.
    positions : list of str
        Those of "q", "cos_q" and "sin_q" that are read.
    laws : list of callable
        Laws that are called.
    taken : set of str
        All names in use, including those of other statements.
    """

    def __init__(
        self,
        outputs: Sequence[Node],
        stage: Stage,
        inline_held: bool = True,
        looked_up: Sequence[Node] = (),
        taken: Iterable[str] = (),
    ) -> None:
        self._stage, self._inline_held, self._looked_up = stage, inline_held, frozenset(looked_up)
        self.statements: list[str] = []
        self.reads: dict[Node, str] = {}
        self.tables: dict[Node, str] = {}
        self.positions: list[str] = []
        self.laws: list = []
        self.taken = {*_TAKEN, *taken}
        self._counts: dict[str, int] = {}
        self._texts: dict[Node, str] = {}
        self._depth: dict[Node, int] = {}
        order = reached(outputs, self._is_leaf)
        # Laws are functions of the module, so their names are taken.
        self.taken.update(name_of(node.law) for node in order if isinstance(node, Application))
        self._uses = _count_uses(order, outputs, self._is_leaf)
        for node in order:
            self._write(node)
        self.values = [self._texts[node] for node in outputs]

    def _is_leaf(self, node: Node) -> bool:
        if isinstance(node, (Constant, TableMemory, Position)) or node in self._looked_up:
            return True
        if self._stage == Stage.STATE:
            return node.stage < Stage.STATE or isinstance(node, Given)
        if isinstance(node, Held):
            return not self._inline_held
        if isinstance(node, (Number, NumberTable, Found, Given)):
            return True
        # Results of held nodes or given numbers alone have no row: they are computed where they are used.
        return node.stage < self._stage and node.stage not in (Stage.VARIANT, Stage.PANEL)

    def _write(self, node: Node) -> None:
        match node:
            case Constant():
                self._texts[node] = repr(node.value)
            case TableMemory():
                self._texts[node] = "T"
            case Position() if self._stage != Stage.STATE:
                self._texts[node] = node.which
                self.positions.append(node.which)
            case NumberTable():
                begin = self.tables[node] = self._name(node)
                self._texts[node] = f"p, {begin}, apart"
            case _ if self._is_leaf(node):
                self._texts[node] = self.reads[node] = self._name(node)
            case Held():
                self._texts[node] = self._texts[node.operands[0]]
            case Application():
                self._call(node)
            case LawResult(index=None):
                self._texts[node] = self._texts[node.application]
            case LawResult():
                pass
            case Operation() | Sum():
                self._compute(node)

    def _name(self, node: Node) -> str:
        wanted = "".join(c if c.isalnum() else "_" for c in node.label).strip("_")
        wanted = wanted if wanted[:1].isalpha() and len(wanted) <= 40 else "x"
        # All lower counts are taken, so thousands of nodes of one label need no repeated search.
        count = self._counts.get(wanted, 1)
        name = wanted if count == 1 else f"{wanted}{count}"
        while name in self.taken:
            count += 1
            name = f"{wanted}{count}"
        self._counts[wanted] = count
        self.taken.add(name)
        return name

    def _call(self, node: Application) -> None:
        if node.law not in self.laws:
            self.laws.append(node.law)
        arguments = node.arguments(self._texts[o] for o in node.operands)
        texts = [f"({', '.join(a)})" if isinstance(a, tuple) else a for a in arguments]
        call = f"{name_of(node.law)}({', '.join(texts)})"
        results = {r.index: r for r in self._uses.get(node, ())}
        if None in results:
            self._texts[node] = name = self._name(results[None] if results[None].label else node)
            self.statements.append(f"{name} = {call}")
            return
        count = max(results) + 1
        targets = []
        for i in range(node.graph.results_of(node.law)):
            if i in results:
                self._texts[results[i]] = self._name(results[i])
                targets.append(self._texts[results[i]])
            else:
                targets.append("_")
        assert count <= len(targets)
        self.statements.append(f"{', '.join(targets)} = {call}")

    def _compute(self, node: Operation | Sum) -> None:
        if isinstance(node, Sum):
            products = [
                self._texts[c] if b is node.graph.one else f"{self._texts[c]} * {self._texts[b]}" for c, b in node.terms
            ]
            text = " + ".join(products)
        else:
            operands = [self._texts[o] for o in node.operands]
            if node.symbol == "sqrt":
                text = f"math.sqrt({operands[0]})"
            elif node.symbol == "neg":
                text = f"(-{operands[0]})"
            elif node.symbol == "abs":
                text = f"abs({operands[0]})"
            else:
                text = f"({operands[0]} {node.symbol} {operands[1]})"
        depth = 1 + max((self._depth.get(o, 0) for o in node.operands), default=0)
        if len(self._uses.get(node, ())) > 1 or node.label or depth > DEEPEST or isinstance(node, Sum):
            name = self._name(node)
            # The outer parentheses of a sum may belong to its first and last terms.
            whole = text[0] == "(" and not isinstance(node, Sum)
            self.statements.append(f"{name} = {text.removeprefix('(').removesuffix(')') if whole else text}")
            text, depth = name, 0
        self._texts[node], self._depth[node] = text, depth


def _lookup_results(outputs: Sequence[Node]) -> list[Node]:
    """Results of laws that look up numbers of the variant by index, and of the laws that find the index.

    They are computed first, in a loop of their own: loads from computed addresses would keep the compiler from
    vectorising everything else. Index and interpolation must come from the same evaluation, so that they agree at the
    ends of an interval.
    """
    results = [node for node in reached(outputs) if isinstance(node, LawResult)]
    looks = {r.application for r in results if any(isinstance(o, NumberTable) for o in r.application.operands)}
    finds = {o.application for look in looks for o in look.operands if isinstance(o, LawResult)}
    return [node for node in results if node.application in looks | finds]


def _count_uses(order: Iterable[Node], outputs: Iterable[Node], is_leaf: object) -> dict[Node, list]:
    """Map each node to the nodes that use it; an output counts as a use of itself."""
    uses: dict[Node, list] = {}
    for node in order:
        if not is_leaf(node):
            for operand in node.operands:
                uses.setdefault(operand, []).append(node)
    for node in outputs:
        uses.setdefault(node, []).append(node)
    return uses


def in_lanes(
    doc: str,
    outputs: Sequence[Node],
    rows: Mapping[Node, int],
    stage: Stage,
    positions: int | None,
    inline_held: bool = True,
) -> tuple[str, list]:
    """Print a function that fills a tile, lanes innermost.

    Parameters
    ----------
    doc : str
        Docstring of the function.
    outputs : sequence of Node
        Rows of the tile.
    rows : mapping of Node to int
        Row of each number in P.
    stage : Stage
        Stage of the outputs; nodes that change less often are read from P.
    positions : int or None
        Room of the tile for positions. A constant lets compilers infer that the tile's rows don't overlap. If None,
        the room varies, and rows are copied from an array where the compiler can infer it.
    inline_held : bool
        Whether held nodes are computed at each position instead of being read from P.

    Returns
    -------
    text : str
    laws : list of callable
        Functions that the text calls.
    """
    looked_up = _lookup_results(outputs) if stage != Stage.STATE else []
    before = Statements(looked_up, stage, inline_held)
    body = Statements(outputs, stage, inline_held, looked_up, before.taken if looked_up else ())
    used = [which for which in ("q", "cos_q", "sin_q") if which in (*body.positions, *before.positions)]
    places = {node: f"looked_up[{i * LANES} + l]" for i, node in enumerate(looked_up)}
    reads = [f"{text} = {places.get(n) or f'p[{rows[n] * LANES} + l]'}" for n, text in body.reads.items()]
    lines = ["def fill(P, T, q, cos_q, sin_q, tile):", f'    """{doc}"""', "    p = flat(P)"]
    lines += [f"    {which}_at = flat({which})" for which in used]
    at = [f"i = k * {LANES} + l", *(f"{which} = {which}_at[i]" for which in used)]
    if looked_up:
        lines += [f"    apart = {LANES}", f"    looked_up = np.empty({len(looked_up) * LANES})"]
    if positions is None:
        lines += [f"    t, positions = np.empty({len(outputs) * LANES}), q.shape[0]"]
        lines += ["    for k in range(positions):"]
    else:
        lines += ["    t = flat(tile)", f"    for k in range({'q.shape[0]' if positions > 1 else 1}):"]
    if looked_up:
        first = [*at, *(f"{text} = p[{rows[n] * LANES} + l]" for n, text in before.reads.items())]
        first += [f"{text} = {rows[n.operands[0]] * LANES} + l" for n, text in before.tables.items()]
        first += before.statements
        first += [f"{places[node]} = {value}" for node, value in zip(looked_up, before.values, strict=True)]
        lines += [f"        for l in range({LANES}):", *(f"            {line}" for line in first)]
    step, place = (LANES, "l") if positions is None else (positions * LANES, "i")
    inner = [*at, *reads, *body.statements]
    inner += [f"t[{c * step} + {place}] = {value}" for c, value in enumerate(body.values)]
    lines += [f"        for l in range({LANES}):", *(f"            {line}" for line in inner)]
    if positions is None:
        lines += [f"        for c in range({len(outputs)}):", f"            for l in range({LANES}):"]
        lines += [f"                tile[c, k, l] = t[c * {LANES} + l]"]
    return "\n".join(lines) + "\n", list(dict.fromkeys([*before.laws, *body.laws]))


def over_positions(outputs: Sequence[Node], rows: Mapping[Node, int]) -> tuple[str, list]:
    """Print a function that fills rows over the positions of one variant.

    Its arguments are the numbers of the variant, T, the positions with their cosines and sines, the index of the
    variant, and the rows of all variants (outputs, variants, positions). The parameters are those of `in_lanes`.
    """
    looked_up = _lookup_results(outputs)
    before = Statements(looked_up, Stage.POSITION)
    body = Statements(outputs, Stage.POSITION, looked_up=looked_up, taken=before.taken if looked_up else ())
    used = dict.fromkeys([*before.positions, *body.positions])
    lines = ["def fill(p, T, q, cos_q, sin_q, v, rows):", '    """Fill rows over the positions of one variant."""']
    lines += ["    p = flat(p)", *(f"    {which}_at = flat({which})" for which in used)]
    places = {node: f"looked_up[{i * CHUNK} + k]" for i, node in enumerate(looked_up)}
    lines += [f"    {text} = p[{rows[node]}]" for node, text in body.reads.items() if node not in places]
    if len(outputs) <= FEW_ROWS and not looked_up:
        inner = [*(f"{which} = {which}_at[k]" for which in used), *body.statements]
        inner += [f"row{c}[k] = {value}" for c, value in enumerate(body.values)]
        lines += [f"    row{c} = rows[{c}, v]" for c in range(len(outputs))]
        lines += ["    for k in range(rows.shape[2]):", *(f"        {line}" for line in inner)]
        return "\n".join(lines) + "\n", body.laws
    at = [f"{which} = {which}_at[first + k]" for which in used]
    inner = [*at, *(f"{body.reads[n]} = {place}" for n, place in places.items() if n in body.reads), *body.statements]
    inner += [f"t[{c * CHUNK} + k] = {value}" for c, value in enumerate(body.values)]
    first = []
    if looked_up:
        lines += ["    apart = 1", f"    looked_up = np.empty({len(looked_up) * CHUNK})"]
        first = [*at, *(f"{text} = p[{rows[n]}]" for n, text in before.reads.items())]
        first += [f"{text} = {rows[n.operands[0]]}" for n, text in before.tables.items()]
        first += before.statements
        first += [f"{places[node]} = {value}" for node, value in zip(looked_up, before.values, strict=True)]
        first = ["        for k in range(n):", *(f"            {line}" for line in first)]
    lines += [
        f"    t = np.empty({len(outputs) * CHUNK})",
        f"    for first in range(0, rows.shape[2], {CHUNK}):",
        f"        n = min({CHUNK}, rows.shape[2] - first)",
        *first,
        "        for k in range(n):",
        *(f"            {line}" for line in inner),
        f"        for c in range({len(outputs)}):",
        "            row = rows[c, v, first : first + n]",
        "            for k in range(n):",
        f"                row[k] = t[c * {CHUNK} + k]",
    ]
    return "\n".join(lines) + "\n", list(dict.fromkeys([*before.laws, *body.laws]))
