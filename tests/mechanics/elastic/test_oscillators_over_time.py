"""One mass driven over time: against shock spectra, the Laplace transform in many digits, and step by step."""

import math

import mpmath
import numpy as np
import pytest
from each_case import refusals
from element_samples import element, figures
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

OSCILLATOR = {"type": "oscillator", "mass": 2.0, "stiffness": 800.0}
W = 20.0
some = settings(max_examples=12)
ratios = st.one_of(st.floats(0.0, 3.0), st.sampled_from([0.0, 1.0, 1 - 1e-9, 1 + 1e-9, 50.0]))
GREATEST = ("greatest_displacement", "greatest_displacement_at", "spring_force", "spring_force_at")


def driven(kind, instants, rows, ratio=0.0, q=0.0, v=0.0, **more):
    key = "displacement" if kind == "support_over_time" else "force"
    excitation = {"type": kind, "over_time": list(instants), key: list(rows)} | more
    start = {"displacement": q, "velocity": v}
    return OSCILLATOR | {"damping_ratio": ratio, "start": start, "excitation": excitation}


def ramps(time, rows):
    """Corners of a polygon: instants, and by how much its slope changes there; it goes on level."""
    slopes = np.diff(rows) / np.diff(time)
    return list(zip(time, np.diff(slopes, prepend=0.0, append=0.0), strict=True))


def exact(kind, time, rows, ratio, q, v, at):
    """Displacement with 50 digits: the free motion, and the response to every ramp and to the first value's step."""
    with mpmath.workdps(50):
        z, w = mpmath.mpf(ratio), mpmath.mpf(W)
        root = mpmath.sqrt(mpmath.mpc(z * z - 1))
        if root == 0:
            root = mpmath.mpf(10) ** -20  # of two roots so near, the critical motion to 1e-40
        a, b = w * (-z + root), w * (-z - root)

        def unit(t, power):
            """Response to F/m = t^power/power!, of the transfer function 1/((s − a)(s − b)) by partial fractions."""
            found = 0
            for one, other in ((a, b), (b, a)):
                found += mpmath.exp(one * t) / (one - other) / one ** (power + 1)
            if power == 0:
                return found + 1 / (a * b)
            return found + t / (a * b) + (a + b) / (a * b) ** 2

        def rate(t):
            """Response to the unit impulse, which is the rate of that to the unit step."""
            return (mpmath.exp(a * t) - mpmath.exp(b * t)) / (a - b)

        t = mpmath.mpf(at)
        moved = mpmath.mpf(q) * (1 - w * w * unit(t, 0)) + mpmath.mpf(v) * rate(t)
        moved += rows[0] * (w * w * unit(t, 0) if kind == "support_over_time" else unit(t, 0) / 2)
        for begins, slope in ramps(time, rows):
            if at > begins:
                since = t - mpmath.mpf(begins)
                if kind == "support_over_time":
                    # k x + b x′: a ramp, and a step of its slope.
                    moved += slope * (w * w * unit(since, 1) + 2 * z * w * unit(since, 0))
                else:
                    moved += slope * unit(since, 1) / 2
        return float(mpmath.re(moved))


values = st.floats(-5.0, 5.0).filter(lambda x: x == 0 or abs(x) > 1e-6)


@some
@given(
    st.sampled_from(["force_over_time", "support_over_time"]),
    ratios,
    st.lists(values, min_size=2, max_size=6).filter(any),
    st.floats(0.01, 1.0),
    values,
    values,
)
# The rounding of the velocity counts where displacements are small.
@example("force_over_time", 0.0, [0.0, 2.2, -3.0, 0.0], 0.015625, 0.0, 0.0)
def test_motion_under_rows__is_that_of_the_transform_within_its_figure(kind, ratio, rows, spacing, q, v):
    if kind == "support_over_time":
        rows[0] = 0.0  # a support that begins elsewhere would be a jump to the exact solution's damper
        rows[-1] = rows[-1] or 1.0
    time = spacing * np.arange(len(rows))
    data = driven(kind, time, rows, ratio, q, v, time=float(time[-1] + 0.3))
    found = figures(data, "end_displacement", *GREATEST)
    wanted = exact(kind, time, rows, ratio, q, v, time[-1] + 0.3)
    value, error = found[0]
    size = abs(q) + abs(v) + max(map(abs, rows))
    # 50 digits, of which the pair of roots beside the critical one costs 20.
    assert abs(value - wanted) <= error + 1e-24 * size
    assert error <= 1e-6 * size
    # The greatest displacement is reached where it is told, and not passed at any of many instants.
    (greatest, figure), (when, _) = found[1:3]
    assert abs(exact(kind, time, rows, ratio, q, v, when)) == pytest.approx(greatest, rel=1e-9, abs=1e-12 * size)
    reached = [abs(exact(kind, time, rows, ratio, q, v, t)) for t in np.linspace(0.0, time[-1] + 0.3, 40)]
    assert max(reached) <= greatest + figure + 1e-20 * size


def test_pulses_without_damping__have_the_dynamic_factors_of_the_textbook():
    """Rectangle, triangle and half sine of a duration t₁: A. K. Chopra, Dynamics of Structures, chapter 4."""
    period = math.tau / W
    for share in (0.2, 0.45, 0.7, 1.3):
        long = share * period
        after = {"time": long + 2 * period}
        step = driven("force_over_time", [0.0, long, long], [3.0, 3.0, 0.0], **after)
        wanted = 2.0 * math.sin(math.pi * share) if share < 0.5 else 2.0
        assert figures(step, "dynamic_factor")[0][0] == pytest.approx(wanted, rel=1e-12)
        # A step that rises evenly, 1 + |sin(π t₁/T)|/(π t₁/T).
        ramp = driven("force_over_time", [0.0, long], [0.0, 3.0], **after)
        wanted = 1.0 + abs(math.sin(math.pi * share)) / (math.pi * share)
        assert figures(ramp, "dynamic_factor")[0][0] == pytest.approx(wanted, rel=1e-12)
        sine = OSCILLATOR | {
            "excitation": {
                "type": "force_over_time",
                "formula": "peak * sin(pi * t / long) if t < long else 0 * peak",
                "numbers": {"peak": {"value": 3.0, "dimension": "force"}, "long": {"value": long, "dimension": "time"}},
                **after,
            }
        }
        eta = 1.0 / (2.0 * share)  # exciting over natural frequency
        if share < 0.5:
            wanted = 2.0 * eta / (eta**2 - 1.0) * math.cos(math.pi / (2.0 * eta))
        else:
            wanted = max(math.sin(math.tau * k / (1.0 + 1.0 / eta)) for k in (1, 2, 3) if 2 * k < 1.0 + 1.0 / eta) / (
                1.0 - eta
            )
        value, error = figures(sine, "dynamic_factor")[0]
        assert abs(value - wanted) <= 2.0 * error
        assert error < 1e-4 * wanted


@some
@given(st.floats(0.0, 0.3), st.floats(20.0, 400.0), values.filter(bool))
def test_greatest_among_many_tops__is_none_of_the_skipped(ratio, periods, drift):
    """A long ramp: hundreds of tops in one piece."""
    span = periods * math.tau / W
    data = driven("force_over_time", [0.0, span], [0.0, 800.0 * drift], ratio, 1.0, 0.0)
    (greatest, _), (when, _) = figures(data, "greatest_displacement", "greatest_displacement_at")
    t = np.linspace(0.0, span, 40 * int(periods) + 1)
    beta, root = ratio * W, W * math.sqrt(1 - ratio**2)
    slope = drift / span
    u, v = 1.0 + 2 * ratio / W * slope, -slope
    swing = np.exp(-beta * t) * (u * np.cos(root * t) + (v + beta * u) / root * np.sin(root * t))
    moved = np.abs(slope * t - 2 * ratio / W * slope + swing)
    assert moved.max() <= greatest * (1 + 1e-9)
    # Forty instants in a period miss less than (π/40)²/2 of a top.
    assert greatest <= moved.max() + 4e-3 * (abs(u) + abs(v) / W)
    assert 0.0 <= when <= span


def test_formula__is_that_of_an_integration_within_its_figure():
    formula = "a * t * sin(w * t^2) * exp(-t / tau)"
    numbers = {"a": (300.0, "kg m s-3"), "w": (40.0, "s-2"), "tau": (0.4, "time")}
    numbers = {k: {"value": v, "dimension": dimension} for k, (v, dimension) in numbers.items()}
    excitation = {"type": "force_over_time", "formula": formula, "numbers": numbers, "time": 2.0}
    data = OSCILLATOR | {"damping_ratio": 0.1, "excitation": excitation}
    found = figures(data, "end_displacement", "end_velocity")

    def rates(t, y):
        force = 300.0 * t * math.sin(40.0 * t * t) * math.exp(-t / 0.4)
        return [y[1], force / 2.0 - 4.0 * y[1] - 400.0 * y[0]]

    wanted = solve_ivp(rates, (0.0, 2.0), [0.0, 0.0], method="DOP853", rtol=1e-13, atol=1e-15).y[:, -1]
    for (value, error), there in zip(found, wanted, strict=True):
        assert abs(value - there) <= error + 1e-11 * abs(there)
        assert error < 1e-3 * abs(there)


def test_numbers_of_a_formula__vary_by_their_paths():
    excitation = {"type": "force_over_time", "formula": "a", "time": 1.0}
    excitation["numbers"] = {"a": {"value": 8.0, "dimension": "force"}}
    data = OSCILLATOR | {"excitation": excitation}
    ((greatest, _),) = figures(data, "greatest_displacement", excitation__numbers__a=[8.0, 16.0])
    # A force that comes at once moves the mass twice as far as one that comes slowly.
    assert greatest == pytest.approx([0.02, 0.04], rel=1e-12)


@pytest.mark.parametrize("kind", ["force_over_time", "support_over_time"])
def test_history__goes_through_the_greatest_values(kind):
    oscillator = element(driven(kind, [0.0, 0.1, 0.15, 0.4], [0.0, 0.7, -0.2, 0.1], 0.05, 0.001, 0.1, time=1.0))
    own = oscillator.values(oscillator.own_numbers())
    drives, displacement, spring_force = (panel.curves[0].values for panel in oscillator.panels())
    time = oscillator.panels()[0].places
    assert drives == pytest.approx(np.interp(time, [0.0, 0.1, 0.15, 0.4], [0.0, 0.7, -0.2, 0.1]), abs=1e-12)
    for curve, name in ((displacement, "greatest_displacement"), (spring_force, "spring_force")):
        # A peak may lie between two instants.
        assert np.abs(curve).max() == pytest.approx(own[name][0], rel=1e-3)
        assert time[np.abs(curve).argmax()] == pytest.approx(own[f"{name}_at"][0], abs=2e-3)
    assert displacement[-1] == pytest.approx(own["end_displacement"][0], rel=1e-12)
    stretch = displacement - (drives if kind == "support_over_time" else 0.0)
    assert spring_force == pytest.approx(800.0 * stretch, rel=1e-12)


def test_ratios_of_stiffness_and_spans_of_many_powers__stay_exact():
    # Hardly any spring: the mass is thrown, q = F t²/(2 m).
    soft = driven("force_over_time", [0.0, 1.0], [2.0, 2.0]) | {"stiffness": 1e-9}
    value, error = figures(soft, "end_displacement")[0]
    assert abs(value - 0.5) <= error + 1e-9
    # A spring a million million times as stiff follows the force at rest.
    stiff = driven("force_over_time", [0.0, 1.0], [0.0, 2.0], 1.0) | {"stiffness": 8e14}
    value, error = figures(stiff, "greatest_displacement")[0]
    # All but the lag b Ḟ/k², 2ζ/ω₀ of a second.
    assert value == pytest.approx(2.0 / 8e14 * (1.0 - 2.0 / math.sqrt(4e14)), rel=1e-12)


test_wrong_excitation_over_time__is_refused_with_the_mend = refusals(
    lambda excitation: element(OSCILLATOR | {"excitation": {"type": "force_over_time"} | excitation}),
    ({"over_time": [0.0, 1.0]}, "over_time and force, or a formula"),
    ({"over_time": [0.0, 1.0], "force": [1.0, 2.0], "formula": "1 N"}, "one of the two"),
    ({"over_time": [0.1, 1.0], "force": [1.0, 2.0]}, "begin at 0 s"),
    ({"over_time": [0.0, 1.0], "force": [0.0, 0.0]}, "nothing drives the mass"),
    ({"over_time": [0.0, 1.0, 0.5], "force": [0.0, 1.0, 2.0]}, "over_time"),
    ({"formula": "3 N"}, "time is missing"),
    ({"formula": "3 N * phi", "time": 1.0}, "unknown name 'phi'"),
    ({"formula": "3 kg", "time": 1.0}, "gives a mass, but this is a force"),
    ({"over_time": [0.0, 1.0], "force": [1.0, 2.0], "numbers": {"a": {"value": 1.0, "dimension": "force"}}}, "belong"),
)


test_support_that_jumps_and_a_second_time__are_refused = refusals(
    element,
    (driven("support_over_time", [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]), "can't jump"),
    (driven("force_over_time", [0.0, 1.0], [0.0, 1.0]) | {"start": {"time": 1.0}}, "give excitation.time"),
)
