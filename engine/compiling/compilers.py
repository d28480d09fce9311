"""Numba's compilers of functions that compiled code calls: code that waits for its callers', arrays kept apart."""

import sys
from importlib import import_module

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler


def _load_array_functions() -> None:
    """Load Numba's array functions without SciPy's linear algebra, which takes as long to load as Numba itself.

    They look for its BLAS once, for `np.cov` and a few others; without it these use loops of their own. `np.dot` and
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


class PartOfCallers(JITCodeLibrary):
    """Code that becomes part of its callers' alone: with theirs it is optimised and made into machine code, once.

    A library of Numba's own would be both by itself too, at every level of calls again.
    """

    def _optimize_final_module(self) -> None:
        """Leave it to the callers."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Nowhere: there is no machine code."""
        return 0

    @property
    def codegen(self) -> "PartOfCallers":
        """What takes the environment for Python's objects, of which compiled code alone has none."""
        return self

    def set_env(self, name: str, environment: object) -> None:
        """Nothing reads it."""


class Within(Compiler):
    """Compiler of functions that are called by compiled code alone."""

    def define_pipelines(self) -> list:
        """Passes as usual, into a library that waits for its callers'."""
        self.state.library = PartOfCallers(self.state.targetctx.codegen(), self.state.func_id.func_qualname)
        return super().define_pipelines()


class Apart(Compiler):
    """Compiler that takes it for granted that arrays handed over don't overlap, where one of them is written to.

    It then needs neither checks before every loop nor another, slow loop for when they do.
    """

    def define_pipelines(self) -> list:
        """Passes as usual, with the promise among the flags."""
        self.state.flags.noalias = True
        return super().define_pipelines()


class ApartWithin(Apart, Within):
    """Both."""
