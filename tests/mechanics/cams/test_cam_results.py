"""Results of cams against closed forms, many digits, dense samples, and against each other where they must agree."""

import math

import mpmath
import numpy as np
import pytest
from cam_samples import ARM, CAMS, FACE, FLAT, KNIFE, ROLLER, cam_answers, cam_of, cam_scene
from element_samples import results
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from engine import ElementsAlone, Verdict, cam_curves, scene_numbers

OMEGA = 600 * math.pi / 30


def within(value, error, true, slack=0.0):
    assert abs(value - true) <= error + slack, f"{value} ± {error} against {true}"


@pytest.mark.parametrize(
    ("law", "velocity", "acceleration", "jerk"),
    [
        ("harmonic", math.pi / 2, math.pi**2 / 2, None),
        ("parabolic", 2.0, 4.0, None),
        ("cycloidal", 2.0, 2 * math.pi, 4 * math.pi**2),
        ("3-4-5", 15 / 8, 10 / math.sqrt(3), 60.0),
        ("4-5-6-7", 35 / 16, 84 * math.sqrt(5) / 25, 52.5),
        ("modified sine", 4 * math.pi / (math.pi + 4), 4 * math.pi**2 / (math.pi + 4), 16 * math.pi**3 / (math.pi + 4)),
        ("modified trapezoid", 2.0, 8 * math.pi / (math.pi + 2), 32 * math.pi**2 / (math.pi + 2)),
    ],
)
def test_greatest_motion__is_the_known_peak(law, velocity, acceleration, jerk):
    values, errors, status = cam_answers(
        ROLLER, sections__out__law=law, sections__back__law=law, sections__back__angle="100 deg"
    )
    assert status == Verdict.OK
    rate = OMEGA / math.radians(100)
    within(values["greatest_velocity"], errors["greatest_velocity"], velocity * 0.02 * rate)
    for name in ("greatest_acceleration", "greatest_deceleration"):
        within(values[name], errors[name], acceleration * 0.02 * rate**2)
    if jerk is None:
        assert math.isnan(values["greatest_jerk"])
        assert values["acceleration_jump"] > 0
    else:
        within(values["greatest_jerk"], errors["greatest_jerk"], jerk * 0.02 * rate**3)
        assert values["acceleration_jump"] == 0.0


LAWS = ["parabolic", "harmonic", "cycloidal", "3-4-5", "4-5-6-7", "modified sine", "modified trapezoid"]


@st.composite
def cams(draw):
    """Cams of any proportions, from shapes hardly lifted to strokes of ten base radii."""
    number = lambda a, b: draw(st.floats(a, b))  # noqa: E731
    base = 10 ** number(-3, 0)
    roller = base * number(0.05, 1.5)
    out, rest, back = number(0.3, 2.4), number(0.05, 1.0), number(0.3, 2.4)
    return ROLLER | {
        "base_radius": base,
        "speed": 10 ** number(0, 3),
        "sections": {
            "out": {"type": "rise", "law": draw(st.sampled_from(LAWS)), "angle": out, "lift": base * number(0.01, 3)},
            "rest": {"type": "dwell", "angle": rest},
            "back": {"type": "return", "law": draw(st.sampled_from(LAWS)), "angle": back},
            "low": {"type": "dwell"},
        },
        "follower": ROLLER["follower"]
        | {"roller_radius": roller, "offset": (base + roller) * number(-0.9, 0.9), "preload": 1e4, "stiffness": 1e4},
    }


@settings(max_examples=8)
@given(cams())
def test_extremes__are_those_of_dense_samples(cam):
    """Samples lie below the extremes, by no more than a few parts in 1e4."""
    values, errors, status = cam_answers(cam)
    curves = cam_curves(cam_of(cam), 4000)
    radius = cam["follower"]["roller_radius"]
    alpha, pitch = curves.pressure_angle, curves.curvature / (1 + radius * curves.curvature)
    assert (1 / pitch[pitch > 0].max() <= radius) == (status == Verdict.UNDERCUT)
    most = max(values["rise_pressure_angle"], values["return_pressure_angle"])
    off = max(errors["rise_pressure_angle"], errors["return_pressure_angle"])
    moving = curves.first != 0
    seen = np.abs(alpha[moving]).max()
    assert seen <= most + 2 * off
    assert seen == pytest.approx(most, rel=3e-3, abs=1e-3)
    assert values["undercut_radius"] <= (1 / pitch.max()) * (1 + 1e-12) + errors["undercut_radius"]
    assert values["undercut_radius"] == pytest.approx(1 / pitch.max(), rel=2e-2)
    if status == Verdict.OK:
        for found, sampled in (
            ("greatest_contact_force", curves.force.max()),
            ("greatest_moment", curves.moment.max()),
        ):
            assert sampled <= values[found] + errors[found]
            assert sampled == pytest.approx(values[found], rel=3e-3)
        assert values["least_contact_force"] <= curves.force.min() + errors["least_contact_force"]
        assert abs(values["mean_moment"]) <= errors["mean_moment"]


@pytest.mark.parametrize("cam", [ROLLER, FLAT, ARM, FACE], ids=["roller", "flat", "arm", "face"])
def test_needed_preload_and_lift_off_speed__are_where_the_force_vanishes(cam):
    fast = {"speed": "3000 rpm"}
    values, _errors, status = cam_answers(cam, **fast)
    assert status == Verdict.LIFTS_OFF
    assert math.isnan(values["greatest_contact_force"])
    assert math.isnan(values.get("contact_pressure", math.nan))
    needed = values["needed_preload"]
    just, off, fine = cam_answers(cam, follower__preload=needed * (1 + 1e-9), **fast)
    assert fine == Verdict.OK
    assert just["least_contact_force"] < 1e-7 * just["greatest_contact_force"]
    assert cam_answers(cam, follower__preload=needed * (1 - 1e-9), **fast)[2] == Verdict.LIFTS_OFF
    speed = values["lift_off_speed"]
    assert cam_answers(cam, speed=speed * (1 - 1e-9))[2] == Verdict.OK
    assert cam_answers(cam, speed=speed * (1 + 1e-9))[2] == Verdict.LIFTS_OFF
    exactly, off, _ = cam_answers(cam, "lift_off_speed", follower__preload=needed, **fast)
    within(exactly["lift_off_speed"], off["lift_off_speed"], 3000 * math.pi / 30, 1e-9)


@settings(max_examples=6)
@given(cams(), st.floats(0.2, 1.0), st.floats(0.0, 0.5))
def test_least_base_circle__just_keeps_its_limits(cam, angle, share):
    radius = share * cam["base_radius"]
    cam = cam | {"limits": {"pressure_angle": angle, "convex_radius": radius}}
    values, _, _ = cam_answers(cam, "least_base_radius")
    least = values["least_base_radius"]
    offset = abs(cam["follower"]["offset"])
    if least == 0.0 or least + cam["follower"]["roller_radius"] < offset * (1 + 1e-3):
        return
    names = ("rise_pressure_angle", "return_pressure_angle", "convex_radius")
    just, _, _ = cam_answers(cam, *names, base_radius=least * (1 + 1e-6))
    below, _, _ = cam_answers(cam, *names, base_radius=least * (1 - 1e-6))

    def kept(found):
        return found["convex_radius"] >= radius and max(found[n] for n in names[:2]) <= angle

    assert kept(just)
    assert not kept(below)


@st.composite
def swinging_cams(draw):
    """Cams whose follower swings, with limits that may or may not be kept by some base circle."""
    number = lambda a, b: draw(st.floats(a, b))  # noqa: E731
    flat = draw(st.booleans())
    d = 10 ** number(-2, 0)
    arm, roller = d * number(0.3, 1.3), d * number(0.02, 0.2)
    follower = {"type": "oscillating", "pivot_distance": d, "opens": draw(st.sampled_from(["with", "against"]))}
    follower |= {"contact": "flat"} if flat else {"contact": "roller", "arm": arm, "roller_radius": roller}
    limits = {"convex_radius": d * draw(st.sampled_from([0.0, number(0.0, 0.3)]))}
    if not flat and draw(st.booleans()):
        limits["pressure_angle"] = number(0.3, 1.2)
    law = st.sampled_from(LAWS)
    return {
        "type": "cam",
        "base_radius": d / 2 if flat else math.sqrt(arm**2 + d**2 - 2 * arm * d * math.cos(0.6)) - roller,
        "speed": 10,
        "follower": follower,
        "limits": limits,
        "sections": {
            "out": {"type": "rise", "law": draw(law), "angle": number(0.6, 2.2), "swing": number(0.05, 0.6)},
            "rest": {"type": "dwell", "angle": number(0.05, 1.0)},
            "back": {"type": "return", "law": draw(law), "angle": number(0.6, 2.2)},
            "low": {"type": "dwell"},
        },
    }


@settings(max_examples=6)
@given(swinging_cams())
def test_least_base_circle_under_an_arm__is_the_least_that_keeps_its_limits(cam):
    """There the cam's own results keep the limits; from nothing up to it, samples of six cams don't."""
    assume(cam["base_radius"] > 0)
    follower, limits = cam["follower"], cam["limits"]
    d, arm, roller = follower["pivot_distance"], follower.get("arm", 0.0), follower.get("roller_radius", 0.0)
    least = cam_answers(cam, "least_base_radius")[0]["least_base_radius"]
    names = ["convex_radius"] + (["rise_pressure_angle", "return_pressure_angle"] if arm else [])

    def kept(base, slack=0.0):
        found = cam_answers(cam, *names, base_radius=base)[0]
        steep = max((found[n] for n in names[1:]), default=0.0) - slack
        return found["convex_radius"] >= limits["convex_radius"] - slack * d and steep <= limits.get(
            "pressure_angle", math.pi
        )

    nothing = (max(abs(d - arm) - roller, 0.0) if arm else 0.0) + 1e-6 * d
    if math.isfinite(least) and least > nothing:
        # Limits may be kept at one circle alone: a parabolic law whose face is touched at infinity on both sides.
        assert kept(least, 1e-7)
        assert not kept(least * (1 - 1e-6))
    up_to = least * (1 - 1e-6) if math.isfinite(least) else (d + arm - roller if arm else d)
    for base in np.linspace(nothing, up_to, 6) if up_to > nothing else []:
        curves = cam_curves(cam_of(cam, base_radius=base), 150)
        # Undercut profiles have their curvatures too: of the roller's path less the roller.
        pitch = curves.curvature / (1 + roller * curves.curvature)
        fine = curves.angle.size > 0 and pitch.max() * (roller + limits["convex_radius"]) <= 1
        if arm and "pressure_angle" in limits:
            fine = fine and np.abs(curves.pressure_angle).max() <= limits["pressure_angle"]
        # Samples may miss an extreme; the cam's results don't.
        assert not (fine and kept(base)), f"{base} keeps the limits, {least} was told"


def test_uniform_motion__has_corners():
    uniform = {"sections__out__law": "uniform", "sections__back__law": "uniform"}
    assert cam_answers(ROLLER, **uniform)[2] == Verdict.UNDERCUT
    values, errors, status = cam_answers(KNIFE, **uniform)
    assert status == Verdict.OK
    # On the slope it is the law's peak, 1; at its ends, on dwells, all of it is lost.
    for name in ("greatest_velocity", "velocity_jump"):
        within(values[name], errors[name], 0.02 / math.radians(100) * OMEGA)
    assert math.isnan(values["greatest_acceleration"])


def test_offset_as_large_as_the_prime_circle__cannot_assemble():
    for offset, verdict in ((37.999999, Verdict.OK), (38.0, Verdict.CANNOT_ASSEMBLE), (39, Verdict.CANNOT_ASSEMBLE)):
        status = cam_answers(ROLLER, "rise_pressure_angle", follower__offset=f"{offset} mm")[2]
        assert status == verdict


@pytest.mark.parametrize("offset", [0.012, -0.05])
def test_offset_of_a_flat_face__only_moves_the_contact(offset):
    limits = {"limits": {"convex_radius": "4 mm"}}
    straight, beside = cam_answers(FLAT, **limits), cam_answers(FLAT, follower__offset=offset, **limits)
    assert straight[2] == beside[2] == Verdict.OK
    for name, value in straight[0].items():
        moved = offset if name in ("face_from", "face_to") else 0.0
        assert beside[0][name] == pytest.approx(value - moved, abs=1e-15, nan_ok=True), name


def test_groove__is_pressed_on_both_flanks():
    groove = {"closure": "form", "follower__preload": None, "follower__stiffness": None}
    values, _, status = cam_answers(ROLLER, line_contact={"width": "12 mm"}, **groove)
    assert status == Verdict.OK
    assert "least_contact_force" not in values
    curves = cam_curves(cam_of(ROLLER, **groove), 20_000)
    assert values["greatest_contact_force"] == pytest.approx(np.abs(curves.force).max(), rel=1e-6)
    pitch = curves.curvature / (1 + 0.008 * curves.curvature)
    modulus = 206e9 / 2 / (1 - 0.3**2)
    gaps = np.where(curves.force > 0, 1 / 0.008 + curves.curvature, 1 / 0.008 - pitch / (1 + 0.008 * pitch))
    pressed = np.sqrt(np.abs(curves.force) * gaps * modulus / math.pi / 0.012)
    assert values["contact_pressure"] == pytest.approx(pressed.max(), rel=1e-6)


@pytest.mark.parametrize("driven", [{}, {"closure": "form", "speed": "3000 rpm"}], ids=["spring", "groove that pulls"])
def test_friction_in_the_guide__costs_work_and_may_jam(driven):
    guide = {"follower__guide_length": "60 mm", "follower__overhang": "40 mm"} | driven
    values, errors, status = cam_answers(ROLLER, follower__friction=0.1, **guide)
    assert status == Verdict.OK
    assert values["mean_moment"] > 100 * errors["mean_moment"]
    # What is lost rubs in the guide: its force times the way, from the courses themselves.
    curves = cam_curves(cam_of(ROLLER, follower__friction=0.1, **guide), 40_000)
    assert (curves.force.min() < 0.0) == bool(driven)
    share = 1 + 2 * (0.040 - curves.displacement) / 0.060
    rubbed = 0.1 * share * np.abs(curves.force * np.sin(curves.pressure_angle) * curves.first)
    assert values["mean_moment"] == pytest.approx(np.trapezoid(rubbed, curves.angle) / (2 * math.pi), rel=1e-5)
    assert cam_answers(ROLLER, follower__friction=1.5, **guide)[2] == Verdict.JAMS


def test_least_force_under_friction__is_where_the_pressure_angle_vanishes():
    """There friction changes its side, and forces bend: the normal points along the guide, s′ being the offset."""
    base, speed, offset, lift, angle = 0.016, 1.28, 0.013, 0.0133, 0.525
    values, errors, status = cam_answers(
        KNIFE,
        base_radius=base,
        speed=speed,
        sections__out__law="parabolic",
        sections__out__lift=lift,
        sections__out__angle=angle,
        follower__offset=offset,
        **{f"follower__{key}": x for key, x in {"mass": 0.5, "preload": 80.0, "stiffness": 8000.0}.items()},
        **{f"follower__{key}": x for key, x in {"friction": 0.15, "guide_length": 0.06, "overhang": 0.04}.items()},
    )
    assert status == Verdict.OK
    at = offset * angle**2 / (4 * lift)
    force = 80.0 + 8000.0 * 2 * lift * (at / angle) ** 2 + 0.5 * speed**2 * 4 * lift / angle**2
    within(values["least_contact_force_at"], errors["least_contact_force_at"], at)
    within(values["least_contact_force"], errors["least_contact_force"], force)


def exact_cubics(over_angle, lift, interpolation):
    """Pieces of a table over a turn with many digits: length, and coefficients of u⁰ to u³."""
    x, y, rows = [mpmath.radians(mpmath.mpf(a)) for a in over_angle], [mpmath.mpf(a) / 1000 for a in lift], len(lift)
    h = [(x[k + 1] if k + 1 < rows else x[0] + 2 * mpmath.pi) - x[k] for k in range(rows)]
    chord = [(y[(k + 1) % rows] - y[k]) / h[k] for k in range(rows)]
    if interpolation == "spline":
        matrix = mpmath.matrix(rows, rows)
        for k in range(rows):
            matrix[k, k - 1 if k else rows - 1] += h[k]
            matrix[k, k] += 2 * (h[k - 1] + h[k])
            matrix[k, (k + 1) % rows] += h[k - 1]
        right = [3 * (h[k] * chord[k - 1] + h[k - 1] * chord[k]) for k in range(rows)]
        slope = list(mpmath.lu_solve(matrix, mpmath.matrix(right)))
    else:
        slope = [mpmath.mpf(0)] * rows
        for k in range(rows):
            if chord[k - 1] * chord[k] > 0:
                w, v = 2 * h[k] + h[k - 1], h[k] + 2 * h[k - 1]
                slope[k] = (w + v) / (w / chord[k - 1] + v / chord[k])
    for k, (a, b) in enumerate(zip(slope, slope[1:] + slope[:1], strict=True)):
        yield h[k], y[k], a, (3 * chord[k] - 2 * a - b) / h[k], (a + b - 2 * chord[k]) / h[k] ** 2


# Powers of the speed in the peaks.
PEAKS = {"greatest_velocity": 1, "greatest_acceleration": 2, "greatest_deceleration": 2}
PEAKS |= {"greatest_jerk": 3, "acceleration_jump": 2}


def exact_peaks(cubics):
    """The `PEAKS` at unit speed."""
    slopes, ends = [], []
    for h, _, c1, c2, c3 in cubics:
        at = [mpmath.mpf(0), h, *([-c2 / (3 * c3)] if c3 and 0 < -c2 / (3 * c3) < h else [])]
        slopes += [c1 + u * (2 * c2 + 3 * c3 * u) for u in at]
        ends.append((2 * c2, 2 * c2 + 6 * c3 * h))
    both = [a for pair in ends for a in pair]
    jump = max(abs(after[0] - before[1]) for before, after in zip(ends, ends[1:] + ends[:1], strict=True))
    jerk = max(abs(b - a) / c[0] for (a, b), c in zip(ends, cubics, strict=True))
    return max(map(abs, slopes)), max(both), -min(both), jerk, jump


@pytest.mark.parametrize("interpolation", ["spline", "pchip"])
@pytest.mark.parametrize("gaps", ["even", "uneven", "pairs", "spread"])
def test_peaks_of_a_table__are_those_of_its_exact_cubics(gaps, interpolation):
    """Rounding of a row shows in all near it, by its size per power of the smallest gap."""
    rng = np.random.default_rng(1)
    for rows in (12, 24, 40):
        gap = {
            "even": np.ones(rows),
            "uneven": rng.uniform(0.2, 1.0, rows),
            "pairs": np.where(rng.random(rows) < 0.15, 1e-3, rng.uniform(0.5, 1.0, rows)),
            "spread": 10.0 ** rng.uniform(-3.5, 0.0, rows),
        }[gaps]
        angles = [f"{a:.6f}" for a in 360.0 * np.concatenate([[0.0], np.cumsum(gap)[:-1]]) / gap.sum()]
        lift = [f"{9.0 * math.sin(math.radians(float(a)) / 2.0) ** 3:.6f}" for a in angles]
        table = {"over_angle": [f"{a} deg" for a in angles], "lift": [f"{a} mm" for a in lift]}
        follower = {"type": "translating", "contact": "flat"}
        cam = {"sections": None, "table": table | {"interpolation": interpolation}, "follower": follower}
        values, errors, _ = cam_answers(FLAT, base_radius="1 km", **cam)
        with mpmath.workdps(30):
            peaks = exact_peaks(list(exact_cubics(angles, lift, interpolation)))
            speed = mpmath.mpf(600) * mpmath.pi / 30
            for (name, power), peak in zip(PEAKS.items(), peaks, strict=True):
                jumps = interpolation == "pchip"
                if name != ("greatest_jerk" if jumps else "acceleration_jump"):
                    true = peak * speed**power
                    off = float(abs(mpmath.mpf(float(values[name])) - true))
                    assert off <= errors[name], (rows, name, off / errors[name])
                    assert gaps != "even" or errors[name] < 1e-10 * float(true), name


def test_face_length__is_as_sure_as_its_ends():
    """Under a face that hardly swings the ends of the contact all but coincide."""
    swing, half = 1e-7, "180 deg"
    sections = {
        "out": {"type": "rise", "law": "harmonic", "angle": half, "swing": swing},
        "back": {"type": "return", "law": "harmonic"},
    }
    values, errors, status = cam_answers(FACE, sections=sections)
    assert status == Verdict.OK
    with mpmath.workdps(30):
        d, psi, h = mpmath.mpf(0.08), mpmath.asin(mpmath.mpf(0.04) / mpmath.mpf(0.08)), mpmath.mpf(swing) / 2

        def contact(phi):
            return d * mpmath.cos(psi + h * (1 - mpmath.cos(phi))) / (1 + h * mpmath.sin(phi))

        ends = [contact(mpmath.findroot(lambda phi: mpmath.diff(contact, phi), x)) for x in (2.0, 5.0)]
        within(values["face_length"], errors["face_length"], float(abs(ends[1] - ends[0])))


def test_arm_all_but_in_line__has_estimates():
    """A rounding changes the angle by the root of its share; a larger change and the arm doesn't reach the cam."""
    base, arm, d = 0.002 * (1 + 1e-9), 0.07, 0.08
    values, errors, _ = cam_answers(ARM, "rise_pressure_angle", "convex_radius_at", base_radius=base)
    with mpmath.workdps(30):
        prime, a, d = mpmath.mpf(base) + mpmath.mpf(0.008), mpmath.mpf(arm), mpmath.mpf(d)
        cosine = (a * a + d * d - prime * prime) / (2 * a * d)
        true = mpmath.atan2(a - d * cosine, d * mpmath.sqrt(1 - cosine * cosine))
        within(values["rise_pressure_angle"], errors["rise_pressure_angle"], abs(float(true)))
    assert max(errors.values()) < 1e-3


@pytest.mark.parametrize("growth", [1e-7, 3e-7, 1e-6])
def test_peak_next_to_a_sample__is_not_that_of_the_sample(growth):
    """A spring whose force grows by a small share moves the peak torque from the middle of a cycloidal rise."""
    lift, force = 0.02, 100.0
    forces = {"follower__mass": 0, "follower__preload": force, "follower__stiffness": growth * force / lift}
    values, errors, _ = cam_answers(FLAT, **forces, sections__out__law="cycloidal")
    with mpmath.workdps(30):
        turn = 2 * mpmath.pi

        def moment(u):
            s = u - mpmath.sin(turn * u) / turn
            return force * lift * (1 + growth * s) * (1 - mpmath.cos(turn * u)) / mpmath.radians(100)

        peak = moment(mpmath.findroot(lambda u: mpmath.diff(moment, u), 0.5))
        within(values["greatest_moment"], errors["greatest_moment"], float(peak))


def test_sections_of_variants__that_make_no_turn_are_outside_limits():
    angles = np.radians([100.0, 209.0, 210.0, 300.0])
    status = results(ROLLER, "greatest_velocity", sections__out__angle=angles)[2]
    assert status.tolist() == [Verdict.OK, Verdict.OK, Verdict.OUTSIDE_LIMITS, Verdict.OUTSIDE_LIMITS]


FRICTION = {"follower__friction": 0.3, "follower__guide_length": "60 mm", "follower__overhang": "40 mm"}
LINE = {"line_contact": {"width": "12 mm"}}
EXTREME = {
    "offset near the prime circle": (ROLLER, {"follower__offset": "37.9999 mm"}),
    "base circle near zero": (
        ROLLER,
        {"base_radius": "0.01 mm", "follower__roller_radius": "0.005 mm", "follower__offset": "0 mm"},
    ),
    "limits": (ROLLER, LINE | {"limits": {"pressure_angle": "30 deg", "convex_radius": "4 mm"}}),
    "roller nearly as large as the curvature": (
        ROLLER,
        LINE
        | {"sections__out__angle": "40 deg", "follower__preload": "2 kN"}
        | {"follower__roller_radius": "11.7 mm", "base_radius": "26.3 mm"},
    ),
    "friction": (ROLLER, FRICTION),
    "arm nearly in line": (ARM, {"base_radius": "135 mm"}),
    "table": (
        FLAT,
        {
            "sections": None,
            "table": {
                "over_angle": ["0 deg", "60 deg", "120 deg", "240 deg"],
                "lift": ["0 mm", "5 mm", "10 mm", "3 mm"],
            },
        },
    ),
}


@pytest.mark.parametrize("name", [*CAMS, *EXTREME])
def test_error_figures__hold_what_rounding_of_the_numbers_makes(name):
    """Every number of the scene is moved in turn; its rounding makes as much less as it is smaller than the move."""
    cam, changes = EXTREME.get(name, (CAMS.get(name), {}))
    scene, nudge = cam_scene(cam, **changes), 2.0**-26
    numbers = {path: number.value for path, number in scene_numbers(scene).items()}
    names = [key for key in ElementsAlone(scene).available_summaries if not key.endswith("_at")]
    moved = {path: np.full(len(numbers) + 1, value) for path, value in numbers.items()}
    for k, values in enumerate(moved.values()):
        values[k + 1] *= 1 + nudge
    outcome = ElementsAlone(scene, names, varied=list(moved)).evaluate(moved)
    assert outcome.status[0] == Verdict.OK
    for key in names:
        values = outcome.summaries[key]
        if np.isfinite(values[0]):
            made = np.nansum(np.abs(values[1:] - values[0])) * 2.0**-53 / nudge
            assert made <= outcome.errors[key][0], key
