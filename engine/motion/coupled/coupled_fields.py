"""Fields along runs at two speeds: those of the motion of both sides, and loads on the crank's pairs."""

from typing import NamedTuple

import numpy as np

from engine.motion.coupled.sides_at import SidesAt
from engine.motion.coupled.two_sides import TOGETHER, CoupledSides, Joined, TwoSides, faced_directions
from engine.motion.coupled.two_speeds import CRANK_SPEED, SHAFT_SPEED, TURNED
from engine.motion.fields.motion_fields import MotionFields, motion_rows, power_rows
from engine.motion.fields.recorded_motion import TIME, Snapshots, inward, turn_inwards
from engine.motion.loads import WITH_FLYWHEEL, PairLoads
from engine.motion.one_speed import CHANNELS
from engine.motion.quantities import INSTANT
from engine.motion.quantities import TURNED as ANGLE
from engine.stepping.recorded import weighted, weights_at
from engine.stepping.records import some

# Torque that a clutch transmits at its own shaft where it holds [N·m].
HELD = "held"


class CoupledSnapshots(NamedTuple):
    """States of machines at two speeds at instants, (instants, columns) unless stated.

    Attributes
    ----------
    who : ndarray (columns,) of int
        Variants.
    time : ndarray
        From the start of the run [s].
    moving : ndarray (4, instants, columns)
        Angle and speed of the crank, and of the shaft or the twist of an elastic one.
    moment : ndarray
        Torque of the coupling on the crank [N·m].
    joined : Joined
    """

    who: np.ndarray
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
    def facing(self) -> np.ndarray:
        """+1 or −1: direction of the crank, (columns,)."""
        return faced_directions(self.joined)[0]


class CoupledMotion:
    """Recorded steps of runs at two speeds.

    Parameters
    ----------
    sides : CoupledSides
        Both sides, for all variants of the runs.
    who : ndarray (steps,) of int
        Variants, ascending.
    joined : Joined
        (steps,) each.
    samples : ndarray (6, RECORDED_AT, steps)
        Time, angles and speeds of both sides, and torque of the coupling, as in `CoupledSnapshots`.
    """

    over_angle = False

    def __init__(self, sides: CoupledSides, who: np.ndarray, joined: Joined, samples: np.ndarray) -> None:
        self.who, self.samples, self._sides, self._joined = who, samples, sides, joined

    def at(self, step: np.ndarray, share: np.ndarray) -> CoupledSnapshots:
        """States at fractions (instants, columns) of the length of steps (columns,)."""
        time, *moving, moment = weighted(weights_at(share), self.samples[..., step])
        states = CoupledSnapshots(self.who[step], time, np.array(moving), moment, some(self._joined, step))
        inwards = states.joined.crank_direction * inward(share, self.samples[1 + TURNED][:, step])
        turn_inwards(states.turned, inwards, self._sides.crank.of(states.who))
        return states

    def durations(self, step: np.ndarray, states: CoupledSnapshots) -> np.ndarray:
        """Time per fraction of the steps [s], as the states."""
        time = self.samples[TIME]
        return np.broadcast_to((time[-1] - time[0])[step], states.time.shape)


class CoupledFields(MotionFields):
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
        super().__init__(crank.dynamics, crank.variants, crank.start, clock, loads)
        self.sides = sides

    def __call__(self, states: CoupledSnapshots) -> dict[str, np.ndarray]:
        """All fields at states, as for runs at one speed.

        Adds the speed of the shaft, the torque of the coupling, and the power of each channel.
        """
        sides, (_, time, moving, _, joined) = self.sides.some(states.who), states
        own, (omega, shaft_omega) = sides.crank.variants, moving[[CRANK_SPEED, SHAFT_SPEED]]
        direction = own.direction
        with np.errstate(all="ignore"):
            pull = SidesAt(sides, joined, moving, time).pull()
            on_crank, on_shaft = pull.crank, pull.shaft
            loads, motors = on_crank.loads + on_shaft.loads, on_crank.motors + on_shaft.motors
            rows = motion_rows(direction, own.flywheel, omega, on_crank._replace(motors=motors, loads=loads))
            power = on_crank.motors * omega + on_shaft.motors * shaft_omega
            powers = on_crank.loads * omega + on_shaft.loads * shaft_omega
            heat = pull.moment * (omega - shaft_omega)
            if self.dynamics.works:
                rows |= power_rows(power, powers, heat)
        # The crank is driven by its own motors and the coupling.
        rows["input_moment"] = (on_crank.motors + pull.moment - own.flywheel * on_crank.epsilon) * direction
        energy = on_crank.inertia * omega**2 + sides.shaft.inertia * shaft_omega**2
        rows |= {"kinetic_energy": 0.5 * energy, INSTANT: time, ANGLE: moving[TURNED]}
        rows |= {"shaft_speed": sides.coupling.ratio * shaft_omega, "coupling_moment": direction * pull.moment}
        rows |= {key: direction * row for key, row in zip(CHANNELS, loads, strict=True)}
        sources = zip(("motors", *CHANNELS, "coupling"), (power, *powers, heat), strict=True)
        rows |= {f"{source} power": row for source, row in sources}
        found = self.on_pairs(states, states.facing, omega, on_crank.epsilon)
        for name in WITH_FLYWHEEL:
            if name in found:
                # Like a flywheel, the shaft's inertia loads the frame.
                ratio = own.numbers[f"shafts.{sides.two.coupling.shaft}.ratio"]
                found[name] = found[name] - sides.shaft.inertia / ratio * direction * on_shaft.epsilon
        return rows | found


class HeldFields(MotionFields):
    """Fields in steady running with a clutch that holds; the torque that it transmits among them.

    Parameters
    ----------
    two : TwoSides
    others : object
        As for `MotionFields`, the dynamics those of both sides together.
    """

    def __init__(self, two: TwoSides, *others: object) -> None:
        super().__init__(*others)
        self._sides = two.of(self.variants, self.start)

    def __call__(self, states: Snapshots) -> dict[str, np.ndarray]:
        """All fields at states."""
        sides, forward = self._sides.some(states.who), np.ones(states.who.size)
        still = np.zeros_like(states.omega)
        joined = Joined(np.full(forward.size, TOGETHER), forward, forward, still[0], still[0], forward)
        moving = np.array([states.turned, states.omega, still, states.omega])
        pull = SidesAt(sides, joined, moving, still).pull()
        return super().__call__(states) | {HELD: pull.moment / sides.coupling.ratio}
