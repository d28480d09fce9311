"""Fields along runs at two speeds: those of the motion of both sides, and loads on the crank's pairs."""

from typing import NamedTuple

import numpy as np

from engine.cycle.regula_falsi import regula_falsi
from engine.motion.coupled.two_sides import CoupledSides, Joined, coupling_pull, faced_ways
from engine.motion.coupled.two_speeds import CRANK_SPEED, SHAFT_SPEED, SHAFT_TURNED, TURNED
from engine.motion.loads import WITH_FLYWHEEL, PairLoads
from engine.motion.quantities import INSTANT
from engine.motion.quantities import TURNED as ANGLE
from engine.motion.runs.watching import RunFields
from engine.motion.settled.cycle import motion_rows, power_rows
from engine.stepping.records import some
from engine.stepping.system import SHOWN

STATES = (TURNED, CRANK_SPEED, SHAFT_TURNED, SHAFT_SPEED)
# Of the polynomials in which steps are recorded.
DEGREE = SHOWN.size - 1


class CoupledPiece(NamedTuple):
    """A segment of the motion of some variants during which the joining doesn't change; arrays (nodes, variants).

    Shorter runs repeat their last node.

    Attributes
    ----------
    time : ndarray
        From the start of the run [s].
    moving : ndarray (4, nodes, variants)
        Angle and speed of the crank, and of the shaft or the twist of an elastic one.
    moment : ndarray
        Torque of the coupling on the crank [N·m].
    joined : Joined
    """

    time: np.ndarray
    moving: np.ndarray
    moment: np.ndarray
    joined: Joined

    @property
    def turned(self) -> np.ndarray:
        """Angle turned by the crank [rad]."""
        return self.moving[TURNED]

    @property
    def omega(self) -> np.ndarray:
        """Speed of the crank [rad/s]."""
        return self.moving[CRANK_SPEED]

    @property
    def steps(self) -> np.ndarray:
        """Spacing of the nodes, 0 where two steps meet [s]."""
        return np.diff(self.time, axis=0)

    @property
    def held(self) -> Joined:
        """What is the same for the whole segment."""
        return self.joined


class CycleStates:
    """Stores the states along a cycle of variants whose joining doesn't change, and evaluates them at crank angles.

    Parameters
    ----------
    count : int
        Number of variants.
    looks : int
        Equally spaced nodes of each step, including its ends; more than the degree of the recorded polynomial.
    """

    def __init__(self, count: int, looks: int) -> None:
        self._looks = looks
        self._seen: list[list[np.ndarray]] = [[] for _ in range(count)]
        self._joined: Joined | None = None

    def see(self, who: np.ndarray, piece: CoupledPiece) -> None:
        """Store a segment."""
        if self._joined is None:
            self._joined = piece.joined
        along = np.array([piece.time, *piece.moving])
        lengths = np.diff(piece.time, axis=0)
        nodes = along.shape[1] - np.argmax(lengths[::-1] > 0.0, axis=0)
        for column, variant in enumerate(who):
            # Shorter runs repeat their last node.
            own = along[:, : nodes[column], column]
            self._seen[variant].append(own.reshape(len(own), -1, self._looks))

    def at(self, turned: np.ndarray) -> CoupledPiece:
        """States at angles turned, (angles, variants)."""
        count = turned.shape[1]
        found = np.empty((1 + len(STATES), *turned.shape))
        for variant, seen in enumerate(self._seen):
            found[:, :, variant] = _read(np.concatenate(seen, axis=1), turned[:, variant])
        joined = some(self._joined, np.zeros(count, int))
        return CoupledPiece(found[0], found[1:], np.full_like(found[0], np.nan), joined)


def _read(steps: np.ndarray, turned: np.ndarray) -> np.ndarray:
    """Time and states, (rows, angles), at angles turned, from steps sampled at nodes, (rows, steps, nodes)."""
    nodes = np.linspace(-1.0, 1.0, steps.shape[2])
    of = np.clip(np.searchsorted(steps[1 + TURNED, :, 0], turned, side="right") - 1, 0, steps.shape[1] - 1)
    fitted = np.polynomial.polynomial.polyfit(nodes, steps.reshape(-1, nodes.size).T, DEGREE)
    own = fitted.reshape(-1, *steps.shape[:2])[:, :, of]

    def ahead(share: np.ndarray) -> np.ndarray:
        return np.polynomial.polynomial.polyval(share, own[:, 1 + TURNED], tensor=False) - turned

    share = regula_falsi(ahead, -np.ones_like(turned), np.ones_like(turned))
    return np.polynomial.polynomial.polyval(share, own, tensor=False)


def _inward(time: np.ndarray) -> np.ndarray:
    """Direction into the step from each node, +1 at its start and −1 at its end, where torques may jump."""
    meet = np.diff(time, axis=0) == 0.0
    edge = np.ones((1, time.shape[1]), bool)
    begins, ends = np.concatenate((edge, meet)), np.concatenate((meet, edge))
    return np.where(ends, -1.0, np.where(begins, 1.0, 0.0))


class CoupledFields(RunFields):
    """Fields along runs at two speeds.

    Parameters
    ----------
    sides : CoupledSides
    clock : ndarray (variants,)
        Time at the start [s].
    loads : PairLoads or None
    """

    def __init__(self, sides: CoupledSides, clock: np.ndarray, loads: PairLoads | None) -> None:
        crank = sides.crank
        super().__init__(crank.dynamics, crank.variants, crank.start, clock, loads, crank.dynamics.off)
        self.sides = sides

    def __call__(self, who: np.ndarray, piece: CoupledPiece) -> dict[str, np.ndarray]:
        """All fields in a segment of some variants' motion, as for runs at one speed.

        Adds the speed of the shaft, the torque of the coupling, and the power of each channel.
        """
        sides, (time, moving, _, joined) = self.sides.some(who), piece
        moving = moving.copy()
        moving[TURNED] += joined.crank_way * _inward(time) * sides.crank.beside(moving[TURNED])
        own, (omega, shaft_omega) = sides.crank.variants, moving[[CRANK_SPEED, SHAFT_SPEED]]
        way, facing = own.direction, faced_ways(joined)[0]
        with np.errstate(all="ignore"):
            pull = coupling_pull(sides, joined, moving, time)
            on_crank, on_shaft = pull.crank, pull.shaft
            loads, motors = on_crank.loads + on_shaft.loads, on_crank.motors + on_shaft.motors
            rows = motion_rows(own, omega, on_crank.epsilon, motors, loads)
            power = on_crank.motors * omega + on_shaft.motors * shaft_omega
            powers = on_crank.loads * omega + on_shaft.loads * shaft_omega
            heat = pull.moment * (omega - shaft_omega)
            if self.dynamics.works:
                rows |= power_rows(power, powers, heat)
        # The crank is driven by its own motors and the coupling.
        rows["input_moment"] = (on_crank.motors + pull.moment - own.flywheel * on_crank.epsilon) * way
        energy = on_crank.inertia * omega**2 + sides.shaft.inertia * shaft_omega**2
        rows |= {"kinetic_energy": 0.5 * energy, INSTANT: time, ANGLE: moving[TURNED]}
        rows |= {"shaft_speed": sides.coupling.ratio * shaft_omega, "coupling_moment": way * pull.moment}
        rows |= {key: way * row for key, row in zip(self.dynamics.channels, loads, strict=True)}
        sources = zip(("motors", *self.dynamics.channels, "coupling"), (power, *powers, heat), strict=True)
        rows |= {f"{source} power": row for source, row in sources}
        clock = time + self.clock[who]
        found = self.on_pairs(who, facing, self.start[who] + way * moving[TURNED], omega, on_crank.epsilon, clock)
        for name in WITH_FLYWHEEL:
            if name in found:
                # Like a flywheel, the shaft's inertia loads the frame.
                ratio = own.numbers[f"shafts.{sides.two.coupling.shaft}.ratio"]
                found[name] = found[name] - sides.shaft.inertia / ratio * way * on_shaft.epsilon
        return rows | found
