"""The requested results of a machine's cycle, each with its number among the results.

Results of the whole cycle are measured from the record of a few curves: curves of the machine and others that
follow from them, such as running integrals. A plan numbers them once all requests are known.
"""

import math
from collections.abc import Hashable, Iterable, Sequence
from copy import copy
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from engine.compiling.printed_functions import PrintedFunction
from engine.cycle.driver import MachineFunctions, Task
from engine.cycle.events import MOST_ROOTS
from engine.cycle.measures.extremes import BOTH, LEAST_MAGNITUDE
from engine.cycle.panels.chebyshev import DEGREE

# Positions at which switching functions are scanned, in a range of up to two turns of the input and in each further
# turn; doubled for variants that need more.
SCANNED, SCANNED_PER_TURN = 36, 18
# Fields that cut the cycle.
_CUTS = ("landmarks", "levels", "crossings", "cuts")
# Fields that are equal in a plan and its task: as arrays, and as they are.
_SHARED = ("ends", "levels", "states", "cuts", "kinks", "rooted")
_SAME = ("looks", "intervals", "degree", "longest", "period", "turn")

Measure = Literal["integrals", "roots", "extremes", "fluctuations", "averages", "arcs", "spaced"]


@dataclass(frozen=True)
class Recorded:
    """A curve of the record, by the curves of the machine from which it follows."""

    curves: tuple[int, ...]


class Kept(Recorded):
    """A curve of the machine."""


class VectorAngle(Recorded):
    """Continuous angle of the vector with two curves as components."""


@dataclass(frozen=True)
class Running(Recorded):
    """Running integral of a curve, or of its difference from its mean."""

    about_mean: bool


@dataclass(frozen=True)
class CycleSpeed(Recorded):
    """Speed over the steady cycle of a moment and an inertia, by the rows with mean speed and flywheel inertia."""

    speed: int
    wheel: int

    @property
    def work(self) -> Running:
        """Work of the moment about its mean."""
        return Running(self.curves[:1], about_mean=True)


@dataclass(frozen=True)
class Difference:
    """a − c (b − b₀): a recorded curve a, a curve b with the initial value b₀, and the row of P with the factor c."""

    curve: Recorded
    base: int
    factor: int


@dataclass
class Plan:
    """Requested results of a machine, by indices of its curves and of rows of P.

    Attributes
    ----------
    ends : tuple of int
        Rows with the first and last position of the input; it may run backwards.
    curves : int
        Number of curves. Those up to the last one that a result needs over the whole cycle are kept.
    landmarks : sequence of tuples
        For each switching function the rows that receive its minimum, its maximum and their positions, in this order;
        −1 for none.
    levels, states : sequence of int
        Rows that receive the outputs of these functions.
    crossings : sequence of tuples
        Switching function, row with a level of it, and an offset: the cycle is cut where the function equals their sum.
    tells_crossings : bool
        Whether the positions of the crossings are among the results.
    cuts : sequence of int
        Rows with input positions at which the cycle is cut; NaN for none.
    kinks : sequence of int
        Curves at whose zeros other curves have kinks: panels end there if those curves require it.
    rooted : sequence of int
        Nonnegative curves whose square roots must meet the tolerance too.
    intervals, positions : int
        Number of intervals into which equally spaced positions divide the range, and number of positions.
    degree : int
        Degree of the panels: DEGREE, or COARSE if little accuracy is requested.
    tolerance : float or sequence of float
        Admissible remainder of each curve beyond its series, relative to its maximum magnitude.
    longest : float
        Maximum length of a panel; at most π/2 if the input is an angle.
    period, turn : float
        Length of the input after which the cycle, or the crank's position, recurs; infinite if the range isn't a cycle.
    looks : int
        Number of scans: 2 if some switching functions depend on landmarks of others.
    turns : int
        Turns of the input in the range; there is room for `MOST_ROOTS` roots in each.
    """

    ends: tuple[int, int]
    curves: int
    landmarks: Sequence[tuple[int, int, int, int]] = ()
    levels: Sequence[int] = ()
    states: Sequence[int] = ()
    crossings: Sequence[tuple[int, int, float]] = ()
    tells_crossings: bool = False
    cuts: Sequence[int] = ()
    kinks: Sequence[int] = ()
    rooted: Sequence[int] = ()
    intervals: int = 1
    positions: int = 0
    degree: int = DEGREE
    tolerance: float | Sequence[float] = 1e-10
    longest: float = 1.26
    period: float = math.inf
    turn: float = math.inf
    looks: int = 1
    turns: int = 1
    # Requests in order, by the measure that finds them; of an extreme also the sides.
    _wanted: dict[Measure, dict[Hashable, int]] = field(init=False, default_factory=dict)
    _sides: list[int] = field(init=False, default_factory=list)

    def find(self, measure: Measure, wanted: Hashable) -> int:
        """Add a result to the plan; returns its number among the results of the measure.

        Parameters
        ----------
        measure : Measure
        wanted : hashable
            A curve of the machine for "integrals", and for "roots", integrals of the square roots of nonnegative
            curves. A recorded curve for "averages" (mean and mean square) and for "spaced" (values at equally spaced
            positions). A `CycleSpeed` for "fluctuations". For "arcs", the widest unloaded arcs of forces: the curves
            with the two components and the squared magnitude.
        """
        of_measure = self._wanted.setdefault(measure, {})
        return of_measure.setdefault(wanted, len(of_measure))

    def find_extremes(self, curve: Recorded | Difference, sides: int = BOTH) -> int:
        """Add extremes of a curve to the plan; `sides` as in `engine.cycle.measures.extremes`."""
        number = self.find("extremes", (curve, sides == LEAST_MAGNITUDE))
        self._sides += [0] * (number + 1 - len(self._sides))
        self._sides[number] |= sides
        return number

    def wanted(self, measure: Measure) -> list:
        """Results requested of a measure, in order."""
        return list(self._wanted.get(measure, ()))

    def task(self, functions: Iterable[PrintedFunction | None]) -> Task:
        """The plan in the driver's format, for a machine's functions in the order of `MachineFunctions`."""
        integrals, sought, arcs = (self.wanted(measure) for measure in ("integrals", "extremes", "arcs"))
        differences = [of for of, _ in sought if isinstance(of, Difference)]
        recorded = [of for of, _ in sought if isinstance(of, Recorded)] + [of.curve for of in differences]
        recorded += [*self.wanted("averages"), *self.wanted("spaced")]
        cycles = _of_kind(CycleSpeed, [*self.wanted("fluctuations"), *recorded])
        recorded += [cycle.work for cycle in cycles]
        running, angles, speeds = (_of_kind(kind, recorded) for kind in (Running, VectorAngle, CycleSpeed))
        needed = [*self.wanted("roots"), *(of.base for of in differences), *(c for arc in arcs for c in arc)]
        needed += [c for of in (*running, *recorded, *cycles) for c in of.curves]
        kept = 1 + max(needed, default=-1)
        row = {of: k for k, of in enumerate([*(Kept((c,)) for c in range(kept)), *running, *angles, *speeds])}

        def of_extreme(of: Recorded | Difference) -> tuple[int, int, int]:
            alone = isinstance(of, Recorded)
            return (row[of], row[of], -1) if alone else (row[of.curve], of.base, of.factor)

        return Task(
            MachineFunctions(*(function or PrintedFunction(None) for function in functions)),
            **{name: _integers(getattr(self, name)) for name in _SHARED},
            **{name: getattr(self, name) for name in _SAME},
            landmarks=_integers(self.landmarks, 4),
            crossings=np.array(self.crossings, float).reshape(-1, 3),
            scan=SCANNED + SCANNED_PER_TURN * max(0, self.turns - 2),
            most_roots=MOST_ROOTS * self.turns,
            integrals=_integers(integrals),
            roots=_integers(self.wanted("roots")),
            kept=kept,
            works=_integers([(of.curves[0], of.about_mean) for of in running], 2),
            angles=_integers([of.curves for of in angles], 2),
            speeds=_integers([cycles.index(of) for of in speeds]),
            extremes=_integers([(*of_extreme(of), k) for (of, _), k in zip(sought, self._sides, strict=True)], 4),
            fluctuations=_integers([(row[of.work], of.curves[1], of.speed, of.wheel) for of in cycles], 4),
            averages=_integers([row[of] for of in self.wanted("averages")]),
            arcs=_integers(arcs, 3),
            spaced=_integers([row[of] for of in self.wanted("spaced")]),
            tolerance=np.broadcast_to(np.asarray(self.tolerance, dtype=float), (self.curves,)).copy(),
            only_integrals=np.array([float(c in integrals and c not in needed) for c in range(self.curves)]),
        )


def is_cut(plan: Plan | Task) -> bool:
    """Whether anything cuts the cycle."""
    return any(len(getattr(plan, name)) for name in _CUTS)


def without_cuts(plan: Plan) -> Plan:
    """A plan of the same results over cycles that nothing cuts."""
    other = copy(plan)
    for name in _CUTS:
        setattr(other, name, ())
    return other


def _of_kind(kind: type, curves: Iterable[Recorded]) -> list:
    return [curve for curve in dict.fromkeys(curves) if isinstance(curve, kind)]


def _integers(values: Sequence, columns: int = 0) -> np.ndarray:
    return np.array(values, dtype=np.int64).reshape((-1, columns) if columns else -1)
