"""A machine's equation of motion, prepared: I(φ) and M(φ, ω) of many variants, with a choice of actions."""

import math
from functools import cached_property, reduce
from typing import NamedTuple

import numpy as np

from engine.compiling.running import mean_of_rows
from engine.cycle.regula_falsi import regula_falsi
from engine.graph.functions import functions_at
from engine.graph.nodes import Given, reached, value_of
from engine.laws.senses import sense
from engine.mechanism.actions.brakes import braking_moment, rounding_of_braking
from engine.mechanism.actions.motors import motor_ratio
from engine.mechanism.friction import relative_motion, rolling_rate
from engine.mechanism.link_loads import Grip, Load
from engine.mechanism.mechanics import Mechanics
from engine.motion.moments.breaks import Breaks, instants_of
from engine.motion.moments.landmarks import Landmarks
from engine.motion.moments.own_drives import loads_of
from engine.motion.moments.tabulation import Ends, Tabulation
from engine.motion.one_speed import CHANNELS, POLYNOMIAL_ORDERS, MachineSystem, Sizes, along_angle, along_time
from engine.parts.actions import Brake
from engine.parts.motors import MotorCurve
from engine.scene.load_formulas import load_formulas
from engine.scene.pairs import contact_pairs, lossy_meshes, own_drives, pairs
from engine.scene.scene import Numbers, Scene
from engine.stepping.records import variant_columns

# Crank angles at which the inertia of a machine without a constant part is sampled.
LOOKED_AT = 720
# Relative to its maximum, an inertia below this is rounding: the square of a speed that vanishes.
NO_INERTIA = 1e-18
# Samples between two speeds for the peak torque of several motors together.
SPEEDS_BETWEEN = 33
# Friction in pairs as an action, which jumps where a pair reverses; no action can have this name.
IN_PAIRS = "friction in pairs"
# Derivative of the inertia as an action, which jumps with the acceleration of a link that moves by sections or a table.
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
    instants : ndarray (instants, variants) or None
        Times of jumps or kinks of the acting torques over time [s], from `Dynamics.driven`.
    kept : dict
        Results of steady running and runs, reused by the second evaluation.
    """

    numbers: Numbers
    direction: np.ndarray
    flywheel: np.ndarray
    parameters: np.ndarray
    ends: Ends
    breaks: Breaks
    instants: np.ndarray | None = None
    kept: dict | None = None

    @property
    def count(self) -> int:
        """Number of variants."""
        return self.direction.size

    def some(self, chosen: np.ndarray) -> "Variants":
        """Variants with given indices, in any order, possibly repeated."""
        if np.array_equal(chosen, np.arange(self.count)):
            return self
        return Variants(
            self.numbers.of_variants(chosen),
            self.direction[chosen],
            self.flywheel[chosen],
            np.ascontiguousarray(self.parameters[:, chosen]),
            {node: end[chosen] for node, end in self.ends.items()},
            self.breaks.some(chosen),
            None if self.instants is None else self.instants[:, chosen],
            {},
        )


class Reduction:
    """What the motion needs whichever actions act: inertia, breaks of the torques, and ends of strokes.

    Parameters
    ----------
    mechanics : Mechanics

    Attributes
    ----------
    mechanics : as given
    time, speed : Given
        Arguments of loads over time and of loads by formula.
    loads : Loads
    nodes : list of Node
        I, dI/dφ and the torque of each action at unit speed.
    tabulation : Tabulation
        Tabulation of the nodes.
    landmarks : Landmarks
    has_cycle : bool
        Whether the input rotates fully.
    """

    def __init__(self, mechanics: Mechanics) -> None:
        graph, reduced = mechanics.graph, mechanics.reduced
        self.mechanics, self.time, self.speed = mechanics, graph.given("time"), graph.given("speed")
        self.loads = loads_of(mechanics, self.time, self.speed)
        working = {load.action: [] for load in self.loads.terms if load.basis is not graph.zero}
        for load in self.loads.terms:
            working.get(load.action, []).append((load.coefficient, load.basis))
        moments = {action: graph.combination(terms) for action, terms in working.items()}
        self.nodes = [reduced.inertia, reduced.slope, *moments.values()]
        terms = [*self.loads.terms, *_reversals(mechanics), *_slope_jumps(mechanics)]
        watched = [load.characteristic for load in terms]
        functions = functions_at(graph, mechanics.first, mechanics.last, self.nodes, watched)
        self.tabulation = Tabulation(functions)
        judged = {action: functions.curves[moment] for action, moment in moments.items()}
        self.has_cycle = mechanics.has_cycle
        turns = mechanics.scene.input.revolutions if self.has_cycle else 1
        self.landmarks = Landmarks(self.tabulation, terms, judged, turns)

    @property
    def cycle(self) -> float:
        """Period of everything except time [rad]; infinite if the input does not rotate fully."""
        return math.tau * self.mechanics.scene.input.revolutions if self.has_cycle else np.inf

    def range_of(self, numbers: Numbers, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Minimum and maximum position of the input, (variants,) each [rad; m if it slides]; 0 … 2π for a crank."""
        ends = [np.broadcast_to(end.compute(numbers), (count,)) for end in (self.mechanics.first, self.mechanics.last)]
        return np.minimum(*ends).astype(float), np.maximum(*ends).astype(float)

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
        parameters, ends, breaks = self.landmarks(numbers, direction)
        return Variants(numbers, direction, flywheel, parameters, ends, breaks, None, {})

    def without_inertia(self, variants: "Variants") -> np.ndarray:
        """Which variants have zero reduced inertia at some crank angle, (variants,) of bool.

        With servos the inertia depends on time, too, and its zeros end the steps.
        """
        constant = self.mechanics.reduced.first_kind.compute(variants.numbers) + variants.flywheel
        found = np.zeros(variants.count, bool)
        bare = np.flatnonzero(np.broadcast_to(constant, (variants.count,)) <= 0.0)
        if bare.size and not own_drives(self.mechanics.scene):
            found[bare] = self._vanishes(variants.some(bare))
        return found

    def _vanishes(self, variants: "Variants") -> np.ndarray:
        """Whether the minimum inertia over the cycle is zero within rounding."""
        low, high = self.range_of(variants.numbers, variants.count)
        step = (high - low) / LOOKED_AT
        places = low + step * np.arange(LOOKED_AT + (not self.has_cycle))[:, None]
        inertia = self.inertia_curves(variants.parameters, places)[0]
        around = low + step * inertia.argmin(axis=0)
        before, after = around - step, around + step
        if not self.has_cycle:
            before, after = np.maximum(before, low), np.minimum(after, high)
        bottom = regula_falsi(lambda q: self.inertia_curves(variants.parameters, q[None])[1, 0], before, after)
        least = np.fmin(self.inertia_curves(variants.parameters, bottom[None])[0, 0], inertia.min(axis=0))
        # A removed inertia counts as a negative flywheel.
        return least + variants.flywheel <= NO_INERTIA * inertia.max(axis=0)

    def inertia_curves(self, parameters: np.ndarray, places: np.ndarray) -> np.ndarray:
        """I without flywheels and dI/dφ of variants with these numbers at crank angles, (2, …, variants)."""
        return self.tabulation(parameters, places)[[self.tabulation.functions.curves[node] for node in self.nodes[:2]]]


def _reversals(mechanics: Mechanics) -> list[Load]:
    """Jumps due to friction: the direction of motion of each pair with friction, as a unit load."""
    graph, found = mechanics.graph, []
    rubbing = {friction.pair for friction in mechanics.scene.friction.values()}
    for pair in [*pairs(mechanics.scene), *contact_pairs(mechanics.scene)]:
        if pair.name in rubbing:
            rate, slope = relative_motion(mechanics.kinematics, pair)
            graph.switches(rate, slope)
            direction = graph.held(graph.apply(sense, rate))
            grip = Grip(pair.link, None, None)
            found.append(Load(IN_PAIRS, graph.one, direction, grip, graph.one, direction, "harmful", 0))
    for name in lossy_meshes(mechanics.scene):
        rate, slope = rolling_rate(mechanics.kinematics, name)
        graph.switches(rate, slope)
        direction = graph.held(graph.apply(sense, rate))
        found.append(Load(IN_PAIRS, graph.one, direction, Grip(name, None, None), graph.one, direction, "harmful", 0))
    return found


def _has_programs(scene: Scene) -> bool:
    """Whether anything moves by sections or a table: a cam's follower or a second input."""
    return bool(scene.cams) or any(second.sections or second.table is not None for second in scene.inputs.values())


def _slope_jumps(mechanics: Mechanics) -> list[Load]:
    """Jumps of the inertia's derivative where sections meet, as a load; independent of the acting actions."""
    if not _has_programs(mechanics.scene):
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
        Whether the works of useful and harmful loads, … are integrated separately.
    rubs : bool
        Whether the friction in the pairs acts, too.
    gathered : frozenset of str
        Other integrals of runs, of "motors", "squares" and "fading".
    """

    def __init__(
        self,
        reduction: Reduction,
        off: frozenset[str] = frozenset(),
        works: bool = False,
        rubs: bool = False,
        gathered: frozenset[str] = frozenset(),
    ) -> None:
        scene, loads = reduction.mechanics.scene, reduction.loads
        self.works, self.reduction, self.rubs, self.off = works, reduction, rubs, off
        self._gathered = gathered | frozenset(CHANNELS if works else ())
        self.motors = tuple(name for name in loads.motors if name not in off)
        acting = [load for load in loads.terms if load.action not in off]
        self.active = frozenset(load.action for load in acting)
        self.active |= {IN_PAIRS} if rubs else set()
        self.active |= {OF_INERTIA} if _has_programs(scene) else set()
        working = [load for load in acting if load.basis is not load.basis.graph.zero]
        own = [scene.inputs[name] for name in own_drives(scene)]
        self.with_servos = bool(own)
        # Whether second inputs keep moving while the first is at rest.
        self.moved = any(second.period is not None or getattr(second, "speed", 0.0) for second in own)
        self.timed = self.moved or reduction.time in reached([load.basis for load in working])
        # Whether a torque may change at any time.
        formulas = load_formulas(scene)
        self.changing = self.moved or any(formulas[name].depends_on_time for name in self.active & formulas.keys())
        self.brakes = tuple(name for name in self.active if isinstance(scene.moments.get(name), Brake))
        # Whether all torques vanish with the speed: then nothing stops or starts the machine.
        self.fades = not (self.motors or rubs or own) and all(load.order in (1, 2) for load in working)
        # Whether torques that don't resist at standstill vanish at least linearly with the speed; one that falls as its
        # root would stop the machine.
        by_speed = reduction.speed in reached([load.basis for load in working])
        self.smooth = not by_speed and all(load.order in POLYNOMIAL_ORDERS for load in working)
        self.cycle = reduction.cycle

    def driven(self, variants: Variants) -> Variants:
        """The variants with the breaks and instants of the acting loads."""
        instants = instants_of(self.reduction.mechanics.scene, self.active, variants.numbers, variants.count)
        return variants._replace(breaks=variants.breaks.of(self.active), instants=instants, kept={})

    @cached_property
    def by_angle(self) -> MachineSystem:
        """The equation of motion over the crank angle, with its functions printed."""
        mechanics = self.reduction.mechanics
        return MachineSystem(*along_angle(mechanics, self._gathered), mechanics)

    @cached_property
    def by_time(self) -> MachineSystem:
        """The equation of motion over time, with its functions printed."""
        mechanics = self.reduction.mechanics
        return MachineSystem(*along_time(mechanics, self._gathered, self.rubs), mechanics)

    def moving(self, system: MachineSystem, variants: Variants, facing: float = 1.0) -> np.ndarray:
        """Numbers of a motion for one of the systems, (numbers, variants), without the limits that end a walk.

        Parameters
        ----------
        system : MachineSystem
        variants : Variants
        facing : float
            +1 or −1: forwards or backwards.
        """
        key = system.system.along, facing
        if key not in variants.kept:
            # Only forward motion can return to the form over the angle, if that form applies.
            by_angle = facing > 0.0 and not self.in_time
            given = self.sized(system.sizes, variants, facing) | {system.sizes.stay: 0.0 if by_angle else np.inf}
            direction = facing * variants.direction
            variants.kept[key] = system.tabulation.parameters(variants.numbers, direction, variants.ends | given)
        return variants.kept[key]

    def sized(self, sizes: Sizes, variants: Variants, facing: float = 1.0) -> dict[Given, np.ndarray | float]:
        """Sizes of the acting loads for motion forwards or backwards, the acting motors, flywheel and direction."""
        direction = facing * variants.direction
        unit = variants.numbers.with_values({"input.speed": direction})
        given = {s: value_of(c, unit) if a not in self.off else 0.0 for s, (a, c) in sizes.loads.items()}
        given |= {size: float(name in self.motors) for size, name in sizes.motors.items()}
        return given | {sizes.wheel: variants.flywheel, sizes.direction: direction, sizes.facing: facing}

    @property
    def in_time(self) -> bool:
        """Whether only the time form applies: friction in pairs, torques over time, other drives, a limited range."""
        return self.timed or self.rubs or self.with_servos or not self.reduction.has_cycle

    def locked(self, variants: Variants) -> np.ndarray:
        """Which variants have an acting brake that is self-locking, (variants,) of bool."""
        scene, found = self.reduction.mechanics.scene, np.zeros(variants.count, bool)
        for name in self.brakes:
            found |= np.isinf(braking_moment(scene.moments[name], f"moments.{name}", variants.numbers))
        return found

    def rounding_of_brakes(self, numbers: Numbers) -> np.ndarray | float:
        """Factor by which acting brakes amplify the rounding of their numbers, at least 1."""
        moments = self.reduction.mechanics.scene.moments
        with np.errstate(divide="ignore", invalid="ignore"):
            factors = [rounding_of_braking(moments[name], f"moments.{name}", numbers) for name in self.brakes]
        return reduce(np.fmax, factors, 1.0)

    def drives(self, numbers: Numbers) -> list[tuple[MotorCurve, float | np.ndarray]]:
        """Characteristic of each acting motor, and the magnitude of its speed over that of the input."""
        scene = self.reduction.mechanics.scene
        motors = [(name, scene.moments[name]) for name in self.motors]
        return [
            (motor.curve(f"moments.{name}", numbers), np.abs(motor_ratio(scene, motor, numbers)))
            for name, motor in motors
        ]

    def no_load_speed(self, variants: Variants) -> tuple[np.ndarray, np.ndarray]:
        """Speed above which no motor drives, and whether there is a motor; without one, the scene's own speed."""
        top = np.zeros(variants.count)
        for curve, ratio in self.drives(variants.numbers):
            top = np.maximum(top, curve.no_load_speed / ratio)
        return np.where(top > 0.0, top, np.abs(variants.numbers["input.speed"])), top > 0.0

    def greatest_moment(self, numbers: Numbers, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Peak torque of the motors, by magnitude, between two speeds of each variant [rad/s]."""
        drives, speeds = self.drives(numbers), [low, high]
        # The torque of one motor has its peak at one of the ends or at a peak of its own.
        if len(drives) > 1:
            speeds += [low + share * (high - low) for share in np.linspace(0.0, 1.0, SPEEDS_BETWEEN)[1:-1]]
        for curve, ratio in drives:
            speeds += [at / ratio for at in curve.peaks]
        at = np.array([np.clip(speed, low, high) for speed in speeds])
        return np.abs(sum((ratio * curve.moment(ratio * at) for curve, ratio in drives), np.zeros(at.shape))).max(
            axis=0
        )

    def gathered(
        self, system: MachineSystem, rows: np.ndarray, change: np.ndarray, sign: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Works of the motors and of each channel, and the integral of the squared motor torque; zero if unused.

        If works aren't separate, all loads count as "other": their work is the change of energy minus the motors' work.

        Parameters
        ----------
        system : MachineSystem
        rows : ndarray (states and gathered, variants)
            Rows of the system.
        change : ndarray (variants,)
            Change of the energy.
        sign : float
            −1; +1 if all are error estimates.
        """
        names, nothing = system.names, np.zeros_like(change)
        motors, squares = (rows[names[name]] if name in names else nothing for name in ("motors", "squares"))
        loads = [rows[names[name]] if self.works else nothing for name in CHANNELS]
        loads[-1] = loads[-1] if self.works else change + sign * motors
        return np.stack([motors, *loads]), squares

    def inertia(self, variants: Variants, places: np.ndarray, who: np.ndarray | slice = slice(None)) -> np.ndarray:
        """Reduced inertia with the flywheel at crank angles (…, variants) of all variants, or of some [kg·m²]."""
        parameters = variant_columns(variants.parameters, who)
        return self.reduction.inertia_curves(parameters, places)[0] + variants.flywheel[who]

    def mean_inertia(self, variants: Variants, positions: int) -> np.ndarray:
        """Mean of the reduced inertia over a number of crank angles of the cycle, (variants,) [kg·m²]."""
        places = np.arange(positions)[:, None] * (self.cycle / positions) + np.zeros(variants.count)
        return mean_of_rows(self.inertia(variants, places))
