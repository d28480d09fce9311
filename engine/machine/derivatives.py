"""Derivatives of summaries with respect to numbers of a scene: sensitivity of a result to a length, a mass, a load.

For every variant, neighbours with one number slightly larger or smaller are evaluated together, by the same kernel as
the variants; the differences are extrapolated (see `extrapolation`). Derivatives of linear functions are exact within
rounding. Positions are not adapted: the result is the derivative of the summary as computed, and the summary's error
estimate is part of the derivative's.
"""

from collections.abc import Callable, Mapping
from operator import itemgetter
from typing import NamedTuple

import numpy as np
from annotated_types import Ge, Gt, Le, Lt

from engine.machine.elements.elements_alone import ElementsAlone
from engine.machine.extrapolation import Differences, Estimate, derivative_of
from engine.machine.machine import Machine
from engine.machine.results import AskError
from engine.parts.skeleton import CrankInput, NonZero
from engine.scene.scene import Scene, SceneNumber, scene_numbers
from engine.stepping.records import on_arrays
from engine.words.verdicts import Verdict

# Assumed rounding error of a summary, in units of the machine epsilon.
ROUNDING = 16
# Steps relative to a number's scale; the shorter ones are used if the longer ones are insufficient.
LADDERS = (tuple(2.0**-k for k in (2, 3, 4, 5, 6, 7)), tuple(2.0**-k for k in (9, 11, 13, 15, 17)))
# Evaluations per variant and number if the longer steps suffice.
EVALUATIONS = 2 * len(LADDERS[0])
# Shorter steps are tried if longer ones leave a larger relative error.
GOOD = 1e-8
# The position of an extreme may jump from one peak to another.
PLACES = (".min_at", ".max_at")


class Move(NamedTuple):
    """A number to be varied for a derivative.

    Attributes
    ----------
    at : ndarray (variants,)
        Its value.
    scale : ndarray (variants,)
        A substantial change of the number, the unit of the steps.
    varied : callable
        Maps values of the number (points,) and the indices of their variants (points,) to the argument of `evaluate`.
    """

    at: np.ndarray
    scale: np.ndarray
    varied: Callable[[np.ndarray, np.ndarray], Mapping[str, np.ndarray]]


class Derivatives(NamedTuple):
    """Derivatives with respect to one number.

    Attributes
    ----------
    values, errors : dict of str to ndarray (variants,)
        Derivative of each requested summary and its error estimate, unit of the summary over unit of the number; NaN
        if undefined.
    status : ndarray (variants,) of uint8
        `Verdict` codes: OK if the variant and its neighbours on at least one side can be evaluated, else the verdict on
        the variant or on its neighbours.
    """

    values: dict[str, np.ndarray]
    errors: dict[str, np.ndarray]
    status: np.ndarray


def derivatives_along(machine: Machine | ElementsAlone, move: Move) -> Derivatives:
    """Derivatives of all requested summaries along a move.

    Parameters
    ----------
    machine : Machine or ElementsAlone
    move : Move

    Raises
    ------
    AskError
        A requested summary has no derivative.
    """
    for name in machine.asked_summaries:
        if name.endswith(PLACES):
            raise AskError(
                f"{name!r} is the position of an extreme, which may jump from peak to peak: it has no derivative"
            )
    here = machine.evaluate(move.varied(move.at, np.arange(move.at.size)))
    names, status = machine.asked_summaries, here.status.copy()
    values, errors = ({name: np.full(move.at.shape, np.nan) for name in names} for _ in range(2))
    left, seen = np.flatnonzero(status == Verdict.OK), []
    for i, ladder in enumerate(LADDERS):
        if not left.size:
            break
        seen.append(_neighbours(machine, move, left, ladder))
        around, steps = on_arrays(lambda *rows: np.concatenate(rows, axis=1), *seen), np.concatenate(LADDERS[: i + 1])
        nearest = around.status[:, -1]
        status[left] = np.where((nearest == Verdict.OK).any(axis=1), Verdict.OK, nearest[:, 0])
        again = (nearest != Verdict.OK).any(axis=1)
        for name in names:
            own = here.summaries[name][left], here.errors[name][left]
            samples = Differences(steps, around.width, *own, around.summaries[name], around.errors[name])
            found = derivative_of(samples, ROUNDING * float(np.finfo(machine.dtype).eps))
            values[name][left], errors[name][left] = found.value, found.error
            again |= _is_open(found, here.summaries[name][left], move.scale[left])
        left, seen = left[again], [on_arrays(itemgetter(again), part) for part in seen]
    return Derivatives(values, errors, status)


def _is_open(found: Estimate, here: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Whether shorter steps could improve an estimate."""
    small = GOOD * (np.abs(found.value) + np.abs(here) / scale)
    # The neighbours of an undefined summary are undefined as well.
    uncertain = (found.from_steps > small) & (found.from_steps > 0.5 * found.error)
    return np.isfinite(here) & (~np.isfinite(found.error) | uncertain)


class _Neighbours(NamedTuple):
    """Neighbours of some variants: displacements, verdicts and results (variants, levels, 2)."""

    width: np.ndarray
    status: np.ndarray
    summaries: dict[str, np.ndarray]
    errors: dict[str, np.ndarray]


def _neighbours(
    machine: Machine | ElementsAlone, move: Move, variants: np.ndarray, ladder: tuple[float, ...]
) -> _Neighbours:
    """Evaluate the neighbours of some variants."""
    at = move.at[variants, None, None]
    places = at + move.scale[variants, None, None] * np.array(ladder)[:, None] * np.array([1.0, -1.0])
    whose = np.broadcast_to(variants[:, None, None], places.shape)
    outcome = machine.evaluate(move.varied(places.ravel(), whose.ravel()))
    failed = outcome.status != Verdict.OK

    def known(table: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        return {name: np.where(failed, np.nan, row).reshape(places.shape) for name, row in table.items()}

    status = outcome.status.reshape(places.shape)
    return _Neighbours(places - at, status, known(outcome.summaries), known(outcome.errors))


# Scales


def scale_of(scene: Scene, varied: Mapping[str, np.ndarray], by: str) -> np.ndarray:
    """A substantial change of a number, as the unit of steps.

    It is the value of a nonnegative number; the crank length for coordinates and offsets; 1 rad for angles; else the
    value. For a value of 0, it is the largest number of the same dimension in the scene. Near a limit it is reduced, so
    that steps to both sides remain within.

    Parameters
    ----------
    scene : Scene
    varied : mapping of path to ndarray (variants,)
        Values (SI) of all varied numbers.
    by : str

    Returns
    -------
    ndarray (variants,)

    Raises
    ------
    AskError
        The number is a choice, such as an assembly mode.
    """
    numbers = scene_numbers(scene)
    number, values = numbers[by], np.abs(varied[by])
    if number.choices:
        raise AskError(f"{by!r} is one of {list(number.choices)}: it has no derivative; choose another number")
    is_size = any(isinstance(limit, (Gt, Ge)) and _bound(limit) >= 0 for limit in number.limits)
    if number.dimension == "angle" and not is_size:
        scale = np.ones_like(values)
    elif number.dimension == "length" and not is_size and scene.input is not None:
        scale = np.broadcast_to(_reach(scene, varied), values.shape).copy()
    else:
        alike = [abs(n.value) for n in numbers.values() if n.dimension == number.dimension and n.value]
        scale = np.where(values > 0, values, max(alike, default=1.0))
    return _within(number, varied[by], scale)


def _reach(scene: Scene, varied: Mapping[str, np.ndarray]) -> float | np.ndarray:
    """Length of the crank, 1 m if it has no pin, or travel of a sliding input."""
    drive = scene.input
    if isinstance(drive, CrankInput):
        return varied.get("input.length", drive.length or 1.0)
    return np.abs(varied.get("input.stop", drive.stop) - varied.get("input.start", drive.start))


def _within(number: SceneNumber, values: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Reduce scales so that the longest step covers at most half the distance to a limit, unless that is too near."""
    for limit in number.limits:
        room = np.abs(values - _bound(limit)) / (2 * LADDERS[0][0])
        scale = np.where((room > LADDERS[0][-1] * scale) & (room < scale), room, scale)
    return scale


def _bound(limit: Gt | Ge | Lt | Le | NonZero) -> float:
    return next(float(getattr(limit, key)) for key in ("gt", "ge", "lt", "le", "ne") if hasattr(limit, key))


# Units


def unit_over(above: str, below: str) -> str:
    """Quotient of two units in CF spelling: "J" over "m" is "J m-1", "N m" over "m" is "N"."""
    powers: dict[str, int] = {}
    for unit, sign in ((above, 1), (below, -1)):
        for symbol in unit.split():
            name = symbol.rstrip("-0123456789")
            power = int(symbol[len(name) :] or 1)
            powers[name] = powers.get(name, 0) + sign * power
    left = sorted(((name, power) for name, power in powers.items() if name and power), key=lambda part: part[1] < 0)
    return " ".join(name if power == 1 else f"{name}{power}" for name, power in left) or "1"
