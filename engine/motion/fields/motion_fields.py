"""Fields of a motion: speeds, torques and powers of the machine, and the requested loads on its pairs."""

import numpy as np

from engine.motion.fields.recorded_motion import Snapshots
from engine.motion.loads import PairLoads
from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.moments.equation_of_motion import EquationOfMotion, MotionAt
from engine.motion.one_speed import CHANNELS
from engine.motion.quantities import EFFICIENCY_NOW, INSTANT, TURNED


class MotionFields:
    """Fields of machines in motion: those of the motion, and the requested loads on the pairs.

    Parameters
    ----------
    dynamics : Dynamics
    variants : Variants
        All variants of the motion, with its flywheel.
    start, clock : ndarray (variants,)
        Initial crank angle [rad] and time [s].
    loads : PairLoads or None
    """

    def __init__(
        self, dynamics: Dynamics, variants: Variants, start: np.ndarray, clock: np.ndarray, loads: PairLoads | None
    ) -> None:
        self.dynamics, self.variants, self.start, self.clock, self.loads = dynamics, variants, start, clock, loads
        self._parameters: dict[float, np.ndarray] = {}

    @property
    def cycle(self) -> float:
        """Period of the crank angle [rad]; infinite if the input does not rotate fully."""
        return self.dynamics.cycle

    def place(self, turned: np.ndarray) -> np.ndarray:
        """Crank angle within its cycle, or position of an input without one, at angles turned (…, variants)."""
        place = self.start + self.variants.direction * turned
        return np.mod(place, self.cycle) if np.isfinite(self.cycle) else place

    def __call__(self, states: Snapshots) -> dict[str, np.ndarray]:
        """All fields at states, counter-clockwise positive except the speed.

        Includes the instant, the angle turned and the torque of each channel of loads.
        """
        who, turned, omega, facing = states.who, states.turned, states.omega, states.facing
        direction, clock = self.variants.direction[who], states.time + self.clock[who]
        form = EquationOfMotion(self.dynamics, self.variants, self.start, who)
        # A torque may be infinite or NaN.
        with np.errstate(all="ignore"):
            found = form.along(turned, omega, clock, facing).known_better(states.moment)
            rows = motion_rows(direction, self.variants.flywheel[who], omega, found)
            rows["kinetic_energy"] = 0.5 * found.inertia * omega**2
            powers = found.loads * omega
            if self.dynamics.with_servos:
                energy, powers = form.with_servos(turned, omega, clock, facing)
                rows["kinetic_energy"] = energy
                rows |= {f"{name} power": row for name, row in zip(CHANNELS, powers, strict=True)}
            rows |= power_rows(found.motors * omega, powers) if self.dynamics.works else {}
        rows |= {INSTANT: states.time, TURNED: turned}
        rows |= {key: direction * row for key, row in zip(CHANNELS, found.loads, strict=True)}
        return rows | self.on_pairs(states, facing, omega, found.epsilon)

    def on_pairs(
        self, states: Snapshots, facing: np.ndarray, omega: np.ndarray, epsilon: np.ndarray
    ) -> dict[str, np.ndarray]:
        """Requested loads on the pairs at states, as these.

        Parameters
        ----------
        states : Snapshots
        facing : ndarray (columns,)
            +1 or −1: direction of each machine.
        omega, epsilon : ndarray (instants, columns)
            Speed [rad/s] and acceleration [rad/s²] in the scene's direction of motion.
        """
        if self.loads is None:
            return {}
        who, found = states.who, {name: np.empty(omega.shape) for name in self.loads.names}
        direction, wheel = self.variants.direction[who], self.loads.wheel(self.variants)[who]
        clock, places = states.time + self.clock[who], self.start[who] + direction * states.turned
        for faced in (1.0, -1.0):
            those = np.flatnonzero(facing == faced)
            if those.size:
                whole = np.ascontiguousarray(self._numbers(faced)[:, who[those]])
                at = (x[:, those] for x in (places, np.abs(omega), direction * epsilon, clock))
                for name, row in self.loads(whole, wheel[those], *at).items():
                    found[name][:, those] = row
        return found

    def _numbers(self, facing: float) -> np.ndarray:
        """Numbers of the loads of all variants, for forward or backward motion."""
        if facing not in self._parameters:
            variants = self.variants._replace(direction=facing * self.variants.direction)
            self._parameters[facing] = self.loads.parameters(variants, self.dynamics.off)
        return self._parameters[facing]


def motion_rows(direction: np.ndarray, wheel: np.ndarray, omega: np.ndarray, found: MotionAt) -> dict[str, np.ndarray]:
    """Fields of the motion itself, counter-clockwise positive except the speed, each (instants, columns).

    Parameters
    ----------
    direction, wheel : ndarray (columns,)
        +1 or −1, the scene's direction of motion, and the inertia of the flywheel [kg·m²].
    omega : ndarray (instants, columns)
        Speed in that direction [rad/s].
    found : MotionAt
        The motion at these speeds.
    """
    return {
        "speed": omega,
        "acceleration": found.epsilon * direction,
        "motor_moment": found.motors * direction,
        "load_moment": found.loads.sum(axis=0) * direction,
        "input_moment": (found.motors - wheel * found.epsilon) * direction,
    }


def power_rows(motors: np.ndarray, loads: np.ndarray, heat: np.ndarray | float = 0.0) -> dict[str, np.ndarray]:
    """Powers, and the instantaneous efficiency η = 1 − P_lost/P_in.

    The input power is the sum of all positive powers: of motors, driving actions, springs and weights, and of the
    kinetic energy, whose rate of decrease is the deficit of all powers, dE/dt = ΣP. Power that is not lost leaves the
    machine or is stored in it, so 0 ≤ η ≤ 1; without storage η is useful power over driving power.

    Parameters
    ----------
    motors : ndarray (instants, variants)
        Power of the motors [W].
    loads : ndarray (channels, instants, variants)
        Powers of all loads, by `CHANNELS`; negative for resistances [W].
    heat : ndarray (instants, variants)
        Power dissipated in a coupling, negative [W].
    """
    driving, useful, harmful, braking, other = loads
    lost = np.maximum(-harmful, 0.0) + np.maximum(-braking, 0.0) - heat
    released = -(motors + loads.sum(axis=0) + heat)
    put_in = sum(np.maximum(power, 0.0) for power in (motors, *loads, released))
    with np.errstate(all="ignore"):
        efficiency = 1.0 - lost / put_in
    return {
        "motors_power": motors,
        "driving_power": driving,
        "useful_power": 0.0 - useful,
        "harmful_power": 0.0 - harmful,
        "braking_power": 0.0 - braking,
        "other_power": other,
        EFFICIENCY_NOW: efficiency,
    }
