"""Curves of one governor for plots: its characteristic, and the motion after a change of load."""

import math
from typing import NamedTuple

import numpy as np

from engine.elements.element import Element
from engine.elements.governors.equilibria import governor_marks, governor_variants, near_equilibrium
from engine.elements.governors.governed_engine import GovernedEngine
from engine.elements.governors.transients import follow_changes
from engine.elements.panels import Curve, Mark, Panel, PanelAxis
from engine.units.display import quantity_text
from engine.words.verdicts import Verdict

# Margins this close to 0 are drawn as stable: a plotted line can't show the difference.
_FLAT = 1e-12
# Extent of the curves beyond the stops, as a fraction of the range between them.
BEYOND = 0.25


class GovernorCurves(NamedTuple):
    """Equilibrium of a governor at equally spaced positions between and beyond its stops, SI units.

    Attributes
    ----------
    radius, lift, force, speed, sleeve, margin : ndarray (positions,)
        Radius of the balls, sleeve lift from the inner stop, controlling force of one ball, spindle speed, force at the
        sleeve that holds the balls, and (dω²/dr)/(ω²/r). NaN where the arms don't reach.
    between : ndarray (positions,) of bool
        Whether a position lies between the stops.
    stops : tuple of 2 floats
        Radii at the inner and the outer stop.
    stable : tuple of 2 floats
        Radii at the ends of the longest stable range; NaN without one.
    verdict : Verdict
    """

    radius: np.ndarray
    lift: np.ndarray
    force: np.ndarray
    speed: np.ndarray
    sleeve: np.ndarray
    margin: np.ndarray
    between: np.ndarray
    stops: tuple[float, float]
    stable: tuple[float, float]
    verdict: Verdict


def governor_curves(governor: Element, positions: int = 401) -> GovernorCurves:
    """Characteristic of a governor between its stops and somewhat beyond.

    Parameters
    ----------
    governor : Governor
    positions : int

    Returns
    -------
    GovernorCurves
        Without positions if the arms don't reach the stops.
    """
    g = governor_variants(governor, governor.own_numbers())
    marks, verdicts = governor_marks(g)
    room = BEYOND * (marks.outer[0] - marks.inner[0])
    places = np.linspace(marks.inner[0] - room, marks.outer[0] + room, positions)
    found = g.some(np.zeros(positions, int)).at(places, marks.inner)
    ends = g.at(np.stack([marks.inner, marks.outer, marks.begin, marks.end]), marks.inner).radius[:, 0]
    # Without stops, or without equilibrium between them, there is nothing to plot.
    between = (places >= marks.inner[0]) & (places <= marks.outer[0])
    seen = slice(None) if np.isfinite(found.speed[between]).any() else slice(0)
    rows = (row[seen] for row in found[:6])
    return GovernorCurves(*rows, between[seen], tuple(ends[:2]), tuple(ends[2:]), Verdict(verdicts[0]))


class LoadChange(NamedTuple):
    """Motion of an engine and its governor after a change of load, SI units.

    Attributes
    ----------
    time, lift, speed : ndarray (instants,)
        Time, sleeve lift, engine speed.
    before, after : float
        Steady speeds of the engine.
    """

    time: np.ndarray
    lift: np.ndarray
    speed: np.ndarray
    before: float
    after: float


def load_change(governor: Element, cycle: np.ndarray | None = None) -> LoadChange | None:
    """Motion of a governor's engine after its change of load.

    Parameters
    ----------
    governor : Governor
    cycle : ndarray, optional
        For a governor of a mechanism, from `governed_scene`.

    Returns
    -------
    LoadChange or None
        Up to where the integration succeeds; None if it fails at once, without equilibrium, or if the scene has no
        change of load.
    """
    if not governor.is_followed:
        return None
    g = governor_variants(governor, governor.own_numbers())
    marks, verdicts = governor_marks(g)
    if verdicts[0] != Verdict.OK:
        return None
    changes = follow_changes(
        g, marks, verdicts, np.zeros((0, 1)) if cycle is None else cycle[:, None], 1.0, records=True
    )
    if not changes.instants.size:
        return None
    steady = near_equilibrium(g, marks)
    after = steady["working_speed"][0]
    return LoadChange(*changes.instants, after - steady["steady_speed_change"][0], after)


class StabilityPoint(NamedTuple):
    """Coordinates of an engine with its governor in Vyshnegradsky's diagram."""

    x: float
    y: float


def stability_point(governor: Element) -> StabilityPoint | None:
    """Coordinates of a governor's engine in Vyshnegradsky's diagram.

    Parameters
    ----------
    governor : Governor

    Returns
    -------
    StabilityPoint or None
        None without an engine, without equilibrium, and for an on-off valve.
    """
    if governor.engine is None:
        return None
    found = governor.evaluate(governor.own_numbers()).values
    x, y = (float(found[f"vyshnegradsky_{axis}"][0]) for axis in "xy")
    return StabilityPoint(x, y) if np.isfinite(x) else None


def governor_panels(governor: Element, cycle: np.ndarray | None = None) -> tuple[Panel, ...]:
    """Controlling force and equilibrium speed; with an engine, its stability and a change of load.

    Parameters
    ----------
    governor : Governor
    cycle : ndarray, optional
        Curves of the mechanism that is its engine, as for `load_change`.
    """
    curve, point, change = governor_curves(governor), stability_point(governor), load_change(governor, cycle)
    if not curve.radius.size:
        return ()
    found = [_characteristic(curve), _speeds(curve, governor.friction)]
    found += [] if point is None else [_diagram(point)]
    return (*found, *([] if change is None else _change(change, governor.engine)))


def _parts(curve: GovernorCurves, row: np.ndarray) -> list[Curve]:
    """A row split into its stable and unstable parts between the stops."""
    stable = curve.margin >= -_FLAT
    chosen = (("stable", stable & curve.between), ("unstable", ~stable & curve.between))
    return [Curve(words, np.where(part, row, np.nan)) for words, part in chosen if part.any()]


def _characteristic(curve: GovernorCurves) -> Panel:
    """Controlling force of one ball, with rays of constant speed and the stops."""
    inside = curve.speed[curve.between]
    mass = np.nanmean(curve.force / (curve.radius * curve.speed**2))
    along = np.array([0.0, curve.stops[1] + 0.3 * (curve.stops[1] - curve.stops[0])])
    rays = [
        Curve(f"{speed * 30.0 / math.pi:.4g} rpm", mass * speed**2 * along, True, along)
        for speed in sorted({float(np.nanmin(inside)), float(np.nanmax(inside))})
    ]
    curves = [*_parts(curve, curve.force), Curve("", curve.force, True), *rays]
    marks = [Mark(words, stop, None) for words, stop in zip(("stops", ""), curve.stops, strict=True)]
    x, y = PanelAxis("radius of the balls", "m", "r"), PanelAxis("controlling force of one ball", "N", "F")
    title = "Controlling force" if curve.verdict == Verdict.OK else curve.verdict.sentence
    return Panel(x, y, curve.radius, curves, marks, title)


def _speeds(curve: GovernorCurves, friction: float) -> Panel:
    """Spindle speed over lift, with the band in which friction holds the sleeve."""
    curves, chosen = _parts(curve, curve.speed), curve.between
    if friction > 0.0:
        share = np.minimum(friction / curve.sleeve, 1.0)
        edges = (("held by friction up to here", -1.0), ("", 1.0))
        curves += [Curve(words, curve.speed * np.sqrt(1.0 + side * share), True) for words, side in edges]
    curves = [one._replace(values=one.values[chosen]) for one in curves]
    x, y = PanelAxis("lift of the sleeve", "m", "s"), PanelAxis("speed of the spindle", "rad s-1", "ω")
    return Panel(x, y, curve.lift[chosen], curves, title="Speed in equilibrium")


def _diagram(point: StabilityPoint) -> Panel:
    """Vyshnegradsky's diagram: regions in which an engine with its governor hunts, oscillates, or does neither."""
    top = max(6.0, 1.25 * point.x, 1.25 * point.y)
    x = np.linspace(top / 400.0, top, 400)
    # Double roots −a, −a, −1/a²: X = 2a + 1/a², Y = a² + 2/a; the two branches meet at (3, 3).
    above, below = (
        np.where(x >= 3.0, np.interp(x, 2.0 * a + 1.0 / a**2, a**2 + 2.0 / a), np.nan)
        for a in (np.geomspace(1.0, top, 2000), np.geomspace(1.0, 1.0 / top, 2000))
    )
    curves = Curve("hunts below", 1.0 / x), Curve("no oscillation below", above), Curve("no oscillation above", below)
    marks = (Mark(f"X Y = {point.x * point.y:.3g}", point.x, point.y),)
    axes = PanelAxis("damping", "1", "X"), PanelAxis("stiffness", "1", "Y")
    return Panel(*axes, x, curves, marks, "Vyshnegradsky's diagram", (0.0, top))


def _change(change: LoadChange, engine: GovernedEngine) -> tuple[Panel, Panel]:
    """Engine speed and sleeve lift after a change of load."""
    x, y = PanelAxis("time after the change of load", "s", "t"), PanelAxis("speed of the engine", "rad s-1", "ω")
    band = [Mark(words, None, change.after * (1.0 + side * engine.settling_band)) for words, side in _BAND]
    title = f"Load from {quantity_text(engine.load, 'N m')} to {quantity_text(engine.new_load, 'N m')}"
    lift = Panel(x, PanelAxis("lift of the sleeve", "m", "s"), change.time, (Curve("", change.lift),))
    return Panel(x, y, change.time, (Curve("", change.speed),), band, title), lift


_BAND = (("settled", -1.0), ("", 1.0))
