"""A machine's equation of motion as a system of rates: states, accumulated integrals and guards, as nodes.

Over the crank angle the state is the kinetic energy E, with dE/dφ = M(φ, ω) and ω = √(2E/I); over time the states are
the angle turned and the speed, with I ε + ½ω² dI/dφ = M(φ, ω, t). Torques are positive in the direction of motion, so ω
is never negative: a machine that moves backwards has the opposite nominal direction of its input.
"""

from collections.abc import Callable
from enum import IntEnum
from typing import NamedTuple

from engine.compiling.decorators import Law
from engine.graph.derivatives import derivative
from engine.graph.nodes import Given, Node, Stage
from engine.laws.kinematics.closure import greater
from engine.laws.loads import sized
from engine.laws.motor_characteristics import BY_SPEED
from engine.mechanism.actions.motors import motor_at_speed, motor_on_shaft
from engine.mechanism.input_motion import InputMotion
from engine.mechanism.loads import Loads
from engine.mechanism.mechanics import Mechanics
from engine.mechanism.reactions import Reactions
from engine.motion.moments.own_drives import WithServos, loads_of
from engine.motion.moments.tabulation import Tabulation
from engine.stepping.system import PrintedSystem, System
from engine.stepping.walk_task import Why

# Kinds of work that are reported separately.
CHANNELS = ("driving", "useful", "harmful", "braking", "other")
# Powers of the speed whose loads are summed at a position.
POLYNOMIAL_ORDERS = (0, 1, 2)


def _motor_slope(slope: Law | None) -> Callable[..., Node]:
    return lambda result, *operands: result.graph.zero if slope is None else result.graph.apply(slope, *operands)


SLOPES = {
    **{law: {law.py_func.__code__.co_argcount - 1: _motor_slope(slope)} for law, slope in BY_SPEED.items()},
    sized: {1: lambda result, size, _: result.graph.apply(sized, size, 1.0)},
}
# Reasons for the end of a walk: the guards of each form of the equation of motion, target speeds first.
AngleEnd = IntEnum("AngleEnd", "ABOVE BELOW SLOW", start=Why.GUARD)
TimeEnd = IntEnum("TimeEnd", "ABOVE BELOW BRISK REST", start=Why.GUARD)
# Replaces a speed of zero, with a sign [rad/s].
AT_REST = 1e-150
# Fraction of its energy that a machine with a steep motor may lose before it counts as near rest.
MUCH = 0.5


class Sizes(NamedTuple):
    """Numbers that a motion supplies to its system: the size of each load, the acting motors, the direction."""

    loads: dict[Given, tuple[str, Node]]
    motors: dict[Given, str]
    wheel: Given
    direction: Given
    facing: Given
    above: Given
    below: Given
    brisk: Given
    stay: Given


class StateMoments(NamedTuple):
    """Torques in the direction of motion: of the motors, and of each channel of loads."""

    motors: Node
    channels: dict[str, Node]

    @property
    def total(self) -> Node:
        """Sum of all torques."""
        return self.motors + sum(self.channels.values())


def inertia_with_flywheel(mechanics: Mechanics) -> tuple[Node, Given]:
    """Reduced inertia including the flywheel of a motion, and the flywheel [kg·m²]."""
    wheel = mechanics.graph.given("flywheel of a motion", Stage.VARIANT)
    return mechanics.reduced.inertia + wheel, wheel


def sizes_of(mechanics: Mechanics, speed: Node, side: str = "") -> tuple[Loads, Given, Sizes]:
    """Loads of a machine, or of one side of it, at a speed; their time; and the numbers supplied to them."""
    graph, (_, wheel) = mechanics.graph, inertia_with_flywheel(mechanics)
    clock = graph.given("time of a state", Stage.STATE)
    # A step that ends at rest evaluates slightly beyond; a machine at rest resists motion in the direction it faces.
    loads = loads_of(mechanics, clock, speed, abs(speed) + AT_REST)

    def number(label: str) -> Given:
        return graph.given(side + label, Stage.VARIANT)

    sizes = {number(f"size {i}"): (load.action, load.coefficient) for i, load in enumerate(loads.terms)}
    motors = {number(f"motor {name} acts"): name for name in loads.motors}
    names = ("direction of motion", "facing", "speed above", "speed below", "brisk", "stay")
    return loads, clock, Sizes(sizes, motors, wheel, *(number(name) for name in names))


def moments_of(
    mechanics: Mechanics, loads: Loads, sizes: Sizes, speed: Node, off: frozenset[str] = frozenset()
) -> StateMoments:
    """Torques at a speed, by kind of work, without the actions in `off`."""
    graph = mechanics.graph
    motion = InputMotion(speed * speed, graph.zero, speed)
    by_magnitude = motion._replace(speed=abs(speed))
    by_channel: dict[str, dict[Node, list[Node]]] = {c: {} for c in CHANNELS}
    for size, load in zip(sizes.loads, loads.terms, strict=True):
        if load.basis is graph.zero or load.action in off:
            continue
        channel = load.role if load.role in CHANNELS else "other"
        # `sized` returns 0 for an action that is off, also at rest, where a negative power of the speed is infinite.
        polynomial = load.order in POLYNOMIAL_ORDERS
        power_of_speed = (motion if polynomial else by_magnitude).power(load.order)
        term = graph.apply(sized, size, load.basis if polynomial else load.basis * power_of_speed)
        orders = by_channel[channel]
        orders.setdefault(power_of_speed if polynomial else graph.one, []).append(term)
    channels = {}
    for channel, orders in by_channel.items():
        # Sum the terms that depend on the position only before multiplying by the power of the speed.
        parts = [(sizes.direction * sum(terms, graph.zero)) * at_speed for at_speed, terms in orders.items()]
        channels[channel] = sum(parts, graph.zero)
    return StateMoments(sum(motors_of(mechanics, sizes, speed, off).values(), graph.zero), channels)


def motors_of(mechanics: Mechanics, sizes: Sizes, speed: Node, off: frozenset[str]) -> dict[str, Node]:
    """Torque of each motor, in the direction of motion, without those in `off`."""
    acting = {name: on for on, name in sizes.motors.items() if name not in off}
    return {name: motor_at_speed(mechanics.kinematics, name, on, sizes.facing, speed) for name, on in acting.items()}


def along_angle(mechanics: Mechanics, asked: frozenset[str]) -> tuple[System, Sizes]:
    """The equation of motion over the crank angle, with time and the requested integrals.

    Parameters
    ----------
    mechanics : Mechanics
    asked : frozenset of str
        Integrals: "motors", "squares", "fading" (∫ ∂M/∂E dφ), and the channels of work.
    """
    graph = mechanics.graph
    energy = graph.given("kinetic energy", Stage.STATE)
    inertia, _ = inertia_with_flywheel(mechanics)
    inverse = 2.0 / inertia
    speed = graph.function("sqrt", energy * inverse)
    loads, clock, sizes = sizes_of(mechanics, speed)
    moments = moments_of(mechanics, loads, sizes, speed)
    total, pace = moments.total, 1.0 / speed
    steepness = derivative(total, {energy: graph.one}, SLOPES)
    squares = (moments.motors * moments.motors) * pace
    known = {"motors": moments.motors, **moments.channels, "squares": squares, "fading": steepness}
    slope = total - (0.5 * speed * speed) * (sizes.direction * mechanics.reduced.slope)
    size = abs(moments.motors) + abs(total - moments.motors)
    guards = {
        AngleEnd.ABOVE: sizes.above - speed,
        AngleEnd.BELOW: speed - sizes.below,
        # A steep motor restores the speed before much of the energy is lost.
        AngleEnd.SLOW: graph.apply(greater, sizes.brisk, -MUCH * steepness) * energy + total,
    }
    gathered = {"time": pace} | {name: node for name, node in known.items() if name in asked}
    responses = tuple(derivative(node, {energy: graph.one}, SLOPES) for node in gathered.values())
    system = System(
        "angle",
        states=(energy,),
        rates=(total,),
        speed=speed,
        slope=slope,
        clock=clock,
        size=size,
        steepness=steepness,
        gathered=gathered,
        slopes=(steepness,),
        responses=responses,
        guards=tuple(map(guards.get, AngleEnd)),
        further=further_nodes(inertia, slope / inertia, moments),
    )
    return system, sizes


def along_time(mechanics: Mechanics, asked: frozenset[str], rubs: bool) -> tuple[System, Sizes]:
    """The equation of motion over time; parameters as in `along_angle`, and whether there is friction in pairs."""
    graph = mechanics.graph
    turned, speed = (graph.given(label, Stage.STATE) for label in ("angle turned", "speed of a state"))
    inertia, _ = inertia_with_flywheel(mechanics)
    # The nodes of the position are those of the form over the angle, made in the same order: one function fills them.
    inverse = 2.0 / inertia
    loads, clock, sizes = sizes_of(mechanics, speed)
    moments, unknown = moments_of(mechanics, loads, sizes, speed), {}
    servos = loads if isinstance(loads, WithServos) else None
    if servos is None:
        total, bias = moments.total, (0.5 * speed * speed) * (sizes.direction * mechanics.reduced.slope)
        smooth = 0.5 * ((total - bias) * inverse)
    else:
        inertia, bias = servos.inertia, sizes.direction * servos.bias
        inverse = 2.0 / inertia
        smooth = 0.5 * (moments.motors * inverse)
    # Motors make a step stiff, friction does not; its derivative would contain those of all reactions.
    steepness = derivative(smooth, {speed: graph.one}, SLOPES)
    if rubs:
        unknown[speed] = graph.given("acceleration", Stage.STATE)
        moments.channels["harmful"] += friction_of(mechanics, loads, sizes, speed, unknown[speed])
    total = moments.total
    epsilon = 0.5 * ((total - bias) * inverse)
    powers, further = {name: moment * speed for name, moment in moments.channels.items()}, {}
    if servos is not None:
        powers = moments_of(mechanics, servos.at_true_velocities(), sizes, speed).channels
        of_drives = servos.energy_rate(epsilon) - moments.motors * speed - sum(powers.values(), graph.zero)
        powers["driving"] += of_drives
        further = {"energy": servos.energy} | {f"{name} power": power for name, power in powers.items()}
    known = {"motors": moments.motors * speed, **powers, "squares": moments.motors * moments.motors}
    guards = {
        TimeEnd.ABOVE: sizes.above - speed,
        TimeEnd.BELOW: speed - sizes.below,
        TimeEnd.BRISK: abs(total) + sizes.stay - sizes.brisk * (inertia * (0.5 * speed * speed)),
        TimeEnd.REST: speed,
    }
    gathered = {name: node for name, node in known.items() if name in asked}
    rates = (sizes.facing * speed, epsilon)
    system = System(
        "time",
        states=(turned, speed),
        rates=rates,
        speed=speed,
        slope=epsilon,
        clock=clock,
        steepness=steepness,
        unknown=unknown,
        gathered=gathered,
        slopes=(steepness,),
        guards=tuple(map(guards.get, TimeEnd)),
        further=further_nodes(inertia, epsilon, moments) | further,
    )
    return system, sizes


def further_nodes(inertia: Node, epsilon: Node, moments: StateMoments) -> dict[str, Node]:
    """Nodes that are evaluated at single instants, too: inertia, acceleration, and torques by kind of work."""
    return {"inertia": inertia, "acceleration": epsilon, "motors": moments.motors, **moments.channels}


def friction_of(
    mechanics: Mechanics,
    loads: Loads,
    sizes: Sizes,
    speed: Node,
    epsilon: Node,
    off: frozenset[str] = frozenset(),
) -> Node:
    """Torque equivalent to friction in pairs and meshes, in the direction of motion; motors in `off` don't act."""
    motion = InputMotion(speed * speed, sizes.direction * epsilon, speed)
    acting = [load._replace(coefficient=size) for size, load in zip(sizes.loads, loads.terms, strict=True)]
    for name, reduced in motors_of(mechanics, sizes, speed, off).items():
        acting.append(motor_on_shaft(mechanics.kinematics, name, reduced, sizes.direction))
    reactions = Reactions(mechanics.kinematics, mechanics.structure, acting, motion)
    return sizes.direction * reactions.variables["friction_moment"]


class MachineSystem(PrintedSystem):
    """A machine's system with its printed functions."""

    def __init__(self, system: System, sizes: Sizes, mechanics: Mechanics) -> None:
        super().__init__(system, mechanics.graph, mechanics.first, mechanics.last)
        self.sizes = sizes
        self.tabulation = Tabulation(self.functions)
