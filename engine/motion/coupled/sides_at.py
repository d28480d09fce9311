"""Both sides of a coupling in given states: their torques, and how these join and move them."""

from typing import NamedTuple

import numpy as np

from engine.elements.elastic_drives.shaft_touch import touch_turns
from engine.motion.coupled.two_sides import APART, FLUID, TOGETHER, CoupledSides, Joined, faced_directions
from engine.motion.coupled.two_speeds import CRANK_SPEED, GRIP, SHAFT_SPEED
from engine.motion.moments.equation_of_motion import MotionAt
from engine.motion.one_speed import CHANNELS
from engine.stepping.records import some


class Pull(NamedTuple):
    """Torques and accelerations of both sides at some instants, each (instants, variants).

    Attributes
    ----------
    moment : ndarray
        Torque of the coupling on the crank [N·m]; for locked sides the torque required.
    crank, shaft : MotionAt
        Both with the inertia of the crank.
    """

    moment: np.ndarray
    crank: MotionAt
    shaft: MotionAt


class SidesAt(NamedTuple):
    """Both sides of a coupling in given states.

    Attributes
    ----------
    sides : CoupledSides
    joined : Joined
    moving : ndarray (4, …, variants)
        Angle and speed of the crank, and of the shaft.
    time : ndarray (…, variants)
        From the start of the run [s].
    """

    sides: CoupledSides
    joined: Joined
    moving: np.ndarray
    time: np.ndarray

    def some(self, chosen: np.ndarray) -> "SidesAt":
        """A subset of the last axis, by index, where the numbers of the coupling have that axis, too."""
        sides = self.sides._replace(coupling=some(self.sides.coupling, chosen))
        return SidesAt(sides, some(self.joined, chosen), self.moving[..., chosen], self.time[..., chosen])

    def pull(self, moves: bool = True, **joined: np.ndarray) -> Pull:
        """Torques and accelerations of both sides.

        Parameters
        ----------
        moves : bool
            Whether the torques accelerate the sides.
        **joined : ndarray
            What differs in the joining.
        """
        sides, joining = self.sides, self.joined._replace(**joined)
        system, (turned, w1, other, w2), faced = sides.two.system, self.moving, faced_directions(joining)
        held = {} if moves else dict.fromkeys((system.sizes.joining.moves, system.sizes.joining.shaft_moves), 0.0)
        numbers = system.limited(sides.numbers(joining), sides.joining(joining) | held)
        places = sides.crank.start + sides.crank.variants.direction * turned
        names = ["inertia", "acceleration", "motors", *CHANNELS]
        wanted = [system.rows_of[f"{side} {name}"] for side in ("crank", "shaft") for name in names]
        wanted.append(system.rows_of["coupling"])
        states = turned, faced[0] * w1, other, faced[1] * w2
        *found, moment = system.at(numbers, places, states, wanted, joining.clock + self.time)
        crank, shaft = (
            MotionAt(inertia, direction * epsilon, direction * motors, direction * np.array(loads))
            for direction, (inertia, epsilon, motors, *loads) in zip(
                faced, (found[: len(names)], found[len(names) :]), strict=True
            )
        )
        return Pull(moment, crank, shaft)

    def apart_moment(self) -> np.ndarray:
        """Torque of a coupling on the crank if it isn't locked [N·m]."""
        (_, crank, twist, shaft), two, coupling = self.moving, self.sides.two, self.sides.coupling
        if self.sides.is_elastic:
            return coupling.moment(self.joined.touch, twist, shaft - crank)
        if two.is_fluid:
            return coupling.fluid_moment(crank, shaft)
        if two.open:
            return np.zeros_like(self.time)
        return self.joined.mode * coupling.capacity_at(self.joined.engaged + self.time)

    def grip(self) -> np.ndarray:
        """Torque capacity of a locked clutch [N·m]."""
        return self.sides.coupling.capacity_at(self.joined.engaged + self.time) * (1.0 + GRIP)

    def starting(self) -> tuple[np.ndarray, np.ndarray]:
        """Torques that would start the crank and the shaft, each alone, (2, variants): forwards and backwards."""
        forth = np.ones(self.time.size)
        # These torques only decide about sides at rest.
        pulls = [self.pull(moves=False, crank_direction=one, shaft_direction=one) for one in (forth, -forth)]
        return np.array([pull.crank.total for pull in pulls]), np.array([pull.shaft.total for pull in pulls])

    def stays(self) -> np.ndarray:
        """Whether a standing crank stays at rest without the coupling."""
        return _set_off(self.starting()[0]) == 0.0

    def joining(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """How the sides are joined, and the direction of each: of its motion, or of its start from rest."""
        directions, (on_crank, on_shaft) = np.sign(self.moving[[CRANK_SPEED, SHAFT_SPEED]]), self.starting()
        mode = np.full(self.time.size, APART if self.sides.two.open else FLUID)
        if self.sides.two.is_clutch:
            mode = self._holding(directions, on_crank, on_shaft)
        moment, holds = self.pull(mode=mode).moment, mode == TOGETHER
        crank = np.where(holds, _set_off(on_crank + on_shaft), _set_off(on_crank + moment))
        shaft = np.where(holds, crank, _set_off(on_shaft - moment))
        return mode, *np.where(directions == 0.0, [crank, shaft], directions)

    def _holding(self, directions: np.ndarray, on_crank: np.ndarray, on_shaft: np.ndarray) -> np.ndarray:
        """Joining of clutches: locked, or the direction of slip."""
        slip = np.sign(self.moving[SHAFT_SPEED] - self.moving[CRANK_SPEED]).astype(int)
        standing, capacity = (directions == 0.0).all(axis=0), self.grip()
        held = np.array([capacity, -capacity])
        off = np.where(standing, _set_off(on_crank + on_shaft), directions[0])
        together = {"mode": np.full(slip.size, TOGETHER), "crank_direction": off, "shaft_direction": off}
        needed = self.pull(**together).moment
        # Where both are at rest, either side may be held by its own resistance.
        alone = _set_off(on_shaft - held)
        alone = np.where(alone == 0.0, -_set_off(on_crank - held), alone)
        torn = np.where(np.abs(needed) > capacity, np.sign(needed), 0.0)
        return np.where(slip != 0, slip, np.where(standing & (off == 0.0), alone, torn)).astype(int)

    def first_pace(self) -> np.ndarray:
        """Length of the first trial step [s]."""
        found, (_, crank_speed, _, shaft_speed) = self.pull(), self.moving
        crank, shaft = found.crank.epsilon, found.shaft.epsilon
        speed = np.maximum(np.abs(crank_speed), np.abs(shaft_speed))
        change = np.maximum(np.abs(crank), np.abs(shaft))
        # A hundredth of the time per radian.
        first = 0.01 / np.maximum(speed, np.sqrt(change))
        if not self.sides.is_elastic:
            return first
        # Within a backlash, a quarter of the time it takes to cross it, at most.
        gap, rise = self.sides.coupling.backlash, np.abs(shaft - crank)
        crossing = gap / (np.abs(shaft_speed - crank_speed) + np.sqrt(gap * rise))
        return np.where(self.joined.touch == 0.0, np.minimum(first, 0.25 * crossing), first)

    def growing(self) -> np.ndarray:
        """Sign of the rate of an elastic shaft's torque, or of its twist if out of contact."""
        found, slip = self.pull(), self.moving[SHAFT_SPEED] - self.moving[CRANK_SPEED]
        change = found.shaft.epsilon - found.crank.epsilon
        rate = touch_turns(tuple(self.sides.coupling), self.joined.touch, slip, change)
        return np.sign(np.where(rate == 0.0, change, rate))


def _set_off(torques: np.ndarray) -> np.ndarray:
    """Direction in which torques forwards and backwards, (2, variants), set off what stands: +1, −1, or 0."""
    forth, back = torques
    return np.where(forth > 0.0, 1.0, np.where(back < 0.0, -1.0, 0.0))
