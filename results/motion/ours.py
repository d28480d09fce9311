"""The project's own way through the machines of the benchmark: a run of so many revolutions, by `Machine`."""

from functools import cache

import numpy as np
from cases import Case

from engine import Machine, Scene
from engine.scene.regimes import RunRegime


@cache
def machine_of(scene: str, speed: float, revolutions: int, varied: tuple[str, ...], steps: int) -> Machine:
    """The machine with its run, ready to answer."""
    run = RunRegime(type="run", from_speed=speed, cycles=float(revolutions))
    with_run = Scene.model_validate_json(scene).model_copy(update={"regimes": {"go": run}})
    return Machine(with_run, ["go.final_speed", "go.time"], varied=varied, positions=steps)


def ours(case: Case, varied: dict[str, np.ndarray], steps: int) -> tuple[np.ndarray, np.ndarray]:
    """Speed and time at the end of the run, both with error figures (which this returns nothing of)."""
    scene = case.scene.model_dump_json(exclude_none=True)
    machine = machine_of(scene, case.speed, case.revolutions, tuple(varied), steps)
    outcome = machine.evaluate(varied)
    return outcome.summaries["go.final_speed"], outcome.summaries["go.time"]
