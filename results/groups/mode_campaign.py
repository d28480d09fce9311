"""Random triads: tables of seeds against paths ten times finer, tracked with 50 digits.

    python results/groups/mode_campaign.py 10000 modes.txt

Each scene is a crank and a plate on three bars with random lengths; its modes at the first position are tracked over a
turn by the steps that machines take, and by 720 steps with 50 digits and other equations (`exact_triads`). Both must
have the same end: at the start, in another mode, or where modes meet, unless the table is full; and as long as both
continue, the directions of the plate and of a bar must agree after each of the 720 steps. The counts are rewritten
after every hundred modes.
"""

import sys
from collections import Counter
from collections.abc import Iterator
from decimal import Decimal
from pathlib import Path
from typing import NamedTuple

import numpy as np
from exact_triads import ExactPath, ExactTriad, Pose, followed_exactly

from engine import Scene
from engine.graph.values import NodeValues
from engine.laws.kinematics.seeds import CLOSE, PROVES, between_seeds
from engine.mechanism.groups.seed_tables import SeedTables
from engine.mechanism.mechanics import Mechanics
from engine.scene.scene import Numbers, scene_numbers
from engine.scene.structure.free_groups import cutting_of

# Positions at which paths are compared, and number of steps with 50 digits between two of them.
PLACES, FINER = 720, 1
# Random starts to find the modes of a scene, and corrections of each.
_STARTS, _CORRECTIONS = 24, 40
_BARS = {"rod": ("A", "B"), "lower": ("P", "C"), "upper": ("Q", "D")}
# Directions that differ by more than this belong to different modes.
_APART = 1e-6


class Followed(NamedTuple):
    """A mode tracked over a turn.

    Attributes
    ----------
    ends, exact_ends : str
        Ends of the table's path and of the exact one.
    apart : float
        Maximum difference of cosines and sines, as long as both continue.
    place_apart : float
        Difference of the positions where modes meet [rad]; NaN if they don't.
    """

    ends: str
    exact_ends: str
    apart: float
    place_apart: float


def random_numbers(count: int, seed: int) -> dict[str, np.ndarray]:
    """Lengths and points of random plates on three bars, by the paths of `triad_scene`."""
    random = np.random.default_rng(seed)
    angles = np.sort(random.uniform(0.0, 2.0 * np.pi, (count, 3)), axis=1)
    found = {}
    for name, angle in zip("BCD", angles.T, strict=True):
        found |= {f"points.{name}.x": 0.1 * np.cos(angle), f"points.{name}.y": 0.1 * np.sin(angle)}
    found |= {f"points.{name}.{axis}": random.uniform(-0.4, 0.4, count) for name in "PQ" for axis in "xy"}
    found |= {f"links.{name}.length": random.uniform(0.1, 0.4, count) for name in _BARS}
    return found | {"input.length": random.uniform(0.02, 0.08, count)}


def triad_scene() -> Scene:
    """A crank and a plate on three bars."""
    points = {"O": (0.0, 0.0), "P": (0.3, -0.1), "Q": (0.25, 0.3)}
    corners = {"B": (0.0, 0.0), "C": (0.12, 0.0), "D": (0.06, 0.08)}
    return Scene.model_validate(
        {
            "points": {n: {"x": x, "y": y} for n, (x, y) in points.items()}
            | {n: {"link": "plate", "x": x, "y": y} for n, (x, y) in corners.items()},
            "input": {"type": "crank", "pivot": "O", "pin": "A", "length": 0.03, "speed": 1.0},
            "links": {"plate": {}, **{n: {"joints": list(j), "length": 0.2} for n, j in _BARS.items()}},
        }
    )


def curves_at(tables: SeedTables, numbers: Numbers, unknowns: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Corrections, rates and measures at given values of the unknowns, (curves, variants)."""
    values = NodeValues(tables._curves[0].graph, numbers)
    return np.array(values(tables._curves, q, dict(zip(tables._given, unknowns, strict=True))))


def modes_of(tables: SeedTables, numbers: Numbers, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Modes at the first position: the scene of each, and its unknowns."""
    scenes = tables._walk.table(numbers).shape[1]
    wide, q = numbers.of_variants(np.repeat(np.arange(scenes), _STARTS)), np.zeros(scenes * _STARTS)
    unknowns = np.random.default_rng(seed).uniform(-np.pi, np.pi, (2, q.size))
    with np.errstate(all="ignore"):
        for _ in range(_CORRECTIONS):
            found = curves_at(tables, wide, unknowns, q)
            unknowns = unknowns + np.clip(found[:2], -0.5, 0.5)
        found = curves_at(tables, wide, unknowns, q)
        proved = (found[6] <= PROVES) & (np.abs(found[:2]) < 1e-9).all(axis=0)
    owner = np.repeat(np.arange(scenes), _STARTS)[proved]
    rounded = np.column_stack([owner, np.round(directions(unknowns[:, proved]).T, 6) + 0.0])
    _, first = np.unique(rounded, axis=0, return_index=True)
    return owner[first], np.ascontiguousarray(unknowns[:, proved][:, first])


def directions(angles: np.ndarray) -> np.ndarray:
    """Cosine and sine of both angles, (4, ...)."""
    return np.array([part for angle in angles for part in (np.cos(angle), np.sin(angle))])


def exact_triad(numbers: dict[str, np.ndarray], i: int) -> ExactTriad:
    """One of the random scenes with the same numbers to all digits."""

    def pair(name: str) -> tuple[Decimal, Decimal]:
        return tuple(Decimal(float(numbers[f"points.{name}.{axis}"][i])) for axis in "xy")

    lengths = tuple(Decimal(float(numbers[f"links.{name}.length"][i])) for name in _BARS)
    return ExactTriad(
        tuple(map(pair, "BCD")), tuple(map(pair, "PQ")), lengths, Decimal(float(numbers["input.length"][i]))
    )


def pose_of(triad: ExactTriad, directions: dict[str, tuple[float, float]]) -> Pose:
    """The plate's pose at the first position, from its direction and that of one bar."""
    (bar,) = set(directions) - {"plate"}
    i = list(_BARS).index(bar)
    (c, s), (bar_c, bar_s) = (tuple(map(Decimal, map(float, directions[name]))) for name in ("plate", bar))
    x, y = ((triad.crank, Decimal(0)), *triad.pivots)[i]
    u, v = triad.corners[i]
    return Pose(x + triad.lengths[i] * bar_c - (c * u - s * v), y + triad.lengths[i] * bar_s - (s * u + c * v), c, s)


def directions_of(triad: ExactTriad, path: ExactPath, bar: str) -> np.ndarray:
    """Directions of the plate and of a bar at the seeds of a table, (seeds, 4)."""
    i, found = list(_BARS).index(bar), []
    for k, pose in enumerate(path.poses[::FINER]):
        turn = 2.0 * np.pi * k / PLACES
        pin = float(triad.crank) * np.cos(turn), float(triad.crank) * np.sin(turn)
        x, y = (pin, *(tuple(map(float, pivot)) for pivot in triad.pivots))[i]
        (u, v), (px, py, c, s) = map(float, triad.corners[i]), map(float, pose)
        length = float(triad.lengths[i])
        found.append((c, s, (px + c * u - s * v - x) / length, (py + s * u + c * v - y) / length))
    return np.array(found)


def campaign(scenes: int, seed: int = 1) -> Iterator[Followed]:
    """Every mode of a number of random scenes."""
    scene = triad_scene()
    (tables,) = Mechanics(scene).kinematics.seed_tables.values()
    numbers = random_numbers(scenes, seed)
    every = Numbers(scene_numbers(scene), numbers)
    owner, start = modes_of(tables, every, seed)
    own_numbers = every.of_variants(owner)
    sines = curves_at(tables, own_numbers, start, np.zeros(owner.size))[-2]
    paths = tables.walked(own_numbers, start, sines)
    rows = rows_at(tables, own_numbers, paths.seeds.reshape(tables.intervals + 1, -1, owner.size))
    placed = [name for name, _ in cutting_of(tables.group).placed]
    columns = {name: (2 * i, 2 * i + 1) for i, name in enumerate(placed)}
    (bar,) = set(placed) - {"plate"}
    for k, i in enumerate(owner):
        triad = exact_triad(numbers, i)
        begin = {name: tuple(rows[0, list(at), k]) for name, at in columns.items()}
        path = followed_exactly(triad, pose_of(triad, begin), PLACES * FINER)
        exact = directions_of(triad, path, bar)
        own = rows[: len(exact), [*columns["plate"], *columns[bar]], k]
        both = np.isfinite(own).all(axis=1)
        apart = float(np.abs(own[both] - exact[both]).max())
        if path.lost_at is not None:
            exact_ends = "lost"
        else:
            exact_ends = "closed" if np.abs(exact[-1] - exact[0]).max() < _APART else "other mode"
        ends = "closed" if paths.closes[k] else "other mode"
        ends = "lost" if not np.isnan(paths.ends_at[k]) else "no room" if not np.isnan(paths.short_at[k]) else ends
        place = abs(paths.ends_at[k] - 2.0 * np.pi * float(path.lost_at)) if path.lost_at is not None else np.nan
        yield Followed(ends, exact_ends, apart, float(place))


def rows_at(tables: SeedTables, numbers: Numbers, seeds: np.ndarray) -> np.ndarray:
    """Directions at the compared positions, (positions, cosines and sines, variants), corrected as in machines."""
    found = np.full((PLACES + 1, 4, seeds.shape[2]), np.nan)
    for k in range(PLACES + 1):
        x = min(k / PLACES, 1.0 - 2.0**-53)
        one = np.maximum((seeds[:, 0] <= x).sum(axis=0) - 1, 0)
        two, every = np.minimum(one + 1, len(seeds) - 1), np.arange(one.size)
        begin, end = seeds[one, :, every].T, seeds[two, :, every].T
        with np.errstate(all="ignore"):
            step = end[0] - begin[0]
            share = (x - begin[0]) / step
            both = [between_seeds(tuple(begin[i::2]), tuple(end[i::2]), share, 2.0 * np.pi * step) for i in (1, 2)]
            unknowns, q = np.array(both), np.full(one.size, 2.0 * np.pi * x)
            for correction in range(2):
                moved = curves_at(tables, numbers, unknowns, q)
                unknowns = unknowns + moved[:2]
                if correction == 0:
                    # Positions without a solution have no certificate either.
                    assert not (moved[6] > 10.0 * CLOSE).any()
        found[k] = directions(unknowns)
    return found


def table_of(scenes: int, found: list[Followed]) -> str:
    """The counts as a table."""
    ends = Counter(f.ends for f in found)
    same = [f for f in found if f.ends == f.exact_ends]
    lost = [f.place_apart for f in same if f.ends == "lost"]
    changed = sum(f.apart > _APART for f in found)
    return "\n".join(
        [
            f"| random triads | {scenes} |",
            f"| modes tracked | {len(found)} |",
            "| return to their start · end where modes meet · return in another mode | "
            f"{ends['closed']} · {ends['lost']} · {ends['other mode']} |",
            f"| not tracked to the end, as the table is full | {ends['no room']} |",
            f"| other ends that differ from those with 50 digits | {len(found) - len(same) - ends['no room']} |",
            f"| mode changes between the ends | {changed} |",
            f"| maximum difference of a cosine or sine | {max(f.apart for f in found):.1e} |",
            f"| maximum difference of the position where modes meet | {max(lost, default=0.0):.1e} rad |",
        ]
    )


def main() -> None:
    """Write the counts of the modes' ends."""
    scenes, to = int(sys.argv[1]), Path(sys.argv[2])
    found: list[Followed] = []
    for one in campaign(scenes):
        found.append(one)
        if one.ends not in (one.exact_ends, "no room") or one.apart > _APART:
            print(f"mode {len(found)}: {one}", flush=True)
        if len(found) % 100 == 0:
            to.write_text(table_of(scenes, found) + "\n")
    to.write_text(table_of(scenes, found) + "\n\nDone.\n")


if __name__ == "__main__":
    main()
