"""Rules for links and wheels: transmission angles, slender rods, missing masses, undercut teeth."""

import math
from collections.abc import Iterator

import numpy as np

from engine.cycle.measured import Measured
from engine.elements.gears.tooth_laws import transverse_angle
from engine.laws.rounding import LEAST_NORMAL
from engine.parts.motors import Motor
from engine.parts.skeleton import FRAME
from engine.scene.masses import body_mass
from engine.scene.pairs import holder_of, rods_of
from engine.scene.scene import Numbers, Scene
from engine.warnings.rule import Rule, limit_of


def transmission_rules(scene: Scene) -> Iterator[Rule]:
    """Transmission angles of dyads of two bars, or of a bar and a slider."""

    def judge(n: Numbers, angle: Measured) -> tuple[object, object]:
        return angle, limit_of(scene, "transmission_angle", n)

    sentence = (
        "its transmission angle falls to {value}, below limits.transmission_angle = {limit} (40° is usual, 30° "
        "suffices for slow machines): forces grow, and little friction makes it jam; change its lengths or "
        "move its joints"
    )
    for name, group in scene.groups.items():
        if group.type in ("RRR", "RRP"):
            yield Rule(f"groups.{name}", "below", "rad", sentence, judge, (f"{name}.transmission_angle",))


def slenderness_rules(scene: Scene) -> Iterator[Rule]:
    """Rods in compression, where the shape of a body gives the section: a round rod, or a plate."""
    for name, body in scene.bodies.items():
        shape, rod = None if body.shape is None else body.shape.type, rods_of(scene).get(body.link)
        if rod is None or not (shape == "plate" or (shape == "rod" and body.shape.area is not None)):
            continue
        sentence = (
            "its slenderness {value} exceeds limits.slenderness = {limit}, and the rod is compressed: it may buckle; "
            "make it thicker or shorter"
        )
        # A positive force along the rod compresses it at its origin, and stretches it at its other end.
        ends = ((rod.outer, "max", 1.0), (rod.inner, "min", -1.0))
        alone = [(pair[0].name, most, sign) for pair, most, sign in ends if [p.link for p in pair] == [body.link]]
        for pair, most, sign in alone[:1]:
            reads = (f"{pair}.reaction_along.{most}",)
            yield Rule(f"bodies.{name}", "above", "1", sentence, _slenderness(scene, name, rod.length, sign), reads)


def _slenderness(scene: Scene, name: str, length: str, sign: float) -> object:
    """Length over the minimum radius of gyration of the section, where the rod is ever compressed."""
    shape, at = scene.bodies[name].shape, f"bodies.{name}.shape"

    def judge(n: Numbers, thrust: Measured) -> tuple[object, object]:
        if shape.type == "rod":
            # A round section has A = πd²/4 and the radius of gyration d/4.
            radius = np.sqrt(n[f"{at}.area"] / (4.0 * math.pi))
        else:
            side = n[f"{at}.width"]
            if shape.thickness is not None:
                side = np.minimum(side, n[f"{at}.thickness"])
            radius = side / math.sqrt(12.0)
        slender = n[length] / radius
        return np.where(sign * thrust.value > thrust.error, slender, 0.0), limit_of(scene, "slenderness", n)

    return judge


def _loaded(scene: Scene) -> dict[str, list[str]]:
    """Links on which forces act, each with the paths of these."""
    acting = [(force.on, f"forces.{name}") for name, force in scene.forces.items()]
    acting += [(end, f"springs.{name}") for name, spring in scene.springs.items() for end in spring.between]
    on = [(_meant(scene, point), path) for point, path in acting]
    on += [(cylinder.piston, f"cylinders.{name}") for name, cylinder in scene.cylinders.items()]
    found: dict[str, list[str]] = {}
    for link, path in on:
        # At constant speed the mass of the input link plays no part.
        if link not in (FRAME, scene.input.link):
            found.setdefault(link, []).append(path)
    return found


def _meant(scene: Scene, point: str) -> str:
    """Link that a load on a point is meant for: of the free links in a joint the one that slides."""
    sliding = (name for name, link in scene.links.items() if link.guide is not None and point in link.joints)
    return next(sliding, holder_of(scene, point))


def _has_loads(scene: Scene) -> bool:
    """Whether anything acts on the machine but its motors."""
    moments = any(not isinstance(moment, Motor) for moment in scene.moments.values())
    return bool(scene.input and (scene.forces or scene.springs or scene.cylinders or moments))


def _has_masses(scene: Scene) -> bool:
    return bool(scene.bodies or any(shaft.inertia for shaft in scene.shafts.values()))


def massless_link_rules(scene: Scene) -> Iterator[Rule]:
    """Links on which forces act, but that have no mass while others have."""
    if not _has_loads(scene) or not scene.bodies or not scene.inertia_in_reactions:
        return
    for link, paths in _loaded(scene).items():
        bodies = [name for name, body in scene.bodies.items() if body.link == link]

        def judge(n: Numbers, bodies: list[str] = bodies) -> tuple[object, object]:
            return sum((body_mass(scene, name, n) for name in bodies), 0.0), LEAST_NORMAL

        sentence = f"acts on link {link}, whose mass is {{value}}: its inertia forces are missing; add it to [bodies]"
        yield Rule(paths[0], "below", "kg", sentence, judge)


def no_masses_rules(scene: Scene) -> Iterator[Rule]:
    """Loaded machines without any mass."""
    if not _has_loads(scene) or _has_masses(scene) or not scene.inertia_in_reactions:
        return
    sentence = (
        "the machine has loads but {value} masses: inertia forces, reduced inertia and flywheel are those of massless "
        "links; add [bodies], or set inertia_in_reactions = false if it runs slowly"
    )
    yield Rule("bodies", "below", "1", sentence, lambda n: (0.0, LEAST_NORMAL))


def undercut_rules(scene: Scene) -> Iterator[Rule]:
    """Wheels of gear trains that a rack cutter undercuts: z < 2 (1 − x) cos β/sin² α_t."""
    for name, train in scene.elements.items():
        if train.type != "gear_train":
            continue
        at, rings = f"elements.{name}", {m.between[1] for m in train.meshes.values() if m.type == "internal"}
        for wheel in train.wheels:
            meshes = [mesh for mesh, part in train.meshes.items() if wheel in part.between]
            if wheel in rings or not meshes:
                continue

            def judge(n: Numbers, wheel: str = f"{at}.wheels.{wheel}", mesh: str = f"{at}.meshes.{meshes[0]}") -> tuple:
                helix = n[f"{mesh}.helix_angle"]
                angle = transverse_angle(n[f"{mesh}.pressure_angle"], helix)
                least = 2.0 * (1.0 - n[f"{wheel}.profile_shift"]) * np.cos(helix) / np.sin(angle) ** 2
                return n[f"{wheel}.teeth"], least

            sentence = (
                "{value} teeth, below {limit}: a rack-type cutter undercuts them; choose more teeth, a larger "
                "profile_shift or pressure_angle"
            )
            yield Rule(f"{at}.wheels.{wheel}", "below", "1", sentence, judge)
