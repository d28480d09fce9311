"""What is computed of a gear train: speeds and ratios, whether it fits, moments, losses, tooth forces, inertia."""

from collections.abc import Iterator

import numpy as np

from engine.cycle.measured import Measured
from engine.elements.element import Answers, ElementResult, Numbers
from engine.elements.gears.assembly_conditions import (
    AssemblyConditions,
    MeshSizes,
    angle_error,
    assembly_conditions,
    mesh_sizes,
    tooth_contact,
)
from engine.elements.gears.gear_elements import GearTrain
from engine.elements.gears.load_columns import TOOTH_FORCES, load_results, pinned_planets
from engine.elements.gears.tooth_laws import minimum_teeth
from engine.elements.gears.train_inertia import kinetic_energy
from engine.elements.gears.train_speeds import basic_ratios, stages, train_speeds
from engine.laws.rounding import EPS
from engine.verdicts import Verdict

# What stays of a variant whose wheels don't fit or mesh: why they don't.
_OF_ASSEMBLY = (
    ".spacing_remainder",
    ".neighbour_clearance",
    ".distance_error",
    ".contact_ratio",
    ".operating_pressure_angle",
    ".centre_distance",
    ".minimum_teeth",
)


def driver_of(train: GearTrain) -> str | None:
    """The shaft that alone is driven; None where several are, or none."""
    driven = train.structure.driven
    return driven[0] if len(driven) == 1 else None


def _free_shafts(train: GearTrain) -> list[str]:
    """Shafts in the frame that aren't held: those that ratios and reduced inertias are told of."""
    return [n for n in train.shafts if n not in train.structure.planets and not train.shafts[n].held]


def gear_train_results(train: GearTrain) -> Iterator[ElementResult]:
    """Results of a gear train, by what it is made of."""
    structure, driver = train.structure, driver_of(train)
    yield ElementResult("mobility", "degrees of freedom W = 3n - 2p1 - p2", "1", exact=True)
    for _, other in structure.same_distance:
        name = structure.meshes[other].name
        yield ElementResult(
            f"{name}.distance_error", f"difference of the centre distance of {name} from that of its axes, over it", "1"
        )
    for carrier in dict.fromkeys(stage[0] for stage in stages(train)):
        if train.shafts[carrier].planets is not None:
            words = f"what is left over where planets spaced equally on {carrier} need a whole multiple (0 fits)"
            yield ElementResult(f"{carrier}.spacing_remainder", words, "1", exact=True)
    for planet, j in structure.pin_meshes.items():
        if train.shafts[structure.name_of(structure.meshes[j].carrier)].planets is not None:
            words = f"gap between the tips of neighbouring {planet} planets, over the diameter of the tips"
            yield ElementResult(f"{planet}.neighbour_clearance", words, "1", None, True)
    for place in structure.meshes:
        name, (a, b) = place.name, place.wheels
        words = f"transverse contact ratio of {name}, of teeth as far as they don't interfere"
        yield ElementResult(f"{name}.contact_ratio", words, "1")
        yield ElementResult(f"{name}.operating_pressure_angle", f"transverse operating pressure angle of {name}", "rad")
        if train.has_modules:
            yield ElementResult(f"{name}.centre_distance", f"distance of the axes of {a} and {b}", "m")
        small = a if place.sense < 0 else f"the smaller of {a} and {b}"
        words = f"minimum number of teeth of {small} without interference, the other wheel as it is"
        yield ElementResult(f"{name}.minimum_teeth", words, "1", None, True, True)
    for name in train.shafts:
        yield ElementResult(f"{name}.speed", f"angular speed of {name}", "rad s-1")
    if driver is not None:
        for name in _free_shafts(train):
            if name != driver:
                yield ElementResult(f"{name}.ratio", f"speed of {driver} over that of {name}", "1", None, True)
    for carrier, a, b, _ in stages(train):
        yield ElementResult(
            f"{carrier}.basic_ratio_of_{a}_to_{b}", f"speed of {a} over that of {b}, seen from {carrier}", "1"
        )
    if train.has_inertia:
        yield ElementResult("kinetic_energy", "kinetic energy of all members", "J")
        for name in _free_shafts(train):
            yield ElementResult(f"{name}.reduced_inertia", f"inertia reduced to {name}", "kg m2", None, True)
    if train.has_loads:
        yield from _results_of_loads(train)


def _results_of_loads(train: GearTrain) -> Iterator[ElementResult]:
    structure = train.structure
    for name in structure.shafts:
        if name in structure.unknown_moments or train.shafts[name].moment is not None:
            yield ElementResult(f"{name}.moment", f"moment from outside on {name}", "N m")
            yield ElementResult(f"{name}.power", f"power put in at {name}", "W")
    yield ElementResult("frame.moment", "moment that holds the frame with all held shafts", "N m")
    yield ElementResult("input_power", "power put in", "W")
    yield ElementResult("loss", "power lost in all meshes", "W")
    yield ElementResult("efficiency", "power that comes out over power put in", "1", None, True)
    yield ElementResult("backward_efficiency", "efficiency turning backwards under the same moments", "1", None, True)
    yield ElementResult(
        "self_locking", "the same moments can't turn the train backwards (1) or can (0)", "1", exact=True
    )
    yield ElementResult("circulating_power", "power that circulates in shafts, over power put in", "1", None, True)
    for place in structure.meshes:
        name, (a, b) = place.name, place.wheels
        yield ElementResult(f"{name}.efficiency", f"efficiency of {name}, its axes at rest", "1")
        yield ElementResult(f"{name}.rolling_power", f"power that {a} gives {b}, seen from the carrier", "W")
        yield ElementResult(f"{name}.rolling_share", f"power rolling through {name} over power put in", "1", None, True)
        if train.has_modules:
            for part in TOOTH_FORCES:
                yield ElementResult(f"{name}.{part}_force", f"{part} force between the teeth of {name}", "N")
    for planet in pinned_planets(train):
        yield ElementResult(f"{planet}.pin_force", f"force on the bearing of each {planet}", "N")


def train_answers(train: GearTrain, n: Numbers) -> Answers:
    """Results of a gear train with what they may be off by, and verdicts.

    Parameters
    ----------
    train : GearTrain
    n : mapping of str to ndarray (variants,)
    """
    with np.errstate(all="ignore"):
        sizes = mesh_sizes(train, n)
        fit = assembly_conditions(train, n, sizes)
        told = _assembly(fit) | _of_teeth(train, sizes)
        contact = tooth_contact(train, n, sizes)
        here = np.flatnonzero(fit.fits & (contact == Verdict.OK))
        found, verdicts = gear_results(train, {key: row[here] for key, row in n.items()})
    values, errors = {}, {}
    for result in gear_train_results(train):
        values[result.name], errors[result.name] = pair = np.full((2, fit.fits.size), np.nan)
        known, where = (told, slice(None)) if result.name.endswith(_OF_ASSEMBLY) else (found, here)
        pair[0, where], pair[1, where] = known[result.name].value, known[result.name].error
    verdict = np.where(fit.fits, contact, Verdict.DOES_NOT_FIT).astype(np.uint8)
    verdict[here] = verdicts
    return Answers(values, errors, verdict)


def _assembly(fit: AssemblyConditions) -> dict[str, Measured]:
    found = {f"{name}.distance_error": Measured(value, 8.0 * EPS) for name, value in fit.distance_errors.items()}
    found |= {f"{name}.spacing_remainder": Measured(value) for name, value in fit.spacing_remainders.items()}
    return found | {
        f"{name}.neighbour_clearance": Measured(value, 16.0 * EPS * (1.0 + np.abs(value)))
        for name, value in fit.clearances.items()
    }


def _of_teeth(train: GearTrain, sizes: dict[str, MeshSizes]) -> dict[str, Measured]:
    found: dict[str, Measured] = {}
    for name, size in sizes.items():
        teeth, geometry, rough = size.teeth, size.geometry, angle_error(size)
        most = np.maximum(teeth.first, teeth.second)
        found[f"{name}.contact_ratio"] = Measured(sum(geometry.contact), (64.0 * EPS + rough) * most)
        found[f"{name}.operating_pressure_angle"] = Measured(geometry.angle, (8.0 * EPS + rough) * geometry.angle)
        if train.has_modules:
            found[f"{name}.centre_distance"] = Measured(size.distance, (8.0 * EPS + rough) * np.abs(size.distance))
        found[f"{name}.minimum_teeth"] = Measured(minimum_teeth(teeth))
    return found


def gear_results(train: GearTrain, n: Numbers) -> tuple[dict[str, Measured], np.ndarray]:
    """All results of trains whose wheels fit and mesh, but for the conditions of that.

    Parameters
    ----------
    train : GearTrain
        How it hangs together; its numbers are not used.
    n : mapping of str to ndarray (variants,)
        Its numbers by their keys, such as "wheels.sun.teeth".

    Returns
    -------
    results : dict of str to Measured (variants,)
        As named by `gear_train_results`.
    verdicts : ndarray (variants,) of uint8
        NOT_FINITE where a basic ratio lets no speeds follow, SELF_LOCKS or STANDS where losses take all power.
    """
    structure, driver = train.structure, driver_of(train)
    variants = next(iter(n.values())).size
    sizes, speeds = mesh_sizes(train, n), train_speeds(train, n)
    found: dict[str, Measured] = {"mobility": Measured(np.full(variants, float(structure.mobility)))}
    found |= {f"{name}.speed": speeds[i] for i, name in enumerate(structure.shafts)}
    if driver is not None:
        first = speeds[structure.shafts.index(driver)]
        for name in _free_shafts(train):
            ratio = first / speeds[structure.shafts.index(name)]
            # Over a shaft that stands it is infinite either way.
            found[f"{name}.ratio"] = Measured(np.where(np.isinf(ratio.value), np.inf, ratio.value), ratio.error)
    found |= basic_ratios(train, n)
    if train.has_inertia:
        energy = found["kinetic_energy"] = kinetic_energy(train, n, speeds, sizes)
        for name in _free_shafts(train):
            found[f"{name}.reduced_inertia"] = 2.0 * energy / speeds[structure.shafts.index(name)] ** 2
    verdicts = np.where(np.isnan(speeds.value).any(axis=0), Verdict.NOT_FINITE, Verdict.OK).astype(np.uint8)
    if train.has_loads:
        loads, moves = load_results(train, n, speeds, sizes)
        found |= loads
        unknown = structure.unknown_moments
        driven = any(train.shafts[name].speed is not None and not train.shafts[name].loaded for name in unknown)
        verdicts[(verdicts == Verdict.OK) & ~moves] = Verdict.SELF_LOCKS if driven else Verdict.STANDS
    return found, verdicts
