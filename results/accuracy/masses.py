"""What two point masses in the joints of a rod miss, and what replacement masses cost, on random machines.

    python results/accuracy/masses.py

writes masses.md beside this file.
"""

import argparse
import platform
from pathlib import Path
from typing import NamedTuple

import numpy as np
from quantities import loads_of
from random_machines import SEED, Kind, Varied, kinds, machines
from timing import microseconds

from engine import Machine, Scene
from engine.compiling.threads import set_threads

HERE = Path(__file__).parent
# Groups whose first link is replaced, by kind of machine.
RODS = {
    "slider-crank": ("g",),
    "crank-rocker": ("g",),
    "compressor": ("g",),
    "Watt six-bar": ("g", "h"),
    "toggle press": ("g", "h"),
    "crank shaper": ("g",),
}
VECTORS = {
    "input moment": ("input_moment",),
    "reaction in the rod's first joint": ("g.first.reaction_x", "g.first.reaction_y"),
    "in its second": ("g.inner.reaction_x", "g.inner.reaction_y"),
    "shaking force": ("shaking_force_x", "shaking_force_y"),
    "shaking moment": ("shaking_moment",),
}
# The flywheel for the δ asked, or the δ of the flywheel given.
NUMBERS = {"excess work": "excess_work", "flywheel, or δ": ("speed_fluctuation", "flywheel_wittenbauer")}
# Of |ab/k² − 1|: how far the moment of inertia of two masses is from the rod's.
RATIOS = {"below 0.1": 0.1, "0.1 … 0.5": 0.5, "0.5 … 1": 1.0, "above 1": np.inf}
POSITIONS = 360
TIMED, VARIANTS = "slider-crank", 1000
REPLACEMENTS = {
    "two static masses": {"type": "static", "at": ["A", "B"]},
    "two dynamic ones": {"type": "dynamic", "at": ["A"]},
    "three dynamic ones": {"type": "dynamic", "at": ["A", "centre", "B"]},
}


class Found(NamedTuple):
    """Errors (machines,) by loads and by what is asked, and how far from the rod's the masses' inertia is.

    `agreement` is how far the engine's static replacement is from the rod with their inertia, `times` the time of a
    variant with bodies and with each of REPLACEMENTS [µs].
    """

    errors: dict[str, np.ndarray]
    loads: np.ndarray
    ratios: np.ndarray
    agreement: float
    times: dict[str, float]


def with_rods(kind: Kind, count: int) -> tuple[Varied, Varied, np.ndarray]:
    """Machines whose rods are as `replacement_masses.py` draws them, the same with two masses, greatest |ab/k² − 1|.

    Two masses in the joints have the rod's mass and centre; their moment of inertia is m a b instead of m k².
    """
    random, varied = np.random.default_rng([SEED, *kind.name.encode()]), machines(kind, count)
    masses, ratio = {}, np.zeros(count)
    for name in RODS[kind.name]:
        body = f"bodies.{kind.scene.groups[name].first.link}_body"
        length = varied[f"groups.{name}.first.length"]
        share, gyration = random.uniform(0.25, 0.6, count), random.uniform(0.25, 0.45, count)
        mass = varied.get(f"{body}.mass", np.ones(count))
        varied |= {f"{body}.mass": mass, f"{body}.x": share * length, f"{body}.y": np.zeros(count)}
        varied[f"{body}.inertia"] = mass * (gyration * length) ** 2
        masses[f"{body}.inertia"] = mass * share * (1 - share) * length**2
        ratio = np.maximum(ratio, abs(share * (1 - share) / gyration**2 - 1))
    return varied, varied | masses, ratio


def _machine(scene: Scene, varied: Varied) -> Machine:
    sized = scene.flywheel.speed_fluctuation is not None
    fields = [field for components in VECTORS.values() for field in components]
    summaries = [NUMBERS["excess work"], NUMBERS["flywheel, or δ"][sized]]
    return Machine(scene, summaries, fields, list(varied), POSITIONS)


def _answers(machine: Machine, varied: Varied) -> dict[str, np.ndarray]:
    """All that is compared, (components, machines, positions)."""
    outcome = machine.evaluate(varied)
    found = {name: np.stack([outcome.fields[f] for f in fields]) for name, fields in VECTORS.items()}
    numbers = zip(NUMBERS, machine.asked_summaries, strict=True)
    return found | {name: outcome.summaries[asked][None, :, None] for name, asked in numbers}


def _errors(found: dict[str, np.ndarray], true: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Greatest error over the cycle relative to the peak."""
    return {
        name: np.linalg.norm(found[name] - true[name], axis=0).max(axis=1)
        / np.linalg.norm(true[name], axis=0).max(axis=1)
        for name in true
    }


def measured(count: int) -> Found:
    """Errors of `count` machines of every kind, and times of one."""
    set_threads(1)
    parts, loads, ratios = [], [], []
    for kind in kinds():
        if kind.name in RODS:
            rods, masses, ratio = with_rods(kind, count)
            machine = _machine(kind.scene, rods)
            parts.append(_errors(_answers(machine, masses), _answers(machine, rods)))
            loads += [loads_of(kind.name)] * count
            ratios.append(ratio)
            if kind.name == TIMED:
                many = {path: np.resize(values, VARIANTS) for path, values in rods.items()}
                agreement, times = _replaced(kind, rods, many, _answers(machine, masses))
                times = {"its body": microseconds(machine, many)} | times
    every = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return Found(every, np.array(loads), np.concatenate(ratios), agreement, times)


def _replaced(kind: Kind, rods: Varied, many: Varied, masses: dict[str, np.ndarray]) -> tuple[float, dict[str, float]]:
    """How far the engine's static masses are from the rod with their inertia, and times over many."""
    times, scene = {}, kind.scene.model_dump()
    for name, replacement in REPLACEMENTS.items():
        body = scene["bodies"]["rod_body"] | {"y": 0.0, "replace": replacement}
        machine = _machine(Scene.model_validate(scene | {"bodies": scene["bodies"] | {"rod_body": body}}), rods)
        times[name] = microseconds(machine, many)
        if name == "two static masses":
            agreement = max(error.max() for error in _errors(_answers(machine, rods), masses).values())
    return float(agreement), times


def lines(found: Found) -> list[str]:
    """Lines of the table of errors: median, 99 % and worst of the machines, by loads and by the rods' inertia."""
    sets = {f"loads: {loads}": found.loads == loads for loads in dict.fromkeys(found.loads)}
    limits = [-1.0, *RATIOS.values()]
    for name, low, high in zip(RATIOS, limits[:-1], limits[1:], strict=True):
        sets[f"ab/k² − 1 {name}"] = (found.ratios > low) & (found.ratios <= high)
    head = ["| | machines | " + " | ".join(found.errors) + " |", "|---" * (len(found.errors) + 2) + "|"]
    for name, which in sets.items():
        some = [errors[which] for errors in found.errors.values()]
        cells = [f"{np.median(e):.0e} {np.quantile(e, 0.99):.0e} {e.max():.0e}" for e in some]
        head.append(f"| {name} | {which.sum()} | " + " | ".join(cells) + " |")
    return head


def cost(found: Found) -> str:
    """What replacement masses cost, as a part of a sentence."""
    return ", ".join(f"{each:.1f} µs with {name}" for name, each in found.times.items())


TEXT = """# Replacement masses on random machines

{count} machines, their rods drawn as in `replacement_masses.py`: what two masses in the joints of the rods miss, the
greatest error over the cycle relative to the peak, median, 99 % and worst. They have the rod's mass and centre, and
m·a·b for its m·k². The engine's `replace` is that to {agreement}; a dynamic replacement is the rod itself to
rounding (`replacement_masses.md`). Made by `python results/accuracy/masses.py`; {system}.

{lines}

A variant takes {cost}, {positions} positions of nine fields kept.

Two static masses are within 1 % of the input moment, the flywheel and δ of 99 % of the machines only where ab is within
10 % of k²; the shaking force and the excess work of the loads they keep exactly, wherever k² is. Of a given scene
`BODY.replacement_error` tells.
"""


def main() -> None:
    """Measure and write the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--machines", type=int, default=200, help="of each kind")
    found = measured(parser.parse_args().machines)
    text = TEXT.format(
        count=found.ratios.size,
        agreement=f"{found.agreement:.0e}",
        system=f"{platform.machine()}, Python {platform.python_version()}, times on one thread",
        lines="\n".join(lines(found)),
        cost=cost(found),
        positions=POSITIONS,
    )
    (HERE / "masses.md").write_text(text, encoding="utf8")


if __name__ == "__main__":
    main()
