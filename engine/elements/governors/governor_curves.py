"""Diagrams of one governor: its characteristic, and the motion after a change of load."""

import math

import numpy as np

from engine.elements.element import Element
from engine.elements.governors.equilibria import governor_marks, governor_variants, near_equilibrium
from engine.elements.governors.governed_engine import GovernedEngine
from engine.elements.governors.governor_nodes import States
from engine.elements.governors.transients import follow_changes
from engine.elements.panels import Curve, Mark, Panel, PanelAxis
from engine.units.display import quantity_text
from engine.words.verdicts import Verdict

# Margins this close to 0 are drawn as stable: a plotted line can't show the difference.
_FLAT = 1e-12
# Number of positions of the curves; their extent beyond the stops, as a fraction of the range between them.
_POSITIONS, BEYOND = 401, 0.25


def governor_panels(governor: Element, cycle: np.ndarray | None = None) -> tuple[Panel, ...]:
    """Controlling force and equilibrium speed; with an engine, its stability and a change of load.

    Parameters
    ----------
    governor : Governor
    cycle : ndarray, optional
        Curves of the mechanism that is its engine, from `governed_scene`.
    """
    g = governor_variants(governor, governor.own_numbers())
    marks, verdicts = governor_marks(g)
    inner, outer = marks.inner[0], marks.outer[0]
    room = BEYOND * (outer - inner)
    places = np.linspace(inner - room, outer + room, _POSITIONS)
    found = g.some(np.zeros(_POSITIONS, int)).at(places, marks.inner)
    between = (places >= inner) & (places <= outer)
    # Without stops, or without equilibrium between them, there is nothing to plot.
    if not np.isfinite(found.speed[between]).any():
        return ()
    stops, verdict = g.at(np.stack([marks.inner, marks.outer]), marks.inner).radius[:, 0], Verdict(verdicts[0])
    title = "Controlling force" if verdict == Verdict.OK else verdict.sentence
    panels = [_characteristic(found, between, stops, title), _speeds(found, between, governor.friction)]
    if governor.engine is None or verdict != Verdict.OK:
        return tuple(panels)
    steady = {name: row[0] for name, row in near_equilibrium(g, marks).items()}
    # A valve has no linear stability.
    panels += [] if governor.has_valve else [_diagram(steady["vyshnegradsky_x"], steady["vyshnegradsky_y"])]
    if governor.is_followed:
        curves = np.zeros((0, 1)) if cycle is None else cycle[:, None]
        instants = follow_changes(g, marks, verdicts, curves, 1.0, records=True).instants
        # A motion that fails at once has none.
        panels += _change(instants, steady["working_speed"], governor.engine) if instants.size else ()
    return tuple(panels)


def _parts(found: States, between: np.ndarray, row: np.ndarray) -> list[Curve]:
    """A row split into its stable and unstable parts between the stops."""
    stable = found.margin >= -_FLAT
    chosen = (("stable", stable & between), ("unstable", ~stable & between))
    return [Curve(words, np.where(part, row, np.nan)) for words, part in chosen if part.any()]


def _characteristic(found: States, between: np.ndarray, stops: np.ndarray, title: str) -> Panel:
    """Controlling force of one ball, with rays of constant speed and the stops."""
    inside = found.speed[between]
    mass = np.nanmean(found.force / (found.radius * found.speed**2))
    along = np.array([0.0, stops[1] + 0.3 * (stops[1] - stops[0])])
    rays = [
        Curve(f"{speed * 30.0 / math.pi:.4g} rpm", mass * speed**2 * along, True, along)
        for speed in sorted({float(np.nanmin(inside)), float(np.nanmax(inside))})
    ]
    curves = [*_parts(found, between, found.force), Curve("", found.force, True), *rays]
    marks = [Mark(words, stop, None) for words, stop in zip(("stops", ""), stops, strict=True)]
    x, y = PanelAxis("radius of the balls", "m", "r"), PanelAxis("controlling force of one ball", "N", "F")
    return Panel(x, y, found.radius, curves, marks, title)


def _speeds(found: States, between: np.ndarray, friction: float) -> Panel:
    """Spindle speed over lift, with the band in which friction holds the sleeve."""
    curves = _parts(found, between, found.speed)
    if friction > 0.0:
        share = np.minimum(friction / found.sleeve, 1.0)
        edges = (("held by friction up to here", -1.0), ("", 1.0))
        curves += [Curve(words, found.speed * np.sqrt(1.0 + side * share), True) for words, side in edges]
    curves = [one._replace(values=one.values[between]) for one in curves]
    x, y = PanelAxis("lift of the sleeve", "m", "s"), PanelAxis("speed of the spindle", "rad s-1", "ω")
    return Panel(x, y, found.lift[between], curves, title="Speed in equilibrium")


def _diagram(at_x: float, at_y: float) -> Panel:
    """Vyshnegradsky's diagram: regions in which an engine with its governor hunts, oscillates, or does neither."""
    top = max(6.0, 1.25 * at_x, 1.25 * at_y)
    x = np.linspace(top / 400.0, top, 400)
    # Double roots −a, −a, −1/a²: X = 2a + 1/a², Y = a² + 2/a; the two branches meet at (3, 3).
    above, below = (
        np.where(x >= 3.0, np.interp(x, 2.0 * a + 1.0 / a**2, a**2 + 2.0 / a), np.nan)
        for a in (np.geomspace(1.0, top, 2000), np.geomspace(1.0, 1.0 / top, 2000))
    )
    curves = Curve("hunts below", 1.0 / x), Curve("no oscillation below", above), Curve("no oscillation above", below)
    marks = (Mark(f"X Y = {at_x * at_y:.3g}", at_x, at_y),)
    axes = PanelAxis("damping", "1", "X"), PanelAxis("stiffness", "1", "Y")
    return Panel(*axes, x, curves, marks, "Vyshnegradsky's diagram", (0.0, top))


def _change(instants: np.ndarray, after: float, engine: GovernedEngine) -> tuple[Panel, Panel]:
    """Engine speed and sleeve lift after a change of load, with the band about the new steady speed."""
    time, lift, speed = instants
    x, y = PanelAxis("time after the change of load", "s", "t"), PanelAxis("speed of the engine", "rad s-1", "ω")
    sides = ("settled", -1.0), ("", 1.0)
    band = [Mark(words, None, after * (1.0 + side * engine.settling_band)) for words, side in sides]
    title = f"Load from {quantity_text(engine.load, 'N m')} to {quantity_text(engine.new_load, 'N m')}"
    lifts = Panel(x, PanelAxis("lift of the sleeve", "m", "s"), time, (Curve("", lift),))
    return Panel(x, y, time, (Curve("", speed),), band, title), lifts
