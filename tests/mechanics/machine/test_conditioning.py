"""How groups magnify inaccuracies of their links, against differences and closed forms; whether their loops close."""

import math
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from drawn_machines import geared_five_bar, quick_return, scotch_yoke, slider_crank, sliding_input
from exact import top_between
from machines import chain

from engine import Machine, Scene, Verdict
from engine.graph.nodes import Application, Node, name_of
from engine.graph.values import NodeValues
from engine.mechanism.mechanics import Mechanics
from engine.scene.scene import Numbers, scene_numbers

EPS = np.finfo(float).eps
POSITIONS = 720

# Of each dyad of the chain: numbers of its own, and fields that they displace.
DISPLACED = {
    "g0": (["groups.g0.first.length", "groups.g0.second.length"], ["B0.x", "B0.y"]),
    "g1": (["groups.g1.first.length", "groups.g1.second.offset"], ["B1.x", "B1.y"]),
    "g2": (["groups.g2.second.offset"], ["v2.angle"]),
    "g3": (["groups.g3.first.offset", "groups.g3.second.offset"], ["B3.x", "B3.y"]),
    "g4": (["points.T2.x", "points.T2.y"], ["v4.slide"]),
}
NUMBERS = [path for paths, _ in DISPLACED.values() for path in paths]
FIELDS = [field for _, fields in DISPLACED.values() for field in fields]
STEP = 1e-3


@cache
def five_dyads() -> Scene:
    return Scene.model_validate(chain(0, 5, False))


@pytest.fixture(scope="module")
def displaced() -> dict[str, np.ndarray]:
    """Derivative of every field by every number (numbers, positions), by differences of the fourth order."""
    machine = Machine(five_dyads(), (), [*FIELDS, "T1.x", "T1.y"], NUMBERS, POSITIONS)
    nominal = Numbers(scene_numbers(five_dyads()), {})
    moved = {path: np.full(4 * len(NUMBERS), nominal[path]) for path in NUMBERS}
    for i, path in enumerate(NUMBERS):
        moved[path][4 * i : 4 * i + 4] += STEP * np.array([1, -1, 2, -2])
    outcome = machine.evaluate(moved)
    assert (outcome.status == Verdict.OK).all()
    found = {}
    for name, rows in outcome.fields.items():
        one, other, far, beyond = rows.reshape(len(NUMBERS), 4, -1).transpose(1, 0, 2)
        found[name] = (8 * (one - other) - (far - beyond)) / (12 * STEP)
    # The last number moves nothing before the pin of the last dyad.
    x, y = (outcome.fields[f"T1.{axis}"][-1] for axis in "xy")
    pivot = five_dyads().points["D2"]
    return found | {"arm": np.hypot(x - pivot.x, y - pivot.y)}


def test_residual_of_rounding__takes_no_panels_from_what_is_asked_beside_it():
    alone = Machine(five_dyads(), ["g0.error_magnification", "positions_used"]).evaluate({})
    beside = Machine(five_dyads(), ["g0.error_magnification", "positions_used", "loop_closure_residual"]).evaluate({})
    for name, values in alone.summaries.items():
        assert beside.summaries[name][0] == pytest.approx(values[0], rel=1e-12)


@pytest.fixture(scope="module")
def magnified() -> dict[str, float]:
    names = [*(f"{group}.error_magnification" for group in five_dyads().groups), "error_magnification"]
    outcome = Machine(five_dyads(), [*names, "loop_closure_residual"], positions=POSITIONS).evaluate({})
    return {name: float(values[0]) for name, values in outcome.summaries.items()}


@pytest.mark.parametrize("group", DISPLACED)
def test_magnification__displacement_of_the_joint_by_an_error_of_a_length(group, displaced, magnified):
    paths, fields = DISPLACED[group]
    rows = [NUMBERS.index(path) for path in paths]
    by_number = np.sqrt(sum(displaced[field][rows] ** 2 for field in fields))
    if group == "g2":
        # An error of the slot's offset turns the rocker; its point at the pin moves by the angle times its arm.
        by_number = by_number * displaced["arm"]
    if group == "g4":
        # The crossing of slot and guide follows the pin's displacement across the slot, whatever its direction.
        by_number = np.hypot(*by_number)[None]
    # Truncation is of the order of (STEP/sin γ)⁴, γ no less than 1/2; rounding EPS/STEP, angles and slides of order 1.
    # A quartic through the highest five of 720 misses harmonics m by some (m h)⁵/1000, 1e-8 of the tenth.
    for row in by_number:
        assert top_between(row) == pytest.approx(magnified[f"{group}.error_magnification"], rel=1e-8)


def test_magnification_of_the_machine__that_of_its_worst_group(magnified):
    of_groups = [value for name, value in magnified.items() if name.endswith(".error_magnification")]
    assert len(of_groups) == len(five_dyads().groups)
    assert magnified["error_magnification"] == max(of_groups)


@pytest.mark.parametrize("short", [0.5, 1e-3, 1e-6, 1e-10])
def test_magnification_near_a_change_point__closed_form(short):
    # Crank and rod all but equal: across the guide the rod stands at asin(r/l).
    machine = Machine(slider_crank(), ["g.error_magnification"], varied=["groups.g.first.length"], positions=POSITIONS)
    length = 0.05 * (1 + short)
    outcome = machine.evaluate({"groups.g.first.length": np.array([length])})
    made, error = (part["g.error_magnification"][0] for part in (outcome.summaries, outcome.errors))
    expected = length / math.sqrt((length - 0.05) * (length + 0.05))
    # Coordinates are good to an EPS or two of the crank, what the rod leaves over to that by its own size.
    assert abs(made - expected) <= error + 8 * EPS * (1 + 1 / short) * expected
    # A curve is followed to 1e-9 of its peak, which is a multiple 1/sine of that of the sine's least value.
    assert error <= 1e-8 * expected**2


# Loops


@pytest.mark.parametrize(
    "made",
    [
        five_dyads,
        lambda: Scene.model_validate(chain(4, 10, True)),
        geared_five_bar,
        sliding_input,
        lambda: quick_return(0.01),
        scotch_yoke,
    ],
    ids=["chain", "series", "five-bar", "sliding input", "quick return", "yoke"],
)
def test_loops__close_to_rounding(made):
    outcome = Machine(made(), ["loop_closure_residual"], positions=POSITIONS).evaluate({})
    # Some ten roundings of coordinates up to ten times as great as a link.
    assert 0 < outcome.summaries["loop_closure_residual"][0] < 100 * EPS


def test_crank_alone__has_no_loop():
    scene = slider_crank().model_dump(exclude_none=True) | {"groups": {}, "bodies": {}}
    available = Machine(Scene.model_validate(scene)).available_summaries
    assert not {"loop_closure_residual", "error_magnification"} & available.keys()


class Spoilt(NodeValues):
    """Values of a graph's nodes with the results of one law changed."""

    def __init__(self, mechanics: Mechanics, law: str, change: Callable | None) -> None:
        super().__init__(mechanics.graph, Numbers(scene_numbers(mechanics.scene), {}))
        self.law, self.change = law, change

    def _value(self, node: Node, q: np.ndarray, found: dict) -> object:
        value = super()._value(node, q, found)
        return self.change(value) if isinstance(node, Application) and name_of(node.law) == self.law else value


def added(place: int, by: float) -> Callable:
    return lambda found: (*found[:place], found[place] + by, *found[place + 1 :])


def closures(spoilt: str = "", change: Callable | None = None) -> dict[str, float]:
    """What the loops of the chain miss at one position, with the results of one law changed."""
    mechanics = Mechanics(five_dyads())
    nodes = mechanics.kinematics.closures
    values = Spoilt(mechanics, spoilt, change)(list(nodes.values()), np.array([0.7]))
    return {group: float(value[0]) for group, value in zip(nodes, values, strict=True)}


@pytest.mark.parametrize(
    ("function", "places", "groups"),
    [
        ("rrr_position", range(6), ["g0"]),
        ("rrp_position", range(5), ["g1"]),
        ("rpr_position", range(3), ["g2"]),
        ("prp_position", range(4), ["g3"]),
        ("rpp_position", range(6), ["g4", "y3"]),
    ],
)
def test_wrong_position__is_what_the_loop_misses(function, places, groups):
    assert max(closures().values()) < 100 * EPS
    for place in places:
        found = closures(function, added(place, 1e-6))
        # Links are some metres long at most; a spoilt direction or place is missed by 1e-6, over that.
        assert all(1e-8 < found[group] < 1e-4 for group in groups), (place, found)
