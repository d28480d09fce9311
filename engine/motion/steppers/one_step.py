"""One step in the energy form, dE/dφ = M(φ, √(2E/I)), of all lanes of a block, explicit or implicit.

Stages stand at places of their own, whose rows are filled beforehand and used again every cycle.
"""

import math

import numpy as np

from engine.compiling.decorators import inlined, routine
from engine.cycle.panels.lanes import Memory
from engine.cycle.panels.series import larger
from engine.laws.runge_kutta import DENSE_PARTS, ORDER_EIGHT, Method
from engine.motion.steppers.places import Form, add_share, moments_at_place, slopes_at_place
from engine.motion.steppers.radau import ORDER_NINE

MOST_STAGES = max(method.dense_stages for method in (ORDER_EIGHT, ORDER_NINE))
# Rows of stages: speed, moment of the motors, moment of everything, ∂M/∂E of both, energy, 1/ω, motors' moment squared
# by 1/ω, moment of a channel; then the linear equations of an implicit step, row by row with their right-hand sides.
SPEED, FROM_MOTORS, MOMENT, MOTOR_SLOPE, SLOPE = (i * MOST_STAGES for i in range(5))
ENERGY, SLOWNESS, SQUARE, CHANNEL, EQUATIONS = (i * MOST_STAGES for i in range(5, 10))
STAGE_ROWS = EQUATIONS + ORDER_NINE.stages * (ORDER_NINE.stages + 1)

# The same rows as numbers that the compiler doesn't know: what takes one is then compiled once, not for each.
ROW_OF = np.arange(STAGE_ROWS)

# Estimates of as many orders as an error is estimated from.
ROOTS = 2

# Newton's method for the stages of an implicit step: most rounds, when they are found, or nearly so, and the least
# share of an energy that it goes to in a round.
MOST_ROUNDS, SOLVED, NEARLY_SOLVED, LEAST_SHARE = 25, 1e-14, 1e-11, 0.1


@routine
def make_stages(
    begin: int,
    end: int,
    wide: int,
    method: Method,
    form: Form,
    drive: Memory,
    exponents: Memory,
    places: Memory,
    first: int,
    energy: Memory,
    step: Memory,
    stages: Memory,
) -> None:
    """Stages begin … end − 1 of a step whose places begin at row `first`; `energy` [J] and `step` [rad] are rows.

    Those of an implicit step are found together, as many as they are.
    """
    if method.implicit:
        solve_stages(wide, method, form, drive, exponents, places, first, energy, step, stages)
        return
    for s in range(begin, end):
        for lane in range(wide):
            stages[ENERGY + s, lane] = energy[lane]
        for k in range(s):
            if method.matrix[s, k] != 0.0:
                add_share(wide, method.matrix[s, k], step, stages[MOMENT + k], stages[ENERGY + s])
        stage_moments(s, wide, method, form, drive, exponents, places, first, stages)


@routine
def stage_moments(
    s: int,
    wide: int,
    method: Method,
    form: Form,
    drive: Memory,
    exponents: Memory,
    places: Memory,
    first: int,
    stages: Memory,
) -> None:
    """Speed and moments of a stage by its energy."""
    at, motors, moment = first + form.width * method.place_of[s], stages[FROM_MOTORS + s], stages[MOMENT + s]
    moments_at_place(wide, form, drive, exponents, places, at, stages[ENERGY + s], stages[SPEED + s], motors, moment)


@routine
def solve_stages(
    wide: int,
    method: Method,
    form: Form,
    drive: Memory,
    exponents: Memory,
    places: Memory,
    first: int,
    energy: Memory,
    step: Memory,
    stages: Memory,
) -> None:
    """Stages of an implicit step, by Newton's method; those of a lane where it fails are no numbers.

    SLOWNESS is 1 of a lane whose energies are found, −1 of one that has none.
    """
    count = method.stages
    for s in range(count):
        for lane in range(wide):
            stages[ENERGY + s, lane] = energy[lane]
    for lane in range(wide):
        stages[SLOWNESS, lane] = 0.0
    for _ in range(MOST_ROUNDS):
        for s in range(count):
            stage_moments(s, wide, method, form, drive, exponents, places, first, stages)
            at = first + form.width * method.place_of[s]
            slopes_at_place(
                wide, form, drive, exponents, places, at, stages[SPEED + s], stages[MOTOR_SLOPE + s], stages[SLOPE + s]
            )
        lay_equations(wide, method, energy, step, stages)
        solve_equations(wide, count, stages)
        if take_corrections(wide, count, stages) == 0.0:
            break
    for s in range(count):
        for lane in range(wide):
            # Rounding may keep corrections of a steep motor's energies from getting as small as asked.
            nearly = (stages[SLOWNESS, lane] == 0.0) & (stages[CHANNEL, lane] < NEARLY_SOLVED)
            found = (stages[SLOWNESS, lane] > 0.0) | nearly
            stages[ENERGY + s, lane] = stages[ENERGY + s, lane] if found else math.nan
        stage_moments(s, wide, method, form, drive, exponents, places, first, stages)
    # Of a steep motor the moment is less sure by the energies than these are themselves.
    for s in range(count):
        for lane in range(wide):
            moment = 0.0
            for k in range(count):
                moment += method.inverse[s, k] * (stages[ENERGY + k, lane] - energy[lane])
            moment = moment / step[lane] if step[lane] > 0.0 else stages[MOMENT + s, lane]
            stages[FROM_MOTORS + s, lane] += moment - stages[MOMENT + s, lane]
            stages[MOMENT + s, lane] = moment


@routine
def lay_equations(wide: int, method: Method, energy: Memory, step: Memory, stages: Memory) -> None:
    """Linear equations for the corrections of the energies of an implicit step's stages."""
    count = method.stages
    for s in range(count):
        row = EQUATIONS + s * (count + 1)
        for lane in range(wide):
            stages[row + count, lane] = energy[lane] - stages[ENERGY + s, lane]
        for k in range(count):
            share = method.matrix[s, k]
            add_share(wide, share, step, stages[MOMENT + k], stages[row + count])
            for lane in range(wide):
                stages[row + k, lane] = (1.0 if k == s else 0.0) - share * step[lane] * stages[SLOPE + k, lane]


@routine
def solve_equations(wide: int, count: int, stages: Memory) -> None:
    """Solve them by Gauss' elimination; the solution is where the right-hand sides were."""
    for pivot in range(count):
        own = EQUATIONS + pivot * (count + 1)
        for k in range(pivot + 1, count + 1):
            for lane in range(wide):
                stages[own + k, lane] /= stages[own + pivot, lane]
        for s in range(count):
            row = EQUATIONS + s * (count + 1)
            for k in range(pivot + 1, count + 1 if s != pivot else 0):
                for lane in range(wide):
                    stages[row + k, lane] -= stages[row + pivot, lane] * stages[own + k, lane]


@routine
def take_corrections(wide: int, count: int, stages: Memory) -> float:
    """Correct the energies of lanes where they aren't found yet; in how many lanes they aren't after that."""
    for lane in range(wide):
        stages[CHANNEL, lane] = 0.0
    for s in range(count):
        by = EQUATIONS + s * (count + 1) + count
        for lane in range(wide):
            # What isn't a number stays none.
            size = abs(stages[by, lane]) / stages[ENERGY + s, lane]
            stages[CHANNEL, lane] = stages[CHANNEL, lane] if stages[CHANNEL, lane] > size else size
            e = stages[ENERGY + s, lane]
            better = larger(e + stages[by, lane], LEAST_SHARE * e)
            stages[ENERGY + s, lane] = better if stages[SLOWNESS, lane] == 0.0 else e
    pending = 0.0
    for lane in range(wide):
        worst = stages[CHANNEL, lane]
        now = (1.0 if worst < SOLVED else 0.0) if worst < math.inf else -1.0
        stages[SLOWNESS, lane] = now if stages[SLOWNESS, lane] == 0.0 else stages[SLOWNESS, lane]
        pending += 1.0 if stages[SLOWNESS, lane] == 0.0 else 0.0
    return pending


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
