"""The flywheel as a wheel: what it is made of must have the inertia asked for."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import fixed_quad

from engine.elements.flywheel_wheels import MATERIALS, make_wheel
from engine.parts.bodies import WheelForm

# Sums, products and quotients of a dozen numbers: tens of roundings of 1.1e-16.
ROUNDED = 1e-13

few = settings(max_examples=30)
sizes = st.floats(-3, 3).map(lambda e: 10.0**e)
ratios = st.floats(0.2, 20)


def numbers_of(form, **arrays):
    values = {k: v for k, v in form.model_dump().items() if isinstance(v, float)} | arrays
    return {f"flywheel.wheel.{k}": v for k, v in values.items()}


def wheel(form, inertia, speed, **arrays):
    return make_wheel(form, np.asarray(inertia), np.asarray(speed), numbers_of(form, **arrays))


def integral(power, inner, outer):
    """∫ r^power dr by Gauss quadrature, exact for such powers."""
    return fixed_quad(lambda r: r**power, inner, outer, n=8)[0]


def integral_of_r2(density, inner, outer, width):
    """∫ρ r² 2πr b dr; and the mass, ∫ρ 2πr b dr."""
    return tuple(density * 2 * math.pi * width * integral(power, inner, outer) for power in (3, 1))


# The inertia of what is made, by quadrature over its material


@few
@given(sizes, st.floats(0.1, 1000), st.floats(0.001, 0.499), ratios, st.sampled_from(["cast iron", "steel"]))
def test_rim__has_the_inertia_asked_for(inertia, speed, thickness, ratio, material):
    form = WheelForm(type="rim", material=material, thickness_ratio=thickness, ratio=ratio)
    made = wheel(form, inertia, speed)
    radius = made.diameter / 2
    j, mass = integral_of_r2(MATERIALS[material].density, radius - thickness * made.diameter, radius, made.width)
    # R² − r² loses up to 1/thickness of its digits.
    assert j * ratio**2 == pytest.approx(inertia, rel=ROUNDED / thickness)
    assert mass == pytest.approx(made.mass, rel=ROUNDED / thickness)


@few
@given(sizes, st.floats(0.1, 1000), sizes, st.floats(1000, 20_000))
def test_disc__has_the_inertia_asked_for(inertia, speed, diameter, density):
    form = WheelForm(type="disc", diameter=diameter, density=density)
    made = wheel(form, inertia, speed)
    j, mass = integral_of_r2(density, 0.0, diameter / 2, made.width)
    assert j == pytest.approx(inertia, rel=ROUNDED)
    assert mass == pytest.approx(made.mass, rel=ROUNDED)


@few
@given(
    st.floats(0.5, 3),
    st.floats(0.05, 0.3),
    st.floats(0.05, 0.35),
    st.floats(1, 100),
    st.integers(2, 12),
    st.floats(1, 5),
)
def test_arms__have_with_rim_and_hub_the_inertia_asked_for(diameter, thickness, hub_share, excess, arms, area_share):
    hub, inner = hub_share * diameter, diameter * (1 - 2 * thickness)
    form = WheelForm(
        type="arms", material="steel", diameter=diameter, thickness_ratio=thickness, arms=arms,
        arm_area=area_share * 1e-4, hub_diameter=hub, hub_width=0.5 * hub,
    )  # fmt: skip
    rho = 7850.0
    j_hub, m_hub = integral_of_r2(rho, 0.0, hub / 2, hub / 2)
    j_arms, m_arms = (arms * rho * form.arm_area * integral(power, hub / 2, inner / 2) for power in (2, 0))
    asked = (j_hub + j_arms) * (1 + excess)
    made = wheel(form, asked, 10.0)
    j_rim, m_rim = integral_of_r2(rho, inner / 2, diameter / 2, made.width)
    assert j_hub + j_arms + j_rim == pytest.approx(asked, rel=100 * ROUNDED)
    assert m_hub + m_arms + m_rim == pytest.approx(made.mass, rel=100 * ROUNDED)


def test_arms_that_suffice__leave_no_rim():
    form = WheelForm(type="arms", diameter=1.0, arms=4, arm_area=0.01, hub_diameter=0.2, hub_width=0.2)
    made = wheel(form, [1e-6, 1e6], 10.0)
    assert made.width[0] == 0.0
    assert made.width[1] > 0.0
    arms = 4 * 7200 * 0.01 * (0.4 - 0.1)
    assert made.mass[0] == pytest.approx(arms + 7200 * math.pi * 0.01 * 0.2, rel=ROUNDED)
    # What is made stores more than what was asked for.
    assert made.energy[0] > 0.5 * 1e-6 * 10**2


def test_hub_that_reaches_the_rim__is_no_wheel():
    form = WheelForm(type="arms", diameter=1.0, arm_area=0.01, hub_diameter=0.9, hub_width=0.2)
    made = wheel(form, [5.0, -1.0], 10.0)
    assert np.isnan([size[0] for size in made]).all()
    assert [size[1] for size in made] == [0.0] * len(made)


# Speed, stress, energy


@few
@given(sizes, st.floats(0.1, 1000), ratios)
def test_free_diameter__puts_the_rim_at_its_limit(inertia, speed, ratio):
    made = wheel(WheelForm(type="rim", material="steel", ratio=ratio), inertia, -speed)
    assert made.rim_speed == pytest.approx(70.0, rel=ROUNDED)
    assert made.rim_speed_share == pytest.approx(1.0, rel=ROUNDED)
    assert made.hoop_stress == pytest.approx(7850 * 70**2, rel=ROUNDED)
    # ½ J ω² of the shaft is ½ I ω² of the input, whatever the ratio.
    assert made.energy == pytest.approx(inertia * speed**2 / 2, rel=10 * ROUNDED)


def test_given_limits_and_density__replace_those_of_the_material():
    form = WheelForm(type="rim", density=7000.0, rim_speed_limit=30.0, diameter=2.0)
    made = wheel(form, 10.0, 20.0, rim_speed_limit=np.array([30.0, 40.0]), diameter=np.array([2.0, 4.0]))
    assert made.rim_speed == pytest.approx([20, 40])
    assert made.rim_speed_share == pytest.approx([20 / 30, 1])
    assert made.hoop_stress == pytest.approx([7000 * 400, 7000 * 1600])


def test_no_inertia_needed__is_no_wheel_at_all():
    for kind in ("rim", "disc"):
        made = wheel(WheelForm(type=kind), [0.0, -3.0], [10.0, 0.0])
        assert [list(size) for size in made] == [[0.0, 0.0]] * len(made)


def test_undefined_input__gives_nan_everywhere():
    made = wheel(WheelForm(type="rim", diameter=1.0), [np.nan, 1.0, 1.0, np.inf], [1.0, 0.0, np.nan, 1.0])
    assert np.isnan(made).all()


def test_input_at_rest__gives_no_diameter():
    assert np.isnan(wheel(WheelForm(type="disc"), [1.0], [0.0])).all()


# The textbook's rim


@few
@given(sizes, st.floats(0.2, 5.0), st.floats(0.5, 8.0), ratios)
def test_mean_rim__is_the_textbooks(inertia, mean, shape, ratio):
    form = WheelForm(type="mean rim", mean_diameter=mean, width_ratio=shape, ratio=ratio)
    made = wheel(form, inertia, 20.0)
    section = inertia / ratio**2 / (mean / 2) ** 2 / (math.pi * mean * 7200)
    if math.sqrt(section / shape) >= mean:
        assert np.isnan(made).all()
        return
    assert made.width * made.thickness == pytest.approx(section, rel=10 * ROUNDED)
    assert made.width / made.thickness == pytest.approx(shape, rel=ROUNDED * (1 + mean / made.thickness))
    assert made.mass * (mean / 2) ** 2 * ratio**2 == pytest.approx(inertia, rel=ROUNDED)
    assert made.hoop_stress == pytest.approx(7200 * (20 * ratio * mean / 2) ** 2, rel=ROUNDED)
    # By Guldin the textbook's mass is the true one of the ring; its inertia leaves out mt²/4.
    j, mass = integral_of_r2(7200, mean / 2 - made.thickness / 2, mean / 2 + made.thickness / 2, made.width)
    assert mass == pytest.approx(made.mass, rel=10 * ROUNDED)
    exact = made.mass * (mean**2 + made.thickness**2) / 4
    assert j == pytest.approx(exact, rel=10 * ROUNDED)


# Bursting


@few
@given(st.floats(0.1, 3.0), st.floats(0.01, 0.49), st.floats(1e6, 1e9), ratios)
def test_wheel__bursts_where_its_halves_pull_with_all_of_their_section(diameter, thickness, strength, ratio):
    """The centrifugal force of a half ring, per metre of width, against the strength of its two sections."""
    form = WheelForm(
        type="rim", density=7850.0, diameter=diameter, thickness_ratio=thickness, strength=strength, ratio=ratio
    )
    made = wheel(form, 1.0, -15.0)
    outer, inner = diameter / 2, diameter * (0.5 - thickness)
    omega = made.burst_speed * ratio
    # Across the cut ∫ρω²r sin θ r dr dθ over the half: 2ρω²∫r² dr.
    pull = 2 * 7850.0 * omega**2 * integral(2, inner, outer)
    assert pull == pytest.approx(2 * strength * (outer - inner), rel=ROUNDED / thickness)
    assert made.burst_margin == pytest.approx(made.burst_speed / 15.0, rel=ROUNDED)


def test_solid_disc_and_thin_ring__burst_at_a_third_and_at_all_of_the_rims_stress():
    speeds = {}
    for kind, more in (("disc", {}), ("rim", {"thickness_ratio": 1e-9})):
        form = WheelForm(type=kind, density=7850.0, diameter=1.0, strength=4e8, **more)
        speeds[kind] = float(wheel(form, 1.0, 10.0).burst_speed)
    assert speeds["disc"] == pytest.approx(2 * math.sqrt(3 * 4e8 / 7850), rel=ROUNDED)
    # A ring as thin as this is thick at 2e-9 of its radius.
    assert speeds["rim"] == pytest.approx(2 * math.sqrt(4e8 / 7850), rel=1e-8)


@pytest.mark.parametrize(("kind", "key"), [("mean rim", "diameter"), ("rim", "mean_diameter")])
def test_diameter_of_another_kind_of_wheel__is_refused(kind, key):
    with pytest.raises(ValueError, match=f"{key} goes with type = .*; the type is {kind!r}"):
        WheelForm.model_validate({"type": kind, key: 1.0})
