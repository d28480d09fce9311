"""What is computed of a locomotive's driving axle: balance weights, and the unbalance that they can't take.

Per cylinder, a share of the masses at the crankpin is balanced by weights that turn. Along the track remains
what isn't balanced, s_rot and c being the shares,

    F = ω² r Re Σ ((1 − s_rot) m_rot + (1 − c) m_rec) exp(i(φ + α_k)),

which varies the tractive effort and, with the cylinders' places as arms, sways the locomotive. Upright act all rotating
masses and weights, those for the reciprocating masses with nothing against them: the hammer blow in either wheel's
plane is that of the weights for c m_rec, and of what s_rot leaves or takes too much of m_rot.

For two cylinders at a right angle these are the textbook's √2 (1 − c) m_rec ω² r, (a/√2) (1 − c) m_rec ω² r and
B ω² b.

Sources: R. S. Khurmi and J. K. Gupta, Theory of Machines, chapter 22 (balancing of locomotives); S. S. Rattan, Theory
of Machines, chapter 14.
"""

from functools import partial

import numpy as np

from engine.elements.element_laws import ElementResult, LawOfArrays, with_nudges
from engine.elements.engines.locomotive_element import USUAL_THROW_ANGLES, LocomotiveElement
from engine.elements.rotors.unbalance import Resultant, unbalance_in_two_planes

_KEYS = (
    "cylinder_spacing", "wheel_spacing", "stroke", "rotating_mass", "reciprocating_mass", "balanced_rotating",
    "balanced_reciprocating", "balance_radius", "speed",
)  # fmt: skip

_SIDES = ("left", "right")
_RESULTS = (
    *(ElementResult(f"{side}_balance_mass", f"balance weight in the {side} wheel", "kg") for side in _SIDES),
    *(
        ElementResult(
            f"{side}_balance_angle",
            f"angle of the balance weight in the {side} wheel, from the first throw in the sense of rotation",
            "rad",
        )
        for side in _SIDES
    ),
    ElementResult("tractive_variation", "greatest unbalanced force along the track", "N"),
    ElementResult("swaying_couple", "greatest unbalanced couple about the upright axis", "N m"),
    *(ElementResult(f"{side}_hammer_blow", f"greatest change of the {side} wheel's load", "N") for side in _SIDES),
    ElementResult("least_wheel_load", "least load of a wheel, negative where it lifts off", "N", "wheel_load"),
    ElementResult("lift_off_speed", "angular speed at which a wheel lifts off", "rad s-1", "wheel_load", True),
    ElementResult("primary_force", "unbalanced primary force of the first cylinder there", "N", "crank_angle"),
    ElementResult("tractive_force", "unbalanced force along the track there", "N", "crank_angle"),
    ElementResult("swaying_moment", "unbalanced couple about the upright axis there", "N m", "crank_angle"),
    *(
        ElementResult(f"{side}_rail_force", f"unbalanced upward force in the {side} wheel there", "N", "crank_angle")
        for side in _SIDES
    ),
)


def locomotive_law(element: LocomotiveElement) -> LawOfArrays:
    """The law of a locomotive's axle.

    Parameters
    ----------
    element : LocomotiveElement
    """
    usual = {
        "throw_angle": USUAL_THROW_ANGLES[element.cylinders],
        "wheel_load": np.nan,
        "crank_angle": 0.0,
    }
    return LawOfArrays(
        with_nudges(partial(_rows, element.cylinders)),
        lambda own, given: (
            *(given(key) for key in _KEYS),
            *(other if getattr(own, key) is None else given(key) for key, other in usual.items()),
        ),
        _RESULTS,
    )


def _rows(cylinders: int, numbers: np.ndarray) -> np.ndarray:
    """Results (results, variants) from numbers (numbers, variants)."""
    apart, track, stroke, rotating, reciprocating, s_rot, c, radius, speed, between, load, phi = numbers
    count, square = np.arange(cylinders)[:, None], speed**2
    pins = stroke / 2 * np.exp(1j * count * between)
    arms = (count - (cylinders - 1) / 2) * apart
    taken, upright = s_rot * rotating + c * reciprocating, (s_rot - 1) * rotating + c * reciprocating
    along = (1 - s_rot) * rotating + (1 - c) * reciprocating
    pull, sway = along * pins.sum(axis=0) * square, along * (arms * pins).sum(axis=0) * square
    weights = [-taken * part for part in _in_wheels(pins, arms, track)]
    blows = [-upright * part * square for part in _in_wheels(pins, arms, track)]
    blow, turned = np.maximum(*np.abs(blows)), np.exp(1j * phi)
    with np.errstate(divide="ignore", invalid="ignore"):
        lifts = speed * np.sqrt(load / blow)
    return np.stack(
        [
            *(np.abs(weight) / radius for weight in weights),
            *(np.angle(weight) for weight in weights),
            np.abs(pull),
            np.abs(sway),
            *np.abs(blows),
            load - blow,
            lifts,
            along * stroke / 2 * square * np.cos(phi),
            (pull * turned).real,
            (sway * turned).real,
            *((part * turned).imag for part in blows),
        ]
    )


def _in_wheels(pins: np.ndarray, arms: np.ndarray, track: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What unit masses at the crankpins amount to in the planes of the left and the right wheel."""
    resultant = Resultant(pins.sum(axis=0), (arms * pins).sum(axis=0), np.zeros(()))
    return unbalance_in_two_planes(resultant, -track / 2, track / 2)
