"""The flywheel that keeps the speed fluctuation of the true steady motion at what is asked.

δ depends on the flywheel's inertia through the motion itself: the motor gives way where it slows down. With a heavy
flywheel δ goes with 1/(I + I_F), so ln δ is nearly straight in ln(I + I_F); its root is found for every variant by
secants within a bracket.
"""

from collections.abc import Callable

import numpy as np

from engine.compiling.running import mean_of_rows
from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.settled.rubbing_steady import settled_motion
from engine.words.verdicts import Verdict

# Crank angles over which the inertia is averaged.
PLACES = 64
MOST_ROUNDS = 60
MOST_DOUBLINGS = 6
HEAVY = np.log(20.0)
SIZED = 1e-10
# The lightest flywheel with which a machine runs at all is found only so far.
BOUNDED = 1e-6


def flywheel_for(
    dynamics: Dynamics, variants: Variants, tolerance: float, asked: np.ndarray, doubtful: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Flywheel for an asked speed fluctuation in true steady motion.

    Parameters
    ----------
    dynamics : Dynamics
    variants : Variants
        With the flywheel they have; what is found replaces it.
    tolerance : float
        As of `settled_motion`.
    asked : ndarray (variants,)
        δ.
    doubtful : bool
        Whether the motion is changed by what it may be off by.

    Returns
    -------
    flywheel : ndarray (variants,)
        Inertia on the input link [kg·m²]; 0 where the machine needs none, NaN where there is no steady motion.
    verdict : ndarray (variants,) of uint8
    """
    step = dynamics.cycle / PLACES
    places = np.broadcast_to(step * np.arange(PLACES)[:, None], (PLACES, variants.count))
    bare = dynamics.rows(variants._replace(flywheel=np.zeros(variants.count)), places)
    lightest = np.log(mean_of_rows(bare.inertia))

    def excess(inertia: np.ndarray, who: np.ndarray) -> np.ndarray:
        """Ln δ − ln δ_asked with a mean inertia, by its logarithm; inf where the machine doesn't run."""
        part = variants.some(who)._replace(flywheel=np.exp(inertia) - np.exp(lightest[who]), kept={})
        steady = settled_motion(dynamics, part, tolerance, doubtful)
        verdict[who] = steady.verdict
        with np.errstate(all="ignore"):
            off = np.log(steady.fluctuation) - np.log(asked[who])
        return np.where(steady.verdict == Verdict.OK, off, np.inf)

    everyone, verdict = np.arange(variants.count), np.zeros(variants.count, np.uint8)
    heavy, f_heavy = _heavy_enough(excess, lightest + HEAVY, everyone)
    ruled = verdict.copy()
    light, f_light = lightest.copy(), np.full(variants.count, np.inf)
    best, slope = heavy.copy(), np.full(variants.count, -1.0)
    pending = np.flatnonzero(np.isfinite(f_heavy))
    for _ in range(MOST_ROUNDS):
        if not pending.size:
            break
        straight = heavy[pending] - f_heavy[pending] / slope[pending]
        inside = (straight > light[pending]) & (straight < heavy[pending])
        at_light = straight <= lightest[pending]
        trial = np.where(inside, straight, 0.5 * (light[pending] + heavy[pending]))
        trial = np.where(at_light & ~np.isfinite(f_light[pending]), lightest[pending], trial)
        f = excess(trial, pending)
        enough = f <= 0.0
        with np.errstate(all="ignore"):
            secant = (f - f_heavy[pending]) / (trial - heavy[pending])
        slope[pending] = np.where(np.isfinite(secant) & (secant < 0.0), secant, -1.0)
        light[pending] = np.where(enough, light[pending], trial)
        f_light[pending] = np.where(enough, f_light[pending], f)
        heavy[pending], f_heavy[pending] = (
            np.where(enough, trial, heavy[pending]),
            np.where(enough, f, f_heavy[pending]),
        )
        best[pending] = np.where(np.abs(f) <= SIZED, trial, heavy[pending])
        narrow = heavy[pending] - light[pending] <= np.where(np.isfinite(f_light[pending]), SIZED, BOUNDED)
        found = (np.abs(f) <= SIZED) | narrow | (heavy[pending] <= lightest[pending])
        pending = pending[~found]
    flywheel = np.maximum(np.exp(best) - np.exp(lightest), 0.0)
    return np.where(ruled == Verdict.OK, flywheel, np.nan), ruled


def _heavy_enough(
    excess: Callable[[np.ndarray, np.ndarray], np.ndarray], heavy: np.ndarray, who: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """A mean inertia, by its logarithm, with which the fluctuation is below what is asked, and ln of the ratio."""
    heavy, f = heavy.copy(), np.full(who.size, np.inf)
    for _ in range(MOST_DOUBLINGS):
        f[who] = excess(heavy[who], who)
        who = who[~(f[who] <= 0.0)]
        if not who.size:
            break
        # δ goes with 1/(I + I_F): with three times what that asks for, it is surely enough.
        heavy[who] += np.where(np.isfinite(f[who]), f[who] + np.log(3.0), HEAVY)
    return heavy, np.where(f <= 0.0, f, np.inf)
