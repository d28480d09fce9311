"""Kinetic energy of a gear train and its inertia reduced to any of its shafts."""

import math

import numpy as np

from engine.cycle.measured import Measured
from engine.elements.gears.train_variants import TrainVariants
from engine.laws.rounding import EPS

# Rounding of a disc's mass and inertia.
_OF_DISCS = 8


def kinetic_energy(v: TrainVariants) -> Measured:
    """Kinetic energy ½ Σ (I ω² + m (ω_h a)²) of all shafts and planets (variants,) [J]."""
    structure = v.structure
    energy = Measured(np.zeros(v.count))
    for i, name in enumerate(structure.shafts):
        mass, inertia = mass_and_inertia(v, name)
        carrier, count, parts = structure.carriers[i], 1.0, [(inertia, v.speeds[i])]
        if name in structure.planets:
            count = v.planet_sets(carrier)
            if name in structure.pin_meshes:
                radius = v.sizes[structure.meshes[structure.pin_meshes[name]].name].distance
                parts.append((mass * radius**2, v.speeds[carrier]))
        for moved, speed in parts:
            energy = energy + 0.5 * count * moved * speed**2
    return energy


def mass_and_inertia(v: TrainVariants, shaft: str) -> tuple[Measured, Measured]:
    """Mass and inertia about its own axis of a shaft with its wheels (variants,)."""
    train, n, zero = v.train, v.n, np.zeros(v.count)
    mass, inertia = (n.get(f"shafts.{shaft}.{key}", zero) for key in ("mass", "inertia"))
    for name, wheel in train.wheels.items():
        if wheel.shaft != shaft or wheel.width is None:
            continue
        mesh, end = next((m, mesh.between.index(name)) for m, mesh in train.meshes.items() if name in mesh.between)
        diameter, bore = v.sizes[mesh].diameters[end], n[f"wheels.{name}.bore"]
        disc = n[f"wheels.{name}.density"] * n[f"wheels.{name}.width"] * math.pi / 4.0 * (diameter**2 - bore**2)
        mass, inertia = mass + disc, inertia + disc * (diameter**2 + bore**2) / 8.0
    return Measured(mass, _OF_DISCS * EPS * mass), Measured(inertia, _OF_DISCS * EPS * inertia)
