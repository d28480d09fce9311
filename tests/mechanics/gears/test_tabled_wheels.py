"""Non-circular wheels by tables of their ratio: against SciPy's splines and their integrals, and against ellipses."""

import math

import numpy as np
import pytest
from driving_cams import changed
from noncircular_wheels import CHAIN, ELLIPSES
from scipy.interpolate import CubicSpline

from engine import Machine, Scene, Verdict

EPS = np.finfo(float).eps
TURN = 2 * math.pi
BALANCE = ("input_moment_disagreement", "equilibrium_residual")
# The first row lies before the law's beginning; the mean isn't 1.
ANGLES = [-0.4, 0.5, 1.6, 2.9, 4.0, 5.1]
RATIOS = [2.0, 2.6, 3.1, 1.9, 1.2, 1.5]
TABLE = {"type": "table", "over_angle": ANGLES, "ratio": RATIOS}
SPLINE = CubicSpline([*ANGLES, ANGLES[0] + TURN], [*RATIOS, RATIOS[0]], bc_type="periodic")
INTEGRAL = SPLINE.antiderivative()
AT = "noncircular_wheels__second"


def asked(data: dict, fields: list[str]) -> tuple[np.ndarray, list[np.ndarray]]:
    machine = Machine(Scene.model_validate(data), BALANCE, fields, positions=24)
    outcome = machine.evaluate({})
    assert outcome.status[0] == Verdict.OK
    # A handful of roundings of forces that a few links pass on.
    assert all(outcome.summaries[name][0] < 1e-13 for name in BALANCE)
    return machine.nodes, [outcome.fields[name][0] for name in fields]


def law(theta: np.ndarray) -> list[np.ndarray]:
    """Angle of the driven wheel where the mean ratio is 1, and its first two derivatives."""
    mean = (INTEGRAL(ANGLES[0] + TURN) - INTEGRAL(ANGLES[0])) / TURN
    turns = np.floor((theta - ANGLES[0]) / TURN)
    within = theta - TURN * turns
    angle = TURN * turns + (INTEGRAL(within) - INTEGRAL(0.0)) / mean
    return [angle, SPLINE(within) / mean, SPLINE(within, 1) / mean]


@pytest.mark.parametrize(("lobes", "driver_lobes"), [(2, 2), (1, 3)])
def test_wheel_by_a_table__turns_by_the_integral_of_its_spline(lobes, driver_lobes):
    data = changed(ELLIPSES, **{f"{AT}__law": TABLE, f"{AT}__lobes": lobes, f"{AT}__driver_lobes": driver_lobes})
    names = ["angle", "angle_phi", "angle_phiphi", "ratio", "pitch_radius", "driver_pitch_radius"]
    phi, (angle, w, e, ratio, own, other) = asked(data, [f"second.{name}" for name in names])
    psi, rate, slope = law(driver_lobes * (phi - 0.3))
    mean = driver_lobes / lobes
    # Angles of up to three turns, pieces of the spline of about a radian.
    np.testing.assert_allclose(np.exp(1j * angle), np.exp(1j * (1.0 - mean / driver_lobes * psi)), atol=200 * EPS)
    np.testing.assert_allclose(w, -mean * rate, atol=200 * EPS)
    np.testing.assert_allclose(e, -mean * driver_lobes * slope, atol=500 * EPS)
    np.testing.assert_allclose(own * ratio, other, rtol=8 * EPS)
    np.testing.assert_allclose(own + other, math.hypot(0.2, 0.05), rtol=8 * EPS)


def test_wheel_by_a_table_behind_another__follows_that_one():
    data = changed(CHAIN, noncircular_wheels__last__law=TABLE)
    names = [f"{of}.angle{rate}" for of in ("middle", "last") for rate in ("", "_phi", "_phiphi")]
    _, (middle, w, e, last, w_last, e_last) = asked(data, names)
    psi, rate, slope = law(middle)
    np.testing.assert_allclose(np.exp(1j * last), np.exp(-1j * psi), atol=1000 * EPS)
    np.testing.assert_allclose(w_last, -rate * w, atol=1000 * EPS)
    np.testing.assert_allclose(e_last, -(slope * w * w + rate * e), atol=4000 * EPS)


def test_fine_table_of_ellipses__is_ellipses():
    e, theta = 0.4, np.linspace(0.0, TURN, 72, endpoint=False)
    ratio = (1 - e * e) / (1 + e * e - 2 * e * np.cos(theta))
    table = {"type": "table", "over_angle": theta.tolist(), "ratio": ratio.tolist()}
    names = ["ram.slide", "second.ratio", "input_moment_by_equilibrium", "second.curvature"]
    _, exact = asked(ELLIPSES, names)
    _, found = asked(changed(ELLIPSES, **{f"{AT}__law": table}), names)
    # Splines miss by 5/384 h⁴ of the fourth derivative, about 40 here; slopes by h³/24, curvatures of slopes by h².
    for a, b, share in zip(found, exact, (1e-5, 1e-4, 5e-3, 2e-2), strict=True):
        np.testing.assert_allclose(a, b, atol=share * np.abs(b).max())


def test_greatest_ratio__lies_between_rows():
    machine = Machine(Scene.model_validate(changed(ELLIPSES, **{f"{AT}__law": TABLE})), ["second.ratio.max"])
    outcome = machine.evaluate({})
    theta = np.linspace(0.5, 2.9, 200_001)
    # A parabola on a grid of 12 µrad.
    assert abs(outcome.summaries["second.ratio.max"][0] - law(theta)[1].max()) < 1e-10


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        ({"ratio": [1, 2, -1, 2, 1, 1]}, "would stand or turn back after the row"),
        ({"over_angle": [0.0, 0.1, 3.0, 3.1], "ratio": [1, 12, 12, 1]}, "curve through the rows comes down to"),
        ({"ratio": [1, 2]}, "over_angle has 6 rows, ratio has 2"),
        ({"over_angle": [0, 1, 2, 3, 4, 8]}, "more than one period"),
        ({"over_angle": [0, 2, 1, 3, 4, 5]}, "sort the rows by over_angle"),
    ],
)
def test_wrong_tables__are_refused_in_words(rows, told):
    with pytest.raises(ValueError, match=told):
        Scene.model_validate(changed(ELLIPSES, **{f"{AT}__law": TABLE | rows}))
