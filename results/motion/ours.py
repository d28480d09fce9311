"""The benchmark's machines by this project: a run over a number of revolutions, by `Machine`.

Speed and time at the end have error estimates, which are not returned.
"""

from collections.abc import Callable

import numpy as np
from cases import Batch, Case
from peers import Peer

from engine import Machine, Scene

# Accuracies as in a study, from coarse to fine.
ACCURACIES = (0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
OURS, OUR_RK4 = "this project", "this project, rk4"


def prepare(case: Case, batch: Batch, accuracy: float | None, **method: object) -> Callable[[slice], np.ndarray]:
    """Function of all variants that returns ω and t, for a requested accuracy."""
    go = {"type": "run", "from_speed": case.speed, "cycles": case.revolutions, **method}
    data = case.scene.model_dump(mode="json", exclude_none=True) | {"regimes": {"go": go}}
    asked = ["go.final_speed", "go.time"]
    machine = Machine(Scene.model_validate(data), asked, varied=batch.varied, accuracy=accuracy)
    return lambda _: np.stack(list(machine.evaluate(batch.varied).summaries.values()))


def prepare_rk4(case: Case, batch: Batch, steps: float) -> Callable[[slice], np.ndarray]:
    """The same by the classical method of order four with given steps per turn."""
    return prepare(case, batch, None, method="rk4", steps_per_turn=int(steps))


OWN = (Peer(OURS, ACCURACIES, prepare), Peer(OUR_RK4, (8, 16, 32, 64, 128, 256), prepare_rk4))
