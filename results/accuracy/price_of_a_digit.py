"""Cost of a digit: error against time of a cycle's summaries, a run and steady running; writes price_of_a_digit.png.

    python results/accuracy/price_of_a_digit.py

needs heyoka.py (pip install heyoka). All methods run in turn on one core with the same variants of one machine, the
press of the motion benchmark. heyoka.py restarts at the jumps, which are given to it; equal positions and equal steps
ignore them. Without a search for steady running, the other methods run until the motion is steady.
"""

import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

sys.path += [str(Path(__file__).parents[1] / room) for room in ("", "motion")]
from cases import CASES, prepare
from measuring import alternating_times, sample
from peers import prepare_heyoka

from engine import Machine, Scene
from engine.compiling.threads import set_threads

HERE = Path(__file__).parent
VARIANTS, ROUNDS, TRUTH = 2048, 5, 1e-12
ACCURACIES = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
POSITIONS, STEPS = (24, 48, 90, 180, 360, 720, 1440, 2880), (16, 32, 64, 128, 256, 512)
TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
# Revolutions of the run, and until a motion is steady to rounding.
RUN, UNTIL_STEADY = 5, 30
# Smaller errors are rounding.
FLOOR = 1e-16
PRESS = CASES["crank_press"]
VARIED = sample(PRESS, VARIANTS)
STATISTICS = ("mean", "rms", "max")
OURS, POINTS, RK4, TAYLOR = "this project", "equal positions", "this project, rk4", "heyoka.py batch"
Results = Callable[[], np.ndarray]


class Method(NamedTuple):
    """A method at one setting: its results, (numbers, variants), and the timed call."""

    name: str
    results: Results
    timed: Results


def machine(names: list[str], accuracy: float | None = None, regimes: dict | None = None) -> Results:
    """Results of the press by name."""
    data = PRESS.scene.model_dump(mode="json", exclude_none=True) | {"regimes": regimes or {}}
    made = Machine(Scene.model_validate(data), names, varied=VARIED, accuracy=accuracy)

    def results() -> np.ndarray:
        found = made.evaluate(VARIED).summaries
        return np.array([found[name] for name in names])

    return results


def cycle(accuracy: float) -> Results:
    """Mean, rms and maximum of the reduced torque."""
    return machine([f"reduced_moment.{statistic}" for statistic in STATISTICS], accuracy)


def over_positions(count: int) -> Results:
    """The same from values at equally spaced positions."""
    made = Machine(PRESS.scene, fields=["reduced_moment"], varied=VARIED, positions=count)

    def results() -> np.ndarray:
        rows = made.evaluate(VARIED).fields["reduced_moment"]
        return np.array([rows.mean(axis=1), np.sqrt(np.square(rows).mean(axis=1)), rows.max(axis=1)])

    return results


def run(accuracy: float | None, cycles: int = RUN, **method: object) -> Results:
    """Speed and time at the end of a run."""
    go = {"type": "run", "from_speed": PRESS.speed, "from_angle": 0.0, "cycles": cycles, **method}
    return machine(["go.final_speed", "go.time"], accuracy, {"go": go})


def taylor(tolerance: float, cycles: int = RUN) -> Results:
    """The same by heyoka.py."""
    case = PRESS._replace(revolutions=cycles)
    solve = prepare_heyoka(case, prepare(case, VARIED), tolerance)
    return lambda: solve(slice(0, VARIANTS))


def steady(accuracy: float) -> Results:
    """Period of the steady cycle."""
    return machine(["go.period"], accuracy, {"go": {"type": "steady"}})


def last_period(steps: int) -> Results:
    """The same from the last cycle of a long run by equal steps."""
    method = {"type": "run", "method": "rk4", "steps_per_turn": steps}
    go = {**method, "from_speed": PRESS.speed, "from_angle": 0.0, "cycles": UNTIL_STEADY - 1}
    return machine(["last.time"], None, {"go": go, "last": {**method, "cycles": 1}})


def last_period_by_taylor(tolerance: float) -> Method:
    """The same by heyoka.py; of its two runs the longer one is timed."""
    long, short = taylor(tolerance, UNTIL_STEADY), taylor(tolerance, UNTIL_STEADY - 1)
    return Method(TAYLOR, lambda: long()[1:] - short()[1:], long)


def of(name: str, results: Iterable[Results]) -> list[Method]:
    """A method at all its settings."""
    return [Method(name, one, one) for one in results]


def entries() -> dict[str, list[Method]]:
    """Methods of each diagram."""
    return {
        "cycle: mean, rms and peak torque": [
            *of(OURS, map(cycle, ACCURACIES)),
            *of(POINTS, map(over_positions, POSITIONS)),
        ],
        f"run of {RUN} turns: speed and time": [
            *of(OURS, map(run, ACCURACIES)),
            *of(RK4, (run(None, method="rk4", steps_per_turn=n) for n in STEPS)),
            *of(TAYLOR, map(taylor, TOLERANCES)),
        ],
        "steady running: period": [
            *of(OURS, map(steady, ACCURACIES)),
            *of(RK4, map(last_period, STEPS)),
            *map(last_period_by_taylor, TOLERANCES),
        ],
    }


def main() -> None:
    """Measure and draw."""
    set_threads(1)
    truths = [cycle(TRUTH)(), run(TRUTH)(), steady(TRUTH)()]
    figure = Figure(figsize=(13, 4.2), layout="constrained")
    for ax, truth, (title, methods) in zip(figure.subplots(1, 3), truths, entries().items(), strict=True):
        # A mean torque may be zero.
        scale = np.abs(truth) if len(truth) < len(STATISTICS) else np.abs(truth).max(axis=0)
        off = [np.abs(method.results() - truth) / scale for method in methods]
        errors = [max(float(np.median(rows.max(axis=0))), FLOOR) for rows in off]
        times = alternating_times([method.timed for method in methods], ROUNDS)
        cost = np.median(times, axis=1) / VARIANTS * 1e6
        for name in dict.fromkeys(method.name for method in methods):
            own = [k for k, method in enumerate(methods) if method.name == name]
            ax.loglog([errors[k] for k in own], cost[own], "o-", label=name)
            print(title, name, *(f"{errors[k]:.0e}:{cost[k]:.2f}" for k in own), flush=True)
        ax.set(title=title, xlabel="median relative error", ylabel="µs of processor time per variant")
        ax.invert_xaxis()
        ax.legend()
    figure.savefig(HERE / "price_of_a_digit.png", dpi=120)


if __name__ == "__main__":
    main()
