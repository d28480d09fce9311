"""Functions printed as LLVM's instructions: their text, and how compiled code passes arrays to them."""

from collections.abc import Callable, Iterable
from typing import NamedTuple

# Arguments of laws that are neither a float nor a tuple of floats.
MEMORY, NUMBERS = "all tables", "numbers of the variant"
_ARGUMENTS = {MEMORY: "ptr, ptr, i64, i64, ptr, i64, i64", NUMBERS: "ptr, i64, i64"}
# Types of the numbers in the rows.
STORED = {"tile": "double", "float64": "double", "float32": "float"}

_TYPES = """
%vector = type { ptr, ptr, i64, i64, ptr, [1 x i64], [1 x i64] }
%matrix = type { ptr, ptr, i64, i64, ptr, [2 x i64], [2 x i64] }
%cube = type { ptr, ptr, i64, i64, ptr, [3 x i64], [3 x i64] }
"""
_TILE = """
define ptr @fill(%matrix %P, %vector %T, %matrix %q, %matrix %cos_q, %matrix %sin_q, %cube %tile) {
  %.rows = extractvalue %cube %tile, 4
  %.positions = extractvalue %matrix %q, 5, 0
  %.p = extractvalue %matrix %P, 4
  %.q = extractvalue %matrix %q, 4
  %.cos_q = extractvalue %matrix %cos_q, 4
  %.sin_q = extractvalue %matrix %sin_q, 4
"""
_ROWS = """
define ptr @fill(%vector %p, %vector %T, %vector %q, %vector %cos_q, %vector %sin_q, i64 %variant, %cube %tile) {
  %.all_rows = extractvalue %cube %tile, 4
  %.positions = extractvalue %cube %tile, 5, 2
  %.own = mul nsw i64 %variant, %.positions
  %.rows = getelementptr KIND, ptr %.all_rows, i64 %.own
  %.p = extractvalue %vector %p, 4
  %.q = extractvalue %vector %q, 4
  %.cos_q = extractvalue %vector %cos_q, 4
  %.sin_q = extractvalue %vector %sin_q, 4
"""
# From there on, pointers to the numbers, to all tables and their size, to the positions with cosine and sine, and to
# the first row to be filled; the number of positions, and the distance from row to row.
_PASSED = """  %.T = extractvalue %vector %T, 4
  %.size = extractvalue %vector %T, 5, 0
  %.room = extractvalue %cube %tile, 5, 1
  %.wide = extractvalue %cube %tile, 5, 2
  %.distance = mul nsw i64 %.room, %.wide
  call void @fill_rows(ptr %.p, ptr %.T, i64 %.size, ptr %.q, ptr %.cos_q, ptr %.sin_q, ptr %.rows,
    i64 %.positions, i64 %.distance)
  ret ptr null
}

define internal void @fill_rows(ptr noalias %.p, ptr noalias %.T, i64 %.size, ptr noalias %.q, ptr noalias %.cos_q,
    ptr noalias %.sin_q, ptr noalias %.rows, i64 %.positions, i64 %.distance) {
"""
_TAIL = """  ret void
}

declare double @llvm.sqrt.f64(double)
declare double @llvm.fabs.f64(double)
declare i64 @llvm.smin.i64(i64, i64)
!0 = distinct !{}
!1 = distinct !{!1, !{!"llvm.loop.parallel_accesses", !0}}
"""


class Call(NamedTuple):
    """A law that a function calls.

    Attributes
    ----------
    name : str
        By which it is called; a law has one for each set of types of its arguments.
    law : callable
    arguments : tuple of int or str
        The number of floats of an argument that is a tuple, 0 for a float, MEMORY or NUMBERS.
    """

    name: str
    law: Callable
    arguments: tuple[int | str, ...]

    @property
    def declaration(self) -> str:
        """The law as Numba compiles it: with pointers to its results and to an exception, which no law raises."""
        types = [", ".join(["double"] * (of or 1)) if isinstance(of, int) else _ARGUMENTS[of] for of in self.arguments]
        return f"declare i32 @{self.name}({', '.join(['ptr, ptr', *types])})\n"


class PrintedCode(NamedTuple):
    """A printed function.

    Attributes
    ----------
    kind : {"tile", "float64", "float32"}
        Whether it fills a tile, positions by lanes, or the rows of one variant, stored as such numbers.
    text : str
        A module with the function `fill`.
    calls : tuple of Call
    """

    kind: str
    text: str
    calls: tuple[Call, ...]

    @classmethod
    def of(cls, kind: str, doc: str, lines: list[str], calls: Iterable[Call]) -> "PrintedCode":
        """The function whose loops are given, described by `doc`."""
        head = _TILE if kind == "tile" else _ROWS.replace("KIND", STORED[kind])
        body = "\n".join(line if line.endswith(":") else f"  {line}" for line in lines)
        declared = "".join(call.declaration for call in calls)
        return cls(kind, f"; {doc}\n{_TYPES}{head}{_PASSED}{body}\n{_TAIL}{declared}", tuple(calls))
