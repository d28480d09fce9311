"""Equation of motion of a machine at two speeds: those of the crank and of the shaft on the other side of a coupling.

I ε₁ + ½ω₁² dI/dφ = M₁ + T and J ε₂ = M₂ − T, with the coupling's torque T on the crank. A locked clutch makes both
sides one: (I + J) ε + ½ω² dI/dφ = M₁ + M₂. An elastic shaft has T = k q + b q̇; its twist q = φ₂ − φ₁ is zero at first
forward contact. With a backlash Δ, T = k (q + Δ) + b q̇ in backward contact, and T = 0 between contacts.

All quantities are reduced to the crank. Each side has a non-negative speed and a direction of motion; torques on it
count in that direction, T in the machine's direction of motion.
"""

from enum import IntEnum
from functools import partial
from typing import NamedTuple

from engine.compiling.decorators import scalar
from engine.compiling.instructions import chosen
from engine.elements.elastic_drives.shaft_touch import touch_left, touch_turns, touching_moment
from engine.graph.derivatives import derivative
from engine.graph.nodes import Given, Graph, Node, Stage
from engine.laws.kinematics.closure import greater
from engine.laws.tables import in_memory, make_table
from engine.mechanism.mechanics import Mechanics
from engine.motion.coupled.fluid_torque import fluid_moment, fluid_piece, slip_guards
from engine.motion.one_speed import (
    CHANNELS,
    SLOPES,
    Sizes,
    TimeEnd,
    friction_of,
    further_nodes,
    inertia_with_flywheel,
    moments_of,
    sizes_of,
)
from engine.parts.couplings import Coupling, FluidCoupling
from engine.stepping.system import System

# Relative excess of the driving torque at breakaway.
SURELY = 1e-11
# Relative excess of a clutch's static capacity over its slipping torque: below the error of any step.
GRIP = 1e-11
# The sign of the slip is decided again once a clutch slips in the opposite direction by more than this fraction of
# the speeds.
ASTRAY = 1e-9
# States, and the integrals other than the works of each channel; with an elastic shaft the third state is its twist.
TURNED, CRANK_SPEED, SHAFT_TURNED, SHAFT_SPEED = range(4)
GATHERED = ("heat", "slipped", "squares", "motors")
# Events that end a walk apart from speed limits, as reasons for its end, in the order of the guards.
Ending = IntEnum(
    "Ending", "CRANK_RESTS SHAFT_RESTS LOCKS_UP ASTRAY BREAKS_LOOSE SETS_OFF TOUCH TURNS", start=TimeEnd.BELOW + 1
)


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


def _joining(mechanics: Mechanics, knots: int) -> Joining:
    def number(label: str) -> Given:
        # Some change from walk to walk, so nothing of them may be computed once.
        return mechanics.graph.given(f"coupling: {label}", Stage.STATE)

    def numbers(label: str, count: int) -> tuple[Given, ...]:
        return tuple(number(f"{label} {i}") for i in range(count))

    several = {"times": numbers("time", knots), "capacity": numbers("capacity", knots)}
    several["never"] = tuple(number(f"never {ending.name}") for ending in Ending)
    return Joining(**several, **{name: number(name) for name in Joining._fields if name not in several})


# Derivative of the torque of an elastic shaft with respect to the slip.
BY_SLIP = {touching_moment: {5: lambda *operands: operands[2] * (operands[4] * operands[4])}}


class _Joint:
    """What joins the sides, as long as they turn separately.

    Attributes
    ----------
    torque : Node
    capacity : Node
        Of a clutch, else 0.
    held : dict of Given to Node
        Held modes, as in `System`.
    """

    def __init__(self, torque: Node, capacity: Node, held: dict[Given, Node] | None = None) -> None:
        self.torque, self.capacity, self.held = torque, capacity, held or {}

    def endings(self, rise: Node, shaft_rise: Node) -> dict[Ending, Node]:
        """Further events that end a walk; the arguments are the sides' accelerations in the machine's direction."""
        return {}

    def switches(self, rise: Node, shaft_rise: Node) -> tuple[Node, ...]:
        """Events at which a held mode changes; arguments as for `endings`."""
        return ()


class _Clutch(_Joint):
    """A clutch that slips transmits its capacity, which may rise in the time after its engagement."""

    def __init__(self, graph: Graph, joining: Joining, clock: Node) -> None:
        capacity = joining.capacity[0]
        for i in range(1, len(joining.capacity)):
            rise = graph.apply(ramp, clock - joining.engaged, *joining.times[i - 1 : i + 1])
            capacity = capacity + (joining.capacity[i] - joining.capacity[i - 1]) * rise
        super().__init__(joining.sense * capacity, capacity)


class _FluidCoupling(_Joint):
    """A fluid coupling, whose coefficient is read from a table over the slip, piece by piece."""

    def __init__(self, graph: Graph, joining: Joining, coupling: FluidCoupling, ahead: Node, shaft_ahead: Node) -> None:
        table = graph.store(in_memory(make_table(coupling.slip, coupling.coefficient, coupling.interpolation)))
        slips = joining.piece, ahead, shaft_ahead
        torque = graph.apply(fluid_moment, graph.memory, table, joining.fluid, *slips)
        piece = graph.apply(fluid_piece, graph.memory, table, *slips)
        super().__init__(torque, graph.zero, {joining.piece: piece})
        self._ends = partial(graph.apply, slip_guards, graph.memory, table, *slips)

    def switches(self, rise: Node, shaft_rise: Node) -> tuple[Node, ...]:
        return self._ends(rise, shaft_rise)


class _ElasticShaft(_Joint):
    """An elastic shaft with a backlash, of which one contact touches or none."""

    def __init__(self, graph: Graph, joining: Joining, twist: Node, slip: Node) -> None:
        elastic = joining.stiffness, joining.damping, joining.backlash
        super().__init__(graph.apply(touching_moment, elastic, joining.touch, twist, slip), graph.zero)
        self._touch = graph.apply(touch_left, elastic, joining.touch, twist, slip)
        turns = partial(graph.apply, touch_turns, elastic, joining.touch, slip)
        self._turns = lambda parting: joining.growing * turns(parting)

    def endings(self, rise: Node, shaft_rise: Node) -> dict[Ending, Node]:
        return {Ending.TOUCH: self._touch, Ending.TURNS: self._turns(shaft_rise - rise)}


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
    graph, joining = mechanics.graph, _joining(mechanics, knots)
    labels = ("angle turned", "speed of a state", "angle turned by the shaft", "speed of the shaft")
    states = tuple(graph.given(label, Stage.STATE) for label in labels)
    _, speed, twist, shaft_speed = states
    loads, clock, crank = sizes_of(mechanics, speed)
    shaft_loads, _, shaft = sizes_of(mechanics, shaft_speed, "shaft: ")
    of_crank = moments_of(mechanics, loads, crank, speed, on_shaft)
    of_shaft = moments_of(mechanics, shaft_loads, shaft, shaft_speed, elsewhere)
    of_inertia, unknown = (0.5 * speed * speed) * (crank.direction * mechanics.reduced.slope), {}
    # Motors and fluids make steps stiff. Friction doesn't, and its derivative would contain those of all reactions.
    smooth = of_crank.total - of_inertia
    if rubs:
        unknown[speed] = graph.given("acceleration", Stage.STATE)
        rubbed = friction_of(mechanics, loads, crank, speed, unknown[speed], on_shaft)
        of_crank.channels["harmful"] += rubbed
    ahead, shaft_ahead = crank.facing * speed, shaft.facing * shaft_speed
    slip = shaft_ahead - ahead
    if coupling is None:
        joint: _Joint = _ElasticShaft(graph, joining, twist, slip)
    elif isinstance(coupling, FluidCoupling):
        joint = _FluidCoupling(graph, joining, coupling, ahead, shaft_ahead)
    else:
        joint = _Clutch(graph, joining, clock)
    facing, inertia = (crank.facing, shaft.facing), inertia_with_flywheel(mechanics)[0]

    def moved(m1: Node) -> _Moved:
        return _accelerated(joining, joint, (m1, of_shaft.total), facing, inertia)

    moving = moved(of_crank.total - of_inertia)
    accelerations = crank.facing * moving.rise, shaft.facing * moving.shaft_rise
    endings = {
        Ending.CRANK_RESTS: speed,
        Ending.SHAFT_RESTS: shaft_speed,
        Ending.LOCKS_UP: joining.sense * slip,
        Ending.ASTRAY: joining.sense * slip + ASTRAY * (speed + shaft_speed),
        Ending.BREAKS_LOOSE: joint.capacity * (1.0 + GRIP) - abs(moving.held),
        Ending.SETS_OFF: _held_back(joining, joint, *moving.moments),
        **joint.endings(*accelerations),
    }
    others = (endings.get(ending, graph.zero) + never for ending, never in zip(Ending, joining.never, strict=True))
    rises = moved(smooth)
    slopes = [
        [derivative(rise, {by: graph.one}, SLOPES | BY_SLIP) for by in (speed, shaft_speed)]
        for rise in (rises.rise, rises.shaft_rise)
    ]
    motors = of_crank.motors + of_shaft.motors
    power = of_crank.motors * speed + of_shaft.motors * shaft_speed
    gathered = dict(zip(GATHERED, (moving.torque * slip, abs(slip), motors * motors, power), strict=True))
    if works:
        gathered |= {n: of_crank.channels[n] * speed + of_shaft.channels[n] * shaft_speed for n in CHANNELS}
    further = {"coupling": moving.torque}
    for side, rise, moments in (("crank", moving.rise, of_crank), ("shaft", moving.shaft_rise, of_shaft)):
        further |= {f"{side} {name}": node for name, node in further_nodes(inertia, rise, moments).items()}
    system = System(
        "time",
        states=states,
        rates=(ahead, moving.rise, slip if coupling is None else shaft_ahead, moving.shaft_rise),
        speed=speed,
        slope=moving.rise,
        clock=clock,
        steepness=graph.apply(greater, *(abs(a) + abs(b) for a, b in slopes)),
        unknown=unknown,
        gathered=gathered,
        # The stiffness of a shaft isn't among the slopes.
        slopes=() if coupling is None else tuple(slope for row in slopes for slope in row),
        guards=(crank.above - speed, speed - crank.below, *others),
        switches=joint.switches(*accelerations),
        held=joint.held,
        further=further,
    )
    return system, TwoSizes(crank, shaft, joining)


class _Moved(NamedTuple):
    """Torque of a locked clutch, torque of the coupling as it is, accelerations and moments of both sides."""

    held: Node
    torque: Node
    rise: Node
    shaft_rise: Node
    moments: tuple[Node, Node]


def _accelerated(
    joining: Joining, joint: _Joint, moments: tuple[Node, Node], facing: tuple[Node, Node], inertia: Node
) -> _Moved:
    """Motion of both sides under their moments, whether the coupling holds them together or not."""
    (m1, m2), (ahead, other), own, apart = moments, facing, joining.shaft_inertia, joint.torque
    rises = (m1 + ahead * apart) / inertia, (m2 - other * apart) / own
    held = moment = apart
    if joining.capacity:
        # Locked sides have the same direction.
        together = (m1 + m2) / (inertia + own)
        held = other * (m2 - own * together)
        rises = tuple(joining.holds * together + (1.0 - joining.holds) * alone for alone in rises)
        moment = joining.holds * held + (1.0 - joining.holds) * apart
    return _Moved(held, moment, rises[0] * joining.moves, rises[1] * joining.shaft_moves, moments)


def _held_back(joining: Joining, joint: _Joint, m1: Node, m2: Node) -> Node:
    """Margin of the resistances of standing sides over the torques that would start one, in either direction."""
    moment, capacity = joint.torque, joint.capacity
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
