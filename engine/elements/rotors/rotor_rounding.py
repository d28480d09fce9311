"""What rounding does to the results of a rotor: bounds of first order, from the sizes of the terms they are sums of.

All sizes count roundings: a result is off by eps times its size at the most, eps being that of the numbers. Every
number of the rotor is taken as rounded, and every step of the calculation. Arms are differences of positions, which may
cancel, so they are counted with the sum of the positions' sizes; a piece of unbalance is counted with the sizes of its
mass, radius and angle. Which holes get pieces is taken as decided.

Source: J. H. Wilkinson, Rounding Errors in Algebraic Processes (running error analysis).
"""

from typing import NamedTuple

import numpy as np

from engine.elements.element_numbers import Numbers
from engine.elements.rotors.bearings import STANDARD_GRAVITY
from engine.elements.rotors.rotor_element import RotorElement

Columns = dict[str, np.ndarray]

# Roundings of a few steps, and of a few dozen.
FEW, SOME = 8.0, 32.0


class BalancedRotor(NamedTuple):
    """What a rotor's results are made of.

    Attributes
    ----------
    unbalances, positions : ndarray (variants, unbalances)
        Complex [kg·m], and where [m].
    made, planes, radii : ndarray (variants, planes)
        Corrections as made, complex [kg·m], where [m], and the radii [m].
    shares, carried : ndarray (2, variants)
        Of the permissible unbalance, and what the sizes of all corrections add up to, in the bearings' planes [kg·m].
    off : ndarray (planes, variants)
        How far every correction may be off, as a share of it.
    """

    unbalances: np.ndarray
    positions: np.ndarray
    made: np.ndarray
    planes: np.ndarray
    radii: np.ndarray
    shares: np.ndarray
    carried: np.ndarray
    off: np.ndarray


@np.errstate(divide="ignore", invalid="ignore", over="ignore")
def rotor_sizes(rotor: RotorElement, n: Numbers, b: BalancedRotor, columns: Columns) -> Columns:
    """Roundings that the results of a rotor carry.

    Parameters
    ----------
    rotor : RotorElement
        Which unbalances and planes there are.
    n : mapping of str to ndarray (variants,)
        Its numbers.
    b : BalancedRotor
    columns : dict of str to ndarray (variants,)
        Its results.

    Returns
    -------
    dict of str to ndarray (variants,)
    """
    own = np.abs(b.unbalances) * (FEW + np.stack([np.abs(n[f"unbalances.{u}.angle"]) for u in rotor.unbalances], -1))
    bearings = np.abs(n["first_bearing"]) + np.abs(n["second_bearing"])
    span, centre = np.abs(n["second_bearing"] - n["first_bearing"]), np.abs(n["centre"])
    stretched = 1 + bearings / span
    # What a unit of unbalance at a place amounts to in a bearing's plane, with the magnitudes of all lengths.
    reach = ((np.abs(z) + (centre + bearings)[:, None]) / span[:, None] for z in (b.positions, b.planes))
    at_masses, at_planes = (r * stretched[:, None] for r in reach)
    added = _corrections(rotor, n, b, own)
    before = (own * at_masses).sum(axis=-1)
    each = added * at_planes
    after = before + each.sum(axis=-1)
    square = np.square(n["speed"])
    arm = stretched * (centre + bearings) / span
    weight = FEW * n["mass"] * STANDARD_GRAVITY * arm
    allowed = FEW * (1 + arm) * columns["permissible_unbalance"]
    sizes = {
        "unbalance": own.sum(axis=-1),
        "couple": (own * (np.abs(b.positions) + centre[:, None])).sum(axis=-1),
        "permissible_unbalance": FEW * columns["permissible_unbalance"],
        "error_allowance": _room(allowed + after, each.sum(axis=-1), b, columns["error_allowance"]),
        "single_plane": _plane_size(own, np.abs(b.positions) + 2 * centre[:, None], centre, columns),
        "knife_edge_unbalance": FEW * columns["knife_edge_unbalance"],
        "knife_edge_angle": _resting_size(own.sum(axis=-1), columns),
    }
    worst = after + (each * b.off.T).sum(axis=-1)
    for word, size in (("before", before), ("after", after), ("at_worst", worst)):
        quality = size / b.shares.min(axis=0) * np.abs(n["speed"]) / n["mass"]
        sizes[f"quality_{word}"] = quality + FEW * (1 + arm) * columns[f"quality_{word}"]
    for bearing in ("first", "second"):
        for word, size in (("before", before), ("after", after)):
            sizes[f"{bearing}_force_{word}"] = size * square + FEW * columns[f"{bearing}_force_{word}"]
            sizes[f"{bearing}_peak_{word}"] = sizes[f"{bearing}_force_{word}"] + weight
            sizes[f"{bearing}_permissible"] = allowed
    for k, name in enumerate(rotor.planes):
        sizes[f"{name}.mass"] = added[:, k] / b.radii[:, k] + FEW * columns[f"{name}.mass"]
        sizes[f"{name}.angle"] = added[:, k] / np.abs(b.made[:, k]) + SOME
    sizes["correction_mass"] = sum(sizes[f"{name}.mass"] for name in rotor.planes)
    return sizes


def _plane_size(own: np.ndarray, arms: np.ndarray, centre: np.ndarray, columns: Columns) -> np.ndarray:
    """Roundings of the position c + Re(P/U) of a single correction plane."""
    moment, whole = (own * arms).sum(axis=-1), own.sum(axis=-1)
    # P/U is complex: where it is turned from the resultant, its real part is small and its rounding is not.
    arm = np.abs(columns["single_plane"]) + columns["couple"] / columns["unbalance"] + centre
    return (moment + arm * whole) / columns["unbalance"] + FEW * (arm + centre)


def _resting_size(own: np.ndarray, columns: Columns) -> np.ndarray:
    """Roundings of arcsin(m k/D): as m k nears D a little more of it does ever more to the angle."""
    sine = columns["knife_edge_unbalance"] / columns["unbalance"]
    angle = FEW * columns["knife_edge_angle"]
    grows = sine * (own / columns["unbalance"] + FEW) / np.sqrt(np.maximum(1.0 - sine * sine, 0.0))
    return np.where(sine < 1.0, grows + angle, angle)


def _room(size: np.ndarray, carried_size: np.ndarray, b: BalancedRotor, room: np.ndarray) -> np.ndarray:
    """Roundings of the errors that are allowed: of a difference over what the corrections carry."""
    return ((size + np.abs(room) * carried_size) / b.carried).max(axis=0) + FEW * np.abs(room)


def _corrections(rotor: RotorElement, n: Numbers, b: BalancedRotor, own: np.ndarray) -> np.ndarray:
    """Roundings of what is added in the planes (variants, planes)."""
    if len(rotor.planes) == 1:
        wanted = own.sum(axis=-1)[:, None]
    else:
        weights = b.radii**2
        total = weights.sum(axis=-1, keepdims=True)
        arms = b.planes - (weights * b.planes).sum(axis=-1, keepdims=True) / total
        tilt = (weights * arms**2).sum(axis=-1, keepdims=True)
        farthest = np.abs(b.planes).max(axis=-1, keepdims=True)
        lengths = np.abs(b.positions) + np.abs(n["centre"])[:, None] + 2 * farthest
        stretched = 1 + 2 * farthest * np.sqrt(total / tilt)
        moment = (own * lengths).sum(axis=-1, keepdims=True)
        even = own.sum(axis=-1, keepdims=True)
        wanted = SOME / FEW * stretched * weights * (even / total + np.abs(arms) / tilt * moment)
    found = wanted + FEW * np.abs(b.made)
    for k, (name, plane) in enumerate(rotor.planes.items()):
        if plane.holes is not None:
            found[:, k] = np.abs(b.made[:, k]) * (SOME + np.abs(n[f"planes.{name}.first_hole"]))
    return found
