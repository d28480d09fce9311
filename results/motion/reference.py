"""Reference motion of the variants: heyoka.py in extended precision, compared with SciPy and with mpmath.

    python results/motion/reference.py

computes one variant of two machines with mpmath's Taylor method at 30 digits (some minutes), and writes
thirty_digits.json, which the benchmark compares its reference with.
"""

import json
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import heyoka
import mpmath as mp
import numpy as np
from cases import CASES, Case, one_variant, prepare, sample
from peers import first_energy, inertia, prepare_scipy, taylor_system

THIRTY_DIGITS = Path(__file__).parent / "thirty_digits.json"
DIGITS = 30
# Both machines have jumps; both come with an induction motor.
CHECKED = ("crank_press", "shaper")
# float64's rounding over some thousand stages of DOP853, whose least tolerance this is
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


def by_mpmath(case: Case, varied: dict[str, float]) -> tuple[str, str]:
    """ω and t at the end of one variant, as texts of the digits that mpmath works with."""
    with mp.workdps(DIGITS):
        functions = SimpleNamespace(
            pi=+mp.pi, sqrt=mp.sqrt, cos=mp.cos, sin=mp.sin, arccos=mp.acos, arcsin=mp.asin, arctan2=mp.atan2
        )
        p, (edges, rams) = one_variant(case, varied, mp.mpf, functions)
        reduced = case.reduced(mp.sqrt)

        def at(phi: mp.mpf, ram: mp.mpf) -> tuple:
            return reduced(mp.cos(phi), mp.sin(phi), ram, p)

        energy, t = at(edges[0], rams[0])[0] * mp.mpf(case.speed) ** 2 / 2, mp.mpf(0)
        for _ in range(case.revolutions):
            for ram, (start, end) in zip(rams, pairwise(edges), strict=True):

                def rates(phi: mp.mpf, state: list, ram: mp.mpf = ram) -> list:
                    found, _, moment = at(phi, ram)
                    omega = mp.sqrt(2 * state[0] / found)
                    return [moment + case.motor(omega, p), 1 / omega]

                energy, t = mp.odefun(rates, start, [energy, t])(end)
        return mp.nstr(mp.sqrt(2 * energy / at(edges[0], rams[0])[0]), DIGITS), mp.nstr(t, DIGITS)


def checked_variant(case: Case) -> dict[str, np.ndarray]:
    """The variant that mpmath was given."""
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


def main() -> None:
    kept = {}
    for name in CHECKED:
        varied = {path: float(values[0]) for path, values in checked_variant(CASES[name]).items()}
        kept[name] = by_mpmath(CASES[name], varied)
        print(name, *kept[name], flush=True)
    THIRTY_DIGITS.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf8")


if __name__ == "__main__":
    main()
