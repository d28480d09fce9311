"""What each option of a machine's dynamics costs; writes options.md.

One thread, the geometry of the benchmark's machines varied: every variant has a shape of its own. Each row asks for
what the row before asks for and something more.

    python results/performance/options.py
"""

import argparse
import platform
import time
from pathlib import Path

import numpy as np
from machines import CASES, Case, sample

from engine import Machine, Scene
from engine.compiling.threads import set_threads
from engine.scene.pairs import pairs

HERE = Path(__file__).parent
VARIANTS, POSITIONS, ROUNDS = 1024, 720, 5


def rubbing(scene: Scene) -> Scene:
    """The machine with friction in all of its pairs."""
    journal, guide = {"coefficient": 0.08, "diameter": 0.02}, {"coefficient": 0.08, "length": 0.05}
    friction = {
        f"f{i}": {"pair": pair.name, **(journal if pair.kind == "revolute" else guide)}
        for i, pair in enumerate(pairs(scene))
    }
    return changed(scene, friction=friction)


def changed(scene: Scene, **parts: object) -> Scene:
    """The machine with some of its tables replaced."""
    return Scene.model_validate({**scene.model_dump(exclude_unset=True), **parts})


def asked(scene: Scene) -> dict[str, tuple[Scene, list[str], list[str]]]:
    """Rows of the table: machine, summaries and fields."""
    position = ["B.x.max"]
    inertia = [*position, "reduced_inertia.max"]
    moments = [*inertia, "required_drive_moment"]
    forces = [*moments, *(f"{pair.name}.reaction.max" for pair in pairs(scene))]
    losses = [*forces, "friction_loss"]
    first = next(iter(scene.groups))
    one = changed(scene, friction={"f": rubbing(scene).friction["f1"].model_dump(exclude_unset=True)})
    light = changed(scene, gravity=0.0)
    return {
        "position of a point": (light, position, []),
        "and reduced inertia I": (light, inertia, []),
        "and reduced moment M, no gravity": (light, moments, []),
        "and gravity": (scene, moments, []),
        "and reactions in all pairs": (scene, forces, []),
        f"and friction in one pair ({first}.first)": (one, losses, []),
        "or friction in all pairs": (rubbing(scene), losses, []),
        "and all reactions kept as fields": (rubbing(scene), losses, [f"{p.name}.reaction" for p in pairs(scene)]),
    }


def cost(case: Case, scene: Scene, summaries: list[str], fields: list[str]) -> float:
    """Processor time of a variant [µs], the median of several rounds."""
    varied = sample(case, case.geometry, VARIANTS)
    machine = Machine(scene, summaries, fields, varied, POSITIONS)
    buffer = machine.new_buffer(VARIANTS)
    machine.evaluate(varied, buffer=buffer)
    times = []
    for _ in range(ROUNDS):
        start = time.process_time()
        outcome = machine.evaluate(varied, buffer=buffer)
        times.append(time.process_time() - start)
    if outcome.status.any():
        raise SystemExit(f"not all variants of {scene.title or 'a machine'} were computed")
    return float(np.median(times)) * 1e6 / VARIANTS


def main() -> None:
    argparse.ArgumentParser(description=__doc__.split("\n")[0]).parse_args()
    set_threads(1)
    names = list(CASES)
    table = {name: asked(CASES[name].scene) for name in names}
    lines = [
        "# What each option costs",
        "",
        f"µs of processor time per variant on one thread, {VARIANTS} variants, each a motion of its own; the median of",
        f"{ROUNDS} rounds. Each row asks for more than the one before; fields are kept at {POSITIONS} positions.",
        f"{platform.machine()}, Python {platform.python_version()}. Made by `python results/performance/options.py`.",
        "",
        f"| asked | {' | '.join(name.replace('_', ' ') for name in names)} |",
        f"|---|{'---|' * len(names)}",
    ]
    for label in table[names[0]]:
        cells = [f"{cost(CASES[name], *table[name][label]):.1f}" for name in names]
        lines.append(f"| {label} | {' | '.join(cells)} |")
        print(lines[-1], flush=True)
    lines.append("")
    (HERE / "options.md").write_text("\n".join(lines), encoding="utf8")


if __name__ == "__main__":
    main()
