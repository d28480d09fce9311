"""Checks of what is asked: of the names, of the positions, and of the numbers that variants are given."""

from collections.abc import Iterable, Mapping

import numpy as np

from engine.machine.results import AskError
from engine.scene.names import nearest
from engine.scene.scene import SceneNumber, within_limits
from engine.verdicts import Verdict

# Kernels keep rows at a fixed distance.
MOST_POSITIONS = 1_048_576


def check_positions(positions: int) -> None:
    """Check a number of positions.

    Raises
    ------
    AskError
        It is odd, less than 8, too great, or no whole number.
    """
    if isinstance(positions, (int, np.integer)) and positions > MOST_POSITIONS:
        raise AskError(f"positions = {positions}: at most {MOST_POSITIONS} are allowed; try accuracy in their place")
    if isinstance(positions, bool) or not isinstance(positions, (int, np.integer)) or positions < 8 or positions % 2:
        raise AskError(f"positions = {positions!r}: an even number of at least 8 is needed, such as 360 or 720")


def check_names(names: Iterable[str], known: Iterable[str], kind: str) -> None:
    """Check that names are known.

    Raises
    ------
    AskError
        One isn't; the message says of what `kind` it should be, and which names are near.
    """
    known = list(known)
    for name in names:
        if name not in known:
            near = nearest(name, known, 3)
            hint = f"; did you mean {' or '.join(repr(n) for n in near)}?" if near else ""
            raise AskError(f"{name!r} is not a {kind} of this scene{hint}")


def given_numbers(
    limits: Mapping[str, SceneNumber], paths: tuple[str, ...], varied: Mapping[str, np.ndarray], drop: np.ndarray | None
) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """What variants are given, as arrays (variants,), and the first verdicts on them, (variants,) of uint8.

    Parameters
    ----------
    limits : mapping of path to SceneNumber
        Of a scene.
    paths : tuple of str
        Paths that vary.
    varied : mapping of path to ndarray (variants,)
        Their values; without any there is one variant.
    drop : ndarray (variants,) of bool, optional
        Variants not to evaluate.

    Raises
    ------
    AskError
        The paths given are not these, or what is given for one is no row of real numbers as long as the others.
    """
    if set(varied) != set(paths):
        raise AskError(f"varied must hold exactly {list(paths)}, got {sorted(varied)}")
    arrays = {path: _row(path, values) for path, values in varied.items()}
    first = next(iter(arrays), None)
    count = 1 if first is None else arrays[first].size
    for path, values in arrays.items():
        if values.size != count:
            raise AskError(f"{path!r} has {values.size} values, {first!r} has {count}: give one for every variant")
    status = np.zeros(count, np.uint8)
    for path, values in arrays.items():
        status[~within_limits(limits[path], values)] = Verdict.OUTSIDE_LIMITS
    if drop is not None:
        drop = np.asarray(drop)
        if drop.shape != status.shape or drop.dtype != np.bool_:
            raise AskError(
                f"drop is an array of {drop.dtype} of the shape {drop.shape}: give True or False for each of the "
                f"{count} variants"
            )
        status[drop] = Verdict.DROPPED
    return arrays, status


def _row(path: str, values: object) -> np.ndarray:
    """What is given for a path, as a row of float64."""
    if np.ma.is_masked(values):
        raise AskError(f"{path!r} has masked values: leave out the variants that have none")
    try:
        row = np.atleast_1d(np.asarray(values))
    except ValueError:
        raise AskError(f"{path!r}: rows differ in length; give one row of numbers, one for every variant") from None
    if row.dtype.kind == "c":
        raise AskError(f"{path!r} has complex values: give real numbers")
    if row.ndim > 1:
        shape = " × ".join(map(str, row.shape))
        raise AskError(f"{path!r} has {shape} values: give one row of numbers, one for every variant")
    if row.dtype.kind not in "biuf":
        raise AskError(f"{path!r} has non-numeric values, such as {row.tolist()[0]!r}: give numbers in SI units")
    return row.astype(np.float64)
