"""Stiffness and damping of parts reduced to one shaft, in series and in parallel, and each part's share of the whole.

With i the speed of a part's axis over that of the shaft reduced to, stiffness and damping are reduced with i², a moment
with i. Compliances add in series, stiffnesses in parallel. The energy that a damper dissipates is proportional to the
square of its own twist. So dampings in series do not add as compliances do, but as Σ b_j (δ_j/δ)², where δ_j/δ is the
part's share of the twist; this assumes that damping hardly changes these shares.

Source: K. V. Frolov et al., Theory of Mechanisms and Machines (elastic links; reduction of stiffnesses).
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from engine.elements.compliances.elastic_parts import ElasticPart, ParallelPart, SeriesPart, ShaftPart
from engine.elements.element import Numbers


class ReducedPart(NamedTuple):
    """A part, or a group of parts, reduced to another shaft.

    Attributes
    ----------
    stiffness, damping : ndarray (variants,)
        [N·m/rad], [N·m·s/rad]; the frequency-independent part of the damping.
    absorption : ndarray (variants,)
        Fraction ψ of the maximum energy that the other dampers dissipate in a cycle.
    roundings : ndarray (variants,)
        Relative error estimate of the stiffness, in multiples of eps: rounding of the numbers and of the calculation.
    within : dict of str to PartShare
        Shares of all single parts, by their paths such as "key" or "gearbox.parts.first".
    """

    stiffness: np.ndarray
    damping: np.ndarray
    absorption: np.ndarray
    roundings: np.ndarray
    within: dict[str, "PartShare"]


class PartShare(NamedTuple):
    """A part's share of the whole.

    Attributes
    ----------
    stiffness : ndarray (variants,)
        Stiffness about its own axis [N·m/rad].
    energy : ndarray (variants,)
        Share of the energy of the whole; in series, share of the compliance.
    moment, twist : ndarray (variants,)
        About its own axis, relative to the moment [1] and to the twist [1] of the whole.
    """

    stiffness: np.ndarray
    energy: np.ndarray
    moment: np.ndarray
    twist: np.ndarray


def _roundings(part: ElasticPart, n: Numbers, path: str, none: np.ndarray) -> np.ndarray:
    """Rounding of a part's stiffness: of a few numbers and operations, and of a thin wall between two diameters."""
    if not isinstance(part, ShaftPart):
        return none + 8.0
    diameter, bore = n[f"{path}.diameter"], n[f"{path}.bore"]
    with np.errstate(divide="ignore"):
        return 12.0 + np.abs((diameter + bore) / (diameter - bore))


def reduced_part(part: ElasticPart, n: Numbers, path: str) -> ReducedPart:
    """A part reduced to the shaft relative to which its ratio is defined.

    Parameters
    ----------
    part : ElasticPart
        The kind; its own numbers are not used.
    n : mapping of str to ndarray (variants,)
        Numbers by their paths.
    path : str
        Path of the part.
    """
    ratio = n[f"{path}.ratio"]
    if isinstance(part, (SeriesPart, ParallelPart)):
        inner = {name: reduced_part(p, n, f"{path}.parts.{name}") for name, p in part.parts.items()}
        whole = in_series(inner) if isinstance(part, SeriesPart) else in_parallel(inner)
    else:
        found = part.law(*(n[f"{path}.{key}"] for key in part.law_keys))
        # A bore as wide as the shaft has no stiffness.
        stiffness = np.where(found > 0.0, found, math.nan)
        one, none = np.ones_like(stiffness), np.zeros_like(stiffness)
        damping, absorption = (n.get(f"{path}.{key}", none) for key in ("damping", "energy_absorption"))
        share = PartShare(stiffness, one, one, one)
        whole = ReducedPart(stiffness, damping, absorption, _roundings(part, n, path, none), {"": share})
    stiffness, damping = whole.stiffness * ratio**2, whole.damping * ratio**2
    within = {
        name: share._replace(moment=share.moment / ratio, twist=share.twist * ratio)
        for name, share in whole.within.items()
    }
    return ReducedPart(stiffness, damping, whole.absorption, whole.roundings + 4.0, within)


def in_series(parts: Mapping[str, ReducedPart]) -> ReducedPart:
    """Parts in series, by name."""
    compliance = sum(1.0 / part.stiffness for part in parts.values())
    shares = {name: 1.0 / part.stiffness / compliance for name, part in parts.items()}
    damping = sum(part.damping * shares[name] ** 2 for name, part in parts.items())
    return _together(parts, 1.0 / compliance, damping, shares, "twist")


def in_parallel(parts: Mapping[str, ReducedPart]) -> ReducedPart:
    """Parts in parallel, by name."""
    stiffness = sum(part.stiffness for part in parts.values())
    shares = {name: part.stiffness / stiffness for name, part in parts.items()}
    return _together(parts, stiffness, sum(part.damping for part in parts.values()), shares, "moment")


def _together(
    parts: Mapping[str, ReducedPart],
    stiffness: np.ndarray,
    damping: np.ndarray,
    shares: Mapping[str, np.ndarray],
    shared: str,
) -> ReducedPart:
    """Parts with their shares of the energy, which are also those of the twist or the moment, as `shared` says."""
    # Rounding of a sum of terms of one sign: at most that of the worst term, and of the additions.
    roundings = np.max([part.roundings for part in parts.values()], axis=0) + 2.0 * len(parts)
    absorption = sum(part.absorption * shares[name] for name, part in parts.items())
    within = {}
    for name, part in parts.items():
        for path, own in part.within.items():
            changed = {key: getattr(own, key) * shares[name] for key in ("energy", shared)}
            within[f"{name}.parts.{path}" if path else name] = own._replace(**changed)
    return ReducedPart(stiffness, damping, absorption, roundings, within)
