"""Second inputs that the crank drives, against geared shafts and cams of the same law: loads, wheel and motion."""

import numpy as np
from driving_cams import BALANCE, changed
from each_case import refusals
from five_bars import JOINED
from geared_links import CRANK
from machines import moving

from engine import Machine, Scene, Verdict
from engine.scene.structure.ordering import order

EPS = np.finfo(float).eps
MOTOR = {"type": "dc_motor", "on": "crank", "stall_moment": 30.0, "no_load_speed": "150 rpm"}
REST = {
    "gravity": 9.81,
    "input": CRANK,
    "moments": {"motor": MOTOR},
    "flywheel": {"inertia": 0.2, "speed_fluctuation": 0.05, "wheel": {"type": "rim", "diameter": 0.5}},
    "regimes": {"start": {"type": "run", "speed": "100 rpm"}, "idle": {"type": "steady"}},
}
SECOND = {"pivot": "C", "ratio": -1, "phase": 0.5}
FIVE_BAR = {
    **JOINED,
    **REST,
    "inputs": {"second": {"type": "crank", "drive": "crank", **SECOND}},
}
SECTIONS = {
    "out": {"type": "rise", "law": "modified sine", "angle": "100 deg", "lift": "50 mm"},
    "stay": {"type": "dwell", "angle": "60 deg"},
    "back": {"type": "return", "law": "3-4-5"},
}
RAM = {"type": "slider", "guide": "way", "start": 0.06, "begin": "20 deg", "drive": "crank", "sections": SECTIONS}
RAM_BY_DRIVE = {
    **REST,
    "points": {"O": {"x": 0, "y": 0}},
    "guides": {"way": {"angle": "70 deg"}},
    "inputs": {"ram": RAM},
    "bodies": {"ram_body": {"link": "ram", "mass": 3.0}},
}
GROOVE = {
    "on": "crank",
    "begin": "20 deg",
    "base_radius": 0.04,
    "closure": "form",
    "sections": SECTIONS,
    "follower": {
        "type": "translating", "link": "ram", "guide": "way", "contact": "roller", "roller_radius": 0.02,
    },
}  # fmt: skip
WHOLE = [
    *("reduced_inertia", "input_moment", "input_moment_by_equilibrium", "input_moment_by_power"),
    *("frame.reaction_x", "frame.reaction_y", "frame.reaction_moment"),
]
OF_CYCLE = ["required_power", "flywheel_wittenbauer", "excess_work", "wheel_mass"]
OF_MOTION = ["idle.speed_max", "idle.speed_fluctuation", "start.time"]


def compared(scene: dict, other: dict, fields: list[str], summaries: list[str]) -> None:
    """Both give the same, by rounding in fields and by their own figures in summaries."""
    rows, found = [], []
    for data in (scene, other):
        rows.append(moving(data, [*WHOLE, *fields], 36)[1])
        outcome = Machine(Scene.model_validate(data), [*BALANCE, *summaries]).evaluate({})
        assert outcome.status[0] == Verdict.OK
        assert all(outcome.summaries[name][0] < 1e-13 for name in BALANCE)
        found.append(outcome)
    for name, a in rows[0].items():
        assert np.abs(a).max() > 0.0
        np.testing.assert_allclose(a, rows[1][name], atol=64 * EPS * np.abs(a).max())
    one, two = found
    for name in summaries:
        a, b = one.summaries[name][0], two.summaries[name][0]
        assert np.isfinite(b)
        assert abs(a - b) <= one.errors[name][0] + two.errors[name][0] + 64 * EPS * abs(b)


def test_link_driven_by_a_ratio__is_a_geared_shaft():
    geared = changed(FIVE_BAR, inputs={}, shafts={"second": {**SECOND, "geared_to": "crank"}})
    fields = ["B.x", "second.angle_phi", "input.reaction_x", "second.reaction_y", "arms.inner.reaction"]
    compared(FIVE_BAR, geared, fields, [*OF_CYCLE, *OF_MOTION])


def test_slider_driven_by_sections__is_a_follower_in_a_groove():
    grooved = changed(RAM_BY_DRIVE, inputs={}, cams={"cam": GROOVE})
    compared(RAM_BY_DRIVE, grooved, ["ram.slide", "ram.slide_phi", "ram.slide_phiphi"], OF_CYCLE)


test_wrong_drives__are_refused_in_words = refusals(
    lambda changes: order(Scene.model_validate(changed(FIVE_BAR, **changes))),
    ({"inputs__second__pivot": "A"}, "inputs.second.drive: gears or cams between the crank and 'second' are on"),
    ({"inputs__second__drive": "own"}, "inputs.second.drive = 'crank'"),
)
