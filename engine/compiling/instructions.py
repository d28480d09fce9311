"""Single instructions of the processor that Python has no words for."""

from collections.abc import Callable

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic


@intrinsic
def fused(typing: object, a: object, b: object, c: object) -> tuple:
    """Product and sum a b + c, rounded once."""

    def generate(context: object, builder: object, signature: object, arguments: list) -> object:
        return builder.fma(*arguments)

    return types.float64(types.float64, types.float64, types.float64), generate


@intrinsic
def bits_of(typing: object, x: object) -> tuple:
    """The bits of a float64 as an int64."""

    def generate(context: object, builder: object, signature: object, arguments: list) -> object:
        return builder.bitcast(arguments[0], ir.IntType(64))

    return types.int64(types.float64), generate


@intrinsic
def number_of(typing: object, bits: object) -> tuple:
    """The float64 with the bits of an int64."""

    def generate(context: object, builder: object, signature: object, arguments: list) -> object:
        return builder.bitcast(arguments[0], ir.DoubleType())

    return types.float64(types.int64), generate


class _Freeze(ir.Instruction):
    """LLVM's `freeze`, which llvmlite's builder doesn't know."""

    def __init__(self, parent: object, value: object) -> None:
        super().__init__(parent, value.type, "freeze", [value])

    def descr(self, lines: list) -> None:
        """Write it down."""
        lines.append(f"freeze {self.operands[0].type} {self.operands[0].get_reference()}\n")


@intrinsic
def held(typing: object, x: object) -> tuple:
    """A float64 itself, from wherever it was read.

    Where what is stored is either something new or what was there, LLVM stores under a mask, which takes some
    processors twenty times as long as storing everything; of a held number it doesn't know that it was there.
    """

    def generate(context: object, builder: object, signature: object, arguments: list) -> object:
        found = _Freeze(builder.block, arguments[0])
        builder._insert(found)
        return found

    return types.float64(types.float64), generate


@intrinsic
def chosen(typing: object, condition: object, a: object, b: object) -> tuple:
    """One of two float64, a where the condition is true, both of them read.

    A conditional expression on two numbers in memory is compiled to a choice between addresses, which a loop over
    positions or lanes then looks up one by one, ten times as slowly.
    """

    def generate(context: object, builder: object, signature: object, arguments: list) -> object:
        return builder.select(*arguments)

    return types.float64(types.boolean, types.float64, types.float64), generate


def roundings(count: float) -> Callable:
    """Intrinsic that gives so many distances from 1 to the next number, in the precision of its argument."""

    @intrinsic
    def given(typing: object, number: object) -> tuple:
        def generate(context: object, builder: object, signature: object, arguments: list) -> object:
            return context.get_constant(number, count * float(np.finfo(str(number)).eps))

        return number(number), generate

    return given
