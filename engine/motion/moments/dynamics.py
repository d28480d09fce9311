"""A machine's equation of motion, prepared: I(φ) and M(φ, ω) of many variants, with a choice of actions."""

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from engine.cycle.regula_falsi import regula_falsi
from engine.graph.functions import functions_at
from engine.graph.nodes import Given, Node, reached, value_of
from engine.laws.senses import sense
from engine.mechanism.acting import Grip, Load
from engine.mechanism.actions.brakes import braking_moment
from engine.mechanism.actions.motors import motor_ratio
from engine.mechanism.friction import relative_motion, rolling_rate
from engine.mechanism.loads import Loads
from engine.mechanism.mechanics import Mechanics
from engine.motion.moments.at_speed import Drive, Moments, moments_at
from engine.motion.moments.breaks import Breaks, instants_of
from engine.motion.moments.grid import Grid, make_grid
from engine.motion.moments.landmarks import Landmarks
from engine.motion.moments.tabulation import Ends, Sums, Tabulation
from engine.motion.one_speed import AT_REST, CHANNELS, POLYNOMIAL_ORDERS, MachineSystem, Sizes, along_angle, along_time
from engine.parts.actions import Brake
from engine.parts.motor_constants import motor_curve
from engine.scene.load_formulas import load_formulas
from engine.scene.pairs import contact_pairs, lossy_meshes, pairs
from engine.scene.scene import Numbers

if TYPE_CHECKING:
    from engine.motion.loads import PairLoads

# Crank angles at which the inertia of a machine without a constant part is sampled.
LOOKED_AT = 720
# Relative to its maximum, an inertia below this is rounding: the square of a speed that vanishes.
NO_INERTIA = 1e-18
# Friction in pairs as an action, which jumps where a pair reverses; no action can have this name.
IN_PAIRS = "friction in pairs"
# Derivative of the inertia as an action, which jumps with the acceleration of a cam's follower.
OF_INERTIA = "inertia of followers"


class Variants(NamedTuple):
    """A set of variants, prepared for motion.

    Attributes
    ----------
    numbers : Numbers
    direction : ndarray (variants,)
        +1 or −1: direction of the crank.
    flywheel : ndarray (variants,)
        Inertia added to the machine's [kg·m²].
    parameters : ndarray (numbers, variants)
        Numbers of the printed functions.
    ends : mapping of Found to ndarray (variants,)
    breaks : Breaks
        Breaks of all actions.
    drive : Drive or None
        The acting motors, from `Dynamics.driven`.
    instants : ndarray (instants, variants) or None
        Times of jumps or kinks of the acting torques over time [s], from `Dynamics.driven`.
    kept : dict
        Results of steady running and runs, reused by the second evaluation.
    rubbing : ndarray (2, numbers, variants) or None
        Numbers for friction in pairs, forwards and backwards, from `Dynamics.driven`.
    """

    numbers: Numbers
    direction: np.ndarray
    flywheel: np.ndarray
    parameters: np.ndarray
    ends: Ends
    breaks: Breaks
    drive: Drive | None = None
    instants: np.ndarray | None = None
    kept: dict | None = None
    rubbing: np.ndarray | None = None

    @property
    def count(self) -> int:
        """Number of variants."""
        return self.direction.size

    def some(self, chosen: np.ndarray) -> "Variants":
        """Variants with given indices, in any order, possibly repeated."""
        if np.array_equal(chosen, np.arange(self.count)):
            return self
        drive = self.drive
        return Variants(
            self.numbers.of_variants(chosen),
            self.direction[chosen],
            self.flywheel[chosen],
            np.ascontiguousarray(self.parameters[:, chosen]),
            {node: end[chosen] for node, end in self.ends.items()},
            self.breaks.some(chosen),
            None if drive is None else drive.some(chosen),
            None if self.instants is None else self.instants[:, chosen],
            {},
            None if self.rubbing is None else self.rubbing[..., chosen],
        )


class Acting(NamedTuple):
    """Key of a row of torques: an action of the scene, or its part with one order and role."""

    action: str
    order: float | str
    role: str | None

    @classmethod
    def of(cls, load: Load) -> "Acting":
        """The key of a load."""
        return cls(load.action, load.order, load.role)


class Reduction:
    """Rows of a machine in motion, independent of the acting actions: I, dI/dφ, and the torque of each action by order.

    Parameters
    ----------
    mechanics : Mechanics

    Attributes
    ----------
    mechanics : as given
    time, speed : Given
        Arguments of loads over time and of loads by formula.
    loads : Loads
    keys : list of Acting
        Key of each row of torques.
    nodes : list of Node
        I, dI/dφ and a torque for each key.
    tabulation : Tabulation
        Tabulation of the nodes.
    landmarks : Landmarks
    has_cycle : bool
        Whether the input rotates fully.
    """

    def __init__(self, mechanics: Mechanics) -> None:
        graph, reduced = mechanics.graph, mechanics.reduced
        self.mechanics, self.time, self.speed = mechanics, graph.given("time"), graph.given("speed")
        self.loads = Loads(mechanics.scene, mechanics.kinematics, self.time, self.speed)
        moments: dict[Acting, Node] = {}
        for key in dict.fromkeys(Acting.of(load) for load in self.loads.terms):
            own = [(t.coefficient, t.basis) for t in self.loads.terms if Acting.of(t) == key]
            moments[key] = graph.combination(own)
        self.keys = [key for key, moment in moments.items() if moment is not graph.zero]
        self.nodes = [reduced.inertia, reduced.slope, *(moments[key] for key in self.keys)]
        terms = [*self.loads.terms, *_reversals(mechanics), *_jerks(mechanics)]
        watched = [load.characteristic for load in terms]
        title = "A machine in motion."
        functions = functions_at(graph, title, mechanics.first, mechanics.last, self.nodes, watched)
        self.tabulation = Tabulation(functions)
        judged = [(key.action, row) for row, key in enumerate(self.keys, 2)]
        self.has_cycle = mechanics.has_cycle
        turns = mechanics.scene.input.revolutions if self.has_cycle else 1
        self.landmarks = Landmarks(self.tabulation, terms, judged, turns)

    @property
    def cycle(self) -> float:
        """Period of everything except time [rad]; infinite if the input does not rotate fully."""
        return 2.0 * np.pi * self.mechanics.scene.input.revolutions if self.has_cycle else np.inf

    def range_of(self, numbers: Numbers, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Minimum and maximum position of the input, (variants,) each [rad; m if it slides]; 0 … 2π for a crank."""
        ends = [np.broadcast_to(end.compute(numbers), (count,)) for end in (self.mechanics.first, self.mechanics.last)]
        return np.minimum(*ends).astype(float), np.maximum(*ends).astype(float)

    def depends_on_time(self, key: "Acting") -> bool:
        """Whether the torque of a key depends on time."""
        own = [t.basis for t in self.loads.terms if Acting.of(t) == key]
        return self.time in reached(own)

    def variants(self, numbers: Numbers, direction: np.ndarray, flywheel: np.ndarray) -> "Variants":
        """Prepare a set of variants.

        Parameters
        ----------
        numbers : Numbers
        direction : ndarray (variants,)
            +1 or −1: direction of the crank.
        flywheel : ndarray (variants,)
            Inertia added to the machine's [kg·m²].
        """
        ends, breaks = self.landmarks(numbers, direction)
        parameters = self.tabulation.parameters(numbers, direction, ends)
        return Variants(numbers, direction, flywheel, parameters, ends, breaks, None, None, {})

    def without_inertia(self, variants: "Variants") -> np.ndarray:
        """Which variants have zero reduced inertia at some crank angle, (variants,) of bool."""
        constant = self.mechanics.reduced.first_kind.compute(variants.numbers) + variants.flywheel
        found = np.zeros(variants.count, bool)
        bare = np.flatnonzero(np.broadcast_to(constant, (variants.count,)) <= 0.0)
        if bare.size:
            found[bare] = self._vanishes(variants.some(bare))
        return found

    def _vanishes(self, variants: "Variants") -> np.ndarray:
        """Whether the minimum inertia over the cycle is zero within rounding."""
        target = np.full(len(self.keys) + 2, -1)
        target[:2] = 0, 1
        sums = Sums(target, 2, np.zeros(target.size, bool), variants.direction)
        low, high = self.range_of(variants.numbers, variants.count)
        step = (high - low) / LOOKED_AT
        places = low + step * np.arange(LOOKED_AT + (not self.has_cycle))[:, None]
        inertia, _ = self.curves(variants, places, {}, sums)
        around = low + step * inertia.argmin(axis=0)
        before, after = around - step, around + step
        if not self.has_cycle:
            before, after = np.maximum(before, low), np.minimum(after, high)
        bottom = regula_falsi(lambda q: self.curves(variants, q[None], {}, sums)[1, 0], before, after)
        least = np.fmin(self.curves(variants, bottom[None], {}, sums)[0, 0], inertia.min(axis=0))
        # A removed inertia counts as a negative flywheel.
        return least + variants.flywheel <= NO_INERTIA * inertia.max(axis=0)

    def curves(
        self, variants: "Variants", places: np.ndarray, given: Mapping[Given, np.ndarray], sums: Sums
    ) -> np.ndarray:
        """Sums of the rows at crank angles, and at times and speeds if given, (sums, places, variants)."""
        # Default: no loads over time; loads that depend on the speed are NaN.
        unknown = {self.time: np.zeros_like(places), self.speed: np.full_like(places, np.nan)}
        given = {node: given.get(node, unknown[node]) for node in self.tabulation.given}
        return self.tabulation(variants.parameters, places, given, sums)


def _reversals(mechanics: Mechanics) -> list[Load]:
    """Jumps due to friction: the direction of motion of each pair with friction, as a unit load."""
    graph, found = mechanics.graph, []
    rubbing = {friction.pair for friction in mechanics.scene.friction.values()}
    for pair in [*pairs(mechanics.scene), *contact_pairs(mechanics.scene)]:
        if pair.name in rubbing:
            rate, slope = relative_motion(mechanics.kinematics, pair)
            graph.switches(rate, slope)
            way = graph.held(graph.apply(sense, rate))
            grip = Grip(pair.link, None, None)
            found.append(Load(IN_PAIRS, graph.one, way, grip, graph.one, way, "harmful", 0))
    for name in lossy_meshes(mechanics.scene):
        rate, slope = rolling_rate(mechanics.kinematics, name)
        graph.switches(rate, slope)
        way = graph.held(graph.apply(sense, rate))
        found.append(Load(IN_PAIRS, graph.one, way, Grip(name, None, None), graph.one, way, "harmful", 0))
    return found


def _jerks(mechanics: Mechanics) -> list[Load]:
    """Jumps of the inertia's derivative where cam sections meet, as a load; independent of the acting actions."""
    if not mechanics.scene.cams:
        return []
    one, slope, grip = mechanics.graph.one, mechanics.reduced.slope, Grip(mechanics.scene.input.link, None, None)
    return [Load(OF_INERTIA, one, slope, grip, one, slope, None, 0)]


class Dynamics:
    """The equation of motion of a machine with a choice of acting actions.

    Parameters
    ----------
    reduction : Reduction
    off : frozenset of str
        Actions, including motors, that do not act.
    works : bool
        Whether the works of useful and harmful loads, … are separate.
    friction : PairLoads, optional
        The torque equivalent to friction in the pairs, if there is any.
    gathered : frozenset of str
        Other integrals of runs, of "motors", "squares" and "fading".
    """

    def __init__(
        self,
        reduction: Reduction,
        off: frozenset[str] = frozenset(),
        works: bool = False,
        friction: "PairLoads | None" = None,
        gathered: frozenset[str] = frozenset(),
    ) -> None:
        scene, loads = reduction.mechanics.scene, reduction.loads
        self.works, self.reduction, self.friction, self.off = works, reduction, friction, off
        self.channels = CHANNELS if works else ("all",)
        self._gathered = gathered | frozenset(CHANNELS if works else ())
        self.motors = tuple(name for name in loads.motors if name not in off)
        # For each acting row: its index in the reduction, its channel and its order.
        acting = [(i, key) for i, key in enumerate(reduction.keys) if key.action not in off]
        self.active = frozenset(load.action for load in loads.terms if load.action not in off)
        self.active |= {IN_PAIRS} if friction is not None else set()
        self.active |= {OF_INERTIA} if scene.cams else set()
        self.timed = any(reduction.depends_on_time(key) for _, key in acting)
        # Whether a torque may change at any time.
        formulas = load_formulas(scene)
        self.changing = any(formulas[name].depends_on_time for name in self.active if name in formulas)
        self.brakes = tuple(name for name in self.active if isinstance(scene.moments.get(name), Brake))
        self.polynomial, self.laws = [], []
        for i, key in acting:
            place = (i, self._channel(key.role), key.order)
            (self.polynomial if key.order in POLYNOMIAL_ORDERS else self.laws).append(place)
        # Whether all torques vanish with the speed: then nothing stops the machine nor starts it.
        self.fades = not self.motors and not self.laws and all(order > 0 for _, _, order in self.polynomial)
        self.fades &= friction is None
        # Sums of rows: I, dI/dφ, then orders 0, 1 and 2 of each channel, then power laws.
        self.target = np.full(len(reduction.keys) + 2, -1)
        self.target[:2] = 0, 1
        for i, channel, order in self.polynomial:
            self.target[i + 2] = 2 + 3 * channel + order
        for k, (i, _, _) in enumerate(self.laws):
            self.target[i + 2] = 2 + 3 * len(self.channels) + k
        self._turned = np.arange(self.target.size) > 0
        self.channel_of_laws = np.array([channel for _, channel, _ in self.laws], np.int64)
        self.cycle = reduction.cycle

    def _channel(self, role: str | None) -> int:
        if not self.works:
            return 0
        return CHANNELS.index(role if role in CHANNELS else "other")

    def driven(self, variants: Variants) -> Variants:
        """The variants with the acting motors, breaks and instants."""
        drive = self._drive(variants.numbers, variants.count)
        instants = instants_of(self.reduction.mechanics.scene, self.active, variants.numbers, variants.count)
        breaks, rubbing = variants.breaks.of(self.active), None
        if self.friction is not None:
            ways = [variants._replace(direction=way * variants.direction) for way in (1.0, -1.0)]
            rubbing = np.stack([self.friction.parameters(each, self.off) for each in ways])
        return variants._replace(breaks=breaks, drive=drive, instants=instants, kept={}, rubbing=rubbing)

    @cached_property
    def by_angle(self) -> MachineSystem:
        """The equation of motion over the crank angle, with its functions printed."""
        mechanics = self.reduction.mechanics
        return MachineSystem(*along_angle(mechanics, self.works, self._gathered), mechanics)

    @cached_property
    def by_time(self) -> MachineSystem:
        """The equation of motion over time, with its functions printed."""
        mechanics, rubs = self.reduction.mechanics, self.friction is not None
        return MachineSystem(*along_time(mechanics, self.works, self._gathered, rubs), mechanics)

    def moving(self, system: MachineSystem, variants: Variants, brisk: float, facing: float = 1.0) -> np.ndarray:
        """Numbers of a motion for one of the systems, (numbers, variants), without the final speeds.

        Parameters
        ----------
        system : MachineSystem
        variants : Variants
        brisk : float
            Relative energy loss per radian at which a machine counts as near rest.
        facing : float
            +1 or −1: forwards or backwards.
        """
        key = system.system.along, brisk, facing
        if key not in variants.kept:
            numbers, way = variants.numbers, facing * variants.direction
            sizes = system.sizes
            given = self.sized(sizes, numbers, way) | {
                sizes.wheel: variants.flywheel,
                sizes.way: way,
                sizes.facing: facing,
            }
            # Only forward motion can return to the form over the angle, if that form applies.
            by_angle = facing > 0.0 and not self.in_time
            given |= {sizes.brisk: brisk, sizes.stay: 0.0 if by_angle else np.inf}
            variants.kept[key] = system.tabulation.parameters(numbers, way, variants.ends, given)
        return variants.kept[key]

    def sized(self, sizes: Sizes, numbers: Numbers, way: np.ndarray) -> dict[Given, np.ndarray | float]:
        """Sizes of the acting loads for motion in the direction `way` of the crank angle, and the acting motors."""
        unit = numbers.with_values({"input.speed": way})
        given = {s: value_of(c, unit) if a not in self.off else 0.0 for s, (a, c) in sizes.loads.items()}
        return given | {size: float(name in self.motors) for size, name in sizes.motors.items()}

    @property
    def in_time(self) -> bool:
        """Whether only the time form applies: friction in pairs, torques over time, an input of limited range."""
        return self.timed or self.friction is not None or not self.reduction.has_cycle

    def locked(self, variants: Variants) -> np.ndarray:
        """Which variants have an acting brake that is self-locking, (variants,) of bool."""
        scene, found = self.reduction.mechanics.scene, np.zeros(variants.count, bool)
        for name in self.brakes:
            found |= np.isinf(braking_moment(scene.moments[name], f"moments.{name}", variants.numbers))
        return found

    def _drive(self, numbers: Numbers, count: int) -> Drive:
        scene, line, bends, kloss, idle = self.reduction.mechanics.scene, np.zeros((2, count)), [], [], []

        def of_all(*values: float | np.ndarray) -> list[np.ndarray]:
            return [np.broadcast_to(value, count) for value in values]

        for name in self.motors:
            motor = scene.moments[name]
            curve, ratio = motor_curve(motor, f"moments.{name}", numbers), np.abs(motor_ratio(scene, motor, numbers))
            line[0] += ratio * curve.level
            line[1] += ratio * ratio * curve.slope
            for bend, at in curve.bends:
                bends += of_all(ratio * ratio * bend, at / ratio)
            kloss += [] if curve.kloss is None else of_all(*curve.kloss, ratio)
            idle += of_all(curve.no_load_speed / ratio)
        exponents = [np.broadcast_to(numbers[n] if isinstance(n, str) else n, count) for _, _, n in self.laws]
        laws, speeds = (np.array(rows).reshape(len(rows), count) for rows in (exponents, idle))
        return Drive(np.array([*line, *bends, *kloss]), laws, speeds, len(bends) // 2)

    def grid(self, variants: Variants, start: np.ndarray, length: float | np.ndarray, steps: int) -> Grid:
        """Grid from a start angle, with a node at every break."""
        return make_grid(start, length, variants.direction, steps, self.cycle, variants.breaks)

    def rows(
        self,
        variants: Variants,
        places: np.ndarray,
        clock: np.ndarray | None = None,
        omega: np.ndarray | None = None,
    ) -> "Rows":
        """Terms that depend on the crank angle, at given angles; torques may also depend on time and speed.

        Parameters
        ----------
        variants : Variants
        places : ndarray (places, variants)
            Crank angles [rad].
        clock, omega : ndarray (places, variants), optional
            Time [s], and speed [rad/s].
        """
        given = {} if clock is None else {self.reduction.time: clock}
        given |= {} if omega is None else {self.reduction.speed: np.abs(omega) + AT_REST}
        channels = len(self.channels)
        sums = Sums(self.target, 2 + 3 * channels + len(self.laws), self._turned, variants.direction)
        out = self.reduction.curves(variants, places, given, sums)
        loads, powers = out[2 : 2 + 3 * channels].reshape(channels, 3, *places.shape), out[2 + 3 * channels :]
        return Rows(out[0] + variants.flywheel, out[1], loads, powers)

    def moments(self, variants: Variants, rows: "Rows", omega: np.ndarray) -> Moments:
        """Torques at given speeds, in the direction of motion.

        Parameters
        ----------
        variants : Variants
        rows : Rows
        omega : ndarray (places, variants)
            Speed, positive in the direction of motion [rad/s].
        """
        return moments_at(variants.drive, self.channel_of_laws, rows.loads, rows.powers, omega)


class Rows(NamedTuple):
    """Terms that depend on the crank angle, (places, variants).

    Attributes
    ----------
    inertia, inertia_phi : ndarray (places, variants)
        Reduced inertia with the flywheel [kg·m²], and its derivative in the direction of motion.
    loads : ndarray (channels, 3, places, variants)
        Coefficients of ω⁰, ω¹ and ω² in the reduced torque, for each kind of work; otherwise one channel for all.
    powers : ndarray (laws, places, variants)
        Coefficients of the power laws in the reduced torque.
    """

    inertia: np.ndarray
    inertia_phi: np.ndarray
    loads: np.ndarray
    powers: np.ndarray
