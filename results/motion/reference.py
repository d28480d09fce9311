"""Reference motion of the variants: heyoka.py in extended precision, compared with SciPy and with mpmath.

thirty_digits.json has one variant of two machines by mpmath's Taylor method at 30 digits; `reference.py` of commit
7392f700 made it, in some minutes.
"""

import json
from pathlib import Path

import heyoka
import numpy as np
from cases import CASES, Case, prepare, sample
from peers import first_energy, inertia, prepare_scipy, taylor_system

THIRTY_DIGITS = Path(__file__).parent / "thirty_digits.json"
# Rounding of float64 over some thousand stages of DOP853, at its minimum tolerance.
SCIPY_TOLERANCE, SCIPY_AGREEMENT = 1e-13, 1e-11
# The reference is rounded to float64 at the end; its own errors are three digits below that.
AGREEMENT = 4 * float(np.finfo(float).eps)


def extended(case: Case, varied: dict[str, np.ndarray]) -> np.ndarray:
    """ω and t at the end, (2, variants), by Taylor's method in long double, from the same float64 numbers.

    Parameters
    ----------
    case : Case
    varied : dict of str to ndarray (variants,)
        As from `sample`.
    """
    real = np.longdouble
    batch = prepare(case, varied, real)
    constants = batch.p.shape[0]
    integrator = heyoka.taylor_adaptive(
        taylor_system(case, constants),
        state=np.ones(2, real),
        pars=np.ones(constants + 2, real),
        fp_type=real,
        tol=np.finfo(real).eps,
    )
    first, last = first_energy(case, batch), inertia(case, batch, -1)
    out = np.empty((2, batch.variants), real)
    for v in range(batch.variants):
        integrator.pars[:constants], integrator.pars[constants + 1] = batch.p[:, v], first[v]
        integrator.state[:] = 1, 0
        integrator.time = batch.edges[0, v]
        for ram, end in zip(batch.ram[:, v], batch.edges[1:, v], strict=True):
            integrator.pars[constants] = ram
            integrator.propagate_until(end)
        out[:, v] = integrator.state
    out[0] = np.sqrt(2 * out[0] * first / last)
    return out.astype(float)


def checked_variant(case: Case) -> dict[str, np.ndarray]:
    """The variant computed by mpmath."""
    return sample(case, 1, seed=3)


def require_agreement(case: Case, what: str, found: np.ndarray, expected: np.ndarray, bound: float) -> None:
    worst = float(np.max(np.abs(found / expected - 1)))
    if not worst <= bound:
        raise SystemExit(f"{case.name}: the reference differs from {what} by {worst:.1e}, more than {bound:.0e}")


def reference(name: str, varied: dict[str, np.ndarray]) -> np.ndarray:
    """Reference ω and t, (2, variants), after its checks.

    Raises
    ------
    SystemExit
        It disagrees with SciPy's DOP853, or with the results of mpmath that are kept.
    """
    case = CASES[name]
    found = extended(case, varied)
    few = {path: values[:4] for path, values in varied.items()}
    by_scipy = prepare_scipy(case, prepare(case, few), SCIPY_TOLERANCE, method="DOP853")(slice(0, 4))
    require_agreement(case, "SciPy", found[:, :4], by_scipy, SCIPY_AGREEMENT)
    kept = json.loads(THIRTY_DIGITS.read_text(encoding="utf8"))
    if case.name in kept:
        digits = np.array([float(text) for text in kept[case.name]])[:, None]
        require_agreement(case, "mpmath", extended(case, checked_variant(case)), digits, AGREEMENT)
    return found
