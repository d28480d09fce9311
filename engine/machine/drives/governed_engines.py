"""A mechanism as the engine of governors: its inertia, and its torques over the cycle."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from engine.elements.governors.governor import cycle_key
from engine.machine.results import Outcome
from engine.scene.scene import Numbers, Scene

# Of the mechanism only, without a flywheel.
MEAN_INERTIA = "reduced_inertia.mean"
_CYCLE_FIELDS = ("reduced_inertia", "reduced_inertia_phi", "reduced_moment")


def _along_motion(outcome: Outcome, numbers: Numbers) -> dict[str, np.ndarray]:
    """Fields over the angle turned in the direction of motion, in which torques and slopes are positive."""
    backwards = np.reshape(numbers["input.speed"] < 0.0, (-1, 1))
    turned = {name: np.roll(rows[:, ::-1], 1, axis=1) for name, rows in outcome.fields.items()}
    signs = {name: 1.0 if name == _CYCLE_FIELDS[0] else -1.0 for name in turned}
    return {name: np.where(backwards, signs[name] * turned[name], rows) for name, rows in outcome.fields.items()}


class GovernedEngines:
    """Data of the mechanism for its governors: mean inertia, and curves if a change of load is simulated.

    Parameters
    ----------
    scene : Scene
    governing : sequence of str
        The governors.

    Attributes
    ----------
    summaries, fields : tuple of str
        Quantities required of the mechanism, at CYCLE_POSITIONS positions.
    """

    summaries = (MEAN_INERTIA,)

    def __init__(self, scene: Scene, governing: Sequence[str]) -> None:
        self._engines = {name: scene.elements[name].engine for name in governing}
        followed = [engine for engine in self._engines.values() if engine.duration is not None]
        throttled = dict.fromkeys(f"{action}.moment" for engine in followed for action in engine.throttled)
        self.fields = (*_CYCLE_FIELDS, *throttled) if followed else ()
        self._length = math.tau * scene.input.revolutions

    def numbers(self, outcome: Outcome, numbers: Numbers) -> dict[str, np.ndarray]:
        """Numbers of the governors' engines, by their paths.

        Parameters
        ----------
        outcome : Outcome
            Results of the mechanism, with the required quantities.
        numbers : Numbers
            Numbers of the same variants.
        """
        found = {}
        mean = outcome.summaries[MEAN_INERTIA]
        for name, engine in self._engines.items():
            path = f"elements.{name}.engine.inertia"
            found[path] = numbers[path] + mean + numbers.get("flywheel.inertia", 0.0)
            if engine.duration is not None:
                rows = self._curves(_along_motion(outcome, numbers), engine.throttled, mean)
                found |= {f"elements.{name}.{cycle_key(k)}": row for k, row in enumerate(rows)}
        return found

    def _curves(self, fields: Mapping[str, np.ndarray], throttled: Sequence[str], mean: np.ndarray) -> np.ndarray:
        """Curves of the variants in the governors' order, and the length of the cycle: (numbers, variants)."""
        inertia, slope, moment = (fields[name] for name in _CYCLE_FIELDS)
        driving = sum((fields[f"{action}.moment"] for action in throttled), np.zeros_like(moment))
        other = moment - driving
        with np.errstate(divide="ignore", invalid="ignore"):
            share = driving / driving.mean(axis=1, keepdims=True) if throttled else np.ones_like(moment)
        # Throttled actions have to drive: otherwise no throttle can govern them.
        share = np.where(driving.mean(axis=1, keepdims=True) > 0.0, share, np.nan) if throttled else share
        parts = (inertia - mean[:, None], slope, share, other - other.mean(axis=1, keepdims=True))
        length = np.full((1, moment.shape[0]), self._length)
        return np.concatenate([*(part.T for part in parts), length])
