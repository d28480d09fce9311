"""The motion of a machine in a regime, from the state that the one before left: what all regimes share."""

from abc import ABC, abstractmethod
from typing import NamedTuple

import numpy as np

from engine.laws.rounding import EPS
from engine.motion.asked_regimes import AskedRegimes
from engine.motion.moments.dynamics import Variants
from engine.motion.one_speed import CHANNELS
from engine.motion.quantities import FieldAnswers
from engine.motion.runs.run_progress import RunOutcome, Standing, Stepping
from engine.words.verdicts import Verdict

ROUNDING = 16.0 * EPS
# Results that need the minimum and maximum speed.
EXTREMES_OF_SPEED = ("speed_min", "speed_max", "speed_fluctuation", "motor_moment_peak")


class OneRegime(NamedTuple):
    """Results of one regime.

    Attributes
    ----------
    answers : FieldAnswers
        By name without the regime's.
    standing : Standing
        State after it.
    made : ndarray (variants,) or float
        Approximate number of steps, each with its rounding.
    energy : ndarray (variants,)
        Approximate maximum kinetic energy [J].
    covered : ndarray (2, variants) or None
        Minimum and maximum position of the input in a run.
    by_equal_steps : ndarray (3, variants) or None
        Angle turned [rad], final speed [rad/s] and time [s] of a run by equal steps.
    known : ndarray (variants,) or bool
        Whether all errors are propagated, so that one comparison suffices.
    """

    answers: FieldAnswers
    standing: Standing
    made: np.ndarray | float
    energy: np.ndarray
    covered: np.ndarray | None = None
    by_equal_steps: np.ndarray | None = None
    known: np.ndarray | bool = False


class RegimeMotion(ABC):
    """The motion of a machine in one of its regimes.

    Parameters
    ----------
    asked : AskedRegimes
    name : str
        Name of the regime.

    Attributes
    ----------
    dynamics : Dynamics
    two : TwoSides or None
        Both sides of the scene's coupling.
    """

    def __init__(self, asked: AskedRegimes, name: str) -> None:
        self.name, self.regime = name, asked.regimes[name]
        off = frozenset(self.regime.off)
        self.dynamics, self.two, self.reduction = asked.dynamics[off], asked.sides.get(off), asked.reduction
        self.fields, self.loads, self.scene, self._asked = asked.fields[name], asked.loads, asked.scene, asked

    def asks(self, *keys: str) -> bool:
        """Whether any of some results of the regime is requested."""
        return not self._asked.asked.isdisjoint(f"{self.name}.{key}" for key in keys)

    def follow(self, variants: Variants, standing: Standing, longer: float) -> OneRegime:
        """The regime from the current state.

        Parameters
        ----------
        variants : Variants
            With the inertia of all parts.
        standing : Standing
        longer : float
            One of `WALKS`.
        """
        hindered = self.hindered(variants)
        verdict = np.where(standing.verdict, standing.verdict, hindered)
        return self._follow(variants, standing._replace(verdict=verdict), longer)

    @abstractmethod
    def _follow(self, variants: Variants, standing: Standing, longer: float) -> OneRegime: ...

    def hindered(self, variants: Variants) -> np.ndarray:
        """Verdict that rules out the regime before it is computed: a brake locks, or there is no inertia."""
        verdict = np.where(self.dynamics.locked(variants), Verdict.LOCKS, Verdict.OK)
        return np.where(self._without_inertia(variants), Verdict.NO_INERTIA, verdict).astype(np.uint8)

    def _without_inertia(self, variants: Variants) -> np.ndarray:
        return self.reduction.without_inertia(variants)

    def _stepping(self, longer: float) -> Stepping:
        """Steps of a run, or of a steady cycle at two speeds."""
        peaks = self.two is not None and self.asks(f"{self.two.name}_moment_peak")
        extremes = self.asks(*EXTREMES_OF_SPEED)
        return Stepping(*self._asked.run_tolerance, extremes=extremes, peaks=peaks, longer=longer)

    def _of_run(self, variants: Variants, outcome: RunOutcome) -> dict[str, np.ndarray]:
        """Results of a run, or of a steady cycle at two speeds, by their names without the regime's."""
        state, low, high = outcome.state, outcome.slowest, outcome.fastest
        turned = {"angle": state.turned, "displacement": state.turned}
        found = turned | {"time": state.time, "final_speed": state.omega}
        found |= {"speed_min": low, "speed_max": high, "implicit_steps": outcome.steep}
        works, change = (state.works, state.squares, state.time), outcome.ended - outcome.started
        return found | self._work_values(*works, change, outcome.energy, outcome.values.get("coupling_heat", 0.0))

    def _of_coupling(self, outcome: RunOutcome) -> dict[str, np.ndarray]:
        """Results of the coupling by their names without the regime's."""
        places = {"coupling": self.two.name, "shaft": self.two.coupling.shaft}
        split = {key: key.partition("_") for key in outcome.values}
        names = {key: f"{places[side]}_{rest}" if side in places else key for key, (side, _, rest) in split.items()}
        return {names[key]: value for key, value in outcome.values.items()}

    def _work_values(
        self,
        works: np.ndarray,
        squares: np.ndarray,
        time: np.ndarray,
        change: np.ndarray,
        turned_over: np.ndarray,
        heat: np.ndarray | float = 0.0,
    ) -> dict[str, np.ndarray]:
        """Results for work and power."""
        converted = turned_over + np.abs(works).sum(axis=0)
        with np.errstate(all="ignore"):
            found = {
                "motor_work": works[0],
                "motor_power": works[0] / time,
                "motor_moment_rms": np.sqrt(squares / time),
                "energy_change": change,
                # A machine at rest converts no energy.
                "work_residual": (works.sum(axis=0) - heat - change) / np.where(converted == 0.0, 1.0, converted),
            }
            if self.dynamics.works:
                by_channel = dict(zip(CHANNELS, works[1:], strict=True))
                found |= {f"{key}_work": by_channel[key] for key in ("driving", "other")}
                found |= {f"{key}_work": 0.0 - by_channel[key] for key in ("useful", "harmful")}
                found["brake_heat"] = 0.0 - by_channel["braking"]
                useful, supplied = found["useful_work"], works[0] + by_channel["driving"]
                # Undefined where the useful load drives, or nothing is supplied but for rounding.
                defined = (useful >= 0.0) & (supplied > ROUNDING * converted)
                found["efficiency"] = np.where(defined, useful / supplied, np.nan)
        return found
