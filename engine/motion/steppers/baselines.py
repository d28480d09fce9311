"""Two textbook methods as baselines: frozen moments, and the trapezoid rule for the work.

Both go over the nodes of the same tables as the energy form, for all variants at once, and estimate their error by
halving: once over the nodes alone, once over nodes and middles. They are slow to converge, of order one and two
where the energy form has order four; what they are for is to show that.

Sources: K. V. Frolov et al., Theory of Mechanisms and Machines (intervals in which I and M are constant); E. Hairer,
S. P. Nørsett and G. Wanner, Solving Ordinary Differential Equations I (Euler's and Heun's method and their orders).
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.steppers.energy_form import Tables

# One step of a method: energy after it and the time it takes, from the place before, the place after and the energy.
Step = Callable[["_Places", int, int, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


class Baseline(NamedTuple):
    """Motion by a baseline, all (nodes, variants); NaN from where the machine stops.

    Attributes
    ----------
    omega, time : ndarray
        Speed [rad/s] and time [s] at the nodes of the tables, cycle after cycle.
    omega_error, time_error : ndarray
        Error estimates.
    """

    omega: np.ndarray
    time: np.ndarray
    omega_error: np.ndarray
    time_error: np.ndarray


def frozen_moments(
    dynamics: Dynamics, variants: Variants, tables: Tables, energy: np.ndarray, cycles: int = 1
) -> Baseline:
    """Motion with I and M frozen at the beginning of every step, where it is one of constant acceleration.

    At the end of a step both are set to their true values. The kinetic energy is what is carried over then, not the
    speed: it holds what ½ω²·dI/dφ does, which frozen I leaves out. Of order one.

    Parameters
    ----------
    dynamics : Dynamics
    variants : Variants
    tables : Tables
        Of one cycle, or of the stretch to be gone through once.
    energy : ndarray (variants,)
        At the first node [J].
    cycles : int
        How often the tables are gone through.
    """
    return _by_halving(_frozen_step, 1, _Places(dynamics, variants, tables), energy, cycles)


def trapezoids(dynamics: Dynamics, variants: Variants, tables: Tables, energy: np.ndarray, cycles: int = 1) -> Baseline:
    """Motion by the trapezoid rule, for the work ∫M dφ and for the time ∫dφ/ω.

    The speed at the end of a step, on which M there depends, is first taken from the moment at its beginning. Of order
    two.

    Parameters
    ----------
    dynamics, variants, tables, energy, cycles
        As of `frozen_moments`.
    """
    return _by_halving(_trapezoid, 2, _Places(dynamics, variants, tables), energy, cycles)


class _Places:
    """The machine at the places of tables."""

    def __init__(self, dynamics: Dynamics, variants: Variants, tables: Tables) -> None:
        self.dynamics, self.variants, self.tables = dynamics, variants, tables
        self.count = tables.inertia.shape[0] - 1

    def omega(self, place: int, energy: np.ndarray) -> np.ndarray:
        """ω [rad/s]."""
        return np.sqrt(2.0 * energy / self.tables.inertia[place])

    def moment(self, place: int, omega: np.ndarray) -> np.ndarray:
        """M(φ, ω) [N·m]."""
        here = self.tables.at(slice(place, place + 1))
        return self.dynamics.moments(self.variants, here, omega[None]).total[0]

    def distance(self, place: int, stride: int) -> np.ndarray:
        """From a place to that `stride` places on: half a step or a whole one [rad]."""
        return 0.5 * stride * self.tables.steps[place // 2]


def _frozen_step(
    places: _Places, here: int, there: int, energy: np.ndarray, h: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    omega = places.omega(here, energy)
    after = energy + h * places.moment(here, omega)
    # Uniformly accelerated with I as at the beginning.
    return after, 2.0 * h / (omega + places.omega(here, after))


def _trapezoid(
    places: _Places, here: int, there: int, energy: np.ndarray, h: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    omega = places.omega(here, energy)
    before = places.moment(here, omega)
    ahead = places.moment(there, places.omega(there, energy + h * before))
    after = energy + 0.5 * h * (before + ahead)
    return after, 0.5 * h * (1.0 / omega + 1.0 / places.omega(there, after))


def _by_halving(step: Step, order: int, places: _Places, energy: np.ndarray, cycles: int) -> Baseline:
    # What stops has no root for its speed: NaN from there on.
    with np.errstate(all="ignore"):
        (coarse, slow), (omega, time) = (_march(step, places, energy, cycles, stride) for stride in (2, 1))
        share = 1.0 / (2**order - 1)
        return Baseline(omega, time, share * np.abs(omega - coarse), share * np.abs(time - slow))


def _march(step: Step, places: _Places, energy: np.ndarray, cycles: int, stride: int) -> tuple[np.ndarray, np.ndarray]:
    """Speed and time at the nodes, with steps from each place to that `stride` places on."""
    nodes = places.count // 2 * cycles + 1
    omega, time = np.empty((2, nodes, energy.size))
    t = np.zeros_like(energy)
    for k in range(nodes - 1):
        at = 2 * k % places.count
        omega[k], time[k] = places.omega(at, energy), t
        for here in range(at, at + 2, stride):
            energy, taken = step(places, here, here + stride, energy, places.distance(here, stride))
            t = t + taken
    omega[-1], time[-1] = places.omega(places.count, energy), t
    return omega, time
