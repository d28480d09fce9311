"""How many steps true motion takes: the engine's energy form and other ways to integrate, against `closed_run`.

    python results/accuracy/steps.py

writes steps.md beside this file.
"""

import argparse
import platform
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np
from closed_run import Driven, paths_of
from quantities import TARGETS, loads_of
from random_machines import SEED, Kind, Varied, kinds, machines
from timing import microseconds
from ways import Motors, Sampled, by_tolerance, frozen_step, in_time, over_tables, rk4_step, trapezoid_step

from engine import Machine, Scene
from engine.compiling.threads import set_threads, threads
from engine.scene.scene import scene_numbers

HERE = Path(__file__).parent
KINDS = ("slider-crank", "crank-rocker", "compressor", "turning moment", "press", "Scotch yoke")
# Loads that depend on speed are the motor's alone: the closed formulas of the others are at uniform speed.
AT_SPEED = ("springs.s.damping", "forces.drag.coefficient", "moments.drag.coefficient")
CYCLES, FROM = 3, 0.7
STEPS = (12, 24, 48, 96, 192, 384, 768, 1536)
RUN = {"speed after three cycles": "go.final_speed", "time they take": "go.time"}
STEADY = {"δ": "even.speed_fluctuation", "mean speed": "even.mean_speed", "multiplier": "even.multiplier"}
TIMED, VARIANTS, STEPS_TIMED = ("slider-crank", "compressor", "press"), 500, 100_000
# RK4 in time needs I and M anywhere, which takes long here: fewer steps.
STEPS_IN_TIME, TOLERANCES = STEPS[:6], (1e-3, 1e-5, 1e-7, 1e-9, 1e-11)


def with_motor(kind: Kind) -> Scene:
    """The machine with a DC motor on its crank, a flywheel, a run and a steady regime."""
    scene = kind.scene.model_dump()
    motor = {"type": "dc_motor", "on": kind.scene.input.link, "no_load_speed": 10.0, "stall_moment": 10.0}
    go = {"type": "run", "from_speed": 1.0, "cycles": CYCLES}
    parts = {"flywheel": {"inertia": 1.0}, "regimes": {"even": {"type": "steady"}, "go": go}}
    return Scene.model_validate(scene | parts | {"moments": scene["moments"] | {"motor": motor}})


def driven(kind: Kind, count: int) -> tuple[Varied, Motors]:
    """Machines with motors from soft to stiff, disturbances lasting 30 cycles to a third of one, δ of 0.003 to 0.3."""
    random, varied = np.random.default_rng([SEED, *kind.name.encode()]), machines(kind, count)
    varied = {path: values for path, values in varied.items() if not path.startswith("flywheel")}
    varied |= {path: np.zeros(count) for path in AT_SPEED if path in scene_numbers(kind.scene)}
    asked = ["excess_work", "reduced_moment.mean", "reduced_inertia.max", "reduced_inertia.min"]
    found = Machine(kind.scene, asked, (), list(varied)).evaluate(varied).summaries
    work, mean, most, least = (found[name] for name in asked)
    speed, forward = abs(varied["input.speed"]), np.sign(varied["input.speed"])
    wheel = (work / speed**2 + most - least) / (0.003 * 100 ** random.random(count))
    slope = 0.03 * 100 ** random.random(count) * (wheel + most) * speed / (2 * np.pi)
    # Where loads drive, the motor gives what little is left.
    top = np.maximum(speed - forward * mean / slope, 0.5 * speed)
    varied |= {"flywheel.inertia": wheel, "moments.motor.no_load_speed": top, "moments.motor.stall_moment": slope * top}
    return varied | {"regimes.go.from_speed": FROM * speed}, Motors(wheel, slope, top, speed, FROM * speed)


# Errors, by loads, and costs

# Ways of integrating, and how often each asks for I and M in a step.
FORMS = {
    "energy form, RK4, nodes at jumps (the engine)": 2,
    "energy form, RK4": 2,
    "energy form, trapezoid rule": 1,
    "I and M frozen over a step": 1,
    "RK4 in time": 4,
    "energy form, steps by tolerance": 6,
}
ENGINE, *EQUAL, IN_TIME, BY_TOLERANCE = FORMS
STEPPERS = dict(zip(EQUAL, (rk4_step, trapezoid_step, frozen_step), strict=True))
Errors = dict[tuple[str, float], np.ndarray]


class Found(NamedTuple):
    """Errors (machines,) by loads and (what or form, steps or tolerance); tries a cycle by loads and tolerance.

    `times` are those of a variant [µs] by regime and steps.
    """

    answers: dict[str, Errors]
    forms: dict[str, Errors]
    tries: dict[str, dict[float, np.ndarray]]
    times: dict[tuple[str, int], float]


def _of_kind(name: str, count: int) -> tuple[Errors, Errors, dict[float, np.ndarray]]:
    """Errors of the engine's answers and of forms, and tries a cycle, of a kind of machine."""
    set_threads(1)
    kind = next(kind for kind in kinds() if kind.name == name)
    varied, motors = driven(kind, count)
    scene = with_motor(kind)
    reference = Driven(paths_of(scene, varied), motors.flywheel, motors.slope, motors.top)
    run, steady = reference.run(motors.first, CYCLES), reference.steady(motors.speed)
    answers: Errors = {}
    for n in STEPS:
        summaries = Machine(scene, [*RUN.values(), *STEADY.values()], (), list(varied), n).evaluate(varied).summaries
        for (what, asked), true in zip((RUN | STEADY).items(), (*run, *steady), strict=True):
            answers[what, n] = _error(summaries[asked], true, 1.0 if what == "multiplier" else true)
    return answers, *_of_forms(Sampled(reference, motors, CYCLES), run, answers)


def _of_forms(machines: Sampled, run: tuple, answers: Errors) -> tuple[Errors, dict[float, np.ndarray]]:
    """Errors of speed and time, the greater, by form, and tries a cycle by tolerance."""
    forms = {(ENGINE, n): np.maximum(*(answers[what, n] for what in RUN)) for n in STEPS}
    tries = {}

    def error(found: Iterable[np.ndarray]) -> np.ndarray:
        return np.maximum(*(_error(a, b, b) for a, b in zip(found, run, strict=True)))

    for n in STEPS:
        forms |= {(form, n): error(over_tables(machines, n, step)) for form, step in STEPPERS.items()}
    forms |= {(IN_TIME, n): error(in_time(machines, n)) for n in STEPS_IN_TIME}
    for tolerance in TOLERANCES:
        *found, tries[tolerance] = by_tolerance(machines, tolerance)
        forms[BY_TOLERANCE, tolerance] = error(found)
    return forms, tries


def _error(found: np.ndarray, true: np.ndarray, scale: np.ndarray | float) -> np.ndarray:
    """Relative to a scale; infinite where nothing is found."""
    gap = np.asarray(abs(found - true) / scale, float)
    return np.where(np.isfinite(gap), gap, np.inf)


def measured(count: int) -> Found:
    """Errors of `count` machines of every one of KINDS, and times."""
    with ProcessPoolExecutor(threads()) as pool:
        every = dict(zip(KINDS, pool.map(_of_kind, KINDS, [count] * len(KINDS)), strict=True))
    merged: list[dict] = [{}, {}, {}]
    for kind, parts in every.items():
        for whole, part in zip(merged, parts, strict=True):
            by_loads = whole.setdefault(loads_of(kind), {})
            for key, values in part.items():
                by_loads[key] = np.append(by_loads.get(key, []), values)
    return Found(*merged, _times(count))


def _times(count: int) -> dict[tuple[str, int], float]:
    """Time of a variant [µs] by regime and steps, the median of the kinds TIMED."""
    set_threads(1)
    found: dict[tuple[str, int], list[float]] = {}
    for kind in kinds():
        if kind.name in TIMED:
            varied, scene = driven(kind, count)[0], with_motor(kind)
            for n in STEPS:
                # With many steps fewer variants.
                some = {path: np.resize(values, min(VARIANTS, STEPS_TIMED // n)) for path, values in varied.items()}
                for regime, asked in (("run", RUN), ("steady", STEADY)):
                    machine = Machine(scene, list(asked.values()), (), list(some), n)
                    found.setdefault((regime, n), []).append(microseconds(machine, some))
    return {key: float(np.median(times)) for key, times in found.items()}


def _enough(errors: Errors, name: str, target: float) -> list[float]:
    """The steps, or the tolerances, that keep 99 % of the machines within an error."""
    return [k for what, k in errors if what == name and np.quantile(errors[what, k], 0.99) <= target]


def _head(first: str) -> list[str]:
    return [f"| loads | {first} | " + " | ".join(TARGETS) + " |", "|---" * (len(TARGETS) + 2) + "|"]


def choices(found: Found) -> list[str]:
    """Lines of the table of the cheapest steps of the engine that keep 99 % of the machines within an error."""
    lines = _head("")
    for loads, errors in found.answers.items():
        for what in RUN | STEADY:
            times = {n: found.times["run" if what in RUN else "steady", n] for n in STEPS}
            steps = [min(_enough(errors, what, target), key=times.get, default=None) for target in TARGETS.values()]
            cells = ["–" if n is None else f"{n} ({times[n]:.0f})" for n in steps]
            lines.append(f"| {loads} | {what} | " + " | ".join(cells) + " |")
    return lines


def forms(found: Found) -> list[str]:
    """Lines of the table of steps a cycle of other forms, and how often they ask for I and M."""
    lines = _head("form")
    for loads, errors in found.forms.items():
        for form, each in FORMS.items():
            cells = []
            for target in TARGETS.values():
                enough = _enough(errors, form, target)
                if form == BY_TOLERANCE and enough:
                    enough = [round(float(np.median(found.tries[loads][max(enough)])))]
                cells.append(f"{min(enough)} ({min(enough) * each})" if enough else "–")
            lines.append(f"| {loads} | {form} | " + " | ".join(cells) + " |")
    return lines


def floors(found: Found) -> str:
    """How near the engine comes to the references, as a part of a sentence."""
    least = {loads: min(np.quantile(errors[ENGINE, n], 0.99) for n in STEPS) for loads, errors in found.forms.items()}
    return ", ".join(f"{value:.0e} ({loads})" for loads, value in least.items())


TEXT = """# Steps of true motion

{count} machines with a flywheel and a DC motor, from so soft that disturbances last 30 cycles to so stiff that they
last a third of one: three cycles from 0.7 of the speed that they are made for, and the motion that repeats itself. True
motion is found by collocation in 80 bits on the panels of the closed formulas (`closed_run.py`). The cheapest steps a
cycle (`positions`) that keep 99 % of the machines within an error (of the multiplier: absolute), and the time of the
regime in µs a variant. Made by `python results/accuracy/steps.py`; {system}.

{choices}

The same of the speed and the time after three cycles, by other ways to integrate, restated in NumPy (`ways.py`); in
brackets how often they ask for I and M in a cycle, of steps by tolerance the median with those tried in vain. "–": not
with 1536 steps, in time with 384, by a tolerance of 1e-11. The engine comes as near to the references as {floors}.

{forms}
"""


def main() -> None:
    """Measure and write the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--machines", type=int, default=100, help="of each kind")
    count = parser.parse_args().machines
    found = measured(count)
    text = TEXT.format(
        count=count * len(KINDS),
        system=f"{platform.machine()}, Python {platform.python_version()}, times on one thread",
        choices="\n".join(choices(found)),
        floors=floors(found),
        forms="\n".join(forms(found)),
    )
    (HERE / "steps.md").write_text(text, encoding="utf8")


if __name__ == "__main__":
    main()
