"""One machine at positions of its input: positions and motion of its parts, loads on its links.

Values have the shapes of the graph's records, with arrays instead of nodes and a vector as x + iy. Derivatives are with
respect to the input, as in the graph. Everything is computed by NumPy, without compiled code.
"""

import dataclasses
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from engine.cycle.measured import Measured
from engine.cycle.one_variant import OneVariant, WheelCycle, WheelNumbers
from engine.graph.nodes import Node, Stage
from engine.laws.elementary import angle_or_zero
from engine.machine.checks import check_names, check_positions, full_names, given_numbers
from engine.machine.measuring.conditions import (
    ON_MARGINS,
    SINGULAR_SINE,
    margins_against_jamming,
    margins_at_cams,
    taking_part,
    wound_springs,
)
from engine.machine.results import AskError
from engine.mechanism.assembly import MovingPoint, Slide, Turning
from engine.mechanism.higher_pairs.cam_motion import CamMotion
from engine.mechanism.higher_pairs.noncircular_motion import NoncircularMotion
from engine.mechanism.link_loads import LinkForce
from engine.mechanism.mechanics import Mechanics
from engine.mechanism.vectors import Vector
from engine.parts.skeleton import FRAME, CrankInput
from engine.quantities.all_chapters import register_of
from engine.quantities.expressions import (
    Angle,
    Expression,
    Extreme,
    Followed,
    Integral,
    LeastMagnitude,
    Measurement,
    Speed,
    SteadyCycle,
    StrokeEnd,
    VariantNumber,
    Work,
    evaluated,
    nodes_of,
)
from engine.scene.scene import Numbers, Scene, scene_numbers
from engine.units.reading import dimension_of_unit
from engine.words.verdicts import Verdict

# Positions between which angles are unwrapped, and at which failures are searched.
_LOOKED_AT = 720
# Turn between two positions [rad] above which an angle is followed between them, and most halvings of their distance.
_SHARP, _HALVINGS = 0.5, 40
# Fraction of a machine's own sizes below which a field is rounding.
_ROUNDED = 1e-12
# Relative error of results from series.
_SERIES = 1e-9
# Results of a steady cycle, from the cycle and its mean speed.
_OF_STEADY: dict[str, Callable[[WheelCycle, float], float]] = {
    "flywheel_used": lambda found, _: found.wheel,
    "flywheel_wittenbauer": lambda found, _: found.exact,
    "speed_fluctuation": lambda found, _: found.fluctuation,
    "speed_min": lambda found, mean: mean * (1.0 - 0.5 * found.fluctuation),
    "speed_max": lambda found, mean: mean * (1.0 + 0.5 * found.fluctuation),
}


class NowhereDefinedError(ValueError):
    """A quantity is undefined at all positions; `verdict` is the reason."""

    def __init__(self, verdict: Verdict) -> None:
        super().__init__(verdict.sentence)
        self.verdict = verdict


class Places(NamedTuple):
    """Positions of the parts of a machine, by name: positions [m] and directions in the scene's coordinates.

    Attributes
    ----------
    points, contacts, pitch_points : dict of str to complex ndarray (positions,)
        Points; contacts of cams; pitch points of non-circular wheels.
    links, guides : dict of str to (complex ndarray, complex ndarray)
        Origin and direction of a link's axes; a point and the direction of a guide.
    slides : dict of str to ndarray (positions,)
        [m]
    centres : dict of str to complex ndarray (positions,)
        Mass centres of bodies.
    """

    points: dict[str, np.ndarray]
    links: dict[str, tuple[np.ndarray, np.ndarray]]
    guides: dict[str, tuple[np.ndarray, np.ndarray]]
    slides: dict[str, np.ndarray]
    contacts: dict[str, np.ndarray]
    pitch_points: dict[str, np.ndarray]
    centres: dict[str, np.ndarray]


class Motions(NamedTuple):
    """Motion of the parts of a machine, by name."""

    points: dict[str, MovingPoint]
    links: dict[str, Turning]
    slides: dict[str, Slide]
    centres: dict[str, MovingPoint]
    cams: dict[str, CamMotion]
    noncircular: dict[str, NoncircularMotion]


class DyadGap(NamedTuple):
    """Distance that the bars of a dyad have to span, (positions,), and the least and the greatest that they can [m]."""

    distance: np.ndarray
    least: float
    greatest: float


class MovingMachine:
    """One machine at positions of its input.

    Parameters
    ----------
    scene : Scene
    values : mapping of path to float, optional
        Numbers (SI) that replace the scene's.
    positions : int or sequence of float
        Intervals over the cycle, or over the input's range; or the positions themselves [rad, or m].
    known : Mechanics, optional
        Reused if it is that of this scene, or of one of which this is a variant.

    Attributes
    ----------
    values : dict of str to float
    numbers : Numbers
    mechanics : Mechanics
    register : Register
    q : ndarray (positions,)
        Crank angles [rad], or displacements of a sliding input [m].

    Raises
    ------
    AskError
        A path isn't one of the scene's numbers, or the number of positions isn't allowed.
    NowhereDefinedError
        Raised by its properties: the quantity is undefined at all positions.
    """

    def __init__(
        self,
        scene: Scene,
        values: Mapping[str, float] | None = None,
        positions: int | Sequence[float] = 720,
        known: Mechanics | None = None,
    ) -> None:
        self.scene, self.values = scene, dict(values or {})
        limits = scene_numbers(scene)
        check_names(self.values, limits, "number of the scene")
        replaced = None if known is None else known.replaced_in(scene, self.values)
        if replaced is None:
            known, replaced = Mechanics(scene, frozenset(self.values)), self.values
        m, limits = known, scene_numbers(known.scene)
        self.mechanics = m
        arrays, (self._given,) = given_numbers(limits, tuple(replaced), replaced, None)
        self.numbers = Numbers(limits, {path: row[0] for path, row in arrays.items()})
        self.register = register_of(m)
        self._known_cycles: dict[SteadyCycle, WheelCycle] = {}
        self._variant = OneVariant(m.graph, self.numbers, (m.first, m.last), getattr(scene.input, "revolutions", 1))
        if np.ndim(positions) == 0:
            check_positions(positions)
            positions = self._spaced(positions)
        self.q = np.asarray(positions, float)

    def _spaced(self, intervals: int) -> np.ndarray:
        """Equally spaced positions; for a cycle without the last, which repeats the first."""
        first, last = self._variant.first, self._variant.last
        return first + (last - first) / intervals * np.arange(intervals + (not self.mechanics.has_cycle))

    @cached_property
    def places(self) -> Places:
        """Positions of all parts."""
        k, at, scene = self.mechanics.kinematics, self.mechanics.kinematics.coordinates, self.scene
        fixed = [name for name, point in scene.points.items() if point.link == FRAME]
        places = Places(
            {name: at(point.r) for name, point in k.points.items() if name not in fixed},
            {name: (at(link.origin.r), link.u) for name, link in k.links.items() if name != FRAME},
            {name: (at(guide.r), guide.u) for name, guide in k.guides.items()},
            {name: slide.d for name, slide in k.slides.items()},
            {name: at(cam.contact) for name, cam in k.cams.items()},
            {name: at(wheel.pitch_point) for name, wheel in k.noncircular.items()},
            {name: at(k.body_centre(name).r) for name in scene.bodies},
        )
        found, still = self._values(places), np.zeros_like(self.q)
        for name in fixed:
            found.points[name] = self.numbers[f"points.{name}.x"] + 1j * self.numbers[f"points.{name}.y"] + still
        found.links[FRAME] = still + 0j, still + (1 + 0j)
        return found

    @cached_property
    def motions(self) -> Motions:
        """Motion of all parts."""
        k = self.mechanics.kinematics
        links = {name: link._replace(origin=self._seen(link.origin)) for name, link in k.links.items()}
        wheels = {n: wheel._replace(pitch_point=k.coordinates(wheel.pitch_point)) for n, wheel in k.noncircular.items()}
        return self._values(
            Motions(
                {name: self._seen(point) for name, point in k.points.items()},
                links,
                k.slides,
                {name: self._seen(k.body_centre(name)) for name in self.scene.bodies},
                {name: cam._replace(contact=k.coordinates(cam.contact)) for name, cam in k.cams.items()},
                wheels,
            )
        )

    @cached_property
    def forces(self) -> list[LinkForce]:
        """All loads on each link at constant input speed; each link is in equilibrium under them."""
        seen = self.mechanics.kinematics.coordinates
        found = self.mechanics.reactions.link_forces()
        return self._values([force._replace(at=seen(force.at)) if force.at else force for force in found])

    def dyad_gap(self, name: str) -> DyadGap | None:
        """Distance that the bars of a dyad RRR or RRP have to span; None for other parts."""
        group, k = self.scene.groups.get(name), self.mechanics.kinematics
        if group is None or group.type not in ("RRR", "RRP"):
            return None

        def number(key: str) -> float:
            return self.numbers[f"groups.{name}.{key}"]

        begin, length = k.points[group.first.joint].r, number("first.length")
        if group.type == "RRR":
            apart, second = (k.points[group.second.joint].r - begin).length, number("second.length")
            return DyadGap(self._row(apart), abs(length - second), length + second)
        guide, offset = k.guides[group.second.guide], number("second.offset")
        return DyadGap(np.abs(self._row(guide.u.cross(begin - guide.r)) - offset), 0.0, length)

    def fields(self, names: Iterable[str]) -> dict[str, np.ndarray]:
        """Fields by name, NaN where undefined.

        Raises
        ------
        AskError
            The field doesn't exist, or a load in it depends on time.
        """
        curves = self._curves(names).items()
        if self._given != Verdict.OK:
            return {name: np.full(self.q.shape, np.nan) for name, _ in curves}
        # Overflow gives infinity or NaN, not a warning.
        with np.errstate(all="ignore"):
            return {name: self._row(curve) for name, curve in curves}

    def without_rounding(self, name: str, row: np.ndarray) -> np.ndarray:
        """A field, zero where it is only rounding of the machine's lengths, speed and energy."""
        mass, length, time, _ = dimension_of_unit(self.register.fields[name].units)
        longest, speed, energy = self._own_sizes
        with np.errstate(all="ignore"):
            # Masses enter only through the energy m (l/t)².
            size = energy**mass * longest ** (length - 2 * mass) * speed ** (-time - 2 * mass)
            return np.where((np.abs(row) <= _ROUNDED * size) & np.isfinite(size), 0.0, row)

    @cached_property
    def _own_sizes(self) -> np.ndarray:
        """Longest length [m], inverse of the time to pass it [1/s], and energy [J]."""
        limits = scene_numbers(self.scene)
        longest = max((abs(self.numbers[path]) for path in limits if limits[path].dimension == "length"), default=1.0)
        speed, turns = abs(self.numbers["input.speed"]), isinstance(self.scene.input, CrankInput)
        known = [name for name in ("reduced_inertia", "reduced_moment") if self.register.why_not(name) is None]
        with np.errstate(all="ignore"):
            sizes = {"reduced_inertia": np.square(speed), "reduced_moment": 1.0 if turns else longest}
            rows = self._variant.values([*self._curves(known).values()], self._spaced(_LOOKED_AT))
            energy = sum(
                sizes[n] * np.fmax.reduce(np.abs(row), initial=0.0) for n, row in zip(known, rows, strict=True)
            )
        return np.array([longest or 1.0, speed if turns else speed / (longest or 1.0), energy])

    def rate(self, name: str) -> np.ndarray:
        """Time derivative of a field at constant input speed; that of its series, without jumps.

        Parameters
        ----------
        name : str
            A field that is not an integral over the cycle.
        """
        (curve,) = self._curves([name]).values()
        with np.errstate(all="ignore"):
            return self._variant.number(self.mechanics.speed) * self._variant.slope(curve, self.q)

    def summary(self, name: str) -> float:
        """A summary by name; see `summaries`."""
        return float(self.summaries([name])[name].value)

    def summaries(self, names: Iterable[str]) -> dict[str, Measured]:
        """Summaries by name: means and extremes of fields, ends of strokes, results of the steady cycle.

        Their error estimates are those of the series that represent the curves.
        """
        # An evaluation caches by identity, so all expressions must outlive it.
        full = {name: full_names(self.mechanics.scene, name) for name in names}
        expressions = {name: self.register.summary(known).expression() for name, known in full.items()}
        known: dict[Measurement | int, Measured] = {}
        with np.errstate(all="ignore"):
            return {name: evaluated(expression, self._measured, known) for name, expression in expressions.items()}

    def verdict(self, names: Iterable[str]) -> Verdict:
        """OK if the fields are defined over the cycle, else the reason."""
        return self._verdict(nodes_of(tuple(self._curves(names).values())))

    def verdict_on(self, expressions: Iterable[Expression]) -> Verdict:
        """OK if the expressions are defined, as `verdict` for fields."""
        return self._verdict(node for node in nodes_of(tuple(expressions)) if node.stage > Stage.VARIANT)

    def _curves(self, names: Iterable[str]) -> dict[str, Node | Followed]:
        full = {name: full_names(self.mechanics.scene, name) for name in names}
        check_names(full.values(), self.register.fields, "field")
        for name in full.values():
            why = self.register.why_not(name)
            if why is not None:
                raise AskError(why)
        return {name: self.register.fields[known].curve() for name, known in full.items()}

    def _row(self, curve: Node | Followed) -> np.ndarray:
        of = self._variant
        match curve:
            case Angle(direction):
                return self._followed(direction.x.graph.apply(angle_or_zero, *direction))
            case Work(moment):
                return of.work(moment, self.q)
            case Speed(steady):
                return self._steady(steady).speed(self.q)
        return of.values([curve], self.q)[0]

    def _followed(self, angle: Node) -> np.ndarray:
        """An angle, unwrapped from the first position; positions are added where it turns sharply."""
        grid = np.unique(np.concatenate([self._spaced(_LOOKED_AT), self.q]))
        row = self._variant.values([angle], grid)[0]
        for _ in range(_HALVINGS):
            turned = np.diff(row)
            sharp = np.flatnonzero(np.abs(turned - math.tau * np.rint(turned / math.tau)) > _SHARP)
            if not sharp.size:
                break
            between = 0.5 * (grid[sharp] + grid[sharp + 1])
            grid = np.insert(grid, sharp + 1, between)
            row = np.insert(row, sharp + 1, self._variant.values([angle], between)[0])
        forwards = slice(None, None, 1 if self._variant.last > self._variant.first else -1)
        return np.unwrap(row[forwards])[forwards][np.searchsorted(grid, self.q)]

    def _measured(self, asked: Measurement) -> Measured:
        match asked:
            case VariantNumber(number):
                return Measured(self._variant.number(number))
            case Integral(curve):
                return Measured(self._variant.integral(curve))
            case StrokeEnd(coordinate, rate, which):
                return Measured(self._variant.number(self.mechanics.graph.found(coordinate, rate, which)))
            case Extreme(Node() as curve, sense):
                return _of_series(self._variant.extreme(curve, sense))
            case LeastMagnitude(curve):
                ends = [self._variant.extreme(curve, sense) for sense in ("least", "greatest")]
                return _of_series(max(ends[0], -ends[1], 0.0))
            case SteadyCycle(result=result) if result in _OF_STEADY:
                mean = abs(self._variant.number(asked.speed))
                return _of_series(_OF_STEADY[result](self._steady(asked), mean))
        raise TypeError(f"{asked!r} is measured by compiled code only")

    def _steady(self, asked: SteadyCycle) -> WheelCycle:
        """The steady cycle, cached for its other results."""
        asked = dataclasses.replace(asked, result="")
        if asked not in self._known_cycles:
            of = self._variant
            flywheel = WheelNumbers(*(n and of.number(n) for n in (asked.wheel, asked.fluctuation)))
            self._known_cycles[asked] = of.steady(asked.moment, asked.inertia, of.number(asked.speed), flywheel)
        return self._known_cycles[asked]

    def _seen(self, point: MovingPoint) -> MovingPoint:
        """A point in the scene's coordinates."""
        return point._replace(r=self.mechanics.kinematics.coordinates(point.r))

    def _values(self, shape: Any) -> Any:
        """The same shape, with values in place of nodes."""
        nodes = list(dict.fromkeys(_nodes(shape)))
        rows = self._variant.values(nodes, self.q)
        if self._given != Verdict.OK or not all(np.isfinite(row).any() for row in rows):
            raise NowhereDefinedError(self._verdict(nodes))
        return _with_values(shape, dict(zip(nodes, rows, strict=True)))

    def _verdict(self, nodes: Iterable[Node]) -> Verdict:
        """OK if the nodes are defined at all examined positions of the cycle, else the reason."""
        m, of, nodes = self.mechanics, self._variant, list(nodes)
        if self._given != Verdict.OK or not m.closes(self.numbers, m.returns_of(nodes)):
            return Verdict(self._given or Verdict.DOES_NOT_CLOSE)
        margins = [*margins_against_jamming(m, nodes), *margins_at_cams(m, nodes)]
        groups = taking_part(m, [*nodes, *(margin.curve for margin in margins)])
        for group, tables in m.kinematics.seed_tables.items():
            found = Verdict(int(tables(self.numbers).verdict[0]))
            if group in groups and found != Verdict.OK:
                return found
        q = self._spaced(_LOOKED_AT)
        vanishing = [m.kinematics.vanishing(group) for group in groups]
        rows = of.values([curve for curve, _ in vanishing], q)
        if np.isnan(rows).any():
            return Verdict.CANNOT_ASSEMBLE
        for row, (_, beyond) in zip(rows, vanishing, strict=True):
            scale = 1.0 if beyond is None else np.abs(row).max() + abs(of.number(beyond))
            if (np.sign(row[0]) * row < SINGULAR_SINE * scale).any():
                return Verdict.SINGULAR
        failing = {margin.verdict for margin in margins if not (of.values([margin.curve], q)[0] > 0.0).all()}
        if failing:
            return min(failing, key=ON_MARGINS.index)
        if any(abs(of.integral(rate)) > math.pi for rate in wound_springs(m, nodes)):
            return Verdict.DOES_NOT_CLOSE
        finite = all(np.isfinite(row).all() for row in of.values(nodes, q))
        return Verdict.OK if finite else Verdict.NOT_FINITE


def _of_series(value: float) -> Measured:
    return Measured(value, _SERIES * abs(value))


def _nodes(shape: Any) -> Iterator[Node]:
    """All nodes in a shape of records, lists and mappings."""
    if isinstance(shape, Node):
        yield shape
    elif isinstance(shape, (tuple, list, dict)):
        for part in shape.values() if isinstance(shape, dict) else shape:
            yield from _nodes(part)


def _with_values(shape: Any, values: Mapping[Node, np.ndarray]) -> Any:
    if isinstance(shape, Node):
        return values[shape]
    if isinstance(shape, dict):
        return {name: _with_values(part, values) for name, part in shape.items()}
    if not isinstance(shape, (tuple, list)):
        return shape
    parts = [_with_values(part, values) for part in shape]
    if isinstance(shape, Vector):
        return parts[0] + 1j * parts[1]
    make: Callable = type(shape)._make if hasattr(shape, "_make") else type(shape)
    return make(parts)
