"""Print nodes as LLVM's instructions: straight-line arithmetic at one position, and the loops around it.

There are two orders of loops. Functions in lanes fill a tile of positions × lanes, with one variant in each lane;
summaries are computed from them. Functions over positions fill the rows of one variant after another; kept fields are
computed from them. Numba compiles the laws, but not the printed code: it would spend most of its time on finding
that thousands of names are numbers.

Rows don't overlap and no position depends on another, so the loops are declared parallel: the compiler computes several
lanes or positions by one instruction without proving that it may.
"""

import struct
from collections.abc import Iterable, Mapping, Sequence

from engine.compiling.blocks import LANES
from engine.compiling.decorators import RULES
from engine.compiling.printed_code import MEMORY, NUMBERS, STORED, Call, PrintedCode
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

# Positions for which numbers are looked up before the curves are computed there.
CHUNK = 16

_RULES = " ".join(sorted(RULES))
_OPERATIONS = {
    "+": f"fadd {_RULES} double {{}}, {{}}",
    "-": f"fsub {_RULES} double {{}}, {{}}",
    "*": f"fmul {_RULES} double {{}}, {{}}",
    "/": f"fdiv {_RULES} double {{}}, {{}}",
    "neg": f"fneg {_RULES} double {{}}",
    "sqrt": f"call {_RULES} double @llvm.sqrt.f64(double {{}})",
    "abs": "call double @llvm.fabs.f64(double {})",
}
# Declares that an access depends on none in another turn of its loop.
_APART = "!llvm.access.group !0"


class Instructions:
    """Instructions that compute nodes at one position. Names that begin with a point belong to no node.

    Parameters
    ----------
    outputs : sequence of Node
    stage : Stage
        Nodes that change less often are read from the numbers.
    inline_held : bool
        Whether held nodes are computed at the position itself instead of being read.
    apart : int
        Distance between the numbers of a table.
    before : Instructions, optional
        Instructions of the same function whose outputs these read.

    Attributes
    ----------
    outputs : sequence of Node
    lines : list of str
    operands : dict of Node to str
    reads : list of Node
        Numbers, and outputs of `before`, that are read.
    tables : list of NumberTable
    positions : list of Position
        Those that are read.
    calls : dict of (callable, tuple) to Call
        Calls of the whole function, by law and arguments.
    rooms : list of str
        Instructions that make room for the results of laws.
    """

    def __init__(
        self,
        outputs: Sequence[Node],
        stage: Stage,
        inline_held: bool,
        apart: int,
        before: "Instructions | None" = None,
    ) -> None:
        self.outputs, self._stage, self._inline_held, self._apart = outputs, stage, inline_held, apart
        self._before = frozenset(before.outputs if before else ())
        self.lines: list[str] = []
        self.operands: dict[Node, str] = {}
        self.reads: list[Node] = []
        self.tables: list[NumberTable] = []
        self.positions: list[Position] = []
        self.rooms: list[str] = []
        self._counts: dict[str, int] = before._counts if before else {}
        self.calls: dict[tuple, Call] = before.calls if before else {}
        for node in reached(outputs, self._is_leaf):
            self._write(node)

    def _is_leaf(self, node: Node) -> bool:
        if isinstance(node, (Constant, TableMemory, Position)) or node in self._before:
            return True
        if self._stage == Stage.STATE:
            return node.stage < Stage.STATE or isinstance(node, Given)
        if isinstance(node, Held):
            return not self._inline_held
        if isinstance(node, (Number, NumberTable, Found, Given)):
            return True
        # Results that depend only on held nodes or given numbers have no row: they are computed where they are used.
        return node.stage < self._stage and node.stage not in (Stage.VARIANT, Stage.PANEL)

    def _write(self, node: Node) -> None:
        match node:
            case Constant():
                self.operands[node] = f"0x{struct.pack('>d', node.value).hex()}"
            case TableMemory():
                pass
            case Held() if not self._is_leaf(node):
                self.operands[node] = self.operands[node.operands[0]]
            case Sum() if not self._is_leaf(node):
                self.operands[node] = self._sum(node)
            case _:
                name = self.operands[node] = self._name(node)
                self._compute(node, name)

    def _compute(self, node: Node, name: str) -> None:
        match node:
            case Position() if self._stage != Stage.STATE:
                self.positions.append(node)
            case NumberTable():
                self.tables.append(node)
            case _ if self._is_leaf(node):
                self.reads.append(node)
            case Application():
                self._call(node, name)
            case LawResult():
                self.lines += _at(name, self.operands[node.application], node.index or 0)
                self.lines.append(f"{name} = load double, ptr {name}.at")
            case Operation():
                operands = (self.operands[o] for o in node.operands)
                self.lines.append(f"{name} = {_OPERATIONS[node.symbol].format(*operands)}")

    def _name(self, node: Node) -> str:
        wanted = "".join(c if c.isascii() and c.isalnum() else "_" for c in node.label).strip("_")
        return f"%{self._numbered(wanted if wanted[:1].isalpha() and len(wanted) <= 40 else 'x')}"

    def _numbered(self, name: str) -> str:
        self._counts[name] = count = self._counts.get(name, 0) + 1
        return f"{name}.{count}"

    def _call(self, node: Application, room: str) -> None:
        self.rooms.append(f"{room} = alloca [{node.graph.results_of(node.law) or 1} x double]")
        kinds, given = {TableMemory: MEMORY, NumberTable: NUMBERS}, [f"ptr {room}", "ptr %.exception"]
        arguments = zip(node.sizes, node.arguments(node.operands), strict=True)
        called = node.law, tuple(kinds.get(type(operand), size) for size, operand in arguments)
        if called not in self.calls:
            self.calls[called] = Call(self._numbered(name_of(node.law)), *called)
        for operand in node.operands:
            if isinstance(operand, TableMemory):
                given.append("ptr null, ptr null, i64 %.size, i64 8, ptr %.T, i64 %.size, i64 8")
            elif isinstance(operand, NumberTable):
                given.append(f"ptr %.p, i64 {self.operands[operand]}, i64 {self._apart}")
            else:
                given.append(f"double {self.operands[operand]}")
        self.lines.append(f"call i32 @{self.calls[called].name}({', '.join(given)}), {_APART}")

    def _sum(self, node: Sum) -> str:
        """Add the products of a sum from the first to the last."""
        total = ""
        for coefficient, curve in node.terms:
            term = self.operands[coefficient]
            if curve is not node.graph.one:
                term = self._name(node)
                product = _OPERATIONS["*"].format(self.operands[coefficient], self.operands[curve])
                self.lines.append(f"{term} = {product}")
            if total:
                name = self._name(node)
                self.lines.append(f"{name} = {_OPERATIONS['+'].format(total, term)}")
                term = name
            total = term
        return total


def _lookup_results(outputs: Sequence[Node]) -> list[Node]:
    """Results of laws that look up numbers of the variant by index, and of the laws that find the index.

    They are computed first, in a separate loop: loads from computed addresses would keep the compiler from
    vectorising everything else. Index and interpolation must come from the same evaluation, so that they agree at the
    ends of an interval.
    """
    results = [node for node in reached(outputs) if isinstance(node, LawResult)]
    looks = {r.application for r in results if any(isinstance(o, NumberTable) for o in r.application.operands)}
    finds = {o.application for look in looks for o in look.operands if isinstance(o, LawResult)}
    return [node for node in results if node.application in looks | finds]


def _loop(variable: str, count: int | str, lines: Iterable[str], ending: str = "") -> list[str]:
    """A loop of a variable over 0 … count − 1; `ending` follows its last instruction."""
    return [
        f"br label %{variable}.before",
        f"{variable}.before:",
        f"br label %{variable}.head",
        f"{variable}.head:",
        f"%.{variable} = phi i64 [ 0, %{variable}.before ], [ %.{variable}.next, %{variable}.last ]",
        f"%.{variable}.more = icmp slt i64 %.{variable}, {count}",
        f"br i1 %.{variable}.more, label %{variable}.body, label %{variable}.end",
        f"{variable}.body:",
        *lines,
        f"br label %{variable}.last",
        f"{variable}.last:",
        f"%.{variable}.next = add nuw nsw i64 %.{variable}, 1",
        f"br label %{variable}.head{ending}",
        f"{variable}.end:",
    ]


def _at(name: str, array: str, *index: int | str, kind: str = "double") -> list[str]:
    """Address `name`.at of a number of an array, at the sum of one or two indices."""
    found = [f"{name}.index = add nsw i64 {index[0]}, {index[1]}"] if index[1:] else []
    return [*found, f"{name}.at = getelementptr {kind}, ptr {array}, i64 {f'{name}.index' if found else index[0]}"]


def _read(name: str, array: str, *index: int | str) -> list[str]:
    """Read a number of an array."""
    return [*_at(name, array, *index), f"{name} = load double, ptr {name}.at, {_APART}"]


class _Function:
    """A function with its loops: those that look up numbers, and those that compute everything else from them.

    Parameters
    ----------
    outputs : sequence of Node
    stage : Stage
    inline_held : bool
    rows : mapping of Node to int
        Row of each number.
    apart : int
        Distance between rows of numbers.
    room : int
        Lanes or positions for which numbers are looked up at once.
    """

    def __init__(
        self,
        outputs: Sequence[Node],
        rows: Mapping[Node, int],
        stage: Stage,
        inline_held: bool,
        apart: int,
        room: int,
    ) -> None:
        looked_up = _lookup_results(outputs) if stage != Stage.STATE else []
        self._rows, self._apart = rows, apart
        self.before = Instructions(looked_up, stage, inline_held, apart)
        self.body = Instructions(outputs, stage, inline_held, apart, self.before)
        self._places = {node: f"%.looked_up{i}" for i, node in enumerate(looked_up)}
        self.rooms = [f"{place} = alloca [{room} x double], align 64" for place in self._places.values()]
        self.rooms += [*self.before.rooms, *self.body.rooms, "%.exception = alloca ptr"]

    def numbers(self, part: Instructions, *lane: str) -> list[str]:
        """Read the numbers of the variant, of a lane if one is given."""
        lines = []
        for node in part.reads:
            if node not in self._places:
                lines += _read(part.operands[node], "%.p", *lane, self._apart * self._rows[node])
        for table in part.tables:
            begin = self._apart * self._rows[table.operands[0]]
            lines.append(f"{part.operands[table]} = add nsw i64 {begin}, {lane[0] if lane else 0}")
        return lines

    def loops(self, count: int | str, in_lanes: bool, kind: str = "double") -> list[str]:
        """The loops over lanes or positions, the first of which is %.first."""
        found = []
        for k, part in (("b", self.before), ("k", self.body)):
            if not part.outputs:
                continue
            lines = [f"%.{k}.i = add nsw i64 %.first, %.{k}"]
            for position in part.positions:
                lines += _read(part.operands[position], f"%.{position.which}", f"%.{k}.i")
            lines += self.numbers(part, f"%.{k}") if in_lanes else []
            for node in part.reads:
                lines += _read(part.operands[node], self._places[node], f"%.{k}") if node in self._places else []
            lines += part.lines
            for i, node in enumerate(part.outputs):
                name, value = f"%.{k}.out{i}", part.operands[node]
                if part is self.before:
                    lines += _at(name, self._places[node], f"%.{k}")
                else:
                    lines += _at(name, f"%.row{i}", f"%.{k}.i", kind=kind)
                if kind != "double" and part is self.body:
                    lines.append(f"{name} = fptrunc double {value} to {kind}")
                    value = name
                stored = kind if part is self.body else "double"
                lines.append(f"store {stored} {value}, ptr {name}.at, {_APART}")
            found += _loop(k, count, lines, ", !llvm.loop !1")
        return found


def in_lanes(
    doc: str,
    outputs: Sequence[Node],
    rows: Mapping[Node, int],
    stage: Stage,
    positions: int | None,
    inline_held: bool = True,
) -> PrintedCode:
    """Print a function that fills a tile, lanes innermost.

    Parameters
    ----------
    doc : str
        What it fills.
    outputs : sequence of Node
        Rows of the tile.
    rows : mapping of Node to int
        Row of each number in P.
    stage : Stage
        Stage of the outputs; nodes that change less often are read from P.
    positions : int or None
        Room of the tile for positions; None if it varies.
    inline_held : bool
        Whether held nodes are computed at each position instead of being read from P.
    """
    function = _Function(outputs, rows, stage, inline_held, LANES, LANES)
    distance = "%.distance" if positions is None else positions * LANES
    lines = [*function.rooms, *_rows_at(len(outputs), distance)]
    at = [f"%.first = mul nsw i64 %.position, {LANES}", *function.loops(LANES, True)]
    lines += _loop("position", 1 if positions == 1 else "%.positions", at)
    return PrintedCode.of("tile", doc, lines, function.body.calls.values())


def over_positions(outputs: Sequence[Node], rows: Mapping[Node, int], stored: str) -> PrintedCode:
    """Print a function that fills rows over the positions of one variant.

    Parameters
    ----------
    outputs : sequence of Node
    rows : mapping of Node to int
        Row of each number.
    stored : {"float64", "float32"}
        Type of the numbers in the rows.
    """
    kind = STORED[stored]
    function = _Function(outputs, rows, Stage.POSITION, True, 1, CHUNK)
    lines = [*function.rooms, *_rows_at(len(outputs), "%.distance", kind)]
    lines += [*function.numbers(function.before), *function.numbers(function.body)]
    if not function.before.outputs:
        lines += ["%.first = add i64 0, 0", *function.loops("%.positions", False, kind)]
        return PrintedCode.of(stored, "Rows over the positions of one variant.", lines, function.body.calls.values())
    at = [f"%.first = mul nsw i64 %.chunk, {CHUNK}", "%.left = sub nsw i64 %.positions, %.first"]
    at += [f"%.count = call i64 @llvm.smin.i64(i64 %.left, i64 {CHUNK})", *function.loops("%.count", False, kind)]
    lines += [f"%.rounded = add nsw i64 %.positions, {CHUNK - 1}", f"%.chunks = sdiv i64 %.rounded, {CHUNK}"]
    lines += _loop("chunk", "%.chunks", at)
    return PrintedCode.of(stored, "Rows over the positions of one variant.", lines, function.body.calls.values())


def _rows_at(count: int, distance: int | str, kind: str = "double") -> list[str]:
    """Pointers to rows at a distance from each other."""
    lines = []
    for i in range(count):
        lines.append(f"%.row{i}.from = mul nsw i64 {distance}, {i}")
        lines.append(f"%.row{i} = getelementptr {kind}, ptr %.rows, i64 %.row{i}.from")
    return lines
