"""Transmission angle of four-bars whose links can all lie in line."""

import numpy as np
import pytest

from sweeps.synthesis.positioned import least_transmission


def test_change_point__has_no_transmission_angle_or_no_linkage():
    # The crank ends in line with coupler and rocker; rounding may put the distance on either side of their difference.
    generator = np.random.default_rng(4)
    found = []
    for crank, coupler, rocker in np.round(generator.uniform(0.1, 0.5, (2000, 3)), 3):
        frame = abs(coupler - rocker) + crank
        if 2.0 * crank + abs(coupler - rocker) < coupler + rocker:
            found.append(least_transmission(crank, coupler, rocker, complex(frame)))
    known = [angle for angle in found if angle is not None]
    assert known
    # acos(1 − x) is √(2 x), with x of some units of rounding over the product of the lengths.
    assert known == pytest.approx([0.0] * len(known), abs=1e-6)
