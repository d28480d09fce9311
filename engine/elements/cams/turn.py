"""The turn of a cam as smooth pieces: their boundaries, and the follower's motion in each.

The law of a section, or a cubic of a table, is a function of the local variable u of its piece.
"""

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from engine.elements.element import Numbers
from engine.graph.over_arrays import over_arrays
from engine.laws.cams.motion_laws import DWELL, LAW_BREAKS, LAW_KINDS, MOTIONS
from engine.laws.tables import make_table, rounding_of_rows
from engine.parts.motion_programs import CamProgram, DwellSection, MotionTable, RiseSection, sections_of

# Samples of a piece that scale its velocity and acceleration; not the middle, where many laws have zero acceleration.
_LOOKED_AT = np.array([0.0, 0.3, 1.0])
# Rounding of a motion law, and of the rows of a table, relative to that of a number.
_LAW_ROUNDINGS, _ROW_ROUNDINGS = 16.0, 2.0
# Jumps below this multiple of the peak are rounding.
_ROUNDING_OF_JUMPS = 1e-9


class CamTurn(NamedTuple):
    """Pieces of the turn of several variants.

    Attributes
    ----------
    directions : ndarray (pieces,)
        1 in a rise, −1 in a return, 0 in a dwell.
    first, last : ndarray (pieces,)
        u at the start and the end.
    kinds : ndarray (pieces,)
        Kinds of the sections' laws.
    cubics : ndarray (3, pieces) or None
        Coefficients of u³, u² and u for the pieces of a table.
    begin, angle, before, stroke : ndarray (pieces, variants)
        Cam angle at u = 0 and per unit of u [rad]; displacement at u = 0 and per unit of the law.
    whole : ndarray (variants,) of bool
        Whether the pieces form a closed turn.
    roundings : ndarray (4, pieces) or None
        Changes of the displacement and its derivatives in the pieces of a table by a unit relative error of its rows.
    """

    directions: np.ndarray
    first: np.ndarray
    last: np.ndarray
    kinds: np.ndarray
    cubics: np.ndarray | None
    begin: np.ndarray
    angle: np.ndarray
    before: np.ndarray
    stroke: np.ndarray
    whole: np.ndarray
    roundings: np.ndarray | None = None

    def motion(self, p: np.ndarray, v: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, ...]:
        """Displacement and three derivatives with respect to the cam angle, at u in pieces p of variants v (...)."""
        before, stroke, rate = self.before[p, v], self.stroke[p, v], 1.0 / self.angle[p, v]
        if self.cubics is None:
            kind, held, u = np.broadcast_arrays(self.kinds[p], 0.5 * (self.first[p] + self.last[p]), u)
            shape = np.empty((4, *u.shape))
            for law in np.unique(kind).tolist():
                here = kind == law
                given = (u[here], held[here]) if law in LAW_BREAKS else (u[here],)
                shape[:, here] = over_arrays(MOTIONS[law], *given)
        else:
            c3, c2, c1 = self.cubics[:, p]
            shape = ((c3 * u + c2) * u + c1) * u, (3 * c3 * u + 2 * c2) * u + c1, 6 * c3 * u + 2 * c2, 6 * c3 + 0 * u
        return before + stroke * shape[0], *(stroke * rate**k * shape[k] for k in (1, 2, 3))

    def rounding(self, order: int, p: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Rounding of a derivative of an order, with values x in pieces p, in units of a number's relative rounding."""
        return _LAW_ROUNDINGS * x if self.roundings is None else _ROW_ROUNDINGS * self.roundings[order][p]

    def cam_angle(self, p: np.ndarray, v: np.ndarray, u: np.ndarray) -> np.ndarray:
        """Cam angle at u in pieces p of variants v (...)."""
        return self.begin[p, v] + self.angle[p, v] * u

    def jumps(self, n: Numbers) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Maximum jump and drop of s′, maximum jump of s″ (variants,); jumps within rounding are 0.

        They grow by the rounding of both sides with the numbers' factors of the orders.
        """
        p, v = np.indices(self.before.shape)
        ends = self.first + _LOOKED_AT[:, None] * (self.last - self.first)
        _, s1, s2, _ = self.motion(p[None], v[None], ends[:, :, None])
        found = []
        for order, s, change in ((1, s1, np.abs), (1, s1, np.negative), (2, s2, np.abs)):
            jump = change(np.roll(s[0], -1, axis=0) - s[-1])
            large = jump > _ROUNDING_OF_JUMPS * np.abs(s).max(axis=(0, 1))
            if (key := f"factor of order {order}") in n:
                before, after = (np.abs(self.rounding(order, p, side)) for side in (s[-1], s[0]))
                jump = jump + (before + np.roll(after, -1, axis=0)) * (n[key] - 1.0)
            found.append(np.where(large, jump, 0.0).max(axis=0))
        return tuple(found)


def turn_of(program: CamProgram, n: Numbers) -> CamTurn:
    """Pieces of the turn of a cam with the numbers `n`."""
    variants = next(iter(n.values())).size
    if program.table is not None:
        return _tabled(program.table, variants)
    sections, pieces, rows = sections_of(program, "", n), [], []
    for k, section in enumerate(program.sections.values()):
        still, rises = isinstance(section, DwellSection), isinstance(section, RiseSection)
        kind = DWELL if still else LAW_KINDS[section.law]
        ends = 0.0, *LAW_BREAKS.get(kind, ()), 1.0
        for first, last in pairwise(ends):
            pieces.append((0 if still else 1 if rises else -1, first, last, kind))
            rows.append([part[k] for part in sections[:-1]])
    numbers = np.array([[np.broadcast_to(x, variants) for x in row] for row in rows]).transpose(1, 0, 2)
    return CamTurn(*np.array(pieces, float).T, None, *numbers, np.broadcast_to(sections.whole, variants))


def _tabled(motion: MotionTable, variants: int) -> CamTurn:
    """The turn given by a table: its cubics, cut also at reversals of the follower."""
    table = make_table(motion.over_angle, motion.rows, motion.interpolation, math.tau)
    roundings, pieces = rounding_of_rows(table, motion.interpolation), []
    every = zip(table.breaks, table.breaks[1:], table.coefficients, strict=False)
    for k, (left, right, (c3, c2, c1, c0)) in enumerate(every):
        length = right - left
        turns = np.roots([3 * c3, 2 * c2, c1]) if c3 or c2 else np.empty(0)
        real = np.sort(turns[np.abs(turns.imag) < 1e-12 * length].real)
        inside = real[(real > 1e-9 * length) & (real < (1 - 1e-9) * length)]
        for a, b in zip([0.0, *inside], [*inside, length], strict=True):
            middle = (a + b) / 2
            direction = np.sign((3 * c3 * middle + 2 * c2) * middle + c1)
            pieces.append((direction, a, b, 0.0, c3, c2, c1, left, 1.0, c0, 1.0, k))
    rows = np.array(pieces).T
    numbers = np.repeat(rows[7:11, :, None], variants, axis=2)
    whole = np.ones(variants, bool)
    return CamTurn(*rows[:4], rows[4:7], *numbers, whole, roundings[:, rows[11].astype(int)])
