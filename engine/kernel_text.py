"""The text of a kernel's module: where rows are kept, the loops around the mathematics, the arguments."""

import re
from typing import Literal

import numpy as np

from engine.model import Model
from engine.parts import CrankInput

Form = Literal["whole", "factorised"]

# A group whose transmission quality falls below this is singular: about the root of the rounding error.
SINGULAR_SINE = {np.dtype(np.float64): 1e-7, np.dtype(np.float32): 1e-3}


def spacing(model: Model) -> list[str]:
    """Lines that set the first position and the spacing of positions, in the input's unit."""
    if isinstance(model.scene.input, CrankInput):
        return ["h = step", "first = nodes[0]", "h_half = h + h"]
    length = "(num__input__stop - num__input__start)"
    return [f"h = step * {length}", "first = num__input__start", "h_half = h + h"]


class KernelText:
    """Puts the lines of a kernel into a module."""

    def __init__(self, model: Model, form: Form, dtype: np.dtype, slots: list[str], rows: dict[str, str]) -> None:
        self.model, self.form, self.dtype = model, form, np.dtype(dtype)
        self.slots, self.rows = slots, rows

    def tables(self, text: str) -> tuple[str, ...]:
        """Searched tables that a text uses."""
        return tuple(t for t in self.model.moments.tables if f"table__{t}_breaks" in text)

    def angle_tables(self, text: str) -> tuple[str, ...]:
        """Tables over the crank angle that a text uses."""
        return tuple(t for t in self.model.moments.angle_tables if f"angle_table__{t}[" in text)

    def _table_arguments(self, text: str) -> list[str]:
        found = [
            f"table__{t}_{field}" for t in self.tables(text) for field in ("breaks", "coefficients", "start", "period")
        ]
        return found + [f"angle_table__{t}" for t in self.angle_tables(text)]

    def _loads(self, role: str) -> list[str]:
        slots = self.model.program.slots
        return [f"{s} = P[{i}, v]" for i, s in enumerate(self.slots) if slots[s].role == role]

    def module(self, position_loop: list[str], geometry: list[str], variant: list[str], diagnosis: list[str]) -> str:
        """Text of the module."""
        text = "\n".join((*position_loop, *geometry, *variant))
        arguments = ", ".join(
            ["begin", "end", "P", "nodes", "cos_nodes", "sin_nodes", "step", "rounding"]
            + (["starts", "members"] if self.form == "factorised" else [])
            + self._table_arguments(text)
            + ["values", "errors", "fields", "troubles", "checks"]
        )
        scratch = [r for r, home in self.rows.items() if home == "scratch"]
        half = [r for r, home in self.rows.items() if home == "half"]
        direct = [f"{r} = {home}" for r, home in self.rows.items() if home not in ("scratch", "half")]
        lines = [f"def kernel({arguments}):", "    n = nodes.shape[0]"]
        lines += [f"    scratch = np.empty(({max(len(scratch), 1)}, n), dtype)"]
        lines += [f"    {r} = scratch[{i}]" for i, r in enumerate(scratch)]
        if half:
            lines += [f"    halves = np.empty(({len(half)}, (n + 1) // 2), dtype)"]
            lines += [f"    {r} = halves[{i}]" for i, r in enumerate(half)]
        lines += ["    for group in range(begin, end):"]
        lines += self._inside(position_loop, geometry, variant, direct)
        return "\n".join([self._head(), *lines, "", "", *self._diagnose(diagnosis), ""])

    def _inside(
        self, position_loop: list[str], geometry: list[str], variant: list[str], direct: list[str]
    ) -> list[str]:
        pad = " " * 8
        if self.form == "whole":
            first = ["v = group", *self._loads("shape"), *self._loads("load"), *spacing(self.model), *direct]
            return [pad + line for line in (*first, *position_loop, *geometry, *variant)]
        first = ["v = members[starts[group]]", *self._loads("shape"), *spacing(self.model)]
        lines = [pad + line for line in (*first, *position_loop, *geometry)]
        lines += [f"{pad}for member in range(starts[group], starts[group + 1]):"]
        each = ["v = members[member]", *self._loads("load"), *direct, *variant]
        return lines + [f"{pad}    {line}" for line in each]

    def _head(self) -> str:
        imports = [
            f'"""Kernel of one machine\'s structure, {self.form}; written by engine.kernels."""',
            "",
            "import math",
            "",
            "import numpy as np",
            "from numba import njit",
            "",
            "from engine.dyads import *",
            "from engine.flywheel import *",
            "from engine.indicator import *",
            "from engine.jit import KERNEL_OPTIONS",
            "from engine.links import *",
            "from engine.loads import *",
            "from engine.reduction import *",
            "from engine.rows import *",
            "from engine.strokes import *",
            "from engine.tables import table_value",
            "",
            f"dtype = np.{self.dtype.name}",
            f"one = np.{self.dtype.name}(1)",
            f"zero = np.{self.dtype.name}(0)",
            f"least_sine = np.{self.dtype.name}({SINGULAR_SINE[self.dtype]})",
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
