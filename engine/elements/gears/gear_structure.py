"""Structure of a gear train: the carrier of each mesh, coaxial parts, degrees of freedom.

A shaft turns in the frame or in a carrier. Two wheels can stay in mesh if both turn in the same carrier (or the frame),
or if one is a planet and the other is coaxial with the planet's carrier. Relative to that carrier a mesh belongs to a
fixed train: z_a (ω_a − ω_h) = ∓ z_b (ω_b − ω_h), − external (Willis).
"""

from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np

from engine.parts.skeleton import FRAME, Part

STANDS_STILL = -1


class TrainRefused(ValueError):
    """Wheels, shafts and meshes that do not form a train."""


class MeshPlace(NamedTuple):
    """A mesh in its train: indices of the shafts of both wheels and of the carrier, −1 for the frame.

    `sense` is the sign in z_a (ω_a − ω_h) + sense z_b (ω_b − ω_h) = 0: 1 external, −1 internal. `central` is the end,
    0 or 1, whose wheel is coaxial with the carrier; None if both turn in it.
    """

    name: str
    wheels: tuple[str, str]
    first: int
    second: int
    carrier: int
    sense: int
    central: int | None


class PlanetaryPath(NamedTuple):
    """Meshes from one central wheel of a carrier to another, via planets.

    Attributes
    ----------
    carrier, begin, end : str
        The carrier; the central wheels.
    steps : tuple of (MeshPlace, bool)
        The meshes, and whether each is passed from its first wheel to its second.
    """

    carrier: str
    begin: str
    end: str
    steps: tuple[tuple[MeshPlace, bool], ...]


class GearStructure(NamedTuple):
    """Structure of a train, independent of its numbers.

    Attributes
    ----------
    shafts : tuple of str
    carriers : tuple of int
        Index of the shaft in which each shaft turns; −1 for the frame.
    meshes : tuple of MeshPlace
    axes : dict of str to str
        Name of the axis of every shaft and wheel; coaxial ones share it.
    same_distance : tuple of (int, int)
        Meshes between the same two axes: their centre distances must agree.
    pin_meshes : dict of str to int
        For every planet that rolls on a central wheel, one such mesh, whose centre distance is the planet pin's radius.
    central_paths : tuple of PlanetaryPath
        Between any two central wheels of a carrier that planets connect.
    held, driven, unknown_moments : tuple of str
        Stopped shafts; shafts of given speed; shafts whose torques follow from equilibrium, including held ones.
    speeds_follow, moments_follow : bool
        Whether these determine all speeds and all torques, for generic numbers of teeth.
    """

    shafts: tuple[str, ...]
    carriers: tuple[int, ...]
    meshes: tuple[MeshPlace, ...]
    axes: dict[str, str]
    same_distance: tuple[tuple[int, int], ...]
    pin_meshes: dict[str, int]
    central_paths: tuple[PlanetaryPath, ...]
    held: tuple[str, ...]
    driven: tuple[str, ...]
    unknown_moments: tuple[str, ...]
    speeds_follow: bool
    moments_follow: bool

    @property
    def mobility(self) -> int:
        """Degrees of freedom W = 3n − 2p₁ − p₂ (Chebyshev) of one set of planets; held shafts belong to the frame."""
        return len(self.shafts) - len(self.held) - len(self.meshes)

    @property
    def words(self) -> str:
        """The mobility calculation in words."""
        n, p2 = len(self.shafts) - len(self.held), len(self.meshes)
        counts = f"n = {n} shafts that move, p1 = {n} bearings, p2 = {p2} meshes"
        return f"{counts}: W = 3·{n} − 2·{n} − {p2} = {self.mobility}"

    @property
    def planets(self) -> tuple[str, ...]:
        """Shafts that turn in a carrier."""
        return tuple(name for name, h in zip(self.shafts, self.carriers, strict=True) if h != STANDS_STILL)

    def number_of(self, names: Sequence[str]) -> list[int]:
        """Indices of the shafts with these names."""
        return [self.shafts.index(name) for name in names]

    def equations(self, teeth: np.ndarray) -> np.ndarray:
        """Coefficients K of the mesh equations K ω = 0 (meshes, shafts + 1, ...), the frame's last.

        Parameters
        ----------
        teeth : ndarray (meshes, 2, ...)
            Teeth of both wheels, negative for a ring.
        """
        found = np.zeros((len(self.meshes), len(self.shafts) + 1, *teeth.shape[2:]))
        for row, place, (first, second) in zip(found, self.meshes, teeth, strict=True):
            for shaft, value in ((place.first, first), (place.second, second), (place.carrier, -(first + second))):
                row[shaft] += value
        return found

    def name_of(self, shaft: int) -> str:
        """Name of a shaft by its index, or of the frame."""
        return FRAME if shaft == STANDS_STILL else self.shafts[shaft]


def gear_structure(wheels: Mapping[str, Part], shafts: Mapping[str, Part], meshes: Mapping[str, Part]) -> GearStructure:
    """Structure of a train.

    Parameters
    ----------
    wheels, shafts, meshes : mapping of str to Part
        As in `GearTrain`.

    Raises
    ------
    TrainRefused
        A name is unknown, wheels do not stay in mesh, nothing can move, or a mesh closes a loop.
    """
    names, shaft_of = tuple(shafts), {name: wheel.shaft for name, wheel in wheels.items()}
    number = {FRAME: STANDS_STILL} | {name: i for i, name in enumerate(names)}
    carriers = _carriers(shafts, number)
    for wheel, shaft in shaft_of.items():
        if shaft not in number:
            raise TrainRefused(f"wheels.{wheel}.shaft: {_no_shaft(shaft, number)}")
    places = tuple(_mesh_place(name, mesh, shaft_of, number, carriers) for name, mesh in meshes.items())
    axes = _axes(shaft_of, shafts, number, places)
    turning = {i for place in places for i in (place.first, place.second, place.carrier)}
    idle = [name for name in names if number[name] not in turning]
    if idle:
        raise TrainRefused(f"shafts.{idle[0]}: has no wheel in mesh and carries no planet; leave it out")
    carrying = {place.carrier for place in places if place.central is not None}
    wrong = [name for name, shaft in shafts.items() if shaft.planets is not None and number[name] not in carrying]
    if wrong:
        raise TrainRefused(f"shafts.{wrong[0]}.planets: no planet turns in this shaft; leave it out")
    same, distances = [], {}
    pins: dict[str, int] = {}
    for j, place in enumerate(places):
        between = frozenset(axes[wheel] for wheel in place.wheels)
        same += [(distances[between], j)] if between in distances else []
        distances.setdefault(between, j)
        if place.central is not None:
            pins.setdefault(names[_planet_of(place)], j)
    held = tuple(name for name, shaft in shafts.items() if shaft.held)
    driven = tuple(name for name, shaft in shafts.items() if shaft.speed is not None)
    unknown = tuple(name for name, shaft in shafts.items() if shaft.moment_follows)
    paths = _central_paths(names, places)
    roles = held, driven, unknown
    structure = GearStructure(names, carriers, places, axes, tuple(same), pins, paths, *roles, True, True)
    rank, follow = _generic_ranks(structure)
    if rank < len(places):
        raise TrainRefused(
            f"{structure.words}; but a mesh is redundant, or closes a loop that can't turn: leave one "
            f"of {', '.join(meshes)} out"
        )
    if structure.mobility < 1:
        raise TrainRefused(f"nothing can turn: {structure.words}; leave a mesh out, or give a wheel its own shaft")
    return structure._replace(speeds_follow=follow[0], moments_follow=follow[1])


def _no_shaft(name: str, shafts: Iterable[str]) -> str:
    return f"there is no shaft {name!r}: add it to shafts, or name one of {', '.join(shafts)}"


def _carriers(shafts: Mapping[str, Part], number: Mapping[str, int]) -> tuple[int, ...]:
    found = []
    for name, shaft in shafts.items():
        carrier = FRAME if shaft.carrier is None else shaft.carrier
        if carrier not in number:
            raise TrainRefused(f"shafts.{name}.carrier: {_no_shaft(carrier, number)}")
        found.append(number[carrier])
    for i, name in enumerate(shafts):
        at, passed = found[i], {i}
        while at != STANDS_STILL:
            if at in passed:
                words = f"{name} would turn in itself; let a carrier turn in the frame"
                raise TrainRefused(f"shafts.{name}.carrier: {words}")
            passed.add(at)
            at = found[at]
    return tuple(found)


def _mesh_place(
    name: str, mesh: Part, wheels: Mapping[str, str], number: Mapping[str, int], carriers: tuple[int, ...]
) -> MeshPlace:
    ends = mesh.between
    for wheel in ends:
        if wheel not in wheels:
            words = f"there is no wheel {wheel!r}: add it to wheels, or name one of {', '.join(wheels)}"
            raise TrainRefused(f"meshes.{name}.between: {words}")
    first, second = (number[wheels[wheel]] for wheel in ends)
    if first == second:
        raise TrainRefused(f"meshes.{name}.between: both are fixed to {wheels[ends[0]]}, so that they can't roll")
    sense = -1 if mesh.type == "internal" else 1
    # A wheel on the frame has no carrier; it counts as coaxial with a planet's carrier that turns in the frame.
    held_by = [None if shaft == STANDS_STILL else carriers[shaft] for shaft in (first, second)]
    if held_by[0] == held_by[1]:
        return MeshPlace(name, ends, first, second, held_by[0], sense, None)
    for central, planet in ((0, 1), (1, 0)):
        carrier, shaft = held_by[planet], (first, second)[central]
        if carrier in (None, STANDS_STILL, shaft):
            continue
        about = STANDS_STILL if held_by[central] is None else held_by[central]
        if carriers[carrier] == about:
            return MeshPlace(name, ends, first, second, carrier, sense, central)
    raise TrainRefused(
        f"meshes.{name}.between: {ends[0]} and {ends[1]} don't keep their distance: both have to turn in the "
        "same carrier, or one is a planet and the other coaxial with the planet's carrier"
    )


def _axes(
    wheels: Mapping[str, str], shafts: Mapping[str, Part], number: Mapping[str, int], places: Sequence[MeshPlace]
) -> dict[str, str]:
    """Name of the axis of every shaft and wheel; coaxial ones share it."""
    # A wheel fixed to the frame has its own axis unless a planet rolls about it.
    node = {wheel: shaft if shaft != FRAME else f"{FRAME} {wheel}" for wheel, shaft in wheels.items()}
    names = {i: name for name, i in number.items()}
    joined = [(node[p.wheels[p.central]], names[p.carrier]) for p in places if p.central is not None]
    joined += [(name, f"axis {s.axis} in {s.carrier or FRAME}") for name, s in shafts.items() if s.axis is not None]
    axis = {name: name for name in (*node.values(), *shafts, *(end for ends in joined for end in ends))}
    for one, other in joined:
        old, new = axis[one], axis[other]
        axis = {name: new if own == old else own for name, own in axis.items()}
    return {wheel: axis[name] for wheel, name in node.items()} | {name: axis[name] for name in shafts}


def _central_paths(names: tuple[str, ...], places: Sequence[MeshPlace]) -> tuple[PlanetaryPath, ...]:
    found = []
    for carrier in dict.fromkeys(place.carrier for place in places if place.central is not None):
        own = [place for place in places if place.carrier == carrier]
        for start, end in combinations([place for place in own if place.central is not None], 2):
            wheels, steps = [place.wheels[place.central] for place in (start, end)], _steps(own, start, end)
            if steps and wheels[0] != wheels[1]:
                found.append(PlanetaryPath(names[carrier], *wheels, steps))
    return tuple(found)


def _planet_of(place: MeshPlace) -> int:
    """Index of the planet's shaft in a mesh with a central wheel."""
    return (place.second, place.first)[place.central]


def _steps(own: Sequence[MeshPlace], start: MeshPlace, end: MeshPlace) -> tuple[tuple[MeshPlace, bool], ...]:
    """Meshes from one with a central wheel to another, via meshes between planets; () if they are not connected."""
    waiting, seen = [(_planet_of(start), ((start, start.central == 0),))], set()
    while waiting:
        planet, steps = waiting.pop(0)
        if planet == _planet_of(end):
            return (*steps, (end, end.central == 1))
        seen.add(planet)
        for place in own:
            if place.central is None and planet in (place.first, place.second):
                forwards = planet == place.first
                other = place.second if forwards else place.first
                if other not in seen:
                    waiting.append((other, (*steps, (place, forwards))))
    return ()


def _generic_ranks(structure: GearStructure) -> tuple[int, tuple[bool, bool]]:
    """Rank of the mesh equations for generic teeth, and whether the given speeds and torques determine all others."""
    rng = np.random.default_rng(1)
    teeth = {wheel: rng.uniform(10, 100) for place in structure.meshes for wheel in place.wheels}
    in_mesh = [[teeth[place.wheels[0]], place.sense * teeth[place.wheels[1]]] for place in structure.meshes]
    equations = structure.equations(np.array(in_mesh))[:, :-1]

    def follows(given: Sequence[str]) -> bool:
        rest = [i for i, name in enumerate(structure.shafts) if name not in given]
        return bool(np.linalg.matrix_rank(equations[:, rest]) == len(rest))

    rank = int(np.linalg.matrix_rank(equations))
    return rank, (follows((*structure.held, *structure.driven)), follows(structure.unknown_moments))
