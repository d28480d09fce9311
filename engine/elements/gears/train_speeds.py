"""Angular speeds of a gear train: mesh equations K ω = 0, and the basic ratios of planetary stages."""

import numpy as np

from engine.cycle.measured import Measured
from engine.elements.element import Element, Numbers
from engine.elements.gears.gear_structure import MeshPlace, PlanetaryPath
from engine.elements.gears.small_systems import solve
from engine.laws.rounding import EPS


def teeth_of(place: MeshPlace, n: Numbers) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of teeth of both wheels of a mesh, negative for a ring."""
    first, second = (n[f"wheels.{wheel}.teeth"] for wheel in place.wheels)
    return first, place.sense * second


def train_speeds(train: Element, n: Numbers) -> Measured:
    """All angular speeds for the given ones.

    Parameters
    ----------
    train : GearTrain
    n : mapping of str to ndarray (variants,)
        Numbers by their keys.

    Returns
    -------
    Measured (shafts + 1, variants)
        [rad/s]; the last row is the frame's, 0, so that index −1 is at rest. NaN if the speeds are not determined.
    """
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
