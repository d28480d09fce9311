"""Balancing of rotors: kinds of unbalance, correction, holes and grades."""

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.elements.rotors.correction import correct
from engine.elements.rotors.grades import grade_reached, tolerance_shares
from engine.elements.rotors.hole_pattern import PatternError, best_holes, split_on_neighbours
from engine.elements.rotors.unbalance import Kind, kind, resultant_unbalance, unbalance

EPS = np.finfo(float).eps

few = settings(max_examples=30)
angles = st.floats(-10, 10)
places = st.floats(-3, 3)
sizes = st.floats(-6, 3).map(lambda e: 10.0**e)
masses_on_rotor = st.lists(st.tuples(sizes, sizes, angles, places), min_size=1, max_size=8)


def rotor_of(masses):
    m, e, alpha, z = np.array(masses).T
    return unbalance(m, e, alpha), z


# What unbalances amount to


def test_kinds__as_the_standard_defines_them_by_the_principal_axis():
    """Each against the principal axis itself: least inertia of a slender body with the masses on it."""
    cases = {
        Kind.BALANCED: [0, 0],
        Kind.STATIC: [1e-5, 1e-5],
        Kind.COUPLE: [1e-5, -1e-5],
        Kind.QUASI_STATIC: [1e-5, 3e-5],
        Kind.DYNAMIC: [1e-5, 1e-5j],
    }
    for expected, unbalances in cases.items():
        assert kind(resultant_unbalance(unbalances, [-0.2, 0.2]), 0.0, 1e-9, 1e-9) == expected
        offset, tilt = principal_axis(unbalances, [-0.2, 0.2])
        parallel, through = abs(tilt) < 1e-7, abs(offset) < 1e-7
        crosses = abs((np.conj(offset) * tilt).imag) < 1e-6 * abs(offset * tilt)
        by_axis = {
            Kind.BALANCED: parallel and through,
            Kind.STATIC: parallel and not through,
            Kind.COUPLE: through and not parallel,
            Kind.QUASI_STATIC: crosses and not through and not parallel,
            Kind.DYNAMIC: not (crosses or through or parallel),
        }
        assert [k for k, holds in by_axis.items() if holds] == [expected]


def principal_axis(unbalances, positions):
    """Offset of the centre of mass and slope of the axis of least inertia of a long body of 1 kg, complex."""
    tensor = np.diag([1.0, 1.0, 0.01])
    for u, z in zip(unbalances, positions, strict=True):
        u = complex(u)
        tensor[0, 2] -= u.real * z
        tensor[1, 2] -= u.imag * z
    tensor[2, :2] = tensor[:2, 2]
    axis = np.linalg.eigh(tensor)[1][:, 0]
    return sum(unbalances), complex(axis[0], axis[1]) / axis[2]


# Correction


@few
@given(masses_on_rotor, st.lists(st.tuples(places, st.floats(0.1, 3)), min_size=3, max_size=5))
def test_correction__in_many_planes_has_the_least_sum_of_squared_masses(masses, planes):
    """Against NumPy's least-norm solution of the two equations in the masses."""
    unbalances, z = rotor_of(masses)
    at, radii = np.array(planes).T
    if np.ptp(at) < 0.1:
        return
    found = correct(resultant_unbalance(unbalances, z), at, radii) / radii
    equations = np.stack([radii, radii * at]).astype(complex)
    wanted = -np.array([unbalances.sum(), (unbalances * z).sum()])
    least = np.linalg.lstsq(equations, wanted, rcond=None)[0]
    # lstsq loses the condition number of the two equations, up to about (max r/min r) (3/0.1) = 900.
    assert found == pytest.approx(least, abs=1e4 * EPS * np.abs(unbalances).sum() / 0.01)


# Holes


@few
@given(st.complex_numbers(min_magnitude=1e-6, max_magnitude=1e3), st.integers(3, 40))
def test_split__on_neighbouring_holes_makes_the_correction_with_nothing_taken_away(correction, holes):
    split = split_on_neighbours(correction, holes)
    at = [math.tau * k / holes for k in (split.hole, split.next_hole)]
    made = split.amount * np.exp(1j * at[0]) + split.next_amount * np.exp(1j * at[1])
    # The sines of a step of tau/40 stretch roundings of the angle by its reciprocal.
    assert abs(made - correction) <= 60 * EPS * abs(correction) / math.sin(math.tau / holes)
    assert min(split.amount, split.next_amount) >= 0
    assert split.next_hole == (split.hole + 1) % holes


def test_split__on_two_holes_is_refused():
    with pytest.raises(PatternError, match=r"holes = 2: .* at least 3"):
        split_on_neighbours(1.0, 2)


@few
@given(
    st.complex_numbers(max_magnitude=6),
    st.integers(1, 5),
    st.integers(1, 2),
    st.integers(1, 3),
    st.floats(0.1, 2) | st.floats(-2, -0.1),
)
def test_best_holes__are_the_best_of_all_ways_counted_one_by_one(correction, holes, most, used, piece):
    pieces, made = best_holes(correction, holes, most, used, piece, 0.3)
    directions = piece * np.exp(1j * (0.3 + math.tau / holes * np.arange(holes)))
    ways = [w for w in product(range(most + 1), repeat=holes) if np.count_nonzero(w) <= used]
    least = min(abs(np.dot(w, directions) - correction) for w in ways)
    # Equal ways differ by roundings of the sums.
    assert abs(made - correction) == pytest.approx(least, abs=1e-8 * abs(piece))
    assert np.dot(pieces, directions) == pytest.approx(made, abs=1e-13)
    equal = [sum(w) for w in ways if abs(np.dot(w, directions) - made) < 1e-9 * abs(piece)]
    assert pieces.sum() == min(equal)


def test_best_holes__of_many_rotors_and_none_for_what_is_no_number():
    pieces, made = best_holes(np.array([1.0, 1j, math.nan]), 4, 2, 2, np.array([0.5, 0.5, 0.5]))
    assert pieces.tolist() == [[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 0, 0]]
    assert np.isnan(made).tolist() == [False, False, True]
    assert np.isnan(best_holes(1.0, 4, 2, 2, 0.0)[1])


@pytest.mark.parametrize("correction", [1e149, 1e150, 1e200, 1e308, -1e200j])
def test_best_holes__of_corrections_beyond_all_pieces(correction):
    pieces, made = best_holes(correction, 4, 2, 2, 1.0)
    if abs(correction) < 1e150:
        # Whatever points that way, as distances are the same to rounding.
        assert np.isfinite(made)
    else:
        assert np.isnan(made)
        assert not pieces.any()


def test_best_holes__with_too_many_ways_says_so():
    with pytest.raises(PatternError, match="48 holes with up to 20 pieces in 4 of them"):
        best_holes(1.0, 48, 20, 4, 1.0)
    with pytest.raises(PatternError, match="holes = 0"):
        best_holes(1.0, 0, 2, 2, 1.0)


# Grades


@pytest.mark.parametrize(
    ("centre", "shares"),
    [
        (1.5, (0.375, 0.625)),
        (1.2, (0.5, 0.5)),
        # Near a bearing: not more than 0.7, not less than 0.3.
        (0.1, (0.7, 0.3)),
        (2.3, (0.3, 0.7)),
        # Beyond a bearing: not more than 1.3, not less than 0.3.
        (2.64, (0.3, 1.1)),
        (3.6, (0.5, 1.3)),
        (-0.24, (1.1, 0.3)),
    ],
)
def test_shares__of_the_tolerance_planes(centre, shares):
    assert tolerance_shares(centre, 0.0, 2.4) == pytest.approx(shares)
    assert tolerance_shares(2.4 - centre, 2.4, 0.0) == pytest.approx(shares)


def test_shares__of_bearings_in_one_place_are_no_number():
    assert np.isnan(tolerance_shares(0.3, 1.0, 1.0)).all()


def test_grade_reached__beyond_the_coarsest_is_infinite():
    assert grade_reached([4.1, 4.0, 0.0, math.nan]).tolist()[:3] == [math.inf, 4000.0, 0.4]
    assert math.isnan(grade_reached(math.nan))
