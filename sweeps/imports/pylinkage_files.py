"""Linkages saved by pylinkage as JSON: joints with their parents, or joints and links."""

import cmath
import math
from collections.abc import Mapping
from typing import Any

from sweeps.imports.chain import Chain, GuidedOnFrame, LinkageError

_KINDS = ("Static", "Crank", "Revolute", "Pivot", "Fixed", "Prismatic", "Linear")


def pylinkage_chain(data: Mapping[str, Any], unit: float, speed: str) -> Chain:
    """Linkage of a file of pylinkage.

    As in pylinkage, lengths and angles count; coordinates only select the assembly mode.

    Parameters
    ----------
    data : mapping
        The file, parsed.
    unit : float
        Length unit [m].
    speed : str
        Crank speed with unit; the file only gives angle steps.

    Raises
    ------
    LinkageError
        The file isn't pylinkage's, or its linkage can't be converted to a scene.
    """
    try:
        reader = _Links(unit) if "links" in data else _Joints(unit)
        return reader.chain(data, speed)
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        if isinstance(error, LinkageError):
            raise
        words = f"is incomplete: {type(error).__name__} {error}"
        raise LinkageError(f"looks like a linkage of pylinkage, but {words}") from None


class _Joints:
    """A list of joints, each defined by distances to others."""

    def __init__(self, unit: float) -> None:
        self.unit = unit
        self.places: dict[str, complex] = {}
        self.links: dict[str, list[str]] = {}
        self.slides: dict[str, GuidedOnFrame] = {}
        self.frame: list[str] = []
        self.cranks: list[tuple[str, str, float]] = []

    def chain(self, data: Mapping[str, Any], speed: str) -> Chain:
        left = {joint["name"]: joint for joint in data["joints"]}
        while left:
            ready = [name for name, joint in left.items() if all(p in self.places for p in self._parents(joint))]
            if not ready:
                raise LinkageError(f"the joints {', '.join(left)} refer to each other in a circle, or one is missing")
            for name in ready:
                self._add(name, left.pop(name))
        if len(self.cranks) != 1:
            raise LinkageError(f"it has {len(self.cranks)} cranks; a scene has one input")
        crank, pivot, step = self.cranks[0]
        turned = f"-{speed}" if step < 0 and not speed.startswith("-") else speed
        title = str(data.get("name") or "Linkage")
        return Chain(title, self.places, self.links, self.frame, self.slides, crank, pivot, turned)

    def _parents(self, joint: Mapping[str, Any]) -> list[str]:
        """Parents of a joint; fixed ones become frame joints."""
        found = []
        for key in ("joint0", "joint1", "joint2"):
            parent = joint.get(key)
            if parent is None:
                continue
            if parent.get("inline"):
                name = str(parent.get("name") or f"{joint['name']}_{key}")
                if name not in self.places:
                    self._fix(name, self._at(parent))
                found.append(name)
            else:
                found.append(parent["ref"])
        return found

    def _at(self, joint: Mapping[str, Any]) -> complex:
        return self.unit * complex(float(joint["x"] or 0.0), float(joint["y"] or 0.0))

    def _fix(self, name: str, place: complex) -> None:
        self.places[name] = place
        self.frame.append(name)

    def _add(self, name: str, joint: Mapping[str, Any]) -> None:
        kind, parents = joint["type"], self._parents(joint)
        if kind not in _KINDS:
            raise LinkageError(f"joint {name}: {kind!r} is not one of {', '.join(_KINDS)}")
        if kind == "Static":
            self._fix(name, self._at(joint))
            return
        if len(parents) != {"Crank": 1, "Prismatic": 3, "Linear": 3}.get(kind, 2):
            raise LinkageError(f"joint {name} has {len(parents)} parents, too few or too many for {kind}")
        if kind == "Crank":
            angle = cmath.phase(self._at(joint) - self.places[parents[0]])
            self.places[name] = self.places[parents[0]] + cmath.rect(self._length(joint, "distance"), angle)
            self.cranks.append((self._link(name, parents[0]), parents[0], float(joint.get("angle") or 0.0)))
        elif kind == "Fixed":
            self._fix_to(name, parents, self._length(joint, "distance"), float(joint["angle"]))
        elif kind in ("Revolute", "Pivot"):
            radii = [self._length(joint, key) for key in ("distance0", "distance1")]
            self.places[name] = self._meeting(name, *(self.places[p] for p in parents), *radii, self._at(joint))
            if self._common(parents) is not None:
                self._onto(name, parents)
            else:
                for parent in parents:
                    self._link(name, parent)
        else:
            self._slider(name, joint, parents)

    def _slider(self, name: str, joint: Mapping[str, Any], parents: list[str]) -> None:
        hinge, *line = parents
        if any(p not in self.frame for p in line):
            raise LinkageError(f"joint {name} slides along a moving line; only guides on the frame are supported")
        origin, along = self.places[line[0]], self.places[line[1]] - self.places[line[0]]
        along /= abs(along)
        foot = (self.places[hinge] - origin) / along
        radius = self._length(joint, "revolute_radius")
        if abs(foot.imag) > radius:
            raise LinkageError(f"joint {name} doesn't reach its guide")
        reach = math.sqrt(radius * radius - foot.imag * foot.imag)
        ways = [origin + (foot.real + sign * reach) * along for sign in (1, -1)]
        self.places[name] = min(ways, key=lambda way: abs(way - self._at(joint)))
        self._link(name, hinge)
        slider = f"slider_{name}"
        self.links[slider] = [name]
        self.slides[slider] = GuidedOnFrame(origin, cmath.phase(along))

    def _length(self, joint: Mapping[str, Any], key: str) -> float:
        length = self.unit * float(joint[key])
        if not 0.0 < length < math.inf:
            raise LinkageError(f"joint {joint['name']}: {key} = {joint[key]!r} is not a length")
        return length

    def _meeting(self, name: str, a: complex, b: complex, r1: float, r2: float, near: complex) -> complex:
        """Intersection of two circles nearest to a point."""
        apart = abs(b - a)
        if not abs(r1 - r2) <= apart <= r1 + r2 or apart == 0.0:
            raise LinkageError(f"joint {name} can't be assembled: its distances don't meet")
        before = (apart * apart + r1 * r1 - r2 * r2) / (2 * apart)
        height = math.sqrt(max(0.0, r1 * r1 - before * before))
        ways = [a + (b - a) / apart * complex(before, sign * height) for sign in (1, -1)]
        return min(ways, key=lambda way: abs(way - near))

    def _link(self, name: str, parent: str) -> str:
        link = f"{parent}_{name}"
        self.links[link] = [parent, name]
        return link

    def _common(self, parents: list[str]) -> list[str] | None:
        """The link that two joints are on, or the frame."""
        bearers = [self.frame, *self.links.values()]
        return next((members for members in bearers if all(p in members for p in parents)), None)

    def _fix_to(self, name: str, parents: list[str], distance: float, angle: float) -> None:
        """Place a joint on the link of two others, by polar coordinates from the first one."""
        first, second = (self.places[p] for p in parents)
        self.places[name] = first + cmath.rect(distance, cmath.phase(second - first) + angle)
        self._onto(name, parents)

    def _onto(self, name: str, parents: list[str]) -> None:
        members = self._common(parents)
        if members is None:
            raise LinkageError(f"joint {name} is fixed to {' and '.join(parents)}, which don't share a link")
        members.append(name)


class _Links(_Joints):
    """Lists of joints, in one position, and of links between them."""

    def chain(self, data: Mapping[str, Any], speed: str) -> Chain:
        followed = []
        for joint in data["joints"]:
            name, kind = joint["id"], joint.get("type", "revolute")
            if kind == "tracker":
                followed.append(joint)
                continue
            if kind not in ("ground", "revolute"):
                raise LinkageError(f"joint {name}: {kind!r} is not supported; supported: ground, revolute, tracker")
            x, y = joint["position"]
            self.places[name] = self.unit * complex(float(x), float(y))
            if kind == "ground":
                self.frame.append(name)
        for link in data["links"]:
            kind, members = link.get("type", "link"), [name for name in link["joints"] if name in self.places]
            if kind == "ground":
                self.frame += [name for name in members if name not in self.frame]
                continue
            self.links[link["id"]] = members
            if kind in ("driver", "arc_driver"):
                pivot = link.get("motor_joint") or next(name for name in members if name in self.frame)
                self.cranks.append((link["id"], pivot, float(link.get("angular_velocity", 1.0))))
        for joint in followed:
            refs = [joint["ref_joint1_id"], joint["ref_joint2_id"]]
            self._fix_to(joint["id"], refs, self.unit * float(joint["distance"]), float(joint["angle"]))
        return super().chain({"name": data.get("name"), "joints": []}, speed)
