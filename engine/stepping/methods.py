"""Sums over the stages of methods, printed as code once for each method.

A step of a method with stages k_i = f(y + h Σ a_ij k_j) ends at y + h Σ b_i k_i. The difference from embedded formulas
of lower order estimates its error. The coefficients are printed as constants, so the sums stay in registers: a step is
five times as fast as with loops over the tableau.
"""

import linecache
import math
from collections.abc import Callable

import numpy as np

from engine.compiling.blocks import LANES
from engine.compiling.decorators import routine
from engine.laws.runge_kutta import ORDER_EIGHT, ORDER_EIGHT_IN_TIME
from engine.stepping.tableaux import ORDER_FOUR, ORDER_NINE

# Indices of the methods.
EIGHT, FOUR, NINE, EIGHT_IN_TIME = range(4)
METHODS = (ORDER_EIGHT, ORDER_FOUR, ORDER_NINE, ORDER_EIGHT_IN_TIME)


def _weighted(weights: np.ndarray) -> str:
    """Weighted sum of the rates of row q over the stages, as code."""
    terms = [f"{float(w)!r} * rates[{k} * width + q, l]" for k, w in enumerate(weights) if w != 0.0]
    return " + ".join(terms) or "0.0"


def _squares(formulas: np.ndarray) -> str:
    """Sum of the squares of such sums, as code."""
    return " + ".join(f"({_weighted(weights)}) ** 2" for weights in formulas)


def _stage_text() -> list[str]:
    lines = ["def at_stage(method, s, states, width, begin, h, rates, state):"]
    for number, method in enumerate(METHODS[:EIGHT_IN_TIME]):
        also = f" or method == {EIGHT_IN_TIME}" if number == EIGHT else ""
        # The stages of an implicit method are solved for together.
        for s in range(1, 0 if method.implicit else method.dense_stages):
            lines += [
                f"    if (method == {number}{also}) and s == {s}:",
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
        # A method of equal steps has no embedded formula.
        if method.fine.any():
            lines += [
                "        for q in range(judged):",
                "            for l in range(LANES):",
                f"                fine = {_squares(method.fine)}",
                f"                size = math.sqrt(fine + {_squares(method.coarse)})",
                "                errors[q, l] = h[l] * (fine / size if size != 0.0 else 0.0)",
            ]
    return lines


def _compiled(lines: list[str]) -> Callable:
    """A compiled function from its code."""
    text, file = "\n".join(lines) + "\n", f"<{lines[0].split('(')[0]}>"
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    names = {"LANES": LANES, "math": math}
    exec(compile(text, file, "exec"), names)
    return routine(names[lines[0].removeprefix("def ").split("(")[0]])


# State of a stage; end of a step, and the error estimates of its first rows. `rates` holds `width` rows for each stage,
# those of the states first; all are rows of lanes.
at_stage, step_end = _compiled(_stage_text()), _compiled(_end_text())
