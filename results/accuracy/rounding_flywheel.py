"""Rounding of the flywheel's sizes and of the fluctuation it leaves: small differences of large energies."""

import inspect

import mpmath as mp
import numpy as np
from engine.equal_positions.flywheel import fluctuation_with_flywheel, flywheel_sizes

POSITIONS, DIGITS, OMEGA = 720, 50, 10.0
phi = np.arange(POSITIONS) * (2 * np.pi / POSITIONS)
WORK = np.sin(phi) + 0.3 * np.cos(3 * phi) - 0.3
# What varies of the reduced inertia, and its constant part.
WAVE = 0.2 * np.cos(2 * phi + 0.4)
WHEELS = [3 * 10.0**k for k in range(-1, 13, 2)]
CONSTANTS = [10.0**k for k in range(0, 10, 3)]


def true_fluctuation(inertia: np.ndarray, work: np.ndarray, flywheel: float, omega: float) -> mp.mpf:
    """δ from the same rows in many digits: the initial energy by the secant rule."""
    loads, masses = [mp.mpf(float(w)) for w in work], [mp.mpf(float(i)) + mp.mpf(flywheel) for i in inertia]

    def speeds(energy: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
        squares = [2 * (energy + w) / i for w, i in zip(loads, masses, strict=True)]
        return mp.sqrt(min(squares)), mp.sqrt(max(squares))

    usual = masses[0] * mp.mpf(omega) ** 2 / 2
    energy = mp.findroot(lambda e: sum(speeds(e)) / 2 - omega, (usual, usual + max(loads)), solver="secant", tol=1e-60)
    slowest, fastest = speeds(energy)
    return (fastest - slowest) / omega


def true_wheel(inertia: np.ndarray, work: np.ndarray, omega: float, delta: float) -> mp.mpf:
    """Wittenbauer's flywheel from the same rows in many digits."""
    half, rate = mp.mpf(delta) / 2, mp.mpf(omega)
    fast, slow = ((rate * (1 + sign * half)) ** 2 / 2 for sign in (1, -1))
    pairs = [(mp.mpf(float(w)), mp.mpf(float(i))) for w, i in zip(work, inertia, strict=True)]
    return (max(w - fast * i for w, i in pairs) - min(w - slow * i for w, i in pairs)) / (2 * half * rate**2)


def plain_wheel(inertia: np.ndarray, work: np.ndarray, omega: float, delta: float) -> float:
    """The same without taking the constant part out."""
    fast, slow = (0.5 * (omega * (1 + sign * delta / 2)) ** 2 for sign in (1, -1))
    return float(((work - fast * inertia).max() - (work - slow * inertia).min()) / (delta * omega**2))


def fluctuation_rows() -> list[str]:
    """Relative errors of δ, from the speeds and by itself."""
    rows = []
    for wheel in WHEELS:
        inertia = 1.0 + WAVE
        with mp.workdps(DIGITS):
            true = true_fluctuation(inertia, WORK, wheel, OMEGA)
            found = fluctuation_with_flywheel(inertia, WORK, wheel, OMEGA)[1]
            slowest, fastest = OMEGA * (1.0 - 0.5 * found), OMEGA * (1.0 + 0.5 * found)
            errors = [float(abs(mp.mpf(x) / true - 1)) for x in ((fastest - slowest) / OMEGA, found)]
        rows.append(f"| {wheel:.0e} | {float(true):.1e} | {errors[0]:.1e} | {errors[1]:.1e} |")
    return rows


def wheel_rows() -> list[str]:
    """Errors of Wittenbauer's flywheel, relative to the larger of it and the constant inertia."""
    rows = []
    for constant in CONSTANTS:
        for delta in (1e-2, 1e-5, 1e-8):
            cells = []
            for inertia in (np.full(POSITIONS, constant), constant + WAVE):
                with mp.workdps(DIGITS):
                    true = true_wheel(inertia, WORK, OMEGA, delta)
                    found = flywheel_sizes(inertia, WORK, OMEGA, delta, 0.0)[3]
                    scale = max(abs(true), mp.mpf(constant))
                    pair = (plain_wheel(inertia, WORK, OMEGA, delta), found)
                    cells += [f"{float(abs(mp.mpf(float(x)) - true) / scale):.1e}" for x in pair]
            rows.append(f"| {constant:.0e} | {delta:.0e} | " + " | ".join(cells) + " |")
    return rows


def flywheel_lines() -> list[str]:
    """The tables of this file as lines of the report."""
    intro = inspect.cleandoc(
        """
        ## Flywheel: small fluctuations, heavy machines

        Against 50 digits from the same rows of 720 positions: work of about 2 J, I between 0.8 and 1.2 kg·m², 10 rad/s.
        The difference of the speeds over ω_m loses what δ is smaller than 1; `fluctuation_with_flywheel` doesn't.
        """
    )
    second = inspect.cleandoc(
        """
        Wittenbauer's flywheel of a machine with a constant inertia, alone or with a wave of 0.2 kg·m² on it; errors
        relative to the larger of the flywheel and the constant. Before: extremes of W − ½ω² I as they stand. After: the
        first value of I taken out beforehand. What the sum of constant and wave lost when the row was written, half an
        ulp of I over δ, is of neither.
        """
    )
    fluctuation = ["| flywheel [kg·m²] | δ | from the speeds | by itself |", "|---|---|---|---|", *fluctuation_rows()]
    head = "| constant [kg·m²] | δ | constant alone: before | after | with a wave: before | after |"
    return [intro, "", *fluctuation, "", second, "", head, "|---|---|---|---|---|---|", *wheel_rows(), ""]
