"""Equation of motion of a machine at two speeds: those of the crank and of the shaft on the other side of a coupling.

I ε₁ + ½ω₁² dI/dφ = M₁ + T and J ε₂ = M₂ − T, with the coupling's torque T on the crank. A locked clutch makes both
sides one: (I + J) ε + ½ω² dI/dφ = M₁ + M₂. An elastic shaft has T = k q + b q̇; its twist q = φ₂ − φ₁ is zero at first
forward contact. With a backlash Δ, T = k (q + Δ) + b q̇ in backward contact, and T = 0 between contacts.

All quantities are reduced to the crank. Each side has a non-negative speed and a direction of motion; torques on it
count in that direction, T in the machine's direction of motion.
"""

from typing import NamedTuple

from engine.compiling.decorators import scalar
from engine.compiling.instructions import chosen
from engine.elements.elastic_drives.shaft_touch import touch_left, touch_turns, touching_moment
from engine.graph.derivatives import derivative
from engine.graph.nodes import Given, Node, Stage
from engine.laws.kinematics.closure import greater
from engine.laws.tables import in_memory, make_table
from engine.mechanism.mechanics import Mechanics
from engine.motion.coupled.fluid_torque import fluid_moment, fluid_piece, slip_guards
from engine.motion.one_speed import (
    CHANNELS,
    SLOPES,
    Sizes,
    friction_of,
    inertia_with_flywheel,
    moments_of,
    shown_of,
    sizes_of,
)
from engine.parts.couplings import Coupling, FluidCoupling
from engine.stepping.system import Guard, System

# Relative excess of the driving torque at breakaway.
SURELY = 1e-11
# Relative excess of a clutch's static capacity over its slipping torque: below the error of any step.
GRIP = 1e-11
# The sign of the slip is decided again once a clutch slips the other way by more than this fraction of the speeds.
ASTRAY = 1e-9
# States, and the integrals other than the works of each channel; with an elastic shaft the third state is its twist.
TURNED, CRANK_SPEED, SHAFT_TURNED, SHAFT_SPEED = range(4)
GATHERED = ("heat", "slipped", "squares", "motors")


@scalar
def ramp(x: float, begin: float, end: float) -> float:
    """Linear ramp of x from 0 at `begin` to 1 at `end`, constant outside."""
    share = (x - begin) / (end - begin)
    return chosen(x <= begin, 0.0, chosen(share >= 1.0, 1.0, share))


class Joining(NamedTuple):
    """Numbers that define how the sides are joined.

    Attributes
    ----------
    holds : Given
        1 if a clutch is locked, else 0.
    sense : Given
        Sign of a clutch's slip, +1 if the shaft is faster, −1 if slower; 0 without slip.
    moves, shaft_moves : Given
        1 if a side moves, 0 at rest.
    fluid : Given
        Torque of a fluid coupling over λ ω² [kg·m²].
    piece : Given
        Piece of a fluid coupling's table, as in `fluid_torque`.
    engaged : Given
        Clock time at which the coupling was engaged [s].
    times, capacity : tuple of Given
        Times after the engagement [s], and the torque a clutch transmits then [N·m].
    shaft_inertia : Given
        Reduced to the crank [kg·m²].
    stiffness, damping, backlash : Given
        Numbers of an elastic shaft [N·m/rad, N·m·s/rad, rad].
    touch : Given
        Contact of the elastic shaft: 1 forward, −1 backward, 0 none.
    growing : Given
        +1 or −1: whether its torque (its twist, if out of contact) rises or falls.
    resists, shaft_resists : Given
        Sum of the torques on a standing side for a start forwards and one backwards, each positive in the direction of
        the start: minus twice the resistance [N·m].
    never : tuple of Given
        Infinite for inactive guards, in their order, else 0.
    """

    holds: Given
    sense: Given
    moves: Given
    shaft_moves: Given
    fluid: Given
    piece: Given
    engaged: Given
    times: tuple[Given, ...]
    capacity: tuple[Given, ...]
    shaft_inertia: Given
    stiffness: Given
    damping: Given
    backlash: Given
    touch: Given
    growing: Given
    resists: Given
    shaft_resists: Given
    never: tuple[Given, ...]


class TwoSizes(NamedTuple):
    """Numbers given to the system: of both sides, and of the joining."""

    crank: Sizes
    shaft: Sizes
    joining: Joining


def _joining(mechanics: Mechanics, guards: tuple[str, ...], knots: int) -> Joining:
    def number(label: str) -> Given:
        # Some change from walk to walk, so nothing of them may be computed once.
        return mechanics.graph.given(f"coupling: {label}", Stage.STATE)

    def numbers(label: str, count: int) -> tuple[Given, ...]:
        return tuple(number(f"{label} {i}") for i in range(count))

    several = {"times": numbers("time", knots), "capacity": numbers("capacity", knots)}
    several["never"] = tuple(number(f"never {name}") for name in guards)
    return Joining(**several, **{name: number(name) for name in Joining._fields if name not in several})


# Derivative of the torque of an elastic shaft with respect to the slip.
BY_SLIP = {touching_moment: {5: lambda *operands: operands[2] * (operands[4] * operands[4])}}
# Events that end a walk apart from speed limits, in the order of the guards.
ENDINGS = ("crank rests", "shaft rests", "locks up", "astray", "breaks loose", "sets off", "touch", "turns")


def at_two_speeds(
    mechanics: Mechanics,
    coupling: Coupling | None,
    knots: int,
    on_shaft: frozenset[str],
    elsewhere: frozenset[str],
    works: bool,
    rubs: bool,
) -> tuple[System, TwoSizes]:
    """Equation of motion of both sides of a coupling.

    Parameters
    ----------
    mechanics : Mechanics
    coupling : Coupling or None
        None for an elastic shaft.
    knots : int
        Number of instants that define a clutch's capacity over time.
    on_shaft, elsewhere : frozenset of str
        Actions on the coupled shaft, and all others.
    works : bool
        Whether the works of useful and harmful loads, … are integrated separately.
    rubs : bool
        Whether pairs have friction.
    """
    graph, inertia = mechanics.graph, inertia_with_flywheel(mechanics)[0]
    labels = ("angle turned", "speed of a state", "angle turned by the shaft", "speed of the shaft")
    states = tuple(graph.given(label, Stage.STATE) for label in labels)
    _, speed, twist, shaft_speed = states

    (loads, clock, crank), (shaft_loads, _, shaft) = (
        sizes_of(mechanics, *side) for side in ((speed, ""), (shaft_speed, "shaft: "))
    )
    of_crank = moments_of(mechanics, loads, crank, speed, on_shaft)
    of_shaft = moments_of(mechanics, shaft_loads, shaft, shaft_speed, elsewhere)
    joining = _joining(mechanics, ENDINGS, knots)
    capacity = joining.capacity[0] if knots else graph.zero
    for i in range(1, knots):
        rise = graph.apply(ramp, clock - joining.engaged, *joining.times[i - 1 : i + 1])
        capacity = capacity + (joining.capacity[i] - joining.capacity[i - 1]) * rise
    own, other = joining.shaft_inertia, shaft.facing
    of_inertia, unknown = (0.5 * speed * speed) * (crank.way * mechanics.reduced.slope), {}
    # Motors and fluids make steps stiff. Friction doesn't, and its derivative would contain those of all reactions.
    smooth, m2 = of_crank.total - of_inertia, of_shaft.total
    if rubs:
        unknown[speed] = graph.given("acceleration", Stage.STATE)
        rubbed = friction_of(mechanics, loads, crank, speed, unknown[speed], on_shaft)
        of_crank.channels["harmful"] += rubbed
    m1 = of_crank.total - of_inertia
    ahead, shaft_ahead = crank.facing * speed, other * shaft_speed
    slip = shaft_ahead - ahead
    touch, turns, kept = graph.zero, graph.zero, {}
    elastic = joining.stiffness, joining.damping, joining.backlash
    if coupling is None:
        apart = graph.apply(touching_moment, elastic, joining.touch, twist, slip)
        touch = graph.apply(touch_left, elastic, joining.touch, twist, slip)
    elif isinstance(coupling, FluidCoupling):
        table = graph.store(in_memory(make_table(coupling.slip, coupling.coefficient, coupling.interpolation)))
        slips = joining.piece, ahead, shaft_ahead
        apart = graph.apply(fluid_moment, graph.memory, table, joining.fluid, *slips)
        kept = {joining.piece: graph.apply(fluid_piece, graph.memory, table, *slips)}
    else:
        apart = joining.sense * capacity

    def moved(m1: Node) -> tuple[Node, Node, Node]:
        """Torque of a locked clutch, and the accelerations of both sides."""
        held, rises = apart, ((m1 + crank.facing * apart) / inertia, (m2 - other * apart) / own)
        if knots:
            # Locked sides have the same direction.
            together = (m1 + m2) / (inertia + own)
            held = other * (m2 - own * together)
            rises = tuple(joining.holds * together + (1.0 - joining.holds) * alone for alone in rises)
        return held, rises[0] * joining.moves, rises[1] * joining.shaft_moves

    held, *rises = moved(m1)
    moment = joining.holds * held + (1.0 - joining.holds) * apart if knots else apart
    if coupling is None:
        parting = other * rises[1] - crank.facing * rises[0]
        turns = joining.growing * graph.apply(touch_turns, elastic, joining.touch, slip, parting)
    motors = of_crank.motors + of_shaft.motors
    powers = {name: of_crank.channels[name] * speed + of_shaft.channels[name] * shaft_speed for name in CHANNELS}
    power = of_crank.motors * speed + of_shaft.motors * shaft_speed
    gathered = dict(zip(GATHERED, (moment * slip, abs(slip), motors * motors, power), strict=True)) | (
        powers if works else {}
    )
    endings = (
        speed,
        shaft_speed,
        joining.sense * slip,
        joining.sense * slip + ASTRAY * (speed + shaft_speed),
        capacity * (1.0 + GRIP) - abs(held),
        _held_back(joining, capacity, apart, m1, m2),
        touch,
        turns,
    )
    named = zip(ENDINGS, endings, joining.never, strict=True)
    guards = [Guard("above", crank.above - speed), Guard("below", speed - crank.below)]
    guards += [Guard(name, value + never) for name, value, never in named]
    if kept:
        accelerations = crank.facing * rises[0], other * rises[1]
        of_slip = graph.apply(slip_guards, graph.memory, table, *slips, *accelerations)
        guards += [Guard(f"slip {end}", value, False) for end, value in zip(("left", "near"), of_slip, strict=True)]
    slopes = [
        [derivative(rise, {by: graph.one}, SLOPES | BY_SLIP) for by in (speed, shaft_speed)]
        for rise in moved(smooth)[1:]
    ]
    steepness = graph.apply(greater, *(abs(a) + abs(b) for a, b in slopes))
    # The stiffness of a shaft isn't among the slopes.
    solved = () if coupling is None else tuple(slope for row in slopes for slope in row)
    shown = {"coupling": moment}
    for side, epsilon, moments in (("crank", rises[0], of_crank), ("shaft", rises[1], of_shaft)):
        shown |= {f"{side} {name}": node for name, node in shown_of(inertia, epsilon, moments).items()}
    system = System(
        "time",
        states=states,
        rates=(ahead, rises[0], slip if coupling is None else shaft_ahead, rises[1]),
        speed=speed,
        slope=rises[0],
        clock=clock,
        steepness=steepness,
        unknown=unknown,
        gathered=gathered,
        slopes=solved,
        guards=tuple(guards),
        held=kept,
        shown=shown,
    )
    return system, TwoSizes(crank, shaft, joining)


def _held_back(joining: Joining, capacity: Node, moment: Node, m1: Node, m2: Node) -> Node:
    """Margin of the resistances of standing sides over the torques that would start one, in either direction."""
    # Resistances keep their sign when the direction reverses; all other torques change it.
    graph, m1_back, m2_back = m1.graph, joining.resists - m1, joining.shaft_resists - m2

    def most(*nodes: Node) -> Node:
        first, *others = nodes
        for node in others:
            first = graph.apply(greater, first, node)
        return first

    # A moving side doesn't start.
    never = graph.constant(-1e300)
    alone = most(m1 + moment, m1_back - moment), most(m2 - moment, m2_back + moment)
    stands = [
        graph.apply(unless, moves, value, never)
        for moves, value in zip((joining.moves, joining.shaft_moves), alone, strict=True)
    ]
    both = most(m1 + m2, m1_back + m2_back, most(m1, m1_back, m2, m2_back) - capacity)
    held_apart = graph.apply(unless, joining.holds, most(*stands), both)
    # Without any torque the scale is the one that accelerates the shaft at 1 rad/s².
    return SURELY * (most(abs(m1), abs(m2), abs(moment)) + joining.shaft_inertia) - held_apart


@scalar
def unless(flag: float, value: float, otherwise: float) -> float:
    """`value` if the flag is zero, else `otherwise`."""
    return value if flag == 0.0 else otherwise
