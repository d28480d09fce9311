"""Single bodies that turn: against integrals over the body, integration in time, and equilibrium of rings."""

import math

import mpmath
import numpy as np
import pytest
from each_case import refusals
from element_samples import LEVER, TIE, WOUND, element, figures, one, results
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp
from scipy.spatial.transform import Rotation

from engine import Verdict

some = settings(max_examples=20)
angles = st.floats(-3.0, 3.0)
FIXED = [f"fixed_inertia_{axis}" for axis in "xyz"] + [f"fixed_product_{pair}" for pair in ("xy", "yz", "zx")]
PRINCIPAL = ["greatest_inertia", "middle_inertia", "least_inertia"]


# A body about fixed axes


def cloud(masses, points):
    """Moments and products of inertia of mass points, straight from their definition."""
    x, y, z = points.T
    moments = [np.sum(masses * (y * y + z * z)), np.sum(masses * (z * z + x * x)), np.sum(masses * (x * x + y * y))]
    return np.array([*moments, np.sum(masses * x * y), np.sum(masses * y * z), np.sum(masses * z * x)])


@some
@given(st.integers(0, 10**6), angles, angles, angles, st.floats(-2, 2), st.floats(-2, 2))
def test_tilted_cloud_of_points__has_the_sums_over_the_turned_points(seed, yaw, pitch, roll, x, z):
    generator = np.random.default_rng(seed)
    masses, points = generator.uniform(0.1, 2.0, 6), generator.normal(size=(6, 3))
    points -= (masses[:, None] * points).sum(axis=0) / masses.sum()
    own = cloud(masses, points)
    keys = ("inertia_x", "inertia_y", "inertia_z", "product_xy", "product_yz", "product_zx")
    body = {"type": "tilted_body", "mass": masses.sum(), "yaw": yaw, "pitch": pitch, "roll": roll, "x": x, "z": z}
    body |= dict(zip(keys, own, strict=True)) | {"speed": 10.0}
    found = figures(body, *FIXED, "tilting_couple", "centrifugal_force")
    # Intrinsic turns z, y', x'', by another library.
    turned = Rotation.from_euler("ZYX", [yaw, pitch, roll]).apply(points) + np.array([x, 0.0, z])
    wanted = cloud(masses, turned)
    size = wanted[:3].max()
    for (value, error), there in zip(found[:6], wanted, strict=True):
        assert abs(value - there) <= error + 1e-14 * size
        assert error <= 1e-12 * size
    # The moment of the points' centrifugal forces about the origin, and their sum.
    forces = 100.0 * masses[:, None] * turned * np.array([1.0, 1.0, 0.0])
    couple = np.cross(turned, forces).sum(axis=0)
    assert found[6][0] == pytest.approx(np.hypot(*couple[:2]), rel=1e-9, abs=1e-11 * size)
    assert found[7][0] == pytest.approx(np.hypot(*forces.sum(axis=0)[:2]), rel=1e-9, abs=1e-11 * size)


@some
@given(st.floats(1e-6, 1.0), st.floats(0.1, 1.0), angles, angles, angles, st.floats(-1e3, 1e3))
def test_slender_body__is_as_sure_as_its_terms_that_cancel(least, middle, yaw, pitch, roll, x):
    """By many digits: of moments that nearly cancel, a tilted needle or a point far away leave few."""
    axes, names = (least, middle, 1.0), [*FIXED, *PRINCIPAL, "principal_tilt"]
    body = {"type": "tilted_body", "mass": 2.0, "yaw": yaw, "pitch": pitch, "roll": roll, "x": x}
    found = figures(body | {f"semi_axis_{k}": axis for k, axis in zip("xyz", axes, strict=True)}, *names)
    with mpmath.workdps(40):
        a, b, c = (mpmath.mpf(axis) ** 2 for axis in axes)
        turned = mpmath.eye(3)
        for angle, (i, j) in ((yaw, (0, 1)), (pitch, (2, 0)), (roll, (1, 2))):
            about = mpmath.eye(3)
            about[i, i] = about[j, j] = mpmath.cos(angle)
            about[j, i], about[i, j] = mpmath.sin(angle), -mpmath.sin(angle)
            turned = turned * about
        fixed = turned * (mpmath.mpf(2) / 5 * mpmath.diag([b + c, c + a, a + b])) * turned.T
        fixed += 2 * mpmath.mpf(x) ** 2 * mpmath.diag([0, 1, 1])
        principal, own = mpmath.eigsy(fixed)
        tilt = min(mpmath.acos(abs(own[2, k])) for k in range(3))
        wanted = [*(fixed[k, k] for k in range(3)), -fixed[0, 1], -fixed[1, 2], -fixed[2, 0]]
        for (value, error), there in zip(found, [*wanted, *sorted(principal, reverse=True), tilt], strict=True):
            # Products below the normal numbers vanish.
            assert abs(value - there) <= error + np.finfo(float).tiny


def test_moments_that_no_body_has__are_not_answered():
    wrong = {"type": "tilted_body", "mass": 1.0, "inertia_x": 1.0, "inertia_y": 1.0, "inertia_z": 3.0}
    assert results(wrong, "fixed_inertia_x")[2] == Verdict.NOT_FINITE


# A body on a turning lever


@some
@given(
    st.floats(0.1, 300.0), st.floats(0.0, 5.0), st.floats(0.0, 2.0), st.floats(-3.0, -1e-3).map(lambda x: 0.5 * 10**x)
)
def test_body_on_a_lever__moves_as_integrated_in_fixed_axes(speed, velocity, friction, start):
    lever = LEVER | {"speed": speed, "start_velocity": velocity, "friction": friction, "start_radius": start}
    names = ("time", "relative_speed", "reaction", "work", "friction_work", "absolute_speed")
    found = figures(lever, *names)

    # In fixed axes, where there is one force: of the lever, across it, and friction along it.
    def rates(t, y):
        along = np.array([math.cos(speed * t), math.sin(speed * t)])
        across = np.array([-along[1], along[0]])
        r, rate = y[:2] @ along, y[2:4] @ along
        normal = 2.0 * 0.4 * speed * rate
        force = normal * across - friction * abs(normal) * along
        return [*y[2:4], *(force / 0.4), normal * r * speed, friction * abs(normal) * rate]

    def leaves(t, y):
        return math.hypot(y[0], y[1]) - 0.5

    leaves.terminal, leaves.direction = True, 1.0
    begin = [start, 0.0, velocity, speed * start, 0.0, 0.0]
    done = solve_ivp(rates, (0.0, 100.0 / speed), begin, method="DOP853", rtol=1e-11, atol=1e-12, events=leaves)
    at, (x, y, vx, vy, work, heat) = done.t_events[0][0], done.y_events[0][0]
    rate = (x * vx + y * vy) / 0.5
    wanted = (at, rate, 0.8 * speed * rate, work, heat, math.hypot(vx, vy))
    for name, (value, error), there in zip(names, found, wanted, strict=True):
        # What integration leaves, of a growth by up to 500.
        assert value == pytest.approx(there, rel=1e-6, abs=error + 1e-9), name


@some
@given(st.floats(0.1, 300.0), st.floats(0.0, 5.0), st.floats(0.0, 2.0), st.floats(-9.0, -0.1))
def test_body_on_a_lever__heats_it_as_its_exponentials_do(speed, velocity, friction, way):
    """In many digits, also over a short way, where the exponentials cancel."""
    start = 0.5 * (1.0 - 10.0**way)
    lever = LEVER | {"speed": speed, "start_velocity": velocity, "friction": friction, "start_radius": start}
    (turned, _), (heat, error) = figures(lever, "turned_angle", "friction_work")
    with mpmath.workdps(50):
        r, v, f = mpmath.mpf(start), mpmath.mpf(velocity) / mpmath.mpf(speed), mpmath.mpf(friction)
        rates = [-f + mpmath.sqrt(1 + f**2), -f - mpmath.sqrt(1 + f**2)]
        terms = [(v - other * r) / (own - other) for own, other in (rates, rates[::-1])]
        off = lambda y: mpmath.fdot(terms, [mpmath.exp(rate * y) for rate in rates]) - mpmath.mpf(0.5)  # noqa: E731
        end = mpmath.findroot(off, turned)
        wanted = sum(
            term * one * rate * other * (mpmath.expm1((rate + other) * end) / (rate + other) if rate + other else end)
            for term, rate in zip(terms, rates, strict=True)
            for one, other in zip(terms, rates, strict=True)
        )
        wanted *= 2 * f * mpmath.mpf(0.4) * mpmath.mpf(speed) ** 2
        # The rounding of both radii, and of some tens of operations. Products below the normal numbers vanish.
        room = min(error, 64 * np.finfo(float).eps * 10.0**-way * wanted)
        assert abs(heat - wanted) <= room + np.finfo(float).tiny


# A wound flywheel


def test_layers_one_by_one__press_the_ring_as_the_winding_does():
    """Thousands of thin rings shrunk on by their tension: Lamé's stresses of what lies below, added up."""
    a, c, b, tension, layers = 0.05, 0.1, 0.3, 3e8, 20_000
    edges = np.linspace(c, b, layers + 1)
    middles, thick = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
    pressures = tension * thick / middles
    # On the ring up to s, pressed from outside by p: at the bore −2ps²/(s² − a²), at c, −p s²(1 − a²/c²)/(s² − a²).
    bore = -np.sum(2.0 * pressures * middles**2 / (middles**2 - a * a))
    at_ring = np.sum(pressures * middles**2 * (1 - (a / c) ** 2) / (middles**2 - a * a))
    found = one(WOUND, "rest_bore_stress", "winding_pressure")
    assert found == pytest.approx([bore, at_ring], rel=1e-6)


@pytest.mark.parametrize(("bore", "edge"), [(1e-3, 1.002e-3), (4e-3, 4.1e-3), (0.5, 0.52)])
def test_peak_tension_of_the_winding__is_that_of_its_layers(bore, edge):
    """Next to a small bore it is a narrow peak, which closely spaced samples show."""
    speed, density, nu, tension, b = 500.0, 1000.0, 0.3, 1e6, 1.0
    wheel = {"bore": bore, "winding_diameter": edge, "diameter": 2 * b, "poisson_ratio": nu, "speed": speed}
    wheel |= {"winding_stress": tension, "density": density}
    ((value, error),) = figures(WOUND | wheel, "layer_stress")
    a, c = bore / 2, edge / 2
    r = a + (c - a) * ((b - a) / (c - a)) ** np.linspace(0.0, 1.0, 400_001)
    spin = (3 + nu) / 8 * density * speed**2
    stress = tension * (1 - (r * r + a * a) / (2 * r * r) * np.log((b * b - a * a) / (r * r - a * a)))
    stress += spin * (a * a + b * b + (a * b / r) ** 2 - (1 + 3 * nu) / (3 + nu) * r * r)
    assert value == pytest.approx(stress[:-1].max(), rel=1e-8, abs=error)


@some
@given(st.floats(0.02, 0.6), st.floats(0.05, 0.9), st.floats(0.0, 0.49), st.floats(0.0, 5e8), st.floats(10.0, 3000.0))
def test_stresses_of_the_spinning_wheel__carry_its_centrifugal_forces(bore, share, nu, tension, speed):
    winding = bore + share * (0.62 - bore)
    wheel = WOUND | {"bore": bore, "winding_diameter": winding, "diameter": 0.62, "poisson_ratio": nu}
    wheel |= {"winding_stress": tension, "speed": speed}
    names = (
        "bore_stress",
        "plain_bore_stress",
        "pressure",
        "layer_stress",
        "energy_per_mass",
        "parting_speed",
        "parts",
    )
    at_bore, plain, pressure, layer, energy, parting, parts = one(wheel, *names)
    a, c, b, rho = 0.5 * bore, 0.5 * winding, 0.31, 7850.0

    def hoop(r):
        about = math.log((b * b - a * a) / (r * r - a * a))
        spin = (3 + nu) / 8 * rho * speed**2
        rest = tension * (1 - (r * r + a * a) / (2 * r * r) * about)
        return rest + spin * (a * a + b * b + (a * b / r) ** 2 - (1 + 3 * nu) / (3 + nu) * r * r)

    # Half of the winding is held together by its hoop stress and pressed out by its own and the ring's forces:
    # 2∫σ dr = 2∫ρω²r² dr − 2pc, per unit of width; p of the ring presses outwards.
    held = quad(hoop, c, b, epsrel=1e-10, limit=200)[0]
    pushed = rho * speed**2 * (b**3 - c**3) / 3 + pressure * c
    assert held == pytest.approx(pushed, rel=1e-7, abs=1e-7 * (tension + rho * speed**2))
    size = tension + rho * speed**2
    highest = max(hoop(r) for r in np.linspace(c, b, 301))
    # Three hundred places miss little of a smooth top.
    assert highest - 1e-9 * size <= layer <= highest + 2e-3 * size
    # The ring's bore: what is left of it by the winding, of Lamé, pressed by that of the winding at rest.
    assert at_bore - plain == pytest.approx(
        -tension * math.log((b * b - a * a) / (c * c - a * a)), rel=1e-9, abs=1e-9 * size
    )
    assert energy == pytest.approx(speed**2 * (a * a + b * b) / 4, rel=1e-12)
    assert parts == float(speed > parting)
    # At the speed of parting, the outermost layers bear on each other neither way.
    r = b * (1 - 1e-6)
    spin = (3 + nu) / 8 * rho * parting**2
    rest = tension * (r * r - a * a) / (2 * r * r) * math.log((b * b - a * a) / (r * r - a * a))
    assert spin * (b * b - r * r) * (r * r - a * a) / (r * r) == pytest.approx(rest, rel=1e-3, abs=1e-9)


test_wrong_body__is_refused_with_the_mend = refusals(
    element,
    ({"type": "tilted_body", "mass": 1.0}, "all three of one"),
    ({"type": "tilted_body", "mass": 1.0, "semi_axis_x": 1.0, "inertia_x": 1.0}, "all three of one"),
    (LEVER | {"start_radius": 0.5}, "is not above start_radius"),
    (WOUND | {"bore": 0.2}, "is not above bore"),
    (WOUND | {"strength": 2e8}, "would tear"),
)


@pytest.mark.parametrize("stiffness", [50.0, 4e3, 4e5])
def test_impulse__stretches_the_tie_as_far_as_the_motion_followed_over_time(stiffness):
    def rates(t, z):
        x, y, u, v = z
        r = math.hypot(x, y)
        pull = stiffness * (r - 1.2) / (2.0 * r)
        return u, v, -pull * x, -pull * y

    def turns(t, z):
        return z[0] * z[2] + z[1] * z[3] - (1e-9 if t == 0 else 0)

    turns.terminal, turns.direction = True, -1
    motion = solve_ivp(rates, (0, 10), (1.2, 0, 0, 25.0), "DOP853", events=turns, rtol=1e-12, atol=1e-13)
    farthest = math.hypot(*motion.y[:2, -1])
    (stretch,) = one(TIE | {"stiffness": stiffness}, "impulse_stretch")
    # Near its greatest value the radius doesn't depend on when that is.
    assert stretch == pytest.approx(farthest - 1.2, rel=1e-9)


def test_tie__bursts_at_the_speeds_at_which_its_force_is_its_strength():
    mass, length, stiffness, strength = 10.0 ** np.random.default_rng(5).uniform(-4, 4, (4, 400))
    keys = ("mass", "length", "stiffness", "strength")
    ties = dict(zip(keys, (mass, length, stiffness, strength), strict=True))

    def of(*names, **speed):
        return [value for value, _ in figures(TIE, *names, **ties, **speed)]

    by_impulse, by_spin_up = of("impulse_burst_speed", "spin_up_burst_speed")
    # A few roundings; the force changes at most as the square of the speed.
    assert of("impulse_force", speed=by_impulse)[0] == pytest.approx(strength, rel=1e-14)
    assert of("spin_up_force", speed=by_spin_up)[0] == pytest.approx(strength, rel=1e-14)
    impulse, spin_up = of("bursts_by_impulse", "bursts_by_spin_up", speed=0.5 * (by_impulse + by_spin_up))
    assert impulse.all()
    assert not spin_up.any()
