"""Machine code of printed functions: translated by LLVM together with the laws that they call, or from the cache."""

from functools import cache

import llvmlite.binding as llvm
import numba
import numpy as np
from numba import types
from numba.core.codegen import CodeLibrary
from numba.core.compiler import CompileResult
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import cpu_target
from numba.core.typing import Signature

from engine.compiling import compilers  # noqa: F401  (settings for Numba)
from engine.compiling.blocks import Row
from engine.compiling.decorators import Law
from engine.compiling.kept_code import compiling, kept_files
from engine.compiling.printed_code import MEMORY, NUMBERS, Call, PrintedCode
from engine.compiling.sources import digest_of_printed

_LINE, _MATRIX = types.float64[::1], types.float64[:, ::1]
# Where there is nothing to fill.
_NOTHING = PrintedCode.of("tile", "Nothing.", [], ())


class PrintedFunction(types.WrapperAddressProtocol):
    """A printed function as a value; functions of one kind have one type.

    Parameters
    ----------
    code : PrintedCode or None
        None where there is nothing to fill.
    """

    def __init__(self, code: PrintedCode | None) -> None:
        code = code or _NOTHING
        self._address, self._signature = _address_of(code), signature_of(code.kind)
        # Numba finds the type itself only once it has loaded all that it can compile.
        self._numba_type_ = types.FunctionType(self._signature)

    def __wrapper_address__(self) -> int:
        """Address of its machine code."""
        return self._address

    def signature(self) -> Signature:
        """Its signature."""
        return self._signature


@cache
def signature_of(kind: str) -> Signature:
    """Signature of functions of a kind of `PrintedCode`.

    Those that fill a tile take (P, T, q, cos_q, sin_q, tile): numbers (numbers, lanes), all tables, three arrays
    (positions, lanes), and the tile (curves, positions, lanes). Those that fill rows take (p, T, q, cos_q, sin_q, v,
    rows): a variant's numbers, all tables, the positions with cosine and sine, the index of the variant, and the rows
    (curves, variants, positions).

    Parameters
    ----------
    kind : {"tile", "float64", "float32"}
    """
    if kind == "tile":
        return types.void(_MATRIX, _LINE, _MATRIX, _MATRIX, _MATRIX, types.float64[:, :, ::1])
    rows = numba.from_dtype(np.dtype(kind))[:, :, ::1]
    return types.void(_LINE, _LINE, _LINE, _LINE, _LINE, types.intp, rows)


def _address_of(code: PrintedCode) -> int:
    with compiling():
        return _library(code).get_pointer_to_function(_name_of(code))


def _name_of(code: PrintedCode) -> str:
    return f"printed_{digest_of_printed(code)[:32]}"


@cache
@global_compiler_lock
def _library(code: PrintedCode) -> CodeLibrary:
    codegen = cpu_target.target_context.codegen()
    files, key = kept_files(digest_of_printed(code)), codegen.magic_tuple()
    kept = files and files.load(key)
    if kept:
        return codegen.unserialize_library(kept)
    library = _translated(code)
    if files:
        files.save(key, library.serialize_using_object_code())
    return library


def _translated(code: PrintedCode) -> CodeLibrary:
    library = cpu_target.target_context.codegen().create_library(_name_of(code))
    library.enable_object_caching()
    module = llvm.parse_assembly(code.text)
    module.triple = llvm.get_process_triple()
    module.get_function("fill").name = _name_of(code)
    for call in code.calls:
        made = _compiled(call)
        module.get_function(call.name).name = made.fndesc.llvm_func_name
        library.add_linking_library(made.library)
    library.add_llvm_module(module)
    library.finalize()
    return library


def _compiled(call: Call) -> CompileResult:
    """A law, or a function that only compiled code calls, for the types of its arguments."""
    function = call.law.compiled if isinstance(call.law, Law) else call.law
    own = {0: (types.float64,), MEMORY: (_LINE,), NUMBERS: (Row, types.intp, types.intp)}
    kinds = [kind for of in call.arguments for kind in own.get(of) or (types.UniTuple(types.float64, of),)]
    function.compile(tuple(kinds))
    made = function.overloads[tuple(kinds)]
    results = made.signature.return_type
    if results != types.float64 and getattr(results, "dtype", None) != types.float64:
        raise TypeError(f"{call.name} returns {results}, not numbers")
    return made
