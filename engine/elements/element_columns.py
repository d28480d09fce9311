"""The results of a scene's machine elements for a set of variants: a small kernel of their laws, and error figures."""

from collections.abc import Iterable

import numpy as np

from engine.balancing.engines.engine_columns import engine_law
from engine.balancing.engines.engine_element import EngineElement
from engine.balancing.rotors.rotor_columns import rotor_law
from engine.balancing.rotors.rotor_element import RotorElement
from engine.compiling.jit import on_all_threads, run_kernel, scalar
from engine.elements.element_laws import LAWS, Law, Result
from engine.quantities.quantity import Quantity
from engine.scene.elements import MachineElement
from engine.scene.scene import Numbers, Scene
from engine.verdicts import Verdict

ROUNDING = 16
# A relative change of a number that is large against rounding and small against what laws curve over.
NUDGE = 2.0**-26
EPS = float(np.finfo(float).eps)

Columns = dict[str, np.ndarray]


def element_summaries(scene: Scene) -> list[Quantity]:
    """Summaries of a scene's machine elements."""
    return [Quantity(f"{n}.{r.name}", f"{n}: {r.long_name}", r.units) for n in scene.elements for r in _given(scene, n)]


class ElementColumns:
    """What is asked of a scene's machine elements.

    Parameters
    ----------
    scene : Scene
    asked : iterable of str
        Names of summaries; those that aren't of elements are left to others.

    Attributes
    ----------
    names : list of str
        Those that are.
    elements : tuple of str
        Elements of which something is asked.
    """

    def __init__(self, scene: Scene, asked: Iterable[str]) -> None:
        known = {q.name for q in element_summaries(scene)}
        self.scene, self.names = scene, [name for name in asked if name in known]
        self.elements = tuple(dict.fromkeys(name.partition(".")[0] for name in self.names))

    @property
    def text(self) -> str:
        """Source of the kernel: for each scalar law, it, then again with each of its numbers a little greater."""
        lines, functions, column, row = [], set(), 0, 0
        for name in self.elements:
            element = self.scene.elements[name]
            law = law_of(element)
            if callable(law.function):
                column += len(law.results)
                continue
            functions.add(law.function)
            given, found = len(law.arguments(element, lambda key: 0.0)), len(law.results)
            numbers = ", ".join(f"numbers[{row + i}, v] * (greater if k == {i} else 1.0)" for i in range(given))
            lines += [
                f"# {name}",
                f"for k in range(-1, {given}):",
                f"    found = {law.function}({numbers})",
                f"    keep(found, k, values[v, {column}:{column + found}], errors[v, {column}:{column + found}])",
            ]
            column, row = column + found, row + given
        head = [*_HEAD, f"from engine.elements.element_laws import {', '.join(sorted(functions))}", *_LOOP]
        return "\n".join([*head, *(f"        {line}" for line in lines), ""]) if functions else ""

    def fill(self, status: np.ndarray, summaries: Columns, errors: Columns, keep: np.ndarray, numbers: Numbers) -> None:
        """Write what is asked of the variants `keep`, and the verdict on those of them that are well so far.

        JAMS where a force or moment would have to be infinite, NOT_FINITE where a law has no value.

        Parameters
        ----------
        status : ndarray (variants,) of uint8
        summaries, errors : dict of str to ndarray (variants,)
            Of an outcome, to be written to.
        keep : ndarray of int
            Indices of variants.
        numbers : Numbers
            Theirs.
        """
        values, figures = self._values(numbers, keep.size)
        must = [
            i for i, (name, r) in enumerate(self._every) if r in _given(self.scene, name) and not r.may_be_undefined
        ]
        jams, undefined = np.isinf(values[:, must]).any(axis=1), np.isnan(values[:, must]).any(axis=1)
        well = status[keep] == Verdict.OK
        status[keep[well & jams]] = Verdict.JAMS
        status[keep[well & undefined]] = Verdict.NOT_FINITE
        nothing = ~np.isfinite(values)
        values[nothing] = figures[nothing] = np.nan
        places = {f"{name}.{r.name}": i for i, (name, r) in enumerate(self._every)}
        for name in self.names:
            summaries[name][keep], errors[name][keep] = values[:, places[name]], figures[:, places[name]]

    @property
    def _every(self) -> list[tuple[str, Result]]:
        """Everything that the kernel gives: element and result."""
        return [(name, r) for name in self.elements for r in law_of(self.scene.elements[name]).results]

    def _values(self, numbers: Numbers, variants: int) -> tuple[np.ndarray, np.ndarray]:
        """All results and their error figures: rounding of the numbers, as the laws pass it on, and of the results."""
        values = np.empty((variants, len(self._every)))
        errors = np.empty_like(values)
        scalars, column = [], 0
        for name in self.elements:
            law, given = law_of(self.scene.elements[name]), self._arguments(name, numbers, variants)
            here = slice(column, column + len(law.results))
            if callable(law.function):
                values[:, here], errors[:, here] = _with_errors(law, given)
            else:
                scalars.append(given)
            column = here.stop
        if scalars:
            run_kernel(self.text, "kernel", variants, np.concatenate(scalars), values, errors)
        for i, (_, result) in enumerate(self._every):
            if result.exact:
                errors[:, i] = 0.0
        return values, errors

    def _arguments(self, name: str, numbers: Numbers, variants: int) -> np.ndarray:
        element = self.scene.elements[name]
        found = law_of(element).arguments(element, lambda key: numbers[f"elements.{name}.{key}"])
        return np.array([np.broadcast_to(a, (variants,)) for a in found], float)


_HEAD = (
    '"""Kernel of machine elements; written by engine.elements.element_columns."""',
    "",
    "from numba import njit",
    "",
    "from engine.elements.element_columns import NUDGE, keep",
)
_LOOP = (
    "from engine.compiling.jit import KERNEL_OPTIONS",
    "",
    "greater = 1.0 + NUDGE",
    "",
    "",
    "@njit(**KERNEL_OPTIONS)",
    "def kernel(begin, end, numbers, values, errors):",
    "    for v in range(begin, end):",
)


@scalar
def keep(found: tuple[float, ...], changed: int, values: np.ndarray, errors: np.ndarray) -> None:
    """Keep the results of an element, or add what they move by to their error figures.

    Parameters
    ----------
    found : tuple of float
        What its law gives.
    changed : int
        Which of its numbers is greater by NUDGE; negative: none, these are the results.
    values, errors : ndarray
        Of one variant and element, to be written to.
    """
    for i in range(len(found)):
        if changed < 0:
            values[i], errors[i] = found[i], ROUNDING * EPS * abs(found[i])
        else:
            errors[i] += EPS / NUDGE * abs(found[i] - values[i])


def _with_errors(law: Law, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Results (variants, results) of a law of arrays and their error figures, block by block."""
    pieces = np.array_split(numbers, max(1, -(-numbers.shape[1] // law.block)), axis=1)
    values, sizes = zip(*on_all_threads(law.function, pieces), strict=True)
    return np.concatenate(values, axis=1).T, ROUNDING * EPS * np.concatenate(sizes, axis=1).T


def law_of(element: MachineElement) -> Law:
    """What is computed of an element; of a rotor or an engine it depends on its unbalances and planes, or cylinders."""
    match element:
        case RotorElement():
            return rotor_law(element)
        case EngineElement():
            return engine_law(element)
    return LAWS[element.type]


def _given(scene: Scene, name: str) -> list[Result]:
    """Results that an element has with what it is given."""
    element = scene.elements[name]
    return [r for r in law_of(element).results if r.needs is None or getattr(element, r.needs) is not None]
