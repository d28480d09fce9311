"""Losses of teeth against the integral of sliding along the path of contact."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from engine.elements.gears.tooth_laws import TeethInMesh, mesh_efficiency, mesh_geometry


def mesh(z1, z2, sense=1, angle=20.0, helix=0.0, shifts=(0.0, 0.0)):
    numbers = (np.asarray(z, float) for z in (z1, z2))
    return TeethInMesh(*numbers, sense, *np.radians([angle, helix]), *(np.asarray(x, float) for x in shifts))


def efficiency(teeth, friction):
    return mesh_efficiency(teeth, mesh_geometry(teeth).contact, np.asarray(friction))


def lost_share(teeth, tips, angle, friction):
    """Work of friction over work passed on, module 1: pairs of teeth share the load equally, one pitch of contact.

    Between places where a pair comes or goes, or the pitch point is passed, what is lost goes linearly along the path.
    Helical teeth press along the normal of their flanks, which leans by β_b, tan β_b = tan β cos α_t.
    """
    z, sense, beta = (float(teeth.first), float(teeth.second)), teeth.sense, float(teeth.helix_angle)
    alpha = math.atan(math.tan(float(teeth.pressure_angle)) / math.cos(beta))
    base = [n / math.cos(beta) * math.cos(alpha) / 2 for n in z]
    # Lengths of contact on both sides of the pitch point, along the line of action.
    first, second = (
        side * (math.sqrt(tip**2 - b**2) - b * math.tan(angle))
        for side, tip, b in zip((1, sense), tips, base, strict=True)
    )
    pitch = math.pi / math.cos(beta) * math.cos(alpha)
    steps = range(-8, 9)
    ends = {-second, first, 0.0, *(end + k * pitch for k in steps for end in (-second, first))}
    places = sorted(end for end in ends if -second <= end <= first)
    work = 0.0
    for a, b in itertools.pairwise(places):
        middle = (a + b) / 2
        pairs = sum(-second < middle + k * pitch < first for k in steps)
        work += abs(middle) * (b - a) / pairs
    sliding, lean = 1 / base[0] + sense / base[1], math.atan(math.tan(beta) * math.cos(alpha))
    return friction / math.cos(lean) * work * sliding / pitch, first / pitch, second / pitch


@given(
    z1=st.integers(18, 80),
    more=st.integers(0, 80),
    sense=st.sampled_from([1, -1]),
    angle=st.floats(15.0, 27.0),
    helix=st.sampled_from([0.0, 20.0, 35.0]),
    shifts=st.tuples(st.floats(-0.3, 0.9), st.floats(-0.3, 0.9)),
)
@settings(max_examples=40, deadline=None)
def test_mesh_loss_and_contact_ratio__are_lengths_and_work_along_the_line_of_action(
    z1, more, sense, angle, helix, shifts
):
    teeth = mesh(z1, z1 + more + (15 if sense < 0 else 0), sense, angle, helix, shifts)
    found = mesh_geometry(teeth)
    assume(np.isfinite(found.distance) and not found.interferes and sum(found.contact) >= 1)
    tips = [float(d) / 2 for d in found.tips]
    exact, *shares = lost_share(teeth, tips, float(found.angle), 0.05)
    assert [float(e) for e in found.contact] == pytest.approx(shares, abs=1e-10)
    assert 1 - efficiency(teeth, 0.05) == pytest.approx(exact, rel=1e-9)
