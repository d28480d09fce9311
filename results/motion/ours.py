"""The project's own way through the machines of the benchmark: a run of so many revolutions, by `Machine`.

Speed and time at the end come with error figures, of which these functions return nothing.
"""

from functools import cache

import numpy as np
from cases import Case

from engine import Machine, Scene
from engine.parts.regimes import RunRegime

# As a study asks for them, from coarse to fine.
ACCURACIES = (0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
STEPS_PER_TURN = (8, 16, 32, 64, 128, 256)


@cache
def machine_of(scene: str, run: str, varied: tuple[str, ...], accuracy: float | None) -> Machine:
    """The machine with its run, ready to answer."""
    regimes = {"go": RunRegime.model_validate_json(run)}
    with_run = Scene.model_validate_json(scene).model_copy(update={"regimes": regimes})
    return Machine(with_run, ["go.final_speed", "go.time"], varied=varied, accuracy=accuracy)


def _answers(case: Case, varied: dict[str, np.ndarray], accuracy: float | None, **method: object) -> np.ndarray:
    run = RunRegime(type="run", from_speed=case.speed, cycles=float(case.revolutions), **method)
    scene, text = case.scene.model_dump_json(exclude_none=True), run.model_dump_json(exclude_none=True)
    outcome = machine_of(scene, text, tuple(varied), accuracy).evaluate(varied)
    return np.stack((outcome.summaries["go.final_speed"], outcome.summaries["go.time"]))


def by_accuracy(case: Case, varied: dict[str, np.ndarray], accuracy: float) -> np.ndarray:
    """Speed and time at the end of the run, (2, variants), by steps as long as an accuracy allows."""
    return _answers(case, varied, accuracy)


def by_classical_steps(case: Case, varied: dict[str, np.ndarray], steps: int) -> np.ndarray:
    """The same by the classical method of order four in so many steps a turn."""
    return _answers(case, varied, None, method="rk4", steps_per_turn=steps)
