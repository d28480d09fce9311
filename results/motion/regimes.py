"""What regimes cost: a settled press in many variants, and one machine under a moment over time; writes regimes.md.

python results/motion/regimes.py
"""

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from cases import CASES, sample

from engine import Machine, Scene
from engine.compiling.threads import set_threads
from engine.parts.actions import TableMoment
from engine.parts.regimes import RunRegime, SteadyRegime

HERE = Path(__file__).parent
VARIANTS, ROUNDS, CYCLES = 2000, 5, 20.0
ACCURACIES = (1e-4, 1e-6, 1e-9)
ASKED = ("work.speed_fluctuation", "work.mean_speed", "work.multiplier", "work.motor_moment_rms")


def least_time(evaluate: Callable[[], object]) -> float:
    """CPU time [s], the least of some rounds after a first one, which compiles."""
    evaluate()
    times = []
    for _ in range(ROUNDS):
        start = time.process_time()
        evaluate()
        times.append(time.process_time() - start)
    return min(times)


def settled_press() -> list[str]:
    """Lines of a table: accuracy, time a variant, median and greatest figures."""
    case = CASES["crank_press"]
    scene = case.scene.model_copy(update={"regimes": {"work": SteadyRegime(type="steady")}})
    varied = sample(case, VARIANTS)
    lines = [
        f"| accuracy | µs a variant | {' | '.join(f'{name} (median, greatest figure)' for name in ASKED)} |",
        "|---" * (2 + len(ASKED)) + "|",
    ]
    for accuracy in ACCURACIES:
        machine = Machine(scene, ASKED, varied=tuple(varied), accuracy=accuracy)
        seconds = least_time(lambda machine=machine: machine.evaluate(varied)) / VARIANTS
        outcome = machine.evaluate(varied)
        figures = [outcome.errors[name] / np.abs(outcome.summaries[name]) for name in ASKED]
        told = " | ".join(f"{np.median(figure):.1e}, {figure.max():.1e}" for figure in figures)
        lines.append(f"| {accuracy:.0e} | {seconds * 1e6:.1f} | {told} |")
    return lines


def machine_over_time() -> str:
    """A sentence: time of one machine whose moment depends on time, and what it is sure to."""
    case = CASES["slider_crank"]
    push = TableMoment(
        type="table", on="crank", over_time=[0.0, 1.0, 3.0], moment=[0.0, 2.0, 0.0], interpolation="linear"
    )
    run = RunRegime(type="run", from_speed=case.speed, cycles=CYCLES)
    moments = {**case.scene.moments, "push": push}
    scene = case.scene.model_copy(update={"moments": moments, "regimes": {"go": run}})
    machine = Machine(Scene.model_validate(scene.model_dump(exclude_none=True)), ["go.time", "go.final_speed"])
    seconds = least_time(lambda: machine.evaluate({}))
    outcome = machine.evaluate({})
    figure = float(outcome.errors["go.final_speed"][0] / outcome.summaries["go.final_speed"][0])
    return f"{seconds * 1e3:.0f} ms for {CYCLES:g} turns of the slider-crank; figure of its final speed {figure:.0e}."


def main() -> None:
    set_threads(1)
    lines = [
        "# What regimes cost",
        "",
        "CPU time on one thread, the least of some rounds, cuts found and error figures included. Remade by",
        "`python results/motion/regimes.py`.",
        "",
        f"## Steady state of the crank press with an induction motor, {VARIANTS} variants",
        "",
        *settled_press(),
        "",
        "## One machine under a moment over time",
        "",
        machine_over_time(),
        "",
    ]
    (HERE / "regimes.md").write_text("\n".join(lines), encoding="utf8")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
