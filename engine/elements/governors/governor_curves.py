"""One governor as curves, to be drawn: its characteristic, and what a change of load does over time."""

from typing import NamedTuple

import numpy as np
from numba import types

from engine.compiling.running import prepare
from engine.elements.governors.equilibria import governor_marks, governor_memory, governor_variants, near_equilibrium
from engine.elements.governors.governor import Governor
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


_LINE = types.float64[::1]
_MOTION_TYPES = (types.intp, types.intp, _LINE, _LINE, types.float64, _LINE, types.float64[:, ::1], _LINE)


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
    g = governor_variants(governor, governor.own_numbers())
    marks, verdicts = governor_marks(g)
    room = BEYOND * (marks.outer[0] - marks.inner[0])
    places = np.linspace(marks.inner[0] - room, marks.outer[0] + room, positions)
    found = g.at(places[:, None], marks.inner)
    ends = g.at(np.stack([marks.inner, marks.outer, marks.begin, marks.end]), marks.inner).radius[:, 0]
    # Without stops, or without equilibrium between them, there is nothing to see.
    between = (places >= marks.inner[0]) & (places <= marks.outer[0])
    seen = slice(None) if np.isfinite(found.speed[between, 0]).any() else slice(0)
    rows = (row[seen, 0] for row in found[:6])
    return GovernorCurves(*rows, between[seen], tuple(ends[:2]), tuple(ends[2:]), Verdict(verdicts[0]))


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
    if not governor.is_followed:
        return None
    g = governor_variants(governor, governor.own_numbers())
    marks, verdicts = governor_marks(g)
    if verdicts[0] != Verdict.OK:
        return None
    numbers = g.rows[0] if cycle is None else np.concatenate([g.rows[0], cycle])
    rows, (memory, offset) = np.full((MOST_INSTANTS, 3), np.nan), governor_memory(governor)
    kind, throttle = int(governor.holding), int(governor.throttling)
    prepare(follow_one, _MOTION_TYPES)
    follow_one(kind, throttle, numbers, memory, offset, marks.of_motion[0], rows, np.empty(MOTION_ROOM + ANSWERS))
    steady = near_equilibrium(g, marks)
    after = steady["working_speed"][0]
    return LoadChange(*rows[np.isfinite(rows[:, 0])].T, after - steady["steady_speed_change"][0], after)


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
    found = governor.evaluate(governor.own_numbers()).values
    x, y = (float(found[f"vyshnegradsky_{axis}"][0]) for axis in "xy")
    return StabilityPoint(x, y) if np.isfinite(x) else None
