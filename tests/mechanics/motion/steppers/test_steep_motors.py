"""Steep motors on light wheels: settled cycles against SciPy's Radau, through the layers that jumps of a load leave."""

import math

import numpy as np
import pytest
from closed_forms import slider_motion
from motion_scenes import (
    CRANK_INERTIA,
    CUT,
    ECCENTRIC_MASS,
    ECCENTRICITY,
    GRAVITY,
    MOMENTS,
    RADIUS,
    RAM_MASS,
    RATIO,
    ROD,
    ask,
    crank_on_dc_motor,
    run,
    slider_crank,
    steady,
)
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from engine import Verdict

SYNCHRONOUS = MOMENTS["induction"]["synchronous_speed"] / RATIO


def cut_begins_and_ends() -> tuple[float, float]:
    """Angles between which the tool cuts, on the ram's way to the high end of its stroke."""
    top = RADIUS + ROD
    begin, end = CUT["over_stroke"][1], CUT["over_stroke"][0]
    return tuple(
        brentq(lambda phi, left=left: top - slider_motion(phi, RADIUS, ROD)[0] - left, -math.pi, 0.0)
        for left in (begin, end)
    )


def settled(slip: float, wheel: float, ratio: float) -> tuple[float, float, float]:
    """Period, least and greatest speed of the slider-crank with an induction motor, cut and gravity.

    A motor so steep forgets within a cycle where it began: what comes after two is settled.
    """
    breakdown = MOMENTS["induction"]["breakdown_moment"] * ratio
    fixed = CRANK_INERTIA + ECCENTRIC_MASS * ECCENTRICITY**2 + wheel
    first, last = cut_begins_and_ends()
    near, far = CUT["over_stroke"]

    def inertia(phi: float) -> float:
        return fixed + RAM_MASS * slider_motion(phi, RADIUS, ROD)[1] ** 2

    def rates(phi: float, state: np.ndarray, cuts: bool) -> list[float]:
        place, rate, _ = slider_motion(phi, RADIUS, ROD)
        omega = math.sqrt(2.0 * state[0] / inertia(phi))
        s = 1.0 - omega / SYNCHRONOUS
        motor = RATIO * 2.0 * breakdown * s * slip / (s * s + slip * slip)
        weight = -ECCENTRIC_MASS * ECCENTRICITY * GRAVITY * math.cos(phi)
        left = RADIUS + ROD - place
        force = CUT["force"][0] + (CUT["force"][1] - CUT["force"][0]) * (left - near) / (far - near)
        return [motor + weight - (force * rate if cuts else 0.0), 1.0 / omega]

    def slopes(phi: float, state: np.ndarray, cuts: bool) -> np.ndarray:
        omega = math.sqrt(2.0 * state[0] / inertia(phi))
        s = 1.0 - omega / SYNCHRONOUS
        rise = RATIO * 2.0 * breakdown * slip * (slip * slip - s * s) / (s * s + slip * slip) ** 2
        return np.array([[-rise / SYNCHRONOUS / (inertia(phi) * omega), 0.0], [-0.5 / (omega * state[0]), 0.0]])

    state, speeds, begun = [0.5 * inertia(last) * SYNCHRONOUS**2, 0.0], [], 0.0
    for turn in range(3):
        begun = state[1]
        for cuts, (a, b) in ((False, (last, first + 2 * math.pi)), (True, (first, last))):
            found = solve_ivp(
                rates, (a, b), state, "Radau", rtol=1e-11, atol=1e-13, jac=slopes, args=(cuts,), dense_output=turn == 2
            )
            state = found.y[:, -1]
            if turn == 2:
                # Extremes lie at the ends of the layers, or where the ram's inertia turns the speed.
                places = np.unique(np.concatenate((found.t, np.linspace(a, b, 20_001))))
                energy = found.sol(places)[0]
                speeds.append(np.sqrt(2.0 * energy / [inertia(phi) for phi in places]))
    speeds = np.concatenate(speeds)
    return state[1] - begun, speeds.min(), speeds.max()


@pytest.mark.parametrize(("slip", "wheel", "ratio"), [(0.02, 0.0, 2.0), (0.01, 0.005, 3.0)])
def test_breakdown_slip_of_2_percent_and_less__as_radau(slip, wheel, ratio):
    motor = {"breakdown_slip": slip, "breakdown_moment": MOMENTS["induction"]["breakdown_moment"] * ratio}
    scene = slider_crank({"on": steady("induction cut gravity")}, flywheel=wheel, induction=motor)
    found = ask(scene, "on.period on.speed_min on.speed_max on.speed_fluctuation on.implicit_steps")
    assert found.status == [Verdict.OK]
    assert found["on.implicit_steps"] == 1.0
    period, slowest, fastest = settled(slip, wheel, ratio)
    delta = 2.0 * (fastest - slowest) / (fastest + slowest)
    for name, true in (
        ("period", period),
        ("speed_min", slowest),
        ("speed_max", fastest),
        ("speed_fluctuation", delta),
    ):
        # Radau's own error; its extremes are looked for at places a few ten-thousandths of a turn apart.
        room = 1e-7 * (2.0 / delta if name == "speed_fluctuation" else 1.0)
        found.covers(f"on.{name}", true, room * true)
        assert found.figure(f"on.{name}") <= 1e-6 * true, name


def test_motor_with_a_flywheel__needs_no_implicit_steps():
    regimes = {"on": steady("induction cut gravity"), "go": run("induction cut gravity", cycles=2.0)}
    scene = slider_crank(regimes, flywheel=1.0)
    found = ask(scene, "on.implicit_steps go.implicit_steps")
    assert (found["on.implicit_steps"], found["go.implicit_steps"]) == (0.0, 0.0)


def test_kink_of_a_load_on_a_steep_motor__is_followed_to_the_extremes_behind_it():
    inertia, light, most, fall = 0.1, 12.5, 1e3, 0.01
    kinks = {"over_angle": [1.0, 2.0, 5.0, 6.0], "moment": [0.0, most, (1.0 - fall) * most, 0.0]}
    kinks |= {"type": "table", "interpolation": "linear"}
    scene = crank_on_dc_motor(inertia, 1e6, light, kinks)
    stalls = np.array([3e4, 1e5, 3e5, 1e6, 3e6, 1e7])
    # I ω dω/dφ = M₀ (1 − ω/ω₀) + M(φ) holds the speed to its balance within I ω₀²/M₀ radians; positions are in these.
    layers = inertia * light**2 / stalls

    def rates(x: float, omega: np.ndarray) -> np.ndarray:
        load = most * (1.0 + x * layers if x < 0.0 else 1.0 - fall * x * layers / 3.0)
        return layers * (stalls * (1.0 - omega / light) + load) / (inertia * omega)

    how = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-13}
    before = light * (1.0 + most * (1.0 - 40.0 * layers) / stalls)
    at_kink = solve_ivp(rates, (-40.0, 0.0), before, **how).y[:, -1]
    tops = solve_ivp(rates, (0.0, 20.0), at_kink, max_step=0.005, **how).y.max(axis=1)
    for accuracy in (None, 1e-6):
        found = ask(scene, "on.speed_max", varied={"moments.dc.stall_moment": stalls}, accuracy=accuracy)
        error = found.errors["on.speed_max"]
        assert (np.abs(found.values["on.speed_max"] - tops) <= error + 1e-12 * tops).all()
        # The tolerance of steps is relative to the load's work, a thousand times the energy here.
        assert (error <= 1e-6 * tops).all()


@pytest.mark.parametrize("stall", [2e3, 2e6])
def test_steep_motor_over_time__goes_as_over_the_angle(stall):
    """Steps also begin at extremes of the speed, where nothing but the angle moves the stages on."""
    names, regime = "go.angle go.final_speed go.speed_max go.motor_work", {"from_speed": 98.0, "time": 0.1}
    angle, time = (
        ask(slider_crank({"go": run("dc oil" + more, **regime)}, dc={"stall_moment": stall}), names)
        for more in ("", " nothing")
    )
    for name in names.split():
        assert abs(time[name] - angle[name]) <= 3 * (time.figure(name) + angle.figure(name)), name
        # Steps in time are judged by the speed, not by the torque, which is steeper.
        assert time.figure(name) <= (1e-6 if name == "go.motor_work" else 1e-9) * time[name], name
