"""Governors in equilibrium: characteristic between the stops, stable range, and the engine's equilibrium under load.

Positions that need a search (ends of the stable range, minimum stability, lift at a load) are found once. The results
at slightly different numbers follow to first order, so error estimates by perturbation need no further search.
"""

from typing import NamedTuple

import numpy as np

from engine.cycle.regula_falsi import bisected, regula_falsi
from engine.elements.element import Columns, Element, Numbers
from engine.elements.governors.governor_forces import DATUM, States, equilibrium_nodes
from engine.elements.sampled_peak import sampled_peak
from engine.graph.nodes import Graph, Stage
from engine.graph.over_arrays import NodesOverArrays, over_arrays
from engine.laws.governors.stability import stability_with_engine
from engine.laws.rounding import EPS
from engine.words.quantity import Quantity, main_result
from engine.words.verdicts import Verdict

# Number of samples of a characteristic, and per piece of a table; distance of the outer samples from the ends of a
# piece, as a fraction of the range.
SAMPLES, _PIECE_SAMPLES, _INSIDE = 33, 9, 1e-12
_TINY = 1e-300
_LEAST_STABILITY = "minimum of (dω²/dr)/(ω²/r) in equilibrium between the stops; 0 is isochronous"
_INSENSITIVITY = "maximum range of speeds within which friction holds the sleeve, relative"
_SLEEVE_FORCE = "force at the sleeve that holds the balls, at half of the stable lift"
_EFFORT = "mean force at the sleeve for the given change of speed, at half of the stable lift"
OF_ENGINE = (
    main_result("working_lift", "lift of the sleeve at the engine's load, after its change", "m"),
    main_result("working_speed", "steady speed of the engine, after the change of load", "rad s-1"),
    main_result("steady_speed_change", "steady change of the engine's speed by the change of load", "rad s-1"),
    Quantity("vyshnegradsky_x", "Vyshnegradsky's X", "1", True),
    Quantity("vyshnegradsky_y", "Vyshnegradsky's Y", "1", True),
    main_result("stable", "engine and governor are stable (1) or hunt (0)", "1", exact=True),
    main_result("gain_margin", "gain of the throttle at which they hunt, over the given gain", "1", True),
    Quantity("critical_damping", "damping at the sleeve below which they hunt", "N s m-1", True),
    Quantity("critical_inertia", "inertia of the engine below which they hunt", "kg m2", True),
    Quantity("decay_rate", "rate at which the slowest part of a disturbance decays", "s-1", True),
    main_result("hunting_frequency", "angular frequency of the oscillation", "rad s-1", True),
    Quantity("oscillates", "a disturbance decays or grows in oscillations (1 or 0)", "1", exact=True),
)


class Marks(NamedTuple):
    """Results of the searches for each governor (variants,).

    Attributes
    ----------
    inner, outer, begin, end, shakiest, weakest, middle, before, after : ndarray
        Positions: the stops, the ends of the longest stable range, minimum stability, minimum sleeve force in the
        range, half of its lift, equilibrium under the engine's load before and after the change.
    off_begin, off_end, off_shakiest : ndarray
        Rounding errors of these positions.
    isochronous : ndarray
    mean_speed : ndarray
    """

    inner: np.ndarray
    outer: np.ndarray
    begin: np.ndarray
    end: np.ndarray
    shakiest: np.ndarray
    weakest: np.ndarray
    middle: np.ndarray
    before: np.ndarray
    after: np.ndarray
    off_begin: np.ndarray
    off_end: np.ndarray
    off_shakiest: np.ndarray
    isochronous: np.ndarray
    mean_speed: np.ndarray


class GovernorVariants(NamedTuple):
    """A governor with the numbers of some variants, by key and as rows, and its states as a function of the rows.

    The first rows are the position and those of the two stops.
    """

    governor: Element
    n: Numbers
    states: NodesOverArrays
    rows: np.ndarray

    def between(self, inner: np.ndarray, outer: np.ndarray) -> "GovernorVariants":
        """The governor with stops at these positions."""
        rows = self.rows.copy()
        rows[1], rows[2] = inner, outer
        return self._replace(rows=rows)

    def at(self, places: np.ndarray) -> States:
        """States at positions (..., variants)."""
        lines = places.reshape(-1, self.rows.shape[1])
        found = np.empty((len(lines), len(States._fields), lines.shape[1]))
        for line, states in zip(lines, found, strict=True):
            self.rows[0] = line
            self.states(self.rows, states)
        return States(*np.moveaxis(found, 1, 0).reshape(-1, *places.shape))

    def with_numbers(self, n: Numbers) -> "GovernorVariants":
        """The governor with other numbers, or of other variants, and without stops."""
        return self._replace(n=n, rows=self.states.table(n, n["ball_mass"].size))

    def some(self, who: np.ndarray) -> "GovernorVariants":
        """A subset of the variants, by index."""
        return self._replace(n={key: row[who] for key, row in self.n.items()}, rows=self.rows.take(who, axis=1))

    def moved(self, x: np.ndarray, name: str, wanted: np.ndarray) -> np.ndarray:
        """Positions at which "radius" or "lift" has the wanted value, to first order from nearby ones."""
        there = self.at(x)
        return x - (getattr(there, name) - wanted) / getattr(there, f"{name}_rate")


def governor_variants(governor: Element, n: Numbers) -> GovernorVariants:
    """A governor with the numbers of some variants.

    Parameters
    ----------
    governor : Governor
    n : mapping of str to ndarray (variants,)
    """
    graph = Graph()
    x, *stops = given = [graph.given(label, Stage.VARIANT) for label in ("position", "inner stop", "outer stop")]
    found = equilibrium_nodes(governor, graph, x, stops)
    states = NodesOverArrays(given, found)
    datum = np.ones_like(n["ball_mass"])
    return GovernorVariants(governor, n, states, np.zeros(0)).with_numbers(n | {DATUM: datum})


@np.errstate(all="ignore")
def governor_marks(g: GovernorVariants) -> tuple[GovernorVariants, Marks, np.ndarray]:
    """Search the characteristic of governors, and find the lifts at which their engines carry their loads.

    Parameters
    ----------
    g : GovernorVariants

    Returns
    -------
    g : GovernorVariants
        With its stops.
    marks : Marks
    verdicts : ndarray (variants,) of uint8
    """
    least, greatest = g.n["least_radius"], g.n["greatest_radius"]
    low, high = (g.governor.position_of(g, radius) for radius in (least, greatest))
    g, places = g.between(low, high), _sample_places(g, low, high)
    found = g.at(places)
    finite = np.isfinite(found.radius_rate) & np.isfinite(found.lift_rate)
    bad = ~(finite & (found.radius_rate > 0.0) & (found.lift_rate > 0.0))
    fails = np.where(_at(finite, bad.argmax(axis=0)), Verdict.SINGULAR, Verdict.CANNOT_ASSEMBLE)
    stable, index = found.stable, np.arange(len(places))[:, None]
    start = np.maximum.accumulate(np.where(stable, 0, index + 1), axis=0)
    begins = np.take_along_axis(places, np.minimum(start, len(places) - 1), axis=0)
    last = np.where(stable, places - begins, -1.0).argmax(axis=0)
    first = _at(start, last)
    begin, off_begin = _edge(g, places, first, -1)
    end, off_end = _edge(g, places, last, 1)

    def peak_of(name: str, where: np.ndarray) -> np.ndarray:
        """Position of the minimum of a state, refined from the smallest sample."""
        return sampled_peak(lambda x: -getattr(g.at(x), name), where)[1]

    k = found.margin.argmin(axis=0)
    beside = np.clip(k + np.array([[-1], [1]]), 0, len(places) - 1)
    shakiest = peak_of("margin", places)
    there = g.at(shakiest)
    rise = np.take_along_axis(found.margin, beside, axis=0).min(axis=0) - there.margin
    span = np.ptp(np.take_along_axis(places, beside, axis=0), axis=0)
    off = span * np.sqrt(np.minimum(there.rounding / np.maximum(rise, _TINY), 1.0))
    weakest = peak_of("sleeve", np.clip(places, begin, end))
    flat = (last > first) & ((found.margin - found.rounding).max(axis=0) <= 0.0)
    ends = g.at(np.stack([begin, end]))
    half = 0.5 * (ends.lift[0] + ends.lift[1])
    nowhere = np.full(low.size, np.nan)
    marks = Marks(
        inner=low,
        outer=high,
        begin=begin,
        end=end,
        shakiest=shakiest,
        weakest=weakest,
        middle=regula_falsi(lambda x: g.at(x).lift - half, begin, end),
        before=nowhere,
        after=nowhere,
        off_begin=off_begin,
        off_end=off_end,
        off_shakiest=np.where(shakiest == _at(places, k), 0.0, off),
        isochronous=flat.astype(float),
        mean_speed=0.5 * (ends.speed[0] + ends.speed[1]),
    )
    verdicts = np.select(
        [~(least < greatest), ~(low < high), bad.any(axis=0), ~stable.any(axis=0)],
        [Verdict.OUTSIDE_LIMITS, Verdict.CANNOT_ASSEMBLE, fails, Verdict.UNSTABLE],
        np.where(g.n["friction"] < g.at(weakest).sleeve, Verdict.OK, Verdict.JAMS),
    )
    if g.governor.engine is not None:
        loads = g.n["engine.load"], g.n.get("engine.new_load", g.n["engine.load"])
        (before, first), (after, second) = (_working_position(g, marks, load) for load in loads)
        marks = marks._replace(before=before, after=after)
        for verdict in (first, second):
            verdicts = np.where(verdicts == Verdict.OK, verdict, verdicts)
    return g, marks, verdicts.astype(np.uint8)


def _at(rows: np.ndarray, k: np.ndarray) -> np.ndarray:
    """Row k of each variant."""
    return np.take_along_axis(rows, k[None], axis=0)[0]


def _sample_places(g: GovernorVariants, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Sample positions between the stops; for a table in each of its pieces, on both sides of its breaks."""
    table = g.governor.controlling_table
    if table is None:
        return low + (high - low) * (np.arange(SAMPLES) / (SAMPLES - 1))[:, None]
    breaks = table.breaks[1:-1, None] + 0.0 * low
    if g.governor.over_radius is None:
        breaks = low + breaks / g.n["lift_ratio"]
    ends = np.concatenate([low[None], np.clip(breaks, low, high), high[None]])
    tiny = _INSIDE * (high - low)
    share = np.arange(_PIECE_SAMPLES)[:, None] / (_PIECE_SAMPLES - 1)
    left, right = ends[:-1, None] + tiny, ends[1:, None] - tiny
    places = np.sort(np.clip((left + (right - left) * share).reshape(-1, low.size), low, high), axis=0)
    places[0], places[-1] = low, high
    return places


def _edge(g: GovernorVariants, places: np.ndarray, k: np.ndarray, side: int) -> tuple[np.ndarray, np.ndarray]:
    """End of a stable range beyond its sample k, in one direction, and its rounding error."""
    other = np.clip(k + side, 0, len(places) - 1)
    inside = stable = _at(places, k)
    unstable = _at(places, other)
    if (other == k).all():
        return inside, np.zeros(inside.size)
    stable, _ = bisected(lambda x: g.at(x).stable, stable, unstable)
    there, beside = g.at(stable), g.at(inside)
    share = np.minimum(4.0 * beside.rounding / np.maximum(np.abs(beside.margin - there.margin), _TINY), 1.0)
    is_stop = other == k
    return np.where(is_stop, inside, stable), np.where(is_stop, 0.0, np.abs(inside - stable) * share)


def _surplus(g: GovernorVariants, found: States, mean: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Engine torque minus load at equilibrium; for a valve, lift missing to its switch."""
    if g.governor.has_valve:
        return g.n["engine.throttle.switch"] - found.lift
    regulation = g.n["engine.self_regulation"] / g.n["engine.ratio"]
    return found.driving - regulation * (found.speed - mean) - load


def _working_position(g: GovernorVariants, marks: Marks, load: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions in the stable range at which engines carry a load, and verdicts on that."""
    ends, mean = g.at(np.stack([marks.begin, marks.end])), marks.mean_speed
    regulation = g.n["engine.self_regulation"] / g.n["engine.ratio"]
    most, least = ends.driving - regulation * (ends.speed - mean)
    verdicts = np.select([~(load <= most), ~(load >= least)], [Verdict.STALLS, Verdict.RUNS_AWAY], Verdict.OK)
    if g.governor.has_valve:
        switch = g.n["engine.throttle.switch"]
        verdicts = np.where((ends.lift[0] < switch) & (switch < ends.lift[1]), verdicts, Verdict.OUTSIDE_LIMITS)
    x = regula_falsi(lambda x: _surplus(g, g.at(x), mean, load), marks.begin, marks.end)
    return np.where(verdicts == Verdict.OK, x, np.nan), verdicts


def _at_load(g: GovernorVariants, x: np.ndarray, mean: np.ndarray, load: np.ndarray) -> States:
    """States at which engines carry a load, to first order from nearby positions."""
    there = g.at(x)
    left = _surplus(g, there, mean, load)
    if g.governor.has_valve:
        return g.at(x + left / there.lift_rate)
    # At equilibrium a lift dz corresponds to a speed change dω = ω c dz/(2 E).
    regulation = g.n["engine.self_regulation"] / g.n["engine.ratio"]
    slope = there.gain + regulation * there.speed * there.stiffness / (2.0 * there.sleeve)
    return g.at(np.where(slope > 0.0, x + left / (slope * there.lift_rate), x))


@np.errstate(all="ignore")
def near_equilibrium(g: GovernorVariants, marks: Marks) -> dict[Quantity, np.ndarray]:
    """All results of governors from their marks, to first order in changes of their numbers.

    Parameters
    ----------
    g : GovernorVariants
    marks : Marks
        For some variants; `g` contains copies of these, one set after another.
    """
    n = g.n
    copies = g.rows.shape[1] // marks.inner.size
    inner, outer, begin, end, shakiest, weakest, middle, before, after, *_ = (np.tile(x, copies) for x in marks)
    stops = (inner, n["least_radius"]), (outer, n["greatest_radius"])
    low, high = (g.moved(x, "radius", radius) for x, radius in stops)
    g = g.between(low, high)

    def own(x: np.ndarray) -> np.ndarray:
        """A mark; one that lies at a stop moves with it."""
        return np.where(x == inner, low, np.where(x == outer, high, x))

    found = g.at(np.stack([low, high, own(begin), own(end), own(shakiest), own(weakest)]))
    at_low, at_high, first, last, shaky, weak = found.each()
    half = g.at(g.moved(middle, "lift", 0.5 * (first.lift + last.lift)))
    mean, effort = 0.5 * (first.speed + last.speed), n["speed_change"] * half.sleeve
    # Friction F holds the sleeve between ω √(1 − F/E) and ω √(1 + F/E).
    falls, rises = (
        end.speed * np.sqrt(1.0 + side * n["friction"] / end.sleeve) for end, side in ((first, -1.0), (last, 1.0))
    )
    held = n["friction"] / weak.sleeve
    # √(1 + F/E) − √(1 − F/E) without its cancellation.
    insensitivity = 2.0 * held / (np.sqrt(1.0 + held) + np.sqrt(1.0 - held))
    uneven, isochronous = (last.speed - first.speed) / mean, np.tile(marks.isochronous, copies)
    power = 2.0 * effort * effort / half.stiffness
    results = {
        Quantity("inner_speed", "speed of the spindle in equilibrium at the inner stop", "rad s-1"): at_low.speed,
        Quantity("outer_speed", "speed of the spindle in equilibrium at the outer stop", "rad s-1"): at_high.speed,
        Quantity("inner_force", "controlling force of one ball at the inner stop", "N"): at_low.force,
        Quantity("outer_force", "controlling force of one ball at the outer stop", "N"): at_high.force,
        Quantity("stable_from", "radius at which the longest stable range begins", "m"): first.radius,
        Quantity("stable_to", "radius at which the longest stable range ends", "m"): last.radius,
        main_result("least_speed", "minimum speed of the spindle in the stable range", "rad s-1"): first.speed,
        main_result("greatest_speed", "maximum speed of the spindle in the stable range", "rad s-1"): last.speed,
        main_result("mean_speed", "mean of the minimum and maximum speed", "rad s-1"): mean,
        main_result("non_uniformity", "range of speeds in the stable range over the mean speed", "1"): uneven,
        Quantity("least_stability", _LEAST_STABILITY, "1"): shaky.margin,
        Quantity("least_stability_radius", "radius at which the governor is least stable", "m"): shaky.radius,
        main_result("isochronous", "the governor is isochronous (1 or 0)", "1", exact=True): isochronous,
        main_result("sleeve_lift", "lift of the sleeve between the stops", "m"): at_high.lift,
        main_result("insensitivity", _INSENSITIVITY, "1"): insensitivity,
        Quantity("least_speed_with_friction", "speed at which the sleeve falls to its lowest", "rad s-1"): falls,
        Quantity("greatest_speed_with_friction", "speed at which the sleeve rises to its highest", "rad s-1"): rises,
        Quantity("sleeve_force", _SLEEVE_FORCE, "N"): half.sleeve,
        main_result("effort", _EFFORT, "N"): effort,
        main_result("power", "effort times the lift that the given change of speed makes", "J", True): power,
    }
    if g.governor.engine is None:
        return results
    load = n["engine.load"]
    old, new = _at_load(g, before, mean, load), _at_load(g, after, mean, n.get("engine.new_load", load))
    ratio, nothing = n["engine.ratio"], np.full(low.size, np.nan)
    rows = (nothing, nothing, 0.0 * low, nothing, nothing, nothing, nothing, nothing, 1.0 + 0.0 * low)
    if not g.governor.has_valve:
        balls, pull = ratio * ratio * new.balls, 2.0 * new.sleeve * ratio / new.speed
        numbers = n["engine.inertia"], new.mass, n["damping"], new.stiffness, n["engine.self_regulation"]
        rows = over_arrays(stability_with_engine, *numbers, new.gain, pull, balls)
    steady = new.lift, new.speed / ratio, (new.speed - old.speed) / ratio
    return results | dict(zip(OF_ENGINE, (*steady, *rows), strict=True))


def search_errors(g: GovernorVariants, marks: Marks, found: Columns) -> Columns:
    """Additional rounding errors of some results: from differences, and from the searched positions.

    Parameters
    ----------
    g : GovernorVariants
    marks : Marks
    found : dict of str to ndarray (variants,)
    """
    more = {
        "non_uniformity": 2.0 * EPS,
        "least_stability": g.at(marks.shakiest).rounding,
        "least_stability_radius": marks.off_shakiest,
        "stable_from": marks.off_begin,
        "stable_to": marks.off_end,
    }
    if g.governor.engine is not None:
        more["steady_speed_change"] = 2.0 * EPS * found["working_speed"]
    return more
