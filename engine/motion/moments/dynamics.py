"""A machine's equation of motion, made ready: I(φ) and M(φ, ω) of many variants, with chosen actions at work."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from engine.compiling.jit import over_variants
from engine.laws.motor_characteristics import induction_motor, induction_motor_slope
from engine.machine.model import LinearRow, Model
from engine.mechanism.actions.motors import kloss_constants, motor_ratio, stall_moment
from engine.motion.moments.breaks import Breaks, Landmarks, instants_of
from engine.motion.moments.grid import Grid, make_grid, nested_grid
from engine.motion.moments.tabulation import Ends, Sums, Tabulation
from engine.motion.steppers.energy_form import Drive, Tables
from engine.scene.actions import DCMotor
from engine.scene.scene import Numbers

# Sorts of work that are told apart where works are asked.
CHANNELS = ("driving", "useful", "harmful", "braking", "other")


class Variants(NamedTuple):
    """A set of variants, ready for motion.

    Attributes
    ----------
    numbers : Numbers
    direction : ndarray (variants,)
        +1 or −1: the way the crank turns.
    flywheel : ndarray (variants,)
        Inertia added to the machine's [kg·m²].
    parameters : ndarray (slots, variants)
        Of the rows.
    ends : mapping of slider to Ends
    breaks : Breaks
        Of all actions.
    drive : Drive or None
        The motors at work, from `Dynamics.driven`.
    kept : dict
        Grid and tables of the last stretch.
    """

    numbers: Numbers
    direction: np.ndarray
    flywheel: np.ndarray
    parameters: np.ndarray
    ends: Mapping[str, Ends]
    breaks: Breaks
    drive: Drive | None = None
    kept: dict | None = None

    @property
    def count(self) -> int:
        """How many."""
        return self.direction.size

    def some(self, chosen: np.ndarray) -> "Variants":
        """Some of them, by index, in order."""
        if chosen.size == self.count:
            return self
        drive = self.drive
        return Variants(
            self.numbers.of_variants(chosen),
            self.direction[chosen],
            self.flywheel[chosen],
            np.ascontiguousarray(self.parameters[:, chosen]),
            {name: Ends(*(part[chosen] for part in end)) for name, end in self.ends.items()},
            self.breaks.some(chosen),
            None if drive is None else Drive(*(np.ascontiguousarray(part[..., chosen]) for part in drive)),
            {},
        )


class Reduction:
    """Rows of a model in motion, made once for whatever acts: I, dI/dφ, and the moment of each action by its order."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.keys = list(dict.fromkeys((term.action, term.order) for term in model.moments.terms))
        rows = {name: model.linear[name] for name in ("reduced_inertia", "reduced_inertia_phi")}
        for action, order in self.keys:
            chosen = [t for t in model.moments.terms if (t.action, t.order) == (action, order)]
            rows[f"{action} {order}"] = LinearRow(None, tuple((t.coefficient, t.basis) for t in chosen))
        self.tabulation = Tabulation(model, rows)
        self.landmarks = Landmarks(model)

    def variants(self, numbers: Numbers, direction: np.ndarray, flywheel: np.ndarray) -> "Variants":
        """Make a set of variants ready.

        Parameters
        ----------
        numbers : Numbers
        direction : ndarray (variants,)
            +1 or −1: the way the crank turns.
        flywheel : ndarray (variants,)
            Inertia added to the machine's [kg·m²].
        """
        count = direction.size
        ends, breaks = self.landmarks(numbers, count, direction)
        parameters = self.tabulation.parameters(numbers, count, direction)
        return Variants(numbers, direction, flywheel, parameters, ends, breaks, None, {})


class Dynamics:
    """The equation of motion of a machine with some of its actions at work.

    Parameters
    ----------
    reduction : Reduction
    off : frozenset of str
        Actions, motors among them, that don't act.
    works : bool
        Whether the works of useful and harmful loads, … are told apart.
    """

    def __init__(self, reduction: Reduction, off: frozenset[str] = frozenset(), works: bool = False) -> None:
        model = reduction.model
        self.model, self.works, self.reduction = model, works, reduction
        self.channels = CHANNELS if works else ("all",)
        self.motors = tuple(name for name in model.moments.motors if name not in off)
        terms = [t for t in model.moments.terms if t.action not in off]
        self.active = frozenset(t.action for t in terms)
        laws = model.moments.laws
        self.timed = any(t.basis in laws and laws[t.basis].clock for t in terms)
        self.instants = instants_of(model, self.active)
        roles = {t.action: t.role for t in terms}
        # Of each row of the reduction that acts: its number, its channel and its order.
        self.polynomial, self.laws = [], []
        for i, (action, order) in enumerate(reduction.keys):
            if action in self.active:
                place = (i + 2, self._channel(roles[action]), order)
                (self.laws if isinstance(order, str) else self.polynomial).append(place)
        # Sums of rows: I, dI/dφ, then each channel's orders 0, 1 and 2, then power laws.
        self.target = np.full(len(reduction.tabulation.names), -1)
        self.target[:2] = 0, 1
        for row, channel, order in self.polynomial:
            self.target[row] = 2 + 3 * channel + order
        for i, (row, _, _) in enumerate(self.laws):
            self.target[row] = 2 + 3 * len(self.channels) + i
        self.cycle = 2 * np.pi * model.scene.input.revolutions

    def _channel(self, role: str | None) -> int:
        if not self.works:
            return 0
        return CHANNELS.index(role if role in CHANNELS else "other")

    @property
    def laws_channels(self) -> tuple[int, ...]:
        """Channel of each power law."""
        return tuple(channel for _, channel, _ in self.laws)

    def driven(self, variants: Variants) -> Variants:
        """The variants with the motors that are at work here."""
        drive = self._drive(variants.numbers, variants.count)
        return variants._replace(breaks=variants.breaks.of(self.active), drive=drive, kept={})

    def _drive(self, numbers: Numbers, count: int) -> Drive:
        scene, line, kloss = self.model.scene, np.zeros((2, count)), []
        for name in self.motors:
            motor, at = scene.moments[name], f"moments.{name}"
            ratio = np.abs(motor_ratio(scene, motor, numbers))
            if isinstance(motor, DCMotor):
                stall = stall_moment(motor, at, numbers)
                line[0] += ratio * stall
                line[1] -= ratio * ratio * stall / numbers[f"{at}.no_load_speed"]
            else:
                constants = (*kloss_constants(motor, at, numbers), ratio)
                kloss.append(np.array([np.broadcast_to(c, count) for c in constants]))
        exponents = [np.broadcast_to(numbers[path], count) for _, _, path in self.laws]
        return Drive(
            line, np.array(kloss).reshape(len(kloss), 5, count), np.array(exponents).reshape(len(exponents), count)
        )

    def grid(self, variants: Variants, start: np.ndarray, length: float | np.ndarray, steps: int) -> Grid:
        """Grid from a start angle, with a node at every break."""
        return make_grid(start, length, variants.direction, steps, self.cycle, variants.breaks)

    def tables(self, variants: Variants, grid: Grid) -> Tables:
        """What depends on the crank angle, at the places of a grid."""
        rows = self.rows(variants, grid.places)
        return Tables(grid.steps, rows.inertia, rows.loads, rows.powers)

    def nested(self, variants: Variants, begin: np.ndarray, steps: int, half: bool) -> tuple[np.ndarray, Tables]:
        """Nodes (angles turned) and tables of a cycle from given crank angles on, for a run.

        Parameters
        ----------
        variants : Variants
        begin : ndarray (variants,)
            [rad].
        steps : int
        half : bool
            Of half the steps instead: they are taken from the tables of all, which are kept.
        """
        key, kept = (begin.tobytes(), steps), variants.kept
        if kept.get("key") != key:
            grid = nested_grid(begin, variants.direction, steps, self.cycle, variants.breaks)
            rows = self.rows(variants, grid.places)
            kept.update(key=key, grid=grid, tables=Tables(grid.steps, rows.inertia, rows.loads, rows.powers))
        grid, tables = kept["grid"], kept["tables"]
        return grid.halved(tables) if half else (grid.nodes, tables)

    def rows(self, variants: Variants, places: np.ndarray, clock: np.ndarray | None = None) -> "Rows":
        """What depends on the crank angle (and time), at any angles of each variant.

        Parameters
        ----------
        variants : Variants
        places : ndarray (places, variants)
            Crank angles [rad].
        clock : ndarray (places, variants), optional
            Time [s].
        """
        tabulation, channels = self.reduction.tabulation, len(self.channels)
        way = np.broadcast_to(variants.direction, (len(tabulation.names), variants.count)).copy()
        way[0] = 1.0
        sums = Sums(self.target, 2 + 3 * channels + len(self.laws), way)
        out = tabulation(variants.parameters, variants.ends, places, clock, sums)
        loads, powers = out[2 : 2 + 3 * channels].reshape(channels, 3, *places.shape), out[2 + 3 * channels :]
        return Rows(out[0] + variants.flywheel, out[1], loads, powers)

    def moments(self, variants: Variants, rows: "Rows", omega: np.ndarray) -> "Moments":
        """Moments at given speeds, in the direction of motion.

        Parameters
        ----------
        variants : Variants
        rows : Rows
        omega : ndarray (places, variants)
            Speed, positive in the direction of motion [rad/s].
        """
        drive = variants.drive
        motors, slope = drive.line[0] + drive.line[1] * omega, np.broadcast_to(drive.line[1], omega.shape).copy()
        of_motors(variants.count, drive.kloss, omega, motors, slope)
        loads = rows.loads[:, 0] + omega * (rows.loads[:, 1] + omega * rows.loads[:, 2])
        slope += rows.loads[:, 1].sum(axis=0) + 2.0 * omega * rows.loads[:, 2].sum(axis=0)
        with np.errstate(all="ignore"):
            for (_, channel, _), row, exponent in zip(self.laws, rows.powers, drive.exponents, strict=True):
                moment = row * np.abs(omega) ** exponent
                loads[channel] += moment
                slope += exponent * moment / omega
        return Moments(motors, loads, slope)


class Rows(NamedTuple):
    """Reduced inertia with the flywheel, its derivative in the direction of motion, and loads as in `Tables`."""

    inertia: np.ndarray
    inertia_phi: np.ndarray
    loads: np.ndarray
    powers: np.ndarray


class Moments(NamedTuple):
    """Moment of the motors, of each channel of loads [N·m], and ∂M/∂ω of all of them [N·m·s]."""

    motors: np.ndarray
    loads: np.ndarray
    slope: np.ndarray

    @property
    def total(self) -> np.ndarray:
        """The reduced moment."""
        return self.motors + self.loads.sum(axis=0)


@over_variants
def of_motors(
    begin: int, end: int, kloss: np.ndarray, omega: np.ndarray, moment: np.ndarray, slope: np.ndarray
) -> None:
    """Add the moments of induction motors, and their slopes, at the places of variants begin … end − 1."""
    for motor in range(kloss.shape[0]):
        for j in range(omega.shape[0]):
            for v in range(begin, end):
                most, slip, rotor = kloss[motor, 0, v], kloss[motor, 1, v], kloss[motor, 2, v]
                synchronous, ratio = kloss[motor, 3, v], kloss[motor, 4, v]
                w = ratio * omega[j, v]
                moment[j, v] += ratio * induction_motor(most, slip, rotor, synchronous, w)
                slope[j, v] += ratio * ratio * induction_motor_slope(most, slip, rotor, synchronous, w)
