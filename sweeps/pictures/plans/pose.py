"""Velocities and accelerations of one machine at a position, at constant input speed."""

from functools import cached_property
from typing import NamedTuple

import numpy as np

import engine
from sweeps.pictures.drawing import DrawnMotion, position_text
from sweeps.pictures.drawing.figures import default_position


class Movement(NamedTuple):
    """Position [m], velocity [m/s] and acceleration [m/s²] of a point of a link, as x + iy."""

    place: complex
    v: complex
    a: complex


class Turn(NamedTuple):
    """Angular velocity [rad/s] and acceleration [rad/s²] of a link."""

    omega: float
    epsilon: float


class Pose:
    """A machine at one position, at constant input speed.

    Parameters
    ----------
    motion : DrawnMotion
    k : int
        Node index.
    """

    def __init__(self, motion: DrawnMotion, k: int) -> None:
        self.motion, self.k = motion, k
        self.scene = motion.scene

    @property
    def title(self) -> str:
        """The position as text."""
        return position_text(self.scene, self.motion.q[self.k]).replace("-", "\N{MINUS SIGN}")

    def number(self, link: str) -> int:
        """Number of a link."""
        return self.motion.link_numbers[link]

    def _movement(self, point: engine.MovingPoint) -> Movement:
        place, v, a = (complex(row[self.k]) for row in point)
        return Movement(place, v * self.motion.omega, a * self.motion.omega**2)

    def place(self, name: str) -> complex:
        """Position of a point of the scene [m]."""
        return complex(self.motion.points[name][self.k])

    def point(self, name: str) -> Movement:
        """Motion of a point of the scene."""
        return self._movement(self.motion.rates.points[name])

    def turn(self, link: str) -> Turn:
        """Rotation of a link."""
        turning = self.motion.rates.links[link]
        w, e = (float(row[self.k]) for row in (turning.w, turning.e))
        return Turn(w * self.motion.omega, e * self.motion.omega**2)

    def slide(self, link: str) -> tuple[float, float]:
        """Velocity [m/s] and acceleration [m/s²] of a slider along its guide or slot."""
        slide = self.motion.rates.slides[link]
        return float(slide.v[self.k]) * self.motion.omega, float(slide.a[self.k]) * self.motion.omega**2

    def direction(self, link: str) -> complex:
        """Unit vector of a link's x axis."""
        return complex(self.motion.axes[link][1][self.k])

    def guide(self, name: str) -> complex:
        """Unit vector of a guide."""
        return complex(self.motion.guides[name][1][self.k])

    def origin(self, link: str) -> Movement:
        """Motion of the origin of a link's axes."""
        return self._movement(self.motion.rates.links[link].origin)

    def rigid(self, link: str, place: complex) -> Movement:
        """Motion of the link's point now at `place` [m]."""
        o, turn = self.origin(link), self.turn(link)
        arm = place - o.place
        v = o.v + 1j * turn.omega * arm
        return Movement(place, v, o.a + 1j * turn.epsilon * arm - turn.omega**2 * arm)

    @cached_property
    def acting(self) -> list[engine.LinkForce]:
        """All loads of each link: points and forces as x + iy."""

        def here(row: np.ndarray | None) -> complex | float | None:
            return None if row is None else row[self.k].item()

        return [
            force._replace(at=here(force.at), force=here(force.force), moment=here(force.moment))
            for force in self.motion.link_forces
        ]

    def centre(self, body: str) -> Movement:
        """Motion of the centre of mass of a body."""
        return self._movement(self.motion.rates.centres[body])


def pose_at(drawn: engine.Scene | DrawnMotion, position: float | None = None) -> Pose:
    """A machine at the node nearest to a crank angle [rad] or displacement [m].

    Parameters
    ----------
    drawn : Scene or DrawnMotion
    position : float, optional
        Default: a suitable position.

    Raises
    ------
    PictureError
        The position is outside the input's range, or the mechanism can't be assembled there.
    """
    motion = DrawnMotion.of(drawn)
    return Pose(motion, motion.node(default_position(motion) if position is None else position))
