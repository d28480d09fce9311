"""Error estimates of triads near their dead centres against an independent solution with more digits, by `compared`.

Of many random triads those that come nearest to a dead centre: positions, speeds, accelerations and reactions at their
peaks, against a solution with 64-bit mantissas. That one solves the three bar lengths for the plate's position and
direction, and its equilibrium for the forces along the bars; only the geometry is shared with the engine. Peaks are
searched near the best of 720 positions, and near the position that the engine gives.
"""

from typing import NamedTuple

import numpy as np
from exact_triads import solved_triple
from mode_campaign import triad_scene

from engine import Machine, Scene, scene_numbers

LONG = np.longdouble
BARS = ("rod", "lower", "upper")
PLACES = [f"{name}.{axis}" for name in "PQCD" for axis in "xy"]
SPEED, GRAVITY = 6.0, 9.81
MASSES = {"rod": (1.0, 0.1, 0.02, 0.01), "lower": (0.7, 0.08, -0.02, 0.01), "upper": (1.5, 0.02, 0.0, 0.01)}
PLATE = (2.0, 0.05, 0.03, 0.02)
SUMMARIES = (
    "D.x.max",
    "D.x.min",
    "plate.swing",
    "upper.angular_velocity.max",
    "plate.angular_velocity.max",
    "D.vy.max",
    "upper.angular_acceleration.max",
    "D.ax.max",
    "upper.D.reaction.max",
    "rod.B.reaction.max",
    "lower.C.reaction.max",
    "group_of_plate.transmission.min",
)
# Curves of the reference whose peaks these are, with their sense.
_PEAKS = {
    "D.x.max": ("dx", 1),
    "D.x.min": ("dx", -1),
    "high": ("angle", 1),
    "low": ("angle", -1),
    "upper.angular_velocity.max": ("w_upper", 1),
    "plate.angular_velocity.max": ("w", 1),
    "D.vy.max": ("dvy", 1),
    "upper.angular_acceleration.max": ("e_upper", 1),
    "D.ax.max": ("dax", 1),
    "upper.D.reaction.max": ("upper", 1),
    "rod.B.reaction.max": ("rod", 1),
    "lower.C.reaction.max": ("lower", 1),
}
_PLACES = {"high": "plate.swing_high_at", "low": "plate.swing_low_at"}
GRID, ZOOM, ZOOMS = 720, 24, 6


def scene() -> Scene:
    """A plate on three bars, each link with its body."""
    bodies = {**MASSES, "plate": PLATE}
    data = triad_scene().model_dump(exclude_unset=True)
    data["input"]["speed"] = SPEED
    data["bodies"] = {
        f"{n}_body": {"link": n, "mass": m, "x": x, "y": y, "inertia": i} for n, (m, x, y, i) in bodies.items()
    }
    return Scene.model_validate(data | {"gravity": GRAVITY, "near": {"C": {"x": 0.3, "y": 0.1}}})


def random_numbers(count: int, seed: int) -> dict[str, np.ndarray]:
    """Numbers of random triads around that scene."""
    random, found = np.random.default_rng(seed), {}
    given = {path: number.value for path, number in scene_numbers(scene()).items()}
    for path in ("input.length", *(f"links.{bar}.length" for bar in BARS), *(f"points.{p}" for p in PLACES)):
        by = 0.04 if path[7] in "CD" else 0.05
        value, by = (0.06, 0.045) if path == "input.length" else (given[path], by)
        found[path] = value + by * random.uniform(-1.0, 1.0, count)
    return found


class Pose(NamedTuple):
    """Position and direction of the plate, a row for each triad."""

    x: np.ndarray
    y: np.ndarray
    angle: np.ndarray


class Reference:
    """Triads in extended precision.

    Parameters
    ----------
    numbers : mapping of path to ndarray (triads,)
    """

    def __init__(self, numbers: dict[str, np.ndarray]) -> None:
        n = {path: values.astype(LONG) for path, values in numbers.items()}
        zero = np.zeros_like(n["input.length"])
        self.crank = n["input.length"]
        self.corners = [zero + 0j * zero] + [n[f"points.{c}.x"] + LONG(1) * 1j * n[f"points.{c}.y"] for c in "CD"]
        self.pivots = [n[f"points.{p}.x"] + 1j * n[f"points.{p}.y"] for p in "PQ"]
        self.lengths = [n[f"links.{bar}.length"] for bar in BARS]

    def _bars(self, pose: Pose, q: np.ndarray) -> tuple[list, list]:
        """Arms of the plate's joints from its origin, and the bars from their far joint."""
        turn, at = np.exp(1j * pose.angle), pose.x + 1j * pose.y
        arms = [turn * corner for corner in self.corners]
        far = [self.crank * np.exp(1j * q), *self.pivots]
        return arms, [at + arm - f for arm, f in zip(arms, far, strict=True)]

    def solved(self, pose: Pose, q: np.ndarray) -> Pose:
        """The root near a pose."""
        for _ in range(7):
            arms, bars = self._bars(pose, q)
            rows = [(b.real, b.imag, _cross(a, b)) for a, b in zip(arms, bars, strict=True)]
            right = [(length**2 - abs(b) ** 2) / 2 for b, length in zip(bars, self.lengths, strict=True)]
            pose = Pose(*(p + d for p, d in zip(pose, solved_triple(rows, right)[0], strict=True)))
        return pose

    def curves(self, pose: Pose, q: np.ndarray) -> dict[str, np.ndarray]:
        """All compared quantities at a position."""
        w0 = LONG(SPEED)
        arms, bars = self._bars(pose, q)
        rows = [(b.real, b.imag, _cross(a, b)) for a, b in zip(arms, bars, strict=True)]
        pin = self.crank * np.exp(1j * q)
        far_v, far_a = [1j * w0 * pin, 0 * pin, 0 * pin], [-(w0**2) * pin, 0 * pin, 0 * pin]
        vx, vy, w = solved_triple(rows, [_dot(b, v) for b, v in zip(bars, far_v, strict=True)])[0]
        at_v = [vx + 1j * vy + 1j * w * arm for arm in arms]
        apart = [a - f for a, f in zip(at_v, far_v, strict=True)]
        right = [_dot(b, fa + w**2 * arm) - abs(d) ** 2 for b, fa, arm, d in zip(bars, far_a, arms, apart, strict=True)]
        ax, ay, e = solved_triple(rows, right)[0]
        at_a = [ax + 1j * ay + (1j * e - w**2) * arm for arm in arms]
        turn = np.exp(1j * pose.angle)
        mass, x, y, inertia = map(LONG, PLATE)
        centre = turn * (x + 1j * y)
        force = mass * (ax + 1j * ay + (1j * e - w**2) * centre + 1j * LONG(GRAVITY))
        need = [force.real, force.imag, inertia * e + _cross(centre, force)]
        known, found = [], {"dx": pose.x + arms[2].real, "angle": pose.angle, "w": w, "dvy": at_v[2].imag}
        for name, arm, bar, v, a, fv, fa in zip(BARS, arms, bars, at_v, at_a, far_v, far_a, strict=True):
            length = abs(bar)
            u = bar / length
            turning, speeding = _cross(u, v - fv) / length, _cross(u, a - fa) / length
            m, bx, by, j = map(LONG, MASSES[name])
            c = u * (bx + 1j * by)
            # The upper and the lower bar start at their pivots, the rod at the crank's pin.
            load = m * (fa + (1j * speeding - turning**2) * c + 1j * LONG(GRAVITY))
            across = -(j * speeding + _cross(c, load)) / length
            known.append((u, across, arm))
            if name == "upper":
                found |= {"w_upper": turning, "e_upper": speeding}
        # The plate's equilibrium: forces of the bars along u, unknown, and across, on the plate.
        for k, (u, across, arm) in enumerate(known):
            f = 1j * u * across
            need = [need[0] - f.real, need[1] - f.imag, need[2] - _cross(arm, f)]
            rows[k] = (u.real, u.imag, _cross(arm, u))
        along = solved_triple(list(zip(*rows, strict=True)), need)[0]
        found |= {n: np.hypot(s, across) for n, s, (_, across, _) in zip(BARS, along, known, strict=True)}
        found["dax"] = at_a[2].real
        return found

    def peak(self, name: str, sense: int, starts: Pose, grid: np.ndarray, place: np.ndarray) -> np.ndarray:
        """Peak of a curve, times its sense, over the turn: near the best of a grid, and near a given position."""
        every = np.arange(place.size)
        told = np.rint(place / float(grid[1, 0])).astype(int) % GRID
        k = (sense * self.curves(starts, grid)[name]).argmax(axis=0)
        return sense * np.maximum(
            *(
                self._zoomed(name, sense, Pose(*(part[i, every] for part in starts)), grid[i, every], grid[1])
                for i in (k, told)
            )
        )

    def _zoomed(self, name: str, sense: int, pose: Pose, centre: np.ndarray, step: np.ndarray) -> np.ndarray:
        """Peak of a curve near a position, by ever smaller steps about the best."""
        best = np.full(centre.size, -np.inf, LONG)
        for _ in range(ZOOMS):
            poses, q = self._around(pose, centre, step)
            values = sense * self.curves(poses, q)[name]
            k, every = values.argmax(axis=0), np.arange(centre.size)
            best, centre = np.maximum(best, values[k, every]), q[k, every]
            pose, step = Pose(*(part[k, every] for part in poses)), step / (ZOOM // 2)
        return best

    def _around(self, pose: Pose, centre: np.ndarray, step: np.ndarray) -> tuple[Pose, np.ndarray]:
        """Poses within a step of one, reached from it on either side, and their positions."""
        places = centre + step * np.arange(-ZOOM // 2, ZOOM // 2 + 1)[:, None] / (ZOOM // 2)
        rows = {ZOOM // 2: pose}
        for side in (-1, 1):
            for i in range(1, ZOOM // 2 + 1):
                k = ZOOM // 2 + side * i
                rows[k] = self.solved(rows[k - side], places[k])
        return Pose(*(np.array(part) for part in zip(*(rows[k] for k in range(ZOOM + 1)), strict=True))), places


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a.real * b.imag - a.imag * b.real


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a.real * b.real + a.imag * b.imag


def compared(count: int, tried: int, seed: int, accuracy: float | None) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Errors and estimates of `count` triads, those nearest to a dead centre among all that are tried."""
    numbers = random_numbers(tried, seed)
    outcome = Machine(scene(), ["group_of_plate.transmission.min"], varied=list(numbers)).evaluate(numbers)
    sine = np.abs(outcome.summaries["group_of_plate.transmission.min"])
    whole = np.flatnonzero(outcome.status == 0)
    chosen = np.sort(whole[np.argsort(sine[whole])][:count])
    numbers = {path: values[chosen] for path, values in numbers.items()}
    fields = ["plate.angle", "B.x", "B.y"]
    places = [_PLACES.get(name, f"{name}_at") for name in _PEAKS]
    machine = Machine(scene(), [*SUMMARIES[:-1], *places], fields, list(numbers), GRID, accuracy=accuracy)
    outcome = machine.evaluate(numbers)
    assert (outcome.status == 0).all()
    reference = Reference(numbers)
    grid = machine.nodes.astype(LONG)
    angle, x, y = (outcome.fields[name].T.astype(LONG) for name in fields)
    wide = np.repeat(grid[:, None], len(chosen), axis=1)
    starts = reference.solved(Pose(x, y, angle), wide)
    assert np.abs(starts.x - x).max() < 1e-6
    exact = {
        name: reference.peak(curve, sense, starts, wide, outcome.summaries[_PLACES.get(name, f"{name}_at")])
        for name, (curve, sense) in _PEAKS.items()
    }
    exact["plate.swing"] = exact.pop("high") - exact.pop("low")
    return {
        name: (
            np.abs(outcome.summaries[name] - exact[name]).astype(float),
            outcome.errors[name],
            np.abs(outcome.summaries[name]),
            sine[chosen],
        )
        for name in SUMMARIES[:-1]
    }
