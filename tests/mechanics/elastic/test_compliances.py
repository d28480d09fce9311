"""Stiffness and damping of parts together: against equilibrium in fractions, and against energy."""

import math
from fractions import Fraction

import numpy as np
import pytest
from each_case import refusals
from element_samples import element, figures, one, results
from hypothesis import given, settings
from hypothesis import strategies as st

from engine import Verdict
from sweeps.pictures.elements.element_pictures import element_sheet

STEEL = 8e10
SHAFT = {"type": "shaft", "diameter": 0.05, "length": 0.4, "shear_modulus": STEEL}
COUPLING = {"type": "coupling", "stiffness": 2e4}


def drive(parts, **others):
    return {"type": "compliance", "parts": parts, **others}


def test_stepped_and_hollow_shaft__is_the_polar_moment_over_length():
    steps = {
        "thick": SHAFT | {"diameter": 0.08, "bore": 0.03, "length": 0.5},
        "thin": SHAFT | {"diameter": 0.04, "length": 0.2},
    }
    twist = sum(
        32 * 300 * part["length"] / (math.pi * STEEL * (part["diameter"] ** 4 - part.get("bore", 0.0) ** 4))
        for part in steps.values()
    )
    found = one(drive(steps, moment=300.0), "twist", "stiffness", "thick.share", "thin.share", "thin.moment")
    assert found[:2] == pytest.approx([twist, 300 / twist], rel=1e-13)
    assert found[2] + found[3] == pytest.approx(1.0, rel=1e-14)
    assert found[4] == pytest.approx(300.0)


def test_parts_by_their_kinds():
    parts = {
        "rod": {"type": "rod", "area": 3e-4, "length": 0.7, "elastic_modulus": 2e11, "radius": 0.1, "strands": 2},
        "chain": {"type": "strand", "stiffness": 4e6, "radius": 0.05},
        "mesh": {"type": "gear_mesh", "mesh_stiffness": 14e9, "width": 0.03, "base_radius": 0.06},
    }
    found = one(drive(parts), "rod.stiffness", "chain.stiffness", "mesh.stiffness")
    assert found == pytest.approx([2 * 2e11 * 3e-4 / 0.7 * 0.01, 1e4, 14e9 * 0.03 * 0.0036], rel=1e-13)


def test_mesh_stiffness__takes_the_unit_of_the_standard():
    mesh = {"type": "gear_mesh", "mesh_stiffness": "20 N/(mm um)", "width": "30 mm", "base_radius": "60 mm"}
    assert one(drive({"mesh": mesh}), "mesh.stiffness") == pytest.approx([20e9 * 0.03 * 0.06**2])


stiffness = st.floats(2, 8).map(lambda x: 10**x)
ratios = st.floats(0.05, 20.0)


@st.composite
def drives(draw, depth=0):
    """Parts nested in series and in parallel."""
    kind = draw(st.sampled_from(["coupling"] if depth == 2 else ["coupling", "series", "parallel"]))
    own = {"type": kind, "ratio": draw(ratios)}
    if kind == "coupling":
        damper = draw(st.sampled_from([{}, {"damping": draw(st.floats(0.1, 10))}]))
        return own | damper | {"stiffness": draw(stiffness)}
    return own | {"parts": {name: draw(drives(depth + 1)) for name in draw(st.sampled_from(["a", "ab", "abc"]))}}


def loaded(part, moment):
    """Twist under a moment about the reference axis, and energy and dissipation at a twist rate equal to the twist.

    In fractions, as stiffnesses may differ a millionfold.
    """
    ratio = Fraction(part["ratio"])
    moment = moment / ratio
    if part["type"] == "coupling":
        twist = moment / Fraction(part["stiffness"])
        return twist / ratio, moment * twist / 2, Fraction(part.get("damping", 0.0)) * twist**2
    parts = list(part["parts"].values())
    if part["type"] == "series":
        twists, energies, losses = zip(*(loaded(p, moment) for p in parts), strict=True)
        return sum(twists) / ratio, sum(energies), sum(losses)
    # One twist for all, and the moments that cause it add up.
    causing = [1 / loaded(p, Fraction(1))[0] for p in parts]
    twist = moment / sum(causing)
    _, energies, losses = zip(*(loaded(p, twist * m) for p, m in zip(parts, causing, strict=True)), strict=True)
    return twist / ratio, sum(energies), sum(losses)


@settings(max_examples=25)
@given(drives(), st.floats(10, 1000))
def test_parts_together__twist_store_and_dissipate_as_each_of_them_does(part, frequency):
    data = drive({"all": part}, moment=100.0, frequency=frequency)
    twist, energy, lost = loaded(part, Fraction(100))
    names = ["twist", "stiffness", "damping", "energy_absorption"]
    # What a cycle of this amplitude dissipates at the frequency, over the greatest energy.
    absorbed = Fraction(math.pi) * Fraction(frequency) * lost / energy
    exacts = [twist, 100 / twist, lost / twist**2, absorbed]
    for (value, error), exact in zip(figures(data, *names), exacts, strict=True):
        assert abs(Fraction(value) - exact) <= Fraction(error) + Fraction(1e-16) * exact
        assert error <= 1e-12 * abs(value)


def test_energy_absorption__of_equal_parts_is_that_of_each():
    part = COUPLING | {"energy_absorption": 0.3}
    pair = {"type": "parallel", "parts": {"left": part, "right": part}}
    found = one(drive({"one": part, "two": pair}, frequency=50.0), "energy_absorption", "damping", "stiffness")
    assert found[0] == pytest.approx(0.3, rel=1e-14)
    assert found[1] == pytest.approx(0.3 * found[2] / (math.tau * 50.0), rel=1e-14)


def test_parts_vary_by_their_paths():
    pair = {"type": "parallel", "parts": {"left": COUPLING, "right": COUPLING}}
    ((value, _),) = figures(drive({"pair": pair}), "stiffness", parts__pair__parts__left__stiffness=[2e4, 6e4])
    assert value == pytest.approx([4e4, 8e4])


test_part_that_cannot_be__says_what_to_mend = refusals(
    lambda part: element(drive({"a": part})),
    (SHAFT | {"bore": 0.05}, "diameter = 50 mm is not above bore = 50 mm"),
    (COUPLING | {"stiffness": -1.0}, "greater than 0"),
    (COUPLING | {"damping": 1.0, "energy_absorption": 0.1}, "give one of damping, energy_absorption"),
    ({"type": "series", "parts": {"a": COUPLING}, "damping": 1.0}, "give it to them"),
    ({"type": "series", "parts": {}}, "has too few entries: 0, at least 1"),
)


def test_bore_that_varies_beyond_the_diameter__is_a_status():
    values, _, status = results(drive({"a": SHAFT}), "stiffness", parts__a__bore=[0.01, 0.05, 0.06])
    assert list(status) == [Verdict.OK, Verdict.OUTSIDE_LIMITS, Verdict.OUTSIDE_LIMITS]
    assert np.isnan(values["stiffness"][1:]).all()


def test_bars_of_a_shaft_line__are_shares_of_the_work_of_its_parts():
    line = drive({"stiff": SHAFT | {"diameter": 0.08}, "soft": COUPLING | {"ratio": 0.5}}, moment=200.0)
    (ax,) = element_sheet(element(line), "line").axes
    names, heights = [text.get_text() for text in ax.get_xticklabels()], [bar.get_height() for bar in ax.patches]
    # A part at half the speed has twice the moment, and the work ½M²/c of each is its share.
    works = [0.5 * 200.0**2 / (STEEL * math.pi * 0.08**4 / 32 / 0.4), 0.5 * 400.0**2 / 2e4]
    assert [name.partition("\n")[0] for name in names] == ["stiff", "soft"]
    assert heights == pytest.approx([100 * work / sum(works) for work in works], rel=1e-13)
