"""A second machine, built otherwise: loop closures solved by Newton, in extended precision where there is any.

Every link has three unknowns (x, y, theta); pairs are equations between them: joints coincide, directions are
parallel, distances from a guide are kept. A `Jet` carries a number with its first two derivatives by the input,
so that the same equations give velocities and accelerations: J·du = −dF. Nothing of the engine's mechanics is used,
only its reading of scenes.

What the engine computes in float64 is compared with numbers good to about 1e-18 (long double on x86), or to
float64's own rounding elsewhere.
"""

import math
from collections.abc import Callable

import numpy as np

from engine import FRAME, CrankInput, Scene, Sliding, Yoke

REAL = np.longdouble
EPS = float(np.finfo(float).eps)


class Jet:
    """A number along the motion: value and first and second derivative by the input."""

    def __init__(self, v, d=0.0, dd=0.0):
        self.v, self.d, self.dd = (np.asarray(part, REAL) for part in (v, d, dd))

    def __add__(self, other):
        o = jet(other)
        return Jet(self.v + o.v, self.d + o.d, self.dd + o.dd)

    def __mul__(self, other):
        o = jet(other)
        return Jet(self.v * o.v, self.d * o.v + self.v * o.d, self.dd * o.v + 2 * self.d * o.d + self.v * o.dd)

    def __neg__(self):
        return Jet(-self.v, -self.d, -self.dd)

    def __sub__(self, other):
        o = jet(other)
        return Jet(self.v - o.v, self.d - o.d, self.dd - o.dd)

    __radd__, __rmul__ = __add__, __mul__

    def turned(self):
        """Cosine and sine of an angle."""
        c, s = np.cos(self.v), np.sin(self.v)
        return Jet(c, -s * self.d, -s * self.dd - c * self.d**2), Jet(s, c * self.d, c * self.dd - s * self.d**2)


def jet(x):
    return x if isinstance(x, Jet) else Jet(x)


class Pose:
    """A link: origin and angle of its axes."""

    def __init__(self, x, y, theta):
        self.x, self.y, self.theta = jet(x), jet(y), jet(theta)
        self.c, self.s = self.theta.turned()

    def point(self, a, b):
        """Where the point (a, b) of the link is."""
        return self.x + self.c * a - self.s * b, self.y + self.s * a + self.c * b

    def seen(self, x, y):
        """Coordinates in the link's axes of a place given in the frame's."""
        ex, ey = x - self.x, y - self.y
        return self.c * ex + self.s * ey, self.c * ey - self.s * ex


def _inverse(matrix):
    rough = matrix.astype(float)
    try:
        return np.linalg.inv(rough)
    except np.linalg.LinAlgError:
        return np.linalg.pinv(rough)


def solved(matrix, right):
    """Batched linear solution, refined to the precision of REAL."""
    inverse, x = _inverse(matrix), np.zeros_like(right)
    for _ in range(4):
        residual = right - np.einsum("...ij,...j->...i", matrix, x)
        x = x + np.einsum("...ij,...j->...i", inverse, residual.astype(float))
    return x


def _parts(jets: list[Jet], order: str, shape: tuple[int, ...]) -> np.ndarray:
    return np.stack([np.broadcast_to(getattr(f, order), shape) for f in jets], axis=-1)


def _jacobian(closure: Callable, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values and Jacobian of the closure at u (..., unknowns), by one seed for each unknown.

    The first derivative without a seed is the known links' own motion, which is subtracted.
    """
    n, shape = u.shape[-1], u.shape[:-1]
    seeds = np.vstack((np.zeros(n), np.eye(n))).reshape(n + 1, *([1] * len(shape)), n)
    found = closure([Jet(u[..., i], seeds[..., i]) for i in range(n)])
    slopes = _parts(found, "d", (n + 1, *shape))
    return _parts(found, "v", shape), np.moveaxis(slopes[1:] - slopes[0], 0, -1)


def _newton(closure: Callable, u: np.ndarray) -> np.ndarray:
    """Newton's method at every position and from every start; NaN where it doesn't arrive."""
    size = 1.0 + np.abs(u).max(axis=-1, keepdims=True)
    for _ in range(30):
        values, jacobian = _jacobian(closure, u)
        jacobian[~np.isfinite(jacobian.astype(float)).all(axis=(-2, -1))] = np.eye(u.shape[-1])
        # Rounding of the step is mended by the next one: the residual decides.
        step = np.matmul(_inverse(jacobian), values.astype(float)[..., None])[..., 0]
        # Steps of more than a radian or so leave the neighbourhood; lengths here are of order one.
        longest = np.abs(step).max(axis=-1, keepdims=True)
        u = u - step * np.minimum(1.0, 1.0 / np.maximum(longest, 1e-300))
        if np.nanmax(longest / size) < 64 * np.finfo(REAL).eps:
            break
    values, _ = _jacobian(closure, u)
    arrived = np.abs(values).max(axis=-1, keepdims=True) < 1e-14 * size
    return np.where(arrived, u, np.nan)


def _assembled(closure: Callable, in_mode: Callable, starts: list, positions: int) -> list[Jet]:
    """Solution in the asked assembly mode, with its derivatives; NaN where no start leads to one."""
    guesses = [np.broadcast_to(np.asarray(x, REAL), positions) for start in starts for x in start]
    with np.errstate(all="ignore"):
        ends = _newton(closure, np.stack(guesses, -1).reshape(positions, len(starts), -1).swapaxes(0, 1))
        good = in_mode([jet(x) for x in np.moveaxis(ends, -1, 0)])
    found = ends[good.argmax(axis=0), np.arange(positions)]
    found[~good.any(axis=0)] = np.nan
    _, jacobian = _jacobian(closure, np.nan_to_num(found))
    rest = closure([Jet(x) for x in found.T])
    first = solved(jacobian, -_parts(rest, "d", found.shape[:-1]))
    rest = closure([Jet(x, d) for x, d in zip(found.T, first.T, strict=True)])
    second = solved(jacobian, -_parts(rest, "dd", found.shape[:-1]))
    return [Jet(*parts) for parts in zip(found.T, first.T, second.T, strict=True)]


class Motion:
    """The motion of a scene at input positions q (crank angles, or displacements of a sliding input).

    Attributes
    ----------
    links, points, guides, slides, transmissions : dict
        By name: Pose, (Jet, Jet), Pose, Jet and array.
    """

    def __init__(self, scene: Scene, q: np.ndarray) -> None:
        self.scene = scene
        self.q = np.atleast_1d(np.asarray(q, REAL))
        self.q_jet = Jet(self.q, 1, 0)
        self._solved: set[str] = set()
        self.links: dict[str, Pose] = {FRAME: Pose(0 * self.q, 0 * self.q, 0 * self.q)}
        self.points: dict[str, tuple[Jet, Jet]] = {}
        self.guides: dict[str, Pose] = {}
        self.slides: dict[str, Jet] = {}
        self.transmissions: dict[str, np.ndarray] = {}
        self.extend(scene)

    def extend(self, scene: Scene) -> "Motion":
        """Solve what a scene has beyond what is known, in whatever order it becomes possible."""
        self.scene = scene
        waiting = [("input", scene.input.link, scene.input)]
        waiting += [("shaft", name, s) for name, s in scene.shafts.items()]
        waiting += [(g.type.lower(), name, g) for name, g in scene.groups.items()]
        waiting = [w for w in waiting if w[1] not in self._solved]
        self._carried_parts()
        while waiting:
            ready = [w for w in waiting if self._hangs_on_known(w[2])]
            assert ready, "the scene can't be ordered"
            for kind, name, part in ready:
                getattr(self, kind)(name, part)
                self._solved.add(name)
                self._carried_parts()
            waiting = [w for w in waiting if w not in ready]
        return self

    def _hangs_on_known(self, part: object) -> bool:
        known = {"pivot": self.points, "joint": self.points, "guide": self.guides, "geared_to": self.links}
        sides = [getattr(part, side) for side in ("first", "second") if hasattr(part, side)] or [part]
        names = [(getattr(side, key, None), table) for side in sides for key, table in known.items()]
        return all(name in table for name, table in names if name is not None)

    def _carried_parts(self) -> None:
        for name, p in self.scene.points.items():
            if p.link in self.links and name not in self.points:
                self.points[name] = self.links[p.link].point(p.x, p.y)
        for name, g in self.scene.guides.items():
            if g.link in self.links and name not in self.guides:
                link = self.links[g.link]
                self.guides[name] = Pose(*link.point(g.x, g.y), link.theta + g.angle)

    # Elements

    def input(self, name: str, drive: object) -> None:
        if isinstance(drive, CrankInput):
            self.links[name] = Pose(*self.points[drive.pivot], self.q_jet)
            self.points[drive.pin] = self.links[name].point(drive.length, 0)
            return
        guide = self.guides[drive.guide]
        self.slides[name] = self.q_jet
        self.points[drive.point] = guide.point(self.q_jet, 0)
        self.links[name] = Pose(*self.points[drive.point], guide.theta)

    def shaft(self, name: str, shaft: object) -> None:
        theta = self.links[shaft.geared_to].theta * shaft.ratio + shaft.phase
        pivot = (jet(0), jet(0)) if shaft.pivot is None else self.points[shaft.pivot]
        self.links[name] = Pose(*pivot, theta)

    def _assemble(self, name: str, g: object, closure: Callable, in_mode: Callable, starts: list) -> tuple:
        u = _assembled(lambda u: closure(Pose(*u[:3]), Pose(*u[3:])), in_mode, starts, self.q.size)
        pair = Pose(*u[:3]), Pose(*u[3:])
        self.links[g.first.link], self.links[g.second.link] = pair
        for part, link in zip((g.first, g.second), pair, strict=True):
            if isinstance(part, (Sliding, Yoke)):
                self.slides[part.link] = self.guides[part.guide].seen(link.x, link.y)[0]
        if hasattr(g, "inner"):
            x, y = pair[0].x, pair[0].y
            self.points[g.inner] = pair[0].point(g.first.length, 0) if hasattr(g.first, "length") else (x, y)
        return pair

    @staticmethod
    def _same(a: tuple, b: tuple) -> list[Jet]:
        return [a[0] - b[0], a[1] - b[1]]

    def rrr(self, name: str, g: object) -> None:
        a, d = self.points[g.first.joint], self.points[g.second.joint]

        def closure(one: Pose, two: Pose) -> list[Jet]:
            inner = one.point(g.first.length, 0), two.point(g.second.length, 0)
            return [*self._same((one.x, one.y), a), *self._same((two.x, two.y), d), *self._same(*inner)]

        def in_mode(u: list[Jet]) -> np.ndarray:
            b = Pose(*u[:3]).point(g.first.length, 0)
            left = (d[0] - a[0]) * (b[1] - a[1]) - (d[1] - a[1]) * (b[0] - a[0])
            # Mode +1: B lies to the left of A → D.
            return left.v * g.mode > 0

        starts = []
        for t in TURNS:
            tip = a[0].v + g.first.length * math.cos(t), a[1].v + g.first.length * math.sin(t)
            starts.append((a[0].v, a[1].v, t, d[0].v, d[1].v, np.arctan2(tip[1] - d[1].v, tip[0] - d[0].v)))
        one, two = self._assemble(name, g, closure, in_mode, starts)
        self.transmissions[name] = g.mode * np.abs(np.sin(one.theta.v - two.theta.v))

    def rrp(self, name: str, g: object) -> None:
        a, guide = self.points[g.first.joint], self.guides[g.second.guide]

        def closure(rod: Pose, slider: Pose) -> list[Jet]:
            joint = self._same(rod.point(g.first.length, 0), (slider.x, slider.y))
            across = guide.seen(slider.x, slider.y)[1] - g.second.offset
            return [*self._same((rod.x, rod.y), a), *joint, across, slider.theta - guide.theta]

        def in_mode(u: list[Jet]) -> np.ndarray:
            return (guide.seen(u[3], u[4])[0] - guide.seen(*a)[0]).v * g.mode > 0

        starts = [(a[0].v, a[1].v, t, a[0].v, a[1].v, guide.theta.v) for t in TURNS]
        rod, _ = self._assemble(name, g, closure, in_mode, starts)
        self.transmissions[name] = np.cos(rod.theta.v - guide.theta.v)

    def rpr(self, name: str, g: object) -> None:
        a, d = self.points[g.first.joint], self.points[g.second.joint]

        def closure(block: Pose, rocker: Pose) -> list[Jet]:
            across = rocker.seen(block.x, block.y)[1] - g.second.offset
            pivots = [*self._same((block.x, block.y), a), *self._same((rocker.x, rocker.y), d)]
            return [*pivots, across, block.theta - rocker.theta]

        def in_mode(u: list[Jet]) -> np.ndarray:
            return Pose(*u[3:]).seen(*a)[0].v * g.mode > 0

        starts = [(a[0].v, a[1].v, t, d[0].v, d[1].v, t) for t in TURNS]
        _, rocker = self._assemble(name, g, closure, in_mode, starts)
        slide = self.slides[g.first.link] = rocker.seen(*a)[0]
        self.transmissions[name] = slide.v / np.hypot((a[0] - d[0]).v, (a[1] - d[1]).v)

    def prp(self, name: str, g: object) -> None:
        one, two = self.guides[g.first.guide], self.guides[g.second.guide]

        def closure(p: Pose, r: Pose) -> list[Jet]:
            distances = [one.seen(p.x, p.y)[1] - g.first.offset, two.seen(r.x, r.y)[1] - g.second.offset]
            parallel = [p.theta - one.theta, r.theta - two.theta]
            return [*self._same((p.x, p.y), (r.x, r.y)), *distances, *parallel]

        starts = [(0.1, 0.1, one.theta.v, 0.1, 0.1, two.theta.v)]
        self._assemble(name, g, closure, lambda u: np.isfinite(u[0].v), starts)
        self.transmissions[name] = np.sin((two.theta - one.theta).v)

    def rpp(self, name: str, g: object) -> None:
        a, guide = self.points[g.first.joint], self.guides[g.second.guide]

        def closure(block: Pose, yoke: Pose) -> list[Jet]:
            # The yoke's origin is the crossing of slot and guide: it sees the block's pivot along the slot.
            pivot = self._same((block.x, block.y), a)
            in_slot = block.seen(yoke.x, yoke.y)[1]
            angles = [block.theta - yoke.theta - g.second.slot_angle, yoke.theta - guide.theta]
            return [*pivot, guide.seen(yoke.x, yoke.y)[1], in_slot, *angles]

        slot = guide.theta.v + g.second.slot_angle
        starts = [(a[0].v, a[1].v, slot, a[0].v, a[1].v, guide.theta.v)]
        block, yoke = self._assemble(name, g, closure, lambda u: np.isfinite(u[0].v), starts)
        self.slides[g.first.link] = -block.seen(yoke.x, yoke.y)[0]
        self.transmissions[name] = np.full(self.q.size, np.sin(REAL(g.second.slot_angle)))

    def field(self, name: str) -> np.ndarray:
        """A kinematic field by the engine's name, such as "B.x_phi"."""
        owner, _, rest = name.rpartition(".")
        what, _, order = rest.partition("_")
        if what == "transmission":
            return self.transmissions[owner]
        value = {
            "x": lambda: self.points[owner][0],
            "y": lambda: self.points[owner][1],
            "angle": lambda: self.links[owner].theta,
            "slide": lambda: self.slides[owner],
        }[what]()
        return getattr(value, {"": "v", "phi": "d", "phiphi": "dd"}[order]) + 0 * self.q


# Angles to start Newton from; none is likely to be that of a singular position.
TURNS = tuple(math.pi / 3 * k + 0.1 for k in range(6))
