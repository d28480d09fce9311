"""Numba's private parts that `engine.compiling` builds on: which of them a new release of Numba lacks.

The public interface has no library that waits for its callers', no cache with digests, no typing of an item of a type
of one's own, and no promise that arrays don't overlap.
"""

import importlib
import os

import llvmlite.binding as llvm
import numba
import numpy as np
import pytest
from llvmlite import ir
from numba import types
from numba.core.registry import cpu_target

from engine.compiling.compilers import SLOWED

# Module, class or function, its attributes: those overridden and those called.
PARTS = {
    "code that becomes part of its callers' (decorators)": """numba.core.codegen JITCodeLibrary _optimize_final_module
    _finalize_final_module _finalize_dynamic_globals _verify_declare_only_symbols get_pointer_to_function codegen""",
    "passes with other flags (decorators)": "numba.core.compiler Compiler define_pipelines",
    "arrays that don't overlap (decorators)": "numba.core.compiler Flags noalias",
    "flags listed once (compilers)": "numba.core.compiler Flags values",
    "calls remembered (compilers)": "numba.core.typing Context resolve_function_type",
    "operators remembered (compilers)": "numba.core.types Function get_call_type",
    "folder of machine code (kept_code)": """numba.core.caching _CacheLocator from_function ensure_cache_path
    get_cache_path get_source_stamp get_disambiguator""",
    "cache of a function (kept_code)": "numba.core.caching FunctionCache _impl_class cache_path",
    "entries of the cache (kept_code)": "numba.core.caching CompileResultCacheImpl _locator_classes filename_base",
    "files with a digest (kept_code)": """numba.core.caching IndexDataCacheFile save load _load_index _load_data
    _save_index _save_data _index_path _data_path _open_for_write""",
    "bytes of machine code (kept_code)": "numba.core.serialize dumps",
    "machine code of text (printed_functions)": """numba.core.codegen JITCodeLibrary add_llvm_module
    enable_object_caching add_linking_library finalize serialize_using_object_code get_pointer_to_function""",
    "libraries (printed_functions)": "numba.core.codegen JITCPUCodegen create_library unserialize_library magic_tuple",
    "processor (printed_functions)": "numba.core.registry cpu_target target_context",
    "width of vectors (compilers)": "numba.core config CPU_FEATURES",
    "features of the processor (compilers)": "numba.core.codegen get_host_cpu_features",
    "one compiles at a time (printed_functions)": "numba.core.compiler_lock global_compiler_lock",
    "signatures (printed_functions)": "numba.core.typing Signature",
    "loading from the cache (kept_code)": "numba.core.caching FunctionCache load_overload _load_overload",
    "items of memory, their types (memory)": "numba.core.typing.templates AbstractTemplate generic",
    "items of memory, registered (memory)": "numba.core.typing.templates infer_global",
    "items of memory, signature (memory)": "numba.core.typing.templates signature",
    "items of memory, several indices (memory)": "numba.core.cgutils unpack_tuple",
}
# Set in constructors, so that a class doesn't show them.
BY_INSTANCES = {"_index_path", "generic"}


@pytest.mark.parametrize("use", PARTS)
def test_private_part__is_still_there(use):
    module, name, *attributes = PARTS[use].split()
    part = getattr(importlib.import_module(module), name, None)
    assert part is not None, f"{use}: Numba {numba.__version__} has no {module}.{name}"
    missing = [a for a in attributes if a not in BY_INSTANCES and not hasattr(part, a)]
    assert missing == [], f"{use}: {module}.{name} of Numba {numba.__version__} lacks them"


def test_arrays_of_others__still_find_blas():
    """Array functions are loaded without SciPy's BLAS; a product of matrices, compiled by anyone, has it."""

    @numba.njit
    def product(a, b):
        return a @ b

    a = np.arange(6.0).reshape(2, 3)
    np.testing.assert_array_equal(product(a, a.T.copy()), a @ a.T)


def test_machine_code__has_vectors_of_512_bits():
    """LLVM prefers half the width on Intel's processors, at which the same results take longer."""
    features = cpu_target.target_context.codegen().magic_tuple()[2]
    if "+avx512f" not in features.split(",") or llvm.get_host_cpu_name() in SLOWED:
        pytest.skip("a processor without them, or one that slows down for them")
    if "NUMBA_CPU_FEATURES" in os.environ:
        pytest.skip("the user's own setting is kept")

    @numba.njit(error_model="numpy")
    def add_squares(a, b):
        for k in range(64):
            b[k] += a[k] * a[k]

    add_squares.compile((types.float64[::1], types.float64[::1]))
    (code,) = add_squares.inspect_asm().values()
    assert "zmm" in code


def test_dispatcher__keeps_what_is_read():
    @numba.njit
    def twice(x):
        return 2.0 * x

    twice.compile((types.float64,))
    assert hasattr(twice, "_cache")
    found = twice.overloads[(types.float64,)]
    assert found.library.get_pointer_to_function(found.fndesc.llvm_cfunc_wrapper_name) != 0
    assert hasattr(types, "WrapperAddressProtocol")
    assert hasattr(ir.IRBuilder, "_insert")
