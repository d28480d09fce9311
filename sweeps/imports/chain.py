"""A linkage as other programs store it (links and joints in one position), and its scene."""

import cmath
import itertools
import re
from collections.abc import Iterable
from typing import Any, NamedTuple

from engine import Scene, SceneError

# Valid scene names.
_UNALLOWED = re.compile("[^A-Za-z0-9]+")


class LinkageError(ValueError):
    """Another program's linkage that is damaged, or that no scene can describe; the message says why."""


class GuidedOnFrame(NamedTuple):
    """A straight guide on the frame: a point on it, x + iy [m], and its direction [rad]."""

    point: complex
    angle: float


class Chain(NamedTuple):
    """A linkage in one position.

    Attributes
    ----------
    title : str
    joints : dict of str to complex
        Positions of joints and points, x + iy [m].
    links : dict of str to list of str
        Joints and points of each moving link.
    frame : list of str
        Joints and points of the frame.
    slides : dict of str to GuidedOnFrame
        Links that slide on a guide of the frame.
    crank : str
        Input link.
    pivot : str
        Its joint on the frame.
    speed : str
        Crank speed with unit.
    """

    title: str
    joints: dict[str, complex]
    links: dict[str, list[str]]
    frame: list[str]
    slides: dict[str, GuidedOnFrame]
    crank: str
    pivot: str
    speed: str


class SceneOfChain:
    """Scene of a linkage: its links become dyads, in order from frame and crank."""

    def __init__(self, chain: Chain) -> None:
        self.chain = chain
        self.taken = {"frame", "crank", "input"}
        self.names = {name: _allowed(name, "P", self.taken) for name in chain.joints}
        self.links = {name: _allowed(name, "link", self.taken) for name in chain.links}
        self.data: dict[str, Any] = {"title": chain.title, "points": {}, "guides": {}, "groups": {}}
        self.known: set[str] = set()

    def scene(self) -> Scene:
        """The scene.

        Raises
        ------
        LinkageError
            The links can't be ordered into dyads (RRR or RRP), or the scene is invalid.
        """
        chain = self.chain
        on_frame = {*chain.frame, chain.pivot}
        for name in chain.joints:
            if name in on_frame:
                self._point(name, "", 0j, 1.0 + 0j)
        self.known |= on_frame
        pin = self._pin()
        to_pin = chain.joints[pin] - chain.joints[chain.pivot]
        self.data["input"] = {
            "type": "crank",
            "link": self.links[chain.crank],
            "pivot": self.names[chain.pivot],
            "pin": self.names[pin],
            "length": abs(to_pin),
            "speed": chain.speed,
        }
        self._settle(chain.crank, chain.joints[chain.pivot], to_pin, (chain.pivot, pin))
        left = {name: members for name, members in chain.links.items() if name != chain.crank}
        while left:
            found = next(self._dyads(left), None)
            if found is None:
                raise LinkageError(
                    f"the links {', '.join(left)} can't be split into dyads; describe them under [links] of a scene "
                    "(`sweeps guide links`)"
                )
            self._add(*found, left)
        self.data = {key: value for key, value in self.data.items() if value not in ({}, "")}
        try:
            return Scene.model_validate(self.data)
        except SceneError as error:
            raise LinkageError(": ".join(error.problems[0])) from None

    def _pin(self) -> str:
        """Crank joint that drives other links."""
        chain = self.chain
        others = [j for name, members in chain.links.items() if name != chain.crank for j in members]
        pins = [j for j in chain.links[chain.crank] if j in others and j != chain.pivot]
        if not pins:
            raise LinkageError(f"the crank {chain.crank} moves no other link")
        return pins[0]

    def _dyads(self, left: dict[str, list[str]]) -> Iterable[tuple[str, str, str]]:
        """Inner joint, hinged link and other link of every dyad that can be added next."""
        for inner in self.chain.joints:
            if inner in self.known:
                continue
            ready = [name for name, members in left.items() if inner in members and self._outer(name) is not None]
            sliders = [name for name in left if name in self.chain.slides and inner in left[name]]
            hinged = [name for name in ready if name not in self.chain.slides]
            pair = [*hinged[:1], *sliders[:1]] if sliders else hinged[:2]
            if len(pair) == 2:
                yield inner, pair[0], pair[1]

    def _outer(self, link: str) -> str | None:
        return next((name for name in self.chain.links[link] if name in self.known), None)

    def _add(self, inner: str, first: str, second: str, left: dict[str, list[str]]) -> None:
        chain, joints = self.chain, self.chain.joints
        outer, far = self._outer(first), self._outer(second)
        a, b = joints[outer], joints[inner]
        group = {
            "inner": self.names[inner],
            "first": {"link": self.links[first], "joint": self.names[outer], "length": abs(b - a)},
        }
        self._settle(first, a, b - a, (outer, inner))
        if second in chain.slides:
            slide = chain.slides[second]
            along = cmath.exp(1j * slide.angle)
            guide = _allowed(f"guide_{second}", "guide", self.taken)
            self.data["guides"][guide] = {"x": slide.point.real, "y": slide.point.imag, "angle": slide.angle}
            offset = ((b - slide.point) / along).imag
            # Most guides pass through the joint: rounding isn't an offset.
            offset = 0.0 if abs(offset) <= 1e-9 * max(abs(b - a), abs(b - slide.point)) else offset
            group |= {"type": "RRP", "second": {"link": self.links[second], "guide": guide, "offset": offset}}
            group["mode"] = 1 if ((b - a) / along).real > 0 else -1
            self._settle(second, b, along, (inner,))
        else:
            d = joints[far]
            group |= {
                "type": "RRR",
                "second": {"link": self.links[second], "joint": self.names[far], "length": abs(b - d)},
                "mode": 1 if ((b - a) * (d - a).conjugate()).imag > 0 else -1,
            }
            self._settle(second, d, b - d, (far, inner))
        self.data["groups"][_allowed(f"dyad_{inner}", "dyad", self.taken)] = group
        for link in (first, second):
            del left[link]

    def _settle(self, link: str, origin: complex, along: complex, own: tuple[str, ...]) -> None:
        """Mark the joints of a newly placed link as known; those that define its axes keep their names."""
        for name in self.chain.links[link]:
            if name in self.known and name not in own:
                raise LinkageError(f"the link {link} is fixed at {own[0]} and at {name}: it can't move")
            if name not in own:
                self._point(name, link, origin, along / abs(along))
        self.known |= {*self.chain.links[link], *own}

    def _point(self, name: str, link: str, origin: complex, axis: complex) -> None:
        at = (self.chain.joints[name] - origin) / axis
        of = {"link": self.links[link]} if link else {}
        self.data["points"][self.names[name]] = of | {"x": at.real, "y": at.imag}


def _allowed(name: str, kind: str, taken: set[str]) -> str:
    """A unique valid scene name close to the given one."""
    plain = _UNALLOWED.sub("_", name).strip("_") or kind
    plain = plain if plain[0].isalpha() else f"{kind}_{plain}"
    numbered = (f"{plain}_{number}" for number in itertools.count(2))
    chosen = next(name for name in itertools.chain((plain,), numbered) if name not in taken)
    taken.add(chosen)
    return chosen
