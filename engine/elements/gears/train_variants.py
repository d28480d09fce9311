"""Gear trains with the numbers of some variants: sizes of their meshes, speeds by the mesh equations K ω = 0."""

from typing import NamedTuple

import numpy as np

from engine.cycle.measured import Measured
from engine.elements.element import Element, Numbers
from engine.elements.gears.gear_structure import GearStructure, MeshPlace, PlanetaryPath
from engine.elements.gears.small_systems import solve
from engine.elements.gears.tooth_laws import MeshGeometry, TeethInMesh, mesh_geometry, pitch_diameter
from engine.laws.rounding import EPS


class MeshSizes(NamedTuple):
    """Dimensions of a mesh (variants,): normal module and reference diameters [m]; teeth and their geometry.

    In a train without modules, the module is 1 and lengths are in modules.
    """

    module: np.ndarray
    diameters: tuple[np.ndarray, np.ndarray]
    teeth: TeethInMesh
    geometry: MeshGeometry

    @property
    def distance(self) -> np.ndarray:
        """Centre distance [m]."""
        return self.module * self.geometry.distance

    @property
    def rolling(self) -> tuple[np.ndarray, np.ndarray]:
        """Diameters of the operating pitch circles [m]."""
        first, second = self.geometry.rolling
        return self.module * first, self.module * second


class TrainVariants(NamedTuple):
    """Gear trains of one structure with the numbers of some variants.

    Attributes
    ----------
    train : GearTrain
        The structure; its own numbers are not used.
    n : mapping of str to ndarray (variants,)
        Numbers by their keys, such as "wheels.sun.teeth".
    sizes : dict of str to MeshSizes
        Dimensions of all meshes, by name.
    speeds : Measured (shafts + 1, variants)
        [rad/s]; the last row is the frame's, 0, so that index −1 is at rest. NaN if the speeds are not determined.
    """

    train: Element
    n: Numbers
    sizes: dict[str, MeshSizes]
    speeds: Measured

    @property
    def structure(self) -> GearStructure:
        """Structure of the trains."""
        return self.train.structure

    @property
    def count(self) -> int:
        """Number of variants."""
        return self.speeds.shape[1]

    def planet_sets(self, carrier: int) -> np.ndarray:
        """Number of planet sets of a carrier, by its index (variants,)."""
        return self.n.get(f"shafts.{self.structure.name_of(carrier)}.planets", np.ones(self.count))


def train_variants(train: Element, n: Numbers) -> TrainVariants:
    """Gear trains with the numbers of some variants; parameters as in `TrainVariants`."""
    return TrainVariants(train, n, _mesh_sizes(train, n), _train_speeds(train, n))


def _mesh_sizes(train: Element, n: Numbers) -> dict[str, MeshSizes]:
    """Dimensions of all meshes, by name."""
    found = {}
    for place in train.structure.meshes:
        z_a, z_b = (n[f"wheels.{wheel}.teeth"] for wheel in place.wheels)
        helix = n[f"meshes.{place.name}.helix_angle"]
        # In a train without modules, lengths are in modules.
        module = n.get(f"meshes.{place.name}.module", n.get("module", np.ones_like(z_a)))
        shifts = (n[f"wheels.{wheel}.profile_shift"] for wheel in place.wheels)
        teeth = TeethInMesh(z_a, z_b, place.sense, n[f"meshes.{place.name}.pressure_angle"], helix, *shifts)
        diameters = pitch_diameter(z_a, module, helix), pitch_diameter(z_b, module, helix)
        found[place.name] = MeshSizes(module, diameters, teeth, mesh_geometry(teeth))
    return found


def angle_error(size: MeshSizes) -> np.ndarray:
    """Relative error estimate of quantities that depend on the operating pressure angle; 0 without profile shift."""
    shifted = size.teeth.first_shift + size.teeth.sense * size.teeth.second_shift != 0.0
    # The involute function of a small angle is the small difference of its tangent and the angle.
    return np.where(shifted, 32.0 * EPS * (1.0 + np.tan(size.geometry.angle) ** -2.0), 0.0)


def teeth_of(place: MeshPlace, n: Numbers) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of teeth of both wheels of a mesh, negative for a ring."""
    first, second = (n[f"wheels.{wheel}.teeth"] for wheel in place.wheels)
    return first, place.sense * second


def _train_speeds(train: Element, n: Numbers) -> Measured:
    """All angular speeds for the given ones."""
    structure = train.structure
    equations = structure.equations(np.array([teeth_of(place, n) for place in structure.meshes]))
    count, variants = len(structure.shafts), equations.shape[-1]
    held, driven = structure.number_of(structure.held), structure.number_of(structure.driven)
    rest = [i for i in range(count) if i not in (*held, *driven)]
    given = np.array([n[f"shafts.{name}.speed"] for name in structure.driven])
    given = Measured(given, EPS * np.abs(given))
    # Solve for each given speed separately: contributions may cancel, and the sum carries the rounding of each.
    shares, _ = solve(equations[:, rest], -equations[:, driven])
    parts = shares * given
    following = sum(parts[:, k] for k in range(len(driven)))
    values, errors = np.zeros((2, count + 1, variants))
    for rows, speeds in ((driven, given), (rest, following)):
        values[rows], errors[rows] = speeds.value, speeds.error
    return Measured(values, errors)


def basic_ratio(path: PlanetaryPath, n: Numbers) -> Measured:
    """Basic ratio i₀ = (ω_a − ω_h)/(ω_b − ω_h) of a planetary stage (Willis) (variants,).

    Parameters
    ----------
    path : PlanetaryPath
        From the central wheel a to b.
    n : mapping of str to ndarray (variants,)
    """
    ratio = Measured(np.ones(next(iter(n.values())).size))
    for place, forwards in path.steps:
        z_a, z_b = (Measured(z) for z in teeth_of(place, n))
        ratio = ratio * (-z_b / z_a if forwards else -z_a / z_b)
    return ratio
