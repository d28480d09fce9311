"""What is computed of a governor: its characteristic, its stability with an engine, and what a change of load does.

Arrays of the governor's numbers in, arrays of results out, all with variants along their last axis.
"""

from collections.abc import Iterator
from functools import partial, reduce

import numpy as np
from numba import types

from engine.compiling.running import prepare
from engine.elements.element_laws import ElementResult, Given, LawOfArrays
from engine.elements.governors.governor_elements import (
    AnyGovernor,
    ArmGovernor,
    FullAndShutThrottle,
    HartnellGovernor,
    LinearThrottle,
    LoadedGovernor,
    ProellGovernor,
    TableGovernor,
    TableThrottle,
    WattGovernor,
    governs_machine,
)
from engine.elements.governors.governor_results import KEPT, ROOM, STATICS, WITH_ENGINE, find_equilibria
from engine.elements.governors.places import (
    CYCLE_LENGTH,
    ENGINE,
    GEOMETRY_NUMBERS,
    NUMBERS,
    Holding,
    Throttling,
)
from engine.elements.governors.transients import ANSWERS, FINE, MOTION_ROOM, follow_changes
from engine.laws.rounding import EPS
from engine.laws.tables import Table, in_memory, make_table

_FLAG = {"units": "1", "exact": True}
_STATICS = (
    ElementResult("inner_speed", "speed of the spindle in equilibrium at the inner stop", "rad s-1"),
    ElementResult("outer_speed", "speed of the spindle in equilibrium at the outer stop", "rad s-1"),
    ElementResult("inner_force", "controlling force of one ball at the inner stop", "N"),
    ElementResult("outer_force", "controlling force of one ball at the outer stop", "N"),
    ElementResult("stable_from", "radius at which the longest stable stretch begins", "m"),
    ElementResult("stable_to", "radius at which the longest stable stretch ends", "m"),
    ElementResult("least_speed", "least speed of the spindle in the stable stretch", "rad s-1"),
    ElementResult("greatest_speed", "greatest speed of the spindle in the stable stretch", "rad s-1"),
    ElementResult("mean_speed", "mean of the least and the greatest speed", "rad s-1"),
    ElementResult("non_uniformity", "range of speeds in the stable stretch over the mean speed", "1"),
    ElementResult(
        "least_stability", "least of (dω²/dr)/(ω²/r) in equilibrium between the stops; 0 is isochronous", "1"
    ),
    ElementResult("least_stability_radius", "radius at which the governor is least stable", "m"),
    ElementResult("isochronous", "the governor is isochronous (1 or 0)", **_FLAG),
    ElementResult("sleeve_lift", "lift of the sleeve between the stops", "m"),
    ElementResult("insensitivity", "greatest range of speeds within which friction holds the sleeve, as a share", "1"),
    ElementResult("least_speed_with_friction", "speed at which the sleeve falls to its lowest", "rad s-1"),
    ElementResult("greatest_speed_with_friction", "speed at which the sleeve rises to its highest", "rad s-1"),
    ElementResult("sleeve_force", "force at the sleeve that holds the balls, at half of the lift", "N"),
    ElementResult("effort", "mean force at the sleeve for the given change of speed, at half of the lift", "N"),
    ElementResult("power", "effort times the lift that the given change of speed makes", "J", None, True),
)
_OF_ENGINE = (
    ElementResult("working_lift", "lift of the sleeve at the engine's load, after its change", "m"),
    ElementResult("working_speed", "steady speed of the engine, after the change of load", "rad s-1"),
    ElementResult("steady_speed_change", "steady change of the engine's speed by the change of load", "rad s-1"),
    ElementResult("vyshnegradsky_x", "Vyshnegradsky's X", "1", None, True),
    ElementResult("vyshnegradsky_y", "Vyshnegradsky's Y", "1", None, True),
    ElementResult("stable", "engine and governor are stable (1) or hunt (0)", **_FLAG),
    ElementResult("gain_margin", "gain of the throttle at which they hunt, over that given", "1", None, True),
    ElementResult("critical_damping", "damping at the sleeve below which they hunt", "N s m-1", None, True),
    ElementResult("critical_inertia", "inertia of the engine below which they hunt", "kg m2", None, True),
    ElementResult("decay_rate", "rate at which the slowest part of a disturbance decays", "s-1", None, True),
    ElementResult("hunting_frequency", "angular frequency of the oscillation", "rad s-1", None, True),
    ElementResult("oscillates", "a disturbance decays or grows in oscillations (1 or 0)", **_FLAG),
)
_TRANSIENT = (
    ElementResult("highest_speed", "highest speed of the engine after the change of load", "rad s-1"),
    ElementResult("lowest_speed", "lowest speed of the engine after the change of load", "rad s-1"),
    ElementResult("overshoot", "greatest departure beyond the new steady speed, as a share", "1"),
    ElementResult("settling_time", "time after which the speed stays in its band", "s", None, True),
    ElementResult("hunting", "half the swing of speed that is left at the end, as a share", "1"),
    ElementResult("inner_stop_hits", "how often the sleeve runs on its inner stop", **_FLAG),
    ElementResult("outer_stop_hits", "how often the sleeve runs on its outer stop", **_FLAG),
)
_HELD = ("stiffness", "preload", "gravity")
EMPTY = np.zeros(1)
# Variants whose motion is followed on one thread before the next piece of work is asked for.
TOGETHER = 32


def governor_law(governor: AnyGovernor) -> LawOfArrays:
    """The law of a governor: its numbers in the order of `engine.elements.governors.places`, and its results.

    Parameters
    ----------
    governor : governor element
    """
    results = [*_STATICS, *(_OF_ENGINE if governor.engine is not None else ())]
    if not is_followed(governor):
        return LawOfArrays(partial(_rows, governor), _arguments, tuple(results))
    return LawOfArrays(partial(_rows, governor), _arguments, (*results, *_TRANSIENT), TOGETHER)


def is_followed(governor: AnyGovernor) -> bool:
    """Whether a change of load is followed over time."""
    return governor.engine is not None and governor.engine.duration is not None


def holding_of(governor: AnyGovernor) -> Holding:
    """How the balls of a governor move, or over what its controlling force is tabled."""
    match governor:
        case ProellGovernor():
            return Holding.LOWER_ARMS
        case ArmGovernor():
            return Holding.UPPER_ARMS
        case HartnellGovernor():
            return Holding.BELL_CRANKS
    return Holding.OVER_RADIUS if governor.over_radius is not None else Holding.OVER_LIFT


def throttling_of(governor: AnyGovernor) -> Throttling:
    """How the moment of a governor's engine depends on the lift."""
    match governor.engine and governor.engine.throttle:
        case LinearThrottle():
            return Throttling.LINEAR
        case TableThrottle():
            return Throttling.TABLE
        case FullAndShutThrottle():
            return Throttling.FULL_AND_SHUT
    return Throttling.NONE


def governor_memory(governor: AnyGovernor) -> tuple[np.ndarray, float]:
    """Tables of a governor one after another, and where that of the throttle begins."""
    parts = []
    if isinstance(governor, TableGovernor):
        rows = governor.over_radius if governor.over_radius is not None else governor.over_lift
        parts.append(in_memory(_going_on(make_table(rows, governor.controlling_force, governor.interpolation))))
    offset = float(sum(part.size for part in parts))
    throttle = governor.engine and governor.engine.throttle
    if isinstance(throttle, TableThrottle):
        parts.append(in_memory(make_table(throttle.over_lift, throttle.moment, throttle.interpolation)))
    return np.concatenate(parts) if parts else EMPTY, offset


def _going_on(table: Table) -> Table:
    """A table that goes on straight beyond its rows: its ends have the slopes that they have from inside."""
    cubic = table.coefficients.copy()
    first, last = cubic[1], cubic[-2]
    t = table.breaks[-2] - table.breaks[-3]
    cubic[0] = (0.0, 0.0, first[2], first[3])
    cubic[-1] = (0.0, 0.0, (3 * last[0] * t + 2 * last[1]) * t + last[2], np.polyval(last, t))
    return table._replace(coefficients=cubic)


def _arguments(governor: AnyGovernor, given: Given) -> tuple:
    """Numbers in their order; 0 where a governor has none."""
    numbers = _numbers(governor, given)
    if not (is_followed(governor) and governs_machine(governor)):
        return numbers
    return (*numbers, *(given(cycle_key(k)) for k in range(NUMBERS, CYCLE_LENGTH + 1)))


def _numbers(governor: AnyGovernor, given: Given) -> tuple:
    """A governor's own numbers in the order of `engine.elements.governors.places`."""
    return (
        *_masses(governor, given),
        *_geometry(governor, given),
        *_engine(governor, given),
    )


def cycle_key(k: int) -> str:
    """Under which key a governor is given a number of the curves of its mechanism, by its place in the row."""
    return f"cycle.{k}"


def _masses(governor: AnyGovernor, given: Given) -> Iterator[float | np.ndarray]:
    held = _HELD if isinstance(governor, LoadedGovernor) else ()
    for key in ("ball_mass", "sleeve_mass", *_HELD, "friction", "damping", "least_radius", "greatest_radius"):
        yield given(key) if key in held or key not in _HELD else 0.0
    yield given("speed_change")


def _geometry(governor: AnyGovernor, given: Given) -> tuple:
    arms = ("upper_arm", "lower_arm", "upper_pivot", "lower_pivot")
    match governor:
        case ProellGovernor():
            keys = (*arms, "extension", "parallel_radius")
        case WattGovernor(ball_arm=float()):
            keys = (*arms, "ball_arm")
        case ArmGovernor():
            keys = (*arms, "upper_arm")
        case HartnellGovernor():
            keys = ("ball_arm", "sleeve_arm", "pivot_radius")
        case _:
            keys = ("lift_ratio",)
    return tuple(given(key) for key in keys) + (0.0,) * (GEOMETRY_NUMBERS - len(keys))


def _engine(governor: AnyGovernor, given: Given) -> tuple:
    engine = governor.engine
    if engine is None:
        return (0.0,) * (NUMBERS - ENGINE)

    def of(key: str) -> float | np.ndarray:
        owner = engine.throttle if key.startswith("throttle.") else engine
        return given(f"engine.{key}") if getattr(owner, key.rpartition(".")[2], None) is not None else 0.0

    keys = ("inertia", "ratio", "throttle.full", "throttle.closed", "self_regulation", "load")
    new = of("load") if engine.new_load is None else of("new_load")
    return (*(of(key) for key in keys), new, *(of(key) for key in ("duration", "settling_band", "throttle.switch")))


_ROW, _TABLE = types.float64[::1], types.float64[:, ::1]
_TYPES = (types.intp, types.intp, _TABLE, _ROW, types.float64, _TABLE, _TABLE, _TABLE, types.uint8[::1], _ROW)


def governor_numbers(governor: AnyGovernor, cycle: np.ndarray | None = None) -> np.ndarray:
    """A governor's own numbers in their order, as one variant (1, numbers).

    Parameters
    ----------
    governor : governor element
    cycle : ndarray, optional
        Curves of its mechanism, and the length of their cycle.
    """

    def own(key: str) -> float:
        return float(reduce(getattr, key.split("."), governor))

    return np.concatenate([np.array(_numbers(governor, own), float), [] if cycle is None else cycle])[None]


def equilibria_of(governor: AnyGovernor, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Results near equilibrium, their sizes, positions and verdicts of a set of variants.

    Parameters
    ----------
    governor : governor element
        Its kind and its tables; its numbers are not used.
    numbers : ndarray (variants, NUMBERS)

    Returns
    -------
    found, sizes : ndarray (variants, results)
        Results, and the magnitudes whose rounding they carry.
    kept : ndarray (variants, KEPT)
        Positions.
    verdicts : ndarray (variants,) of uint8
    """
    variants, results = numbers.shape[0], STATICS if governor.engine is None else WITH_ENGINE
    found, sizes = np.full((2, variants, results), np.nan)
    kept, verdicts = np.full((variants, KEPT), np.nan), np.empty(variants, np.uint8)
    memory, offset = governor_memory(governor)
    kind, throttle = int(holding_of(governor)), int(throttling_of(governor))
    prepare(find_equilibria, _TYPES)
    find_equilibria(kind, throttle, numbers, memory, offset, found, sizes, kept, verdicts, np.empty(ROOM))
    return found, sizes, kept, verdicts


def _rows(governor: AnyGovernor, arguments: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Results and their sizes (results, variants), and verdicts, from numbers (numbers, variants)."""
    numbers = np.ascontiguousarray(arguments.T)
    found, sizes, kept, verdicts = equilibria_of(governor, numbers)
    if is_followed(governor):
        answers, coarse = np.full((2, numbers.shape[0], ANSWERS), np.nan)
        kind, throttle = int(holding_of(governor)), int(throttling_of(governor))
        tables, room = governor_memory(governor), np.empty(MOTION_ROOM)
        prepare(follow_changes, _TYPES)
        follow_changes(kind, throttle, numbers, *tables, answers, coarse, kept, verdicts, room)
        off = np.abs(answers - coarse) / (16 * EPS) + np.abs(answers) * FINE / EPS
        found, sizes = np.concatenate([found, answers], axis=1), np.concatenate([sizes, off], axis=1)
    return found.T, np.where(np.isnan(sizes), 0.0, sizes).T, verdicts
