"""Single processor instructions that Python can't express, with an equivalent in Python."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import cached_property, update_wrapper
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from llvmlite import ir

Generate = Callable[..., "ir.Value"]


class Instruction:
    """A processor instruction: Python evaluates its equivalent, compiled code emits the LLVM instruction.

    Parameters
    ----------
    meaning : callable
        Equivalent in Python, of numbers or arrays.
    signature : str
        Types of the compiled instruction, in Numba's notation.
    generate : callable
        Emits the LLVM instruction, from a builder and the arguments.
    """

    def __init__(self, meaning: Callable, signature: str, generate: Generate) -> None:
        update_wrapper(self, meaning)
        self._meaning, self._signature, self._generate = meaning, signature, generate

    def __call__(self, *arguments: object) -> object:
        """Evaluate the equivalent in Python."""
        return self._meaning(*arguments)

    @cached_property
    def _numba_type_(self) -> object:
        """Numba's type of the instruction, by which compiled code may call it."""
        from numba import types
        from numba.core import sigutils
        from numba.core.typing.templates import make_intrinsic_template

        arguments, result = sigutils.normalize_signature(self._signature)

        def typed(typing: object, *_: object) -> tuple:
            return result(*arguments), lambda context, builder, signature, given: self._generate(builder, *given)

        first = inspect.Parameter("typing", inspect.Parameter.POSITIONAL_OR_KEYWORD)
        typed.__signature__ = inspect.Signature([first, *inspect.signature(self._meaning).parameters.values()])
        return types.Function(make_intrinsic_template(self, typed, self.__name__))


def _instruction(signature: str, generate: Generate) -> Callable[[Callable], Instruction]:
    return lambda meaning: Instruction(meaning, signature, generate)


def _as_bits(builder: ir.IRBuilder, x: ir.Value) -> ir.Value:
    from llvmlite import ir

    return builder.bitcast(x, ir.IntType(64))


def _as_number(builder: ir.IRBuilder, bits: ir.Value) -> ir.Value:
    from llvmlite import ir

    return builder.bitcast(bits, ir.DoubleType())


def _freeze(builder: ir.IRBuilder, x: ir.Value) -> ir.Value:
    from llvmlite import ir

    class Freeze(ir.Instruction):
        """LLVM's `freeze`, which llvmlite's builder lacks."""

        def descr(self, lines: list) -> None:
            """Append the instruction's text to `lines`."""
            lines.append(f"freeze {self.operands[0].type} {self.operands[0].get_reference()}\n")

    found = Freeze(builder.block, x.type, "freeze", [x])
    builder._insert(found)
    return found


@_instruction("float64(float64, float64, float64)", lambda builder, a, b, c: builder.fma(a, b, c))
def fused(a: float, b: float, c: float) -> float:
    """The sum a b + c, rounded once in compiled code and twice in Python."""
    return a * b + c


@_instruction("int64(float64)", _as_bits)
def bits_of(x: float) -> int:
    """The bits of a float64 as an int64."""
    return x.view(np.int64)


@_instruction("float64(int64)", _as_number)
def number_of(bits: int) -> float:
    """The float64 with the bits of an int64."""
    return bits.view(np.float64)


@_instruction("float64(float64)", _freeze)
def held(x: float) -> float:
    """Return x, passed through LLVM's `freeze`.

    If a loop stores either a new value or the one already in memory, LLVM emits a masked store, which takes some
    processors twenty times as long as an unconditional one. `freeze` hides from LLVM that the value came from memory.
    """
    return x


@_instruction("float64(boolean, float64, float64)", lambda builder, *given: builder.select(*given))
def chosen(condition: bool, a: float, b: float) -> float:
    """Return a if the condition is true, else b; both are read.

    LLVM compiles a conditional expression on two numbers in memory to a choice between their addresses. A loop over
    positions or lanes then loads them one by one, ten times as slowly.
    """
    if isinstance(condition, np.ndarray):
        return np.where(condition, a, b).view(type(condition))
    return a if condition else b
