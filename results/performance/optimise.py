"""What a search costs beside the engine: a population evaluated, and NSGA-II whole. Remakes optimise.md.

Run as `python results/performance/optimise.py` from the repository's root; needs pymoo.
"""

import platform
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path

import numpy as np
from machines import CASES

from engine import Machine
from engine.compiling.threads import threads
from sweeps.optimising.runner import optimise_study
from sweeps.optimising.searching import first_generation
from sweeps.optimising.trials import Trials
from sweeps.study.sampling import Design, Sampled
from sweeps.study.search_task import SearchTask, task_of
from sweeps.study.study import Study
from sweeps.study.study_text import Optimise

HERE = Path(__file__).parent
RUNS = 15
CANDIDATES = 10_000


class Clock:
    """Seconds spent in the engine."""

    def __init__(self) -> None:
        self.seconds = 0.0

    @contextmanager
    def watching(self) -> Iterator[None]:
        """Count what is spent inside the block."""
        evaluate = Machine.evaluate

        def timed(*arguments: object, **named: object) -> object:
            started = time.perf_counter()
            outcome = evaluate(*arguments, **named)
            self.seconds += time.perf_counter() - started
            return outcome

        Machine.evaluate = timed
        try:
            yield
        finally:
            Machine.evaluate = evaluate


def task(population: int, generations: int) -> SearchTask:
    """Four-bar: least flywheel and greatest transmission angle, over its lengths and the mass of its rocker."""
    scene = CASES["four_bar"].scene
    lows = {"input.length": 0.03, "groups.g.first.length": 0.15, "groups.g.second.length": 0.1, "bodies.rocker.mass": 1}
    highs = {
        "input.length": 0.07,
        "groups.g.first.length": 0.25,
        "groups.g.second.length": 0.2,
        "bodies.rocker.mass": 2,
    }
    axis = Sampled(tuple(lows), tuple(lows.values()), tuple(highs.values()), population, "latin")
    wanted = Optimise(
        minimise=["flywheel_used"],
        maximise=["g.transmission_angle"],
        subject_to=["speed_fluctuation <= 0.05"],
        population=population,
        generations=generations,
    )
    return task_of(Study(scene, Design((axis,)), optimise=wanted))


def times(evaluate: Callable[[], object]) -> np.ndarray:
    """Seconds of evaluations and of the engine in them (runs, 2)."""
    evaluate()
    found, clock = [], Clock()
    with clock.watching():
        for _ in range(RUNS):
            clock.seconds, started = 0.0, time.perf_counter()
            evaluate()
            found.append((time.perf_counter() - started, clock.seconds))
    return np.array(found)


def population() -> str:
    """Rows of a population evaluated and judged: the middle of all runs, and the quickest."""
    asked = task(CANDIDATES, 1)
    trials, points = Trials(asked), first_generation(asked)
    found = times(lambda: trials.evaluate(points))
    quotients = found[:, 0] / found[:, 1]
    quickest = found[:, 0].argmin()
    whole, inside = 1e3 * np.median(found, axis=0)
    least, then = 1e3 * found[quickest]
    return (
        f"| medians | {whole:.1f} | {inside:.1f} | {np.median(quotients):.2f} |\n"
        f"| the quickest run | {least:.1f} | {then:.1f} | {quotients[quickest]:.2f} |"
    )


def genetic(generations: int = 100, size: int = 1000) -> str:
    """Row of a whole search with NSGA-II."""
    asked, clock = task(size, generations), Clock()
    Trials(asked).evaluate(first_generation(asked))
    with tempfile.TemporaryDirectory() as folder, clock.watching():
        started = time.perf_counter()
        path = optimise_study(asked.study, Path(folder) / "front.h5")
        seconds, megabytes = time.perf_counter() - started, path.stat().st_size / 1e6
    return f"| {generations} × {size} | {seconds:.1f} | {clock.seconds:.2f} | {megabytes:.0f} |"


def main() -> None:
    """Measure and write the table."""
    libraries = ("numpy", "numba", "scipy", "pymoo", "h5py")
    words = ", ".join([platform.python_version(), *(f"{name} {version(name)}" for name in libraries)])
    text = f"""# Cost of searching

Four-bar of the benchmark: `flywheel_used` small and the transmission angle great, four numbers
varied, one condition on results; {RUNS} runs, on a machine that others use too.
Remade by `python results/performance/optimise.py`.
{threads()} threads; Python {words}.

## {CANDIDATES} candidates, from coordinates to costs

| runs | whole [ms] | engine [ms] | quotient |
|---|---|---|---|
{population()}

## NSGA-II with its file

What is neither engine nor file is pymoo's own.

| generations × candidates | whole [s] | engine [s] | file [MB] |
|---|---|---|---|
{genetic()}
"""
    (HERE / "optimise.md").write_text(text, encoding="utf8")
    print(text)


if __name__ == "__main__":
    np.seterr(all="ignore")
    main()
