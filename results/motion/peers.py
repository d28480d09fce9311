"""Other methods to compute the motion: heyoka.py, SciPy, and fixed steps compiled by Numba.

Every method restarts at the jumps of each variant, whose angles are known; none has to find them. All use
the energy form over φ, dE = (M + M_motor) dφ, ω = √(2E/I), dt = dφ/ω: it needs no dI/dφ, no search for the end, and
was the fastest for heyoka too (in time its steps cost four times as much for the same error). Commit 7392f700 also had
SciPy's LSODA and RK4 variant by variant, over φ and in time, all slower than DOP853 at an error of 1e-7 or less.
"""

import math
from collections.abc import Callable
from functools import cache, partial
from typing import NamedTuple

import heyoka
import numpy as np
from cases import CASES, Batch, Case
from fixed_steps import COMPILE, RK4, RK8, Tableau, constants_of, lanes_over_angle
from numba import njit
from scipy.integrate import solve_ivp

HEYOKA_LANES = 16


class Peer(NamedTuple):
    """A method.

    Attributes
    ----------
    name : str
    settings : tuple of float
        Tolerances, or steps per revolution.
    prepare : callable
        Given (case, batch, setting), the function of a slice of variants that returns ω and t, (2, variants).
    """

    name: str
    settings: tuple[float, ...]
    prepare: Callable[[Case, Batch, float], Callable[[slice], np.ndarray]]


def inertia(case: Case, batch: Batch, edge: int) -> np.ndarray:
    """Reduced inertia at the start (0) or the end (-1)."""
    phi = batch.edges[edge]
    return case.reduced(np.sqrt)(np.cos(phi), np.sin(phi), batch.ram[0], batch.p)[0]


def first_energy(case: Case, batch: Batch) -> np.ndarray:
    """Kinetic energy at the start."""
    return inertia(case, batch, 0) * case.speed**2 / 2


# heyoka.py


def taylor_system(case: Case, constants: int) -> list:
    """Energy form over φ as heyoka's expressions; the parameters are p, the force on the ram and the first energy.

    The energy is in units of its first value: heyoka measures its error relative to its largest variable.
    """
    energy, time = heyoka.make_vars("energy", "time")
    p, phi = [heyoka.par[i] for i in range(constants)], heyoka.time
    ram, first = heyoka.par[constants], heyoka.par[constants + 1]
    reduced_inertia, _, moment = case.reduced(heyoka.sqrt)(heyoka.cos(phi), heyoka.sin(phi), ram, p)
    omega = heyoka.sqrt(energy * (2.0 * first) / reduced_inertia)
    return [(energy, (moment + case.motor(omega, p)) / first), (time, 1.0 / omega)]


def prepare_heyoka(case: Case, batch: Batch, tolerance: float) -> Callable:
    """Batch integrator, one variant per lane, compiled once."""
    constants = batch.p.shape[0]
    integrator = heyoka.taylor_adaptive_batch(
        taylor_system(case, constants),
        state=np.ones((2, HEYOKA_LANES)),
        pars=np.ones((constants + 2, HEYOKA_LANES)),
        tol=tolerance,
    )
    first, last = first_energy(case, batch), inertia(case, batch, -1)

    def solve(part: slice) -> np.ndarray:
        out = np.empty((2, part.stop - part.start))
        state, pars = integrator.state, integrator.pars
        for start in range(part.start, part.stop, HEYOKA_LANES):
            # Lanes beyond the last variant repeat it.
            v = np.minimum(np.arange(start, start + HEYOKA_LANES), part.stop - 1)
            pars[:constants], pars[constants + 1] = batch.p[:, v], first[v]
            state[0], state[1] = 1.0, 0.0
            edges, rams = batch.edges[:, v], batch.ram[:, v]
            integrator.set_time(edges[0])
            for ram, end in zip(rams, edges[1:], strict=True):
                pars[constants] = ram
                integrator.propagate_until(end)
            count = min(HEYOKA_LANES, part.stop - start)
            out[:, start - part.start : start - part.start + count] = state[:, :count]
        out[0] = np.sqrt(2 * out[0] * first[part] / last[part])
        return out

    return solve


# SciPy: all variants of a part in one system, so that Python's overhead per step is shared


@cache
def stacked_rates(name: str, constants: int) -> Callable:
    """Compiled rates of (energy, time), alternating, of all variants, for a position of each."""
    case = CASES[name]
    reduced, motor = njit(**COMPILE)(case.reduced(math.sqrt)), njit(**COMPILE)(case.motor)
    names = {}
    exec(f"def variant(p, i):\n    return {constants_of(constants, 'p', 'i')}\n", names)
    variant = njit(**COMPILE)(names["variant"])

    @njit(**COMPILE)
    def rates(state, c, s, length, ram, first, p):
        out = np.empty_like(state)
        for i in range(c.size):
            q = variant(p, i)
            inertia, _, moment = reduced(c[i], s[i], ram[i], q)
            omega = math.sqrt(2 * state[2 * i] * first[i] / inertia)
            out[2 * i] = length[i] * (moment + motor(omega, q)) / first[i]
            out[2 * i + 1] = length[i] / omega
        return out

    return rates


def prepare_scipy(case: Case, batch: Batch, tolerance: float, **method: object) -> Callable:
    """Solve every segment over a fraction 0 … 1, which is common to all variants."""
    rates = stacked_rates(case.name, batch.p.shape[0])
    first, last = first_energy(case, batch), inertia(case, batch, -1)

    def solve(part: slice) -> np.ndarray:
        p, edges, rams = (np.ascontiguousarray(rows[:, part]) for rows in (batch.p, batch.edges, batch.ram))
        start, length = edges[:-1], np.diff(edges, axis=0)
        state = np.zeros(2 * p.shape[1])
        state[::2] = 1.0
        for k, ram in enumerate(rams):

            def rhs(share: float, state: np.ndarray, k: int = k, ram: np.ndarray = ram) -> np.ndarray:
                phi = start[k] + share * length[k]
                return rates(state, np.cos(phi), np.sin(phi), length[k], ram, first[part], p)

            state = solve_ivp(rhs, (0.0, 1.0), state, rtol=tolerance, atol=tolerance, **method).y[:, -1]
        return np.stack((np.sqrt(2 * state[::2] * first[part] / last[part]), state[1::2]))

    return solve


# Fixed steps


def prepare_lanes(case: Case, batch: Batch, steps: float, tableau: Tableau) -> Callable:
    kernel, first = lanes_over_angle(case.name, batch.p.shape[0]), first_energy(case, batch)
    arguments = (batch.p, batch.edges, batch.ram, first, float(steps), *tableau)
    return lambda part: kernel(*arguments, part.start, part.stop)


TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-15)
LANE_STEPS = (8, 16, 32, 64, 128, 256, 512)
FEW_STEPS = (4, 6, 8, 12, 16, 24, 32, 48, 64)
PEERS = (
    Peer("heyoka.py batch", TOLERANCES, prepare_heyoka),
    Peer("SciPy DOP853", TOLERANCES[:-1], partial(prepare_scipy, method="DOP853")),
    Peer("RK4 over φ, lanes", LANE_STEPS, partial(prepare_lanes, tableau=RK4)),
    Peer("RK8 over φ, lanes", FEW_STEPS, partial(prepare_lanes, tableau=RK8)),
)
