"""One machine over its cycle, and its velocities and accelerations at a position, at constant input speed."""

from collections.abc import Callable
from functools import cached_property
from typing import NamedTuple, TypeVar

import numpy as np

import engine
from sweeps.pictures.drawing import DrawnMotion, position_text
from sweeps.pictures.drawing.figures import default_position
from sweeps.pictures.picture_error import PictureError

Found = TypeVar("Found")


class MachineCycle:
    """One machine over its cycle: positions, motion and forces.

    Parameters
    ----------
    drawn : Scene or DrawnMotion

    Attributes
    ----------
    motion : DrawnMotion
    numbers : Numbers
    link_numbers : dict of str to int
        Link numbers in plans: frame 0, input 1, then groups, second inputs, followers, wheels.

    Raises
    ------
    PictureError
        The mechanism can't be assembled at any position.
    """

    def __init__(self, drawn: engine.Scene | DrawnMotion) -> None:
        self.motion = DrawnMotion.of(drawn)
        scene = self.scene = self.motion.scene
        self.numbers = self.motion.numbers
        self.structure = engine.order_groups(scene)
        in_groups = [link for links in self.groups.values() for link in links]
        links = [engine.FRAME, scene.input.link, *in_groups, *scene.inputs]
        links += [cam.follower.link for cam in scene.cams.values()]
        links += [*scene.shafts, *scene.noncircular_wheels, *scene.racks, *scene.pinions]
        self.link_numbers = {link: i for i, link in enumerate(links)}
        self.omega = float(self.numbers["input.speed"])

    @cached_property
    def groups(self) -> dict[str, tuple[str, ...]]:
        """Links of each group, in group order."""
        free = self.structure.free_groups
        return {
            e.name: free[e.name].links if e.name in free else engine.group_links(self.scene, e.name)
            for e in self.structure.elements
            if e.kind in ("group", "free group")
        }

    def _found(self, find: Callable[[], Found]) -> Found:
        try:
            return find()
        except engine.NowhereDefinedError as error:
            raise PictureError(f"no plans of this machine: {error}") from None

    @cached_property
    def rates(self) -> engine.Motions:
        """Transfer functions of points, links, sliders and bodies, and contact geometry of cams and wheels."""
        return self._found(lambda: self.motion.machine.motions)

    @cached_property
    def link_forces(self) -> list[engine.LinkForce]:
        """All loads of each link."""
        return self._found(lambda: self.motion.machine.forces)

    @cached_property
    def pairs(self) -> dict[str, engine.Pair]:
        """Lower pairs by name."""
        return {pair.name: pair for pair in engine.pairs_of(self.scene)}

    @cached_property
    def forces(self) -> dict[str, np.ndarray]:
        """Pair reactions and input drive, by field."""
        fields = [f"{name}.reaction_{axis}" for name in self.pairs for axis in "xy"]
        fields += [f"{name}.reaction_moment" for name, pair in self.pairs.items() if pair.kind == "prismatic"]
        fields.append("input_moment_by_equilibrium")
        found = self.motion.machine.fields(fields)
        if not all(np.isfinite(row).any() for row in found.values()):
            raise PictureError(f"no plans of this machine: {self.motion.machine.verdict(fields).sentence}")
        return found

    def force(self, name: str) -> np.ndarray:
        """A reaction over the cycle, x + iy [N]: `PAIR.reaction`."""
        return self.forces[f"{name}_x"] + 1j * self.forces[f"{name}_y"]

    def peak_force(self, pair: str) -> float:
        """Peak reaction of a pair [N]: the summary, or the maximum drawn if the machine doesn't assemble everywhere."""
        force = np.abs(self.force(f"{pair}.reaction"))
        whole = np.isfinite(force).all()
        return self.motion.machine.summary(f"{pair}.reaction.peak") if whole else float(np.nanmax(force))

    def at(self, position: float | None = None) -> "Pose":
        """The machine at the node nearest to a crank angle [rad] or displacement [m].

        Parameters
        ----------
        position : float, optional
            Default: a suitable position.

        Raises
        ------
        PictureError
            The position is outside the input's range, or the mechanism can't be assembled there.
        """
        return Pose(self, self.motion.node(default_position(self.motion) if position is None else position))


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
    cycle : MachineCycle
    k : int
        Node index.
    """

    def __init__(self, cycle: MachineCycle, k: int) -> None:
        self.cycle, self.k = cycle, k
        self.scene, self.motion = cycle.scene, cycle.motion

    @property
    def title(self) -> str:
        """The position as text."""
        return position_text(self.scene, self.motion.q[self.k]).replace("-", "\N{MINUS SIGN}")

    def number(self, link: str) -> int:
        """Number of a link."""
        return self.cycle.link_numbers[link]

    def _movement(self, point: engine.MovingPoint) -> Movement:
        place, v, a = (complex(row[self.k]) for row in point)
        return Movement(place, v * self.cycle.omega, a * self.cycle.omega**2)

    def place(self, name: str) -> complex:
        """Position of a point of the scene [m]."""
        return complex(self.motion.points[name][self.k])

    def point(self, name: str) -> Movement:
        """Motion of a point of the scene."""
        return self._movement(self.cycle.rates.points[name])

    def turn(self, link: str) -> Turn:
        """Rotation of a link."""
        turning = self.cycle.rates.links[link]
        w, e = (float(row[self.k]) for row in (turning.w, turning.e))
        return Turn(w * self.cycle.omega, e * self.cycle.omega**2)

    def slide(self, link: str) -> tuple[float, float]:
        """Velocity [m/s] and acceleration [m/s²] of a slider along its guide or slot."""
        slide = self.cycle.rates.slides[link]
        return float(slide.v[self.k]) * self.cycle.omega, float(slide.a[self.k]) * self.cycle.omega**2

    def direction(self, link: str) -> complex:
        """Unit vector of a link's x axis."""
        return complex(self.motion.axes[link][1][self.k])

    def guide(self, name: str) -> complex:
        """Unit vector of a guide."""
        return complex(self.motion.guides[name][1][self.k])

    def origin(self, link: str) -> Movement:
        """Motion of the origin of a link's axes."""
        return self._movement(self.cycle.rates.links[link].origin)

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
            for force in self.cycle.link_forces
        ]

    def centre(self, body: str) -> Movement:
        """Motion of the centre of mass of a body."""
        return self._movement(self.cycle.rates.centres[body])
