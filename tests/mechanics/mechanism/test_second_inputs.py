"""Second inputs: five-bars by two circles and by Fourier, powers and friction of both drives, refusals."""

import numpy as np
import pytest
from driving_cams import asked, changed
from each_case import refusals
from test_crank_driven_inputs import FIVE_BAR as DRIVEN

from engine import Machine, Scene
from engine.machine.results import AskError
from engine.scene.structure.ordering import order

EPS = np.finfo(float).eps
HARMONICS = {"one": {"order": 1, "cosine": 0.2, "sine": -0.3}, "three": {"order": 3, "cosine": 0.04, "sine": 0.05}}
FIVE_BAR = changed(
    DRIVEN, moments=None, flywheel=None, regimes=None, inputs__second__drive=None, inputs__second__harmonics=HARMONICS
)


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
    ({"inputs__second__pivot": "B"}, "inputs.second.pivot: 'B' is on a link that this input drives"),
    ({"inputs__second__ratio": 0.5}, "makes 0.5 turns in a cycle of 1 of the crank"),
    ({"inputs": {"left": {"type": "crank", "pivot": "C", "ratio": 1}}}, "link 'left' is already moved by inputs.left"),
    ({"input": SLIDER, "guides": {"way": {}}}, "inputs.second: the first input slides and has no angle"),
    ({"regimes": {"idle": {"type": "steady"}}}, "regimes.idle: needs a single drive"),
    ({"flywheel": {"speed_fluctuation": 0.05}}, "flywheel: needs a single drive"),
)


def test_second_input_that_never_moves__is_refused():
    with pytest.raises(ValueError, match="never moves: give a ratio, a speed, harmonics"):
        Scene.model_validate(changed(FIVE_BAR, inputs__second__ratio=0, inputs__second__harmonics={}))


def test_ratio_of_a_cycle__is_the_same_for_all_variants():
    with pytest.raises(AskError, match=r"inputs\.second\.ratio: its turns in a cycle"):
        Machine(Scene.model_validate(FIVE_BAR), varied=["inputs.second.ratio"])
