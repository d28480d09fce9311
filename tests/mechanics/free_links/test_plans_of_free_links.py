"""Plans of free links: special points, sheets, origins of what slides."""

import numpy as np
import pytest
from matplotlib.text import Text
from plan_machines import EXACT, motion_of

from sweeps.pictures.plans.polygons import velocities
from sweeps.pictures.plans.pose import pose_at
from sweeps.pictures.plans.sheets import kinematic_sheet


def test_special_point__moves_along_two_bars_as_their_outer_joints_do():
    pose = pose_at(motion_of("three bars"), 0.7)
    plan = velocities(pose)
    (special,) = plan.special
    for bar in special.bars:
        outer, inner = (pose.point(name) for name in (bar.outer, bar.inner))
        along = (inner.place - outer.place) / abs(inner.place - outer.place)
        assert abs(((special.place - outer.place).conjugate() * along).imag) < EXACT
        assert (plan.images[special.name].conjugate() * along).real == pytest.approx(
            (outer.v.conjugate() * along).real, abs=EXACT
        )


def test_sheet_of_a_triad__names_its_special_point():
    figure = kinematic_sheet(pose_at(motion_of("three bars"), 0.7), "acceleration")
    texts = [text.get_text() for text in figure.findobj(Text)]
    assert any("special points of Assur: $W$ on 5" in text for text in texts)


def test_origin_of_a_sliding_plate__is_on_its_guide():
    motion = motion_of("sliding plate")
    pose = pose_at(motion, 0.7)
    point, direction = (values[pose.k] for values in motion.guides["slot"])
    assert ((pose.origin("plate").place - point) / direction).imag == pytest.approx(0.01, abs=EXACT)
    assert np.isfinite(pose.origin("plate").a)
