"""Diagrams of an element as data: curves, marks and units, for whoever draws them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

# Curves that grow beyond all bounds are shown up to so many times what they are as given.
HIGHEST = 4.0


class PanelAxis(NamedTuple):
    """What runs along an axis: its words, and its unit (SI)."""

    words: str
    unit: str


class Curve(NamedTuple):
    """A curve by its words, NaN where it has no value; one that stands `beside` the element's own is drawn faintly."""

    words: str
    values: np.ndarray
    beside: bool = False


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
        Of what is shown upwards; all unless given.
    """

    x: PanelAxis
    y: PanelAxis
    places: np.ndarray
    curves: Sequence[Curve]
    marks: Sequence[Mark] = ()
    title: str = ""
    limits: tuple[float, float] | None = None


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
