"""The motion of one machine at given times."""

from collections.abc import Sequence

import numpy as np

import engine
from engine import CrankInput, Scene, Verdict, sliding_quantity
from sweeps.report.readings import Readings
from sweeps.report.regime_words import failure_text
from sweeps.text.input_files import InputError

_OF_HISTORY = {
    "time": ("s", "time after the start"),
    "angle": ("rad", "crank angle, cumulative"),
    "speed": ("rad s-1", "angular speed of the input link"),
    "acceleration": ("rad s-2", "angular acceleration of the input link"),
    "motor_moment": ("N m", "motor torque, reduced to the input"),
    "energy": ("J", "kinetic energy"),
}


def readings_in_time(scene: Scene, at: Sequence[float]) -> Readings:
    """The motion through the regimes at given times.

    Parameters
    ----------
    scene : Scene
    at : sequence of float
        Times after the start [s]; steady running lasts one cycle.

    Raises
    ------
    InputError
        The scene has no regimes, or they end earlier.
    """
    if not scene.regimes:
        raise InputError.of("--at", 'a time needs regimes; give an angle, or add [regimes.NAME] with type = "run"')
    seen, times = engine.history(scene), np.asarray(at, float)
    failed = "" if seen.verdict == Verdict.OK else failure_text(scene, seen.verdict, seen)
    if times.min() < 0 or times.max() > seen.time[-1]:
        message = f"the regimes last from 0 to {seen.time[-1]:.6g} s" + (f": {failed}" if failed else "")
        raise InputError.of("--at", message)
    rows = _between(seen, times)
    channels = {f"{channel}_moment": row for channel, row in seen.load_moments.items()}
    values = rows | {name: np.interp(times, seen.time, row) for name, row in channels.items()}
    about = _OF_HISTORY | {
        name: ("N m", f"torque of {name.removesuffix('_moment')} loads, reduced to the input") for name in channels
    }
    if not isinstance(scene.input, CrankInput):
        about = {name: sliding_quantity(words, unit)[::-1] for name, (unit, words) in about.items()}
        about["angle"] = ("m", "input displacement")
    units, long_names = ({name: pair[i] for name, pair in about.items()} for i in (0, 1))
    return Readings("time", times, values, units, long_names, failed)


def _between(seen: "engine.History", times: np.ndarray) -> dict[str, np.ndarray]:
    """Interpolate a history: angle and speed by cubic Hermite polynomials."""
    after = np.clip(np.searchsorted(seen.time, times, "right"), 1, seen.time.size - 1)
    before = after - 1
    step = seen.time[after] - seen.time[before]
    # Adjacent regimes share an instant.
    share = np.where(step > 0, (times - seen.time[before]) / np.where(step > 0, step, 1.0), 1.0)

    def cubic(values: np.ndarray, slopes: np.ndarray) -> np.ndarray:
        begin, end = values[before], values[after]
        rise, of_begin, of_end = end - begin, step * slopes[before], step * slopes[after]
        bend = (of_begin - rise) * (1 - share) - (of_end - rise) * share
        return begin + share * rise + share * (1 - share) * bend

    def line(values: np.ndarray) -> np.ndarray:
        return values[before] + share * (values[after] - values[before])

    return {
        "angle": cubic(seen.angle, seen.speed),
        "speed": cubic(seen.speed, seen.acceleration),
        "acceleration": line(seen.acceleration),
        "motor_moment": line(seen.motor_moment),
        "energy": line(seen.energy),
    }
