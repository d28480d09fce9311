"""The two sides of a coupling: the crank with everything geared to it, and the shaft with its masses.

All quantities are reduced to the crank: speeds and angles of the shaft are divided by its ratio, torques multiplied by
it. Locked sides then turn at the same speed.
"""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.interpolate import PPoly

from engine.elements.elastic_drives.shaft_touch import touching_moment
from engine.graph.nodes import Given
from engine.laws.loads import fluid_coupling_moment, slip_of
from engine.laws.tables import make_table
from engine.motion.coupled.two_speeds import at_two_speeds, ramp
from engine.motion.moments.dynamics import Dynamics, Reduction, Variants
from engine.motion.moments.equation_of_motion import EquationOfMotion
from engine.motion.one_speed import MachineSystem
from engine.parts.couplings import Coupling, FluidCoupling, FrictionClutch
from engine.scene.scene import Numbers, Scene
from engine.stepping.records import some


def coupling_of(scene: Scene) -> tuple[str, Coupling] | None:
    """Name and model of a scene's coupling; None without one."""
    return next(iter(scene.couplings.items()), None)


class CouplingNumbers(NamedTuple):
    """Numbers of a coupling, for a number of variants.

    Attributes
    ----------
    ratio : ndarray (variants,)
        Magnitude of the shaft's speed over the crank's.
    times : ndarray (rows, variants)
        Knots of the capacity, from the engagement on [s].
    capacity : ndarray (rows, variants)
        Capacity at the knots, reduced to the crank [N·m]; no rows for a fluid coupling.
    fluid : ndarray (variants,)
        Reduced torque of a fluid coupling over λ ω² [kg·m²].
    coefficient : PPoly or None
        λ over slip.
    """

    ratio: np.ndarray
    times: np.ndarray
    capacity: np.ndarray
    fluid: np.ndarray
    coefficient: PPoly | None

    def capacity_at(self, engaged: np.ndarray) -> np.ndarray:
        """Torque capacity of a clutch [N·m], a given time after its engagement [s]."""
        rises = zip(np.diff(self.capacity, axis=0), self.times, self.times[1:], strict=False)
        return self.capacity[0] + sum((rise * ramp(engaged, *knots) for rise, *knots in rises), np.zeros_like(engaged))

    def fluid_moment(self, crank: np.ndarray, shaft: np.ndarray) -> np.ndarray:
        """Torque of a fluid coupling on the crank [N·m], from the speeds of both sides."""
        side, fast, slip = _driving(crank, shaft)
        return side * np.sign(fast) * self.fluid * fluid_coupling_moment(self.coefficient(slip), 1.0, fast, 1.0)

    def fluid_piece(self, crank: np.ndarray, shaft: np.ndarray) -> np.ndarray:
        """Piece of the table of a fluid coupling at its slip, as in `fluid_torque`."""
        side, _, slip = _driving(crank, shaft)
        return side * (2.0 + np.searchsorted(self.coefficient.x[2:-1], slip))


def _driving(crank: np.ndarray, shaft: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Which side of a fluid coupling is faster, +1 the shaft, −1 the crank; its speed, and the slip."""
    shaft_drives = np.abs(shaft) >= np.abs(crank)
    fast, slow = np.where(shaft_drives, shaft, crank), np.where(shaft_drives, crank, shaft)
    return np.where(shaft_drives, 1.0, -1.0), fast, slip_of(fast, slow)


class ElasticNumbers(NamedTuple):
    """Numbers of an elastic shaft between both sides, (variants,): stiffness, damping, backlash."""

    stiffness: np.ndarray
    damping: np.ndarray
    backlash: np.ndarray

    @property
    def times(self) -> np.ndarray:
        """Empty: nothing about the shaft depends on time."""
        return np.zeros((0, self.stiffness.size))

    def moment(self, touch: np.ndarray, twist: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Torque of the shaft [N·m]."""
        return touching_moment(tuple(self), touch, twist, slip)


def coupling_numbers(scene: Scene, numbers: Numbers, count: int) -> CouplingNumbers:
    """Numbers of a scene's coupling.

    Parameters
    ----------
    scene : Scene
        With a coupling.
    numbers : Numbers
    count : int
        Number of variants.
    """
    name, coupling = coupling_of(scene)
    at, none = f"couplings.{name}", np.zeros((0, count))
    ratio = np.abs(numbers.of_each(f"shafts.{coupling.shaft}.ratio", count))
    if isinstance(coupling, FluidCoupling):
        table = make_table(coupling.slip, coupling.coefficient, coupling.interpolation)
        unit = fluid_coupling_moment(1.0, numbers[f"{at}.density"], ratio, numbers[f"{at}.diameter"])
        return CouplingNumbers(ratio, none, none, ratio * unit, PPoly(table.coefficients.T, table.breaks))
    full = ratio * numbers[f"{at}.capacity"]
    times, shares = _engagement(coupling, at, numbers, count)
    return CouplingNumbers(ratio, times, shares * full, np.zeros(count), None)


def _engagement(clutch: FrictionClutch, at: str, numbers: Numbers, count: int) -> tuple[np.ndarray, np.ndarray]:
    if clutch.over_time is not None:
        return tuple(np.repeat(np.array(row)[:, None], count, axis=1) for row in (clutch.over_time, clutch.share))
    if clutch.engagement is not None:
        zero, one = np.zeros(count), np.ones(count)
        return np.array([zero, numbers.of_each(f"{at}.engagement", count)]), np.array([zero, one])
    return np.zeros((1, count)), np.ones((1, count))


class ShaftSide(NamedTuple):
    """The side of the shaft; nothing on it depends on an angle or on time.

    Attributes
    ----------
    form : EquationOfMotion
        Equation of the torques on the shaft, its speed reduced to the crank.
    inertia : ndarray (variants,)
        Reduced to the crank [kg·m²].
    """

    form: EquationOfMotion
    inertia: np.ndarray


# Joining of the sides: locked, slipping forwards (the shaft is faster) or backwards, disconnected, or by a fluid.
TOGETHER, FORWARDS, BACKWARDS, APART, FLUID = 0, 1, -1, 2, 3


class Joined(NamedTuple):
    """Joining and directions of both sides during a phase of the motion; arrays (variants,).

    Attributes
    ----------
    mode : ndarray of int
        TOGETHER, FORWARDS, …
    crank_direction, shaft_direction : ndarray
        Direction of motion of each side, +1 or −1; 0 at rest.
    clock : ndarray
        Clock time of time-dependent torques at the start of the run [s].
    engaged : ndarray
        Time since the coupling was engaged, at the start of the run [s].
    touch : ndarray
        Contact of an elastic shaft: +1 forward, −1 backward, 0 none.
    """

    mode: np.ndarray
    crank_direction: np.ndarray
    shaft_direction: np.ndarray
    clock: np.ndarray
    engaged: np.ndarray
    touch: np.ndarray

    def holding(self) -> np.ndarray:
        """Indices of the clutches that hold in motion."""
        return np.flatnonzero((self.mode == TOGETHER) & (self.crank_direction != 0.0))


class CoupledSides(NamedTuple):
    """Both sides of a coupling, for a number of variants.

    Attributes
    ----------
    crank : EquationOfMotion
    shaft : ShaftSide
    coupling : CouplingNumbers or ElasticNumbers
    two : TwoSides or OnElasticShaft
    whole : tuple of (CoupledSides, ndarray of int), optional
        The sides of which these are some, and their indices.
    """

    crank: EquationOfMotion
    shaft: ShaftSide
    coupling: CouplingNumbers | ElasticNumbers
    two: "TwoSides | OnElasticShaft"
    whole: "tuple[CoupledSides, np.ndarray] | None" = None

    @property
    def count(self) -> int:
        """Number of variants."""
        return self.crank.variants.count

    @property
    def is_elastic(self) -> bool:
        """Whether the coupling is an elastic shaft."""
        return isinstance(self.coupling, ElasticNumbers)

    def some(self, who: np.ndarray) -> "CoupledSides":
        """A subset of the variants, by index."""
        shaft = ShaftSide(self.shaft.form.some(who), self.shaft.inertia[who])
        crank, coupling = self.crank.some(who), some(self.coupling, who)
        return self._replace(crank=crank, shaft=shaft, coupling=coupling, whole=(self, who))

    def numbers(self, joined: Joined) -> np.ndarray:
        """Numbers of the motion at two speeds, (numbers, variants), without those of the joining and of the ends."""
        faced = faced_directions(joined)
        found = np.empty((len(self.two.system.functions.rows), self.count))
        for direction in (1.0, -1.0):
            for other in (1.0, -1.0):
                those = (faced[0] == direction) & (faced[1] == other)
                if those.any():
                    found[:, those] = self._facing(direction, other)[:, those]
        return found

    def joining(self, joined: Joined) -> dict[Given, np.ndarray]:
        """Numbers of the joining of the sides."""
        given, slips = self.two.system.sizes.joining, np.abs(joined.mode) == FORWARDS
        return {
            given.holds: joined.mode == TOGETHER,
            given.sense: np.where(slips, joined.mode, 0),
            given.moves: joined.crank_direction != 0.0,
            given.shaft_moves: joined.shaft_direction != 0.0,
            given.piece: np.zeros(self.count),
            given.engaged: joined.clock - joined.engaged,
            given.touch: joined.touch,
        }

    def _facing(self, direction: float, other: float) -> np.ndarray:
        """The same for variants whose crank and shaft have the directions given, +1 or −1."""
        if self.whole is not None:
            whole, who = self.whole
            return whole._facing(direction, other)[:, who]
        key, kept = ("two speeds", direction, other), self.crank.variants.kept
        if key not in kept:
            system, variants = self.two.system, self.crank.variants
            sizes, joining, own = system.sizes, system.sizes.joining, self.coupling
            given = {joining.shaft_inertia: self.shaft.inertia}
            if self.is_elastic:
                given |= dict(zip((joining.stiffness, joining.damping, joining.backlash), own, strict=True))
            else:
                given |= {joining.fluid: 0.0 if self.two.open else own.fluid}
                given |= dict(zip(joining.times, own.times, strict=True))
                capacity = zip(joining.capacity, own.capacity, strict=True)
                given |= {node: 0.0 if self.two.open else row for node, row in capacity}
            given |= self.two.crank.sized(sizes.crank, variants, direction)
            given |= self.two.shaft.sized(sizes.shaft, variants, other)
            of_crank = direction * variants.direction
            kept[key] = system.tabulation.parameters(variants.numbers, of_crank, variants.ends | given)
        return kept[key]


def faced_directions(joined: Joined) -> tuple[np.ndarray, np.ndarray]:
    """Direction that each side faces, +1 or −1; standing sides face forwards."""
    return np.where(joined.crank_direction < 0.0, -1.0, 1.0), np.where(joined.shaft_direction < 0.0, -1.0, 1.0)


class OnElasticShaft:
    """Actions on both sides of an elastic shaft: loads on the machine, motors at the other end.

    Parameters
    ----------
    reduction : Reduction
    off : frozenset of str
        Inactive actions.

    Attributes
    ----------
    crank, shaft : Dynamics
    open, is_fluid, is_clutch : bool
        False, as the shaft is none of these.
    """

    open = is_fluid = is_clutch = False

    def __init__(self, reduction: Reduction, off: frozenset[str]) -> None:
        self._motors = frozenset(reduction.loads.motors)
        self._loads = frozenset(load.action for load in reduction.loads.terms)
        self.crank = Dynamics(reduction, off | self._motors)
        self.shaft = Dynamics(reduction, off | self._loads)

    @cached_property
    def system(self) -> MachineSystem:
        """Equation of motion of both sides, with its printed functions."""
        mechanics = self.crank.reduction.mechanics
        return MachineSystem(*at_two_speeds(mechanics, None, 0, self._motors, self._loads, False, False), mechanics)

    def of(self, bare: Variants, start: np.ndarray, shaft: np.ndarray, backlash: np.ndarray) -> CoupledSides:
        """Both sides of a number of variants.

        Parameters
        ----------
        bare : Variants
            Without the inertia of the motor end.
        start : ndarray (variants,)
            Crank angle at zero angle turned [rad].
        shaft : ndarray (3, variants)
            Stiffness, damping, inertia of the motor end.
        backlash : ndarray (variants,)
            [rad].
        """
        stiffness, damping, own = shaft
        motors = ShaftSide(EquationOfMotion(self.shaft, self.shaft.driven(bare), np.zeros(bare.count)), own)
        crank = EquationOfMotion(self.crank, self.crank.driven(bare), start)
        return CoupledSides(crank, motors, ElasticNumbers(stiffness, damping, backlash), self)


class TwoSides:
    """Actions on both sides of a scene's coupling in one of its regimes.

    Parameters
    ----------
    reduction : Reduction
    off : frozenset of str
        Inactive actions, and the coupling if it is open.
    works : bool
        Whether the works of useful and harmful loads, … are integrated separately.
    rubs : bool
        Whether there is friction in the pairs.

    Attributes
    ----------
    crank, shaft : Dynamics
    open : bool
        Whether the coupling is open and transmits nothing.
    is_fluid, is_clutch : bool
        Whether it is a fluid coupling or a clutch, and not open.
    """

    def __init__(self, reduction: Reduction, off: frozenset[str], works: bool, rubs: bool) -> None:
        self.scene = reduction.mechanics.scene
        self.name, self.coupling = coupling_of(self.scene)
        self.open = self.name in off
        self.is_fluid = isinstance(self.coupling, FluidCoupling) and not self.open
        self.is_clutch = isinstance(self.coupling, FrictionClutch) and not self.open
        on_shaft = {name for name, moment in self.scene.moments.items() if moment.on == self.coupling.shaft}
        elsewhere = {load.action for load in reduction.loads.terms} | set(reduction.loads.motors)
        self.crank = Dynamics(reduction, off | on_shaft, works, rubs)
        self.shaft = Dynamics(reduction, off | (elsewhere - on_shaft), works)
        self._on_shaft, self._elsewhere = frozenset(on_shaft), frozenset(elsewhere - on_shaft)

    @cached_property
    def system(self) -> MachineSystem:
        """Equation of motion of both sides, with its printed functions."""
        mechanics, coupling = self.crank.reduction.mechanics, self.coupling
        knots = 0
        if isinstance(coupling, FrictionClutch):
            knots = len(coupling.over_time) if coupling.over_time is not None else 1 + (coupling.engagement is not None)
        acting, rubs = (self._on_shaft, self._elsewhere), self.crank.rubs
        return MachineSystem(*at_two_speeds(mechanics, coupling, knots, *acting, self.crank.works, rubs), mechanics)

    def without_inertia(self, whole: Variants) -> np.ndarray:
        """Whether a side lacks inertia, (variants,) of bool."""
        sides = self.of(whole, np.zeros(whole.count))
        return self.crank.reduction.without_inertia(sides.crank.variants) | (sides.shaft.inertia <= 0.0)

    def of(self, whole: Variants, start: np.ndarray) -> CoupledSides:
        """Both sides of a number of variants.

        Parameters
        ----------
        whole : Variants
            With the inertia of everything.
        start : ndarray (variants,)
            Crank angle at zero angle turned [rad].
        """
        count, n, inertia_of_shaft = whole.count, whole.numbers, f"shafts.{self.coupling.shaft}.inertia"
        bare = n.with_values({inertia_of_shaft: np.zeros(count)})
        of_crank = self.crank.reduction.variants(bare, whole.direction, whole.flywheel)
        crank = EquationOfMotion(self.crank, self.crank.driven(of_crank), start)
        coupling = coupling_numbers(self.scene, n, count)
        inertia = coupling.ratio**2 * n.of_each(inertia_of_shaft, count)
        shaft = ShaftSide(EquationOfMotion(self.shaft, self.shaft.driven(whole), np.zeros(count)), inertia)
        return CoupledSides(crank, shaft, coupling, self)
