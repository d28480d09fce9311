"""Settings of the computation that aren't keys of a study: the rule of integration, tables, floating-point rules."""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from measured import DEFAULT, Found
from quantities import loads_of
from random_machines import kinds, machines
from scipy.integrate import cumulative_simpson, cumulative_trapezoid

from engine import Machine
from engine.compiling.jit import set_threads
from engine.laws.tables import make_table, table_value

RULE_POSITIONS = (48, 180, 720, 2880)
ROWS = (8, 12, 24, 48, 96)


# Rules of integration


def by_trapezoid(moment: np.ndarray, h: float) -> np.ndarray:
    """Work from equally spaced moments less their mean, the cycle's end too, (variants, positions + 1)."""
    return cumulative_trapezoid(_closed(moment), dx=h, initial=0)


def by_simpson(moment: np.ndarray, h: float) -> np.ndarray:
    """The same by Simpson's rule."""
    return cumulative_simpson(_closed(moment), dx=h, initial=0)


def by_harmonics(moment: np.ndarray, h: float) -> np.ndarray:
    """The same harmonic by harmonic."""
    n = moment.shape[1]
    orders = np.arange(n // 2 + 1)
    orders[0] = 1
    found = np.fft.rfft(moment - moment.mean(axis=1, keepdims=True)) / (1j * orders)
    found[:, -1] = 0
    return np.fft.irfft(found, n)


def between(work: np.ndarray, h: float) -> np.ndarray:
    """The work at sixteen times as many positions, by its harmonics."""
    n = work.shape[1]
    return np.fft.irfft(np.pad(np.fft.rfft(work)[:, : n // 2], ((0, 0), (0, 15 * n // 2 + 1))), 16 * n) * 16


def by_harmonics_between(moment: np.ndarray, h: float) -> np.ndarray:
    """Harmonic by harmonic, extremes searched between the positions too."""
    return between(by_harmonics(moment, h), h)


RULES = {
    "trapezoid": by_trapezoid,
    "Simpson": by_simpson,
    "harmonics": by_harmonics,
    "harmonics, between positions": by_harmonics_between,
}


def _closed(moment: np.ndarray) -> np.ndarray:
    moment = moment - moment.mean(axis=1, keepdims=True)
    return np.append(moment, moment[:, :1], axis=1)


def rules(found: Found, count: int) -> list[str]:
    """Lines of the table of rules: errors of the excess work and times, by loads."""
    lines = ["| loads | rule | " + " | ".join(f"{n}" for n in RULE_POSITIONS) + " | µs a variant at 720 |"]
    lines.append("|---" * (len(RULE_POSITIONS) + 3) + "|")
    errors: dict[tuple[str, str, int], list] = {}
    times: dict[str, list[float]] = {}
    for kind in kinds():
        varied = machines(kind, count)
        true = found[kind.name][DEFAULT]["excess_work"].truths
        for n in RULE_POSITIONS:
            moment = (
                Machine(kind.scene, (), ["reduced_moment"], list(varied), n).evaluate(varied).fields["reduced_moment"]
            )
            for name, rule in RULES.items():
                begin = time.thread_time()
                work = rule(moment, 2 * np.pi / n)
                if n == DEFAULT.positions:
                    times.setdefault(name, []).append((time.thread_time() - begin) / count * 1e6)
                error = abs(np.ptp(work, axis=1) / true - 1)
                errors.setdefault((loads_of(kind.name), name, n), []).append(error)
    for loads in ("smooth", "kinks", "jumps"):
        for name in RULES:
            cells = [np.quantile(np.concatenate(errors[loads, name, n]), 0.99) for n in RULE_POSITIONS]
            cost = f"{np.median(times[name]):.1f}"
            lines.append(f"| {loads} | {name} | " + " | ".join(f"{c:.1e}" for c in cells) + f" | {cost} |")
    return lines


# Tables


def torque(angle: np.ndarray) -> np.ndarray:
    """A smooth turning moment of three harmonics."""
    return np.sin(angle) + 0.4 * np.cos(2 * angle + 1) - 0.2 * np.sin(3 * angle)


def excess_of(moment: np.ndarray) -> float:
    """Excess work of a moment at many equally spaced angles."""
    work = by_trapezoid(moment[None], 2 * np.pi / moment.size)[0]
    return float(np.ptp(work))


def tables() -> list[str]:
    """Lines of the table of interpolations: error of the excess work of a smooth moment by its number of rows."""
    lines = ["| interpolation | " + " | ".join(f"{rows} rows" for rows in ROWS) + " |", "|---" * (len(ROWS) + 1) + "|"]
    fine = np.arange(100_000) * (2 * np.pi / 100_000)
    true = excess_of(torque(fine))
    for name in ("linear", "pchip", "spline"):
        cells = []
        for rows in ROWS:
            # Rows not at the angles where the moment is extreme or zero.
            x = 0.1 + np.arange(rows) * (2 * np.pi / rows)
            table = make_table(x, torque(x), name, 2 * np.pi)
            cells.append(abs(excess_of(np.array([table_value(*table, q) for q in fine])) / true - 1))
        lines.append(f"| {name} | " + " | ".join(f"{c:.1e}" for c in cells) + " |")
    return lines


# Floating-point rules


WITHOUT = """
import sys, numba
njit = numba.njit
numba.njit = lambda *a, **k: njit(*a, **(k | {"fastmath": False}))
sys.path[:0] = sys.argv[1:3]
import knobs
knobs.print_rules()
"""


def print_rules() -> None:
    """Time a variant at the default setting, and the greatest change of the excess work by rounding."""
    set_threads(1)
    kind = kinds()[0]
    varied = machines(kind, 1000)
    machine = Machine(kind.scene, ["excess_work", "input_moment.rms", "flywheel_wittenbauer"], (), list(varied))
    work = machine.evaluate(varied).summaries["excess_work"]
    rounds = []
    for _ in range(7):
        begin = time.thread_time()
        machine.evaluate(varied)
        rounds.append(time.thread_time() - begin)
    print(f"{np.median(rounds) * 1e3:.4f}", " ".join(value.hex() for value in work[:50]))


def floating_point() -> tuple[float, float, float]:
    """Time a variant [µs] with the engine's floating-point rules, strictly by IEEE 754, and how far results differ."""
    here = Path(__file__).parent
    answers = []
    with tempfile.TemporaryDirectory() as folder:
        for text in (WITHOUT.replace("numba.njit = ", "unused = "), WITHOUT):
            environment = os.environ | {"XDG_CACHE_HOME": str(Path(folder) / str(len(answers)))}
            command = [sys.executable, "-c", text, str(here), str(here.parents[1])]
            run = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
            first, *rest = run.stdout.split()
            answers.append((float(first), np.array([float.fromhex(value) for value in rest])))
    (fast, one), (strict, other) = answers
    return fast, strict, float(np.max(abs(one / other - 1)))
