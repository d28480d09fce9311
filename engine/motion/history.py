"""The history of one machine through its regimes: angle, speed, moments and energy, instant by instant."""

from typing import NamedTuple

import numpy as np

from engine.mechanism.mechanics import Mechanics
from engine.motion.coupled.coupled_answers import CoupledStanding
from engine.motion.coupled.two_sides import CoupledSides
from engine.motion.moments.dynamics import CHANNELS, Dynamics, Variants
from engine.motion.regimes_in_order import Schedule, Standing
from engine.motion.settled.steady import steady_motion
from engine.motion.steppers.energy_form import NODES
from engine.scene.regimes import RunRegime
from engine.scene.scene import Numbers, Scene, scene_numbers
from engine.verdicts import Verdict

# What power comes from, and goes to.
SOURCES = ("motors", *CHANNELS, "coupling")


class History(NamedTuple):
    """What a machine does in its regimes; arrays (instants,).

    Attributes
    ----------
    regime : ndarray of str
        Name of the regime of each instant.
    time : ndarray
        Since the first regime began [s]; a steady regime is shown for one cycle.
    angle : ndarray
        Crank angle [rad], going on beyond a turn.
    speed, acceleration : ndarray
        Of the crank [rad/s, rad/s²], counter-clockwise positive.
    motor_moment : ndarray
        Of the motors, reduced to the crank [N·m].
    load_moments : dict of str to ndarray
        By the sort of work: "driving", "useful", "harmful", "braking", "other" [N·m].
    energy : ndarray
        Kinetic energy [J].
    powers : dict of str to ndarray
        Of the "motors", by the sort of work as `load_moments`, and of the "coupling", whose heat it is [W].
    shaft_speed, coupling_moment : ndarray
        Of a shaft behind a coupling, at its own speed [rad/s], and what the coupling transmits to the crank, reduced to
        it [N·m]; NaN where a machine has no coupling, and the moment where it is in steady motion.
    verdict : Verdict
        Where it isn't OK, the history ends where the motion did.
    """

    regime: np.ndarray
    time: np.ndarray
    angle: np.ndarray
    speed: np.ndarray
    acceleration: np.ndarray
    motor_moment: np.ndarray
    load_moments: dict[str, np.ndarray]
    energy: np.ndarray
    powers: dict[str, np.ndarray]
    shaft_speed: np.ndarray
    coupling_moment: np.ndarray
    verdict: Verdict


def history(scene: Scene, steps: int = 360) -> History:
    """Go through the regimes of a scene.

    Parameters
    ----------
    scene : Scene
        With at least one regime.
    steps : int
        Steps a cycle; even.

    Raises
    ------
    ValueError
        The scene has no regimes.
    """
    if not scene.regimes:
        raise ValueError("regimes: the scene has none; add [regimes.NAME] with type = 'run' or 'steady'")
    schedule = Schedule(Mechanics(scene), {f"{name}.useful_work" for name in scene.regimes}, steps)
    every = schedule.variants(Numbers(scene_numbers(scene), {}), 1)
    zero = np.zeros(1)
    standing = Standing(zero, zero, zero, np.full(1, Verdict.OK, np.uint8))
    parts: list[_Part] = []
    begun = 0.0
    for name in schedule.needed:
        dynamics = schedule.dynamics[frozenset(scene.regimes[name].off)]
        variants = dynamics.driven(every)
        hindered, sides = schedule.hindered(name, dynamics, variants), None
        if hindered.any():
            parts.append(_Part(name, np.array([[begun], standing.angle, standing.omega]), dynamics, variants))
            standing = standing._replace(verdict=hindered)
            break
        if isinstance(scene.regimes[name], RunRegime):
            angle = scene.regimes[name].from_angle
            start = standing.angle[0] if angle is None else angle
            if schedule.sides:
                gone, standing = schedule.run_at_two_speeds(name, variants, standing, record=True)
                sides = schedule.sides[frozenset(scene.regimes[name].off)].of(variants, np.full(1, start))
                time, turned, omega, *shaft = gone.history
                own = np.array([time + begun, start + variants.direction * turned, omega])
                parts.append(_Part(name, own, dynamics, variants, sides, np.array(shaft)))
                begun += time[-1]
                if standing.verdict[0] != Verdict.OK:
                    break
                continue
            outcome, standing = schedule.run(name, dynamics, variants, standing, record=True)
            time, turned, omega = outcome.history
        else:
            start, (time, turned, omega), standing = 0.0, *_one_cycle(dynamics, variants, steps, schedule.tolerance)
            if schedule.sides:
                sides = schedule.sides[frozenset(scene.regimes[name].off)].of(variants, zero)
                standing = standing._replace(coupled=CoupledStanding(standing.omega, np.full(1, np.inf)))
        own = np.array([time + begun, start + variants.direction * turned, omega])
        parts.append(_Part(name, own, dynamics, variants, sides))
        begun += time[-1]
        if standing.verdict[0] != Verdict.OK:
            break
    return _gathered(parts, Verdict(int(standing.verdict[0])))


class _Part(NamedTuple):
    """One regime: time, crank angle and speed by instants, and what acts; of a coupling its sides, speed and moment."""

    name: str
    course: np.ndarray
    dynamics: Dynamics
    variants: Variants
    sides: CoupledSides | None = None
    shaft: np.ndarray | None = None


def _one_cycle(dynamics: Dynamics, variants: Variants, steps: int, tolerance: float) -> tuple[np.ndarray, Standing]:
    zero = np.zeros(1)
    places = dynamics.grid(variants, zero, dynamics.cycle, steps).places[NODES]
    steady = steady_motion(dynamics, variants, tolerance, variants.direction * places)[0]
    energy, time, _ = steady.record
    omega = np.sqrt(2.0 * energy / dynamics.rows(variants, places).inertia)
    turned = variants.direction * places
    return np.array([time[:, 0], turned[:, 0], omega[:, 0]]), Standing(zero, omega[0], zero, steady.verdict)


def _gathered(parts: list[_Part], verdict: Verdict) -> History:
    columns: dict[str, list[np.ndarray]] = {}

    def add(key: str, values: np.ndarray) -> None:
        columns.setdefault(key, []).append(values)

    for name, (time, angle, omega), dynamics, variants, sides, shaft in parts:
        way, none = variants.direction[0], np.full(time.size, np.nan)
        rows = dynamics.rows(variants, angle[:, None], time[:, None])
        moments = dynamics.moments(variants, rows, omega[:, None])
        energy, speed, transmitted = 0.5 * rows.inertia[:, 0] * omega**2, none, none
        own, of_loads, total = moments.motors[:, 0], moments.loads[:, :, 0], moments.total[:, 0]
        slope, inertia = rows.inertia_phi[:, 0], rows.inertia[:, 0]
        with np.errstate(all="ignore"):
            powers, heat = np.concatenate((own[None], of_loads)) * omega, np.zeros_like(omega)
        if sides is not None and shaft is None:
            speed = sides.coupling.ratio * omega
        elif sides is not None:
            rows = sides.crank.dynamics.rows(sides.crank.variants, angle[:, None], time[:, None])
            of_crank = sides.crank.dynamics.moments(sides.crank.variants, rows, omega[:, None])
            of_shaft = sides.shaft.dynamics.moments(sides.shaft.variants, sides.shaft.forwards, shaft[0][:, None])
            both = [np.concatenate((m.motors[None], m.loads))[:, :, 0] for m in (of_crank, of_shaft)]
            own, of_loads = both[0][0] + both[1][0], both[0][1:] + both[1][1:]
            powers, heat = both[0] * omega + both[1] * shaft[0], shaft[1] * (omega - shaft[0])
            inertia, total = rows.inertia[:, 0], of_crank.total[:, 0] + shaft[1]
            energy = 0.5 * inertia * omega**2 + 0.5 * sides.shaft.inertia * shaft[0] ** 2
            speed, transmitted = sides.coupling.ratio * shaft[0], way * shaft[1]
        with np.errstate(all="ignore"):
            epsilon = (total - 0.5 * omega**2 * slope) / inertia
        add("regime", np.full(time.size, name))
        add("time", time)
        add("angle", angle)
        add("speed", way * omega)
        add("acceleration", way * epsilon)
        add("motor_moment", way * own)
        add("energy", energy)
        add("shaft_speed", speed)
        add("coupling_moment", transmitted)
        for channel, moment in zip(CHANNELS, of_loads, strict=True):
            add(channel, way * moment)
        for source, power in zip(SOURCES, (*powers, heat), strict=True):
            add(f"{source} power", power)
    whole = {key: np.concatenate(values) for key, values in columns.items()}
    loads = {channel: whole.pop(channel) for channel in CHANNELS}
    powers = {source: whole.pop(f"{source} power") for source in SOURCES}
    return History(load_moments=loads, powers=powers, verdict=verdict, **whole)
