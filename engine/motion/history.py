"""The history of one machine through its regimes: angle, speed, moments and energy, instant by instant."""

from typing import NamedTuple

import numpy as np

from engine.mechanism.mechanics import Mechanics
from engine.motion.moments.dynamics import CHANNELS, Dynamics, Variants
from engine.motion.regimes_in_order import Schedule, Standing
from engine.motion.settled.steady import steady_motion
from engine.motion.steppers.energy_form import NODES
from engine.scene.regimes import RunRegime
from engine.scene.scene import Numbers, Scene, scene_numbers
from engine.verdicts import Verdict


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
    parts: list[tuple[str, np.ndarray, Dynamics, Variants]] = []
    begun = 0.0
    for name in schedule.needed:
        dynamics = schedule.dynamics[frozenset(scene.regimes[name].off)]
        variants = dynamics.driven(every)
        hindered = schedule.hindered(name, dynamics, variants)
        if hindered.any():
            parts.append((name, np.array([[begun], standing.angle, standing.omega]), dynamics, variants))
            standing = standing._replace(verdict=hindered)
            break
        if isinstance(scene.regimes[name], RunRegime):
            angle = scene.regimes[name].from_angle
            start = standing.angle[0] if angle is None else angle
            outcome, standing = schedule.run(name, dynamics, variants, standing, record=True)
            time, turned, omega = outcome.history
        else:
            start, (time, turned, omega), standing = 0.0, *_one_cycle(dynamics, variants, steps, schedule.tolerance)
        parts.append((name, np.array([time + begun, start + variants.direction * turned, omega]), dynamics, variants))
        begun += time[-1]
        if standing.verdict[0] != Verdict.OK:
            break
    return _gathered(parts, Verdict(int(standing.verdict[0])))


def _one_cycle(dynamics: Dynamics, variants: Variants, steps: int, tolerance: float) -> tuple[np.ndarray, Standing]:
    zero = np.zeros(1)
    places = dynamics.grid(variants, zero, dynamics.cycle, steps).places[NODES]
    steady = steady_motion(dynamics, variants, tolerance, variants.direction * places)[0]
    energy, time, _ = steady.record
    omega = np.sqrt(2.0 * energy / dynamics.rows(variants, places).inertia)
    turned = variants.direction * places
    return np.array([time[:, 0], turned[:, 0], omega[:, 0]]), Standing(zero, omega[0], zero, steady.verdict)


def _gathered(parts: list[tuple[str, np.ndarray, Dynamics, Variants]], verdict: Verdict) -> History:
    columns: dict[str, list[np.ndarray]] = {}

    def add(key: str, values: np.ndarray) -> None:
        columns.setdefault(key, []).append(values)

    for name, (time, angle, omega), dynamics, variants in parts:
        way = variants.direction[0]
        rows = dynamics.rows(variants, angle[:, None], time[:, None])
        moments = dynamics.moments(variants, rows, omega[:, None])
        slope = rows.inertia_phi[:, 0]
        with np.errstate(all="ignore"):
            epsilon = (moments.total[:, 0] - 0.5 * omega**2 * slope) / rows.inertia[:, 0]
        add("regime", np.full(time.size, name))
        add("time", time)
        add("angle", angle)
        add("speed", way * omega)
        add("acceleration", way * epsilon)
        add("motor_moment", way * moments.motors[:, 0])
        add("energy", 0.5 * rows.inertia[:, 0] * omega**2)
        for channel, moment in zip(CHANNELS, moments.loads, strict=True):
            add(channel, way * moment[:, 0])
    whole = {key: np.concatenate(values) for key, values in columns.items()}
    loads = {channel: whole.pop(channel) for channel in CHANNELS}
    return History(load_moments=loads, verdict=verdict, **whole)
