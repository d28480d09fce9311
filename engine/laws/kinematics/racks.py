"""Rack and pinion: pure rolling of the pitch circle along the pitch line, s = r φ.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapters on gearing and on the forces in higher pairs.
"""

from engine.compiling.decorators import scalar


@scalar
def rack_slide(axis: float, start: float, radius: float, turned: float) -> float:
    """Position of a rack along its guide, s = s_axis + s₀ + r φ [m].

    Parameters
    ----------
    axis : float
        Position of the pinion's axis along the guide [m].
    start : float
        Position of the rack's origin beyond the axis at φ = 0 [m].
    radius : float
        Signed radius of the pitch circle [m].
    turned : float
        Angle φ of the pinion relative to the link with the guide [rad].
    """
    return axis + start + radius * turned


@scalar
def pinion_turn(slide: float, axis: float, radius: float) -> float:
    """Angle of a pinion on its rack, φ = (s − s_axis)/r [rad]; its rates follow from theirs in the same way.

    Parameters
    ----------
    slide, axis : float
        Positions of the rack and of the pinion's axis along the guide [m].
    radius : float
        Signed radius of the pitch circle [m].
    """
    return (slide - axis) / radius
