"""Diagrams of an element as data: curves, marks and units, for whoever draws them."""

import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

# Curves that grow beyond all bounds are shown up to so many times what they are as given.
HIGHEST = 4.0


class PanelAxis(NamedTuple):
    """What runs along an axis: its words, and its unit (SI)."""

    words: str
    unit: str


class Curve(NamedTuple):
    """A curve by its words, NaN where it has no value; one that stands `beside` the element's own is drawn faintly.

    It may have `places` of its own; a faint one that has is named at its end, but for a plan.
    """

    words: str
    values: np.ndarray
    beside: bool = False
    places: np.ndarray | None = None


class Mark(NamedTuple):
    """A point by its words; an upright line where it has no height, a level one where it has no place."""

    words: str
    place: float | None
    height: float | None


class Panel(NamedTuple):
    """Curves in one diagram.

    Attributes
    ----------
    x, y : PanelAxis
    places : ndarray
        At which the curves are known.
    curves : sequence of Curve
    marks : sequence of Mark
    title : str
    limits : (float, float), optional
        Of what is shown upwards, in a logarithmic scale where both are above 0; all unless given.
    kind : {"curves", "plan", "bars"}
        A plan has one scale along both axes; bars stand beside each other at every place.
    names : sequence of str
        Of the places, where they are no numbers.
    """

    x: PanelAxis
    y: PanelAxis
    places: np.ndarray
    curves: Sequence[Curve]
    marks: Sequence[Mark] = ()
    title: str = ""
    limits: tuple[float, float] | None = None
    kind: Literal["curves", "plan", "bars"] = "curves"
    names: Sequence[str] = ()


def path(words: str, points: np.ndarray | Sequence[complex], beside: bool = False) -> Curve:
    """A line through points of a plane, complex."""
    points = np.asarray(points)
    return Curve(words, points.imag, beside, points.real)


def circle(words: str, radius: float, centre: complex = 0.0, beside: bool = True) -> Curve:
    """A circle in a plane."""
    return path(words, centre + radius * np.exp(1j * np.linspace(0.0, math.tau, 361)), beside)


def plan(curves: Sequence[Curve], title: str = "", unit: str = "m", words: tuple[str, str] = ("x", "y")) -> Panel:
    """Lines of a plane, to scale.

    Parameters
    ----------
    curves : sequence of Curve
        With places of their own.
    title, unit : str
    words : (str, str)
        What both axes are.
    """
    every = np.concatenate([curve.places for curve in curves])
    return Panel(PanelAxis(words[0], unit), PanelAxis(words[1], unit), every, curves, title=title, kind="plan")


def bounded(places: np.ndarray, curves: Sequence[Curve], given: float) -> tuple[float, float] | None:
    """Limits of curves of which some grow beyond all bounds; None where all of them can be shown.

    Parameters
    ----------
    places : ndarray
    curves : sequence of Curve
    given : float
        Where the element is as given; the curves are shown HIGHEST times as high as there, or as in their midst where
        they have no value there.
    """
    drawn = np.array([curve.values for curve in curves])
    if not np.isfinite(drawn).any():
        return None
    usual = drawn[:, np.abs(places - given).argmin()]
    high = HIGHEST * np.abs(usual if np.isfinite(usual).all() else np.nanmedian(drawn[np.isfinite(drawn)])).max()
    if not np.nanmax(np.abs(drawn)) > high > 0.0:
        return None
    low = max(min(np.nanmin(drawn), 0.0) - 0.05 * high, -high)
    return float(low), float(min(1.05 * np.nanmax(drawn), high))
