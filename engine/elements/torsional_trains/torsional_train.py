"""Torsional trains: natural frequencies and modes, distance from resonances, forced vibration."""

import math
from collections import defaultdict
from collections.abc import Sequence
from functools import cached_property
from types import MappingProxyType
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.cycle.measured import Measured, maximum, measured, where
from engine.elements.compliances.elastic_parts import ElasticPart
from engine.elements.element import Answers, Element, NamedRows, Numbers
from engine.elements.engines.engine import OF_SHAKING, EngineElement
from engine.elements.panels import SPEED, Curve, Mark, Panel, PanelAxis
from engine.elements.torsional_trains.excitation import TrainExcitation, excitation_orders, train_excitation
from engine.elements.torsional_trains.forced_vibration import ForcedVibration, forced_vibration, under_mean_moments
from engine.elements.torsional_trains.natural_frequencies import NaturalVibration, natural_vibration
from engine.elements.torsional_trains.order_sums import extremes_of_orders
from engine.elements.torsional_trains.reduced_train import ReducedTrain, reduced_train
from engine.elements.torsional_trains.train_layout import FRAME_END, Joint, TrainLayout, train_layout
from engine.laws.rounding import EPS
from engine.parts.actions import TorsionalDamping, TorsionalStiffness
from engine.parts.skeleton import Angle, AngularSpeed, Faults, Inertia, Moment, Name, NonZero, Number, Part
from engine.words.quantity import Quantity, check_result, main_result
from engine.words.verdicts import Verdict

MOST_MASSES = 1000
# Complex array elements in memory at a time.
_BLOCK = 2**17
# Most modes and orders in one diagram; highest speed drawn, relative to the train's speed.
_MOST_MODES, _MOST_ORDERS, _FASTEST = 6, 16, 1.5
# An order gets a dot if its work on a mode is above this fraction of the maximum.
_FELT = 0.05
_HERTZ = 1.0 / math.tau


_TURNS = NonZero("with the ratio 0 the second end never turns: give its speed over that of the first")


class TrainMass(Part):
    """A rigid disc, wheel, rotor or throw; `damping` relative to the frame."""

    inertia: Annotated[Inertia, Field(gt=0)] | None = None
    damping: Annotated[TorsionalDamping, Field(ge=0)] = 0.0


class TrainShaft(Part):
    """A shaft between two masses, or a mass and the `frame`; its stiffness is given, or that of its parts in series.

    Stiffness and damping are about the axis of the first end. `ratio` is the speed of the second end over that of the
    first, if the parts include elastic teeth or belts. `energy_absorption` is the fraction of the maximum energy
    dissipated in a cycle.
    """

    one_of: ClassVar = (("stiffness", "parts"),)

    between: tuple[Name, Name]
    stiffness: Annotated[TorsionalStiffness, Field(gt=0)] | None = None
    parts: Annotated[dict[Name, ElasticPart], Field(min_length=1)] | None = None
    damping: Annotated[TorsionalDamping, Field(ge=0)] | None = None
    energy_absorption: Annotated[Number, Field(ge=0)] | None = None
    ratio: Annotated[Number, _TURNS] = 1.0

    def _faults(self) -> Faults:
        if self.parts is not None and (self.damping is not None or self.energy_absorption is not None):
            yield "the parts have their own dampers: give damping or energy_absorption to them"


class TrainGear(Part):
    """Rigid gears; `ratio` is the speed of the second mass over that of the first, negative for external gears."""

    between: tuple[Name, Name]
    ratio: Annotated[Number, _TURNS]


class HarmonicMoment(Part):
    """A torque on a mass, amplitude · cos(order · Ω t + phase), with Ω the `speed`; order 0 is a mean torque."""

    on: Name
    order: Annotated[float, Field(ge=0, le=1000)]
    amplitude: Moment
    phase: Angle = 0.0


class TorsionalTrain(Element):
    """Masses connected by shafts and gears, in a chain or branched.

    The first `modes` positive natural frequencies and their modes are computed, and the vibration under `excitations`,
    whose orders are multiples of the `speed`. An `engine` excites the masses `cylinders_at`, one for each cylinder in
    the order of their numbers, with gas and inertia torque; its speed is then the train's. `machine_at` is the mass on
    which the scene's own machine acts with the harmonics of M − ½ ω² dI/dφ at constant crank speed, which is then the
    train's. Without its own inertia, that mass has the mean of the machine's reduced moment of inertia over the crank
    angle, plus its flywheel. A load at the mass `load` balances the mean torques; without it they accelerate the whole
    train.
    """

    picture: ClassVar = "vibration"
    infinite: ClassVar = Verdict.RESONANCE

    type: Literal["torsional_train"]
    masses: Annotated[dict[Name, TrainMass], Field(min_length=1, max_length=MOST_MASSES)]
    shafts: dict[Name, TrainShaft] = {}
    gears: dict[Name, TrainGear] = {}
    modes: Annotated[int, Field(ge=1, le=50)] = 3
    speed: Annotated[AngularSpeed, Field(gt=0)] | None = None
    excitations: dict[Name, HarmonicMoment] = {}
    engine: EngineElement | None = None
    cylinders_at: tuple[Name, ...] = ()
    machine_at: Name | None = None
    load: Name | None = None

    def _faults(self) -> Faults:
        if FRAME_END in self.masses:
            yield f"masses.{FRAME_END}: this name is reserved for the frame; choose another"
        names = [*self.masses, *self.shafts, *self.gears]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            yield f"{twice[0]} names two things; masses, shafts and gears need distinct names"
        if not self.layout.shaft_to[1:] and not self.layout.grounded:
            yield "shafts is missing: masses without a shaft between them don't vibrate; add one"
        yield from self._faults_of_excitations()
        for name, mass in self.masses.items():
            if mass.inertia is None and name != self.machine_at:
                yield f"masses.{name}.inertia is missing; only the mass that is machine_at takes the machine's own"

    def _faults_of_excitations(self) -> Faults:
        asked = [("load", self.load), ("machine_at", self.machine_at)]
        asked += [(f"excitations.{name}.on", excitation.on) for name, excitation in self.excitations.items()]
        for key, mass in (*asked, *(("cylinders_at", mass) for mass in dict.fromkeys(self.cylinders_at))):
            if mass is not None and mass not in self.masses:
                yield f"{key}: there is no mass {mass!r}; masses are {', '.join(self.masses)}"
        given = [key for key in ("speed", "engine", "machine_at") if getattr(self, key) is not None]
        if len(given) > 1:
            yield f"{' and '.join(given)}: each of them gives the train's speed; leave all but one out"
        if not self.is_excited and self._of_vibration:
            yield (
                f"{self._of_vibration[0]} changes nothing without an excitation: natural frequencies are those without "
                "damping; leave it out, or give excitations, engine or machine_at"
            )
        if self.excitations and not given:
            yield "speed is missing: excitations have multiples of it; give it"
        if self.engine is not None:
            yield from self._faults_of_engine(self.engine)
        elif self.cylinders_at:
            yield "cylinders_at are those of an engine; give engine, or leave them out"

    @property
    def _of_vibration(self) -> list[str]:
        """Given keys that affect the forced vibration only."""
        found = [key for key in ("speed", "load") if getattr(self, key) is not None]
        pending = [(f"masses.{name}", mass) for name, mass in self.masses.items()]
        pending += [(f"shafts.{name}", shaft) for name, shaft in self.shafts.items()]
        for at, part in pending:
            found += [f"{at}.{key}" for key in ("damping", "energy_absorption") if getattr(part, key, None)]
            pending += [(f"{at}.parts.{name}", own) for name, own in (getattr(part, "parts", None) or {}).items()]
        return found

    def _faults_of_engine(self, engine: EngineElement) -> Faults:
        if engine.gas is None:
            yield "engine.gas is missing: without it the engine has no torque; add it"
        lost = engine.gives(*OF_SHAKING)
        if lost:
            yield f"engine.{lost[0]} affects the shaking forces of the engine, not its torque; leave it out"
        if len(self.cylinders_at) != engine.cylinders:
            yield f"cylinders_at: give a mass for each of the {engine.cylinders} cylinders, in their order"

    @cached_property
    def layout(self) -> TrainLayout:
        """How masses, shafts and gears are connected.

        Raises
        ------
        LayoutProblem
            They do not form a tree.
        """
        joints = [Joint(name, *shaft.between, False) for name, shaft in self.shafts.items()]
        joints += [Joint(name, *gear.between, True) for name, gear in self.gears.items()]
        return train_layout(tuple(self.masses), joints)

    @property
    def is_excited(self) -> bool:
        """Whether anything excites the train."""
        return bool(self.excitations) or self.engine is not None or self.machine_at is not None

    @property
    def reported_modes(self) -> int:
        """Number of positive natural frequencies computed: those requested, or as many as exist."""
        return min(self.modes, len(self.layout.parents) - (1 if self.layout.is_free else 0))

    @property
    def variants_at_once(self) -> int:
        """Few if the train is long."""
        nodes = len(self.layout.parents)
        return max(1, min(4096, _BLOCK // (nodes * max(nodes, len(excitation_orders(self))))))

    def named(self, n: Numbers) -> NamedRows:
        """Modes, and vibration if anything excites the train; infinite at a resonance without damping."""
        reduced = reduced_train(self, n)
        return self._named(n, reduced, natural_vibration(reduced, self.reported_modes))

    def _named(self, n: Numbers, reduced: ReducedTrain, natural: NaturalVibration) -> NamedRows:
        frequencies = list(map(Measured, natural.frequencies, natural.frequency_errors))
        words = "number of zero natural frequencies (the whole train turns freely)"
        free = Measured(1.0 if self.layout.is_free else 0.0)
        yield check_result("rigid_body_modes", words, "1", exact=True), free
        for k, frequency in enumerate(frequencies, 1):
            yield main_result(f"frequency_{k}", f"natural frequency {k} above zero", "rad s-1"), frequency
        for k in range(self.reported_modes):
            yield from _shape(self, reduced, natural, k)
        if self.is_excited:
            excitation = train_excitation(self, reduced, n)
            yield from _margins(frequencies, excitation) if excitation.orders else ()
            yield from _vibration(self, reduced, excitation)

    @cached_property
    def results(self) -> tuple[Quantity, ...]:
        """Results available with the keys given, named for any numbers of the machine and any frequencies."""
        n = defaultdict(lambda: np.ones(1), self.own_numbers())
        reduced, count = reduced_train(self, n), self.reported_modes
        rows, modes = np.ones((count, 1)), np.ones((count, len(self.layout.parents), 1))
        with np.errstate(all="ignore"):
            return tuple(result for result, _ in self._named(n, reduced, NaturalVibration(rows, rows, modes, modes)))

    def evaluate(self, n: Numbers) -> Answers:
        """Results with error estimates."""
        return Answers.of(self.values(n))

    def panels(self, machine: Numbers = MappingProxyType({})) -> tuple[Panel, ...]:
        """Modes along the train, and the Campbell diagram.

        Parameters
        ----------
        machine : mapping of str to ndarray (1,)
            Excitation by the machine of its scene, by the keys that `values` uses.
        """
        n = self.own_numbers() | dict(machine)
        reduced = reduced_train(self, n)
        natural = natural_vibration(reduced, self.reported_modes)
        modes = _modes(self, reduced, natural)
        if not self.is_excited:
            return (modes,)
        excitation = train_excitation(self, reduced, n)
        return (modes, _campbell(excitation, natural)) if excitation.orders else (modes,)

    def machine_needed(self) -> tuple[str, str]:
        """A rotating crank, if the machine excites the train."""
        if self.machine_at is None:
            return "", ""
        return ".machine_at", "only a crank that turns fully excites a train"


def _shape(train: TorsionalTrain, reduced: ReducedTrain, natural: NaturalVibration, k: int) -> NamedRows:
    """A mode as rotations of the masses about their own axes, relative to the maximum."""
    layout = train.layout
    own, nodes = np.stack([reduced.ratios[mass] for mass in layout.masses]), list(layout.node_of.values())
    mode = natural.modes[k, nodes], natural.mode_errors[k, nodes]
    amplitudes = Measured(own) * Measured(*mode)
    greatest = np.abs(amplitudes.value).argmax(axis=0), np.arange(own.shape[1])
    shape = amplitudes / amplitudes[greatest]
    for i, mass in enumerate(layout.masses):
        words = f"amplitude of {mass} in mode {k + 1}, over the maximum of all"
        yield Quantity(f"mode_{k + 1}.{mass}", words, "1", True), shape[i]


def _margins(frequencies: Sequence[Measured], excitation: TrainExcitation) -> NamedRows:
    """Relative distance of the nearest order from each natural frequency."""
    orders, speed = np.array(excitation.orders), excitation.speed
    excited = Measured(orders[:, None] * speed, EPS * orders[:, None] * speed)
    for k, frequency in enumerate(frequencies, 1):
        away = abs(excited / frequency - 1.0)
        nearest = away.value.argmin(axis=0)
        words = f"relative distance of the nearest order from natural frequency {k}"
        yield main_result(f"margin_{k}", words, "1"), away[nearest, np.arange(speed.size)]
        words = f"order nearest to natural frequency {k}"
        yield main_result(f"nearest_order_{k}", words, "1", exact=True), Measured(orders[nearest])


def _vibration(train: TorsionalTrain, reduced: ReducedTrain, excitation: TrainExcitation) -> NamedRows:
    """Torques of the shafts, amplitudes of the masses, and dissipated power."""
    layout, orders = train.layout, excitation.orders
    frequencies = np.array(orders).reshape(-1, 1) * excitation.speed
    swings = forced_vibration(reduced, frequencies, excitation.moments)
    mean = under_mean_moments(reduced, excitation.means)
    still = np.zeros((1, excitation.speed.size))
    # Infinite values stay infinite when scaled.
    with np.errstate(invalid="ignore"):
        for name in train.shafts:
            ratio = reduced.shaft_ratios[name]
            constant = _shaft_moment(train, reduced, name, mean, still)[0].real / ratio
            least, greatest = _range(orders, _shaft_moment(train, reduced, name, swings, frequencies) / ratio)
            yield Quantity(f"{name}.mean_moment", f"mean torque of {name}, at its first end", "N m"), constant
            words = f"alternating torque of {name}: half its range"
            yield main_result(f"{name}.alternating_moment", words, "N m"), 0.5 * (greatest - least)
            peak = maximum(abs(constant + greatest), abs(constant + least))
            yield main_result(f"{name}.greatest_moment", f"peak torque of {name}", "N m"), peak
        for mass, node in layout.node_of.items():
            least, greatest = _range(orders, reduced.ratios[mass] * swings.angles[node])
            words = f"half the range of the vibration of {mass}"
            yield main_result(f"{mass}.amplitude", words, "rad"), 0.5 * (greatest - least)
        yield Quantity("dissipated_power", "mean power that all dampers dissipate", "W"), swings.dissipated


def _shaft_moment(
    train: TorsionalTrain, reduced: ReducedTrain, name: str, swings: ForcedVibration, frequencies: np.ndarray
) -> Measured:
    """Reduced torque k (θ_first − θ_second) of a shaft (orders, variants)."""
    layout, first = train.layout, train.shafts[name].between[0]
    if name in layout.shaft_to:
        node = layout.shaft_to.index(name)
        forwards = layout.node_of[first] == layout.parents[node]
        return swings.moments[node] if forwards else -swings.moments[node]
    mass = layout.grounded[name]
    stiffness, damping, loss = reduced.ground_shafts[name]
    held = reduced.known(stiffness + 1j * (loss / math.tau + frequencies * damping))
    moment = held * swings.angles[layout.node_of[mass]]
    return moment if first == mass else -moment


def _range(orders: tuple[float, ...], amplitudes: Measured) -> tuple[Measured, Measured]:
    """Minimum and maximum of a sum of orders over time; infinite at a resonance."""
    if not orders:
        nothing = measured(np.zeros(amplitudes.shape[1:]))
        return nothing, nothing
    infinite = ~np.isfinite(amplitudes.error).all(axis=0)
    sound = np.where(infinite, 0.0, amplitudes.value)
    rounded = EPS * (8.0 + 24.0 * max(orders)) * np.abs(sound)
    error = (np.where(infinite, 0.0, amplitudes.error) + rounded).sum(axis=0)
    *ends, more = extremes_of_orders(orders, sound)
    least, greatest = (Measured(end, error + more) for end in ends)
    return where(infinite, measured(-math.inf), least), where(infinite, measured(math.inf), greatest)


def _modes(train: TorsionalTrain, reduced: ReducedTrain, natural: NaturalVibration) -> Panel:
    """Modes, linear along each shaft; shaft length is drawn in proportion to compliance, plus a visible minimum."""
    layout, parents = train.layout, reduced.parents
    compliance = 1.0 / reduced.stiffnesses[1:, 0]
    places = np.zeros(len(parents))
    for node in range(1, len(parents)):
        places[node] = places[parents[node]] + 0.25 + 0.75 * compliance[node - 1] / compliance.max()
    names = ["\n".join(m for m, at in layout.node_of.items() if at == k) for k in range(len(places))]
    # Both ends of each shaft, and a gap after it.
    ends = np.array([(parents[node], node, node) for node in range(1, len(places))] or [(0, 0, 0)]).ravel()
    gap = np.arange(ends.size) % 3 == 2
    curves, marks = [], [Mark("", None, 0.0)]
    for k in range(min(len(natural.frequencies), _MOST_MODES)):
        mode, words = natural.modes[k, :, 0], f"{k + 1}: {natural.frequencies[k, 0] * _HERTZ:.4g} Hz"
        if np.isnan(mode).any():
            words += ", mode not determined"
        shape = mode / mode[np.abs(mode).argmax()]
        curves.append(Curve(words, np.where(gap, np.nan, shape[ends]), places=places[ends]))
    free = "it turns freely" if layout.is_free else "held to the frame"
    axes, title = (PanelAxis("", "1"), PanelAxis("relative amplitude", "1", "θ")), f"Modes along the train ({free})"
    return Panel(*axes, places, curves, marks, title, names=names)


def _campbell(excitation: TrainExcitation, natural: NaturalVibration) -> Panel:
    """Natural frequencies as horizontal lines, orders as rays, dots where an order excites a mode at resonance."""
    speed, orders = float(excitation.speed[0]), np.array(excitation.orders)
    fastest, levels = _FASTEST * speed, natural.frequencies[:_MOST_MODES, 0]
    top = 1.15 * max(levels[levels <= orders.max() * fastest], default=levels[0])
    # Work of each order on each mode, |Σ q M_h|, relative to the maximum over the orders.
    work = np.abs(np.nan_to_num(natural.modes[: len(levels), :, 0], nan=1.0) @ excitation.moments.value[:, :, 0])
    most = work.max(axis=1, keepdims=True)
    felt = work >= _FELT * np.where(most > 0.0, most, 1.0)
    seen = levels < top
    both = np.array([0.0, fastest])
    curves = [Curve(f"mode {k + 1}", np.full(2, level * _HERTZ)) for k, level in enumerate(levels[seen])]
    strongest = np.argsort(-(work / np.where(most > 0.0, most, 1.0))[seen].max(axis=0), kind="stable")[:_MOST_ORDERS]
    for order in np.sort(orders[strongest]):
        ends = np.array([0.0, min(fastest, top / order)])
        curves.append(Curve(f"{order:g}", order * ends * _HERTZ, True, ends))
    marks = [Mark("as given", speed, None)]
    for k, i in zip(*np.nonzero(felt & seen[:, None]), strict=True):
        if i in strongest and levels[k] < orders[i] * fastest:
            marks.append(Mark("", levels[k] / orders[i], levels[k] * _HERTZ))
    axes = SPEED, PanelAxis("frequency", "Hz", "f")
    title, limits = "Campbell diagram (rays: orders; dots: excited)", (0.0, 1.05 * top * _HERTZ)
    return Panel(*axes, both, curves, marks, title, limits)
