"""Friction in prismatic pairs: flat, V and cylindrical guides, tilting sliders, overhung sliders that jam.

A slider of length 2 a, pressed on its guide by a force N and turned by a moment M about its middle, bears as if on its
two edges: (N + M/a)/2 at the front and (N - M/a)/2 at the rear. While both press on the same face the pressure is
distributed between them, and F = f N for any distribution. Where |M| > |N| a the slider tilts, its edges bear on
opposite faces of the guide and F = f |M|/a.

Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines, friction in kinematic pairs; K. V. Frolov et al.,
Theory of Mechanisms and Machines.
"""

import math

from engine.compiling.decorators import scalar


@scalar
def vee_friction(friction: float, half_angle: float) -> float:
    """Equivalent coefficient of friction of a V guide, for the force pressing the slider into it: f/sin(gamma).

    For a cylinder in a half-round guide use the factors WORN_IN and NEW of `engine.laws.friction.coefficients` instead.

    Parameters
    ----------
    friction, half_angle : float
        f of a face, half of the angle between the faces gamma [rad]; pi/2 for a flat guide.
    """
    return friction / math.sin(half_angle)


@scalar
def edge_forces(normal: float, moment: float, half_length: float) -> tuple[float, float]:
    """Forces of the guide on the front and rear edge of a slider, positive on the face that N loads.

    Parameters
    ----------
    normal, moment : float
        N [N], and M about the slider's middle [N·m], positive where it presses the front.
    half_length : float
        a [m].

    Returns
    -------
    front, rear : float
        [N]; of opposite sign where the slider tilts.
    """
    tilting = moment / half_length
    return (normal + tilting) / 2, (normal - tilting) / 2


@scalar
def slider_friction(normal: float, moment: float, half_length: float, friction: float) -> float:
    """Friction of a slider under force and moment: f (|N1| + |N2|), with N1 and N2 on its edges.

    Parameters
    ----------
    normal, moment, half_length : float
        N [N], M about the slider's middle [N·m], half of its length a [m].
    friction : float
        f; for a V or cylindrical guide the equivalent coefficient.

    Returns
    -------
    float
        [N]: f |N|, or f |M|/a where the slider tilts.
    """
    front, rear = edge_forces(normal, moment, half_length)
    return friction * (abs(front) + abs(rear))


@scalar
def tilts(normal: float, moment: float, half_length: float) -> float:
    """1 if the edges of a slider bear on opposite faces of the guide, |M| > |N| a, otherwise 0.

    Parameters
    ----------
    normal, moment, half_length : float
        N [N], M about the slider's middle [N·m], half of its length a [m].
    """
    return 1.0 if abs(moment) > abs(normal) * half_length else 0.0


@scalar
def jamming_overhang(half_length: float, friction: float) -> float:
    """Overhang of the driving force beyond which a slider jams: a/f, its length divided by 2 f.

    The friction at the two edges has no resultant moment about the middle of the guide, so the guide's height doesn't
    matter.

    Parameters
    ----------
    half_length, friction : float
        a [m], f.
    """
    return half_length / friction


@scalar
def overhung_drive(resistance: float, normal: float, overhang: float, half_length: float, friction: float) -> float:
    """Force along the guide that moves a slider against a resistance: P = Q + f max(|N|, P e/a).

    Parameters
    ----------
    resistance : float
        Q >= 0, along the middle of the guide [N].
    normal : float
        N, perpendicular to the guide at the slider's middle [N].
    overhang : float
        Distance e of P from the middle of the guide [m].
    half_length, friction : float
        a [m], f.

    Returns
    -------
    float
        P [N]; infinite where the slider jams, e >= a/f.
    """
    left = 1 - friction * abs(overhang) / half_length
    if left <= 0.0:
        return math.inf
    return max(resistance + friction * abs(normal), resistance / left)


@scalar
def guide(
    load: float, resistance: float, overhang: float, length: float, friction: float, vee: float, factor: float
) -> tuple[float, float, float, float, float, float, float, float]:
    """Slider on its guide: its results in order."""
    half, reduced = length / 2, factor * vee_friction(friction, vee / 2)
    drive = overhung_drive(resistance, load, overhang, half, reduced)
    front, rear = edge_forces(load, drive * overhang, half)
    return (
        reduced,
        drive,
        slider_friction(load, drive * overhang, half, reduced),
        front,
        rear,
        tilts(load, drive * overhang, half),
        jamming_overhang(half, reduced),
        resistance / drive,
    )
