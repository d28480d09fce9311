"""Whether wheels fit, against planets set in one by one with all their teeth; and the inertia of what turns."""

import itertools
import math

import numpy as np
import pytest
from element_samples import element, results, solved
from gear_samples import simple_planetary, stepped_planetary, tips_keep_clear, toothed

from engine import Verdict

EPS = np.finfo(float).eps
ROLES = {"sun": {"speed": 100.0}, "ring": {"held": True}}


def can_be_set_in(central, planets, internal, count):
    """Whether `count` equal planets fit between two central wheels that stay where the first planet needs them.

    Central wheels have a tooth on the x axis, so the first planet a gap there. At 2π/k a planet is turned, tooth by
    tooth of its first wheel, and its second wheel has to find the gaps of the other central one.
    """
    (za, zb), (z1, z2) = central, planets
    place = 1 / count
    for tooth in range(z1):
        # Phase of the first mesh, in teeth: z_a (0 − place) + z_1 (turn − place) is whole.
        turn = place + (tooth + za * place) / z1
        second = -zb * place + (-1 if internal else 1) * z2 * (turn - place)
        if abs(second - round(second)) < 1e-9:
            return True
    return False


@pytest.mark.parametrize("internal", [False, True])
def test_stepped_planets__are_set_in_as_their_two_wheels_allow(internal):
    rng = np.random.default_rng(3)
    first, second, third = rng.integers(12, 60, (3, 150))
    fourth = rng.integers(60, 130, 150)
    names = ("first", "second", "third", "fourth")
    for count in (2, 3, 5):
        roles = {"first": {"speed": 100.0}, "fourth": {"held": True}}
        train = stepped_planetary(20, 30, 25, 75, roles, internal=internal, planets=count)
        grid = (first, second, third, fourth)
        found, _, _ = results(train, **{f"wheels.{n}.teeth": z for n, z in zip(names, grid, strict=True)})
        fits = found["arm.spacing_remainder"] == 0
        assert 0.05 < fits.mean() < 0.95
        for i, z in enumerate(zip(*map(np.ndarray.tolist, grid), strict=True)):
            assert fits[i] == can_be_set_in((z[0], z[3]), (z[1], z[2]), internal, count)


def test_all_conditions__over_all_small_integers():
    """Coaxial z_r = z_s + 2 z_p, equal spacing (z_s + z_r)/k whole, neighbours (z_s + z_p) sin(π/k) > z_p + 2."""
    axes = (range(12, 22), range(12, 22), range(36, 66), range(1, 6))
    grid = np.array(list(itertools.product(*axes)), float)
    keys = ("wheels.sun.teeth", "wheels.planet.teeth", "wheels.ring.teeth", "shafts.arm.planets")
    train = simple_planetary(18, 24, 66, ROLES, planets=3)
    found, errors, status = results(train, **dict(zip(keys, grid.T, strict=True)))
    sun, planet, ring, k = grid.T
    neighbours = (k == 1) | ((sun + planet) * np.sin(np.pi / k) > planet + 2)
    fits = (ring == sun + 2 * planet) & ((sun + ring) % k == 0) & neighbours
    clear = tips_keep_clear(sun, planet) & tips_keep_clear(planet, ring, -1)
    assert (fits & clear).any()
    why = np.where(neighbours, Verdict.OK, Verdict.PLANETS_TOUCH)
    why = np.where((sun + ring) % k == 0, why, Verdict.UNEVEN_PLANETS)
    why = np.where(ring == sun + 2 * planet, why, Verdict.AXES_APART)
    why = np.where(ring > planet, why, Verdict.DOES_NOT_FIT)
    assert (status[~fits] == why[~fits]).all()
    assert (status[fits] == np.where(clear, Verdict.OK, Verdict.INTERFERES)[fits]).all()
    fits &= clear
    assert np.isnan(found["arm.ratio"][~fits]).all()
    ratio, error = found["arm.ratio"][fits], errors["arm.ratio"][fits]
    assert (np.abs(ratio - (1 + ring / sun)[fits]) <= error + 4 * EPS * ratio).all()


def test_numbers_of_teeth_that_are_not_whole__do_not_fit():
    varied = {"wheels.sun.teeth": np.array([18, 18.5, 19, 20])}
    train = simple_planetary(18, 24, 66, ROLES)
    # 20 + 2·24 is no longer 66; nor is 19 + 2·24.
    assert list(results(train, **varied)[2]) == [Verdict.OK, Verdict.FRACTION_OF_A_TOOTH, *[Verdict.AXES_APART] * 2]


def test_two_stages_on_one_axis__need_equal_distances():
    train = {
        "type": "gear_train",
        "wheels": toothed(a=("input", 20), b=("lay", 60), c=("lay", 30), d=("output", 50)),
        "shafts": {"input": {"axis": "main", "speed": 1.0}, "lay": {}, "output": {"axis": "main"}},
        "meshes": {"one": {"between": ["a", "b"]}, "two": {"between": ["c", "d"]}},
    }
    varied = {"wheels.d.teeth": np.array([50.0, 51.0])}
    found, _, status = results(train, **varied)
    assert list(status) == [Verdict.OK, Verdict.AXES_APART]
    np.testing.assert_allclose(found["two.distance_error"], [0, 1 / 80], atol=1e-15)


def test_central_shafts_of_joined_sets__are_all_on_one_axis():
    train = simple_planetary(24, 30, 84, ROLES)
    train["wheels"] |= toothed(second_sun=("arm", 24), second_planet=("second", 30), second_ring=("ring_shaft", 84))
    train["shafts"] |= {"second": {"carrier": "out"}, "out": {}}
    train["meshes"] |= {"m1": {"between": ["second_sun", "second_planet"]}}
    train["meshes"] |= {"m2": {"between": ["second_planet", "second_ring"], "type": "internal"}}
    axes = element(train).structure.axes
    assert len({axes[shaft] for shaft in ("sun_shaft", "ring_shaft", "arm", "out")}) == 1
    assert len(set(axes.values())) == 3


def test_wheel_in_a_smaller_ring__does_not_fit():
    train = simple_planetary(18, 24, 20, ROLES)
    assert results(train)[2] == Verdict.DOES_NOT_FIT


def test_bore_up_to_the_teeth__does_not_fit():
    train = simple_planetary(24, 30, 84, ROLES, module=0.002)
    train["wheels"]["sun"] |= {"width": 0.02, "bore": 0.01}
    # The root circle has 2 mm · (24 - 2.5) = 43 mm.
    assert list(results(train, wheels__sun__bore=[0.042, 0.0431])[2]) == [Verdict.OK, Verdict.BORE_TOO_LARGE]


# Inertia


def test_reduced_inertia__is_that_of_lagrange_for_a_simple_planetary():
    """All wheels discs; I = I_s + k (I_p (ω_p/ω_s)² + m_p (a ω_h/ω_s)²) + I_h (ω_h/ω_s)²."""
    sun, planet, ring, k, m, b, rho = 24, 30, 84, 3, 0.002, 0.025, 7850.0
    train = simple_planetary(sun, planet, ring, ROLES | {"arm": {"inertia": 0.02}}, planets=k, module=m)
    train["wheels"]["sun"] |= {"width": b, "bore": 0.01}
    train["wheels"]["planet"] |= {"width": b}
    found = solved(train)
    arm = sun / (sun + ring)
    spin = arm - sun / planet * (1 - arm)
    d_s, d_p = m * sun, m * planet
    i_s = rho * b * math.pi / 32 * (d_s**4 - 0.01**4)
    m_p = rho * b * math.pi / 4 * d_p**2
    i_p = m_p * d_p**2 / 8
    exact = i_s + k * (i_p * spin**2 + m_p * (m * (sun + planet) / 2 * arm) ** 2) + 0.02 * arm**2
    value, error = found["sun_shaft.reduced_inertia"]
    assert abs(value - exact) <= error + 32 * EPS * exact
    value, error = found["arm.reduced_inertia"]
    assert abs(value - exact / arm**2) <= error + 32 * EPS * exact / arm**2
    assert found["kinetic_energy"][0] == pytest.approx(exact * 100.0**2 / 2, rel=1e-14)
