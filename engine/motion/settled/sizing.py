"""The flywheel for a required speed fluctuation in steady running.

δ depends on the flywheel's inertia through the motion itself, as the motor torque varies with the speed. For a heavy
flywheel δ is proportional to 1/(I + I_F), so ln δ is nearly linear in ln(I + I_F); secants within a bracket find the
root for every variant.
"""

from collections.abc import Callable

import numpy as np

from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.settled.steady_with_friction import settled_motion
from engine.words.verdicts import Verdict

# Crank angles over which the inertia is averaged.
PLACES = 64
MOST_ROUNDS = 60
MOST_DOUBLINGS = 6
HEAVY = np.log(20.0)
SIZED = 1e-10
# Relative accuracy of the lightest flywheel with which the machine runs at all.
BOUNDED = 1e-6


def flywheel_for(
    dynamics: Dynamics, variants: Variants, tolerance: float, asked: np.ndarray, longer: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Flywheel for a required speed fluctuation in steady running.

    Parameters
    ----------
    dynamics : Dynamics
    variants : Variants
        Their current flywheel is replaced.
    tolerance : float
        As for `settled_motion`.
    asked : ndarray (variants,)
        Required δ.
    longer : float
        As for `settled_motion`.

    Returns
    -------
    flywheel : ndarray (variants,)
        Inertia on the input link [kg·m²]; 0 if the machine needs none, NaN without steady running.
    missed : ndarray (variants,)
        By how much it exceeds one that is too light [kg·m²]; 0 if it is found.
    verdict : ndarray (variants,) of uint8
    """
    lightest = np.log(dynamics.mean_inertia(variants._replace(flywheel=np.zeros(variants.count)), PLACES))

    def excess(inertia: np.ndarray, who: np.ndarray) -> np.ndarray:
        """Ln δ − ln δ_asked over the logarithm of the mean inertia; inf if the machine does not run."""
        part = variants.some(who)._replace(flywheel=np.exp(inertia) - np.exp(lightest[who]), kept={})
        steady = settled_motion(dynamics, part, tolerance, longer)
        verdict[who] = steady.verdict
        with np.errstate(all="ignore"):
            off = np.log(steady.fluctuation) - np.log(asked[who])
        return np.where(steady.verdict == Verdict.OK, off, np.inf)

    everyone, verdict = np.arange(variants.count), np.zeros(variants.count, np.uint8)
    heavy, f_heavy = _heavy_enough(excess, lightest + HEAVY, everyone)
    ruled = verdict.copy()
    light, f_light = lightest.copy(), np.full(variants.count, np.nan)
    best, slope, missed = heavy.copy(), np.full(variants.count, -1.0), np.zeros(variants.count)
    pending = np.flatnonzero(np.isfinite(f_heavy))
    for _ in range(MOST_ROUNDS):
        if not pending.size:
            break
        straight = heavy[pending] - f_heavy[pending] / slope[pending]
        inside = (straight > light[pending]) & (straight < heavy[pending])
        at_light = straight <= lightest[pending]
        trial = np.where(inside, straight, 0.5 * (light[pending] + heavy[pending]))
        # Once at most: without a flywheel the machine may not run.
        trial = np.where(at_light & np.isnan(f_light[pending]), lightest[pending], trial)
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
        exact = np.abs(f) <= SIZED
        best[pending] = np.where(exact, trial, heavy[pending])
        missed[pending] = np.where(exact, 0.0, np.exp(heavy[pending]) - np.exp(light[pending]))
        narrow = heavy[pending] - light[pending] <= np.where(np.isfinite(f_light[pending]), SIZED, BOUNDED)
        found = exact | narrow | (heavy[pending] <= lightest[pending])
        pending = pending[~found]
    flywheel = np.maximum(np.exp(best) - np.exp(lightest), 0.0)
    return np.where(ruled == Verdict.OK, flywheel, np.nan), missed, ruled


def _heavy_enough(
    excess: Callable[[np.ndarray, np.ndarray], np.ndarray], heavy: np.ndarray, who: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Logarithm of a mean inertia with a fluctuation below the required one, and ln of their ratio."""
    heavy, f = heavy.copy(), np.full(who.size, np.inf)
    for _ in range(MOST_DOUBLINGS):
        f[who] = excess(heavy[who], who)
        who = who[~(f[who] <= 0.0)]
        if not who.size:
            break
        # δ ~ 1/(I + I_F): three times the predicted inertia is a safe bound.
        heavy[who] += np.where(np.isfinite(f[who]), f[who] + np.log(3.0), HEAVY)
    return heavy, np.where(f <= 0.0, f, np.inf)
