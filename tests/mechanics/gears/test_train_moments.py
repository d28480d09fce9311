"""Moments and losses of gear trains against closed forms, virtual power, and all directions tried one by one."""

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest
from element_samples import results, solved
from gear_samples import simple_planetary, stepped_planetary, toothed
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from engine import Verdict

EPS = np.finfo(float).eps
SPEED, LOAD = 100.0, -50.0


def near(found, exact):
    value, error = found
    assert abs(value - exact) <= error + 16 * EPS * abs(exact)


def balanced(found, shafts, meshes):
    """Moments and the frame's, which holds what is held, add up to nothing; meshes lose shares of what rolls by."""
    free = [s for s in shafts if f"{s}.moment" in found and found[f"{s}.speed"][0] != 0]
    moments = [found[f"{s}.moment"] for s in free] + [found["frame.moment"]]
    assert abs(sum(m for m, _ in moments)) <= 2 * sum(e for _, e in moments)
    lost = sum((1 - found[f"{m}.efficiency"][0]) * abs(found[f"{m}.rolling_power"][0]) for m in meshes)
    into, figure = found["input_power"]
    assert abs(lost - found["loss"][0]) <= 4 * figure + found["loss"][1] + 64 * EPS * into
    assert found["loss"][0] >= -found["loss"][1]


# A high reduction by wheels outside on both sides: i₀ = z₂ z₄/(z₁ z₃) next to 1.
DAVID = (99, 100, 101, 100)


@pytest.mark.parametrize("eta", [0.999, 0.99, 0.98])
def test_basic_ratio_next_to_one__loses_nearly_all_and_locks_backwards(eta):
    i0, both = Fraction(100 * 100, 99 * 101), Fraction(eta) ** 2
    assert i0 > 1
    roles = {"arm": {"speed": SPEED}, "first": {"moment": LOAD}, "fourth": {"held": True}}
    roles["first"]["moment"] = math.copysign(LOAD, i0 - 1)  # arm ahead, first turns by 1 − i₀ < 0
    found = solved(stepped_planetary(*DAVID, roles, mesh={"efficiency": eta}))
    # T_first given, so T_arm = −T_first (1 − i₀ η^w): efficiencies of both ways, that below one holds.
    shares = [(1 - i0) / (1 - i0 * both**w) for w in (1, -1)]
    near(found["efficiency"], float(next(s for s in shares if 0 < s < 1)))
    assert found["self_locking"][0] == 1
    assert np.isnan(found["backward_efficiency"][0])
    balanced(found, ("first_shaft", "arm", "fourth_shaft"), ("one", "two"))
    # Loss exceeds what the load could put in: driven by its load the train stays where it is.
    roles["first"]["moment"] *= -1
    found, _, status = results(stepped_planetary(*DAVID, roles, mesh={"efficiency": eta}))
    assert status == Verdict.SELF_LOCKS
    assert np.isnan(found["efficiency"][0])
    assert np.isnan(found["arm.moment"][0])
    # Driven from the side of the wheel, with its moment given, it stands.
    roles = {"first": {"speed": SPEED, "moment": -LOAD}, "arm": {"loaded": True}, "fourth": {"held": True}}
    _, _, status = results(stepped_planetary(*DAVID, roles, mesh={"efficiency": eta}))
    assert status == Verdict.STANDS


def all_directions(teeth_, eta, omega, moments, unknown):
    """Equilibria of a train of two meshes (first–second, third–fourth on the block) for every set of directions."""
    z1, z2, z3, z4 = teeth_
    rows = {"first": 0, "block": 1, "arm": 2, "fourth": 3}
    found = []
    for senses in itertools.product((1, -1), repeat=2):
        acts = np.zeros((4, 2))
        for j, (a, b, za, zb) in enumerate((("first", "block", z1, z2), ("block", "fourth", z3, z4))):
            ka, kb = (1, eta) if senses[j] > 0 else (eta, 1)
            acts[rows[a], j] += za * ka
            acts[rows[b], j] += zb * kb
            acts[rows["arm"], j] -= za * ka + zb * kb
        system = np.hstack([acts, np.array([[float(name == u) for u in unknown] for name in rows])])
        forces = np.linalg.solve(system, [-moments.get(name, 0.0) for name in rows])
        rolling = [-forces[0] * z1 * (omega["first"] - omega["arm"]), -forces[1] * z3 * (omega["block"] - omega["arm"])]
        if all(r * s >= 0 for r, s in zip(rolling, senses, strict=True)):
            found.append(moments | dict(zip(unknown, forces[2:], strict=True)))
    return found


@given(
    z=st.tuples(*[st.integers(20, 60)] * 4),
    eta=st.floats(0.85, 0.999),
    drive=st.sampled_from(["first", "arm", "fourth"]),
    held=st.sampled_from(["first", "arm", "fourth"]),
    drive_given=st.booleans(),
)
@settings(max_examples=15)
def test_directions__are_those_in_which_power_comes_out_or_the_train_stands(z, eta, drive, held, drive_given):
    assume(drive != held)
    z1, z2, z3, z4 = z
    third = ({"first", "arm", "fourth"} - {drive, held}).pop()
    i0 = z2 * z4 / (z1 * z3)
    assume(abs(i0 - 1) > 1e-6)
    coefficients = {"first": 1.0, "fourth": -i0, "arm": i0 - 1.0}
    omega = {drive: SPEED, held: 0.0, third: -SPEED * coefficients[drive] / coefficients[third]}
    omega["block"] = omega["arm"] - z1 / z2 * (omega["first"] - omega["arm"])
    moments = {drive: 30.0} if drive_given else {third: -math.copysign(30.0, omega[third])}
    unknown = [held, third] if drive_given else [held, drive]
    roles = {drive: {"speed": SPEED}, held: {"held": True}, third: {"loaded": True} if drive_given else {}}
    (given_at,) = moments
    roles[given_at] = {"moment": moments[given_at]} | ({"speed": SPEED} if drive_given else {})
    train, shares = stepped_planetary(*z, roles, mesh={"efficiency": eta}), []
    for m in all_directions(z, eta, omega, moments, unknown):
        into, out = m[drive] * omega[drive], m[third] * omega[third]
        if into > 0 and out < 0:
            shares.append(-out / into)
    if shares:
        # Next to standing, rounding decides whether anything comes out.
        assume(max(shares) > 1e-9)
        found = solved(train)
        near((found["efficiency"][0], found["efficiency"][1] + 1e-9), max(shares))
        balanced(found, ("first_shaft", "arm", "fourth_shaft"), ("one", "two"))
    else:
        assert results(train)[2] == (Verdict.STANDS if drive_given else Verdict.SELF_LOCKS)


def test_mesh_that_carries_nothing__has_any_direction():
    roles = {"sun": {"speed": SPEED}, "arm": {"moment": 0.0}, "ring": {"held": True}}
    found = solved(simple_planetary(20, 30, 80, roles, mesh={"efficiency": 0.9}))
    assert found["sun_shaft.moment"][0] == 0
    assert found["loss"][0] == 0
    assert np.isnan(found["efficiency"][0])


def closed_train(a, b, c, d, load):
    """A planetary set whose arm and ring are both geared to the output: a, b from the arm, c, d from the ring."""
    train = simple_planetary(30, 30, 90, {"sun": {"speed": SPEED}})
    train["wheels"] |= toothed(on_arm=("arm", a), to_arm=("out", b), on_ring=("ring_shaft", c), to_ring=("out", d))
    train["shafts"]["out"] = {"moment": load}
    train["meshes"] |= {"by_arm": {"between": ["on_arm", "to_arm"]}, "by_ring": {"between": ["on_ring", "to_ring"]}}
    return train


@pytest.mark.parametrize(("a", "b", "c", "d"), [(40, 40, 20, 60), (60, 20, 50, 30), (30, 50, 45, 35)])
def test_power_that_circulates__is_what_two_branches_carry_against_each_other(a, b, c, d):
    found = solved(closed_train(a, b, c, d, 20.0))
    # Without losses: arm = −(b/a) ω, ring = −(d/c) ω, sun + 3 ring = 4 arm; T_arm : T_ring : T_sun = −4 : 3 : 1.
    arm, ring = -b / a, -d / c
    sun = 4 * arm - 3 * ring
    out = SPEED / sun
    near(found["out.speed"], out)
    # Powers of both branches over that of the sun, as they leave the planetary set.
    by_arm, by_ring = 4 * arm / sun, -3 * ring / sun
    near((by_arm + by_ring, 0.0), 1.0)
    near(found["circulating_power"], max(abs(by_arm), abs(by_ring)) - 1 if min(by_arm, by_ring) < 0 else 0.0)
    # Tooth forces carry the branches' powers: rolling power of a mesh in the frame is power.
    near(found["by_arm.rolling_share"], abs(by_arm))
    near(found["by_ring.rolling_share"], abs(by_ring))


def test_reactions__of_teeth_and_of_the_planet():
    """Tooth forces from the sun's moment, the pin's from two of them and the planet's mass on its circle."""
    roles = {
        "sun": {"speed": SPEED},
        "arm": {"moment": -90.0},
        "ring": {"held": True},
        "idler": {"mass": 0.4, "inertia": 1e-4},
    }
    found = solved(simple_planetary(24, 30, 84, roles, planets=3, module=0.002))
    pull = 90.0 * 24 / 108 / (0.024 * 3)
    near(found["outer.tangential_force"], pull)
    near(found["inner.tangential_force"], pull)
    near(found["outer.radial_force"], pull * math.tan(math.radians(20)))
    near(found["inner.normal_force"], pull / math.cos(math.radians(20)))
    radius, arm = 0.054, found["arm.speed"][0]
    near(found["idler.pin_force"], math.hypot(2 * pull, 0.4 * radius * arm**2))


def test_planets_bearing__carries_the_arms_moment_whatever_the_meshes_lose():
    """The sun drives the planet, the planet the ring; each tooth force is what its wheels' moments leave to the arm."""
    roles = {"sun": {"speed": SPEED}, "arm": {"moment": -90.0}, "ring": {"held": True}}
    train = simple_planetary(24, 30, 84, roles, planets=3, module=0.002)
    train["meshes"]["outer"]["efficiency"], train["meshes"]["inner"]["efficiency"] = 0.9, 0.8
    found = solved(train)
    sun = 90.0 / (1 + 0.9 * 0.8 * 84 / 24)
    planet, lever = 0.9 * sun * 30 / 24, 3 * 0.054
    outer, inner = (sun + planet) / lever, (0.8 * planet * 84 / 30 - planet) / lever
    near(found["idler.pin_force"], math.hypot(90.0 / lever, (inner - outer) * math.tan(math.radians(20))))


def test_helical_teeth__push_along_the_axis():
    train = {
        "type": "gear_train",
        "module": 0.003,
        "wheels": toothed(a=("s", 20), b=("t", 50)),
        "shafts": {"s": {"speed": SPEED}, "t": {"moment": 300.0}},
        "meshes": {"m": {"between": ["a", "b"], "helix_angle": math.radians(15)}},
    }
    found = solved(train)
    pull = 120.0 / (0.03 / math.cos(math.radians(15)))
    near(found["m.tangential_force"], pull)
    near(found["m.axial_force"], pull * math.tan(math.radians(15)))
    parts = [found[f"m.{part}_force"][0] for part in ("tangential", "radial", "axial")]
    near(found["m.normal_force"], math.hypot(*parts))
    near(found["frame.moment"], -(found["s.moment"][0] + 300.0))
