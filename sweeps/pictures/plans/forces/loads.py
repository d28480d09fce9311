"""All forces on each link of a mechanism at a position, with inertia forces, in equilibrium.

The loads of a link are the reactions of its pairs, weights, inertia forces (d'Alembert), forces and moments of the
scene, gear forces, and the drive at the input.

The reaction of a journal with friction touches its friction circle. A guide with friction presses at the point given by
the moment on its slider, or at both edges if that lies outside the slider; friction acts along the guide.
"""

from collections.abc import Iterator
from typing import NamedTuple

from engine import FRAME, LinkForce, guide_edge_forces
from sweeps.pictures.plans.lettering import numbered, subscript, symbol
from sweeps.pictures.plans.pose import Pose

# Edges of a guide: direction from the slider's middle, and mark.
_EDGES = ((1, r"\prime"), (-1, r"\prime\prime"))


class DrawnLoad(NamedTuple):
    """A force at a point, or a moment.

    Attributes
    ----------
    text : str
        Symbol.
    force : complex
        x + iy [N]; 0 for a moment.
    at : complex
        Point of the force [m].
    moment : float
        [N·m], counter-clockwise.
    pair : str
        Name of the pair for reactions and friction, else "".
    middle : complex, optional
        Centre of the joint [m], for a reaction that touches a friction circle.
    """

    text: str
    force: complex
    at: complex
    moment: float = 0.0
    pair: str = ""
    middle: complex | None = None

    @property
    def is_friction(self) -> bool:
        """Whether it is guide friction."""
        return bool(self.pair) and self.text[1] == "F"

    @property
    def rho(self) -> float:
        """Radius of its friction circle [m]; 0 if none."""
        return 0.0 if self.middle is None else abs(self.at - self.middle)

    @property
    def is_moment(self) -> bool:
        """Whether it is a moment."""
        return self.force == 0


def loads_on_links(pose: Pose) -> dict[str, list[DrawnLoad]]:
    """Nonzero loads of each moving link by name.

    Parameters
    ----------
    pose : Pose
    """
    found: dict[str, list[DrawnLoad]] = {link: [] for link in pose.motion.link_numbers if link != FRAME}
    acting = [force for force in pose.acting if force.link in found]
    # Journal friction and guide moments shift the reaction.
    twists = {(force.name, force.link): force.moment for force in acting if _in_pair(force) and force.at is None}
    for force in acting:
        loads = found[force.link]
        if force.kind == "reaction" and force.force:
            loads += _pressing(pose, force, twists.pop((force.name, force.link), 0.0))
        elif force.force:
            loads.append(DrawnLoad(_text(pose, force), force.force, force.at, 0.0, force.name * _in_pair(force)))
        elif force.moment and not _in_pair(force):
            loads.append(DrawnLoad(_text(pose, force), 0j, 0j, force.moment))
    for force in acting:
        if moment := force.at is None and twists.get((force.name, force.link)):
            text = _text(pose, force._replace(kind="reaction"))
            found[force.link].append(DrawnLoad(text, 0j, 0j, moment, force.name))
    places = {name: i for i, name in enumerate(pose.motion.pairs)}
    for loads in found.values():
        loads.sort(key=lambda load: (places.get(load.pair, len(places)) if load.pair else -1, load.is_friction))
    return found


def _in_pair(force: LinkForce) -> bool:
    return force.kind in ("reaction", "friction")


def _pressing(pose: Pose, acting: LinkForce, moment: float) -> Iterator[DrawnLoad]:
    """A reaction shifted by its moment: to the friction circle, the bearing point of a slider, or its edges."""
    text, name, at, force = _text(pose, acting), acting.name, acting.at, acting.force
    pair = pose.motion.pairs.get(name)
    if pair is None or pair.kind == "revolute":
        moved = at - 1j * force * moment / abs(force) ** 2
        yield DrawnLoad(text, force, moved, 0.0, name, at if moment else None)
        return
    length, u = _length(pose, name), pose.direction(pair.link)
    normal = (force / (1j * u)).real
    if length is None:
        yield DrawnLoad(text, force, at, 0.0, name)
        if moment != 0:
            yield DrawnLoad(_text(pose, acting._replace(at=None)), 0j, 0j, moment, name)
    elif abs(moment) <= abs(normal) * length / 2:
        yield DrawnLoad(text, force, at + moment / normal * u, 0.0, name)
    else:
        edges = guide_edge_forces(normal, moment, length / 2)
        for edge, (side, prime) in zip(edges, _EDGES, strict=True):
            yield DrawnLoad(_text(pose, acting, prime), edge * 1j * u, at + side * length / 2 * u, 0.0, name)


def _length(pose: Pose, pair: str) -> float | None:
    """Length of the slider in a guide with friction [m]; None if not given."""
    name = next((n for n, friction in pose.scene.friction.items() if friction.pair == pair), None)
    return None if name is None else pose.motion.numbers.get(f"friction.{name}.length")


def _text(pose: Pose, acting: LinkForce, prime: str = "") -> str:
    """Symbol of a force or moment."""
    letter, scene, number = "M" if acting.at is None else "F", pose.scene, pose.number(acting.link)
    match acting.kind:
        case "weight" | "inertia":
            alone = sum(body.link == acting.link for body in scene.bodies.values()) <= 1
            index = str(number) if alone or acting.name in scene.shafts else subscript(acting.name)
            if acting.at is None:
                return symbol("M", f"U{index}")
            return symbol("G" if acting.kind == "weight" else "U", index)
        case "load":
            return symbol(letter, subscript(acting.name))
        case "drive":
            own = "" if acting.name == scene.input.link else str(pose.number(acting.name))
            return symbol(letter, rf"\mathrm{{in}}{own}")
        case "friction":
            return numbered("F", pose.number(acting.source), number, before=r"\mathrm{f}")
    return numbered("M" if acting.at is None else "R", pose.number(acting.source), number, power=prime)


def loaded_links(pose: Pose) -> list[str]:
    """Loaded links that are neither input nor in a group: second inputs, followers, wheels and racks.

    Parameters
    ----------
    pose : Pose
    """
    known = {pose.scene.input.link, *(link for links in pose.motion.groups.values() for link in links)}
    loads = loads_on_links(pose)
    return [link for link in loads if link not in known and any(not load.is_moment for load in loads[link])]


def group_loads(pose: Pose, name: str) -> list[DrawnLoad]:
    """Loads on a group as a whole (without its inner pairs), the reaction of its first pair last.

    Parameters
    ----------
    pose : Pose
    name : str
        Group name.
    """
    links, loads = pose.motion.groups[name], loads_on_links(pose)
    forces = [load for link in links for load in loads[link] if not load.is_moment]
    if name in pose.scene.groups:
        own, outer = {f"{name}.{side}" for side in ("first", "inner", "second")}, [f"{name}.second", f"{name}.first"]
    else:
        around = pose.motion.structure.free_groups[name].pairs
        own, outer = {p.name for p in around}, [p.name for p in around if not {p.link, p.other} <= set(links)]
    rest = [load for load in forces if load.pair not in own]
    return rest + [load for pair in outer for load in forces if load.pair == pair]
