"""What moments do in a gear train: powers, losses, efficiency both ways, forces between teeth and on planets."""

import numpy as np

from engine.elements.element import Numbers
from engine.elements.gears.assembly_conditions import MeshSizes, angle_error
from engine.elements.gears.gear_elements import GearTrain
from engine.elements.gears.gear_structure import STANDS_STILL
from engine.elements.gears.tooth_laws import mesh_efficiency, tooth_forces
from engine.elements.gears.train_inertia import mass_and_inertia, planet_sets
from engine.elements.gears.train_moments import TrainMoments, train_moments
from engine.elements.gears.train_speeds import TrainSpeeds
from engine.laws.rounding import EPS

Pairs = dict[str, tuple[np.ndarray, np.ndarray]]
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
    train: GearTrain, n: Numbers, speeds: TrainSpeeds, sizes: dict[str, MeshSizes]
) -> tuple[Pairs, np.ndarray]:
    """Everything that follows from moments.

    Parameters
    ----------
    train : GearTrain
    n : mapping of str to ndarray (variants,)
    speeds : TrainSpeeds
    sizes : dict of str to MeshSizes

    Returns
    -------
    results : dict of str to (ndarray (variants,), ndarray (variants,))
        Values and what they may be off by.
    moves : ndarray (variants,) of bool
        Whether power comes out of the train.
    """
    structure = train.structure
    efficiencies = mesh_efficiencies(train, n, sizes)
    state = train_moments(train, n, speeds, efficiencies)
    back = train_moments(train, n, speeds, efficiencies, backwards=True)
    power = state.moments * speeds.speeds
    off = state.moment_errors * np.abs(speeds.speeds) + np.abs(state.moments) * speeds.errors
    found: Pairs = {}
    for i, name in enumerate(structure.shafts):
        found[f"{name}.moment"], found[f"{name}.power"] = (state.moments[i], state.moment_errors[i]), (power[i], off[i])
    # What is held belongs to the frame.
    free = [i for i, name in enumerate(structure.shafts) if name not in structure.held]
    found["frame.moment"] = 0.0 - state.moments[free].sum(axis=0), state.moment_errors[free].sum(axis=0)
    into, into_off = np.maximum(power, 0.0).sum(axis=0), np.where(power > 0, off, 0.0).sum(axis=0)
    found["input_power"] = into, into_off
    found["loss"] = power.sum(axis=0), off.sum(axis=0)
    found["efficiency"] = _efficiency(power, off)
    found["backward_efficiency"] = _efficiency(
        -back.moments * speeds.speeds,
        back.moment_errors * np.abs(speeds.speeds) + np.abs(back.moments) * speeds.errors,
    )
    found["self_locking"] = np.where(state.moves, np.where(back.moves, 0.0, 1.0), np.nan), 0.0 * into
    found["circulating_power"] = _circulating(train, speeds, state, into)
    for j, place in enumerate(structure.meshes):
        found |= _mesh_loads(train, n, j, sizes[place.name], state, efficiencies[j], into)
    for planet in pinned_planets(train):
        found[f"{planet}.pin_force"] = _pin_force(train, n, planet, speeds, sizes, state)
    return found, state.moves


def _efficiency(power: np.ndarray, off: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Power that comes out over power put in, undefined where none is."""
    out, into = -np.minimum(power, 0.0).sum(axis=0), np.maximum(power, 0.0).sum(axis=0)
    share = np.where(into > 0, out / into, np.nan)
    return share, (np.where(power < 0, off, 0.0).sum(axis=0) + share * np.where(power > 0, off, 0.0).sum(axis=0)) / into


def _circulating(
    train: GearTrain, speeds: TrainSpeeds, state: TrainMoments, into: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """How much more power passes through a shaft than is put into the train, over what is put in.

    A shaft of the frame is given power from outside, by every mesh between axes of the frame, and by every planetary
    stage as a whole.
    """
    structure = train.structure
    most = np.zeros_like(into)
    for i in range(len(structure.shafts)):
        if structure.carriers[i] != STANDS_STILL:
            continue
        parts: dict[object, np.ndarray] = {"outside": state.moments[i]}
        for j, place in enumerate(structure.meshes):
            stage = place.name if place.carrier == STANDS_STILL else place.carrier
            first, second = state.tooth_moments[j]
            for shaft, value in ((place.first, first), (place.second, second), (place.carrier, -first - second)):
                if shaft == i:
                    parts[stage] = parts.get(stage, 0.0) + value
        passing = sum(np.maximum(moment * speeds.speeds[i], 0.0) for moment in parts.values())
        most = np.maximum(most, passing)
    share = np.where(into > 0, np.maximum(most / into - 1.0, 0.0), np.nan)
    off = state.tooth_moment_errors.max(axis=0) + 32.0 * EPS
    share = np.where(share <= off * (1.0 + share), 0.0, share)
    return share, off * (1.0 + share)


def _mesh_loads(
    train: GearTrain,
    n: Numbers,
    j: int,
    size: MeshSizes,
    state: TrainMoments,
    efficiency: np.ndarray,
    into: np.ndarray,
) -> Pairs:
    place = train.structure.meshes[j]
    name, off = place.name, state.tooth_moment_errors[j]
    rolling = state.rolling_powers[j]
    found: Pairs = {
        f"{name}.efficiency": (efficiency, 32.0 * EPS * np.ones_like(efficiency)),
        f"{name}.rolling_power": (rolling, (off + 8.0 * EPS) * np.abs(rolling)),
    }
    share = np.where(into > 0, np.abs(rolling) / into, np.nan)
    found[f"{name}.rolling_share"] = share, share * (2.0 * off + 16.0 * EPS)
    if train.has_modules:
        sets = planet_sets(train, n, train.structure.name_of(place.carrier))
        pulls = np.abs(state.tooth_moments[j]) / (0.5 * np.array(size.rolling))
        forces = tooth_forces(pulls.max(axis=0) / sets, size.geometry.angle, size.teeth)
        for part in TOOTH_FORCES:
            value = getattr(forces, part)
            found[f"{name}.{part}_force"] = value, (off + 16.0 * EPS + angle_error(size)) * value
    return found


def _pin_force(
    train: GearTrain,
    n: Numbers,
    planet: str,
    speeds: TrainSpeeds,
    sizes: dict[str, MeshSizes],
    state: TrainMoments,
) -> tuple[np.ndarray, np.ndarray]:
    """Force on a planet's bearing: of its teeth, and of its mass on its circle."""
    structure = train.structure
    i = structure.shafts.index(planet)
    carrier = structure.carriers[i]
    sets = planet_sets(train, n, structure.name_of(carrier))
    along, across, off = np.zeros((3, speeds.speeds.shape[1]))
    for j, place in enumerate(structure.meshes):
        if i not in (place.first, place.second):
            continue
        end, name = (place.first, place.second).index(i), place.name
        size = sizes[name]
        pull = state.tooth_moments[j, end] / (0.5 * size.rolling[end] * sets)
        apart = tooth_forces(np.abs(pull), size.geometry.angle, size.teeth).radial
        in_a_ring = place.sense < 0 and end == 0
        across += pull if in_a_ring else -pull
        along += apart if place.sense > 0 else -apart
        off += (state.tooth_moment_errors[j] + 16.0 * EPS + angle_error(size)) * (np.abs(pull) + apart)
    mass, _ = mass_and_inertia(train, n, planet, sizes)
    round_force = mass * speeds.of(carrier) ** 2 * sizes[structure.meshes[structure.pin_meshes[planet]].name].distance
    off += 16.0 * EPS * round_force
    return np.hypot(along + round_force, across), off
