"""One machine over its cycle, and its motion at one position: velocities and accelerations at uniform input speed."""

import math
from collections.abc import Mapping
from functools import cached_property
from typing import NamedTuple

import numpy as np

from engine import (
    FRAME,
    CrankInput,
    Machine,
    Scene,
    Verdict,
    Yoke,
    acting_fields,
    centre_along,
    driving_field,
    friction_in_pairs,
    group_links,
    guide_of,
    has_cycle,
    order_groups,
    pairs_of,
    tooth_force_fields,
)
from sweeps.pictures.drawing import DrawnMotion
from sweeps.pictures.drawing.figures import default_position
from sweeps.pictures.drawing.motion import POSITIONS
from sweeps.pictures.picture_error import PictureError


class MachineCycle:
    """One machine over its cycle: where it is, how it moves, what acts in it.

    Parameters
    ----------
    scene : Scene
    values : mapping of path to float, optional
        Numbers (SI) in place of the scene's.

    Attributes
    ----------
    motion : DrawnMotion
    numbers : Numbers
    link_numbers : dict of str to int
        Links as plans number them: the frame 0, the input 1, those of the groups, second inputs, followers, wheels.

    Raises
    ------
    PictureError
        The mechanism can't be assembled at any position.
    """

    def __init__(self, scene: Scene, values: Mapping[str, float] | None = None) -> None:
        if scene.input is None:
            raise PictureError("the scene has machine elements alone: there is no mechanism to draw")
        self.scene, self._values = scene, dict(values or {})
        self.motion = DrawnMotion(scene, values)
        self.numbers = self.motion.numbers
        self.structure = order_groups(scene)
        in_groups = [link for links in self.groups.values() for link in links]
        links = [FRAME, scene.input.link, *in_groups, *scene.inputs]
        links += [cam.follower.link for cam in scene.cams.values()]
        links += [*scene.shafts, *scene.noncircular_wheels, *scene.racks, *scene.pinions]
        self.link_numbers = {link: i for i, link in enumerate(links)}
        self.omega = float(self.numbers["input.speed"])

    @cached_property
    def groups(self) -> dict[str, tuple[str, ...]]:
        """Links of each group, in the order in which groups follow each other."""
        free = self.structure.free_groups
        return {
            e.name: free[e.name].links if e.name in free else group_links(self.scene, e.name)
            for e in self.structure.elements
            if e.kind in ("group", "free group")
        }

    @property
    def is_closed(self) -> bool:
        """Whether the first position follows the last."""
        return has_cycle(self.scene)

    def _rows(self, fields: list[str]) -> dict[str, np.ndarray]:
        machine = Machine(self.scene, fields=fields, varied=self._values, positions=POSITIONS)
        outcome = machine.evaluate({path: np.array([value]) for path, value in self._values.items()})
        rows = {name: row[0].astype(float) for name, row in outcome.fields.items()}
        if not all(np.isfinite(row).any() for row in rows.values()):
            raise PictureError(f"no plans of this machine: {Verdict(int(outcome.status[0])).sentence}")
        return rows

    @cached_property
    def rates(self) -> dict[str, np.ndarray]:
        """Transfer functions of points, links and sliders, and shapes of cams and wheels where they touch."""
        known = Machine(self.scene).available_fields
        fields = [name for name in known if name.endswith(("_phi", "_phiphi")) and "inertia" not in name]
        for name in self.scene.cams:
            fields += [f"{name}.{field}" for field in ("normal_x", "normal_y", "curvature")]
        for name in self.scene.noncircular_wheels:
            shape = ("pitch_x", "pitch_y", "tangent_x", "tangent_y", "curvature", "driver_curvature")
            fields += [f"{name}.{field}" for field in shape]
        return self._rows(fields)

    @cached_property
    def forces(self) -> dict[str, np.ndarray]:
        """Reactions, forces between teeth and on cams, inertia and acting forces, what drives, by their fields."""
        fields = [f"{pair.name}.reaction_{axis}" for pair in pairs_of(self.scene) for axis in "xy"]
        fields += [f"{pair.name}.reaction_moment" for pair in pairs_of(self.scene) if pair.kind == "prismatic"]
        parts = ("inertia_force_x", "inertia_force_y", "inertia_moment")
        fields += [f"{body}.{part}" for body in self.scene.bodies for part in parts]
        fields += [quantity.name for quantity in acting_fields(self.scene)]
        fields += [quantity.name for quantity in tooth_force_fields(self.scene)]
        fields += [f"{name}.contact_force" for name in self.scene.cams]
        fields += [driving_field(self.scene, name) for name in self.scene.inputs]
        fields += friction_in_pairs(self.scene).values()
        return self._rows([*fields, "input_moment_by_equilibrium"])

    def force(self, name: str) -> np.ndarray:
        """A force over the cycle, x + iy [N]: `PAIR.reaction`, `BODY.inertia_force` or `ACTION.force`."""
        return self.forces[f"{name}_x"] + 1j * self.forces[f"{name}_y"]

    def at(self, position: float | None = None) -> "Pose":
        """The machine at the node nearest to a crank angle [rad] or displacement [m].

        Parameters
        ----------
        position : float, optional
            Where a drawing shows the machine well unless given.

        Raises
        ------
        PictureError
            The place is outside the range of the input, or the mechanism can't be assembled there.
        """
        return Pose(self, self.motion.node(default_position(self.motion) if position is None else position))


class Movement(NamedTuple):
    """A place that moves with a link: where it is [m], its velocity [m/s] and acceleration [m/s²], as x + iy."""

    place: complex
    v: complex
    a: complex


class Turn(NamedTuple):
    """Angular velocity [rad/s] and acceleration [rad/s²] of a link."""

    omega: float
    epsilon: float


class Pose:
    """A machine at one position, its input at uniform speed.

    Parameters
    ----------
    cycle : MachineCycle
    k : int
        Number of the node.

    Attributes
    ----------
    lettered : dict
        Where the names stand in the mechanism's drawing, by the size of its paper: it is on every sheet of forces.
    """

    def __init__(self, cycle: MachineCycle, k: int) -> None:
        self.cycle, self.k = cycle, k
        self.lettered: dict[complex, list[complex]] = {}
        self.scene, self.motion = cycle.scene, cycle.motion

    @property
    def title(self) -> str:
        """The position in words."""
        q = self.motion.q[self.k]
        if isinstance(self.scene.input, CrankInput):
            return f"φ = {math.degrees(q):.4g}°".replace("-", "\N{MINUS SIGN}")
        return f"q = {1e3 * q:.4g} mm".replace("-", "\N{MINUS SIGN}")

    def number(self, link: str) -> int:
        """Number of a link."""
        return self.cycle.link_numbers[link]

    def value(self, field: str) -> float:
        """A number of a contact at this position, by its field."""
        return float(self.cycle.rates[field][self.k])

    def vector(self, stem: str) -> complex:
        """A place or direction of a contact at this position, x + iy."""
        return complex(self.value(f"{stem}_x"), self.value(f"{stem}_y"))

    def _rate(self, stem: str) -> tuple[float, float]:
        """First and second derivative by time of a kinematic field at uniform input speed."""
        rows, omega = self.cycle.rates, self.cycle.omega
        return float(rows[f"{stem}_phi"][self.k]) * omega, float(rows[f"{stem}_phiphi"][self.k]) * omega**2

    def point(self, name: str) -> Movement:
        """Movement of a point of the scene."""
        place = complex(self.motion.points[name][self.k])
        if name in self.scene.points and self.scene.points[name].link == FRAME:
            return Movement(place, 0j, 0j)
        (vx, ax), (vy, ay) = self._rate(f"{name}.x"), self._rate(f"{name}.y")
        return Movement(place, complex(vx, vy), complex(ax, ay))

    def turn(self, link: str) -> Turn:
        """How a link turns."""
        if link == FRAME:
            return Turn(0.0, 0.0)
        if link in self.scene.shafts and self.scene.shafts[link].pivot is None:
            shaft, ratio = self.scene.shafts[link], self.cycle.numbers[f"shafts.{link}.ratio"]
            driver, carrier = self.turn(shaft.geared_to), self.turn(shaft.carrier or FRAME)
            return Turn(*(c + ratio * (d - c) for c, d in zip(carrier, driver, strict=True)))
        return Turn(*self._rate(f"{link}.angle"))

    def slide(self, link: str) -> tuple[float, float]:
        """Velocity [m/s] and acceleration [m/s²] of a slider along its guide or slot."""
        return self._rate(f"{link}.slide")

    def direction(self, link: str) -> complex:
        """Unit vector of a link's x axis."""
        return complex(self.motion.axes(link)[1][self.k])

    def guide(self, name: str) -> complex:
        """Unit vector of a guide."""
        return complex(self.motion.guide(name)[1][self.k])

    def origin(self, link: str) -> Movement:
        """Movement of the origin of a link's axes."""
        if link == FRAME or (link in self.scene.shafts and self.scene.shafts[link].pivot is None):
            return Movement(0j, 0j, 0j)
        guide = guide_of(self.scene, link)
        if guide is not None and self._is_where_it_slides(link):
            return self.slid(link, guide, complex(self.motion.axes(link)[0][self.k]))
        point = self.point(self.motion.members(link)[0])
        # The axes of a free link may begin where it has no joint.
        return self._beside(link, point, complex(self.motion.axes(link)[0][self.k]))

    def _is_where_it_slides(self, link: str) -> bool:
        """Whether the origin of a slider's axes goes by its guide, where no joint need be."""
        yokes = (group.second for group in self.scene.groups.values() if isinstance(group.second, Yoke))
        followers = (cam.follower for cam in self.scene.cams.values())
        known = {*self.scene.inputs, *self.scene.racks, *self.scene.links}
        return link in known or any(part.link == link for part in (*yokes, *followers))

    def slid(self, slider: str, guide: str, place: complex) -> Movement:
        """Movement of the place of a slider that is at `place` [m] at the moment, by its motion along its guide."""
        carrier, u = self.scene.guides[guide].link, self.guide(guide)
        under = self.rigid(carrier, place)
        v, a = self.slide(slider)
        return Movement(place, under.v + v * u, under.a + 2j * self.turn(carrier).omega * v * u + a * u)

    def rigid(self, link: str, place: complex) -> Movement:
        """Movement of the place of a link that is at `place` [m] at the moment."""
        return self._beside(link, self.origin(link), place)

    def _beside(self, link: str, o: Movement, place: complex) -> Movement:
        """Movement of a place of a link from that of another."""
        turn, arm = self.turn(link), place - o.place
        v = o.v + 1j * turn.omega * arm
        return Movement(place, v, o.a + 1j * turn.epsilon * arm - turn.omega**2 * arm)

    def centre(self, body: str) -> Movement:
        """Movement of the centre of mass of a body."""
        numbers, link = self.cycle.numbers, self.scene.bodies[body].link
        if link in self.scene.shafts and self.scene.shafts[link].pivot is None:
            return Movement(0j, 0j, 0j)
        arm = centre_along(self.scene, body, numbers) + 1j * numbers[f"bodies.{body}.y"]
        origin, u = (complex(values[self.k]) for values in self.motion.axes(link))
        return self.rigid(link, origin + arm * u)
