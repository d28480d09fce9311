"""Engine layouts: position of the cylinders and their throws; and an engine with its masses.

The z axis runs along the crankshaft from its middle; x and y are across it, with x the engine's own axis (midway
between the banks, usually drawn upwards). A cylinder's axis is at its bank angle beta from x, its throw leads that of
cylinder 1 by alpha, both counter-clockwise in the sense of rotation: at the crank angle phi the throw is at
phi + alpha, and at theta = phi + alpha − beta from the cylinder's axis. The piston is at its outer dead centre at
theta = 0.

Cylinders are numbered bank by bank, and along the crank within a bank; in a radial engine in the sense of rotation.

A `Pattern` is a layout without dimensions: bank angle, offset of the crankpins of one throw (a split pin), spacing of
the throws, distance of the rods on one throw. With these numbers it becomes an `EngineLayout`.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike


class LayoutError(ValueError):
    """An impossible layout; the message states what is possible."""


class EngineLayout(NamedTuple):
    """Positions and throws of the cylinders.

    Attributes
    ----------
    banks, throws : ndarray (..., cylinders)
        Bank angles beta and crankpin angles alpha [rad].
    positions : ndarray (..., cylinders)
        Position along the crank, from its middle [m].
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
        Crankpin angle: throw + lead · offset of the pins [rad].
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
    """Cylinders of a layout without dimensions."""

    __slots__ = ()

    def layout(
        self,
        bank_angle: ArrayLike = 0.0,
        pin_offset: ArrayLike = 0.0,
        spacing: ArrayLike = 1.0,
        rod_distance: ArrayLike = 0.0,
    ) -> EngineLayout:
        """The layout with dimensions.

        Parameters
        ----------
        bank_angle : array_like (...)
            Angle between neighbouring banks [rad].
        pin_offset : array_like (...)
            Angle by which the second bank's part of a split crankpin leads the first bank's [rad].
        spacing : array_like (...)
            Distance between throws [m].
        rod_distance : array_like (...)
            Distance between the rods of neighbouring banks on one throw [m].
        """
        bank, lean, throw, lead, place, shift = np.array(self, dtype=float).T
        given = (bank_angle, pin_offset, spacing, rod_distance)
        angle, offset, pitch, apart = (np.asarray(x, dtype=float)[..., None] for x in given)
        return EngineLayout(bank + lean * angle, throw + lead * offset, place * pitch + shift * apart)


def usual_throws(throws: int) -> tuple[float, ...]:
    """Throws of the usual in-line crank: even four-stroke intervals, mirror-symmetric if the halves are alike.

    Returns
    -------
    tuple of float
        Angles [rad]. Two throws are opposite each other.
    """
    step = math.tau / throws
    if throws in _IN_TURN:
        return tuple(step * k for k in _IN_TURN[throws])
    if throws % 2 or throws < 4:
        return tuple(step * k for k in range(throws))
    half = [2 * step * k for k in _HALVES.get(throws, range(throws // 2))]
    return tuple(half + half[::-1])


# Firing orders 1-2-4-5-3 (five), 1-5-3-6-2-4 (six) and 1-6-2-5-8-3-7-4 (eight in line).
_IN_TURN = {5: (0, 3, 2, 1, 4)}
_HALVES = {6: (0, 2, 1), 8: (0, 2, 3, 1)}
CROSS_PLANE = (0.0, math.tau / 4, 3 * math.tau / 4, math.tau / 2)


def in_line_engine(cylinders: int, throws: Sequence[float] | None = None) -> Pattern:
    """Cylinders in a row.

    Parameters
    ----------
    cylinders : int
    throws : sequence of float, optional
        Angle of each cylinder's throw [rad]; default: `usual_throws`.

    Raises
    ------
    LayoutError
    """
    return w_engine(cylinders, 1, throws)


def v_engine(cylinders: int, throws: Sequence[float] | None = None) -> Pattern:
    """Two banks, with pairs of cylinders on common throws.

    Parameters
    ----------
    cylinders : int
    throws : sequence of float, optional
        Angle of each pair's throw [rad]; default: a cross-plane crank for eight cylinders, else `usual_throws`.

    Raises
    ------
    LayoutError
    """
    return w_engine(cylinders, 2, CROSS_PLANE if throws is None and cylinders == 8 else throws)


def w_engine(cylinders: int, banks: int = 3, throws: Sequence[float] | None = None) -> Pattern:
    """Several banks in a fan, with rows of cylinders on common throws; three banks are a W engine.

    Parameters
    ----------
    cylinders, banks : int
    throws : sequence of float, optional
        Angle of each throw [rad]; default: `usual_throws`.

    Raises
    ------
    LayoutError
    """
    if cylinders < 1 or banks < 1 or cylinders % banks:
        raise LayoutError(f"{cylinders} cylinders can't stand in {banks} banks; give a multiple of {banks}")
    along = _checked(throws, cylinders // banks)
    fan = [(banks - 1) / 2 - b for b in range(banks)]
    return Pattern(
        Station(0.0, lean, throw, b, place, b - (banks - 1) / 2)
        for b, lean in enumerate(fan)
        for place, throw in zip(_places(len(along)), along, strict=True)
    )


def boxer_engine(cylinders: int, throws: Sequence[float] | None = None) -> Pattern:
    """Pairs of opposed pistons that move in opposite directions, each on its own throw.

    The spacing is the distance between neighbouring throws, within a pair and between pairs.

    Parameters
    ----------
    cylinders : int
    throws : sequence of float, optional
        Angle of the first cylinder's throw in each pair [rad]; the second throw is opposite. Default: `usual_throws`,
        for four cylinders 0 and 180°.

    Raises
    ------
    LayoutError
    """
    if cylinders < 2 or cylinders % 2:
        raise LayoutError(f"a boxer engine has pairs of cylinders, not {cylinders} of them; give an even number")
    pairs = cylinders // 2
    along, places = _checked(throws, pairs), _places(cylinders)
    return Pattern(
        Station(bank * math.tau / 4, 0.0, throw + turned, 0.0, places[2 * pair + second], 0.0)
        for second, (bank, turned) in enumerate(((1, 0.0), (-1, math.tau / 2)))
        for pair, throw in enumerate(along)
    )


def radial_engine(cylinders: int) -> Pattern:
    """Evenly spaced cylinders around one throw.

    Raises
    ------
    LayoutError
        Fewer than two cylinders.
    """
    if cylinders < 2:
        raise LayoutError(f"a radial engine has at least two cylinders, not {cylinders}")
    return Pattern(Station(math.tau * k / cylinders, 0.0, 0.0, 0.0, 0.0, 0.0) for k in range(cylinders))


def _places(count: int) -> list[float]:
    return [k - (count - 1) / 2 for k in range(count)]


def _checked(throws: Sequence[float] | None, count: int) -> tuple[float, ...]:
    if throws is None:
        return usual_throws(count)
    if len(throws) != count:
        raise LayoutError(f"{len(throws)} throws are given; this layout has {count}: give as many angles")
    return tuple(float(throw) for throw in throws)


class MasterRod(NamedTuple):
    """A radial engine's master rod, whose big end carries the knuckle pins of the link rods.

    Attributes
    ----------
    cylinder : int
        Index of the master rod's cylinder, from 0.
    knuckle_radius, link_rod : ndarray (...)
        Distance from the crankpin to a knuckle pin, and length of a link rod [m].
    knuckle_mass : ndarray (...)
        Mass at each knuckle pin [kg]: the link rod's fraction there. The crankpin carries the rest.

    Seen from the crankpin, the angle of a knuckle pin from the master rod is that of its cylinder from the master's.
    """

    cylinder: int
    knuckle_radius: np.ndarray | float
    link_rod: np.ndarray | float
    knuckle_mass: np.ndarray | float = 0.0


class Engine(NamedTuple):
    """An engine: layout, cranks and masses.

    Numbers of the whole engine have the variants' axes (...); numbers of each cylinder have one more axis
    (..., cylinders), of length 1 if all cylinders are alike.

    Attributes
    ----------
    layout : EngineLayout
    radius, rod : ndarray (...)
        Crank radius and rod length [m].
    reciprocating_mass, rotating_mass : ndarray (..., cylinders)
        Masses of each cylinder at the piston pin and at the crankpin [kg].
    offset : ndarray (...)
        Offset of the cylinder axes from the crank axis, to the left of each cylinder seen outwards [m].
    rod_correction : ndarray (...)
        J_S − m a b of each rod [kg·m²]; affects the torque only.
    master : MasterRod, optional
        Default: all rods are on the crankpins.
    """

    layout: EngineLayout
    radius: np.ndarray | float
    rod: np.ndarray | float
    reciprocating_mass: np.ndarray | float = 1.0
    rotating_mass: np.ndarray | float = 0.0
    offset: np.ndarray | float = 0.0
    rod_correction: np.ndarray | float = 0.0
    master: MasterRod | None = None
