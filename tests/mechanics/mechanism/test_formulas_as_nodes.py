"""Formulas of loads as nodes: random ones against the same text evaluated by Python, their derivatives and cuts."""

import math
import re
from itertools import pairwise

import numpy as np
from graph_values import GraphValues
from hypothesis import example, given, reject, settings
from hypothesis import strategies as st
from machines import slider_crank

from engine import Scene, SceneError
from engine.graph.nodes import Graph, Node, Stage
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.loads import Loads
from engine.scene.structure.ordering import order

CRANK, ROD, OFFSET, ANGLE = 0.05, 0.17, 0.012, 0.3
NUMBERS = {"k": 0.7, "n": 1.7, "m": -0.4}


def scene_of(text: str, speed: float, **more: object) -> Scene:
    """An offset slider-crank, its ram under a force by a formula; units of N make any number a force."""
    force = {"type": "formula", "on": "B", "angle": ANGLE, "force": f"1 N * ({text})", "numbers": NUMBERS, **more}
    way = {"way": {"y": OFFSET}}
    return Scene.model_validate(slider_crank(CRANK, ROD, speed, "drive", guides=way, forces={"push": force}))


def by_hand(q: np.ndarray, speed: float) -> dict[str, np.ndarray]:
    """Names of formulas in closed form, lengths over 0.1 m, speeds over 1 m/s and times over 1 s."""
    x, y = CRANK * np.cos(q), CRANK * np.sin(q)
    along = np.sqrt(ROD**2 - (OFFSET - y) ** 2)
    reach, reach_phi = x + along, -y + (OFFSET - y) * x / along
    turn = -x / along
    # Ends of the stroke: crank and rod in one line.
    high, low = math.sqrt((ROD + CRANK) ** 2 - OFFSET**2), math.sqrt((ROD - CRANK) ** 2 - OFFSET**2)
    return {
        "phi": q,
        "(omega / (1 rad/s))": speed + 0 * q,
        "(v / (1 m/s))": speed * reach_phi * math.cos(ANGLE),
        "(ram.velocity / (1 m/s))": speed * reach_phi,
        "(rod.angular_velocity / (1 rad/s))": speed * turn,
        "(ram.slide / (0.1 m))": reach / 0.1,
        "(ram.from_low / (0.1 m))": (reach - low) / 0.1,
        "(ram.from_high / ram.stroke)": (high - reach) / (high - low),
        "(A.x / (0.1 m))": x / 0.1,
        "(A.vy / (1 m/s))": speed * x,
        "rod.angle": np.arctan2(OFFSET - y, along),
        "crank.angle": q,
        "(t / (1 s))": (q if speed > 0 else q - 2 * np.pi) / speed,
        "(input.length / (0.1 m))": CRANK / 0.1 + 0 * q,
        **{name: value + 0 * q for name, value in NUMBERS.items()},
    }


SPEEDS = (3.0, -2.0)
KNOWN = sorted(by_hand(np.zeros(1), 1.0), key=len, reverse=True)
NAMES = re.compile("|".join(re.escape(name) if "(" in name else rf"\b{re.escape(name)}\b" for name in KNOWN))
names = st.sampled_from(KNOWN)
leaves = names | st.floats(-3, 3).map(lambda x: f"({round(x, 2)})")
sums = st.recursive(
    leaves,
    lambda inner: st.one_of(
        st.tuples(st.sampled_from(["({} + {})", "({} - {})", "({} * {})", "min({}, {})", "max({}, {})"]), inner, inner),
        st.tuples(st.sampled_from(["({} / (2 + sin({})))", "atan2({}, 3 + cos({}))"]), inner, inner),
        st.tuples(
            st.sampled_from(
                [
                    *("-{}", "abs({})", "sign({})", "({})^2", "({})^3"),
                    *("abs({})^1.5", "sin({})", "cos({})", "atan({})"),
                    *("sqrt(1 + ({})^2)", "(1 + abs({}))^n", "log(2 + sin({}))", "(1 + abs({}))^-2", "exp(-abs({}))"),
                    *("tan(sin({}))", "asin(0.9 * sin({}))", "acos(0.9 * cos({}))", "degrees({})", "radians({})"),
                ]
            ),
            inner,
        ),
        st.tuples(st.just("({} if {} > {} else {})"), inner, inner, inner, inner),
        st.tuples(st.just("({} if {} < 0.3 and not {} >= {} or {} < -1 else {})"), *[inner] * 6),
    ).map(lambda parts: parts[0].format(*parts[1:])),
    max_leaves=8,
)

PYTHON = {
    **{name: getattr(np, name) for name in ("sin", "cos", "tan", "exp", "log", "sqrt", "abs", "sign", "degrees")},
    **{"asin": np.arcsin, "acos": np.arccos, "atan": np.arctan, "atan2": np.arctan2, "radians": np.radians},
    **{"min": np.minimum, "max": np.maximum, "__builtins__": {}},
}


def evaluated(text: str, values: dict[str, np.ndarray], at: int) -> float:
    """The formula as Python has it, at one position."""
    text = NAMES.sub(lambda name: f"values[{name[0]!r}]", text)
    return float(eval(text.replace("^", "**"), PYTHON | {"values": {name: x[at] for name, x in values.items()}}))


def force_of(scene: Scene) -> tuple[GraphValues, Node]:
    try:
        structure = order(scene)
    except SceneError:
        # It may switch too often.
        reject()
    loads = Loads(scene, Kinematics(scene, structure, Graph(), frozenset()))
    graph = loads.kinematics.graph
    force = graph.combination((load.coefficient, load.characteristic) for load in loads.terms)
    return GraphValues(scene, graph), force


@settings(max_examples=20)
@given(sums, st.sampled_from(SPEEDS))
def test_random_formula__is_what_python_makes_of_it(text, speed):
    values, force = force_of(scene_of(text, speed))
    q = np.random.default_rng(len(text)).uniform(0.0, 2 * math.pi, 6)
    known = by_hand(q, speed)
    found = values([force], q)[0]
    with np.errstate(all="ignore"):
        expected = np.array([evaluated(text, known, i) for i in range(q.size)])
        beside = [np.array([evaluated(text, by_hand(q + h, speed), i) for i in range(q.size)]) for h in (1e-9, -1e-9)]
    # Where a piece switches within rounding, and as far as the formula magnifies the roundings of its names.
    near = 1e-5 * sum(np.abs(b - expected) for b in beside)
    wild = np.abs(beside[0] - beside[1]) > 1e-6 * (1 + np.abs(expected))
    size = np.abs(expected) + 1.0
    good = ~wild & np.isfinite(expected)
    assert (np.abs(found - expected) <= 1e-11 * size + near)[good].all(), (text, found, expected)
    assert (np.isnan(found) == np.isnan(expected))[~wild].all()


# The minimum of a curve and of numbers between which another part switches.
STEPPED = "min(rod.angular_velocity / (1 rad/s), (n if rod.angular_velocity / (1 rad/s) > phi else k))"


@settings(max_examples=20)
@given(sums, st.sampled_from(SPEEDS))
@example(STEPPED, 3.0)
def test_what_switches__lies_at_a_declared_crossing(text, speed):
    """In the panels that the crossings cut, what is held in the middle holds everywhere."""
    values, force = force_of(scene_of(text, speed))
    cuts = values.cuts([force])
    for left, right in pairwise(cuts):
        width = right - left
        if width < 1e-6:
            continue
        q = left + width * np.linspace(0.001, 0.999, 7)
        found, held = values([force], q)[0], values.in_panel([force], left, right, q)[0]
        np.testing.assert_allclose(held, found, rtol=1e-12, atol=1e-12 * (1 + np.nanmax(np.abs(found), initial=0)))


@settings(max_examples=20)
@given(sums, st.sampled_from(SPEEDS))
def test_derivative_of_a_switching_curve__is_its_slope(text, speed):
    values, _ = force_of(scene_of(f"max({text}, 0.1)", speed))
    h, q = 1e-4, np.random.default_rng(len(text)).uniform(0.01, 2 * math.pi - 0.01, 5)
    for crossing in values.graph.crossings:
        if crossing.curve.stage < Stage.POSITION:
            continue
        near = [values([crossing.curve], q + k * h)[0] for k in (-2, -1, 1, 2)]
        rate = values([crossing.rate], q)[0]
        rates = [values([crossing.rate], q + k * h)[0] for k in (-2, -1, 1, 2)]
        slope = (near[0] - 8 * near[1] + 8 * near[2] - near[3]) / (12 * h)
        size = np.max(np.abs([rate, *rates]), axis=0) + 1e-3 + np.max(np.abs(near), axis=0)
        # Fourth order; not where a piece ends nearby, where the slopes beside differ.
        smooth = np.max(np.abs(np.diff([*rates[:2], rate, *rates[2:]], n=2, axis=0)), axis=0) < 1e-4 * size
        assert (np.abs(slope - rate) <= 2e-4 * size)[smooth & np.isfinite(slope)].all(), text
