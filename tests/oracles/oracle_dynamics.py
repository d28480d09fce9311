"""Energy of the oracle's motion and the forces of its actions, from first principles.

I is twice the kinetic energy at unit input speed. Radii of gyration come from quadrature over the shapes.
"""

import math

import numpy as np
from oracle import REAL, Motion, Pose
from scipy.interpolate import CubicSpline, PchipInterpolator

from engine import Scene


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


def _begin(drive: object, speed: float) -> float:
    """Position of the input at which time begins: the end of its range from which it moves."""
    full = drive.type == "crank" and drive.start is None
    ends = (0.0, 2 * math.pi * drive.revolutions) if full else (drive.start, drive.stop)
    return min(ends) if speed > 0 else max(ends)


def _tabled(action: object, motion: Motion, speed: float) -> np.ndarray:
    y = np.array(getattr(action, "force", None) or action.moment)
    if action.over_angle is not None:
        x, place, period = action.over_angle, motion.q, 2 * math.pi * motion.scene.input.revolutions
        assert x[-1] - x[0] < period, "the table closes itself"
        x, y = [*x, x[0] + period], [*y, y[0]]
        place = x[0] + (place - x[0]) % period
    elif action.over_time is not None:
        x, place = action.over_time, (motion.q - _begin(motion.scene.input, speed)) / speed
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


def _pump_force(pump: object, v: np.ndarray) -> np.ndarray:
    """Force along the slide coordinate: discharge pressure while the piston moves towards the head."""
    towards = v > 0 if pump.head == "high" else v < 0
    gauge = np.where(towards, pump.discharge, pump.suction) - pump.ambient
    return (-1 if pump.head == "high" else 1) * gauge * math.pi * pump.bore**2 / 4


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


def force_at(force: object, motion: Motion, speed: float | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Parts of a force along the frame's axes."""
    x, y = motion.points[force.on]
    if force.angle is None:
        v = np.sqrt(x.d**2 + y.d**2)
        value = _characteristic(force, motion, speed, abs(speed) * v) * np.sign(speed)
        return value * x.d / v, value * y.d / v
    way = Pose(0, 0, motion.links[force.turns_with].theta + force.angle)
    value = _characteristic(force, motion, speed, speed * (way.c.v * x.d + way.s.v * y.d))
    return value * way.c.v, value * way.s.v


def moment_on(moment: object, motion: Motion, speed: float | np.ndarray) -> np.ndarray:
    theta = motion.links[moment.on].theta
    if moment.type == "torsion_spring":
        return -moment.stiffness * (np.angle(np.exp(1j * theta.v.astype(float))) - moment.free_angle)
    return _characteristic(moment, motion, speed, speed * theta.d)


def pull_of(spring: object, motion: Motion, speed: float | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What a spring pulls its first end with, along the frame's axes."""
    (ax, ay), (bx, by) = (motion.points[end] for end in spring.between)
    ex, ey = bx - ax, by - ay
    length = np.hypot(ex.v, ey.v)
    rate = speed * (ex.v * ex.d + ey.v * ey.d) / length
    pull = spring.stiffness * (length - spring.free_length) + spring.damping * rate
    return pull * ex.v / length, pull * ey.v / length
