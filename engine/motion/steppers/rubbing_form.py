"""The equation of motion in time of machines with friction in their pairs: I·ε + ½ω²·dI/dφ = M(φ, ω, t) + M_f.

The moment M_f that stands for friction follows from the reactions, and these from ω² and ε, so that ε is found with it,
by secants. Against which motion it acts is given by the way that the machine moves.
"""

import numpy as np

from engine.compiling.tiles import TileFunction
from engine.motion.moments.at_speed import Moments
from engine.motion.moments.dynamics import Dynamics, Rows, Variants
from engine.motion.steppers.rubbing import MOST_ROUNDS, SETTLED, Rubbing
from engine.motion.steppers.time_form import TimeForm
from engine.motion.system import CHANNELS

# The field of the loads on pairs that stands for friction.
FRICTION_MOMENT = "friction_moment"


class RubbingForm(TimeForm):
    """Steps of a set of variants with friction in pairs, in time; see `TimeForm`."""

    def along(
        self, turned: np.ndarray, omega: np.ndarray, time: np.ndarray, facing: np.ndarray
    ) -> tuple[Rows, Moments]:
        """Rows and moments at instants, (instants, variants), the moment of friction among those of harmful loads."""
        rows, moments = super().along(turned, omega, time, facing)
        with np.errstate(all="ignore"):
            free = (moments.total - 0.5 * omega * omega * rows.inertia_phi) / rows.inertia
            rubbed = self._friction(turned, omega, time, facing, free, rows.inertia)
        channel = CHANNELS.index("harmful") if self.dynamics.works else 0
        moments.loads[channel] += rubbed
        return rows, moments

    def _friction(
        self,
        turned: np.ndarray,
        omega: np.ndarray,
        time: np.ndarray,
        facing: np.ndarray,
        free: np.ndarray,
        inertia: np.ndarray,
    ) -> np.ndarray:
        """Moment of friction, in the direction of motion, at the ε that it leaves; `free` is ε without friction."""
        own, loads = self.variants, self.dynamics.friction
        places = self.start + own.direction * turned
        parameters = self._numbers(facing)

        def moment(epsilon: np.ndarray) -> np.ndarray:
            found = loads(own, parameters, places, np.abs(omega), own.direction * epsilon, time)
            return own.direction * found[FRICTION_MOMENT]

        before, rubbed = free, moment(free)
        # What is left over of I ε = I ε_free + M_f, over I.
        left_before = rubbed / inertia
        here = free + left_before
        for _ in range(MOST_ROUNDS):
            rubbed = moment(here)
            left = free + rubbed / inertia - here
            pending = np.abs(left) > SETTLED * (np.abs(free) + np.abs(rubbed / inertia))
            if not pending.any():
                break
            secant = here - left * (here - before) / (left - left_before)
            before, left_before = here, left
            here = np.where(pending & np.isfinite(secant), secant, here)
        return rubbed

    def _numbers(self, facing: np.ndarray) -> np.ndarray:
        """Numbers of the friction, (numbers, variants), for the way that each moves."""
        forward, backwards = self.variants.rubbing
        return np.require(np.where(facing > 0.0, forward, backwards), requirements="CW")

    def _rubbing(self, facing: np.ndarray) -> tuple[TileFunction, Rubbing, np.ndarray, int]:
        channel = CHANNELS.index("harmful") if self.dynamics.works else -1
        source = self.dynamics.friction.source(channel)
        return self.dynamics.friction.function, source, self._numbers(facing), self.dynamics.friction.curves


def form_in_time(dynamics: Dynamics, variants: Variants, start: np.ndarray) -> TimeForm:
    """The equation of motion in time of some variants, with friction in their pairs where there is any.

    Parameters
    ----------
    dynamics, variants, start
        As of `TimeForm`.
    """
    return (TimeForm if dynamics.friction is None else RubbingForm)(dynamics, variants, start)
