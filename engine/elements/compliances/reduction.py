"""Stiffness and damping of parts reduced to one shaft, in series and in parallel, and each part's share in the whole.

With i the speed of a part's axis over that of the shaft that all is reduced to, stiffness and damping are reduced with
i², a moment with i. In series compliances add and in parallel stiffnesses do. What a damper dissipates goes with the
square of its own twist, so that in series dampings don't add as compliances would but as Σ b_j (δ_j/δ)², with δ_j/δ the
part's share of the twist; that holds as long as damping hardly changes how the twist is shared.

Source: K. V. Frolov et al., Theory of Mechanisms and Machines (elastic links; reduction of stiffnesses).
"""

import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from engine.elements.compliances.elastic_parts import (
    CouplingPart,
    ElasticPart,
    MeshPart,
    ParallelPart,
    RodPart,
    SeriesPart,
    ShaftPart,
    StrandPart,
)
from engine.elements.compliances.stiffnesses import at_radius, damping_of_absorption, rod_stiffness, shaft_stiffness
from engine.elements.element_numbers import Numbers


class ReducedPart(NamedTuple):
    """A part, or parts together, as another shaft feels them.

    Attributes
    ----------
    stiffness, damping : ndarray (variants,)
        [N·m/rad], [N·m·s/rad]; the damping that doesn't depend on a frequency.
    absorption : ndarray (variants,)
        Share ψ of the greatest energy that the others dissipate in a cycle.
    roundings : ndarray (variants,)
        What the stiffness may be off by, over eps of it: that of the numbers with that of the calculation.
    within : dict of str to PartShare
        Of all parts that aren't made of others, by their paths such as "key" or "gearbox.parts.first".
    """

    stiffness: np.ndarray
    damping: np.ndarray
    absorption: np.ndarray
    roundings: np.ndarray
    within: dict[str, "PartShare"]


class PartShare(NamedTuple):
    """What a part is in the whole.

    Attributes
    ----------
    stiffness : ndarray (variants,)
        About its own axis [N·m/rad].
    energy : ndarray (variants,)
        Its share of the energy of the whole, which in series is that of the compliance.
    moment, twist : ndarray (variants,)
        About its own axis, over the moment [1] and over the twist [1] of the whole.
    """

    stiffness: np.ndarray
    energy: np.ndarray
    moment: np.ndarray
    twist: np.ndarray


def part_keys(part: ElasticPart, path: str) -> Iterator[str]:
    """Paths of all numbers that a part, or what it is made of, is given."""
    own = {
        ShaftPart: ("diameter", "bore", "length", "shear_modulus"),
        RodPart: ("area", "length", "elastic_modulus", "radius", "strands"),
        StrandPart: ("stiffness", "radius"),
        MeshPart: ("mesh_stiffness", "width", "base_radius"),
        CouplingPart: ("stiffness",),
    }
    for key in ("ratio", *own.get(type(part), ())):
        yield f"{path}.{key}"
    for key in ("damping", "energy_absorption"):
        if getattr(part, key) is not None:
            yield f"{path}.{key}"
    if isinstance(part, (SeriesPart, ParallelPart)):
        for name, inner in part.parts.items():
            yield from part_keys(inner, f"{path}.parts.{name}")


def leaf_paths(parts: Mapping[str, ElasticPart], path: str = "") -> Iterator[str]:
    """Paths of all parts that aren't made of others."""
    for name, part in parts.items():
        if isinstance(part, (SeriesPart, ParallelPart)):
            yield from leaf_paths(part.parts, f"{path}{name}.parts.")
        else:
            yield f"{path}{name}"


def _own_stiffness(part: ElasticPart, n: Numbers, path: str) -> np.ndarray:
    """Torsional stiffness about a part's own axis."""

    def numbers(*keys: str) -> Iterator[np.ndarray]:
        return (n[f"{path}.{key}"] for key in keys)

    match part:
        case ShaftPart():
            found = shaft_stiffness(*numbers("diameter", "bore", "length", "shear_modulus"))
        case RodPart():
            strands, radius = numbers("strands", "radius")
            found = at_radius(strands * rod_stiffness(*numbers("area", "length", "elastic_modulus")), radius)
        case StrandPart():
            found = at_radius(*numbers("stiffness", "radius"))
        case MeshPart():
            per_width, width, radius = numbers("mesh_stiffness", "width", "base_radius")
            found = at_radius(per_width * width, radius)
        case _:
            (found,) = numbers("stiffness")
    # A bore as wide as the shaft leaves nothing.
    return np.where(found > 0.0, found, math.nan)


def _roundings(part: ElasticPart, n: Numbers, path: str, none: np.ndarray) -> np.ndarray:
    """Roundings of a part's stiffness: of a few numbers and steps, and of a thin wall between two diameters."""
    if not isinstance(part, ShaftPart):
        return none + 8.0
    diameter, bore = n[f"{path}.diameter"], n[f"{path}.bore"]
    with np.errstate(divide="ignore"):
        return 12.0 + np.abs((diameter + bore) / (diameter - bore))


def _most_rounded(parts: Mapping[str, ReducedPart]) -> np.ndarray:
    """Roundings of a sum of terms of one sign: no more than of the worst of them, and those of the sum."""
    return np.max([part.roundings for part in parts.values()], axis=0) + 2.0 * len(parts)


def reduced_part(part: ElasticPart, n: Numbers, path: str) -> ReducedPart:
    """A part as the shaft feels it from which its ratio is counted.

    Parameters
    ----------
    part : ElasticPart
        Its kind; its numbers are not used.
    n : mapping of str to ndarray (variants,)
        Numbers by their paths.
    path : str
        Of the part among them.
    """
    ratio = n[f"{path}.ratio"]
    if isinstance(part, (SeriesPart, ParallelPart)):
        inner = {name: reduced_part(p, n, f"{path}.parts.{name}") for name, p in part.parts.items()}
        whole = in_series(inner) if isinstance(part, SeriesPart) else in_parallel(inner)
    else:
        stiffness = _own_stiffness(part, n, path)
        one, none = np.ones_like(stiffness), np.zeros_like(stiffness)
        damping, absorption = (n.get(f"{path}.{key}", none) for key in ("damping", "energy_absorption"))
        share = PartShare(stiffness, one, one, one)
        whole = ReducedPart(stiffness, damping, absorption, _roundings(part, n, path, none), {"": share})
    square = ratio**2
    within = {
        name: share._replace(moment=share.moment / ratio, twist=share.twist * ratio)
        for name, share in whole.within.items()
    }
    return ReducedPart(
        whole.stiffness * square, whole.damping * square, whole.absorption, whole.roundings + 4.0, within
    )


def in_series(parts: Mapping[str, ReducedPart]) -> ReducedPart:
    """Parts one after another.

    Parameters
    ----------
    parts : mapping of str to ReducedPart
    """
    compliance = sum(1.0 / part.stiffness for part in parts.values())
    shares = {name: 1.0 / part.stiffness / compliance for name, part in parts.items()}
    damping = sum(part.damping * shares[name] ** 2 for name, part in parts.items())
    within = {
        key: share._replace(energy=share.energy * shares[name], twist=share.twist * shares[name])
        for name, part in parts.items()
        for key, share in _named(name, part)
    }
    return ReducedPart(1.0 / compliance, damping, _absorbed(parts, shares), _most_rounded(parts), within)


def in_parallel(parts: Mapping[str, ReducedPart]) -> ReducedPart:
    """Parts side by side.

    Parameters
    ----------
    parts : mapping of str to ReducedPart
    """
    stiffness = sum(part.stiffness for part in parts.values())
    shares = {name: part.stiffness / stiffness for name, part in parts.items()}
    within = {
        key: share._replace(energy=share.energy * shares[name], moment=share.moment * shares[name])
        for name, part in parts.items()
        for key, share in _named(name, part)
    }
    damping = sum(part.damping for part in parts.values())
    return ReducedPart(stiffness, damping, _absorbed(parts, shares), _most_rounded(parts), within)


def _absorbed(parts: Mapping[str, ReducedPart], shares: Mapping[str, np.ndarray]) -> np.ndarray:
    """Energy absorption of the whole: that of every part by its share of the energy."""
    return sum(part.absorption * shares[name] for name, part in parts.items())


def _named(name: str, part: ReducedPart) -> Iterator[tuple[str, PartShare]]:
    for path, share in part.within.items():
        yield (f"{name}.parts.{path}" if path else name), share


def damping_and_absorption(whole: ReducedPart, frequency: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All dampers of a whole at one frequency, as a damping and as an energy absorption.

    Parameters
    ----------
    whole : ReducedPart
    frequency : ndarray (variants,)
        Of the vibration [rad/s].

    Returns
    -------
    damping, absorption : ndarray (variants,)
        [N·m·s/rad], [1].
    """
    damping = whole.damping + damping_of_absorption(whole.absorption, whole.stiffness, frequency)
    return damping, damping * math.tau * frequency / whole.stiffness
