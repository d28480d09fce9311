"""Layouts of engines: where the cylinders stand, on which throws they work; and an engine with its masses.

Along the crankshaft z runs from the crank's middle, x and y lie across it, x being the engine's own axis (the one
between the banks, usually drawn upwards). A cylinder's axis leans from x by its bank angle beta, its throw leads
cylinder 1's by alpha, both counter-clockwise as the crank turns: at the crank angle phi the crank stands at
phi + alpha, and at theta = phi + alpha − beta from the cylinder's axis. A piston is at its outer dead centre at
theta = 0.

Cylinders are numbered bank by bank, and within a bank along the crank; in a radial engine as the crank passes them.

A `Pattern` is a layout whose sizes are still open: bank angle, offset of the crankpins of one throw (a split pin),
spacing of the throws, distance of the rods on one throw. With numbers for these it is an `EngineLayout`.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

TURN = 2 * math.pi


class LayoutError(ValueError):
    """A layout that doesn't exist; the message says what is possible."""


class EngineLayout(NamedTuple):
    """Where cylinders stand and on which throws they work.

    Attributes
    ----------
    banks, throws : ndarray (..., cylinders)
        Bank angles beta and angles of the crankpins alpha [rad].
    positions : ndarray (..., cylinders)
        Along the crank, from its middle [m].
    """

    banks: np.ndarray
    throws: np.ndarray
    positions: np.ndarray


class Station(NamedTuple):
    """A cylinder of a pattern.

    Attributes
    ----------
    bank, lean : float
        Bank angle: bank + lean · bank angle of the engine [rad].
    throw, lead : float
        Angle of the crankpin: throw + lead · offset of the pins [rad].
    place, shift : float
        Position: place · spacing + shift · distance of the rods.
    """

    bank: float
    lean: float
    throw: float
    lead: float
    place: float
    shift: float


class Pattern(tuple[Station, ...]):
    """The cylinders of a layout whose sizes are still open."""

    __slots__ = ()

    def layout(
        self,
        bank_angle: ArrayLike = 0.0,
        pin_offset: ArrayLike = 0.0,
        spacing: ArrayLike = 1.0,
        rod_distance: ArrayLike = 0.0,
    ) -> EngineLayout:
        """The layout with its sizes.

        Parameters
        ----------
        bank_angle : array_like (...)
            Between neighbouring banks [rad].
        pin_offset : array_like (...)
            By which a split crankpin's part for the second bank leads that for the first one [rad].
        spacing : array_like (...)
            Of the throws [m].
        rod_distance : array_like (...)
            Of the rods of neighbouring banks on one throw [m].
        """
        bank, lean, throw, lead, place, shift = np.array(self, dtype=float).T
        angle, offset, pitch, apart = (
            np.asarray(x, dtype=float)[..., None] for x in (bank_angle, pin_offset, spacing, rod_distance)
        )
        return EngineLayout(bank + lean * angle, throw + lead * offset, place * pitch + shift * apart)


def usual_throws(throws: int) -> tuple[float, ...]:
    """Throws of the usual in-line crank: even intervals for four strokes, like halves mirrored where there are two.

    Parameters
    ----------
    throws : int

    Returns
    -------
    tuple of float
        Angles [rad]. Two throws stand opposite each other.
    """
    step = TURN / throws
    if throws in _IN_TURN:
        return tuple(step * k for k in _IN_TURN[throws])
    if throws % 2 or throws < 4:
        return tuple(step * k for k in range(throws))
    half = [2 * step * k for k in _HALVES.get(throws, range(throws // 2))]
    return tuple(half + half[::-1])


# Firing orders 1-2-4-5-3 of five, 1-5-3-6-2-4 of six and 1-6-2-5-8-3-7-4 of eight in line.
_IN_TURN = {5: (0, 3, 2, 1, 4)}
_HALVES = {6: (0, 2, 1), 8: (0, 2, 3, 1)}
CROSS_PLANE = (0.0, TURN / 4, 3 * TURN / 4, TURN / 2)


def in_line_engine(cylinders: int, throws: Sequence[float] | None = None) -> Pattern:
    """Cylinders in a row.

    Parameters
    ----------
    cylinders : int
    throws : sequence of float, optional
        Of each cylinder [rad]; `usual_throws` where not given.

    Raises
    ------
    LayoutError
    """
    return w_engine(cylinders, 1, throws)


def v_engine(cylinders: int, throws: Sequence[float] | None = None) -> Pattern:
    """Two banks, whose cylinders work on common throws.

    Parameters
    ----------
    cylinders : int
    throws : sequence of float, optional
        Of each pair of cylinders [rad]; `usual_throws` where not given, but a cross-plane crank for eight cylinders.

    Raises
    ------
    LayoutError
    """
    return w_engine(cylinders, 2, CROSS_PLANE if throws is None and cylinders == 8 else throws)


def w_engine(cylinders: int, banks: int = 3, throws: Sequence[float] | None = None) -> Pattern:
    """Banks in a fan, whose cylinders work on common throws: W engines with three of them.

    Parameters
    ----------
    cylinders, banks : int
    throws : sequence of float, optional
        Of each throw [rad]; `usual_throws` where not given.

    Raises
    ------
    LayoutError
    """
    if cylinders < 1 or banks < 1 or cylinders % banks:
        raise LayoutError(f"{cylinders} cylinders can't stand in {banks} banks of equal length")
    along = _checked(throws, cylinders // banks)
    fan = [(banks - 1) / 2 - b for b in range(banks)]
    return Pattern(
        Station(0.0, lean, throw, b, place, b - (banks - 1) / 2)
        for b, lean in enumerate(fan)
        for place, throw in zip(_places(len(along)), along, strict=True)
    )


def boxer_engine(cylinders: int, throws: Sequence[float] | None = None) -> Pattern:
    """Pairs of opposed pistons that move against each other, each on its own throw.

    The spacing is that of neighbouring throws, those of a pair or of two pairs.

    Parameters
    ----------
    cylinders : int
    throws : sequence of float, optional
        Of the first cylinder of each pair [rad]; the second one's throw stands opposite. As `usual_throws` where not
        given, for four cylinders 0 and 180°.

    Raises
    ------
    LayoutError
    """
    if cylinders < 2 or cylinders % 2:
        raise LayoutError(f"a boxer engine has pairs of cylinders, not {cylinders} of them")
    pairs = cylinders // 2
    along, places = _checked(throws, pairs), _places(cylinders)
    return Pattern(
        Station(bank * TURN / 4, 0.0, throw + turned, 0.0, places[2 * pair + second], 0.0)
        for second, (bank, turned) in enumerate(((1, 0.0), (-1, TURN / 2)))
        for pair, throw in enumerate(along)
    )


def radial_engine(cylinders: int) -> Pattern:
    """A star of cylinders on one throw, evenly spaced.

    Parameters
    ----------
    cylinders : int

    Raises
    ------
    LayoutError
    """
    if cylinders < 2:
        raise LayoutError(f"a radial engine has two cylinders at least, not {cylinders}")
    return Pattern(Station(TURN * k / cylinders, 0.0, 0.0, 0.0, 0.0, 0.0) for k in range(cylinders))


def _places(count: int) -> list[float]:
    return [k - (count - 1) / 2 for k in range(count)]


def _checked(throws: Sequence[float] | None, count: int) -> tuple[float, ...]:
    if throws is None:
        return usual_throws(count)
    if len(throws) != count:
        raise LayoutError(f"{len(throws)} throws are given; this layout has {count}")
    return tuple(float(throw) for throw in throws)


class MasterRod(NamedTuple):
    """A radial engine's master rod, on whose big end the link rods of all other cylinders turn.

    Attributes
    ----------
    cylinder : int
        Index of the master rod's, from 0.
    knuckle_radius, link_rod : ndarray (...)
        From the crankpin to a knuckle pin, and length of a link rod [m].
    knuckle_mass : ndarray (...)
        Mass at each knuckle pin [kg]: the link rod's share there. The crankpin carries the rest.

    A knuckle pin stands in line with its cylinder when the crank points to the master rod's.
    """

    cylinder: int
    knuckle_radius: np.ndarray | float
    link_rod: np.ndarray | float
    knuckle_mass: np.ndarray | float = 0.0


class Engine(NamedTuple):
    """An engine: layout, cranks and masses.

    Numbers of the whole engine have the variants' axes (...), those of each cylinder one more (..., cylinders), or
    one of length 1 where all cylinders are alike.

    Attributes
    ----------
    layout : EngineLayout
    radius, rod : ndarray (...)
        [m].
    reciprocating_mass, rotating_mass : ndarray (..., cylinders)
        Of each cylinder, at its piston pin and at its crankpin [kg].
    offset : ndarray (...)
        Of the cylinders' axes from the crank's, to the left of each axis as it points outwards [m].
    rod_correction : ndarray (...)
        J_S − m a b of each rod [kg·m²]; matters to the torque alone.
    master : MasterRod, optional
        Without it all rods turn on the crankpin.
    """

    layout: EngineLayout
    radius: np.ndarray | float
    rod: np.ndarray | float
    reciprocating_mass: np.ndarray | float = 1.0
    rotating_mass: np.ndarray | float = 0.0
    offset: np.ndarray | float = 0.0
    rod_correction: np.ndarray | float = 0.0
    master: MasterRod | None = None
