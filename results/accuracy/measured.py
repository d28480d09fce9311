"""Errors and error figures of random machines under every setting that trades speed for accuracy, and their cost.

Every kind of machine is a task of its own: it draws its machines, finds their true summaries and evaluates them under
all settings. Times are measured afterwards, when nothing else runs.
"""

import time
from concurrent.futures import ProcessPoolExecutor
from typing import NamedTuple

import numpy as np
from closed_cycle import Cycle
from closed_summaries import Summaries, Truth
from random_machines import Kind, Varied, kinds, machines

from engine import Machine
from engine.compiling.jit import set_threads, threads
from engine.panels.accuracy import AccurateMachine

POSITIONS = (48, 96, 180, 360, 720, 1440, 2880, 5760)
ACCURACIES = (1e-2, 1e-3, 1e-4, 1e-6, 1e-8)
# Summaries of one kernel: compilers take more than twice as long for twice as many.
AT_ONCE = 30
# Summaries that an accuracy has no say in, or that may be zero: places and differences.
UNJUDGED = ("_at", "_difference")
VARIANTS, ROUNDS = 1000, 5
# A setting with many positions is timed on fewer variants.
POSITIONS_TIMED = 1_500_000


class Setting(NamedTuple):
    """How machines are evaluated: positions per cycle and precision, or an accuracy that is asked."""

    positions: int
    precision: str = "float64"
    accuracy: float = 0.0
    few: bool = False

    @property
    def compared(self) -> "Setting":
        """The default setting, asked for the same."""
        return Setting(720, few=self.few)

    @property
    def label(self) -> str:
        """Name in tables."""
        if self.accuracy:
            return f"accuracy {self.accuracy:g}"
        return f"{self.positions}" if self.precision == "float64" else f"{self.positions}, float32"

    def machines(self, kind: Kind, varied: Varied) -> list[Machine | AccurateMachine]:
        """Machines that together answer all that is asked of a kind; of few, what an accuracy judges."""
        asked = [name for name in kind.asked if not (self.few and name.endswith(UNJUDGED))]
        parts = [asked[i : i + AT_ONCE] for i in range(0, len(asked), AT_ONCE)]
        if self.accuracy:
            return [AccurateMachine(kind.scene, part, (), list(varied), self.accuracy) for part in parts]
        dtype = getattr(np, self.precision)
        return [Machine(kind.scene, part, (), list(varied), self.positions, dtype) for part in parts]


SETTINGS = (
    *(Setting(n) for n in POSITIONS),
    *(Setting(n, "float32") for n in POSITIONS),
    *(Setting(720, accuracy=a, few=True) for a in ACCURACIES),
)
DEFAULT = Setting(720)


class Errors(NamedTuple):
    """Of one summary under one setting, by variant: true error, error figure, what they are relative to, and more.

    `doubts` are the references' own, `truths` the true values (of several places the first).
    """

    errors: np.ndarray
    figures: np.ndarray
    scales: np.ndarray
    doubts: np.ndarray
    truths: np.ndarray


Found = dict[str, dict[Setting, dict[str, Errors]]]


def truths_of(kind: Kind, varied: Varied, k: int) -> dict[str, Truth]:
    """True summaries of one machine, those that are asked."""
    with np.errstate(all="ignore"):
        numbers = {path: float(values[k]) for path, values in varied.items()}
        found = Summaries(Cycle(kind.scene, numbers), set(kind.asked)).truths
    return {name: found[name] for name in kind.asked}


def scale_of(truths: dict[str, Truth], name: str, speed: float) -> float:
    """What an error is relative to: the peak of a field for its statistics, 1 for places and differences."""
    field = name.rpartition(".")[0]
    if name.endswith(("_at", "_difference")):
        return 1.0
    if f"{field}.max" in truths:
        return _peak(truths, field)
    if name in ("required_drive_moment", "required_power"):
        # The mean of a moment may vanish.
        return _peak(truths, "reduced_moment") * (speed if name == "required_power" else 1.0)
    return truths[name].size


def _peak(truths: dict[str, Truth], field: str) -> float:
    return max(truths[f"{field}.min"].size, truths[f"{field}.max"].size)


def errors_of(kind: Kind, varied: Varied, truths: list[dict[str, Truth]], setting: Setting) -> dict[str, Errors]:
    """True errors and error figures of all that is asked of a kind under a setting."""
    found, speeds = {}, np.abs(varied["input.speed"])
    for machine in setting.machines(kind, varied):
        outcome = machine.evaluate(varied)
        for name in machine.asked_summaries:
            true = [t[name] for t in truths]
            values = np.where(outcome.status == 0, outcome.summaries[name], np.nan)
            turn = name.endswith("_at")
            found[name] = Errors(
                np.array([t.error(v, turn) if np.isfinite(v) else np.nan for t, v in zip(true, values, strict=True)]),
                outcome.errors[name],
                np.array([scale_of(t, name, w) for t, w in zip(truths, speeds, strict=True)]),
                np.array([t.doubt for t in true]),
                np.array([float(t.values[0]) for t in true]),
            )
    return found


def measured_kind(index: int, count: int, settings: tuple[Setting, ...]) -> dict[Setting, dict[str, Errors]]:
    """Everything about one kind of machine but its times."""
    set_threads(1)
    kind = kinds()[index]
    varied = machines(kind, count)
    truths = [truths_of(kind, varied, k) for k in range(count)]
    return {setting: errors_of(kind, varied, truths, setting) for setting in settings}


def measured(count: int, settings: tuple[Setting, ...] = SETTINGS) -> Found:
    """Errors of `count` machines of every kind under every setting."""
    names = [kind.name for kind in kinds()]
    with ProcessPoolExecutor(threads()) as pool:
        tasks = [pool.submit(measured_kind, i, count, settings) for i in range(len(names))]
        return {name: task.result() for name, task in zip(names, tasks, strict=True)}


def costs(settings: tuple[Setting, ...] = SETTINGS) -> dict[Setting, float]:
    """Time per variant of each setting relative to the default, the median over the kinds; one thread."""
    set_threads(1)
    ratios: dict[Setting, list[float]] = {setting: [] for setting in settings}
    for kind in kinds():
        varied = machines(kind, VARIANTS)
        asked = {*settings, *(setting.compared for setting in settings)}
        times = {setting: _time(kind, varied, setting) for setting in asked}
        for setting in settings:
            ratios[setting].append(times[setting] / times[setting.compared])
    return {setting: float(np.median(found)) for setting, found in ratios.items()}


def _time(kind: Kind, varied: Varied, setting: Setting) -> float:
    """Seconds a variant, the median of several rounds."""
    count = min(VARIANTS, POSITIONS_TIMED // setting.positions)
    some = {path: values[:count] for path, values in varied.items()}
    made = setting.machines(kind, some)
    rounds = []
    for machine in made:
        machine.evaluate(some)
    for _ in range(ROUNDS):
        begin = time.thread_time()
        for machine in made:
            machine.evaluate(some)
        rounds.append(time.thread_time() - begin)
    return float(np.median(rounds)) / count
