"""Rack and pinion: pure rolling of the pitch circle along the pitch line, s = r φ, and the force between the teeth.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapters on gearing and on the forces in higher pairs.
"""

from engine.compiling.decorators import scalar


@scalar
def rack_slide(axis: float, start: float, radius: float, turned: float) -> float:
    """Place of a rack along its guide, s = s_axis + s₀ + r φ [m].

    Parameters
    ----------
    axis : float
        Place of the pinion's axis along the guide [m].
    start : float
        How far the rack's origin is beyond the axis at φ = 0 [m].
    radius : float
        Of the pitch circle, signed [m].
    turned : float
        Angle φ of the pinion against what carries the guide [rad].
    """
    return axis + start + radius * turned


@scalar
def pinion_turn(slide: float, axis: float, radius: float) -> float:
    """Angle of a pinion by its rack, φ = (s − s_axis)/r [rad]; its rates follow from theirs in the same way.

    Parameters
    ----------
    slide, axis : float
        Places of the rack and of the pinion's axis along the guide [m].
    radius : float
        Of the pitch circle, signed [m].
    """
    return (slide - axis) / radius
