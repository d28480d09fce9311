"""Axes of a study and the parameters of every variant, computed from the variant's index.

Blocks of any size can be computed in any order on any worker, identical bit for bit, with only the block in memory.
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from engine import even_steps
from sweeps.study.unit_points import SOBOL_LARGEST, latin_points, random_points, sobol_points

# Larger results fit on no disk.
MOST_VARIANTS = 10**12

_UNIT_POINTS = {"random": random_points, "sobol": sobol_points, "latin": latin_points}


class SamplingError(ValueError):
    """Invalid sampling; the message names the path and the value."""


@dataclass(frozen=True, eq=False)
class Listed:
    """One parameter that takes the values of a list.

    Raises
    ------
    SamplingError
        If the list holds anything but finite numbers.
    """

    name: str
    listed: Sequence[float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "listed", _column(self.name, self.listed))

    @property
    def names(self) -> tuple[str, ...]:
        """The parameter's path."""
        return (self.name,)

    @property
    def size(self) -> int:
        """Length of the list."""
        return len(self.listed)

    def values(self, indices: np.ndarray) -> dict[str, np.ndarray]:
        """Values at the indices."""
        return {self.name: self.listed[indices]}


@dataclass(frozen=True)
class Steps:
    """One parameter in `size` equal steps, or equal ratios, from `start` to `stop`, both hit exactly.

    Raises
    ------
    SamplingError
        If the size is 1 for two different ends, an end is infinite or NaN, or a logarithmic range touches or crosses
        zero.
    """

    name: str
    start: float
    stop: float
    size: int
    logarithmic: bool = False

    def __post_init__(self) -> None:
        _check_finite(self.name, self.start, self.stop)
        if self.size == 1 and self.start != self.stop:
            raise SamplingError(f"{self.name}: count 1 can't hit both ends; take 2 or more, or give a single value")
        if self.logarithmic:
            _check_ratio(self.name, self.start, self.stop)

    @property
    def names(self) -> tuple[str, ...]:
        """The parameter's path."""
        return (self.name,)

    def values(self, indices: np.ndarray) -> dict[str, np.ndarray]:
        """Values at the indices."""
        if not self.logarithmic:
            return {self.name: even_steps(self.start, self.stop, self.size, indices)}
        logarithm = math.log(self.stop / self.start) / max(self.size - 1, 1)
        steps = self.start * np.exp(indices * logarithm)
        return {self.name: np.where(indices == self.size - 1, self.stop, steps)}


@dataclass(frozen=True, eq=False)
class Columns:
    """Several parameters that vary together, row by row of a table.

    `table` has a column for each of `names`: its values in all rows.

    Raises
    ------
    SamplingError
        If the table holds anything but finite numbers.
    """

    names: tuple[str, ...]
    table: Sequence[Sequence[float]]

    def __post_init__(self) -> None:
        columns = tuple(_column(name, column) for name, column in zip(self.names, self.table, strict=True))
        object.__setattr__(self, "table", columns)

    @property
    def size(self) -> int:
        """Number of rows."""
        return len(self.table[0])

    def values(self, indices: np.ndarray) -> dict[str, np.ndarray]:
        """Values in the rows with these indices."""
        return {name: column[indices] for name, column in zip(self.names, self.table, strict=True)}


@dataclass(frozen=True)
class Sampled:
    """Several parameters sampled together, each between its own limits.

    Parameters
    ----------
    names : sequence of str
        Paths of the parameters.
    lows, highs : sequence of float
        Limits of each.
    count : int
        Number of samples.
    method : {"random", "sobol", "latin"}
        "random": independent and uniform. "sobol": scrambled Sobol' points, those of `scipy.stats.qmc.Sobol`.
        With both, a larger count keeps the earlier samples. "latin": a Latin hypercube, in which each
        parameter has exactly one sample in each of `count` equal strata; another count, another hypercube.
    seed : int
        Equal seeds give equal samples.
    logarithmic : sequence of bool, optional
        For each parameter, whether its logarithm is sampled evenly; none by default.
    sizes : mapping of str to sequence of float, optional
        Parameters that only take some sizes, all equally often; their limits are the first and the last.

    Raises
    ------
    SamplingError
        If a logarithmic range touches zero, a limit is infinite or NaN, or Sobol' is asked for more
        than 2**30 points.
    """

    names: tuple[str, ...]
    lows: tuple[float, ...]
    highs: tuple[float, ...]
    count: int
    method: Literal["random", "sobol", "latin"] = "random"
    seed: int = 0
    logarithmic: tuple[bool, ...] = ()
    sizes: Mapping[str, Sequence[float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "logarithmic", self.logarithmic or (False,) * len(self.names))
        for name, low, high, is_logarithmic in zip(self.names, self.lows, self.highs, self.logarithmic, strict=True):
            _check_finite(name, low, high)
            if is_logarithmic:
                _check_ratio(name, low, high)
        if self.method == "sobol" and self.count > SOBOL_LARGEST:
            raise SamplingError(
                f"{', '.join(self.names)}: count {self.count} is above the {SOBOL_LARGEST} points of the "
                "Sobol' sequence; take 'random' or 'latin'"
            )

    @property
    def size(self) -> int:
        """The count."""
        return self.count

    @property
    def note(self) -> str:
        """A warning, or ""."""
        if self.method != "sobol" or self.count.bit_count() == 1:
            return ""
        below = 2 ** (self.count.bit_length() - 1)
        paths = ", ".join(self.names)
        return f"{paths}: {self.count} Sobol' points are unevenly spread; {below} or {2 * below} would be even"

    def values(self, indices: np.ndarray) -> dict[str, np.ndarray]:
        """Values of the samples with these indices."""
        # In a product with other axes samples repeat.
        distinct, back = np.unique(indices, return_inverse=True)
        unit = _UNIT_POINTS[self.method](self.seed, self.count, len(self.names), distinct)
        limits = zip(self.names, unit.T, self.lows, self.highs, self.logarithmic, strict=True)
        found = {}
        for name, fraction, low, high, is_logarithmic in limits:
            sizes = self.sizes.get(name)
            values = between(fraction, low, high, is_logarithmic) if sizes is None else entry_at(fraction, sizes)
            found[name] = values[back]
        return found


# Parameters that vary together: `size` sets of `values` for `names`, dotted paths.
Axis = Listed | Steps | Columns | Sampled


@dataclass(frozen=True)
class Design:
    """The product of axes: every set of one with every set of the others, the last axis fastest.

    Without axes it is a single variant in which nothing varies.

    Raises
    ------
    SamplingError
        If two axes have a name in common, or the product exceeds `MOST_VARIANTS`.
    """

    axes: tuple[Axis, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "axes", tuple(self.axes))
        twice = [name for name, count in Counter(self.names).items() if count > 1]
        if twice:
            raise SamplingError(f"{twice[0]}: varies twice; leave one of the two out")
        if self.size > MOST_VARIANTS:
            words = "reduce a count, or sample with low and high"
            raise SamplingError(f"{self.size} variants, at most {MOST_VARIANTS}; {words}")

    @property
    def names(self) -> tuple[str, ...]:
        """Paths of all parameters that vary, in the order of the axes."""
        return tuple(name for axis in self.axes for name in axis.names)

    @property
    def size(self) -> int:
        """Number of variants."""
        return math.prod(axis.size for axis in self.axes)

    def values(self, start: int, stop: int) -> dict[str, np.ndarray]:
        """Parameters of the variants start..stop-1.

        Returns
        -------
        dict of str to ndarray
            For each of `names`, float64 of shape (stop - start,).

        Raises
        ------
        SamplingError
            Unless 0 <= start <= stop <= size.
        """
        if not 0 <= start <= stop <= self.size:
            raise SamplingError(f"variants {start} to {stop} are outside 0 to {self.size}")
        remaining = np.arange(start, stop, dtype=np.int64)
        found: dict[str, np.ndarray] = {}
        for axis in reversed(self.axes):
            remaining, indices = np.divmod(remaining, axis.size)
            found |= axis.values(indices)
        return {name: found[name] for name in self.names}


def _column(name: str, values: Sequence[float]) -> np.ndarray:
    column = np.array(values, np.float64)
    if len(wrong := np.flatnonzero(~np.isfinite(column))):
        raise SamplingError(f"{name}: value {wrong[0] + 1} is {column[wrong[0]]}; it must be finite")
    column.setflags(write=False)
    return column


def _check_finite(name: str, low: float, high: float) -> None:
    if not math.isfinite(high - low):
        raise SamplingError(f"{name}: the range and its ends must be finite")


def _check_ratio(name: str, low: float, high: float) -> None:
    if low == 0 or high == 0 or (low < 0) != (high < 0):
        raise SamplingError(
            f"{name}: a logarithmic range can't touch or cross zero; take a linear one, or limits of equal sign"
        )
    if not 0 < high / low < math.inf:
        raise SamplingError(f"{name}: the ratio of the ends is too large")


def entry_at(fraction: np.ndarray, listed: Sequence[float]) -> np.ndarray:
    """Entries of a list at fractions from 0 to 1; each has an equal share."""
    return np.asarray(listed)[np.minimum((fraction * len(listed)).astype(np.int64), len(listed) - 1)]


def between(fraction: np.ndarray, low: float, high: float, is_logarithmic: bool) -> np.ndarray:
    """Linear or logarithmic interpolation between two ends at fractions from 0 to 1."""
    steps = low * np.exp(fraction * math.log(high / low)) if is_logarithmic else low + fraction * (high - low)
    # Rounding may overshoot an end by a unit in the last place.
    return np.clip(steps, low, high)
