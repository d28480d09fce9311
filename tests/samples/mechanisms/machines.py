"""Parts of scenes, written short, and the comparison of a machine with its oracle."""

import copy
import math
from collections.abc import Callable

import numpy as np
from oracle import EPS, Motion

from engine import MovingMachine, Scene, Verdict

NUDGE = 1e-7
ROUNDINGS = 40
WORDS = ("x", "y", "angle", "slide", "transmission")


def changed(scene: dict, numbers: dict) -> dict:
    """A scene with some numbers replaced, by their paths."""
    scene = copy.deepcopy(scene)
    for path, value in numbers.items():
        *folders, key = path.split(".")
        part = scene
        for folder in folders:
            part = part[folder]
        part[key] = value
    return scene


def nudged(part: object, rng: np.random.Generator) -> object:
    """A scene with every length and angle (every float) a little off."""
    if isinstance(part, dict):
        return {key: nudged(value, rng) for key, value in part.items()}
    return part * (1 + NUDGE * rng.choice([-1, 1])) if isinstance(part, float) else part


def difference(field: str, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Of two rows; angles may differ by whole turns."""
    gap = np.asarray(a - b, float)
    return gap - 2 * math.pi * np.round(gap / (2 * math.pi)) if field.endswith(".angle") else gap


def compare(found: dict, scene: dict, rows: Callable, rounding: float = EPS, truncation: dict | None = None) -> None:
    """Compare rows that a machine gave with those of the oracle.

    The tolerance is the machine's own sensitivity: the oracle runs once more with every number of the scene changed
    by a relative NUDGE; what a row then changes by, over NUDGE, times the rounding of a number, is what the rounding
    of the data alone does to it. ROUNDINGS of that size are allowed for all operations.
    """
    expected = rows(Scene.model_validate(scene))
    other = rows(Scene.model_validate(nudged(scene, np.random.default_rng(5))))
    for name, row in found.items():
        reference = np.asarray(expected[name], float)
        assert np.isfinite(reference).all(), name
        sensitivity = np.abs(difference(name, other[name], expected[name])).max() / NUDGE
        tolerance = ROUNDINGS * rounding * (sensitivity + np.abs(reference).max() + 1e-3)
        error = np.abs(difference(name, row, expected[name])).max()
        assert error <= tolerance + (truncation or {}).get(name, 0.0), (name, error, tolerance)


def variants_of(scene: dict, varied: dict[str, list]) -> list[dict]:
    """One scene for each variant."""
    count = len(next(iter(varied.values()))) if varied else 1
    return [changed(scene, {path: values[i] for path, values in varied.items()}) for i in range(count)]


def moving(
    scene: dict, fields: list[str], positions: int, values: dict | None = None
) -> tuple[MovingMachine, dict[str, np.ndarray]]:
    """A sound machine and its fields by NumPy: that compiled code gives the same is tested in `test_one_machine.py`."""
    machine = MovingMachine(Scene.model_validate(scene), values, positions)
    assert machine.verdict(fields) == Verdict.OK
    return machine, machine.fields(fields)


def check(scene: dict, fields: list[str] | None = None, **varied: list) -> None:
    """Compare kinematic fields (all of them when none are named) of a scene and its variants with the oracle."""
    paths = {path.replace("__", "."): values for path, values in varied.items()}
    for numbers in variants_of(scene, paths):
        machine = MovingMachine(Scene.model_validate(numbers), positions=16)
        kinematic = [f for f in machine.register.fields if f.rpartition(".")[2].partition("_")[0] in WORDS]
        names, q = fields or kinematic, machine.q

        def rows(of: Scene, names: list[str] = names, q: np.ndarray = q) -> dict:
            motion = Motion(of, q)
            return {field: motion.field(field) for field in names}

        compare(machine.fields(names), numbers, rows)


# Parts of scenes


def crank(**changes: object) -> dict:
    return {"type": "crank", "pivot": "O", "pin": "A", "length": 0.3, "speed": 5.0, **changes}


def rrr(inner: str, first: tuple, second: tuple, mode: int = 1) -> dict:
    sides = [dict(zip(("link", "joint", "length"), side, strict=True)) for side in (first, second)]
    return {"type": "RRR", "inner": inner, "first": sides[0], "second": sides[1], "mode": mode}


def rrp(inner: str, first: tuple, link: str, guide: str, offset: float = 0.0, mode: int = 1) -> dict:
    rod = dict(zip(("link", "joint", "length"), first, strict=True))
    return {
        "type": "RRP",
        "inner": inner,
        "first": rod,
        "second": {"link": link, "guide": guide, "offset": offset},
        "mode": mode,
    }


def rpr(block: tuple, rocker: tuple, offset: float = 0.0, mode: int = 1) -> dict:
    return {
        "type": "RPR",
        "first": dict(zip(("link", "joint"), block, strict=True)),
        "second": {"link": rocker[0], "joint": rocker[1], "offset": offset},
        "mode": mode,
    }


def prp(inner: str, first: tuple, second: tuple) -> dict:
    sides = [dict(zip(("link", "guide", "offset"), side, strict=True)) for side in (first, second)]
    return {"type": "PRP", "inner": inner, "first": sides[0], "second": sides[1]}


def rpp(block: tuple, yoke: tuple, slot_angle: float) -> dict:
    return {
        "type": "RPP",
        "first": dict(zip(("link", "joint"), block, strict=True)),
        "second": {"link": yoke[0], "guide": yoke[1], "slot_angle": slot_angle},
    }


def on(link: str, x: float, y: float) -> dict:
    return {"link": link, "x": x, "y": y}


def frame(x: float, y: float) -> dict:
    return {"x": x, "y": y}


def slider_crank(
    length: float = 0.05,
    rod: float = 0.2,
    speed: float | str = 5.0,
    group: str = "g",
    slider: str = "ram",
    **parts: dict,
) -> dict:
    """In line, its slider on the frame; parts by their names replace these."""
    return {
        "points": {"O": frame(0.0, 0.0)},
        "guides": {"way": {}},
        "input": crank(length=length, speed=speed),
        "groups": {
            group: {
                "type": "RRP",
                "inner": "B",
                "first": {"link": "rod", "joint": "A", "length": rod},
                "second": {"link": slider, "guide": "way"},
            }
        },
    } | parts


def four_bar(mode: int = 1, **points: dict) -> dict:
    """Crank and rocker; O and D are off the origin."""
    return {
        "points": {"O": frame(0.1, -0.2), "D": frame(1.15, -0.3), **points},
        "input": crank(),
        "groups": {"bars": rrr("B", ("coupler", "A", 1.0), ("rocker", "D", 0.8), mode)},
    }


# Random chains


def reach(motion: Motion, a: str, b: str) -> tuple[float, float]:
    """Least and greatest distance of two points."""
    (ax, ay), (bx, by) = motion.points[a], motion.points[b]
    distance = np.hypot((ax - bx).v, (ay - by).v)
    return float(distance.min()), float(distance.max())


def chain(seed: int, dyads: int, in_series: bool) -> dict:
    """Random dyads of all kinds that can be assembled all around, each on the last one or on any earlier one."""
    rng = np.random.default_rng(seed)
    scene = {"points": {"O": frame(0.0, 0.0)}, "guides": {}, "input": crank(), "groups": {}}
    motion = Motion(Scene.model_validate(scene), np.linspace(0, 2 * math.pi, 48))
    tips = ["A"]
    for i in range(dyads):
        a = tips[-1] if in_series else str(rng.choice(tips))
        kind = (
            ("RRR", "RRP", "RPR", "PRP", "RPP")[(i + seed) % 5] if i < 5 else rng.choice(["RRR", "RRP", "RPR", "RPP"])
        )
        _add_dyad(scene, motion, str(kind), i, a, rng)
        motion.extend(Scene.model_validate(scene))
        tips.append(f"T{i}")
    return scene


def _add_dyad(scene: dict, motion: Motion, kind: str, i: int, a: str, rng: np.random.Generator) -> None:
    one, two, mode = f"u{i}", f"v{i}", int(rng.choice([-1, 1]))
    ax, ay = (float(part.v.mean()) for part in motion.points[a])
    sway = max(float(np.ptp(part.v + 0 * motion.q)) for part in motion.points[a])
    scene["points"][f"D{i}"] = frame(ax + rng.uniform(1, 2) * (sway + 0.3), ay + rng.uniform(-0.5, 0.5))
    turn = rng.uniform(-3, 3)
    scene["guides"][f"G{i}"] = {"x": ax + rng.uniform(-0.2, 0.2), "y": ay + rng.uniform(-0.2, 0.2), "angle": turn}
    motion.extend(Scene.model_validate(scene))
    least, most = reach(motion, a, f"D{i}")
    carrier = two if kind in ("RRR", "RPR", "PRP", "RPP") else one
    scene["points"][f"T{i}"] = on(carrier, rng.uniform(0.1, 0.4), rng.uniform(-0.3, 0.3))
    match kind:
        case "RRR":
            r = most * rng.uniform(0.8, 1.1)
            group = rrr(f"B{i}", (one, a, r), (two, f"D{i}", r + rng.uniform(-0.5, 0.5) * least), mode)
        case "RRP":
            group = rrp(f"B{i}", (one, a, 1.5 * (sway + 0.3)), two, f"G{i}", rng.uniform(-0.1, 0.1), mode)
        case "RPR":
            group = rpr((one, a), (two, f"D{i}"), rng.uniform(-0.5, 0.5) * least, mode)
        case "RPP":
            group = rpp((one, a), (two, f"G{i}"), rng.uniform(0.6, 2.2) * mode)
        case _:
            # One guide slides bodily with a yoke driven by a: the yoke is a group of its own.
            scene["groups"][f"y{i}"] = rpp((f"d{i}", a), (f"w{i}", f"G{i}"), 1.5)
            scene["guides"] |= {
                f"M{i}": {"link": f"w{i}", "x": 0.1, "y": 0.05, "angle": 1.2},
                f"F{i}": {"x": ax, "y": ay, "angle": turn + 0.3},
            }
            group = prp(f"B{i}", (one, f"M{i}", 0.1), (two, f"F{i}", -0.05))
    scene["groups"] = {f"g{i}": group, **scene["groups"]}
