"""A second machine, built otherwise: loop closures solved by Newton, in extended precision where there is any.

Every link has three unknowns (x, y, theta); pairs are equations between them: joints coincide, directions are
parallel, distances from a guide are kept. A `Jet` carries a number with its first two derivatives by the input,
so that the same equations give velocities and accelerations: J·du = −dF. Forces act on real velocities and
their power is divided by the input's speed. Nothing of the engine's mechanics is used, only its reading of scenes.

What the engine computes in float64 is compared with numbers good to about 1e-18 (long double on x86), or to
float64's own rounding elsewhere.
"""

import math
from collections.abc import Callable

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator

from engine import Scene
from engine.parts import FRAME, CrankInput, Sliding, Yoke

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
        return Jet(
            self.v * o.v,
            self.d * o.v + self.v * o.d,
            self.dd * o.v + 2 * self.d * o.d + self.v * o.dd,
        )

    def __neg__(self):
        return self * -1

    def __sub__(self, other):
        return self + -jet(other)

    __radd__, __rmul__ = __add__, __mul__

    def turned(self):
        """Cosine and sine of an angle."""
        c, s = np.cos(self.v), np.sin(self.v)
        return (
            Jet(c, -s * self.d, -s * self.dd - c * self.d**2),
            Jet(s, c * self.d, c * self.dd - s * self.d**2),
        )


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


def _solved(matrix, right):
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
    for _ in range(40):
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
    first = _solved(jacobian, -_parts(rest, "d", found.shape[:-1]))
    rest = closure([Jet(x, d) for x, d in zip(found.T, first.T, strict=True)])
    second = _solved(jacobian, -_parts(rest, "dd", found.shape[:-1]))
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
        while waiting:
            self._carried_parts()
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
            return left.v * g.mode > 0  # B lies to the left of A → D for mode +1

        starts = [(a[0].v, a[1].v, t1, d[0].v, d[1].v, t2) for t1 in QUARTERS for t2 in QUARTERS]
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

        starts = [(a[0].v, a[1].v, t, a[0].v, a[1].v, guide.theta.v) for t in QUARTERS]
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

        starts = [(a[0].v, a[1].v, t, d[0].v, d[1].v, t) for t in (*QUARTERS, 0.3, 1.8, 3.4, 5.0)]
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


QUARTERS = tuple(math.pi / 2 * k + 0.1 for k in range(4))


# Energy and power


def _shape_inertia(shape: object) -> float:
    """Square of the radius of gyration of a uniform shape about its centre, by Gauss's quadrature."""
    x, w = np.polynomial.legendre.leggauss(8)
    match shape.type:
        case "rod":
            return float(np.sum(w * (x * shape.length / 2) ** 2) / np.sum(w))
        case "plate":
            a, b = x * shape.length / 2, x * shape.width / 2
            return float(np.sum(np.outer(w, w) * (a[:, None] ** 2 + b**2)) / np.sum(np.outer(w, w)))
    inner = getattr(shape, "inner_diameter", 0.0) / 2
    half = (shape.diameter / 2 - inner) / 2
    r = inner + half * (1 + x)
    return float(np.sum(w * r**3) / np.sum(w * r))


def _shape_mass(shape: object, density: float) -> float:
    match shape.type:
        case "rod":
            return density * shape.area * shape.length
        case "plate":
            return density * shape.length * shape.width * shape.thickness
    radii = (shape.diameter / 2, getattr(shape, "inner_diameter", 0.0) / 2)
    return density * shape.thickness * math.pi * (radii[0] ** 2 - radii[1] ** 2)


def body_of(body: object) -> tuple[float, float, float, float]:
    """Mass, centre (x, y) and moment of inertia about it."""
    if body.shape is None:
        return body.mass, body.x or 0.0, body.y, body.inertia or 0.0
    mass = body.mass if body.mass is not None else _shape_mass(body.shape, body.density)
    middle = body.shape.length / 2 if body.shape.type == "rod" else 0.0
    return mass, middle if body.x is None else body.x, body.y, mass * _shape_inertia(body.shape)


def reduced_inertia(motion: Motion) -> np.ndarray:
    """Twice the kinetic energy at unit input speed, Σ m v² + J ω²."""
    total = 0 * motion.q
    for body in motion.scene.bodies.values():
        mass, x, y, inertia = body_of(body)
        link = motion.links[body.link]
        px, py = link.point(x, y)
        total = total + mass * (px.d**2 + py.d**2) + inertia * link.theta.d**2
    for name, shaft in motion.scene.shafts.items():
        total = total + shaft.inertia * motion.links[name].theta.d ** 2
    return total


def reduced_inertia_phi(scene: Scene, q: np.ndarray, h: float = 0.02) -> np.ndarray:
    """dI/dq by the central difference of tenth order: truncation h¹⁰·I⁽¹¹⁾/2772."""
    weights = np.array([2100, -600, 150, -25, 2], REAL) / 2520
    q = np.asarray(q, REAL)
    ends = [(reduced_inertia(Motion(scene, q + k * h)), reduced_inertia(Motion(scene, q - k * h))) for k in range(1, 6)]
    return sum(w * (up - down) for w, (up, down) in zip(weights, ends, strict=True)) / h


def _characteristic(action: object, motion: Motion, speed: float, v: np.ndarray) -> np.ndarray:
    """Value of a force or moment along its direction at the real velocity v there."""
    against = -np.sign(v)
    match action.type:
        case "constant":
            value = getattr(action, "force", None) or action.moment
        case "against_motion":
            value = against * getattr(action, "force", getattr(action, "moment", None))
        case "linear_drag":
            value = -action.coefficient * v
        case "quadratic_drag":
            value = action.coefficient * v**2 * against
        case "power_drag":
            at = getattr(action, "force", getattr(action, "moment", None))
            value = at * (np.abs(v) / action.at_speed) ** action.exponent * against
        case "table":
            value = action.scale * _tabled(action, motion, speed)
    if getattr(action, "acts", "always") == "always":
        return value
    return np.where(v > 0 if action.acts == "along" else v < 0, value, 0)


def _tabled(action: object, motion: Motion, speed: float) -> np.ndarray:
    y = np.array(getattr(action, "force", None) or action.moment)
    if action.over_angle is not None:
        x, place, period = action.over_angle, motion.q, 2 * math.pi * motion.scene.input.revolutions
        assert x[-1] - x[0] < period, "the table closes itself"
        x, y = [*x, x[0] + period], [*y, y[0]]
        place = x[0] + (place - x[0]) % period
    elif action.over_time is not None:
        x, place = action.over_time, motion.q / speed
    else:
        x, slide = action.over_stroke, motion.slides[action.slider].v
        low, high = stroke(motion.scene, action.slider) if action.measured_from != "guide" else (0, 0)
        place = {"guide": slide, "low end": slide - low, "high end": high - slide}[action.measured_from]
    place = np.asarray(place, float)
    inside = np.clip(place, x[0], x[-1])
    curve = {
        "linear": lambda: np.interp(inside, x, y),
        "pchip": lambda: PchipInterpolator(x, y)(inside),
        "spline": lambda: CubicSpline(x, y, bc_type="natural")(inside),
    }[action.interpolation]()
    return np.where((place == inside) | (action.outside == "hold"), curve, 0.0)


def stroke(scene: Scene, slider: str) -> tuple[float, float]:
    """Low and high end of a slider's motion over a full turn: roots of the velocity by Newton."""
    q = np.linspace(0, 2 * math.pi, 64, endpoint=False).astype(REAL)
    slide = Motion(scene, q).slides[slider]
    ends = []
    for pick in (np.argmin, np.argmax):
        at = q[[pick(slide.v)]]
        for _ in range(8):
            s = Motion(scene, at).slides[slider]
            at = at - s.d / s.dd
        ends.append(float(s.v[0]))
    return ends[0], ends[1]


def moments(motion: Motion) -> dict[str, np.ndarray]:
    """Reduced moment of every force, moment, spring and of gravity, by its name: power over input speed."""
    scene, found = motion.scene, {}
    speed = scene.input.speed
    for name, force in scene.forces.items():
        x, y = motion.points[force.on]
        if force.angle is None:
            v = abs(speed) * np.sqrt(x.d**2 + y.d**2)
        else:
            direction = Pose(0, 0, motion.links[force.turns_with].theta + force.angle)
            v = speed * (direction.c.v * x.d + direction.s.v * y.d)
        found[name] = _characteristic(force, motion, speed, v) * v / speed
    for name, moment in scene.moments.items():
        theta = motion.links[moment.on].theta
        if moment.type == "torsion_spring":
            angle = np.angle(np.exp(1j * theta.v.astype(float)))
            found[name] = -moment.stiffness * (angle - moment.free_angle) * theta.d
        else:
            found[name] = _characteristic(moment, motion, speed, speed * theta.d) * theta.d
    for name, spring in scene.springs.items():
        (ax, ay), (bx, by) = (motion.points[end] for end in spring.between)
        ex, ey = bx - ax, by - ay
        length = np.hypot(ex.v, ey.v)
        rate = (ex.v * ex.d + ey.v * ey.d) / length
        pull = spring.stiffness * (length - spring.free_length) + spring.damping * speed * rate
        found[name] = -pull * rate
    found["gravity"] = 0 * motion.q
    for body in scene.bodies.values():
        mass, x, y, _ = body_of(body)
        found["gravity"] = found["gravity"] - mass * scene.gravity * motion.links[body.link].point(x, y)[1].d
    return found
