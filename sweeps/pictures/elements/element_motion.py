"""Cams with their followers, and gear trains along their axes, over a turn, as figures of a drawing."""

import cmath
import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

import engine
from sweeps.pictures.drawing.symbols import Primitive, bush, fixed_pivot, line
from sweeps.pictures.machine.animation import Frames
from sweeps.pictures.picture_error import PictureError

# Size of a cam or train in hinge radii; how far a stem reaches beyond its guide, as a share of the cam.
RADII, STEM = 45, 0.45
SPOKES = 3


def element_frames(element: engine.CamElement | engine.GearTrain, frames: int) -> Frames:
    """Positions of an element over a turn.

    Parameters
    ----------
    element : Element
    frames : int

    Raises
    ------
    PictureError
        The element doesn't move, or has no shape.
    """
    return _cam_frames(element, frames) if isinstance(element, engine.CamElement) else _train_frames(element, frames)


# Cams


def reached_curves(cam: engine.CamElement, *points: int) -> engine.CamCurves:
    """Curves of a cam as by `engine.cam_curves`.

    Raises
    ------
    PictureError
        Its follower doesn't reach the base circle.
    """
    curves = engine.cam_curves(cam, *points)
    if not curves.angle.size:
        raise PictureError("the follower of the cam doesn't reach the base circle; enlarge base_radius")
    return curves


def _cam_frames(cam: engine.CamElement, frames: int) -> Frames:
    curves = reached_curves(cam)
    radius = hinge_radius(curves)
    at = np.searchsorted(curves.angle, math.tau * np.arange(frames) / frames).clip(max=curves.angle.size - 1)
    poses = [[*_cam(curves, k), *follower_figures(cam, curves, k, radius)] for k in at]
    stand = fixed_pivot(0j, radius)
    axis = Primitive("joints", "circle", (0j,), radius, "paper")
    base = Primitive("pitch", "circle", (0j,), cam.base_radius)
    titles = [f"φ = {math.degrees(curves.angle[k]):.0f}°, {_displacement(cam, curves, k)}" for k in at]
    return Frames([[*stand, base, *pose, axis] for pose in poses], titles, radius)


def hinge_radius(curves: engine.CamCurves) -> float:
    """Radius of a hinge next to a cam [m]."""
    return 2 * float(np.abs(curves.profile).max()) / RADII


def _displacement(cam: engine.CamElement, curves: engine.CamCurves, k: int) -> str:
    symbol, unit = ("s", "m") if cam.translating else ("ψ", "rad")
    return f"{symbol} = {engine.quantity_text(float(curves.displacement[k]), unit)}"


def _cam(curves: engine.CamCurves, k: int) -> Iterator[Primitive]:
    """Profile of a cam, and a mark on it that shows how it turns."""
    turned = curves.profile * np.exp(1j * curves.sense * curves.angle[k])
    yield line(*turned, turned[0])
    yield line(0j, 0.6 * turned[0], layer="frame")


def follower_figures(cam: engine.CamElement, curves: engine.CamCurves, k: int, r: float) -> list[Primitive]:
    """Roller, edge or face of a cam's follower, with its stem in a guide or its arm on a pivot.

    Parameters
    ----------
    cam : CamElement
    curves : CamCurves
    k : int
        Position among those of the curves.
    r : float
        Hinge radius [m].
    """
    contact, centre = complex(curves.contact[k]), complex(curves.follower[k])
    size, found = float(np.abs(curves.profile).max()), []
    if cam.translating:
        foot = complex(cam.follower.offset, contact.imag) if cam.follower.contact == "flat" else centre
        top = max(curves.contact.imag.max(), curves.follower.imag.max()) + STEM * size
        found += bush(foot.real + 1j * top, 1j, r)
        lift = foot.imag - min(curves.follower.imag.min(), curves.contact.imag.min())
        found.append(line(foot, foot.real + 1j * (top + STEM * size / 2 + lift)))
        if cam.follower.contact == "flat":
            touched = np.array([foot.real, curves.contact.real.min(), curves.contact.real.max()])
            ends = touched.min() - 0.1 * size, touched.max() + 0.1 * size
            found.append(line(*(complex(end, foot.imag) for end in ends)))
    else:
        pivot = complex(cam.follower.pivot_distance)
        end = centre if cam.follower.contact != "flat" else pivot + 1.35 * (contact - pivot)
        found += [*fixed_pivot(pivot, r), line(pivot, end), Primitive("joints", "circle", (pivot,), r, "paper")]
    if cam.follower.contact == "roller":
        found.append(Primitive("links", "circle", (centre,), abs(centre - contact), "paper"))
        found.append(Primitive("joints", "circle", (centre,), 0.55 * r, "solid"))
    return found


# Gear trains


def _train_frames(train: engine.GearTrain, frames: int) -> Frames:
    """A train seen along its axes, until its slowest shaft has turned once."""
    picture = engine.velocity_picture(train)
    speeds = {name: shown.speed for name, shown in picture.lines.items()}
    turning = [abs(speed) for speed in speeds.values() if speed and math.isfinite(speed)]
    if not turning or not picture.wheels:
        raise PictureError("no shaft of the train turns")
    times = math.tau / min(turning) * np.arange(frames) / frames
    radius = max(abs(wheel.axis) + wheel.radius for wheel in picture.wheels.values()) / RADII
    seen = _TrainAt(train, picture, speeds, radius)
    titles = [f"t = {engine.quantity_text(float(time), 's')}" for time in times]
    return Frames([seen.figures(time) for time in times], titles, radius)


class _TrainAt(NamedTuple):
    """A gear train at any time; `speeds` of its shafts [rad/s]."""

    train: engine.GearTrain
    picture: engine.VelocityPicture
    speeds: dict[str, float]
    radius: float

    def figures(self, time: float) -> list[Primitive]:
        """Wheels, the arms of carriers, and axes at a time [s]."""
        found, axes = [], []
        # Rings below, so that planets are seen within.
        for name, wheel in sorted(self.picture.wheels.items(), key=lambda pair: -pair[1].radius):
            shaft = self.train.wheels[name].shaft
            for k in range(self.sets(shaft)):
                found += self.wheel(wheel, self.place(shaft, time, k), self.speeds.get(shaft, 0.0) * time)
        for shaft in self.picture.axes:
            carrier = self.train.shafts[shaft].carrier
            for k in range(self.sets(shaft)):
                at = self.place(shaft, time, k)
                if carrier is not None:
                    found.append(line(self.place(carrier, time, k), at))
                axes.append(Primitive("joints", "circle", (at,), self.radius, "paper"))
        return [*found, *axes]

    def sets(self, shaft: str) -> int:
        """Number of copies of a shaft: several for planets."""
        carrier = None if shaft == engine.FRAME else self.train.shafts[shaft].carrier
        if carrier is None:
            return 1
        return round(self.train.shafts[carrier].planets or 1) * self.sets(carrier)

    def place(self, shaft: str, time: float, k: int) -> complex:
        """Axis of a shaft, of the set k; the line of centres points up."""
        height = self.picture.axes.get(shaft, 0.0)
        carrier = None if shaft == engine.FRAME else self.train.shafts[shaft].carrier
        if carrier is None:
            return 1j * height
        turned = self.speeds.get(carrier, 0.0) * time + math.tau * k / self.sets(shaft)
        return self.place(carrier, time, k) + 1j * (height - self.picture.axes[carrier]) * cmath.exp(1j * turned)

    def wheel(self, wheel: engine.DrawnWheel, centre: complex, angle: float) -> list[Primitive]:
        """Pitch circle of a wheel with spokes, or of a ring with marks outside, turned by an angle."""
        inner, outer = (1.0, 1.12) if wheel.is_ring else (0.0, 1.0)
        spokes = [1j * wheel.radius * cmath.exp(1j * (angle + math.tau * s / SPOKES)) for s in range(SPOKES)]
        rims = [Primitive("links", "circle", (centre,), wheel.radius)]
        if wheel.is_ring:
            rims.append(Primitive("links", "circle", (centre,), outer * wheel.radius))
        return [*rims, *(line(centre + inner * s, centre + outer * s, layer="frame") for s in spokes)]
