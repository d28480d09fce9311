"""Losses of teeth against the integral of sliding along the path of contact."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.elements.gears.tooth_laws import addendum_contact_ratios, mesh_efficiency

ANGLE, NONE = np.array(math.radians(20)), np.array(0.0)


def lost_share(z1, z2, sense, friction):
    """Work of friction over work passed on, module 1: pairs of teeth share the load equally, one pitch of contact."""
    alpha = math.radians(20)
    base = [z * math.cos(alpha) / 2 for z in (z1, z2)]
    tips = [z1 / 2 + 1, z2 / 2 + sense]
    # Lengths of contact on both sides of the pitch point, along the line of action.
    first = math.sqrt(tips[0] ** 2 - base[0] ** 2) - z1 / 2 * math.sin(alpha)
    second = sense * (math.sqrt(tips[1] ** 2 - base[1] ** 2) - z2 / 2 * math.sin(alpha))
    pitch = math.pi * math.cos(alpha)
    # One pair carries all of it at each instant: contacts a pitch apart, so that any place of the pitch point will do
    # for load shared by halves: ∫ |s| over the path, over the number of pairs in contact.
    s = np.linspace(-second, first, 200_001)
    pairs = np.zeros_like(s)
    for k in range(-3, 4):
        pairs += (s + k * pitch >= -second) & (s + k * pitch <= first)
    sliding = np.abs(s) * (1 / base[0] + sense / base[1])
    work = np.trapezoid(sliding / pairs, s) / pitch
    return friction * work, (first + second) / pitch, first / pitch, second / pitch


@pytest.mark.parametrize(("z1", "z2", "sense"), [(20, 40, 1), (30, 30, 1), (18, 90, 1), (24, 84, -1), (30, 60, -1)])
def test_contact_ratios__are_lengths_of_the_line_of_action(z1, z2, sense):
    _, _, first, second = lost_share(z1, z2, sense, 0.05)
    e1, e2 = addendum_contact_ratios(np.array(z1), np.array(z2), sense, ANGLE, NONE)
    assert e1 == pytest.approx(first, rel=1e-12)
    assert e2 == pytest.approx(second, rel=1e-12)


@pytest.mark.parametrize(("z1", "z2", "sense"), [(20, 40, 1), (30, 30, 1), (18, 90, 1)])
def test_mesh_loss__is_the_work_of_sliding(z1, z2, sense):
    """With two pairs sharing the load the integral is Niemann's formula; steps of the grid leave some 1e-4."""
    exact, *_ = lost_share(z1, z2, sense, 0.05)
    eta = mesh_efficiency(np.array(z1), np.array(z2), sense, np.array(0.05), ANGLE, NONE)
    assert 1 - eta == pytest.approx(exact, rel=1e-3)


@given(z1=st.integers(14, 200), z2=st.integers(14, 400))
@settings(max_examples=100, deadline=None)
def test_mesh_loss__is_the_same_from_both_ends_and_less_in_a_ring(z1, z2):
    mu = np.array(0.06)
    there = mesh_efficiency(np.array(z1), np.array(z2), 1, mu, ANGLE, NONE)
    back = mesh_efficiency(np.array(z2), np.array(z1), 1, mu, ANGLE, NONE)
    assert there == pytest.approx(back, abs=1e-15)
    assert 0.9 < there < 1
    if z2 > max(40, z1 + 8):
        assert mesh_efficiency(np.array(z1), np.array(z2), -1, mu, ANGLE, NONE) > there
