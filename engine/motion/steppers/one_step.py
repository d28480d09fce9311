"""What steps in time are made of, in lanes: integrals over their stages, estimates, polynomials within."""

import math

import numpy as np

from engine.compiling.decorators import inlined, routine
from engine.cycle.panels.lanes import Memory
from engine.laws.runge_kutta import DENSE_PARTS, ORDER_EIGHT, Method
from engine.motion.steppers.places import add_share
from engine.motion.steppers.radau import ORDER_NINE

MOST_STAGES = max(method.dense_stages for method in (ORDER_EIGHT, ORDER_NINE))
# Rows of stages as numbers that the compiler doesn't know: what takes one is then compiled once, not for each.
ROW_OF = np.arange(15 * MOST_STAGES)

# Estimates of as many orders as an error is estimated from.
ROOTS = 2


@routine
def add_weighted(wide: int, weights: np.ndarray, step: Memory, stages: Memory, row: int, total: Memory) -> None:
    """Add to a total the integral over the step of what stands at the stages, in rows from `row` on."""
    for s in range(weights.shape[0]):
        if weights[s] != 0.0:
            add_share(wide, weights[s], step, stages[row + s], total)


@routine
def estimate(
    wide: int, method: Method, step: Memory, stages: Memory, row: int, work: Memory, at: int, error: Memory
) -> None:
    """Estimated error of such an integral, with its sign, from formulas that vanish up to lower orders.

    ROOTS rows of `work` are to work in, from `at` on. Source: as of DOP853. Each is the root of the squares of all of
    its order: one alone happens to be zero at some lengths of a step, at which nothing of what is missed would be seen.
    """
    root_of_squares(wide, method.coarse, step, stages, row, error, work[at + 1])
    root_of_squares(wide, method.fine, step, stages, row, error, work[at])
    for lane in range(wide):
        fine, coarse = work[at, lane], work[at + 1, lane]
        error[lane] = math.copysign(fine * fading(fine, coarse), error[lane])


@inlined
def fading(fine: float, coarse: float) -> float:
    """Which share of the coarse the fine one is, at most 1."""
    size = math.sqrt(fine * fine + coarse * coarse)
    return fine / size if size != 0.0 else size


@routine
def root_of_squares(
    wide: int, formulas: np.ndarray, step: Memory, stages: Memory, row: int, first: Memory, root: Memory
) -> None:
    """What the first of some formulas gives, and the root of the squares of all."""
    for lane in range(wide):
        root[lane] = 0.0
    for i in range(formulas.shape[0]):
        formula = formulas.shape[0] - 1 - i
        for lane in range(wide):
            first[lane] = 0.0
        add_weighted(wide, formulas[formula], step, stages, row, first)
        for lane in range(wide):
            root[lane] = math.sqrt(root[lane] * root[lane] + first[lane] * first[lane])


@routine
def make_polynomial(wide: int, method: Method, step: Memory, stages: Memory, row: int, parts: Memory, at: int) -> None:
    """Parts of the polynomial that follows a quantity within the step, from all stages of its derivative."""
    for i in range(DENSE_PARTS):
        for lane in range(wide):
            parts[at + i, lane] = 0.0
        for s in range(method.dense_stages):
            if method.parts[i, s] != 0.0:
                add_share(wide, method.parts[i, s], step, stages[row + s], parts[at + i])


@inlined
def value_within(parts: Memory, at: int, lane: int, begin: float, share: float) -> float:
    """Value of a polynomial at a share of the step."""
    value, rest = 0.0, 1.0 - share
    for i in range(DENSE_PARTS):
        value = (value + parts[at + DENSE_PARTS - 1 - i, lane]) * (share if i % 2 == 0 else rest)
    return begin + value


@inlined
def slope_within(parts: Memory, at: int, lane: int, share: float) -> float:
    """Derivative of a polynomial by the share of the step."""
    value, slope, rest = 0.0, 0.0, 1.0 - share
    for i in range(DENSE_PARTS):
        value += parts[at + DENSE_PARTS - 1 - i, lane]
        slope = slope * share + value if i % 2 == 0 else slope * rest - value
        value *= share if i % 2 == 0 else rest
    return slope


@inlined
def cubic_extreme(begin: float, rise: float, near: float, far: float) -> tuple[float, float, float]:
    """Extreme of the cubic over an interval, by its change and its slopes at both ends, both over the interval.

    Returns its value, its place in the interval and the second derivative there; the begin where there is none.
    """
    a, b = 3.0 * (near + far - 2.0 * rise), 3.0 * rise - 2.0 * near - far
    root = math.sqrt(b * b - a * near)
    t = near / (root - b) if near > 0.0 else -near / (root + b)
    inside = ((near > 0.0) != (far > 0.0)) & (t > 0.0) & (t < 1.0)
    value = begin + t * (near + t * (b + t * a / 3.0))
    return (value if inside else begin), (t if inside else 0.0), (b + b + 2.0 * a * t if inside else 0.0)
