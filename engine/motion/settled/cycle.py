"""Fields of a steady cycle, and their statistics: extremes, and means over time.

The nodes are those of the motion, on both sides of every position where a load has a jump or a kink.
"""

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from engine.compiling.running import over_variants
from engine.motion.loads import PairLoads
from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.moments.equation_of_motion import EquationOfMotion
from engine.motion.moments.grid import Grid
from engine.motion.moments.piecewise import extremes_along, integral, of_extremes
from engine.motion.one_speed import CHANNELS
from engine.motion.quantities import EFFICIENCY_NOW, INSTANT, Asked, FieldAnswers
from engine.motion.settled.steady import Steady


class Cycle(NamedTuple):
    """A steady cycle of a number of variants, at the nodes of its grid; arrays (nodes, variants).

    Attributes
    ----------
    grid : Grid
    omega : ndarray
        Magnitude of the speed [rad/s].
    direction : ndarray (variants,)
        +1 or −1.
    rows : dict of str to ndarray
        Fields by name, counter-clockwise positive.
    """

    grid: Grid
    omega: np.ndarray
    direction: np.ndarray
    rows: dict[str, np.ndarray]

    def field(self, name: str) -> np.ndarray:
        """A field over the crank angle, (variants, equal steps)."""
        found = np.take_along_axis(self.rows[name], self.grid.even, axis=0)[:-1].T
        found[np.isnan(self.omega[0])] = np.nan
        # The crank angle decreases if the crank turns clockwise.
        back = self.direction < 0.0
        found[back] = np.roll(found[back, ::-1], 1, axis=1)
        return found


def cycle_of(
    dynamics: Dynamics,
    variants: Variants,
    grid: Grid,
    steady: Steady,
    loads: PairLoads | None,
    off: frozenset[str],
) -> Cycle:
    """The steady cycle with its fields: those of the motion, and the requested loads on the pairs.

    Parameters
    ----------
    dynamics, variants, grid, steady
        Of the motion, including its flywheel and its record at the nodes of the grid.
    loads : PairLoads or None
    off : frozenset of str
        Actions that are off.
    """
    angle, way = grid.angles, variants.direction
    omega = np.sqrt(2.0 * steady.record[0] / dynamics.inertia(variants, angle))
    form = EquationOfMotion(dynamics, variants, np.zeros(variants.count))
    found = form.along(way * angle, omega, np.zeros_like(angle), np.ones(variants.count))
    _, epsilon, motors, moments = found.known_better(steady.record[2])
    rows = motion_rows(variants, omega, epsilon, motors, moments)
    rows["kinetic_energy"] = steady.record[0]
    rows[INSTANT] = steady.record[1]
    if loads is not None:
        rows |= loads(variants, loads.parameters(variants, off), angle, omega, epsilon * way)
    return Cycle(grid, omega, way, rows)


def motion_rows(
    variants: Variants, omega: np.ndarray, epsilon: np.ndarray, motors: np.ndarray, loads: np.ndarray
) -> dict[str, np.ndarray]:
    """Fields of the motion itself, counter-clockwise positive except the speed, each (places, variants).

    Parameters
    ----------
    variants : Variants
    omega, epsilon : ndarray (places, variants)
        Speed [rad/s] and acceleration [rad/s²] in the direction of motion.
    motors : ndarray (places, variants)
        Reduced motor torque in that direction [N·m].
    loads : ndarray (channels, places, variants)
        Torques of all loads by channel; powers are returned if there is one for each kind of work.
    """
    way, wheel = variants.direction, variants.flywheel
    rows = {
        "speed": omega,
        "acceleration": epsilon * way,
        "motor_moment": motors * way,
        "load_moment": loads.sum(axis=0) * way,
        "input_moment": (motors - wheel * epsilon) * way,
    }
    return rows | (power_rows(motors * omega, loads * omega) if len(loads) == len(CHANNELS) else {})


def power_rows(motors: np.ndarray, loads: np.ndarray, heat: np.ndarray | float = 0.0) -> dict[str, np.ndarray]:
    """Powers, and the instantaneous efficiency η = 1 − P_lost/P_in.

    The input power is the sum of all positive powers: of motors, driving actions, springs and weights, and of the
    kinetic energy, whose rate of decrease is the deficit of all powers, dE/dt = ΣP. Power that is not lost leaves the
    machine or is stored in it, so 0 ≤ η ≤ 1; without storage η is useful power over driving power.

    Parameters
    ----------
    motors : ndarray (places, variants)
        Power of the motors [W].
    loads : ndarray (channels, places, variants)
        Powers of all loads, by `CHANNELS`; negative for resistances [W].
    heat : ndarray (places, variants)
        Power dissipated in a coupling, negative [W].
    """
    driving, useful, harmful, braking, other = loads
    lost = np.maximum(-harmful, 0.0) + np.maximum(-braking, 0.0) - heat
    released = -(motors + loads.sum(axis=0) + heat)
    put_in = sum(np.maximum(power, 0.0) for power in (motors, *loads, released))
    with np.errstate(all="ignore"):
        efficiency = 1.0 - lost / put_in
    return {
        "motors_power": motors,
        "driving_power": driving,
        "useful_power": 0.0 - useful,
        "harmful_power": 0.0 - harmful,
        "braking_power": 0.0 - braking,
        "other_power": other,
        EFFICIENCY_NOW: efficiency,
    }


def answers_of(cycle: Cycle, asked: Iterable[Asked], period: float) -> FieldAnswers:
    """Requested results of a steady cycle.

    Parameters
    ----------
    cycle : Cycle
    asked : iterable of Asked
    period : float
        Period of the crank angle [rad].
    """
    found = FieldAnswers.none()
    known: dict[str, tuple[dict[str, np.ndarray], dict[str, np.ndarray]]] = {}
    for _, name, statistic in asked:
        if not statistic:
            found.rows[name] = cycle.field(name)
            continue
        if name not in known:
            known[name] = statistics_of(cycle, name, period)
        values, missed = known[name]
        key = f"{name}.{statistic}"
        found.values[key], found.missed[key], found.scales[key] = values[statistic], missed[statistic], values["peak"]
    return found


def statistics_of(cycle: Cycle, name: str, period: float) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Statistics of a field of a steady cycle, (variants,), and their error estimates due to gaps between nodes.

    Parameters
    ----------
    cycle : Cycle
    name : str
    period : float
        Period of the crank angle [rad].
    """
    row, count = cycle.rows[name], cycle.direction.size
    most, places, bounds = np.moveaxis(extremes_along(row, cycle.grid.steps), 1, 0)
    found = np.empty((4, count))
    over_time(count, np.ascontiguousarray(row), cycle.omega, cycle.grid.steps, found)
    mean, rms, hidden, hidden_rms = np.where(np.isnan(most[1]), np.nan, found)
    values, missed = of_extremes(most, bounds)
    values |= {"mean": mean, "rms": rms}
    missed |= {"mean": hidden, "rms": hidden_rms}
    step = np.full(count, period / (cycle.grid.even.shape[0] - 1))
    for key, place in zip(("min_at", "max_at"), places, strict=True):
        known = np.isfinite(place)
        at = cycle.grid.angles[np.where(known, place, 0.0).astype(int), np.arange(count)]
        values[key], missed[key] = np.where(known, np.mod(at, period), np.nan), step
    return values, missed


@over_variants
def over_time(
    begin: int,
    end: int,
    row: np.ndarray,
    omega: np.ndarray,
    steps: np.ndarray,
    found: np.ndarray,
) -> None:
    """Mean and rms of a row over the time ∫dφ/ω, and their error estimates due to the behaviour between nodes."""
    nodes = row.shape[0]
    pace, first, second, h = np.empty(nodes), np.empty(nodes), np.empty(nodes), np.empty(nodes - 1)
    for v in range(begin, end):
        for k in range(nodes):
            pace[k] = 1.0 / omega[k, v]
            first[k] = row[k, v] * pace[k]
            second[k] = row[k, v] * first[k]
        for k in range(nodes - 1):
            h[k] = steps[k, v]
        time, _ = integral(pace, h)
        total, hidden = integral(first, h)
        squares, hidden_squares = integral(second, h)
        rms = math.sqrt(max(squares, 0.0) / time)
        found[0, v], found[1, v], found[2, v] = total / time, rms, hidden / time
        found[3, v] = 0.5 * hidden_squares / (time * rms) if rms > 0.0 else 0.0
