"""Second inputs that move by laws of time, and beside a first input that slides, against loops in 40 digits."""

import math

import mpmath
import numpy as np
import pytest
from driving_cams import BALANCE, asked, changed, rows_of
from each_case import refusals
from five_bars import JOINED
from geared_links import CRANK
from hypothesis import given, settings
from hypothesis import strategies as st
from two_bars import joint, power

from engine import Machine, Scene
from engine.machine.results import AskError
from engine.scene.structure.ordering import order

EPS = np.finfo(float).eps
SPEED, PERIOD, TURNING = 4 * math.pi, 0.8, -2.5
SWINGS = {
    "out": {"type": "rise", "law": "cycloidal", "angle": "120 deg", "swing": 0.3},
    "back": {"type": "return", "law": "cycloidal", "angle": "90 deg"},
    "rest": {"type": "dwell"},
}
SECOND = {
    "type": "crank",
    "pivot": "C",
    "phase": 0.5,
    "begin": 1.0,
    "harmonics": {"two": {"order": 2, "cosine": 0.1, "sine": -0.06}},
    "sections": SWINGS,
}
# Over 0 … 7 rad of a crank no turn of which is like another, as 2.5 turns of it take 5/8 of two periods.
OVER_RANGE = JOINED | {
    "input": CRANK | {"speed": SPEED, "start": 0.0, "stop": 7.0},
    "inputs": {"second": SECOND | {"period": PERIOD, "speed": TURNING}},
}
SLIDING = JOINED | {
    "guides": {"way": {"angle": 0.1}},
    "input": {"type": "slider", "link": "ram", "guide": "way", "point": "A", "start": -0.05, "stop": 0.05, "speed": 1},
    "inputs": {"second": SECOND | {"travel": 0.06}},
    "bodies": JOINED["bodies"] | {"ram_body": {"link": "ram", "mass": 2.0}},
}
FIELDS = ["B.x", "B.y", "second.angle", "second.angle_phi", "second.angle_phiphi"]
DRIVES = ["input_moment_by_equilibrium", "second.driving_moment", "input_moment_by_power", "input_moment"]


def swing(tau: mpmath.mpf) -> mpmath.mpf:
    """What harmonics and sections of SECOND make of the argument of its law."""
    turned, two_pi = (tau - 1) % (2 * mpmath.pi), 2 * mpmath.pi
    law = mpmath.mpf(0.1) * mpmath.cos(2 * tau) - mpmath.mpf(0.06) * mpmath.sin(2 * tau)
    out, back = mpmath.radians(120), mpmath.radians(90)
    for u, sign in ((turned / out, 1), ((turned - out) / back, -1)):
        u = min(max(u, mpmath.mpf(0)), mpmath.mpf(1))
        law += sign * mpmath.mpf(0.3) * (u - mpmath.sin(two_pi * u) / two_pi)
    return law


def away_from_joins(tau: float) -> bool:
    turned = (tau - 1.0) % (2 * math.pi)
    return np.abs(turned - np.radians([0.0, 120.0, 210.0, 360.0])).min() > 1e-6


def compared(rows: dict[str, np.ndarray], k: int, one, psi, time: mpmath.mpf, speed: float, ram: float = 0.0) -> None:
    """Position and power at a node; motions over time."""

    def ends(t: mpmath.mpf) -> tuple[mpmath.mpc, ...]:
        turned = mpmath.expj(psi(t))
        return one(t), mpmath.mpc(0.2, 0.02) + mpmath.mpc(0.04, 0.01) * turned, turned

    with mpmath.workdps(40):
        true, angle = joint(*ends(time)[:2], 0.19, 0.17), psi(time)
        rate, bend = (mpmath.diff(psi, time, n) / mpmath.mpf(speed) ** n for n in (1, 2))
        taken = power(ends, 0.19, 0.17, time, ram)
    # Angles of about ten radians, and what loops of 0.2 m make of them.
    assert abs(complex(rows["B.x"][k], rows["B.y"][k]) - complex(true)) < 400 * EPS
    assert abs(math.remainder(rows["second.angle"][k] - float(angle), 2 * math.pi)) < 100 * EPS
    scale = 1.0 if abs(speed) > 1.0 else 2 * math.pi / 0.06
    np.testing.assert_allclose(rows["second.angle_phi"][k], float(rate), atol=200 * EPS * scale)
    np.testing.assert_allclose(rows["second.angle_phiphi"][k], float(bend), atol=1000 * EPS * scale**2)
    own, turning = rows["input_moment_by_equilibrium"][k], rows["second.driving_moment"][k]
    whole = own + turning * rows["second.angle_phi"][k]
    size = max(np.abs(rows["input_moment"]).max(), np.abs(rows["second.driving_moment"]).max() * scale)
    assert abs(whole * speed - float(taken)) < 1e4 * EPS * abs(speed) * size
    np.testing.assert_allclose(whole, rows["input_moment_by_power"][k], atol=1e4 * EPS * size)
    np.testing.assert_allclose(whole, rows["input_moment"][k], atol=1e4 * EPS * size)


@pytest.fixture(scope="module")
def over_range() -> Machine:
    return Machine(Scene.model_validate(OVER_RANGE), BALANCE, [*FIELDS, *DRIVES], ["inputs.second.phase"], 48)


@settings(max_examples=5)
@given(st.floats(-0.3, 0.9), st.integers(0, 47))
def test_law_of_time__over_a_range_that_closes_nowhere(over_range, phase, k):
    rows, phi = rows_of(over_range, **{"inputs.second.phase": phase}), float(over_range.nodes[k])
    tau = 2 * math.pi * phi / SPEED / PERIOD
    if away_from_joins(tau):
        time = mpmath.mpf(phi) / mpmath.mpf(SPEED)
        compared(
            rows,
            k,
            lambda t: mpmath.mpf(CRANK["length"]) * mpmath.expj(mpmath.mpf(SPEED) * t),
            lambda t: phase + TURNING * t + swing(2 * mpmath.pi * t / mpmath.mpf(PERIOD)),
            time,
            SPEED,
        )


def test_crank_that_turns_back__goes_through_the_law_as_time_does():
    """At −ω the law is met in its own order while the crank's angle falls."""
    turns, periods = 3, 2
    drive = CRANK | {"speed": -SPEED, "revolutions": turns}
    second = SECOND | {"period": turns * 2 * math.pi / SPEED / periods, "speed": 2 * SPEED / turns}
    scene = changed(OVER_RANGE, input=drive, inputs={"second": second})
    q, rows = asked(scene, [*FIELDS, *DRIVES], 72)
    for k in (3, 20, 35, 49, 66):
        phi = float(q[k])
        tau = -2 * math.pi * phi / SPEED / second["period"]
        assert away_from_joins(tau)
        compared(
            rows,
            k,
            lambda t: mpmath.mpf(CRANK["length"]) * mpmath.expj(-mpmath.mpf(SPEED) * t),
            lambda t: 0.5 + mpmath.mpf(second["speed"]) * t + swing(2 * mpmath.pi * t / mpmath.mpf(second["period"])),
            mpmath.mpf(phi) / -mpmath.mpf(SPEED),
            -SPEED,
        )


@settings(max_examples=5)
@given(st.floats(-0.3, 0.9), st.integers(0, 47))
def test_first_input_that_slides__beside_a_second_by_its_travel(phase, k):
    q, rows = asked(changed(SLIDING, inputs__second__phase=phase), [*FIELDS, *DRIVES], 48)
    s = float(q[k])
    if away_from_joins(2 * math.pi * s / 0.06):
        compared(
            rows,
            k,
            lambda t: t * mpmath.expj(0.1),
            lambda t: phase + swing(2 * mpmath.pi * t / mpmath.mpf(0.06)),
            mpmath.mpf(s),
            1.0,
            ram=2.0,
        )


test_laws_without_meaning__are_refused_in_words = refusals(
    lambda scene, changes: order(Scene.model_validate(changed(scene, **changes))),
    (OVER_RANGE, {"input": CRANK}, "doesn't close: no cycle of up to 24"),
    (
        OVER_RANGE,
        {"input": CRANK, "inputs__second": {"type": "crank", "pivot": "C", "speed": 1.0}},
        "inputs.second.speed: 'second' makes",
    ),
    (
        OVER_RANGE,
        {"inputs__second__travel": 0.1, "inputs__second__period": None},
        "inputs.second.travel: needs a first input",
    ),
    (OVER_RANGE, {"regimes": {"run": {"type": "run", "time": 1.0}}}, "inputs.second.sections: a run with"),
    (SLIDING, {"inputs__second__travel": None}, "give travel, the distance"),
    (SLIDING, {"inputs__second__drive": "crank"}, "there is no crank"),
)


test_laws_of_two_kinds__are_no_law = refusals(
    lambda changes: Scene.model_validate(changed(OVER_RANGE, **changes)),
    ({"inputs__second__travel": 0.1}, "period and travel are given"),
    ({"inputs__second__drive": "crank"}, "follows the crank angle, not time"),
)


@pytest.mark.parametrize("path", ["inputs.second.period", "input.speed"])
def test_what_places_sections__is_the_same_for_all_variants(path):
    with pytest.raises(AskError, match="the same for all variants"):
        Machine(Scene.model_validate(OVER_RANGE), varied=[path])
