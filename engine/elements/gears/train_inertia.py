"""Kinetic energy of a gear train and its inertia reduced to any of its shafts."""

import math

import numpy as np

from engine.cycle.measured import Measured
from engine.elements.element import Element, Numbers
from engine.elements.gears.assembly_conditions import MeshSizes
from engine.laws.rounding import EPS

# Rounding of a disc's mass and inertia.
_OF_DISCS = 8


def kinetic_energy(train: Element, n: Numbers, speeds: Measured, sizes: dict[str, MeshSizes]) -> Measured:
    """Kinetic energy ½ Σ (I ω² + m (ω_h a)²) of all shafts and planets (variants,) [J].

    Parameters
    ----------
    train : GearTrain
    n : mapping of str to ndarray (variants,)
    speeds : Measured (shafts + 1, variants)
    sizes : dict of str to MeshSizes
    """
    structure = train.structure
    energy = Measured(np.zeros(speeds.shape[1]))
    for i, name in enumerate(structure.shafts):
        mass, inertia = mass_and_inertia(train, n, name, sizes)
        carrier = structure.carriers[i]
        count = 1.0
        parts = [(inertia, speeds[i])]
        if name in structure.planets:
            count = planet_sets(n, structure.name_of(carrier))
            if name in structure.pin_meshes:
                radius = sizes[structure.meshes[structure.pin_meshes[name]].name].distance
                parts.append((mass * radius**2, speeds[carrier]))
        for moved, speed in parts:
            energy = energy + 0.5 * count * moved * speed**2
    return energy


def planet_sets(n: Numbers, carrier: str) -> np.ndarray:
    """Number of planet sets of a carrier (variants,)."""
    return n.get(f"shafts.{carrier}.planets", np.ones(next(iter(n.values())).size))


def mass_and_inertia(train: Element, n: Numbers, shaft: str, sizes: dict[str, MeshSizes]) -> tuple[Measured, Measured]:
    """Mass and inertia about its own axis of a shaft with its wheels (variants,)."""
    zero = np.zeros(next(iter(n.values())).size)
    mass, inertia = (n.get(f"shafts.{shaft}.{key}", zero) for key in ("mass", "inertia"))
    for name, wheel in train.wheels.items():
        if wheel.shaft != shaft or wheel.width is None:
            continue
        mesh, end = next((m, mesh.between.index(name)) for m, mesh in train.meshes.items() if name in mesh.between)
        diameter, bore = sizes[mesh].diameters[end], n[f"wheels.{name}.bore"]
        disc = n[f"wheels.{name}.density"] * n[f"wheels.{name}.width"] * math.pi / 4.0 * (diameter**2 - bore**2)
        mass, inertia = mass + disc, inertia + disc * (diameter**2 + bore**2) / 8.0
    return Measured(mass, _OF_DISCS * EPS * mass), Measured(inertia, _OF_DISCS * EPS * inertia)
