"""Numba's compilers and settings: functions that only compiled code calls, arrays without overlap, whole vectors."""

import sys
from functools import cache
from importlib import import_module

import llvmlite.binding as llvm
from numba.core import config, types
from numba.core.codegen import JITCodeLibrary, get_host_cpu_features
from numba.core.compiler import Compiler, Flags
from numba.core.typed_passes import NopythonRewrites
from numba.core.typing import Context, Signature
from numba.core.untyped_passes import InlineClosureLikes, LiteralPropagationSubPipelinePass, LiteralUnroll, WithLifting

# Passes for what the engine's functions don't contain: `with`, closures, mixed tuples in loops, arithmetic on arrays.
_FOR_OTHERS = {WithLifting, InlineClosureLikes, LiteralUnroll, LiteralPropagationSubPipelinePass, NopythonRewrites}


def _load_array_functions() -> None:
    """Load Numba's array functions without SciPy's linear algebra, which takes as long to load as Numba itself.

    They look for its BLAS once, for `np.cov` and a few others; without it these use their own loops. `np.dot` and
    `np.linalg` look for it again when they are compiled.
    """
    blas = "scipy.linalg.cython_blas"
    if blas in sys.modules:
        return
    sys.modules[blas] = None  # type: ignore[assignment]
    try:
        import_module("numba.np.arraymath")
    finally:
        del sys.modules[blas]


_load_array_functions()

# The first processors with AVX-512, whose clock slows down while they compute with vectors of 512 bits.
SLOWED = {"skylake-avx512", "cascadelake", "cooperlake"}


def _use_whole_vectors() -> None:
    """Let LLVM use vectors of 512 bits wherever the processor has them at full clock.

    For Intel's processors it prefers 256 bits, with which summaries take a sixth more time. Numba reads this setting
    once, before it compiles or loads its first function; a user's own setting, `NUMBA_CPU_FEATURES`, is kept.
    """
    features = get_host_cpu_features()
    if config.CPU_FEATURES is None and "+avx512f" in features.split(",") and llvm.get_host_cpu_name() not in SLOWED:
        config.CPU_FEATURES = f"{features},-prefer-256-bit"


_use_whole_vectors()


class PartOfCallers(JITCodeLibrary):
    """Library that is optimised and turned into machine code only as part of its callers' libraries.

    Numba's own library would also be optimised and translated separately, again at every level of calls.
    """

    def _optimize_final_module(self) -> None:
        """Do nothing: the callers optimise this code."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Return 0: the function has no separate machine code."""
        return 0

    @property
    def codegen(self) -> "PartOfCallers":
        """Receiver of the environment of Python objects, which functions called only by compiled code don't have."""
        return self

    def set_env(self, name: str, environment: object) -> None:
        """Ignore the environment: nothing reads it."""


class _ListedFlags(Flags):
    """Flags that list their values once, as nothing changes them later.

    Numba compares all flags at every call of a built-in function, which takes a twentieth of the compile time.
    """

    __slots__ = ("_listed",)

    def values(self) -> dict:
        """Values of all flags, by name."""
        if not hasattr(self, "_listed"):
            self._listed = super().values()
        return self._listed


def _remember_operators() -> None:
    """Make Numba remember the signatures of calls of its own functions with positional arguments.

    It searches all candidates again when it emits the instructions of an `a * b`: a fifth of the time to compile
    arithmetic.
    """
    search = types.Function.get_call_type

    @cache
    def found(function: types.Function, context: Context, args: tuple) -> Signature:
        return search(function, context, args, {})

    def get_call_type(function: types.Function, context: Context, args: tuple, kws: dict) -> Signature:
        """Signature of a call."""
        return search(function, context, args, kws) if kws else found(function, context, tuple(args))

    types.Function.get_call_type = get_call_type


_remember_operators()


class _RememberedCalls(Context):
    """Numba's typing context, which remembers the signature of each call of a function with positional arguments.

    Numba itself searches all candidates again at every `a * b`, a seventh of the time to compile arithmetic.
    """

    def __init__(self, context: Context) -> None:
        self.__dict__ = context.__dict__

    def resolve_function_type(self, func: object, args: tuple, kws: dict) -> Signature | None:
        """Signature of a call."""
        if kws or not isinstance(func, types.Callable):
            return super().resolve_function_type(func, args, kws)
        # One version of a function for all values of an integer.
        given = map(types.unliteral, args) if isinstance(func, types.Dispatcher) else args
        return self._resolved(func, tuple(given))

    # Numba's one context lives as long as the process.
    @cache  # noqa: B019
    def _resolved(self, func: types.Callable, args: tuple) -> Signature | None:
        return super().resolve_function_type(func, args, {})


_remembered_calls = cache(_RememberedCalls)


class Plain(Compiler):
    """Compiler of functions of numbers and loops."""

    def __init__(
        self, typing: Context, target: object, library: object, args: tuple, result: object, flags: Flags, locals: dict
    ) -> None:
        super().__init__(_remembered_calls(typing), target, library, args, result, _ListedFlags(flags), locals)

    def define_pipelines(self) -> list:
        """Numba's usual passes, apart from those for other functions, which take a tenth of the compile time."""
        (passes,) = super().define_pipelines()
        passes.passes = [made for made in passes.passes if made[0] not in _FOR_OTHERS]
        passes.finalize()
        return [passes]


class Within(Plain):
    """Compiler for functions that only compiled code calls."""

    def define_pipelines(self) -> list:
        """The passes of `Plain`, with `PartOfCallers` as the library."""
        self.state.library = PartOfCallers(self.state.targetctx.codegen(), self.state.func_id.func_qualname)
        return super().define_pipelines()


class Apart(Plain):
    """Compiler that assumes that an array argument that is written to overlaps no other argument.

    It then emits no overlap check before each loop and no slow second loop for the case of overlap.
    """

    def define_pipelines(self) -> list:
        """The passes of `Plain`, with the `noalias` flag."""
        self.state.flags.noalias = True
        return super().define_pipelines()


class ApartWithin(Apart, Within):
    """Compiler for functions that only compiled code calls, with array arguments that don't overlap."""
