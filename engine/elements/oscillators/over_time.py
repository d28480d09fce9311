"""Response of one mass to a force or support motion given over time: peaks and history."""

import math

import numpy as np

from engine.elements.element import Columns, Numbers, named_in_order
from engine.elements.oscillators.excitations import OverTime, SupportOverTime
from engine.elements.oscillators.forced_pieces import Oscillators, Response, follow_pieces
from engine.words.quantity import main_result

# Linear pieces that approximate a formula; half of them yields the error estimate.
PIECES = 4096
OVER_TIME_RESULTS = (
    main_result("greatest_displacement", "peak displacement", "m"),
    main_result("greatest_displacement_at", "time of the peak displacement", "s"),
    main_result("spring_force", "peak spring force", "N"),
    main_result("spring_force_at", "time of the peak spring force", "s"),
    main_result("dynamic_factor", "peak displacement over the static one at the peak excitation", "1", True),
    main_result("end_displacement", "displacement at the end", "m"),
    main_result("end_velocity", "velocity at the end", "m s-1"),
)


def _given_over_time(excitation: OverTime, n: Numbers, pieces: int) -> tuple[np.ndarray, np.ndarray]:
    """Rows (1 or variants, 2, rows) of the excitation, and the duration of the motion (variants or 1,)."""
    if excitation.formula is None:
        drives = excitation.displacement if isinstance(excitation, SupportOverTime) else excitation.force
        rows = np.array([[excitation.over_time, drives]], float)
        return rows, n["excitation.time"] if excitation.time is not None else rows[0, 0, -1:]
    horizon = n["excitation.time"]
    time = horizon[:, None] * np.linspace(0.0, 1.0, pieces + 1)
    numbers = {name: n[f"excitation.numbers.{name}"][:, None] for name in excitation.numbers}
    drives = excitation.expression.evaluate({"t": time, **numbers})
    return np.stack([time, np.broadcast_to(drives, time.shape)], axis=1), horizon


def _followed(
    excitation: OverTime, n: Numbers, stiffness: np.ndarray, ratio: np.ndarray, pieces: int, instants: int = 0
) -> tuple[Response, np.ndarray, np.ndarray, np.ndarray]:
    """The response, the states at the start of pieces, and the rows and horizons of the excitation.

    States are kept if there are `instants` for one oscillator: equally spaced, they become rows of the excitation.
    """
    rows, horizon = _given_over_time(excitation, n, pieces)
    if instants:
        further = np.setdiff1d(np.linspace(0.0, horizon[0], instants), rows[0, 0])
        more = further, np.interp(further, *rows[0])
        rows = np.insert(rows, np.searchsorted(rows[0, 0], further), more, axis=2)
    none = np.zeros_like(stiffness)
    start = n.get("start.displacement", none), n.get("start.velocity", none)
    numbers = (np.array(np.broadcast_to(a, none.shape)) for a in (stiffness, n["mass"], ratio, *start, horizon))
    found = Response(*np.empty((len(Response._fields), none.size)))
    states = np.empty((none.size, rows.shape[2] if instants else 0, 3))
    oscillators, moves_support = Oscillators(*numbers), isinstance(excitation, SupportOverTime)
    follow_pieces(none.size, moves_support, oscillators, np.ascontiguousarray(rows), found, states)
    return found, states, rows, oscillators.horizon


def over_time_columns(
    excitation: OverTime, n: Numbers, stiffness: np.ndarray, ratio: np.ndarray, pieces: int = PIECES
) -> tuple[Columns, Columns]:
    """Results of an oscillator under an excitation over time, and the magnitudes on which its rounding acts.

    Parameters
    ----------
    excitation : OverTime
    n : mapping of str to ndarray (variants,)
        Its numbers by their keys.
    stiffness, ratio : ndarray (variants,)
        [N/m]; damping ratio.
    pieces : int
        Number of linear pieces for a formula.

    Returns
    -------
    columns, carried : dict of str to ndarray (variants,)
        As named by OVER_TIME_RESULTS.
    """
    found, _, rows, horizon = _followed(excitation, n, stiffness, ratio, pieces)
    every = np.broadcast_to(rows, (horizon.size, *rows.shape[1:]))
    ends = np.array([np.interp(until, *row) for until, row in zip(horizon, every, strict=True)])
    reached = np.where(rows[:, 0] <= horizon[:, None], np.abs(rows[:, 1]), 0.0).max(axis=1)
    drives = np.maximum(reached, np.abs(ends))
    at_rest = drives if isinstance(excitation, SupportOverTime) else drives / stiffness
    with np.errstate(all="ignore"):
        factor = np.where(at_rest > 0.0, found.displacement / at_rest, math.nan)
        carried = found.rounded / 4.0
        rate = carried * np.sqrt(stiffness / n["mass"]) * np.maximum(1.0, 2.0 * ratio)
    peaks = found.displacement, found.displacement_at, stiffness * found.stretch, found.stretch_at
    columns = named_in_order(OVER_TIME_RESULTS, (*peaks, factor, found.end, found.end_velocity))
    sizes = {
        "greatest_displacement": carried,
        "spring_force": stiffness * carried,
        "dynamic_factor": carried / at_rest,
        "end_displacement": carried,
        "end_velocity": rate,
    }
    return columns, sizes


def oscillator_history(
    excitation: OverTime, n: Numbers, columns: Columns, instants: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Motion of an oscillator under an excitation over time, at equally spaced instants.

    Parameters
    ----------
    excitation : OverTime
    n, columns : mapping of str to ndarray (1,)
        Numbers of the oscillator by their keys, and its results.
    instants : int

    Returns
    -------
    time, drives, displacement, spring_force : ndarray (instants,)
        [s], force on the mass [N] or displacement of the support [m], [m], [N].
    """
    stiffness, ratio = columns["stiffness"], columns["damping_ratio"]
    found, states, rows, horizon = _followed(excitation, n, stiffness, ratio, PIECES, instants)
    time = np.linspace(0.0, horizon[0], instants)
    begins, displacement, _ = states[0].T
    # No piece starts at the end.
    moved = np.append(displacement[np.isin(begins, time[:-1])], found.end)
    drives = rows[0, 1, np.searchsorted(rows[0, 0], time, side="right") - 1]
    stretch = moved - drives if isinstance(excitation, SupportOverTime) else moved
    return time, drives, moved, stiffness * stretch
