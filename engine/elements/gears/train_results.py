"""Results of a gear train: speeds and ratios, assembly, torques, losses, tooth forces, inertia.

Each result is named where it is computed, so a train's own numbers decide which results it has.
"""

import numpy as np

from engine.cycle.measured import Measured
from engine.elements.element import Answers, Element, NamedRows, Numbers
from engine.elements.gears.assembly_conditions import assembly_conditions, tooth_contact
from engine.elements.gears.tooth_laws import minimum_teeth
from engine.elements.gears.train_inertia import kinetic_energy
from engine.elements.gears.train_loads import equilibria, load_results
from engine.elements.gears.train_variants import TrainVariants, angle_error, basic_ratio, train_variants
from engine.laws.rounding import EPS
from engine.words.quantity import Quantity, check_result, main_result
from engine.words.verdicts import Verdict


def _of_teeth(v: TrainVariants) -> NamedRows:
    """Results of the meshing of teeth."""
    for place in v.structure.meshes:
        name, (a, b), size = place.name, place.wheels, v.sizes[place.name]
        teeth, geometry, rough = size.teeth, size.geometry, angle_error(size)
        words = f"transverse contact ratio of {name}, up to the interference points"
        off = (64.0 * EPS + rough) * np.maximum(teeth.first, teeth.second)
        yield main_result(f"{name}.contact_ratio", words, "1"), Measured(sum(geometry.contact), off)
        words, off = f"transverse operating pressure angle of {name}", (8.0 * EPS + rough) * geometry.angle
        yield Quantity(f"{name}.operating_pressure_angle", words, "rad"), Measured(geometry.angle, off)
        if v.train.has_modules:
            words, off = f"centre distance of {a} and {b}", (8.0 * EPS + rough) * np.abs(size.distance)
            yield main_result(f"{name}.centre_distance", words, "m"), Measured(size.distance, off)
        small = a if place.sense < 0 else f"the smaller of {a} and {b}"
        words = f"minimum number of teeth of {small} without interference, the other wheel unchanged"
        least = Quantity(f"{name}.minimum_teeth", words, "1", may_be_undefined=True, exact=True)
        yield least, Measured(minimum_teeth(teeth))


def _of_motion(v: TrainVariants) -> NamedRows:
    """Speeds, ratios, energy."""
    train, structure = v.train, v.structure
    mobility = np.full(v.count, float(structure.mobility))
    yield check_result("mobility", "degrees of freedom W = 3n - 2p1 - p2", "1", exact=True), Measured(mobility)
    by_name = dict(zip(structure.shafts, v.speeds, strict=False))
    for name, speed in by_name.items():
        yield main_result(f"{name}.speed", f"angular speed of {name}", "rad s-1"), speed
    # Shafts in the frame that are not held: ratios and reduced inertias refer to these.
    free = [name for name in train.shafts if name not in structure.planets and not train.shafts[name].held]
    # Ratios require a single driven shaft.
    for driver in structure.driven if len(structure.driven) == 1 else ():
        for name in free:
            if name != driver:
                ratio = by_name[driver] / by_name[name]
                # For a shaft at rest the ratio is infinite; its sign is meaningless.
                ratio = Measured(np.where(np.isinf(ratio.value), np.inf, ratio.value), ratio.error)
                yield main_result(f"{name}.ratio", f"speed of {driver} over that of {name}", "1", True), ratio
    for path in structure.central_paths:
        (carrier, a, b, _), words = path, f"speed of {path.begin} over that of {path.end}, seen from {path.carrier}"
        yield main_result(f"{carrier}.basic_ratio_of_{a}_to_{b}", words, "1"), basic_ratio(path, v.n)
    if train.has_inertia:
        energy = kinetic_energy(v)
        yield Quantity("kinetic_energy", "kinetic energy of all members", "J"), energy
        for name in free:
            words = f"inertia reduced to {name}"
            reduced = 2.0 * energy / by_name[name] ** 2
            yield Quantity(f"{name}.reduced_inertia", words, "kg m2", may_be_undefined=True), reduced


def train_results(train: Element, n: Numbers) -> tuple[list[tuple[Quantity, Measured]], np.ndarray]:
    """All results of trains whose wheels fit and mesh, except the assembly conditions.

    Parameters
    ----------
    train : GearTrain
        The structure; its own numbers are not used.
    n : mapping of str to ndarray (variants,)
        Numbers by their keys, such as "wheels.sun.teeth".

    Returns
    -------
    results : list of (Quantity, Measured (variants,))
    verdicts : ndarray (variants,) of uint8
        NOT_FINITE if the given speeds do not determine the others; SELF_LOCKS or STANDS if losses absorb all power.
    """
    v = train_variants(train, n)
    found = list(_of_motion(v))
    verdicts = np.where(np.isnan(v.speeds.value).any(axis=0), Verdict.NOT_FINITE, Verdict.OK).astype(np.uint8)
    if train.has_loads:
        states = equilibria(v)
        found += load_results(v, states)
        roles = (train.shafts[name] for name in train.structure.unknown_moments)
        driven = any(shaft.speed is not None and not shaft.loaded for shaft in roles)
        stuck = (verdicts == Verdict.OK) & ~states.forwards.moves
        verdicts[stuck] = Verdict.SELF_LOCKS if driven else Verdict.STANDS
    return found, verdicts


def named_results(train: Element, n: Numbers) -> NamedRows:
    """All results of a train, whether or not its wheels fit."""
    v, ((mobility, *others), _) = train_variants(train, n), train_results(train, n)
    yield from (mobility, *assembly_conditions(v).results, *_of_teeth(v), *others)


@np.errstate(all="ignore")
def train_answers(train: Element, n: Numbers) -> Answers:
    """Results of a gear train with error estimates, and verdicts."""
    v = train_variants(train, n)
    fit, contact = assembly_conditions(v), tooth_contact(v)
    verdict = np.where(fit.verdicts == Verdict.OK, contact, fit.verdicts).astype(np.uint8)
    here = np.flatnonzero(verdict == Verdict.OK)
    found, verdicts = train_results(train, {key: row[here] for key, row in n.items()})
    # The assembly conditions are also reported for variants that do not fit, to show why.
    values, errors = {}, {}
    everywhere = (*fit.results, *_of_teeth(v))
    for results, where in ((everywhere, slice(None)), (found, here)):
        for result, known in results:
            values[result.name], errors[result.name] = pair = np.full((2, verdict.size), np.nan)
            pair[0, where], pair[1, where] = known.value, known.error
    verdict[here] = verdicts
    return Answers(values, errors, verdict)
