"""Balance of engines: harmonics of the slider-crank, forces and couples by orders.

The independent way is Newton's law: positions of all pistons at 30 digits, differentiated twice, times their masses.
"""

import math

import mpmath
import numpy as np
import pytest
from engine_samples import ALL, EPS, RIGHT, angles, engines, few
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mpf
from numpy.testing import assert_allclose

from engine.elements.engines.engine_layout import (
    Engine,
    boxer_engine,
    in_line_engine,
    radial_engine,
    usual_throws,
    v_engine,
    w_engine,
)
from engine.elements.engines.harmonics import piston_harmonics
from engine.elements.engines.shafts import crankshaft_counterweights, remaining_shaking
from engine.elements.engines.shaking import SHAKING_ORDERS, engine_shaking

# Harmonics of the slider-crank


@pytest.mark.parametrize("ratio", [0.9, 0.99, 0.9999])
def test_piston_harmonics__hold_for_rods_hardly_longer_than_the_crank(ratio):
    # √(1 − λ² sin²) = Σ b_n cos 2n: its equation (1 − λ² sin²) s' = −λ² sin cos s binds three harmonics at a time.
    orders = np.array([2, 4, 6, 8])
    b = piston_harmonics(ratio, orders.tolist()).real / orders**2 * ratio
    for n in (2, 3):
        before, here, after = b[n - 2 : n + 1]
        k2 = ratio**2
        terms = np.array([k2 / 4 * (2 * n - 3) * before, (2 - k2) * n * here, k2 / 4 * (2 * n + 3) * after])
        # Rounding of b, whose largest is of the size 1, times some n.
        assert abs(terms.sum()) <= 16 * EPS


def test_piston_harmonics__do_not_exist_where_the_crank_does_not_turn():
    found = piston_harmonics(np.array([0.3, 1.0, 1.2, 0.6]), (1, 2), np.array([0.0, 0.0, 0.0, 0.5]))
    assert np.isfinite(found[0]).all()
    assert np.isnan(found[1:]).all()


# Forces and couples against Newton's law


def newton(engine, phi, arms):
    """Force, or couple, on the frame over ω²: masses times their second derivatives, at 30 digits."""
    layout = engine.layout
    cylinders = layout.banks.size
    masses = np.broadcast_to(engine.reciprocating_mass, cylinders)
    turning = np.broadcast_to(engine.rotating_mass, cylinders)
    with mpmath.workdps(30):
        r, rod, e = mpf(float(engine.radius)), mpf(float(engine.rod)), mpf(float(engine.offset))
        total = mpmath.mpc(0)
        for k in range(cylinders):
            bank, throw = mpf(float(layout.banks[k])), mpf(float(layout.throws[k]))

            def place(t, bank=bank, throw=throw):
                theta = t + throw - bank
                return r * mpmath.cos(theta) + mpmath.sqrt(rod**2 - (r * mpmath.sin(theta) - e) ** 2)

            pull = -mpmath.diff(place, mpf(phi), 2) * mpf(float(masses[k])) * mpmath.expj(bank)
            swing = mpf(float(turning[k])) * r * mpmath.expj(mpf(phi) + throw)
            total += mpf(float(arms[k])) * (pull + swing)
        return complex(total)


@few
@given(engines(), angles)
def test_shaking__is_the_sum_of_all_orders_of_newtons_forces(engine, phi):
    found = engine_shaking(engine, ALL)
    for vector, arms, terms in (
        (found.forces, np.ones(5), found.force_terms),
        (found.couples, engine.layout.positions, found.couple_terms),
    ):
        # λ + ε up to 0.55 gives a > 1.38: beyond order 24, 25² exp(−25 a) of the first order's size and less; here
        # 1e-9 with the slowest. Rounding grows as n² (n ≤ 24, 24 of them).
        assert abs(vector.at(np.array([phi]))[0] - newton(engine, phi, arms)) <= 1e-9 * terms[0] + 1e-15


# Well-known engines


def force_and_couple(layout):
    """Half axes of forces and couples as multiples of m r ω² A_n and m r ω² A_n a."""
    found = engine_shaking(Engine(layout, 1.0, 1 / 0.3))
    units = np.abs(piston_harmonics(0.3, SHAKING_ORDERS))
    return [(vector.major / units, vector.minor / units) for vector in (found.forces, found.couples)]


# Bosch Automotive Handbook, free forces and moments of the first and second order of usual engines; Taylor, The
# Internal-Combustion Engine in Theory and Practice, vol. 2; Maass & Klier. F1, F2, M1, M2 (their F2 is m r ω² λ).
TABLE = {
    "in-line 2": (in_line_engine(2).layout(), 0, 2, 1, 0),
    "in-line 3": (in_line_engine(3).layout(), 0, 0, math.sqrt(3), math.sqrt(3)),
    "in-line 4": (in_line_engine(4).layout(), 0, 4, 0, 0),
    "in-line 5": (in_line_engine(5).layout(), 0, 0, 0.449, 4.98),
    "in-line 6": (in_line_engine(6).layout(), 0, 0, 0, 0),
    "in-line 8": (in_line_engine(8).layout(), 0, 0, 0, 0),
    "boxer 2": (boxer_engine(2).layout(), 0, 0, 1, 1),
    "boxer 4": (boxer_engine(4).layout(), 0, 0, 0, 2),
    "boxer 6": (boxer_engine(6).layout(), 0, 0, 0, 0),
    "V2 90": (v_engine(2).layout(RIGHT), 1, math.sqrt(2), 0, 0),
    "V6 90": (v_engine(6).layout(RIGHT), 0, 0, math.sqrt(3), math.sqrt(6)),
    "V6 60 split": (v_engine(6).layout(math.pi / 3, math.pi / 3), 0, 0, 1.5, 1.5),
    "V8 cross-plane": (v_engine(8).layout(RIGHT), 0, 0, math.sqrt(10), 0),
    "V8 flat-plane": (v_engine(8, usual_throws(4)).layout(RIGHT), 0, 4 * math.sqrt(2), 0, 0),
    "V12 60": (v_engine(12).layout(math.pi / 3), 0, 0, 0, 0),
    "radial 3": (radial_engine(3).layout(), 1.5, 1.5, 0, 0),
    "radial 9": (radial_engine(9).layout(), 4.5, 0, 0, 0),
    # Broad arrow: cosines of 60° leave 1 + 2/4 and 1 − 2/4 times four rows, the secondaries cos 60° and cos 180°.
    "W12 60": (w_engine(12).layout(math.pi / 3), 0, 6, 0, 0),
}


@pytest.mark.parametrize("name", TABLE)
def test_known_engine__keeps_the_forces_and_couples_of_the_tables(name):
    layout, *expected = TABLE[name]
    (force, _), (couple, _) = force_and_couple(layout)
    # The tables' three digits; zeros to rounding.
    assert_allclose([*force[:2], *couple[:2]], expected, rtol=1e-3, atol=1e-13)


@pytest.mark.parametrize("name", ["V2 90", "V6 90", "V8 cross-plane", "radial 9"])
def test_first_order__turns_with_the_crank_and_counterweights_take_it(name):
    layout = TABLE[name][0]
    engine = Engine(layout, 0.04, 0.13, 0.5, 0.7)
    found = engine_shaking(engine)
    left = remaining_shaking(found, [crankshaft_counterweights(engine, 1.0, 0.5)])
    for before, after in zip(found[:2], left[:2], strict=True):
        assert abs(before.of(1)[1]) <= 1e-15
        assert after.major[0] <= 1e-15
        assert_allclose(after.major[1:], before.major[1:], rtol=0, atol=0)


def test_cylinders__stand_about_the_cranks_middle_with_their_rods_side_by_side():
    pairs = v_engine(4).layout(spacing=0.1, rod_distance=0.02)
    assert_allclose(pairs.positions, [-0.06, 0.04, -0.04, 0.06], rtol=4 * EPS)
    rows = w_engine(6).layout(math.radians(60), spacing=0.1, rod_distance=0.02)
    assert_allclose(rows.positions, [-0.07, 0.03, -0.05, 0.05, -0.03, 0.07], rtol=4 * EPS)
    assert_allclose(np.degrees(rows.banks), [60, 60, 0, 0, -60, -60], rtol=4 * EPS)
    assert_allclose(boxer_engine(4).layout(spacing=0.1).positions, [-0.15, 0.05, -0.05, 0.15], rtol=4 * EPS)


@few
@given(engines(), st.floats(0, 6))
def test_hodograph__has_its_half_axes_and_direction(engine, phi):
    vector = engine_shaking(engine, (2,)).forces
    drawn = vector.at(np.linspace(0, math.pi, 2001))
    # 2000 positions over the ellipse: extremes to (π/2000)²/2 of the larger half axis, beside a line's rounding.
    assert_allclose(np.abs(drawn).max(), vector.major[0], rtol=2e-6)
    assert abs(np.abs(drawn).min() - vector.minor[0]) <= 2e-3 * vector.major[0]
    assert_allclose(np.sqrt((np.abs(drawn[:-1]) ** 2).mean()), vector.rms, rtol=1e-12)
    if vector.minor[0] < 0.9 * vector.major[0]:
        along = drawn[np.abs(drawn).argmax()] * np.exp(-1j * vector.direction[0])
        assert abs(along.imag) <= 0.02 * vector.major[0]
