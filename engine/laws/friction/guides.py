"""Sliders on their guides: the forces on both edges.

A slider of length 2 a, pressed on its guide by a force N and turned by a moment M about its middle, bears as if on its
two edges: (N + M/a)/2 at the front and (N − M/a)/2 at the rear. While both press on the same face the pressure is
distributed between them, and F = f N for any distribution. Where |M| > |N| a the slider tilts, its edges bear on
opposite faces of the guide and F = f |M|/a.

Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines, friction in kinematic pairs; K. V. Frolov et al.,
Theory of Mechanisms and Machines.
"""

import numpy as np

Value = float | np.ndarray


def edge_forces(normal: Value, moment: Value, half_length: Value) -> tuple[Value, Value]:
    """Forces of the guide on the front and rear edge of a slider, positive on the face that N loads."""
    tilting = moment / half_length
    return (normal + tilting) / 2, (normal - tilting) / 2
