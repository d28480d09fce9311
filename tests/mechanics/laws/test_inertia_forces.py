"""Inertia forces of links against those of point masses."""

import math

import numpy as np
import pytest
from machines import changed, frame, moving, on
from machines import slider_crank as crank_and_ram
from oracle import EPS

from engine.laws.masses.link_inertia import inertia_offset


def test_resultant__where_nothing_accelerates():
    assert math.isinf(inertia_offset(0.1, 0.0, 0.0, 2.0))
    assert inertia_offset(0.1, 0.0, 0.0, 0.0) == 0.0


# Fields


def slider_crank():
    """A uniform rod with points at ±L/(2√3) from its middle: two halves of its mass there have all its inertia."""
    length = 0.8
    arms = (length / 2 - length / math.sqrt(12), length / 2 + length / math.sqrt(12))
    return crank_and_ram(0.3, length, slider="slider") | {
        "points": {"O": frame(0, 0), "N": on("rod", arms[0], 0), "F": on("rod", arms[1], 0), "S": on("rod", 0.4, 0)},
        "guides": {"way": {"angle": 0.2, "y": 0.05}},
        "bodies": {
            "bar": {"link": "rod", "mass": 3.0, "shape": {"type": "rod", "length": length}},
            "ram": {"link": "slider", "mass": 4.0},
        },
    }


REPLACED = {"bodies.bar.replace": {"type": "dynamic", "at": ["A"]}}


@pytest.mark.parametrize("changes", [{}, REPLACED], ids=["body", "replaced"])
def test_fields__inertia_forces_of_two_halves(changes):
    names = [f"{p}.{k}" for p in "NFS" for k in ("x", "y", "ax", "ay")] + ["B.ax", "B.ay"]
    fields = ["bar.inertia_force_x", "bar.inertia_force_y", "bar.inertia_moment", "bar.inertia_offset"]
    rams = ["ram.inertia_force_x", "ram.inertia_force_y", "ram.inertia_moment", "ram.inertia_offset"]
    for speed, mass in ((5.0, 3.0), (-11.0, 0.5)):
        values = {"input.speed": speed, "bodies.bar.mass": mass}
        _, f = moving(changed(slider_crank(), changes), [*names, *fields, *rams], 24, values)
        halves = [(-mass / 2 * f[f"{p}.ax"], -mass / 2 * f[f"{p}.ay"]) for p in "NF"]
        arms = [(f[f"{p}.x"] - f["S.x"], f[f"{p}.y"] - f["S.y"]) for p in "NF"]
        force = np.add(*halves)
        moment = sum(px * uy - py * ux for (px, py), (ux, uy) in zip(arms, halves, strict=True))
        size = np.abs(halves).max()
        # Sums of products that cancel: some roundings of the greatest force, and of its moment at the half length.
        assert np.abs(f["bar.inertia_force_x"] - force[0]).max() <= 64 * EPS * size
        assert np.abs(f["bar.inertia_force_y"] - force[1]).max() <= 64 * EPS * size
        assert np.abs(f["bar.inertia_moment"] - moment).max() <= 64 * EPS * size
        total = np.hypot(*force)
        assert (np.abs(f["bar.inertia_offset"] * total - moment) <= 64 * EPS * size).all()
        np.testing.assert_allclose(f["ram.inertia_force_x"], -4.0 * f["B.ax"], rtol=8 * EPS)
        np.testing.assert_allclose(f["ram.inertia_force_y"], -4.0 * f["B.ay"], rtol=8 * EPS)
        assert (f["ram.inertia_moment"] == 0).all()
        assert (f["ram.inertia_offset"] == 0).all()
