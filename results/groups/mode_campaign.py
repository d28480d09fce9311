"""Random triads: tables of seeds against paths of steps 64 times as short.

    python results/groups/mode_campaign.py 500

Each scene is a crank and a plate on three bars with random lengths; each of its modes at the first position is followed
over a turn, with the steps that machines take and with short ones. Both must end alike: at the same place where modes
meet, back where they began, or on another mode; and where both go on, the plate's angles must agree.
"""

import sys
from collections import Counter
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from engine import Scene
from engine.mechanism.groups.seed_tables import SEEDS, SeedTables
from engine.mechanism.groups.seed_walk import walk_seeds
from engine.mechanism.mechanics import Mechanics

# How many short steps stand for one of a table.
FINER = 64


class Followed(NamedTuple):
    """A mode followed over a turn: how it ends, and how far coarse and fine steps are apart."""

    ends: str
    fine_ends: str
    apart: float
    place_apart: float


def random_triad(random: np.random.Generator) -> Scene:
    """A crank and a plate on three bars."""
    angles = np.sort(random.uniform(0.0, 2.0 * np.pi, 3))
    corners = {
        name: {"link": "plate", "x": 0.1 * np.cos(angle), "y": 0.1 * np.sin(angle)}
        for name, angle in zip("BCD", angles, strict=True)
    }
    lengths = random.uniform(0.1, 0.4, 3)
    frame = {n: dict(zip("xy", random.uniform(-0.4, 0.4, 2), strict=True)) for n in "PQ"}
    joints = (("A", "B"), ("P", "C"), ("Q", "D"))
    bars = zip(("rod", "lower", "upper"), joints, lengths, strict=True)
    return Scene.model_validate(
        {
            "points": {"O": {"x": 0.0, "y": 0.0}, **frame, **corners},
            "input": {"type": "crank", "pivot": "O", "pin": "A", "length": random.uniform(0.02, 0.08), "speed": 1.0},
            "links": {"plate": {}, **{n: {"joints": list(j), "length": length} for n, j, length in bars}},
        }
    )


def followed(tables: SeedTables) -> Iterator[Followed]:
    """Every mode of a scene."""
    modes = tables.modes
    if not modes:
        return
    table = np.repeat(tables._table(tables._own, tables._functions), len(modes), axis=1)
    start, sines = np.array([m.unknowns for m in modes]).T, np.array([m.transmission for m in modes])
    given = (*tables._compiled, tables._functions, tables._given_rows, tables._slides, table, start, sines)
    coarse, fine = (walk_seeds(*given, steps, True) for steps in (SEEDS, SEEDS * FINER))
    rows = coarse[0].reshape(SEEDS + 1, tables.width, -1), fine[0].reshape(SEEDS * FINER + 1, tables.width, -1)[::FINER]
    angles = [0, 1, 3, 4]
    for k in range(len(modes)):
        ends = [_end(path[1][k], path[2][k]) for path in (coarse, fine)]
        both = np.isfinite(rows[0][:, angles, k]).all(axis=1) & np.isfinite(rows[1][:, angles, k]).all(axis=1)
        apart = float(np.abs(rows[0][both][:, angles, k] - rows[1][both][:, angles, k]).max())
        yield Followed(*ends, apart, abs(float(coarse[1][k] - fine[1][k])))


def _end(lost_at: float, closes: bool) -> str:
    if not np.isnan(lost_at):
        return "lost"
    return "closed" if closes else "other mode"


def campaign(scenes: int, seed: int = 1) -> list[Followed]:
    """Every mode of so many random scenes."""
    random, found = np.random.default_rng(seed), []
    for _ in range(scenes):
        (tables,) = Mechanics(random_triad(random)).kinematics.seed_tables.values()
        found += followed(tables)
    return found


def main() -> None:
    """Tell how the modes end."""
    found = campaign(int(sys.argv[1]) if len(sys.argv) > 1 else 100)
    same = [f for f in found if f.ends == f.fine_ends]
    print(f"{len(found)} modes followed; they end {dict(Counter(f.ends for f in found))}")
    print(f"ends that differ from those of finer steps: {len(found) - len(same)}")
    print(f"greatest difference of a cosine or sine: {max(f.apart for f in found):.1e}")
    lost = [f.place_apart for f in same if f.ends == "lost"]
    print(f"greatest difference of the place where modes meet: {max(lost, default=0.0):.1e} rad")


if __name__ == "__main__":
    main()
