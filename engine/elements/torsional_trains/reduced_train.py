"""A train's numbers reduced to the shaft of its first mass, node by node."""

from typing import NamedTuple

import numpy as np

from engine.cycle.measured import Measured
from engine.elements.compliances.reduction import in_series, reduced_part
from engine.elements.element import Element, Numbers
from engine.laws.rounding import EPS


class ReducedTrain(NamedTuple):
    """A train reduced to the shaft of its first mass, for a set of variants.

    Attributes
    ----------
    parents : ndarray of int (nodes,)
        Parent of each node, with a lower index; -1 for the first.
    inertias : ndarray (nodes, variants)
        [kg·m²].
    mass_damping : ndarray (nodes, variants)
        Damping relative to the frame [N·m·s/rad].
    stiffnesses, dampings, absorptions : ndarray (nodes, variants)
        Of the shaft to the parent; 0 for the first node [N·m/rad], [N·m·s/rad], [1].
    ground, ground_damping, ground_loss : ndarray (nodes, variants)
        Of all shafts to the frame [N·m/rad], [N·m·s/rad], and stiffness times energy absorption [N·m/rad].
    ground_shafts : dict of str to tuple of ndarray (variants,)
        The same for each shaft to the frame.
    ratios : dict of str to ndarray (variants,)
        Speed of each mass over that of the first one, with rigid shafts.
    shaft_ratios : dict of str to ndarray (variants,)
        The same for each shaft's first end.
    roundings : ndarray (variants,)
        Relative error estimate of any inertia or stiffness, in multiples of eps.
    """

    parents: np.ndarray
    inertias: np.ndarray
    mass_damping: np.ndarray
    stiffnesses: np.ndarray
    dampings: np.ndarray
    absorptions: np.ndarray
    ground: np.ndarray
    ground_damping: np.ndarray
    ground_loss: np.ndarray
    ground_shafts: dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]
    ratios: dict[str, np.ndarray]
    shaft_ratios: dict[str, np.ndarray]
    roundings: np.ndarray

    def known(self, numbers: np.ndarray) -> Measured:
        """Products of the train's inertias or stiffnesses, with their error estimates."""
        return Measured(numbers, EPS * (self.roundings + 2.0) * np.abs(numbers))


def reduced_train(train: Element, n: Numbers) -> ReducedTrain:
    """Reduce a train to the shaft of its first mass.

    Parameters
    ----------
    train : TorsionalTrain
        The structure; its own numbers are not used.
    n : mapping of str to ndarray (variants,)
        Numbers by their keys, such as "masses.flywheel.inertia".
    """
    layout = train.layout
    one = np.ones_like(n[f"masses.{layout.masses[0]}.damping"])
    ratios = {layout.masses[0]: one}
    for mass, before, joint, forwards in layout.path:
        ratio = n[f"{'gears' if joint in train.gears else 'shafts'}.{joint}.ratio"]
        ratios[mass] = ratios[before] * ratio if forwards else ratios[before] / ratio
    found = ReducedTrain(np.array(layout.parents), *np.zeros((8, len(layout.parents), *one.shape)), {}, ratios, {}, one)
    for mass, node in layout.node_of.items():
        key = f"masses.{mass}.inertia" if train.masses[mass].inertia is not None else "machine.inertia"
        found.inertias[node] += ratios[mass] ** 2 * n[key]
        found.mass_damping[node] += ratios[mass] ** 2 * n[f"masses.{mass}.damping"]
    roundings = np.zeros_like(one)
    for name, shaft in train.shafts.items():
        stiffness, damping, absorption, rounded = _shaft(train, name, n)
        first = shaft.between[0] if shaft.between[0] in ratios else shaft.between[1]
        g = found.shaft_ratios[name] = ratios[first]
        roundings = np.maximum(roundings, rounded)
        if name in layout.grounded:
            node = layout.node_of[layout.grounded[name]]
            held = found.ground_shafts[name] = g**2 * stiffness, g**2 * damping, g**2 * stiffness * absorption
            for total, part in zip((found.ground, found.ground_damping, found.ground_loss), held, strict=True):
                total[node] += part
        else:
            node = layout.shaft_to.index(name)
            found.stiffnesses[node], found.dampings[node] = g**2 * stiffness, g**2 * damping
            found.absorptions[node] = absorption
    if any(mass.inertia is None for mass in train.masses.values()):
        roundings = np.maximum(roundings, n["machine.inertia_error"] / n["machine.inertia"] / EPS)
    # Every joint on the path multiplies by its ratio: rounding of the ratio and of the product.
    any_ratio = bool(train.gears) or any(shaft.ratio != 1.0 for shaft in train.shafts.values())
    roundings = roundings + 4.0 * (len(layout.path) if any_ratio else 0) + 8.0 + 2.0 * len(train.gears)
    return found._replace(roundings=roundings)


def _shaft(train: Element, name: str, n: Numbers) -> tuple[np.ndarray, ...]:
    """Stiffness, damping, energy absorption and rounding of a shaft about the axis of its first end."""
    shaft, path = train.shafts[name], f"shafts.{name}"
    if shaft.parts is not None:
        whole = in_series({key: reduced_part(part, n, f"{path}.parts.{key}") for key, part in shaft.parts.items()})
        return whole.stiffness, whole.damping, whole.absorption, whole.roundings
    stiffness = n[f"{path}.stiffness"]
    none = np.zeros_like(stiffness)
    return stiffness, n.get(f"{path}.damping", none), n.get(f"{path}.energy_absorption", none), none + 1.0
