"""Methods of integration as data, and their sums over stages, printed once for each method.

A step of a method with stages k_i = f(y + h Σ a_ij k_j) ends at y + h Σ b_i k_i. What differs from that in formulas of
a lower order estimates its error. The sums are printed with the coefficients written out: they stay in registers, which
makes a step five times as fast as loops over the tableau.

Sources: E. Hairer, S. P. Nørsett and G. Wanner, Solving Ordinary Differential Equations I, second edition, section
II.10 (Dormand and Prince, order eight; coefficients as in SciPy) and II.1 (Runge and Kutta, order four).
"""

import linecache
import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.integrate import DOP853

from engine.compiling.decorators import routine
from engine.compiling.widths import LANES

# A second formula that vanishes up to order five. Its error of order six, over all rooted trees of six vertices
# weighted by their symmetry, is as large as that of the first and orthogonal to it: both hardly ever vanish together.
SECOND_ERROR = np.zeros(12)
SECOND_ERROR[[0, *range(5, 12)]] = [
    -2.16575624753399913e-2,
    -2.87929616619069517e-1,
    4.68800979560341058e-1,
    -3.71761606355259955e-1,
    -1.24189137504977531,
    1.32421205179734280,
    1.59378222181324636e-1,
    -2.91510930395638204e-2,
]


class ExplicitMethod(NamedTuple):
    """An explicit Runge–Kutta method.

    Attributes
    ----------
    matrix : ndarray (dense stages, dense stages)
        A; rows beyond the stages of a step are those of the polynomial within it, the first of them the step's end.
    nodes : ndarray (dense stages,)
        c.
    weights : ndarray (stages,)
        b.
    errors : tuple of ndarray (stages,)
        What differs from two formulas of a lower order, and from one of a still lower order; none where steps have
        fixed lengths.
    parts : ndarray (parts, dense stages)
        Weights of the parts of the polynomial within a step, p₀θ + p₁θ(1−θ) + p₂θ²(1−θ) + p₃θ²(1−θ)² + …
    """

    matrix: np.ndarray
    nodes: np.ndarray
    weights: np.ndarray
    errors: tuple[np.ndarray, ...]
    parts: np.ndarray

    @property
    def stages(self) -> int:
        """How many stages a step has."""
        return self.weights.size

    @property
    def adaptive(self) -> bool:
        """Whether the method estimates its errors."""
        return len(self.errors) > 0


def _weighted(weights: np.ndarray) -> str:
    """Sum of the rates of some row q over the stages, as text."""
    terms = [f"{float(w)!r} * rates[{k} * width + q, l]" for k, w in enumerate(weights) if w != 0.0]
    return " + ".join(terms)


def _parts(weights: np.ndarray, stages: int, *higher: np.ndarray) -> np.ndarray:
    """Parts of the polynomial within a step: the first three from values and slopes at both ends."""
    last = weights.size
    whole, first, end = np.zeros(stages), np.eye(stages)[0], np.eye(stages)[last]
    whole[:last] = weights
    return np.array([whole, first - whole, 2.0 * whole - first - end, *higher])


def _order_eight() -> ExplicitMethod:
    stages, dense = 12, 16
    matrix = np.zeros((dense, dense))
    matrix[:stages, :stages], matrix[stages, :stages], matrix[stages + 1 :] = DOP853.A, DOP853.B, DOP853.A_EXTRA
    nodes = np.concatenate([DOP853.C, [1.0], DOP853.C_EXTRA])
    errors = DOP853.E5[:stages], SECOND_ERROR, DOP853.E3[:stages]
    return ExplicitMethod(matrix, nodes, DOP853.B, errors, _parts(DOP853.B, dense, *DOP853.D))


def _order_four() -> ExplicitMethod:
    matrix = np.zeros((5, 5))
    matrix[1, 0] = matrix[2, 1] = 0.5
    matrix[3, 2] = 1.0
    weights = np.array([1.0, 2.0, 2.0, 1.0]) / 6.0
    matrix[4, :4] = weights
    return ExplicitMethod(matrix, np.array([0.0, 0.5, 0.5, 1.0, 1.0]), weights, (), _parts(weights, 5))


ORDER_EIGHT, ORDER_FOUR = 0, 1
METHODS = (_order_eight(), _order_four())


def _stage_text() -> list[str]:
    lines = ["def at_stage(method, s, states, width, begin, h, rates, state):"]
    for number, method in enumerate(METHODS):
        for s in range(1, len(method.nodes)):
            lines += [
                f"    if method == {number} and s == {s}:",
                "        for q in range(states):",
                "            for l in range(LANES):",
                f"                state[q, l] = begin[q, l] + h[l] * ({_weighted(method.matrix[s, :s])})",
            ]
    return lines


def _end_text() -> list[str]:
    lines = ["def step_end(method, judged, width, begin, h, rates, after, errors):"]
    for number, method in enumerate(METHODS):
        lines += [
            f"    if method == {number}:",
            "        for q in range(width):",
            "            for l in range(LANES):",
            f"                after[q, l] = begin[q, l] + h[l] * ({_weighted(method.weights)})",
        ]
        if method.adaptive:
            lines += [
                "        for q in range(judged):",
                "            for l in range(LANES):",
                f"                five, six = {_weighted(method.errors[0])}, {_weighted(method.errors[1])}",
                f"                fine, coarse = five * five + six * six, {_weighted(0.1 * method.errors[2])}",
                "                size = math.sqrt(fine + coarse * coarse)",
                "                errors[q, l] = h[l] * (fine / size if size != 0.0 else 0.0)",
            ]
    return lines


def _compiled(lines: list[str]) -> Callable:
    """A function of compiled code by its text."""
    text, file = "\n".join(lines) + "\n", f"<{lines[0].split('(')[0]}>"
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    names = {"LANES": LANES, "math": math}
    exec(compile(text, file, "exec"), names)
    return routine(names[lines[0].removeprefix("def ").split("(")[0]])


# The state of a stage; the end of a step, and the estimated errors of its first rows. `rates` holds `width` rows for
# each stage, those of the states first; all are rows of lanes.
at_stage, step_end = _compiled(_stage_text()), _compiled(_end_text())
