"""What moments do in a gear train: powers, losses, efficiency both ways, forces between teeth and on planets."""

import numpy as np

from engine.cycle.measured import Measured, maximum, minimum, where
from engine.elements.element import Numbers
from engine.elements.gears.assembly_conditions import MeshSizes, angle_error
from engine.elements.gears.gear_elements import GearTrain
from engine.elements.gears.gear_structure import STANDS_STILL
from engine.elements.gears.tooth_laws import mesh_efficiency, tooth_forces
from engine.elements.gears.train_inertia import mass_and_inertia, planet_sets
from engine.elements.gears.train_moments import TrainMoments, train_moments
from engine.laws.rounding import EPS

TOOTH_FORCES = ("tangential", "radial", "axial", "normal")


def pinned_planets(train: GearTrain) -> list[str]:
    """Planets all of whose meshes are with central wheels of a carrier in the frame, in a train with modules."""
    structure = train.structure
    found = []
    for planet in structure.planets if train.has_modules else ():
        i = structure.shafts.index(planet)
        own = [place for place in structure.meshes if i in (place.first, place.second)]
        if all(p.central is not None and p.carrier == structure.carriers[i] for p in own) and (
            structure.carriers[structure.carriers[i]] == STANDS_STILL
        ):
            found.append(planet)
    return found


def mesh_efficiencies(train: GearTrain, n: Numbers, sizes: dict[str, MeshSizes]) -> np.ndarray:
    """Efficiencies of all meshes with their carriers at rest (meshes, variants)."""
    found = []
    for place in train.structure.meshes:
        mesh = train.meshes[place.name]
        if mesh.friction is not None:
            size = sizes[place.name]
            found.append(mesh_efficiency(size.teeth, size.geometry.contact, n[f"meshes.{place.name}.friction"]))
        elif mesh.efficiency is not None:
            found.append(n[f"meshes.{place.name}.efficiency"])
        else:
            found.append(np.ones(next(iter(n.values())).size))
    return np.array(found)


def load_results(
    train: GearTrain, n: Numbers, speeds: Measured, sizes: dict[str, MeshSizes]
) -> tuple[dict[str, Measured], np.ndarray]:
    """Everything that follows from moments.

    Parameters
    ----------
    train : GearTrain
    n : mapping of str to ndarray (variants,)
    speeds : Measured (shafts + 1, variants)
    sizes : dict of str to MeshSizes

    Returns
    -------
    results : dict of str to Measured (variants,)
    moves : ndarray (variants,) of bool
        Whether power comes out of the train.
    """
    structure = train.structure
    efficiencies = mesh_efficiencies(train, n, sizes)
    state = train_moments(train, n, speeds, efficiencies)
    back = train_moments(train, n, speeds, efficiencies, backwards=True)
    power = state.moments * speeds[:-1]
    found = {}
    for i, name in enumerate(structure.shafts):
        found[f"{name}.moment"], found[f"{name}.power"] = state.moments[i], power[i]
    # What is held belongs to the frame.
    free = [i for i, name in enumerate(structure.shafts) if name not in structure.held]
    found["frame.moment"] = 0.0 - _total(state.moments[free])
    into = found["input_power"] = _total(maximum(power, 0.0))
    found |= {"loss": _total(power), "efficiency": _efficiency(power)}
    found["backward_efficiency"] = _efficiency(-back.moments * speeds[:-1])
    found["self_locking"] = Measured(np.where(state.moves, np.where(back.moves, 0.0, 1.0), np.nan))
    found["circulating_power"] = _circulating(train, speeds, state, into)
    for j, place in enumerate(structure.meshes):
        found |= _mesh_loads(train, n, (j, sizes[place.name]), state, into)
        found[f"{place.name}.efficiency"] = Measured(efficiencies[j], 32.0 * EPS)
    for planet in pinned_planets(train):
        found[f"{planet}.pin_force"] = _pin_force(train, n, planet, speeds, sizes, state)
    return found, state.moves


def _total(rows: Measured) -> Measured:
    """Sum over shafts."""
    return sum(rows[i] for i in range(rows.shape[0]))


def _efficiency(power: Measured) -> Measured:
    """Power that comes out over power put in, undefined where none is."""
    out, into = -_total(minimum(power, 0.0)), _total(maximum(power, 0.0))
    return where(into.value > 0, out / into, np.nan)


def _circulating(train: GearTrain, speeds: Measured, state: TrainMoments, into: Measured) -> Measured:
    """How much more power passes through a shaft than is put into the train, over what is put in.

    A shaft of the frame is given power from outside, by every mesh between axes of the frame, and by every planetary
    stage as a whole.
    """
    structure, most = train.structure, 0.0
    for i in range(len(structure.shafts)):
        if structure.carriers[i] != STANDS_STILL:
            continue
        parts: dict[object, Measured] = {"outside": state.moments[i]}
        for j, place in enumerate(structure.meshes):
            stage = place.name if place.carrier == STANDS_STILL else place.carrier
            first, second = (state.tooth_moments[j, end] for end in (0, 1))
            for shaft, value in ((place.first, first), (place.second, second), (place.carrier, -first - second)):
                if shaft == i:
                    parts[stage] = parts.get(stage, 0.0) + value
        most = maximum(most, sum(maximum(moment * speeds[i], 0.0) for moment in parts.values()))
    share = where(into.value > 0, maximum(most / into - 1.0, 0.0), np.nan)
    return where(share.value <= share.error, Measured(0.0 * share.value, share.error), share)


def _mesh_loads(
    train: GearTrain, n: Numbers, mesh: tuple[int, MeshSizes], state: TrainMoments, into: Measured
) -> dict[str, Measured]:
    j, size = mesh
    place, rolling = train.structure.meshes[j], state.rolling_powers[j]
    share = where(into.value > 0, abs(rolling) / into, np.nan)
    found = {f"{place.name}.rolling_power": rolling, f"{place.name}.rolling_share": share}
    if train.has_modules:
        sets = planet_sets(train, n, train.structure.name_of(place.carrier))
        pulls = (abs(_pull(state, size, j, end)) for end in (0, 1))
        forces = tooth_forces(maximum(*pulls) / sets, size.geometry.angle, size.teeth)
        found |= {f"{place.name}.{part}_force": getattr(forces, part) for part in TOOTH_FORCES}
    return found


def _pull(state: TrainMoments, size: MeshSizes, mesh: int, end: int) -> Measured:
    """Tangential force on a wheel of a mesh, of all its sets of planets; its angle's error is that of its teeth."""
    radius = 0.5 * size.rolling[end]
    return state.tooth_moments[mesh, end] / Measured(radius, (8.0 * EPS + angle_error(size)) * np.abs(radius))


def _pin_force(
    train: GearTrain, n: Numbers, planet: str, speeds: Measured, sizes: dict[str, MeshSizes], state: TrainMoments
) -> Measured:
    """Force on a planet's bearing: of its teeth, and of its mass on its circle."""
    structure = train.structure
    i = structure.shafts.index(planet)
    carrier = structure.carriers[i]
    sets = planet_sets(train, n, structure.name_of(carrier))
    along, across = 0.0, 0.0
    for j, place in enumerate(structure.meshes):
        if i not in (place.first, place.second):
            continue
        end, size = (place.first, place.second).index(i), sizes[place.name]
        pull = _pull(state, size, j, end) / sets
        apart = tooth_forces(abs(pull), size.geometry.angle, size.teeth).radial
        across = across + (pull if place.sense < 0 and end == 0 else -pull)
        along = along + (apart if place.sense > 0 else -apart)
    mass, _ = mass_and_inertia(train, n, planet, sizes)
    radius = sizes[structure.meshes[structure.pin_meshes[planet]].name].distance
    along = along + mass * speeds[carrier] ** 2 * radius
    return Measured(np.hypot(along.value, across.value), along.error + across.error)
