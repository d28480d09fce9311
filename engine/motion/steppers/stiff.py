"""The energy form where a characteristic is steep: Lobatto IIIC of order four, which is L-stable.

Between two nodes dE/dφ = M(φ, √(2E/I)) is collocated at the first node, the middle and the last node, so it needs
the same tables as the explicit method, and steps of any length are stable: a motor that holds its speed within a
fraction of a step is simply followed. The three energies are found by Newton's method; ∂M/∂E = ∂M/∂ω/(Iω).

Source: E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, section IV.5.
"""

import math

import numpy as np

from engine.compiling.jit import over_variants, scalar
from engine.equal_positions.rows import larger, smaller
from engine.laws.motor_characteristics import induction_motor, induction_motor_slope
from engine.motion.steppers.energy_form import ABOVE, ANGLE, BELOW, NEAR_REST, TIME, Course, Drive, Limits, Tables

# Rows of the method's matrix, for the first node, the middle and the last node; the last row is its weights as well.
FIRST = (1 / 6, -1 / 3, 1 / 6)
MIDDLE = (1 / 6, 5 / 12, -1 / 12)
LAST = (1 / 6, 2 / 3, 1 / 6)

MOST_ROUNDS = 60
SOLVED = 1e-14


@scalar
def moment_at(
    tables: Tables, drive: Drive, laws: np.ndarray, j: int, v: int, omega: float, works: np.ndarray
) -> tuple[float, float]:
    """Moment of everything at place j and its slope ∂M/∂ω; the motors' and each channel's into `works`."""
    motor, slope = drive.line[0, v] + drive.line[1, v] * omega, drive.line[1, v]
    for i in range(drive.kloss.shape[0]):
        most, slip, rotor = drive.kloss[i, 0, v], drive.kloss[i, 1, v], drive.kloss[i, 2, v]
        synchronous, ratio = drive.kloss[i, 3, v], drive.kloss[i, 4, v]
        motor += ratio * induction_motor(most, slip, rotor, synchronous, ratio * omega)
        slope += ratio * ratio * induction_motor_slope(most, slip, rotor, synchronous, ratio * omega)
    works[0] = total = motor
    for channel in range(tables.loads.shape[0]):
        linear, square = tables.loads[channel, 1, j, v], tables.loads[channel, 2, j, v]
        works[channel + 1] = tables.loads[channel, 0, j, v] + omega * (linear + omega * square)
        slope += linear + 2.0 * omega * square
    for law in range(laws.shape[0]):
        moment = tables.powers[law, j, v] * omega ** drive.exponents[law, v]
        works[laws[law] + 1] += moment
        slope += drive.exponents[law, v] * moment / omega
    for channel in range(tables.loads.shape[0]):
        total += works[channel + 1]
    return total, slope


@scalar
def solve3(a: np.ndarray, b: np.ndarray) -> None:
    """Solve the 3 × 3 system a x = b in place of b, by elimination with pivots."""
    for i in range(3):
        best = i
        for r in range(i + 1, 3):
            if abs(a[r, i]) > abs(a[best, i]):
                best = r
        for c in range(3):
            a[i, c], a[best, c] = a[best, c], a[i, c]
        b[i], b[best] = b[best], b[i]
        for r in range(i + 1, 3):
            factor = a[r, i] / a[i, i]
            for c in range(i, 3):
                a[r, c] -= factor * a[i, c]
            b[r] -= factor * b[i]
    for i in range(2, -1, -1):
        for c in range(i + 1, 3):
            b[i] -= a[i, c] * b[c]
        b[i] /= a[i, i]


@scalar
def solve_step(
    tables: Tables,
    drive: Drive,
    laws: np.ndarray,
    k: int,
    v: int,
    energy: float,
    e: np.ndarray,
    omega: np.ndarray,
    works: np.ndarray,
) -> bool:
    """Find the three energies of step k into `e`, speeds into `omega` and moments into `works`; True where found."""
    h = tables.steps[k, v]
    a, b, moment, slope = np.empty((3, 3)), np.empty(3), np.empty(3), np.empty(3)
    e[:] = energy
    for _ in range(MOST_ROUNDS):
        for j in range(3):
            inertia = tables.inertia[2 * k + j, v]
            omega[j] = math.sqrt(2.0 * e[j] / inertia)
            moment[j], by_speed = moment_at(tables, drive, laws, 2 * k + j, v, omega[j], works[j])
            slope[j] = by_speed / (inertia * omega[j])
        for i in range(3):
            row = FIRST if i == 0 else (MIDDLE if i == 1 else LAST)
            b[i] = energy + h * (row[0] * moment[0] + row[1] * moment[1] + row[2] * moment[2]) - e[i]
            for j in range(3):
                a[i, j] = (1.0 if i == j else 0.0) - h * row[j] * slope[j]
        solve3(a, b)
        worst = 0.0
        for j in range(3):
            worst = larger(worst, abs(b[j]) / e[j])
            e[j] = larger(e[j] + b[j], 0.1 * e[j])
        if not worst >= 0.0:
            return False
        if worst < SOLVED:
            return e[2] > 0.0
    return False


@over_variants
def stiff_energy_form(
    begin: int,
    end: int,
    tables: Tables,
    drive: Drive,
    laws: np.ndarray,
    energy: np.ndarray,
    limits: Limits,
    record: np.ndarray,
    course: Course,
) -> None:
    """Carry variants begin … end − 1 to the end of their stretch; arguments as of `energy_form`'s stepper.

    `laws` (laws,) holds the channel of each power law.
    """
    cycle, sorts = tables.steps.shape[0], tables.loads.shape[0] + 1
    e, omega, works = np.empty(3), np.empty(3), np.empty((3, sorts))
    for v in range(begin, end):
        here, t, done, stop = energy[v], 0.0, 0, -1
        w = math.sqrt(2.0 * here / tables.inertia[0, v])
        course.slowest[v] = course.fastest[v] = w
        course.peak[v] = course.squares[v] = 0.0
        course.works[:, v] = 0.0
        while stop < 0:
            if done < record.shape[1]:
                record[0, done, v], record[1, done, v] = here, t
            k = done % cycle
            if done >= limits.steps[v]:
                stop = ANGLE
                break
            if not solve_step(tables, drive, laws, k, v, here, e, omega, works):
                stop = NEAR_REST
                break
            h = tables.steps[k, v]
            after = t + h * (LAST[0] / omega[0] + LAST[1] / omega[1] + LAST[2] / omega[2])
            w = math.sqrt(2.0 * e[2] / tables.inertia[2 * k + 2, v])
            if w >= limits.above[v]:
                stop = ABOVE
            elif w <= limits.below[v]:
                stop = BELOW
            elif after >= limits.time[v]:
                stop = TIME
            else:
                here, t, done = e[2], after, done + 1
                course.slowest[v], course.fastest[v] = smaller(course.slowest[v], w), larger(course.fastest[v], w)
                for j in range(3):
                    course.squares[v] += h * LAST[j] * works[j, 0] * works[j, 0] / omega[j]
                    for sort in range(sorts):
                        course.works[sort, v] += h * LAST[j] * works[j, sort]
                course.peak[v] = larger(course.peak[v], larger(abs(works[0, 0]), abs(works[2, 0])))
        course.energy[v], course.time[v], course.made[v], course.stop[v] = here, t, done, stop
