"""A mechanism over its cycle: positions of its parts, motion and forces, as complex numbers x + iy."""

import math
from collections.abc import Iterable
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

import engine
from sweeps.pictures.picture_error import PictureError, need_mechanism

POSITIONS = 720
# Hinge radius of a drawing without extent: a wheel on its bearing [m].
ALONE = 0.01


class Slider(NamedTuple):
    """A link that slides on a guide; its joint, if any, is offset to the guide's left."""

    link: str
    joint: str | None
    guide: str
    offset: float


def position_text(scene: engine.Scene, at: float) -> str:
    """Position of the input, such as "φ = 60°".

    Parameters
    ----------
    scene : Scene
    at : float
        Crank angle [rad], or displacement of a sliding input [m].
    """
    units = engine.InputUnits.of(scene)
    return f"{units.symbols[0]} = {engine.quantity_text(float(at), units.q)}".replace(" °", "°")


class DrawnMotion:
    """A scene's mechanism at every node of the cycle.

    Parameters
    ----------
    scene : Scene
    known : Mechanics, optional
        As for `MovingMachine`.

    Attributes
    ----------
    machine : MovingMachine
    q : ndarray (nodes,)
        Crank angles [rad] or displacements of a sliding input [m].
    points : dict of str to complex ndarray (nodes,)
    slides : dict of str to ndarray (nodes,)
    axes, guides : dict of str to (complex ndarray, complex ndarray)
        Origin and direction of each link's axes, a point and the direction of each guide; (nodes,).
    assembled : ndarray (nodes,) of bool
    contacts : dict of str to complex ndarray (nodes,)
        Contact points of cams and followers.
    centres : dict of str to complex ndarray (nodes,)
        Of the masses of bodies.
    profiles : dict of str to complex ndarray (points,)
        Cam profiles in the axes of their links; closed if the cam turns fully.
    pitch_curves : dict of str to (complex ndarray, complex ndarray)
        Pitch curves of non-circular wheels and their drivers, each in the axes of its link.
    radius : float
        Radius of a hinge, which scales all symbols [m].

    Raises
    ------
    PictureError
        There is no mechanism, it can't be assembled at any position, or what is asked is undefined at all.
    """

    def __init__(self, scene: engine.Scene, known: engine.Mechanics | None = None) -> None:
        need_mechanism(scene)
        self.scene = scene
        self.machine = engine.MovingMachine(scene, positions=POSITIONS, known=known)
        self.numbers, self.q = self.machine.numbers, self.machine.q
        self.omega = float(self.numbers["input.speed"])
        places = self._of_machine("places")
        self.points, self.slides, self.contacts = places.points, places.slides, places.contacts
        self.axes, self.guides, self.centres = places.links, places.guides, places.centres
        self.structure = engine.order_groups(scene)
        self.links = (*self.structure.links, engine.FRAME)
        self.profiles = {name: self._profile(name) for name in scene.cams}
        self.pitch_curves = {
            name: tuple((point - self.axes[link][0]) / self.axes[link][1] for link in (name, wheel.geared_to))
            for (name, wheel), point in zip(scene.noncircular_wheels.items(), places.pitch_points.values(), strict=True)
        }
        self.assembled = np.all([np.isfinite(point) for point in self.points.values()], axis=0)
        self.sliders = tuple(self._sliders())
        self.radius = self._radius()

    @classmethod
    def of(cls, drawn: "engine.Scene | DrawnMotion") -> "DrawnMotion":
        """The motion of a scene, or the given motion."""
        return drawn if isinstance(drawn, DrawnMotion) else cls(drawn)

    def _of_machine(self, what: str) -> Any:
        """Positions, motions or forces of the machine."""
        try:
            return getattr(self.machine, what)
        except engine.NowhereDefinedError as error:
            words = "positions" if what == "places" else what
            raise PictureError(f"the {words} of this mechanism are undefined at every position: {error}") from None

    def node(self, at: float) -> int:
        """Number of the node nearest to a crank angle [rad] or displacement [m].

        Raises
        ------
        PictureError
            The position is outside the input's range, or the mechanism can't be assembled there.
        """
        step, unit = self.q[1] - self.q[0], engine.InputUnits.of(self.scene).q
        k = round((at - self.q[0]) / step)
        if self.scene.has_cycle:
            k %= self.q.size
        elif not 0 <= k < self.q.size:
            given, *ends = (engine.quantity_text(float(q), unit) for q in (at, self.q[0], self.q[-1]))
            raise PictureError(f"position {given} is outside the input's range {' to '.join(ends)}")
        if not self.assembled[k]:
            sentence = engine.Verdict.CANNOT_ASSEMBLE.sentence
            raise PictureError(
                f"position {engine.quantity_text(at, unit)} can't be drawn: {sentence}; or choose another position"
            )
        return k

    def _profile(self, name: str) -> np.ndarray:
        """Profile of a cam over a turn, or as far as it turns."""
        place, along = self.axes[self.scene.cams[name].on]
        profile = (self.contacts[name] - place) / along
        turns = abs(np.unwrap(np.angle(along))[-1] - np.angle(along[0])) / math.tau
        if not self.scene.has_cycle and turns < 1.0:
            return profile
        count = round(profile.size / max(1.0, round(turns)))
        return np.append(profile[:count], profile[:1])

    def _sliders(self) -> Iterable[Slider]:
        drive = self.scene.input
        if not isinstance(drive, engine.CrankInput):
            yield Slider(drive.link, drive.point, drive.guide, 0.0)
        for name, group in self.scene.groups.items():
            for side in ("first", "second"):
                part = getattr(group, side)
                if isinstance(part, engine.Sliding):
                    offset = self.numbers[f"groups.{name}.{side}.offset"]
                    yield Slider(part.link, group.inner, part.guide, offset)
        for name, link in self.scene.links.items():
            if link.guide is not None:
                yield Slider(name, next(iter(link.joints), None), link.guide, self.numbers[f"links.{name}.offset"])
        for name, second in self.scene.inputs.items():
            if isinstance(second, engine.SecondSlider):
                yield Slider(name, None, second.guide, 0.0)

    def _radius(self) -> float:
        """Hinge radius: a share of the overall size, smaller for short links."""
        cloud = np.concatenate([*self.points.values(), *self._stems(), *self.contacts.values()])
        cloud = cloud[np.isfinite(cloud)]
        whole = abs(np.ptp(cloud.real) + 1j * np.ptp(cloud.imag))
        lengths = [v for path, v in self.numbers.items() if path.endswith(".length") and path[:6] != "bodies"]
        if whole == 0.0:
            return ALONE
        return min(whole / 85, max(0.14 * min(lengths, default=math.inf), whole / 170))

    def _stems(self) -> Iterable[np.ndarray]:
        """Length of yoke stems."""
        for group in self.scene.groups.values():
            if group.type == "RPP":
                place, along = self.guides[group.second.guide]
                low, high = self.range_of(group.second.link)
                yield place + (2 * high - low) * along

    def range_of(self, link: str) -> tuple[float, float]:
        """Range of a slider's coordinate over the cycle [m]."""
        return float(np.nanmin(self.slides[link])), float(np.nanmax(self.slides[link]))

    def members(self, link: str) -> list[str]:
        """Names of a link's points, the origin of its axes first if it is a point."""
        return list(engine.places_on(self.scene, link))

    @property
    def hinges(self) -> set[str]:
        """Points that are revolute pairs."""
        return {pair.joint for pair in self.pairs.values() if pair.kind == "revolute"}

    @cached_property
    def groups(self) -> dict[str, tuple[str, ...]]:
        """Links of each group, in group order."""
        free = self.structure.free_groups
        return {
            e.name: free[e.name].links if e.name in free else engine.group_links(self.scene, e.name)
            for e in self.structure.elements
            if e.kind in ("group", "free group")
        }

    @cached_property
    def link_numbers(self) -> dict[str, int]:
        """Link numbers in plans: frame 0, input 1, then groups, second inputs, followers, wheels."""
        scene = self.scene
        in_groups = [link for links in self.groups.values() for link in links]
        links = [engine.FRAME, scene.input.link, *in_groups, *scene.inputs]
        links += [cam.follower.link for cam in scene.cams.values()]
        links += [*scene.shafts, *scene.noncircular_wheels, *scene.racks, *scene.pinions]
        return {link: i for i, link in enumerate(links)}

    @cached_property
    def rates(self) -> engine.Motions:
        """Transfer functions of points, links, sliders and bodies, and contact geometry of cams and wheels."""
        return self._of_machine("motions")

    @cached_property
    def link_forces(self) -> list[engine.LinkForce]:
        """All loads of each link."""
        return self._of_machine("forces")

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
        found = self.machine.fields(fields)
        if not all(np.isfinite(row).any() for row in found.values()):
            raise PictureError(f"no plans of this machine: {self.machine.verdict(fields).sentence}")
        return found

    def force(self, name: str) -> np.ndarray:
        """A reaction over the cycle, x + iy [N]: `PAIR.reaction`."""
        return self.forces[f"{name}_x"] + 1j * self.forces[f"{name}_y"]

    def peak_force(self, pair: str) -> float:
        """Peak reaction of a pair [N]: the summary, or the maximum drawn if the machine doesn't assemble everywhere."""
        force = np.abs(self.force(f"{pair}.reaction"))
        whole = np.isfinite(force).all()
        return self.machine.summary(f"{pair}.reaction.peak") if whole else float(np.nanmax(force))
