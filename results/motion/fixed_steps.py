"""Fixed-step methods compiled by Numba: Runge-Kutta of orders 4 and 8 in the energy form over φ, and plain RK4.

In lanes: variants go side by side so that the compiler vectorises them, the position's quantities are shared by stages
at the same angle, and the crank is turned on by rotations, without trigonometry in a step. The steps of a segment
are equal and end on its end. Plain: variant by variant with ω as the state, over φ or in time; in time the step across
an angle is done again over φ and lands on that angle (M. Hénon, On the numerical computation of Poincaré maps, 1982).
"""

import math
from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
from cases import CASES
from numba import njit
from scipy.integrate import DOP853

# So many that LLVM doesn't unroll the loops over them, which it would do before vectorising: three times as fast as 16.
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
    """Count of steps over an angle, at `steps` per revolution.

    A single step over a short blow would spoil a method of high order; rounding of a whole number must not add one.
    """
    return max(2, math.ceil(angle * steps / (2 * math.pi) - 1e-9))


# In lanes


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

    Inlined: where the compiler sees that the arrays are apart from each other, it vectorises the loops over lanes.
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
            # The first stage stands where the last one of the step before stood.
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


# Plain


def plain_steps(name: str, constants: int) -> tuple[Callable, Callable, Callable]:
    """Compiled: a variant's constants; an RK4 step of (φ, ω) in time; one of (ω, t) over φ."""
    case, names = CASES[name], {}
    reduced, motor = inline(case.reduced(math.sqrt)), inline(case.motor)
    exec(f"def variant(p, v):\n    return {constants_of(constants, 'p', 'v')}\n", names)

    @njit(**COMPILE)
    def acceleration(phi, omega, ram, p):
        inertia, inertia_phi, moment = reduced(math.cos(phi), math.sin(phi), ram, p)
        return (moment + motor(omega, p) - omega * omega * inertia_phi / 2) / inertia

    @njit(**COMPILE)
    def in_time(phi, omega, dt, ram, p):
        e1 = acceleration(phi, omega, ram, p)
        v2 = omega + dt / 2 * e1
        e2 = acceleration(phi + dt / 2 * omega, v2, ram, p)
        v3 = omega + dt / 2 * e2
        e3 = acceleration(phi + dt / 2 * v2, v3, ram, p)
        v4 = omega + dt * e3
        e4 = acceleration(phi + dt * v3, v4, ram, p)
        return phi + dt / 6 * (omega + 2 * v2 + 2 * v3 + v4), omega + dt / 6 * (e1 + 2 * e2 + 2 * e3 + e4)

    @njit(**COMPILE)
    def over_angle(phi, omega, h, ram, p):
        e1 = acceleration(phi, omega, ram, p) / omega
        v2 = omega + h / 2 * e1
        e2 = acceleration(phi + h / 2, v2, ram, p) / v2
        v3 = omega + h / 2 * e2
        e3 = acceleration(phi + h / 2, v3, ram, p) / v3
        v4 = omega + h * e3
        e4 = acceleration(phi + h, v4, ram, p) / v4
        return omega + h / 6 * (e1 + 2 * e2 + 2 * e3 + e4), h / 6 * (1 / omega + 2 / v2 + 2 / v3 + 1 / v4)

    return inline(names["variant"]), in_time, over_angle


@cache
def plain_in_time(name: str, constants: int) -> Callable:
    """Compiled RK4 in time, with `steps` steps per revolution at the motor's top speed."""
    variant, in_time, over_angle = plain_steps(name, constants)
    top_speed, first = CASES[name].top_speed, CASES[name].speed

    @njit(**COMPILE)
    def solve(p, edges, rams, steps, low, high):
        out = np.empty((2, high - low))
        dt = 2 * math.pi / (top_speed * steps)
        for v in range(low, high):
            q = variant(p, v)
            phi, omega, t = edges[0, v], first, 0.0
            for k in range(rams.shape[0]):
                end, ram = edges[k + 1, v], rams[k, v]
                while True:
                    reached = in_time(phi, omega, dt, ram, q)
                    if not reached[0] < end:
                        break
                    phi, omega = reached
                    t += dt
                omega, rest = over_angle(phi, omega, end - phi, ram, q)
                phi, t = end, t + rest
            out[0, v - low], out[1, v - low] = omega, t
        return out

    return solve


@cache
def plain_over_angle(name: str, constants: int) -> Callable:
    """Compiled RK4 over φ, with `steps` steps per revolution."""
    variant, _, over_angle = plain_steps(name, constants)
    first = CASES[name].speed

    @njit(**COMPILE)
    def solve(p, edges, rams, steps, low, high):
        out = np.empty((2, high - low))
        for v in range(low, high):
            q = variant(p, v)
            omega, t = first, 0.0
            for k in range(rams.shape[0]):
                start, length = edges[k, v], edges[k + 1, v] - edges[k, v]
                n = steps_of(length, steps)
                for j in range(n):
                    omega, dt = over_angle(start + j * (length / n), omega, length / n, rams[k, v], q)
                    t += dt
            out[0, v - low], out[1, v - low] = omega, t
        return out

    return solve
