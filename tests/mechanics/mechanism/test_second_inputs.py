"""Second inputs: five-bars by two circles and by Fourier, powers and friction of both drives, refusals."""

import cmath
import math

import numpy as np
import pytest
from driving_cams import asked, changed
from each_case import refusals
from geared_links import CRANK
from hypothesis import given, settings
from hypothesis import strategies as st
from machines import rrr

from engine import Machine, Scene
from engine.machine.results import AskError
from engine.scene.structure.ordering import order

EPS = np.finfo(float).eps
HARMONICS = {"one": {"order": 1, "cosine": 0.2, "sine": -0.3}, "three": {"order": 3, "cosine": 0.04, "sine": 0.05}}
FIVE_BAR = {
    "gravity": "9.81 m/s2",
    "points": {
        "O": {"x": 0, "y": 0},
        "C": {"x": 0.2, "y": 0.02},
        "D": {"link": "second", "x": 0.04, "y": 0.01},
        "H": {"x": 0.05, "y": -0.2},
    },
    "input": CRANK,
    "inputs": {"second": {"type": "crank", "pivot": "C", "ratio": -1, "phase": 0.5, "harmonics": HARMONICS}},
    "groups": {"arms": rrr("B", ("left", "A", 0.19), ("right", "D", 0.17))},
    "springs": {"s": {"between": ("B", "H"), "stiffness": 100.0}},
    "bodies": {
        "left_body": {"link": "left", "mass": 0.7, "x": 0.09, "y": 0.01, "inertia": 0.002},
        "right_body": {"link": "right", "mass": 0.8, "x": 0.08, "inertia": 0.003},
        "second_body": {"link": "second", "mass": 1.5, "x": 0.01, "y": 0.02, "inertia": 0.002},
    },
}
MOTION = [f"{of}{rate}" for of in ("B.x", "B.y", "second.angle") for rate in ("", "_phi", "_phiphi")]
MOMENTS = ["input_moment_by_equilibrium", "second.driving_moment", "input_moment_by_power", "input_moment"]
REACTIONS = [f"{pair}.reaction" for pair in ("input", "second", "arms.first", "arms.inner", "arms.second")]
NODES = 128


def varied(phase: float, cosine: float, sine: float, speed: float) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    harmonics = {"one": HARMONICS["one"] | {"cosine": cosine}, "three": HARMONICS["three"] | {"sine": sine}}
    second = {"inputs__second__phase": phase, "inputs__second__harmonics": harmonics}
    return asked(changed(FIVE_BAR, **second, input__speed=speed), [*MOTION, *MOMENTS, *REACTIONS], NODES)


def law(phi: float, phase: float, cosine: float, sine: float) -> float:
    first, third = cosine * math.cos(phi) - 0.3 * math.sin(phi), 0.04 * math.cos(3 * phi) + sine * math.sin(3 * phi)
    return phase - phi + first + third


def by_circles(phi: float, psi: float) -> complex:
    """Where the circles about both ends meet, to the left of the line from the first to the second."""
    one, other = 0.05 * cmath.exp(1j * phi), 0.2 + 0.02j + (0.04 + 0.01j) * cmath.exp(1j * psi)
    line = other - one
    along = (abs(line) ** 2 + 0.19**2 - 0.17**2) / (2 * abs(line))
    return one + line / abs(line) * complex(along, math.sqrt(0.19**2 - along**2))


@settings(max_examples=10, deadline=None)
@given(st.floats(-3.0, 3.0), st.floats(-0.3, 0.3), st.floats(-0.08, 0.08), st.floats(0.5, 300.0))
def test_five_bar__goes_as_two_circles_say_and_both_drives_give_the_power(phase, cosine, sine, speed):
    # Rods of 0.19 m and 0.17 m reach the 0.11 m … 0.30 m that cranks of 0.05 m and 0.041 m leave between them.
    phi, rows = varied(phase, cosine, sine, speed)
    psi = np.array([law(q, phase, cosine, sine) for q in phi])
    true = np.array([by_circles(q, p) for q, p in zip(phi, psi, strict=True)])
    np.testing.assert_allclose(rows["B.x"] + 1j * rows["B.y"], true, atol=100 * EPS)
    np.testing.assert_allclose(np.exp(1j * rows["second.angle"]), np.exp(1j * psi), atol=100 * EPS)
    whole = rows["input_moment_by_equilibrium"] + rows["second.driving_moment"] * rows["second.angle_phi"]
    # Forces in the pairs at arms below 0.1 m make up the moments.
    size = 0.1 * sum(np.abs(rows[name]) for name in REACTIONS).max()
    np.testing.assert_allclose(whole, rows["input_moment_by_power"], atol=100 * EPS * size)
    np.testing.assert_allclose(whole, rows["input_moment"], atol=100 * EPS * size)


def test_friction__is_borne_by_both_drives():
    friction = {
        "own": {"pair": "second", "coefficient": 0.1, "diameter": 0.02},
        "inner": {"pair": "arms.inner", "coefficient": 0.15, "diameter": 0.02},
    }
    names = ["input_moment_with_friction", "input_moment_by_equilibrium", "second.driving_moment", "second.angle_phi"]
    whole, own, second, rate = asked(changed(FIVE_BAR, friction=friction), names)[1].values()
    np.testing.assert_allclose(whole, own + second * rate, atol=8 * EPS * (np.abs(own) + np.abs(second * rate)).max())


SLIDER = {"type": "slider", "link": "crank", "guide": "way", "point": "A", "start": 0, "stop": 0.05, "speed": 0.1}


test_wrong_second_inputs__are_refused_in_words = refusals(
    lambda changes: order(Scene.model_validate(changed(FIVE_BAR, **changes))),
    ({"inputs__second__pivot": "B"}, "inputs.second.pivot: 'B' is on what this input would drive"),
    ({"inputs__second__ratio": 0.5}, "makes 0.5 turns in a cycle of 1 of the crank"),
    ({"inputs": {"left": {"type": "crank", "pivot": "C", "ratio": 1}}}, "link 'left' is already moved by inputs.left"),
    ({"input": SLIDER, "guides": {"way": {}}}, "inputs.second: the first input slides and has no angle"),
    ({"regimes": {"idle": {"type": "steady"}}}, "regimes.idle: counts on one drive"),
    ({"flywheel": {"speed_fluctuation": 0.05}}, "flywheel: counts on one drive"),
)


def test_second_input_that_never_moves__is_refused():
    with pytest.raises(ValueError, match="never moves: give a ratio, a speed, harmonics"):
        Scene.model_validate(changed(FIVE_BAR, inputs__second__ratio=0, inputs__second__harmonics={}))


def test_ratio_of_a_cycle__is_the_same_for_all_variants():
    with pytest.raises(AskError, match=r"inputs\.second\.ratio: its turns in a cycle"):
        Machine(Scene.model_validate(FIVE_BAR), varied=["inputs.second.ratio"])
