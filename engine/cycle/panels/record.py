"""Curves kept over the whole cycle, for results that need all of it: extremes, work, zeros.

A record grows by one step at a time. Lanes that took no panel in a step have half length 0 there.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import LANES, Row
from engine.compiling.decorators import inlined, routine
from engine.compiling.memory import Memory
from engine.cycle.panels.chebyshev import MATRICES, POSITIONS
from engine.cycle.panels.lanes import Panels, many, new_record, one
from engine.cycle.panels.series import Figures, larger, panel_figures
from engine.cycle.panels.transforms import Tiles, to_coefficients
from engine.cycle.panels.walk import Scales, Walk

# Safety factor on the measured rounding of values.
OF_ROUNDING = 16.0


class Left(NamedTuple):
    """Remainder of a curve in a step.

    Attributes
    ----------
    tail, missing : row
        Remainder of the curve beyond its series, and of its integral beyond the quadrature sum.
    """

    tail: Row
    missing: Row


class KeptPanel(NamedTuple):
    """Each lane's panel of a step.

    Attributes
    ----------
    middle, half : row
        Middle and half length.
    opened, closed : row
        Error estimates of the positions of the cuts or kinks where it begins and ends.
    bent : row
        1 if it has a kink inside, else 0.
    """

    middle: Row
    half: Row
    opened: Row
    closed: Row
    bent: Row


class Whole(NamedTuple):
    """A curve over the whole cycle.

    Attributes
    ----------
    scale : row
        Maximum magnitude, infinite if a value is NaN or infinite.
    first : row
        Value at the first position.
    offset : row
        Error estimate of the values beyond rounding.
    """

    scale: Row
    first: Row
    offset: Row


class Record(NamedTuple):
    """Kept curves; curve k in step i is in slot i · curves + k.

    Attributes
    ----------
    degree : int
        Degree of the panels; the last rows of a panel stay 0 if it is COARSE.
    curves : int
        Number of kept curves.
    most_steps : int
        Room for steps.
    steps : ndarray (1,) of int
        Number of steps so far.
    values : panels (slots, POSITIONS, LANES)
        Values at the positions of each panel.
    coefficients : panels (slots, POSITIONS, LANES)
        Coefficients of their Chebyshev series, where `known`.
    left : many Left
        One for each slot.
    panels : many KeptPanel
        One for each step.
    whole : many Whole
        One for each curve.
    work : Tiles
    figures : Figures
        Scratch.
    known : ndarray (slots,) of int
        1 where the coefficients are known.
    to_coefficients, to_integrals : ndarray
        The matrices of its `engine.cycle.panels.chebyshev.PanelMatrices`.
    """

    degree: int
    curves: int
    most_steps: int
    steps: np.ndarray
    values: Panels
    coefficients: Panels
    left: many(Left)
    panels: many(KeptPanel)
    whole: many(Whole)
    work: Memory((POSITIONS, LANES), Tiles)
    figures: one(Figures)
    known: np.ndarray
    to_coefficients: np.ndarray
    to_integrals: np.ndarray


def room_for(curves: int, steps: int, degree: int, beyond: int) -> Record:
    """Allocate a record of `curves` curves and `steps` steps of panels of a degree, and values of `beyond` more."""
    slots = curves * steps
    return new_record(
        Record,
        degree=degree,
        curves=curves,
        most_steps=steps,
        steps=np.zeros(1, np.int64),
        values=slots + beyond,
        coefficients=slots,
        left=slots,
        panels=steps,
        whole=curves,
        known=np.zeros(slots, np.int64),
        to_coefficients=MATRICES[degree].to_coefficients,
        to_integrals=MATRICES[degree].to_integrals,
    )


@routine
def begin_record(record: Record) -> None:
    """Clear a record."""
    for slot in range(record.steps[0] * record.curves):
        record.known[slot] = 0
    record.steps[0] = 0
    for k in range(record.curves):
        whole = record.whole[k]
        for lane in range(LANES):
            whole.scale[lane] = whole.first[lane] = whole.offset[lane] = 0.0


@routine
def keep_rounding(scales: Scales, whole: Whole) -> None:
    """Include the rounding of a curve that the walk measured in the error estimate of its values."""
    for lane in range(LANES):
        whole.offset[lane] = larger(OF_ROUNDING * scales.rounding[lane], whole.offset[lane])


@routine
def keep_panels(walk: Walk, panels: KeptPanel) -> None:
    """Store each lane's panel of a step; half length 0 if it wasn't accepted."""
    for lane in range(LANES):
        panels.middle[lane] = walk.middle[lane]
        panels.half[lane] = walk.half[lane] if walk.accepted[lane] > 0.0 else 0.0
        panels.opened[lane] = larger(walk.opened[lane], walk.before_kink[lane])
        panels.closed[lane] = larger(walk.next_opened[lane], walk.past_kink[lane])
        panels.bent[lane] = walk.bent[lane]


@routine
def keep_curve(figures: Figures, walk: Walk, record: Record, step: int, kept: int) -> None:
    """Store the figures of a curve whose values are in the record.

    Parameters
    ----------
    figures : Figures
    walk : Walk
    record : Record
    step, kept : int
        Step and curve of the record.
    """
    slot, whole, degree = step * record.curves + kept, record.whole[kept], record.degree
    curve, left = record.values[slot], record.left[slot]
    for lane in range(LANES):
        left.tail[lane], left.missing[lane] = figures.tail[lane], figures.missing[lane]
        accepted, first = walk.accepted[lane] > 0.0, walk.taken[lane] == 1.0
        whole.scale[lane] = _scale(figures, whole, lane, accepted)
        # A function that starts or ends at a cut shifts with the cut's position.
        moved = larger(walk.opened[lane], walk.next_opened[lane]) / abs(walk.half[lane])
        middle = curve[degree // 2, lane]
        moved *= larger(abs(curve[0, lane] - middle), abs(curve[degree, lane] - middle))
        offset = larger(moved, whole.offset[lane])
        whole.offset[lane] = offset if accepted else whole.offset[lane]
        whole.first[lane] = curve[0, lane] if accepted & first else whole.first[lane]


@inlined
def _scale(figures: Figures, whole: Whole, lane: int, taken: bool) -> float:
    """Maximum magnitude of a curve, including the panel's if it was taken."""
    finite = abs(figures.sum[lane]) < math.inf
    scale = larger(figures.magnitude[lane] if finite else math.inf, whole.scale[lane])
    return scale if taken else whole.scale[lane]


@routine
def keep_derived(record: Record, step: int, curve: int) -> None:
    """Store the figures of a curve whose values in a step were computed from those of other curves."""
    slot, whole, figures = step * record.curves + curve, record.whole[curve], record.figures
    left, panels = record.left[slot], record.panels[step]
    panel_figures(record.values[slot], record.degree, panels.bent, figures)
    for lane in range(LANES):
        left.tail[lane], left.missing[lane] = figures.tail[lane], figures.missing[lane]
        whole.scale[lane] = _scale(figures, whole, lane, panels.half[lane] != 0.0)


@routine
def known_slot(record: Record, curve: int, step: int) -> int:
    """Return the slot of a curve in a step; compute its coefficients if they aren't known."""
    slot = step * record.curves + curve
    if record.known[slot] == 0:
        to_coefficients(record.to_coefficients, record.values[slot], record.work, record.coefficients[slot])
        record.known[slot] = 1
    return slot
