"""Engine elements with offset gudgeon pins, link rods and gas: against Newton, quadrature in many digits, firing."""

import math

import mpmath
import numpy as np
import pytest
from each_case import refusals
from engine_samples import EPS, few
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mpf
from numpy.testing import assert_allclose
from sampled_torque import gas_torque, harmonics, inertia_harmonics

from engine import ElementsAlone, Scene, Verdict
from engine.elements.engines.engine import TORQUE_ORDERS, engine_torque, torque_name
from engine.elements.engines.engine_layout import in_line_engine
from engine.elements.engines.firing import firing_angles
from engine.elements.engines.harmonics import crank_radius

GAS = {"bore": 0.08, "clearance": 1 / 8.5, "intake": 0.9e5, "exhaust": 1.05e5, "peak": 50e5}
FOUR = {
    "type": "engine",
    "layout": "in-line",
    "cylinders": 4,
    "spacing": 0.1,
    "stroke": 0.08,
    "rod": 0.14,
    "piston_mass": 0.4,
    "rod_mass": 0.5,
    "rod_centre": 0.04,
    "speed": 300.0,
}
STAR = FOUR | {
    "layout": "radial",
    "cylinders": 5,
    "rod": 0.24,
    "master_cylinder": 2,
    "knuckle_radius": 0.06,
    "link_rod": 0.18,
    "link_rod_mass": 0.3,
    "link_rod_centre": 0.05,
}


def element(**keys):
    return Scene.model_validate({"elements": {"it": keys}}).elements["it"]


def results(varied=None, **keys):
    scene = Scene.model_validate({"elements": {"it": keys}})
    paths = {f"elements.it.{key}": np.asarray(values, float) for key, values in (varied or {}).items()}
    return ElementsAlone(scene, list(ElementsAlone(scene).available_summaries), varied=paths).evaluate(paths)


def value(outcome, name):
    return float(outcome.summaries[f"it.{name}"][0]), float(outcome.errors[f"it.{name}"][0])


@few
@given(st.floats(0.01, 1.0), st.floats(1.05, 8.0), st.floats(-0.4, 0.4))
def test_crank_radius__gives_the_stroke(stroke, length, aside):
    rod = stroke / 2 * length
    offset = aside * (rod - stroke / 2)
    r = float(crank_radius(stroke, rod, offset))
    found = mpmath.sqrt((mpf(rod) + r) ** 2 - mpf(offset) ** 2) - mpmath.sqrt((mpf(rod) - r) ** 2 - mpf(offset) ** 2)
    # Products and a difference of squares, which cancels as the rod is short.
    assert_allclose(float(found), stroke, rtol=16 * EPS * length / (length - 1))
    assert float(crank_radius(stroke, rod)) == stroke / 2


def test_link_rods__are_those_of_newtons_master_rod():
    outcome = results(**STAR | {"balanced_reciprocating": 0.5})
    banks, r, rod, link = 2 * math.pi * np.arange(5) / 5, 0.04, 0.24, 0.18
    own = 0.4 + 0.5 * 0.04 / rod, 0.5 * (1 - 0.04 / rod)
    other = 0.4 + 0.3 * (1 - 0.13 / link), 0.3 * 0.13 / link
    with mpmath.workdps(40):

        def pin(t, k):
            lean = mpmath.asin(-r * mpmath.sin(t - banks[1]) / rod)
            return r * mpmath.expj(t) + (0.06 * mpmath.expj(banks[k] + lean) if k != 1 else 0)

        def momentum(t):
            """Sum of mass times place of everything that moves, but for what stands opposite the crank."""
            total = mpmath.mpc(0)
            for k, bank in enumerate(banks):
                piston, knuckle = own if k == 1 else other
                seen = pin(t, k) * mpmath.expj(-bank)
                along = seen.real + mpmath.sqrt((rod if k == 1 else link) ** 2 - seen.imag**2)
                total += piston * along * mpmath.expj(bank) + knuckle * pin(t, k)
            return total

        weights = own[1] + 4 * other[1] + (own[0] + 4 * other[0]) / 2
        count = 96
        forces = [momentum(2 * mpmath.pi * k / count) for k in range(count)]
        for n, word in ((1, "primary"), (2, "secondary"), (3, "third_order")):
            parts = []
            for sense in (1, -1):
                turns = [f * mpmath.expj(-2 * mpmath.pi * sense * n * k / count) for k, f in enumerate(forces)]
                parts.append(n**2 * sum(turns) / count - (r * weights if (n, sense) == (1, 1) else 0))
            exact = [float(abs(parts[0]) + s * abs(parts[1])) * 300**2 for s in (1, -1)]
            found, error = value(outcome, f"{word}_force")
            least, least_error = value(outcome, f"{word}_force_least")
            assert abs(found - exact[0]) <= error
            assert abs(least - abs(exact[1])) <= least_error
            assert error < 1e-10 * float(5 * r * 300**2)


def test_link_rods_too_short_to_reach__are_a_verdict():
    outcome = results({"link_rod": [0.18, 0.02]}, **STAR)
    assert outcome.status.tolist() == [Verdict.OK, Verdict.NOT_FINITE]


@pytest.mark.parametrize("offset", [None, 0.008])
def test_torque_of_gas_and_inertia__is_that_of_the_curves(offset):
    keys = FOUR | {"gas": GAS, "rod_inertia": 0.0015} | ({} if offset is None else {"gudgeon_offset": offset})
    outcome, aside = results(**keys), offset or 0.0
    r = float(crank_radius(0.08, 0.14, aside))
    gas = GAS | {"n_compression": 1.32, "n_expansion": 1.28, "outside": 101_325.0}
    curve = gas_torque(gas, 0.08, r, 0.14, aside)
    mass, correction = 0.4 + 0.5 * 0.04 / 0.14, 0.0015 - 0.5 * 0.04 * 0.10
    inertia = inertia_harmonics(mass, correction, r, 0.14, TORQUE_ORDERS, aside)
    angles = firing_angles(in_line_engine(4).layout(), (1, 2, 4, 3)) + math.asin(aside / (0.14 + r))
    fired = np.exp(-1j * np.outer(TORQUE_ORDERS, angles)).sum(axis=-1)
    expected = (harmonics(curve, TORQUE_ORDERS) + inertia * 300**2) * fired
    size = np.abs(curve).max()
    four = element(**keys)
    found = engine_torque(four, four.own_numbers())[1][0]
    for n, whole, phased in zip(TORQUE_ORDERS, expected, found, strict=True):
        # The curve has kinks: its trapezoid rule is off by (4π/28800)²/12 of a slope of some ten times its size.
        assert value(outcome, torque_name(n))[0] == pytest.approx(abs(whole), abs=1e-6 * size)
        assert abs(phased - whole) <= 1e-6 * size
    mean, error = value(outcome, "mean_torque")
    assert mean == pytest.approx(4 * curve.mean(), abs=1e-6 * size)
    assert value(outcome, "mean_power")[0] == pytest.approx(mean * 300.0, rel=4 * EPS)
    if offset is None:
        least = GAS["clearance"] * 0.08 * math.pi / 4 * 0.08**2
        ratio = 1 + 1 / GAS["clearance"]
        expansion, compression = (1 - ratio**-0.28) / 0.28, (ratio**0.32 - 1) / 0.32
        work = least * (50e5 * expansion - 0.9e5 * ratio * compression) - 0.15e5 * least / GAS["clearance"]
        # The work of the diagram in closed form; some roundings of its own.
        assert abs(mean - work / math.pi) <= error + 1e-13 * mean


@pytest.mark.parametrize("nodes", [8, 12, 20])
def test_torque_by_too_few_nodes__has_an_error_figure_that_says_so(nodes, monkeypatch):
    keys = [
        FOUR | {"cylinders": 1, "gas": GAS | {"clearance": c}, "rod": rod} for c in (0.05, 0.2) for rod in (0.05, 0.2)
    ]
    fine = [results(**k) for k in keys]
    monkeypatch.setattr("engine.elements.engines.engine_torque.NODES", nodes)
    for exact, coarse in zip(fine, [results(**k) for k in keys], strict=True):
        for name in ("mean_torque", *map(torque_name, TORQUE_ORDERS)):
            assert abs(value(coarse, name)[0] - value(exact, name)[0]) <= value(coarse, name)[1], name


def test_torque_near_singularities__keeps_its_error_figure(monkeypatch):
    """Small clearances, rods hardly longer than the crank: against ten times the nodes."""
    rng, count = np.random.default_rng(1), 400
    varied = {"gas.clearance": 10.0 ** rng.uniform(-4, -1, count), "rod": 0.04 / rng.uniform(0.2, 0.98, count)}
    varied |= {f"gas.n_{stroke}": rng.uniform(1.0, 1.7, count) for stroke in ("compression", "expansion")}
    varied |= {"speed": 10.0 ** rng.uniform(0, 3, count)}
    coarse = results(varied, **FOUR | {"cylinders": 1, "gas": GAS})
    monkeypatch.setattr("engine.elements.engines.engine_torque.NODES", 480)
    fine = results(varied, **FOUR | {"cylinders": 1, "gas": GAS})
    for name in (f"it.{name}" for name in ("mean_torque", *map(torque_name, TORQUE_ORDERS))):
        off = np.abs(coarse.summaries[name] - fine.summaries[name])
        assert (off <= coarse.errors[name] + fine.errors[name]).all(), name


def test_bank_angle_at_which_the_order_cannot_fire__has_no_torque_but_forces():
    twin = FOUR | {"layout": "V", "cylinders": 2, "bank_angle": 1.0, "gas": GAS, "firing_order": (1, 2)}
    outcome = results({"bank_angle": [0.5, 1.0, 3.0]}, **twin)
    assert outcome.status.tolist() == [Verdict.OK] * 3
    assert np.isfinite(outcome.summaries["it.torque_order_0_5"]).all()
    # 697° to the last cylinder at 2.5 rad, two turns more at a right angle.
    six = FOUR | {"layout": "V", "cylinders": 6, "bank_angle": 2.5, "gas": GAS, "firing_order": (1, 4, 2, 5, 3, 6)}
    outcome = results({"bank_angle": [2.5, math.pi / 2]}, **six)
    assert outcome.status.tolist() == [Verdict.OK] * 2
    assert np.isfinite(outcome.summaries["it.torque_order_3"]).tolist() == [True, False]


test_engine_that_cannot_be__is_refused_with_the_mend = refusals(
    lambda changes: element(**FOUR | changes),
    ({"gudgeon_offset": 0.14}, "longer than 145.6 mm, for half the stroke and gudgeon_offset across it"),
    ({"knuckle_radius": 0.05}, "knuckle_radius and link_rod belong together"),
    ({"link_rod_mass": 0.2}, "link_rod_mass has no meaning without knuckle_radius"),
    ({"knuckle_radius": 0.05, "link_rod": 0.1}, "goes with layout = 'radial'; the layout is 'in-line'"),
    ({**STAR, "gas": GAS}, "leave out gas, or the link rods"),
    ({**STAR, "master_cylinder": 6}, "master_cylinder = 6: there are 5 cylinders"),
    ({"firing_order": (1, 3, 4, 2)}, "firing_order has no meaning without gas: give gas"),
    ({"gas": GAS, "firing_order": (1, 4, 2, 3)}, "1-3-4-2 fires evenly"),
    ({"gas": GAS, "throws": (0.0, 1.0, 2.0, 3.0)}, "firing_order is missing, and these throws allow no even one"),
)
