"""Inertia forces against point masses, and Euler's equations against d/dt of the angular momentum with mpmath."""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from machines import changed, crank, evaluated, frame, on, rrp
from oracle import EPS

from engine import Machine, Scene
from engine.laws.inertia_forces import (
    centre_of_percussion,
    euler_moment,
    euler_moment_of_products,
    fixed_axis_moment,
    inertia_force,
    inertia_moment,
    inertia_offset,
    resultant_point,
)

ANY = st.floats(-1e4, 1e4).filter(lambda v: abs(v) > 1e-4)
POSITIVE = st.floats(1e-6, 1e6)


@settings(deadline=None, max_examples=100)
@given(POSITIVE, POSITIVE, ANY, ANY, ANY)
def test_resultant__has_the_force_and_the_moment(mass, gyration, ax, ay, epsilon):
    ux, uy = inertia_force(mass, ax, ay)
    moment = inertia_moment(mass * gyration**2, epsilon)
    dx, dy = resultant_point(gyration**2, ax, ay, epsilon)
    # One rounding for each of some ten operations.
    assert abs(dx * uy - dy * ux - moment) <= 16 * EPS * abs(moment)
    assert abs(dx * ux + dy * uy) <= 16 * EPS * math.hypot(dx, dy) * math.hypot(ux, uy)
    h = inertia_offset(gyration**2, ax, ay, epsilon)
    assert math.isclose(h, moment / math.hypot(ux, uy), rel_tol=16 * EPS)
    # To the right of S, seen along U, where h is positive.
    assert (ux * dy - uy * dx < 0) == (h > 0)


@settings(deadline=None, max_examples=100)
@given(POSITIVE, POSITIVE, st.floats(-math.pi, math.pi), ANY, ANY)
def test_resultant_of_a_swinging_link__passes_through_the_centre_of_percussion(gyration, arm, angle, omega, epsilon):
    sx, sy = arm * math.cos(angle), arm * math.sin(angle)
    ax, ay = -epsilon * sy - omega**2 * sx, epsilon * sx - omega**2 * sy
    beyond = centre_of_percussion(gyration**2, arm) / arm
    ux, uy = inertia_force(1.0, ax, ay)
    # About O: U at K, against the inertia moment about S and U at S.
    at_k = beyond * (sx * uy - sy * ux)
    about_o = sx * uy - sy * ux + inertia_moment(gyration**2, epsilon)
    assert abs(at_k - about_o) <= 16 * EPS * (beyond * arm * math.hypot(ux, uy) + gyration**2 * abs(epsilon))


def test_centre_of_percussion__of_a_uniform_rod_hung_at_its_end():
    length = 1.7
    assert math.isclose(centre_of_percussion(length**2 / 12, length / 2), 2 * length / 3, rel_tol=4 * EPS)


def test_resultant__where_nothing_accelerates():
    assert math.isinf(inertia_offset(0.1, 0.0, 0.0, 2.0))
    assert math.isnan(inertia_offset(0.1, 0.0, 0.0, 0.0))


# Rotors in space


def rotation(angles):
    """R = R_z R_x R_z by the three Euler angles."""
    result = mp.eye(3)
    for axis, angle in zip("zxz", angles, strict=True):
        c, s = mp.cos(angle), mp.sin(angle)
        turn = {"z": [[c, -s, 0], [s, c, 0], [0, 0, 1]], "x": [[1, 0, 0], [0, c, -s], [0, s, c]]}[axis]
        result = result * mp.matrix(turn)
    return result


def matrix_rate(function, t):
    """Derivative of a matrix by the central difference of fourth order, h = 1e-10: off by 1e-40 and its rounding."""
    h = mp.mpf(10) ** -10
    weights = ((1, 8), (-1, -8), (2, -1), (-2, 1))
    return sum((function(t + k * h) * w for k, w in weights), 0 * function(t)) / (12 * h)


def body_rates(angles_at, t):
    """Angular velocity in the body's axes: the vector of RᵀdR/dt."""
    spin = rotation(angles_at(t)).T * matrix_rate(lambda s: rotation(angles_at(s)), t)
    return mp.matrix([spin[2, 1], spin[0, 2], spin[1, 0]])


@settings(deadline=None, max_examples=15)
@given(
    st.lists(st.floats(-2.0, 2.0), min_size=9, max_size=9),
    st.lists(st.floats(1e-3, 1e3), min_size=3, max_size=3),
    st.lists(st.floats(-1e3, 1e3), min_size=3, max_size=3),
)
def test_euler_equations__are_the_rate_of_the_angular_momentum(motion, principal, products):
    with mp.workdps(60):
        coefficients = [[mp.mpf(c) for c in motion[3 * i : 3 * i + 3]] for i in range(3)]
        jx, jy, jz, jxy, jyz, jzx = (mp.mpf(j) for j in (*principal, *products))
        inertia = mp.matrix([[jx, -jxy, -jzx], [-jxy, jy, -jyz], [-jzx, -jyz, jz]])

        def angles_at(t):
            return [a + b * t + c * t * t for a, b, c in coefficients]

        def momentum(t):
            turn = rotation(angles_at(t))
            return turn * inertia * body_rates(angles_at, t)

        t = mp.mpf(1) / 3
        w, e = body_rates(angles_at, t), matrix_rate(lambda s: body_rates(angles_at, s), t)
        expected = -(rotation(angles_at(t)).T * matrix_rate(momentum, t))
        w, e, expected = ([float(v) for v in vector] for vector in (w, e, expected))
    found = np.add(euler_moment(*principal, *w, *e), euler_moment_of_products(*products, *w, *e))
    # Each of some fifteen terms is at most the greatest J times ω² + |ε|, rounded twice.
    size = max(map(abs, (*principal, *products))) * (np.dot(w, w) + np.abs(e).max())
    assert np.abs(found - expected).max() <= 32 * EPS * size + 1e-30


def test_rotor_of_point_masses__loads_its_fixed_axis():
    rng = np.random.default_rng(8)
    m, (x, y, z) = rng.uniform(0.1, 2, 6), rng.uniform(-1, 1, (3, 6))
    omega, epsilon = 7.0, -4.0
    force = -m * np.array([-epsilon * y - omega**2 * x, epsilon * x - omega**2 * y, 0 * x])
    expected = np.cross([x, y, z], force, axis=0).sum(axis=1)
    jz, jyz, jzx = (m * (x**2 + y**2)).sum(), (m * y * z).sum(), (m * z * x).sum()
    found = fixed_axis_moment(jz, jyz, jzx, omega, epsilon)
    # Sums of a dozen terms, each at most m ω².
    np.testing.assert_allclose(found, expected, rtol=0, atol=32 * EPS * m.sum() * omega**2)
    jx, jy, jxy = (m * (y**2 + z**2)).sum(), (m * (z**2 + x**2)).sum(), (m * x * y).sum()
    rates = (0.0, 0.0, omega, 0.0, 0.0, epsilon)
    in_space = np.add(euler_moment(jx, jy, jz, *rates), euler_moment_of_products(jxy, jyz, jzx, *rates))
    np.testing.assert_allclose(found, in_space, rtol=0, atol=8 * EPS * jz * omega**2)


# Fields


def slider_crank(**parts):
    """A uniform rod with points at ±L/(2√3) from its middle: two halves of its mass there have all its inertia."""
    length = 0.8
    arms = (length / 2 - length / math.sqrt(12), length / 2 + length / math.sqrt(12))
    return {
        "points": {"O": frame(0, 0), "N": on("rod", arms[0], 0), "F": on("rod", arms[1], 0), "S": on("rod", 0.4, 0)},
        "guides": {"way": {"angle": 0.2, "y": 0.05}},
        "input": crank(),
        "groups": {"g": rrp("B", ("rod", "A", length), "slider", "way")},
        "bodies": {
            "bar": {"link": "rod", "mass": 3.0, "shape": {"type": "rod", "length": length}},
            "ram": {"link": "slider", "mass": 4.0},
        },
        **parts,
    }


REPLACED = {"bodies.bar.replace": {"type": "dynamic", "at": ["A"]}}


@pytest.mark.parametrize("changes", [{}, REPLACED], ids=["body", "replaced"])
def test_fields__inertia_forces_of_two_halves(changes):
    names = [f"{p}.{k}" for p in "NFS" for k in ("x", "y", "ax", "ay")] + ["B.ax", "B.ay"]
    fields = ["bar.inertia_force_x", "bar.inertia_force_y", "bar.inertia_moment", "bar.inertia_offset"]
    rams = ["ram.inertia_force_x", "ram.inertia_force_y", "ram.inertia_moment", "ram.inertia_offset"]
    varied = {"input.speed": [5.0, -11.0], "bodies.bar.mass": [3.0, 0.5]}
    _, outcome = evaluated(changed(slider_crank(), changes), [*names, *fields, *rams], varied, 24)
    for i, mass in enumerate(varied["bodies.bar.mass"]):
        f = {name: row[i] for name, row in outcome.fields.items()}
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


def test_field__of_a_crank_at_uniform_speed_points_outward():
    scene = slider_crank(bodies={"web": {"link": "crank", "mass": 2.0, "x": 0.1, "inertia": 0.3}})
    fields = [f"web.inertia_{k}" for k in ("force_x", "force_y", "moment", "offset")]
    machine, outcome = evaluated(scene, fields, {"input.speed": [5.0]}, 16)
    found = [outcome.fields[name][0] for name in fields]
    # m r ω² along the crank.
    expected = 2.0 * 0.1 * 25.0 * np.array([np.cos(machine.nodes), np.sin(machine.nodes)])
    np.testing.assert_allclose(found[:2], expected, rtol=0, atol=4 * EPS * 5.0)
    assert (np.abs(found[2:]) == 0).all()


def test_statistics_of_inertia_fields__may_be_asked():
    machine = Machine(Scene.model_validate(slider_crank()), ["bar.inertia_force_x.peak", "bar.inertia_moment.rms"])
    found = machine.evaluate({})
    assert all(np.isfinite(found.summaries[n][0]) for n in machine.asked_summaries)
