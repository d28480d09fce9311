"""Angular speeds of a gear train: meshes' equations K ω = 0, and the basic ratios of its planetary stages."""

import numpy as np

from engine.cycle.measured import Measured
from engine.elements.element import Numbers
from engine.elements.gears.gear_elements import GearTrain
from engine.elements.gears.gear_structure import MeshPlace
from engine.elements.gears.mesh_equations import solve
from engine.laws.rounding import EPS


def teeth_of(place: MeshPlace, n: Numbers) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of teeth of both wheels of a mesh, that of a ring negative."""
    first, second = (n[f"wheels.{wheel}.teeth"] for wheel in place.wheels)
    return first, place.sense * second


def train_speeds(train: GearTrain, n: Numbers) -> Measured:
    """Angular speeds that follow from those given.

    Parameters
    ----------
    train : GearTrain
    n : mapping of str to ndarray (variants,)
        Its numbers by their keys.

    Returns
    -------
    Measured (shafts + 1, variants)
        The frame's, 0, stand last: a shaft that is −1 stands still [rad/s]. NaN where none follow.
    """
    structure = train.structure
    equations = structure.equations(np.array([teeth_of(place, n) for place in structure.meshes]))
    count, variants = len(structure.shafts), equations.shape[-1]
    held, driven = structure.number_of(structure.held), structure.number_of(structure.driven)
    rest = [i for i in range(count) if i not in (*held, *driven)]
    given = np.array([n[f"shafts.{name}.speed"] for name in structure.driven])
    given = Measured(given, EPS * np.abs(given))
    # Each given speed by itself: their shares may cancel, and what is left carries the rounding of both.
    shares = solve(equations[:, rest], -equations[:, driven])
    parts = Measured(shares.values, shares.errors) * given
    following = sum(parts[:, k] for k in range(len(driven)))
    values, errors = np.zeros((2, count + 1, variants))
    for rows, speeds in ((driven, given), (rest, following)):
        values[rows], errors[rows] = speeds.value, speeds.error
    return Measured(values, errors)


def basic_ratios(train: GearTrain, n: Numbers) -> dict[str, Measured]:
    """Basic ratios i₀ = (ω_a − ω_h)/(ω_b − ω_h) of a train's planetary stages (Willis).

    Parameters
    ----------
    train : GearTrain
    n : mapping of str to ndarray (variants,)

    Returns
    -------
    dict of str to Measured (variants,)
        As "carrier.basic_ratio_of_sun_to_ring" by the names of carriers and wheels.
    """
    found = {}
    for name, a, b, path in stages(train):
        ratio = Measured(np.ones(next(iter(n.values())).size))
        start = train.structure.meshes[path[0]]
        at = (start.first, start.second)[start.central]
        for place in (train.structure.meshes[j] for j in path):
            z_a, z_b = (Measured(z) for z in teeth_of(place, n))
            forwards = place.first == at
            ratio = ratio * (-z_b / z_a if forwards else -z_a / z_b)
            at = place.second if forwards else place.first
        found[f"{name}.basic_ratio_of_{a}_to_{b}"] = ratio
    return found


def stages(train: GearTrain) -> list[tuple[str, str, str, tuple[int, ...]]]:
    """Carrier, central wheels and meshes between them for every basic ratio of a train."""
    found = []
    for carrier, paths in train.structure.central_paths.items():
        for path in paths:
            ends = [train.structure.meshes[j] for j in (path[0], path[-1])]
            a, b = (end.wheels[end.central] for end in ends)
            if a != b:
                found.append((carrier, a, b, path))
    return found
