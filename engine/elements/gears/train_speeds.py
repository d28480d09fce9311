"""Angular speeds of a gear train: meshes' equations K ω = 0, and the basic ratios of its planetary stages."""

from math import inf
from typing import NamedTuple

import numpy as np

from engine.elements.element import Numbers
from engine.elements.gears.gear_elements import GearTrain
from engine.elements.gears.gear_structure import STANDS_STILL, MeshPlace
from engine.elements.gears.mesh_equations import solve
from engine.laws.rounding import EPS


class TrainSpeeds(NamedTuple):
    """Angular speeds of all shafts and what they may be off by (shafts, variants) [rad/s]; NaN where none follow."""

    speeds: np.ndarray
    errors: np.ndarray

    def relative(self, shaft: int, carrier: int) -> np.ndarray:
        """Speed of a shaft as seen from a carrier; −1 stands for the frame."""
        return self.of(shaft) - self.of(carrier)

    def of(self, shaft: int) -> np.ndarray:
        """Speed of a shaft, or of the frame."""
        return np.zeros_like(self.speeds[0]) if shaft == STANDS_STILL else self.speeds[shaft]


def teeth_of(place: MeshPlace, n: Numbers) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of teeth of both wheels of a mesh, that of a ring negative."""
    first, second = (n[f"wheels.{wheel}.teeth"] for wheel in place.wheels)
    return first, place.sense * second


def train_speeds(train: GearTrain, n: Numbers) -> TrainSpeeds:
    """Angular speeds that follow from those given.

    Parameters
    ----------
    train : GearTrain
    n : mapping of str to ndarray (variants,)
        Its numbers by their keys.
    """
    structure = train.structure
    count, meshes = len(structure.shafts), len(structure.meshes)
    variants = next(iter(n.values())).size
    equations = np.zeros((meshes, count + 1, variants))
    for j, place in enumerate(structure.meshes):
        z_a, z_b = teeth_of(place, n)
        for shaft, value in ((place.first, z_a), (place.second, z_b), (place.carrier, -(z_a + z_b))):
            equations[j, shaft] += value
    held, driven = structure.number_of(structure.held), structure.number_of(structure.driven)
    rest = [i for i in range(count) if i not in (*held, *driven)]
    speeds, errors = np.zeros((2, count, variants))
    for i, name in zip(driven, structure.driven, strict=True):
        speeds[i] = n[f"shafts.{name}.speed"]
    # Each given speed by itself: their shares may cancel, and what is left carries the rounding of both.
    shares = solve(equations[:, rest], -equations[:, driven])
    parts = shares.values * speeds[driven]
    speeds[rest] = parts.sum(axis=1)
    errors[driven] = EPS * np.abs(speeds[driven])
    errors[rest] = (4.0 * EPS * np.abs(parts) + shares.errors * np.abs(speeds[driven])).sum(axis=1)
    return TrainSpeeds(speeds, errors)


def basic_ratios(train: GearTrain, n: Numbers) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Basic ratios i₀ = (ω_a − ω_h)/(ω_b − ω_h) of a train's planetary stages (Willis), and their errors.

    Parameters
    ----------
    train : GearTrain
    n : mapping of str to ndarray (variants,)

    Returns
    -------
    dict of str to (ndarray, ndarray)
        As "carrier.basic_ratio_of_sun_to_ring" by the names of carriers and wheels.
    """
    found = {}
    for name, a, b, path in stages(train):
        ratio = np.ones(next(iter(n.values())).size)
        start = train.structure.meshes[path[0]]
        at = (start.first, start.second)[start.central]
        for place in (train.structure.meshes[j] for j in path):
            z_a, z_b = teeth_of(place, n)
            forwards = place.first == at
            ratio = ratio * (-z_b / z_a if forwards else -z_a / z_b)
            at = place.second if forwards else place.first
        found[f"{name}.basic_ratio_of_{a}_to_{b}"] = ratio, 2 * len(path) * EPS * np.abs(ratio)
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


def speed_ratio(speeds: np.ndarray, driver: int, shaft: int) -> np.ndarray:
    """Speed of a driven shaft over that of another; infinite where that stands."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = speeds[driver] / speeds[shaft]
    return np.where(np.isinf(ratio), inf, ratio)
