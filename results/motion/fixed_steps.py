"""Fixed-step methods compiled by Numba: Runge-Kutta of orders 4 and 8 in the energy form over φ.

Variants are computed side by side so that the compiler vectorises them, stages at the same angle share the quantities
of the position, and the crank advances by rotations, without trigonometry in a step. The steps of a segment are equal
and end exactly at its end.
"""

import math
from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
from cases import CASES
from numba import njit
from scipy.integrate import DOP853

# Enough that LLVM doesn't unroll the loops over them before vectorising: three times as fast as 16.
LANES = 64
COMPILE = {"error_model": "numpy", "fastmath": {"contract", "arcp", "nsz", "reassoc"}, "nogil": True}
inline = njit(**COMPILE, forceinline=True)


class Tableau(NamedTuple):
    """An explicit Runge-Kutta method."""

    a: np.ndarray
    b: np.ndarray
    c: np.ndarray


RK4 = Tableau(
    np.array([[0, 0, 0, 0], [1 / 2, 0, 0, 0], [0, 1 / 2, 0, 0], [0, 0, 1, 0]]),
    np.array([1, 2, 2, 1]) / 6,
    np.array([0, 1 / 2, 1 / 2, 1]),
)
# The formula of DOP853 that advances the solution, without its error estimate.
RK8 = Tableau(np.ascontiguousarray(DOP853.A[:12, :12]), DOP853.B, DOP853.C[:12])


def constants_of(constants: int, array: str, index: str) -> str:
    """Text of the tuple of a variant's constants: written out, as sliced arrays would keep loops from vectorising."""
    return f"({', '.join(f'{array}[{j}, {index}]' for j in range(constants))})"


@inline
def steps_of(angle, steps):
    """Number of steps over an angle, at `steps` per revolution.

    A single step over a short blow would spoil a method of high order; rounding of a whole number must not add one.
    """
    return max(2, math.ceil(angle * steps / (2 * math.pi) - 1e-9))


def lane_loops(name: str, constants: int) -> tuple[Callable, Callable]:
    """Compiled loops over the lanes of a case: the position's quantities; rates of energy and time."""
    p = constants_of(constants, "p", "i")
    text = f"""
def position(p, c, s, turn_c, turn_s, ram, inertia, moment):
    for i in range({LANES}):
        x, y = c[i] * turn_c[i] - s[i] * turn_s[i], s[i] * turn_c[i] + c[i] * turn_s[i]
        inertia[i], _, moment[i] = reduced(x, y, ram[i], {p})

def rates(p, energy, inertia, moment, power, slowness):
    for i in range({LANES}):
        omega = math.sqrt(2 * energy[i] / inertia[i])
        power[i] = moment[i] + motor(omega, {p})
        slowness[i] = 1 / omega
"""
    case = CASES[name]
    names = {"math": math, "reduced": inline(case.reduced(math.sqrt)), "motor": inline(case.motor)}
    exec(text, names)
    return njit(**COMPILE)(names["position"]), njit(**COMPILE)(names["rates"])


def segment_loop(name: str, constants: int) -> Callable:
    """Compiled steps from one jump to the next.

    Inlined: if the compiler sees that the arrays don't overlap, it vectorises the loops over lanes.
    """
    position, rates = lane_loops(name, constants)

    @inline
    def stages(p, a, c, turn_c, turn_s, x, y, h, energy, ram, inertia, moment, power, slowness, reached):
        for j in range(c.size):
            reached[:] = 0
            for k in range(j):
                share = a[j, k]
                if share != 0:
                    for i in range(LANES):
                        reached[i] += share * power[k, i]
            for i in range(LANES):
                reached[i] = energy[i] + h[i] * reached[i]
            # The first stage is at the position of the previous step's last one.
            if j > 0 and c[j] != c[j - 1]:
                position(p, x, y, turn_c[j], turn_s[j], ram, inertia, moment)
            rates(p, reached, inertia, moment, power[j], slowness[j])

    @inline
    def segment(p, a, b, c, n, x, y, h, energy, time, ram, inertia, moment, power, slowness):
        turn_c, turn_s, reached = np.empty((c.size, LANES)), np.empty((c.size, LANES)), np.empty(LANES)
        for j in range(c.size):
            for i in range(LANES):
                turn_c[j, i], turn_s[j, i] = math.cos(c[j] * h[i]), math.sin(c[j] * h[i])
        position(p, x, y, turn_c[0], turn_s[0], ram, inertia, moment)
        for _ in range(n):
            stages(p, a, c, turn_c, turn_s, x, y, h, energy, ram, inertia, moment, power, slowness, reached)
            for j in range(c.size):
                share = b[j]
                for i in range(LANES):
                    energy[i] += share * h[i] * power[j, i]
                    time[i] += share * h[i] * slowness[j, i]
            for i in range(LANES):
                cos, sin = turn_c[-1, i], turn_s[-1, i]
                x[i], y[i] = x[i] * cos - y[i] * sin, y[i] * cos + x[i] * sin

    return segment


@cache
def lanes_over_angle(name: str, constants: int) -> Callable:
    """Compiled Runge-Kutta method over φ in lanes, for the variants from `low` to `high`."""
    segment = segment_loop(name, constants)

    @njit(**COMPILE)
    def solve(p, edges, rams, first, steps, a, b, c, low, high):
        out = np.empty((2, high - low))
        q, power, slowness = np.empty((constants, LANES)), np.empty((c.size, LANES)), np.empty((c.size, LANES))
        x, y, h, ram = np.empty(LANES), np.empty(LANES), np.empty(LANES), np.empty(LANES)
        energy, time, inertia, moment = np.empty(LANES), np.empty(LANES), np.empty(LANES), np.empty(LANES)
        for start in range(low, high, LANES):
            # Lanes beyond the last variant repeat it.
            v = np.minimum(np.arange(start, start + LANES), high - 1)
            for i in range(LANES):
                q[:, i], energy[i], time[i] = p[:, v[i]], first[v[i]], 0
            for k in range(rams.shape[0]):
                longest = 0.0
                for i in range(LANES):
                    x[i], y[i], ram[i] = math.cos(edges[k, v[i]]), math.sin(edges[k, v[i]]), rams[k, v[i]]
                    h[i] = edges[k + 1, v[i]] - edges[k, v[i]]
                    longest = max(longest, h[i])
                n = steps_of(longest, steps)
                h /= n
                segment(q, a, b, c, n, x, y, h, energy, time, ram, inertia, moment, power, slowness)
            for i in range(min(LANES, high - start)):
                out[0, start - low + i] = math.sqrt(2 * energy[i] / inertia[i])
                out[1, start - low + i] = time[i]
        return out

    return solve
