"""Effects of external torques on a gear train: powers, losses, efficiency in both directions, tooth and pin forces."""

from typing import NamedTuple

import numpy as np

from engine.cycle.measured import Measured, maximum, minimum, where
from engine.elements.element import Element, NamedRows
from engine.elements.gears.gear_structure import STANDS_STILL
from engine.elements.gears.tooth_laws import ToothForces, mesh_efficiency, tooth_forces
from engine.elements.gears.train_inertia import mass_and_inertia
from engine.elements.gears.train_moments import TrainMoments, train_moments
from engine.elements.gears.train_variants import MeshSizes, TrainVariants, angle_error
from engine.laws.rounding import EPS
from engine.words.quantity import Quantity, main_result

TOOTH_FORCES = ("tangential", "radial", "axial", "normal")


def pinned_planets(train: Element) -> list[str]:
    """Planets that mesh only with central wheels of a carrier in the frame, in a train with modules."""
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


def mesh_efficiencies(v: TrainVariants) -> np.ndarray:
    """Efficiencies of all meshes with their carriers at rest (meshes, variants)."""
    found = []
    for place in v.structure.meshes:
        size, at = v.sizes[place.name], f"meshes.{place.name}"
        if v.train.meshes[place.name].friction is not None:
            found.append(mesh_efficiency(size.teeth, size.geometry.contact, v.n[f"{at}.friction"]))
        else:
            found.append(v.n.get(f"{at}.efficiency", np.ones_like(size.module)))
    return np.array(found)


class Equilibria(NamedTuple):
    """Equilibrium of a train under its torques, forwards and backwards; efficiencies of its meshes."""

    forwards: TrainMoments
    backwards: TrainMoments
    efficiencies: np.ndarray


def equilibria(v: TrainVariants) -> Equilibria:
    """Equilibrium of a train in both directions of rotation."""
    efficiencies = mesh_efficiencies(v)
    return Equilibria(*(train_moments(v, efficiencies, backwards) for backwards in (False, True)), efficiencies)


def load_results(v: TrainVariants, states: Equilibria) -> NamedRows:
    """All results that depend on torques."""
    train, structure, speeds, state = v.train, v.structure, v.speeds, states.forwards
    power = state.moments * speeds[:-1]
    for i, name in enumerate(structure.shafts):
        if name in structure.unknown_moments or train.shafts[name].moment is not None:
            yield main_result(f"{name}.moment", f"external torque on {name}", "N m"), state.moments[i]
            yield main_result(f"{name}.power", f"input power at {name}", "W"), power[i]
    # Held shafts belong to the frame.
    free = [i for i, name in enumerate(structure.shafts) if name not in structure.held]
    words = "torque that holds the frame and all held shafts"
    yield Quantity("frame.moment", words, "N m"), 0.0 - state.moments[free].sum()
    into = maximum(power, 0.0).sum()
    yield Quantity("input_power", "input power", "W"), into
    yield main_result("loss", "power lost in all meshes", "W"), power.sum()
    words = "output power over input power"
    yield main_result("efficiency", words, "1", True), _efficiency(power)
    words, back = "efficiency in reverse rotation under the same torques", states.backwards
    backwards = _efficiency(-back.moments * speeds[:-1])
    yield Quantity("backward_efficiency", words, "1", may_be_undefined=True), backwards
    words = "whether the same torques can't turn the train backwards (1 or 0)"
    locks = Measured(np.where(state.moves, np.where(back.moves, 0.0, 1.0), np.nan))
    yield main_result("self_locking", words, "1", exact=True), locks
    words = "circulating power in the shafts over input power"
    circulating = _circulating(v, state, into)
    yield Quantity("circulating_power", words, "1", may_be_undefined=True), circulating
    for j, place in enumerate(structure.meshes):
        name, (a, b), rolling = place.name, place.wheels, state.rolling_powers[j]
        found = Measured(states.efficiencies[j], 32.0 * EPS)
        yield Quantity(f"{name}.efficiency", f"efficiency of {name}, its axes at rest", "1"), found
        yield Quantity(f"{name}.rolling_power", f"power from {a} to {b}, relative to the carrier", "W"), rolling
        words = f"rolling power of {name} over input power"
        share = where(into.value > 0, abs(rolling) / into, np.nan)
        yield Quantity(f"{name}.rolling_share", words, "1", may_be_undefined=True), share
        if train.has_modules:
            forces = _tooth_forces(v, j, state)
            for part in TOOTH_FORCES:
                words = f"{part} force between the teeth of {name}"
                yield main_result(f"{name}.{part}_force", words, "N"), getattr(forces, part)
    for planet in pinned_planets(train):
        force = _pin_force(v, planet, state)
        yield main_result(f"{planet}.pin_force", f"force on the bearing of each {planet}", "N"), force


def _efficiency(power: Measured) -> Measured:
    """Output power over input power; NaN without input power."""
    out, into = -minimum(power, 0.0).sum(), maximum(power, 0.0).sum()
    return where(into.value > 0, out / into, np.nan)


def _circulating(v: TrainVariants, state: TrainMoments, into: Measured) -> Measured:
    """Maximum power through a shaft in excess of the train's input power, relative to it.

    A shaft in the frame receives power from outside, from every mesh between axes in the frame, and from every
    planetary stage as a whole.
    """
    structure, most = v.structure, 0.0
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
        most = maximum(most, sum(maximum(moment * v.speeds[i], 0.0) for moment in parts.values()))
    share = where(into.value > 0, maximum(most / into - 1.0, 0.0), np.nan)
    return where(share.value <= share.error, Measured(0.0 * share.value, share.error), share)


def _tooth_forces(v: TrainVariants, j: int, state: TrainMoments) -> ToothForces:
    place = v.structure.meshes[j]
    size, sets = v.sizes[place.name], v.planet_sets(place.carrier)
    pulls = (abs(_pull(state, size, j, end)) for end in (0, 1))
    return tooth_forces(maximum(*pulls) / sets, size.geometry.angle, size.teeth)


def _pull(state: TrainMoments, size: MeshSizes, mesh: int, end: int) -> Measured:
    """Tangential force on a wheel of a mesh, for all planets together, with the error estimate of its radius."""
    radius = 0.5 * size.rolling[end]
    return state.tooth_moments[mesh, end] / Measured(radius, (8.0 * EPS + angle_error(size)) * np.abs(radius))


def _pin_force(v: TrainVariants, planet: str, state: TrainMoments) -> Measured:
    """Force on a planet's bearing: tooth forces and centrifugal force."""
    structure = v.structure
    i = structure.shafts.index(planet)
    carrier = structure.carriers[i]
    sets = v.planet_sets(carrier)
    along, across = 0.0, 0.0
    for j, place in enumerate(structure.meshes):
        if i not in (place.first, place.second):
            continue
        size = v.sizes[place.name]
        # Losses shift the contact from the pitch point, but not the moment about the central axis.
        distance = Measured(size.distance, (8.0 * EPS + angle_error(size)) * np.abs(size.distance))
        pull = (0.0 - state.tooth_moments[j, 0] - state.tooth_moments[j, 1]) / (distance * sets)
        apart = tooth_forces(abs(pull), size.geometry.angle, size.teeth).radial
        across = across + pull
        along = along + (apart if place.sense > 0 else -apart)
    mass, _ = mass_and_inertia(v, planet)
    radius = v.sizes[structure.meshes[structure.pin_meshes[planet]].name].distance
    along = along + mass * v.speeds[carrier] ** 2 * radius
    return Measured(np.hypot(along.value, across.value), along.error + across.error)
