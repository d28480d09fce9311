"""Assembly and meshing of a train's wheels: whole teeth, equal centre distances, clearance between planets."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from engine.cycle.measured import Measured
from engine.elements.element import Numbers
from engine.elements.gears.gear_structure import PlanetaryPath
from engine.elements.gears.train_variants import MeshSizes, TrainVariants, teeth_of
from engine.laws.rounding import EPS
from engine.words.quantity import Quantity, check_result, main_result
from engine.words.verdicts import Verdict

# Relative difference below which centre distances are equal except for rounding.
_SAME = 1e-9


class AssemblyConditions(NamedTuple):
    """Assembly conditions of a train: verdicts (variants,), OK where it fits, and the results that show why."""

    verdicts: np.ndarray
    results: list[tuple[Quantity, Measured]]


def tooth_contact(v: TrainVariants) -> np.ndarray:
    """Verdicts on teeth (variants,): OK, INTERFERES, or CONTACT_BREAKS for a contact ratio below one.

    For helical wheels the overlap ratio is included; without a face width they are not checked.
    """
    interferes = breaks = np.zeros(v.count, bool)
    for name, mesh in v.train.meshes.items():
        teeth, geometry, module = v.sizes[name].teeth, v.sizes[name].geometry, v.sizes[name].module
        interferes = interferes | geometry.interferes
        widths = [v.n[f"wheels.{w}.width"] for w in mesh.between if v.train.wheels[w].width is not None]
        width = np.min(widths, axis=0) if widths else np.where(teeth.helix_angle == 0.0, 0.0, np.inf)
        overlap = np.where(teeth.helix_angle == 0.0, 0.0, width * np.sin(teeth.helix_angle) / (np.pi * module))
        breaks = breaks | (sum(geometry.contact) + overlap < 1.0)
    return np.where(interferes, Verdict.INTERFERES, np.where(breaks, Verdict.CONTACT_BREAKS, Verdict.OK))


def assembly_conditions(v: TrainVariants) -> AssemblyConditions:
    """Check whether a train can be assembled."""
    train, n, sizes, structure, results = v.train, v.n, v.sizes, v.structure, []
    verdicts = np.full(v.count, Verdict.OK, np.uint8)

    def require(met: np.ndarray, otherwise: Verdict) -> None:
        verdicts[~met & (verdicts == Verdict.OK)] = otherwise

    counts = [f"wheels.{wheel}.teeth" for wheel in train.wheels]
    counts += [f"shafts.{name}.planets" for name, shaft in train.shafts.items() if shaft.planets is not None]
    for key in counts:
        require(n[key] == np.round(n[key]), Verdict.FRACTION_OF_A_TOOTH)
    for size in sizes.values():
        # NaN if profile shifts rule out any centre distance.
        require(size.distance > 0, Verdict.DOES_NOT_FIT)
    require(_equal_modules(v), Verdict.MODULES_DIFFER)
    require(_bores_leave_a_rim(v), Verdict.BORE_TOO_LARGE)
    for one, other in structure.same_distance:
        at, name = (sizes[structure.meshes[j].name].distance for j in (one, other)), structure.meshes[other].name
        first, second = at
        off = (second - first) / first
        require(np.abs(off) <= _SAME, Verdict.AXES_APART)
        words = f"relative difference between the centre distance of {name} and that of its axes"
        results.append((check_result(f"{name}.distance_error", words, "1"), Measured(off, 8.0 * EPS)))
    remainders: dict[str, np.ndarray] = {}
    for path in structure.central_paths:
        if train.shafts[path.carrier].planets is not None:
            left = _spacing_remainder(path, n, n[f"shafts.{path.carrier}.planets"])
            remainders[path.carrier] = np.maximum(remainders.get(path.carrier, 0.0), left)
    for name, left in remainders.items():
        require(left == 0, Verdict.UNEVEN_PLANETS)
        words = f"remainder of the assembly condition for equally spaced planets on {name} (0 fits)"
        results.append((check_result(f"{name}.spacing_remainder", words, "1", exact=True), Measured(left)))
    for planet, gap in _clearances(v):
        require(gap > 0, Verdict.PLANETS_TOUCH)
        words = f"gap between the tips of neighbouring {planet} planets, over the diameter of the tips"
        clearance = main_result(f"{planet}.neighbour_clearance", words, "1", True)
        results.append((clearance, Measured(gap, 16.0 * EPS * (1.0 + np.abs(gap)))))
    return AssemblyConditions(verdicts, results)


def _equal_modules(v: TrainVariants) -> np.ndarray:
    """Whether all meshes of a wheel have the same module and helix angle."""
    first: dict[str, MeshSizes] = {}
    equal = np.array(True)
    for name, mesh in v.train.meshes.items():
        own = v.sizes[name]
        for wheel in mesh.between:
            known = first.setdefault(wheel, own)
            equal = equal & (np.abs(known.module - own.module) <= _SAME * known.module)
            equal = equal & (np.abs(known.teeth.helix_angle - own.teeth.helix_angle) <= _SAME)
    return equal


def _bores_leave_a_rim(v: TrainVariants) -> np.ndarray:
    """Whether the bores of discs are smaller than the root circles of the teeth."""
    left = np.array(True)
    for name, mesh in v.train.meshes.items():
        for wheel, diameter in zip(mesh.between, v.sizes[name].diameters, strict=True):
            if v.train.wheels[wheel].width is not None:
                root = diameter + (2.0 * v.n[f"wheels.{wheel}.profile_shift"] - 2.5) * v.sizes[name].module
                left = left & (v.n[f"wheels.{wheel}.bore"] < root)
    return left


def _spacing_remainder(path: PlanetaryPath, n: Numbers, count: np.ndarray) -> np.ndarray:
    """Remainder of the condition that all equally spaced planets mesh, in whole units; 0 fits.

    If a set of planets is rotated by 2π/k without changing phases, both central wheels rotate back by that angle
    relative to it. Each mesh may then slip by whole teeth only. Integers y with y · (coefficients of each planet) = 0
    combine the meshes so that the planets' own angles cancel; the contribution of the central wheels must be divisible
    by k. For a planet with one wheel this is (z_a ± z_b)/k, with two wheels (z_a z₂ ± z_b z₁)/(k gcd(z₁, z₂)).
    """
    teeth = ([np.rint(z).astype(np.int64) for z in teeth_of(place, n)][:: 1 if on else -1] for place, on in path.steps)
    central, into = next(teeth)
    y = [np.ones_like(central)]
    for here, there in teeth:
        shared = np.gcd(y[-1] * into, here)
        shared = np.where(shared == 0, 1, shared)
        y = [value * (here // shared) for value in y] + [-(y[-1] * into) // shared]
        into = there
    total = y[0] * central + y[-1] * into
    k = np.maximum(np.rint(count), 1).astype(np.int64)
    return (np.abs(total) % k).astype(float)


def _clearances(v: TrainVariants) -> Iterator[tuple[str, np.ndarray]]:
    """Gap between neighbouring planets, relative to their tip diameter: 2a sin(π/k)/d_a − 1."""
    structure, sizes = v.structure, v.sizes
    for planet, j in structure.pin_meshes.items():
        count = v.planet_sets(structure.meshes[j].carrier)
        if v.train.shafts[structure.name_of(structure.meshes[j].carrier)].planets is None:
            continue
        tips = []
        for place in structure.meshes:
            for end, shaft in enumerate((place.first, place.second)):
                if structure.name_of(shaft) == planet and not (end == 1 and place.sense < 0):
                    size = sizes[place.name]
                    tips.append(size.module * size.geometry.tips[end])
        chord = 2.0 * sizes[structure.meshes[j].name].distance * np.sin(np.pi / count)
        with np.errstate(divide="ignore"):
            gap = chord / np.max(tips, axis=0) - 1.0
        # A single planet has no neighbour.
        yield planet, np.where(count < 2, np.inf, gap)
