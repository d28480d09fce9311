"""Diagrams of an element as data for the plotting code: curves, marks and units."""

import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

# Limit of the y axis for unbounded curves, relative to their value at the given number.
HIGHEST = 4.0


class PanelAxis(NamedTuple):
    """Words, unit (SI) and symbol of an axis; a symbol such as "M_in" has its index after the underscore."""

    words: str
    unit: str
    symbol: str = ""


TIME = PanelAxis("time", "s", "t")
VELOCITY, SPEED = PanelAxis("speed", "m s-1", "v"), PanelAxis("speed", "rad s-1", "ω")


class Curve(NamedTuple):
    """A curve with its label, NaN where undefined; a reference curve is `faint`.

    `places`, if given, replace the panel's. A faint curve with its own places is labelled at its end, except in a plan.
    """

    words: str
    values: np.ndarray
    faint: bool = False
    places: np.ndarray | None = None


class Mark(NamedTuple):
    """A labelled point; a vertical line without `height`, a horizontal line without `place`."""

    words: str
    place: float | None
    height: float | None


class Panel(NamedTuple):
    """Curves in one diagram.

    Attributes
    ----------
    x, y : PanelAxis
    places : ndarray
        Abscissae of the curves.
    curves : sequence of Curve
    marks : sequence of Mark
    title : str
    limits : (float, float), optional
        Limits of the y axis, logarithmic if both are above 0; default: all values.
    kind : {"curves", "plan", "bars"}
        A plan has equal scales on both axes; bars of several curves are side by side at each abscissa.
    names : sequence of str
        Labels of the abscissae, if they are not numbers.
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


def path(words: str, points: np.ndarray | Sequence[complex], faint: bool = False) -> Curve:
    """A line through points of a plane, given as complex numbers."""
    points = np.asarray(points)
    return Curve(words, points.imag, faint, points.real)


def circle(words: str, radius: float, centre: complex = 0.0) -> Curve:
    """A faint circle in a plane."""
    return path(words, centre + radius * np.exp(1j * np.linspace(0.0, math.tau, 361)), True)


def plan(curves: Sequence[Curve], title: str = "", unit: str = "m", words: tuple[str, str] = ("x", "y")) -> Panel:
    """Lines in a plane, to scale.

    Parameters
    ----------
    curves : sequence of Curve
        Each with its own abscissae.
    title, unit : str
    words : (str, str)
        Labels of both axes.
    """
    every = np.concatenate([curve.places for curve in curves])
    return Panel(PanelAxis(words[0], unit), PanelAxis(words[1], unit), every, curves, title=title, kind="plan")


def bounded(places: np.ndarray, curves: Sequence[Curve], given: float) -> tuple[float, float] | None:
    """Limits of the y axis if a curve is unbounded; None if all values can be shown.

    Parameters
    ----------
    places : ndarray
    curves : sequence of Curve
    given : float
        Given value of the abscissa. The upper limit is HIGHEST times the largest magnitude there, or HIGHEST times the
        median if a curve is undefined there.
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
