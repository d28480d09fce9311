"""One governor as curves, to be drawn: its characteristic, and what a change of load does over time."""

from typing import NamedTuple

import numpy as np
from numba import types

from engine.compiling.blocks import lane_of
from engine.compiling.decorators import driver
from engine.compiling.running import prepare
from engine.elements.governors.characteristic import FROM, INNER, OUTER, TO
from engine.elements.governors.governor import Governor, equilibria_of, governor_memory
from engine.elements.governors.governor_results import (
    SPEED_CHANGE,
    VYSHNEGRADSKY_X,
    VYSHNEGRADSKY_Y,
    WORKING_SPEED,
    equilibrium_at,
)
from engine.elements.governors.places import linkage_at
from engine.elements.governors.transients import ANSWERS, MOTION_ROOM, follow_one
from engine.verdicts import Verdict

# How far beyond the stops curves are drawn, as a share of the range between them.
BEYOND = 0.25


class GovernorCurves(NamedTuple):
    """Equilibrium of a governor at positions evenly spread about its stops, SI units.

    Attributes
    ----------
    radius, lift, force, speed, sleeve, margin : ndarray (positions,)
        Radius of the balls, lift of the sleeve from the inner stop, controlling force of one ball, speed of the
        spindle, force at the sleeve that holds the balls, and (dω²/dr)/(ω²/r). NaN where arms don't reach.
    between : ndarray (positions,) of bool
        Whether a position lies between the stops.
    stops : tuple of 2 floats
        Radii at the inner and the outer stop.
    stable : tuple of 2 floats
        Radii of the ends of the longest stable stretch; NaN where there is none.
    verdict : Verdict
    """

    radius: np.ndarray
    lift: np.ndarray
    force: np.ndarray
    speed: np.ndarray
    sleeve: np.ndarray
    margin: np.ndarray
    between: np.ndarray
    stops: tuple[float, float]
    stable: tuple[float, float]
    verdict: Verdict


@driver
def sample_states(
    kind: int, p: np.ndarray, memory: np.ndarray, zero_at: float, places: np.ndarray, rows: np.ndarray
) -> None:
    """Write `equilibrium_at` positions.

    Parameters
    ----------
    kind : int
        `Holding`.
    p : ndarray (NUMBERS,)
    memory : ndarray
    zero_at : float
        Position of the inner stop.
    places : ndarray (positions,)
    rows : ndarray (positions, 6)
        To be written to: the first six numbers of `equilibrium_at`.
    """
    own, tables = lane_of(p), lane_of(memory)
    zero = linkage_at(kind, own, zero_at)[5]
    for k in range(places.size):
        state = equilibrium_at(kind, own, tables, places[k], zero)
        for j in range(6):
            rows[k, j] = state[j]


_LINE = types.float64[::1]
_TABLE = types.float64[:, ::1]
_TYPES = (types.intp, _LINE, _LINE, types.float64, _LINE, _TABLE)
_MOTION_TYPES = (types.intp, types.intp, _LINE, _LINE, types.float64, _LINE, _TABLE, _LINE)


def governor_curves(governor: Governor, positions: int = 401) -> GovernorCurves:
    """Characteristic of a governor from one stop to the other, and somewhat beyond.

    Parameters
    ----------
    governor : Governor
    positions : int

    Returns
    -------
    GovernorCurves
        Without positions where arms don't reach as far as the stops.
    """
    numbers = governor.row(governor.own_numbers())
    kept, verdicts = equilibria_of(governor, numbers)[2:]
    inner, outer, begin, end = kept[0, [INNER, OUTER, FROM, TO]]
    room = BEYOND * (outer - inner)
    places = np.concatenate([np.linspace(inner - room, outer + room, positions), [inner, outer, begin, end]])
    rows = np.empty((places.size, 6))
    prepare(sample_states, _TYPES)
    sample_states(int(governor.holding), numbers[0], governor_memory(governor)[0], inner, places, rows)
    radii, columns, places = rows[positions:, 0], rows[:positions], places[:positions]
    # Without stops, or without equilibrium between them, there is nothing to see.
    between = (places >= inner) & (places <= outer)
    seen = slice(None) if np.isfinite(columns[between, 3]).any() else slice(0)
    stops, stable = (radii[0], radii[1]), (radii[2], radii[3])
    return GovernorCurves(*columns[seen].T.copy(), between[seen], stops, stable, Verdict(verdicts[0]))


class LoadChange(NamedTuple):
    """Motion of an engine and its governor after a change of load, SI units.

    Attributes
    ----------
    time, lift, speed : ndarray (instants,)
        Time, lift of the sleeve, speed of the engine.
    before, after : float
        Steady speeds of the engine.
    """

    time: np.ndarray
    lift: np.ndarray
    speed: np.ndarray
    before: float
    after: float


# Instants that there is room for.
MOST_INSTANTS = 8000


def load_change(governor: Governor, cycle: np.ndarray | None = None) -> LoadChange | None:
    """Follow what the change of load of a governor's engine does.

    Parameters
    ----------
    governor : Governor
    cycle : ndarray, optional
        Of a governor of a mechanism, from `governed_scene`.

    Returns
    -------
    LoadChange or None
        As far as the motion can be followed; None without a change that is to be followed, or without equilibrium.
    """
    own = governor.row(governor.own_numbers())
    numbers = own if cycle is None else np.concatenate([own, cycle[None]], axis=1)
    found, _, kept, verdicts = equilibria_of(governor, numbers)
    if not governor.is_followed or verdicts[0] != Verdict.OK:
        return None
    rows, (memory, offset) = np.full((MOST_INSTANTS, 3), np.nan), governor_memory(governor)
    kind, throttle = int(governor.holding), int(governor.throttling)
    prepare(follow_one, _MOTION_TYPES)
    follow_one(kind, throttle, numbers[0], memory, offset, kept[0], rows, np.empty(MOTION_ROOM + ANSWERS))
    after = found[0, WORKING_SPEED]
    return LoadChange(*rows[np.isfinite(rows[:, 0])].T, after - found[0, SPEED_CHANGE], after)


class StabilityPoint(NamedTuple):
    """Place of an engine with its governor in Vyshnegradsky's diagram."""

    x: float
    y: float


def stability_point(governor: Governor) -> StabilityPoint | None:
    """Place of a governor's engine in Vyshnegradsky's diagram.

    Parameters
    ----------
    governor : Governor

    Returns
    -------
    StabilityPoint or None
        None without an engine, without equilibrium, and for a valve that is open or shut.
    """
    if governor.engine is None:
        return None
    found = equilibria_of(governor, governor.row(governor.own_numbers()))[0][0]
    x, y = found[[VYSHNEGRADSKY_X, VYSHNEGRADSKY_Y]]
    return StabilityPoint(float(x), float(y)) if np.isfinite(x) else None
