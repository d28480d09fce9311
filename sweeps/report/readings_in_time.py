"""The motion of one machine at given times."""

from collections.abc import Sequence

import numpy as np

import engine
from engine import CrankInput, Scene, Verdict, sliding_quantity
from sweeps.report.readings import Readings
from sweeps.report.regime_words import failure_text
from sweeps.text.input_files import InputError


def history_readings(scene: Scene, seen: "engine.History") -> Readings:
    """Motion, torques and energy of a history at all its instants, position and speed first.

    Parameters
    ----------
    scene : Scene
    seen : History
    """
    turns = isinstance(scene.input, CrankInput)
    loads = {
        f"{channel}_moment": (row, "N m", f"torque of {channel} loads, reduced to the input")
        for channel, row in seen.load_moments.items()
    }
    found = {
        "angle" if turns else "displacement": (seen.angle, "rad", "crank angle, cumulative"),
        "speed": (seen.speed, "rad s-1", "angular speed of the input link"),
        "acceleration": (seen.acceleration, "rad s-2", "angular acceleration of the input link"),
        "motor_moment": (seen.motor_moment, "N m", "motor torque, reduced to the input"),
        **loads,
        "energy": (seen.energy, "J", "kinetic energy"),
    }
    if not turns:
        found = {name: (row, *sliding_quantity(words, unit)[::-1]) for name, (row, unit, words) in found.items()}
        found["displacement"] = (seen.angle, "m", "input displacement")
    failed = "" if seen.verdict == Verdict.OK else failure_text(scene, seen.verdict, seen)
    values, units, long_names = ({name: column[k] for name, column in found.items()} for k in range(3))
    about = {"time": "s"} | units, {"time": "time after the start"} | long_names
    return Readings("time", seen.time, values, *about, failed)


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
    whole = history_readings(scene, seen)
    if times.min() < 0 or times.max() > seen.time[-1]:
        message = f"the regimes last from 0 to {seen.time[-1]:.6g} s" + (f": {whole.remark}" if whole.remark else "")
        raise InputError.of("--at", message)
    slopes = dict(zip(whole.values, (seen.speed, seen.acceleration), strict=False))
    values = {name: _between(seen.time, times, row, slopes.get(name)) for name, row in whole.values.items()}
    return whole._replace(
        at=times, values=values, regimes=[str(name) for name in seen.regime[_after(seen.time, times)]]
    )


def _after(time: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Indices of the first instants after some times; for the end, of the last instant."""
    return np.clip(np.searchsorted(time, at, "right"), 1, time.size - 1)


def _between(time: np.ndarray, at: np.ndarray, row: np.ndarray, slopes: np.ndarray | None) -> np.ndarray:
    """Interpolate a row over time linearly, or by cubic Hermite polynomials."""
    after = _after(time, at)
    step = time[after] - time[after - 1]
    # Adjacent regimes share an instant.
    share = np.where(step > 0, (at - time[after - 1]) / np.where(step > 0, step, 1.0), 1.0)
    begin, rise = row[after - 1], row[after] - row[after - 1]
    if slopes is None:
        return begin + share * rise
    bend = (step * slopes[after - 1] - rise) * (1 - share) - (step * slopes[after] - rise) * share
    return begin + share * rise + share * (1 - share) * bend
