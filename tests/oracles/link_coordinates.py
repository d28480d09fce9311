"""Where free links are, to 50 digits: three coordinates a link and two equations a pair, no tree and no cut."""

from collections.abc import Mapping

import mpmath
import numpy as np

from engine import CrankInput, Scene

_FRAME = (0.0, 0.0, 0.0)


class LinkCoordinates:
    """The closure of all pairs of a scene of free links on a crank that turns about the frame's points.

    Parameters
    ----------
    scene : Scene
        All groups of free links.
    """

    def __init__(self, scene: Scene) -> None:
        assert isinstance(scene.input, CrankInput)
        self.scene, self.links = scene, tuple(scene.links)
        self._joints: dict[str, list[tuple[str, tuple]]] = {scene.input.pin: [("crank", (scene.input.length, 0.0))]}
        for name, point in scene.points.items():
            self._joints[name] = [(point.link, (point.x, point.y))]
        for name, link in scene.links.items():
            for joint, along in zip(link.joints, (0.0, link.length), strict=False):
                self._joints.setdefault(joint, []).append((name, (along, 0.0)))

    def _poses(self, x: list, q: object) -> dict[str, tuple]:
        pivot = self.scene.points[self.scene.input.pivot]
        found = {"frame": _FRAME, "crank": (pivot.x, pivot.y, q)}
        return found | {name: tuple(x[3 * i : 3 * i + 3]) for i, name in enumerate(self.links)}

    @staticmethod
    def _at(pose: tuple, place: tuple, m: object) -> tuple:
        x, y, angle = pose
        c, s = m.cos(angle), m.sin(angle)
        return x + c * place[0] - s * place[1], y + s * place[0] + c * place[1]

    def misses(self, x: list, q: object, m: object = mpmath) -> list:
        """What all pairs miss; `m` has sine and cosine."""
        poses, found = self._poses(x, q), []
        for ends in self._joints.values():
            (link, place), *others = ends
            first = self._at(poses[link], place, m)
            for other, there in others:
                found += [a - b for a, b in zip(first, self._at(poses[other], there, m), strict=True)]
        for name, link in self.scene.links.items():
            if link.guide is not None:
                guide = self.scene.guides[link.guide]
                carrier, own = poses[guide.link], poses[name]
                direction = carrier[2] + guide.angle
                x0, y0 = self._at(carrier, (guide.x, guide.y), m)
                left = (own[1] - y0) * m.cos(direction) - (own[0] - x0) * m.sin(direction)
                found += [m.sin(own[2] - direction), left - link.offset]
        return found

    @mpmath.workdps(50)
    def solved(self, near: list, q: object) -> list:
        """Coordinates at a crank angle from some that are close: corrections with the Jacobian in double precision."""
        columns = []
        for k in range(len(near)):
            moved = np.array([float(value) for value in near], complex)
            moved[k] += 1e-30j
            columns.append(np.imag(self.misses(list(moved), float(q), np)) / 1e-30)
        inverse = mpmath.matrix(np.linalg.inv(np.array(columns).T).tolist())
        exact = mpmath.matrix([mpmath.mpf(value) for value in near])
        for _ in range(8):
            exact -= inverse * mpmath.matrix(self.misses(list(exact), q))
        assert mpmath.norm(mpmath.matrix(self.misses(list(exact), q))) < mpmath.mpf(10) ** -44
        return list(exact)

    @mpmath.workdps(50)
    def motion(self, near: list, q: float) -> Mapping[str, tuple]:
        """Of each link its coordinates with first and second derivative by the crank's angle."""
        h = mpmath.mpf(10) ** -12
        here = self.solved(near, mpmath.mpf(q))
        after, before = (self.solved(here, mpmath.mpf(q) + side * h) for side in (1, -1))
        first = [(a - b) / (2 * h) for a, b in zip(after, before, strict=True)]
        second = [(a - 2 * o + b) / h**2 for a, o, b in zip(after, here, before, strict=True)]
        return {
            name: tuple(tuple(float(v) for v in part[3 * i : 3 * i + 3]) for part in (here, first, second))
            for i, name in enumerate(self.links)
        }
