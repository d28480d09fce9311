"""How many passes friction in pairs takes, against friction that has settled in extended precision.

    python results/accuracy/passes.py

writes passes.md beside this file.
"""

import argparse
import platform
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np
from closed_friction import Rubbed, Settled
from quantities import TARGETS
from random_machines import SEED, Kind, Varied, kinds, machines
from timing import microseconds

from engine import Machine, Scene
from engine.compiling.threads import set_threads, threads
from engine.scene.pairs import Pair, pairs

HERE = Path(__file__).parent
# Not a multiple of four: where symmetric machines are at rest friction has no direction.
POSITIONS = 50
PASSES = (1, 2, 3, 4, 5, 6, 8, 12, 20, 40)
SHOWN = PASSES[:5]
ENOUGH = 80
# Least determinants of friction's feedback: 1 without friction, 0 where the machine jams.
MARGINS = {"0.9 … 1": 0.9, "0.5 … 0.9": 0.5, "0.1 … 0.5": 0.1, "0 … 0.1": 0.0}
ASKED = ("friction_loss", "input moment", "reactions")
# A machine that jams is given so much of its friction, until it doesn't.
LESS = 0.85
TIMED, VARIANTS = ("slider-crank", "crank-rocker"), 1000


class Case(NamedTuple):
    """A machine with its friction settled.

    Least determinant, input moment with friction (positions,), errors of ASKED after PASSES by way of passing.
    """

    margin: float
    moment: np.ndarray
    errors: np.ndarray


def rubbed(kind: Kind) -> Scene:
    """The machine with friction in all pairs of its groups; sliders on the frame are so short that they may tilt."""
    found = {}
    for pair in rubbing(kind.scene):
        own = {"diameter": 0.03} if pair.kind == "revolute" else {}
        if pair.kind == "prismatic" and pair.name.endswith("second"):
            own = {"length": 0.06}
        found[path_of(pair)] = {"pair": pair.name, "coefficient": 0.1, **own}
    return Scene.model_validate(kind.scene.model_dump() | {"friction": found})


def rubbing(scene: Scene) -> list[Pair]:
    """Pairs of the groups of a scene."""
    return [pair for pair in pairs(scene) if pair.name.partition(".")[0] in scene.groups]


def path_of(pair: Pair) -> str:
    """Name of a pair's friction."""
    return pair.name.replace(".", "_")


def frictions(scene: Scene, random: np.random.Generator, count: int) -> Varied:
    """Coefficients from 0.01 to 1, alike within a factor of two in all pairs of a machine."""
    general = 0.01 * 100 ** random.random(count)
    return {
        f"friction.{path_of(pair)}.coefficient": general * 2 ** random.uniform(-0.5, 0.5, count)
        for pair in rubbing(scene)
    }


def cases(index: int, count: int) -> tuple[list[Case], Varied]:
    """Errors of machines of a kind, and the machines with as much friction as they bear."""
    kind = kinds()[index]
    scene, varied = rubbed(kind), machines(kind, count)
    drawn = frictions(scene, np.random.default_rng([SEED, *kind.name.encode()]), count)
    found = []
    for i in range(count):
        numbers = {path: float(values[i]) for path, values in varied.items()}
        while True:
            machine = Rubbed(scene, numbers | {path: float(f[i]) for path, f in drawn.items()}, POSITIONS)
            true = machine.settle(ENOUGH)
            if true.margin > 0 and true.change < 1e-15:
                break
            for f in drawn.values():
                f[i] *= LESS
        moment = machine.input_moment[0] + np.sign(machine.numbers["input.speed"]) * true.lost
        found.append(Case(true.margin, np.asarray(moment, float), errors_of(machine, true)))
    return found, varied | drawn


def errors_of(machine: Rubbed, true: Settled) -> np.ndarray:
    """Errors of ASKED after PASSES, exactly solved and substituted, relative to peaks."""
    without = machine.input_moment[0]
    sign = np.sign(machine.numbers["input.speed"])

    def answers(settled: Settled) -> list[np.ndarray]:
        return [settled.lost.sum()[None], without + sign * settled.lost, *settled.reactions.values()]

    found = np.empty((len(ASKED), len(PASSES), 2))
    for k, passes in enumerate(PASSES):
        for way in (0, 1):
            pairs_of = zip(answers(machine.settle(passes, way == 1)), answers(true), strict=True)
            each = [_error(*both) for both in pairs_of]
            found[:, k, way] = *each[:2], max(each[2:])
    return found


def _error(found: np.ndarray, true: np.ndarray) -> float:
    """Greatest error over the positions relative to the peak, of a reaction that of either component."""
    found, true = np.atleast_2d(found), np.atleast_2d(true)
    return float((abs(found - true).max(axis=1) / abs(true).max(axis=1)).max())


class Times(NamedTuple):
    """Times of a variant without friction in pairs and with it [µs]."""

    without: float
    rubbed: float


class Found(NamedTuple):
    """Of all machines: margins, errors (machines, asked, passes, ways).

    `agreement` is the greatest difference of the engine's input moment with friction from the settled one, relative to
    its peak, of the kinds TIMED; `times` are those of `timed` by kind.
    """

    margins: np.ndarray
    errors: np.ndarray
    agreement: float
    times: dict[str, Times]


def measured(count: int) -> Found:
    """Errors of `count` machines of every kind, and times."""
    with ProcessPoolExecutor(threads()) as pool:
        every = list(pool.map(cases, range(len(kinds())), [count] * len(kinds())))
    found = [case for some, _ in every for case in some]
    agreements, times = [], {}
    for kind, (some, varied) in zip(kinds(), every, strict=True):
        if kind.name in TIMED:
            agreements.append(_agreement(kind, varied, np.stack([case.moment for case in some])))
            times[kind.name] = timed(kind, varied)
    return Found(
        np.array([case.margin for case in found]), np.stack([case.errors for case in found]), max(agreements), times
    )


def _asked(kind: Kind) -> list[str]:
    return ["input_moment.max", *(f"{pair.name}.reaction.max" for pair in rubbing(kind.scene))]


def _agreement(kind: Kind, varied: Varied, moments: np.ndarray) -> float:
    """Greatest difference of the engine's input moment with friction, relative to its peak, at the same positions."""
    machine = Machine(rubbed(kind), (), ["input_moment_with_friction"], list(varied), POSITIONS)
    found = machine.evaluate(varied).fields["input_moment_with_friction"]
    return float((abs(found - moments).max(axis=1) / abs(moments).max(axis=1)).max())


def timed(kind: Kind, varied: Varied) -> Times:
    """Times of a kind of machine."""
    set_threads(1)
    bare = Machine(kind.scene, _asked(kind), (), [path for path in varied if not path.startswith("friction.")])
    machine = Machine(rubbed(kind), [*_asked(kind), "friction_loss"], (), list(varied))
    without = microseconds(bare, {path: np.resize(varied[path], VARIANTS) for path in bare.varied})
    with_friction = microseconds(machine, {path: np.resize(values, VARIANTS) for path, values in varied.items()})
    return Times(without, with_friction)


def _classes(found: Found) -> dict[str, np.ndarray]:
    """Which machines have a margin against jamming within a range, by its name."""
    names, limits = list(MARGINS), [1.0, *MARGINS.values()]
    # A determinant may come out a rounding above 1.
    inside = np.minimum(found.margins, 1.0)
    return {
        name: (inside > low) & (inside <= high) for name, low, high in zip(names, limits[1:], limits[:-1], strict=True)
    }


def choices(found: Found) -> list[str]:
    """Lines of the table of the passes that keep 99 % of the machines within an error: solved, substituted."""
    lines = ["| least determinant | machines | | " + " | ".join(TARGETS) + " |", "|---" * (len(TARGETS) + 3) + "|"]
    for name, which in _classes(found).items():
        for k, asked in enumerate(ASKED):
            errors = np.quantile(found.errors[which, k], 0.99, axis=0)
            cells = [" / ".join(_least(errors[:, way], target) for way in (0, 1)) for target in TARGETS.values()]
            lines.append(f"| {name} | {which.sum()} | {asked} | " + " | ".join(cells) + " |")
    return lines


def _least(errors: np.ndarray, target: float) -> str:
    enough = np.flatnonzero(errors <= target)
    return str(PASSES[enough[0]]) if enough.size else "–"


def errors(found: Found) -> list[str]:
    """Lines of the table of errors of exactly solved passes: median, 99 % and worst of the machines."""
    lines = ["| least determinant | | " + " | ".join(f"{n}" for n in SHOWN) + " |", "|---" * (len(SHOWN) + 2) + "|"]
    for name, which in _classes(found).items():
        for k, asked in enumerate(ASKED):
            some = found.errors[which, k, :, 0]
            levels = zip(np.median(some, axis=0), np.quantile(some, 0.99, axis=0), some.max(axis=0), strict=True)
            cells = [" ".join(f"{v:.0e}" for v in level) for level, _ in zip(levels, SHOWN, strict=False)]
            lines.append(f"| {name} | {asked} | " + " | ".join(cells) + " |")
    return lines


def cost(found: Found) -> str:
    """What passes cost, as a sentence."""
    return "; ".join(
        f"{name}: {t.without:.1f} µs a variant without friction, {t.rubbed:.1f} with it"
        for name, t in found.times.items()
    )


TEXT = """# Passes of friction

{count} machines with friction in all pairs of their groups, coefficients from 0.01 up to where they jam, sliders on
the frame so short that they may tilt; errors relative to peaks, against passes until nothing changes in 80 bits
(`closed_friction.py`), to which the engine's input moment comes within {agreement} (two kinds). The least determinant
of friction's feedback in the cycle (`jamming_margin`) is 1 without friction, 0 where a machine jams.
Made by `python results/accuracy/passes.py`; {system}.

Passes that keep 99 % of the machines within an error: before the stroke such as take the directions of the reactions
from the pass before and solve for what presses; after it as textbooks do, which take friction from the pass before.
"–": not in 40.

{choices}

Errors after so many passes of the first sort: median, 99 % and worst.

{errors}

{cost}.
"""


def main() -> None:
    """Measure and write the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--machines", type=int, default=100, help="of each kind")
    found = measured(parser.parse_args().machines)
    text = TEXT.format(
        count=found.margins.size,
        agreement=f"{found.agreement:.0e}",
        system=f"{platform.machine()}, Python {platform.python_version()}, times on one thread",
        choices="\n".join(choices(found)),
        errors="\n".join(errors(found)),
        cost=cost(found),
    )
    (HERE / "passes.md").write_text(text, encoding="utf8")


if __name__ == "__main__":
    main()
