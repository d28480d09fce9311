"""The text of a kernel's module: where rows are kept, the loops around the mathematics, the arguments."""

import re
from typing import Literal, NamedTuple

import numpy as np

from engine.equal_positions.text.superposition import SideBySide
from engine.machine.checks import MOST_POSITIONS
from engine.machine.model import Model
from engine.scene.parts import CrankInput

Form = Literal["whole", "factorised"]

# Rows that the loop over positions fills lie at a fixed distance. As a constant it tells compilers that they don't
# overlap, where they would else need more tests than they make.
ONE_LOOP = ("row__", "bas__")
# Kernels for few positions, for many, and for the most that are allowed: memory for few is at hand, that for many is
# asked of the system every time.
ROOMS = (1024, 16_384, MOST_POSITIONS)
# One more for a range with its end; an odd number of cache lines keeps rows apart in caches.
ASIDE = 8

# A group whose transmission quality falls below this is singular: about the root of the rounding error.
SINGULAR_SINE = {np.dtype(np.float64): 1e-7, np.dtype(np.float32): 1e-3}


# Passes end where no pressing force changes by more than this share: what is left, its square, is below rounding.
SETTLED = {np.dtype(np.float64): 1e-10, np.dtype(np.float32): 1e-5}
# A determinant of friction's feedback that is nothing but rounding.
JAMMED = {np.dtype(np.float64): 1e-14, np.dtype(np.float32): 1e-6}


class Lines(NamedTuple):
    """The mathematics of a kernel: the loop over positions, what follows for the shape, what for each variant."""

    positions: list[str]
    shape: list[str]
    together: SideBySide | None
    variant: list[str]

    @property
    def text(self) -> str:
        """All of it, to be searched for names."""
        together = [self.together.text] if self.together else []
        return "\n".join((*self.positions, *self.shape, *together, *self.variant))


def spacing(model: Model) -> list[str]:
    """Lines that set the first position and the spacing of positions, in the input's unit."""
    if isinstance(model.scene.input, CrankInput):
        return ["h = step", "first = nodes[0]", "h_half = h + h"]
    length = "(num__input__stop - num__input__start)"
    return [f"h = step * {length}", "first = num__input__start", "h_half = h + h"]


class KernelText:
    """Puts the lines of a kernel into a module."""

    def __init__(
        self,
        model: Model,
        form: Form,
        dtype: np.dtype,
        slots: list[str],
        fixed: frozenset[str],
        rows: dict[str, str],
        most: int,
    ) -> None:
        self.model, self.form, self.dtype = model, form, np.dtype(dtype)
        self.stride = next(room for room in ROOMS if most <= room) + ASIDE
        self.slots, self.rows = slots, rows
        # What the variants of a shape have in common is read once for all of them.
        self.shared = {s for s in slots if model.program.slots[s].role == "shape" or s in fixed}

    def tables(self, text: str) -> tuple[str, ...]:
        """Searched tables that a text uses."""
        return tuple(t for t in self.model.moments.tables if f"table__{t}_breaks" in text)

    def angle_tables(self, text: str) -> tuple[str, ...]:
        """Tables over the crank angle that a text uses."""
        return tuple(t for t in self.model.moments.angle_tables if re.search(rf"\bangle_table__{t}\b", text))

    def _table_arguments(self, text: str) -> list[str]:
        found = [
            f"table__{t}_{field}" for t in self.tables(text) for field in ("breaks", "coefficients", "start", "period")
        ]
        return found + [f"angle_table__{t}" for t in self.angle_tables(text)]

    def _numbers(self, shared: bool) -> list[str]:
        return [f"{s} = P[{i}, v]" for i, s in enumerate(self.slots) if (s in self.shared) == shared]

    def module(self, mathematics: Lines, diagnosis: list[str]) -> str:
        """Text of the module."""
        arguments = ", ".join(
            ["begin", "end", "P", "nodes", "cos_nodes", "sin_nodes", "step", "rounding"]
            + (["starts", "members"] if self.form == "factorised" else [])
            + self._table_arguments(mathematics.text)
            + ["values", "errors", "fields", "troubles", "checks"]
        )
        scratch = [r for r, home in self.rows.items() if home == "scratch"]
        half = [r for r, home in self.rows.items() if home == "half"]
        lines = [f"def kernel({arguments}):", "    n = nodes.shape[0]"]
        together = [r for r in scratch if r.startswith(ONE_LOOP)]
        lines += [f"    scratch = np.empty({len(together) * self.stride}, dtype)"]
        begins = [(r, i * self.stride) for i, r in enumerate(together)]
        lines += [f"    {r} = scratch[{begin} : {begin} + n]" for r, begin in begins]
        lines += [f"    {r} = np.empty(n, dtype)" for r in scratch if r not in together]
        lines += [f"    {r} = np.empty((n + 1) // 2, dtype)" for r in half]
        if mathematics.together:
            loads = mathematics.together.loads
            lines += [f"    kept = room_for_lanes({len(loads)})"]
            lines += [f"    lane__{load} = kept[KEPT + {i}]" for i, load in enumerate(loads)]
        lines += ["    for group in range(begin, end):"]
        lines += [f"        {line}" for line in self._inside(mathematics)]
        return "\n".join([self._head(), *lines, "", "", *self._diagnose(diagnosis), ""])

    def _inside(self, mathematics: Lines) -> list[str]:
        positions, shape, together, variant = mathematics
        direct = [f"{r} = {home}" for r, home in self.rows.items() if home not in ("scratch", "half")]
        if self.form == "whole":
            first = ["v = group", *self._numbers(True), *self._numbers(False), *spacing(self.model), *direct]
            return [*first, *positions, *shape, *variant]
        first = ["v = members[starts[group]]", *self._numbers(True), *spacing(self.model), *positions, *shape]
        each = [*self._numbers(False), *direct, *variant]
        if together is None:
            return [
                *first,
                "for member in range(starts[group], starts[group + 1]):",
                *_indented("v = members[member]", *each),
            ]
        return [
            *first,
            "for block in range(starts[group], starts[group + 1], LANES):",
            *_indented("count = min(LANES, starts[group + 1] - block)", *self._side_by_side(together)),
            *_indented("for lane in range(count):", *_indented("v = members[block + lane]", *each)),
        ]

    def _side_by_side(self, together: SideBySide) -> list[str]:
        """The pass over the cycle that several variants share; lanes left over repeat the last variant."""
        kept = [f"lane__{load}[lane] = {load}" for load in together.loads]
        return [
            "lanes = whole_vectors(count)",
            "for lane in range(lanes):",
            *_indented("v = members[block + min(lane, count - 1)]", *self._numbers(False), *kept, together.begin),
            "for k in range(0, n, 2):",
            *_indented(*together.shared, "for lane in range(lanes):", *_indented(*together.lane)),
        ]

    def _head(self) -> str:
        imports = [
            f'"""Kernel of one machine\'s structure, {self.form}; written by engine.equal_positions.text.kernels."""',
            "",
            "import math",
            "",
            "import numpy as np",
            "from numba import njit",
            "",
            "from engine.equal_positions.text.apart import read_apart, read_own, write_apart",
            "from engine.laws.kinematics.closure import *",
            "from engine.laws.kinematics.dead_centres import *",
            "from engine.laws.kinematics.prp import *",
            "from engine.laws.kinematics.rpp import *",
            "from engine.laws.kinematics.rpr import *",
            "from engine.laws.kinematics.rrp import *",
            "from engine.laws.kinematics.rrr import *",
            "from engine.laws.kinematics.vectors import *",
            "from engine.equal_positions.equilibrium import *",
            "from engine.equal_positions.flywheel import *",
            "from engine.laws.friction.coefficients import *",
            "from engine.laws.friction.feedback import *",
            "from engine.laws.indicator_diagrams import *",
            "from engine.laws.inertia_forces import *",
            "from engine.compiling.jit import KERNEL_OPTIONS",
            "from engine.equal_positions.lanes import *",
            "from engine.laws.kinematics.links import *",
            "from engine.equal_positions.load_directions import *",
            "from engine.laws.loads import *",
            "from engine.equal_positions.efficiency import *",
            "from engine.laws.reduction import *",
            "from engine.equal_positions.rows import *",
            "from engine.equal_positions.extremes import *",
            "from engine.equal_positions.shaking import *",
            "from engine.equal_positions.stroke_work import work_over_stroke",
            "from engine.equal_positions.strokes import *",
            "from engine.laws.tables import table_value",
            "",
            f"dtype = np.{self.dtype.name}",
            f"one = np.{self.dtype.name}(1)",
            f"zero = np.{self.dtype.name}(0)",
            f"least_sine = np.{self.dtype.name}({SINGULAR_SINE[self.dtype]})",
            f"settled = np.{self.dtype.name}({SETTLED[self.dtype]})",
            f"jammed = np.{self.dtype.name}({JAMMED[self.dtype]})",
            "",
            "",
            "@njit(**KERNEL_OPTIONS)",
        ]
        return "\n".join(imports)

    def _diagnose(self, diagnosis: list[str]) -> list[str]:
        text = "\n".join(diagnosis)
        loads = [f"        {s} = P[{i}, v]" for i, s in enumerate(self.slots) if re.search(rf"\b{s}\b", text)]
        return [
            "@njit(**KERNEL_OPTIONS)",
            "def diagnose(begin, end, P, nodes, cos_nodes, sin_nodes, doubtful, places, sines):",
            "    for i in range(begin, end):",
            "        v = doubtful[i]",
            "        least, group, place = one / zero, -1, -1",
            *loads,
            "        for k in range(nodes.shape[0]):",
            *(f"            {line}" for line in (diagnosis or ["pass"])),
            "        places[i, 0], places[i, 1], sines[i] = group, place, least",
        ]


def _indented(*lines: str) -> list[str]:
    return [f"    {line}" for line in lines]
