"""What switches in a load, over scenes of any kind: all of it where the graph says, and smooth in between.

Within a panel a held node has the value of the panel's middle. If a load jumped or bent at a place that the graph
doesn't name, what is held would differ from what holds at some position; if something that switches weren't held, a
polynomial through a panel's positions would miss the load between them.
"""

import itertools
import math

import numpy as np
import pytest
from graph_values import GraphValues
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from machines import crank, four_bar, frame, on, rpr, rrp, slider_crank

from engine import Scene
from engine.graph.nodes import Graph, Node
from engine.mechanism.actions.paths import uniform_time
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.loads import Loads
from engine.scene.structure.ordering import order

some = settings(deadline=None, max_examples=12)

TURN = 2 * math.pi
# Cuts closer than this are one: rounding moves a place at which a curve has a slope by less. Nearer to a dead centre a
# stroke, which changes by the square of the distance, may lie beyond its end by rounding.
MERGED = 1e-6
# Panels in each cycle, at least.
DEGREE, PANELS = 20, 16
# After so many halvings a piece of a panel is as short as 0.006 of a turn of the input.
HALVINGS = 4


# Scenes: a mechanism, the points that can be loaded, its sliders and its links


def any_slider_crank(draw: st.DrawFn) -> tuple:
    scene = slider_crank(0.05, draw(st.floats(0.12, 0.4)), draw(st.sampled_from([5.0, -5.0])))
    scene["guides"]["way"] = {"angle": draw(st.floats(-3, 3)), "y": draw(st.floats(-0.02, 0.02))}
    scene["groups"]["g"]["second"]["offset"] = draw(st.floats(-0.02, 0.02))
    scene["points"] |= {"K": on("rod", 0.05, 0.03), "R": on("ram", 0.02, 0.01)}
    if draw(st.booleans()):
        scene["input"] |= {"start": -0.7, "stop": draw(st.floats(0.5, 5.0))}
    elif draw(st.booleans()):
        scene["input"]["revolutions"] = 2
    return scene, ["A", "B", "K", "R", "O"], ["ram"], ["crank", "rod"]


def any_four_bar(draw: st.DrawFn) -> tuple:
    scene = four_bar(draw(st.sampled_from([1, -1])), C=on("rocker", 0.7, 0.1), K=on("coupler", 0.4, 0.2))
    scene["guides"] = {"way": {"x": 1.2, "y": 0.4, "angle": draw(st.floats(-0.3, 0.3))}}
    scene["groups"]["drive"] = rrp("E", ("link", "C", draw(st.floats(1.5, 2.0))), "ram", "way", 0.05)
    scene["input"]["speed"] = draw(st.sampled_from([2.0, -2.0]))
    return scene, ["A", "B", "C", "E", "K", "D"], ["ram"], ["coupler", "rocker", "link"]


def any_shaper(draw: st.DrawFn) -> tuple:
    scene = {
        "points": {"O": frame(0, 0), "D": frame(0.02, draw(st.floats(-0.4, -0.2))), "T": on("lever", 0.7, 0.0)},
        "guides": {"way": {"y": 0.3}},
        "input": crank(length=0.1, speed=draw(st.sampled_from([7.0, -7.0]))),
        "groups": {"slot": rpr(("block", "A"), ("lever", "D")), "drive": rrp("E", ("link", "T", 0.9), "ram", "way")},
    }
    return scene, ["T", "E", "A"], ["ram", "block"], ["lever", "block", "link"]


def any_driven_slider(draw: st.DrawFn) -> tuple:
    ends = draw(st.sampled_from([(0.0, 0.1), (0.1, 0.0)]))
    scene = {
        "points": {"D": frame(0.05, 0.25)},
        "guides": {"way": {"angle": draw(st.floats(-0.4, 0.4))}},
        "input": {
            "type": "slider",
            "link": "piston",
            "guide": "way",
            "point": "P",
            "start": ends[0],
            "stop": ends[1],
            "speed": math.copysign(0.3, ends[1] - ends[0]),
        },
        "groups": {"g": rpr(("block", "P"), ("lever", "D"))},
    }
    return scene, ["P"], ["piston", "block"], ["lever"]


MECHANISMS = [any_slider_crank, any_four_bar, any_shaper, any_driven_slider]
ACTS = st.sampled_from(["always", "along", "against"])
FORCE = st.floats(-500, 500)


def a_table(draw: st.DrawFn, scene: dict, sliders: list[str]) -> dict:
    """Rows as close as a tenth of a millimetre or radian, steps among them."""
    over = draw(st.sampled_from(["over_stroke", "over_time", "over_angle"]))
    if over == "over_angle" and scene["input"]["type"] == "slider":
        over = "over_stroke"
    interpolation = draw(st.sampled_from(["linear", "pchip", "spline"]))
    count = draw(st.integers(2, 6))
    origin = draw(st.sampled_from(["guide", "low end", "high end"]))
    ends = {
        "over_angle": (-7.0, 7.0),
        "over_time": (-0.1, 1.0),
        "over_stroke": (-0.05, 0.5 if origin == "guide" else 0.1),
    }
    begin = draw(st.floats(*ends[over]))
    longest = {"over_stroke": 0.15, "over_time": 0.3, "over_angle": 1.0}[over]
    gaps = draw(st.lists(st.floats(1e-4, longest), min_size=count - 1, max_size=count - 1))
    if interpolation == "linear" and count > 2 and draw(st.booleans()):
        gaps[draw(st.integers(0, count - 2))] = 0.0
    table = {over: list(np.cumsum([begin, *gaps])), "interpolation": interpolation}
    if over != "over_angle" or "start" in scene["input"]:
        table["outside"] = draw(st.sampled_from(["hold", "zero"]))
    if over == "over_stroke":
        table |= {"slider": draw(st.sampled_from(sliders)), "measured_from": origin}
    return table


def an_action(draw: st.DrawFn, scene: dict, sliders: list[str], value: str) -> dict:
    """Any characteristic of a force or moment."""
    kinds = ["constant", "against_motion", "linear_drag", "quadratic_drag", "power_drag", *["table"] * 5]
    kind = draw(st.sampled_from(kinds))
    acts = {"acts": draw(ACTS)}
    match kind:
        case "constant":
            return {"type": kind, value: draw(FORCE)} | acts
        case "table":
            table = a_table(draw, scene, sliders)
            count = len(next(v for k, v in table.items() if k.startswith("over")))
            rows = draw(st.lists(FORCE, min_size=count, max_size=count))
            return {"type": kind, value: rows} | table | acts
        case "against_motion":
            return {"type": kind, value: 30.0} | acts
        case "power_drag":
            # With a whole exponent it is smooth, with another one not at rest.
            return {"type": kind, value: 20.0, "at_speed": 0.7, "exponent": 3.0} | acts
    return {"type": kind, "coefficient": 7.0} | acts


def a_cylinder(draw: st.DrawFn, drive: dict, sliders: list[str]) -> dict:
    """Any kind, a compressor that doesn't reach its discharge pressure among them."""
    turns = drive["type"] == "crank" and "start" not in drive
    kind = draw(st.sampled_from(["compressor", "pump", "two_stroke", *["four_stroke"] * turns]))
    if kind == "four_stroke":
        drive["revolutions"] = 2
    gas = {"clearance": draw(st.floats(0.2, 0.6))}
    lines = {"suction": 1e5, "discharge": draw(st.floats(1.5e5, 2e6))}
    burnt = {"intake": 0.9e5, "exhaust": 1.1e5, "peak": 4e6}
    own = {
        "compressor": gas | lines,
        "pump": lines,
        "four_stroke": gas | burnt | {"firing_angle": draw(st.floats(-4, 8))},
        "two_stroke": gas | burnt | {"port": draw(st.floats(0.3, 1.0))},
    }[kind]
    head = draw(st.sampled_from(["high", "low"]))
    return {"type": kind, "piston": draw(st.sampled_from(sliders)), "bore": 0.01, "head": head} | own


@st.composite
def scenes(draw: st.DrawFn) -> Scene:
    """A machine with a force, a moment, a torsion spring and a cylinder."""
    scene, points, sliders, links = draw(st.sampled_from(MECHANISMS))(draw)
    force = an_action(draw, scene, sliders, "force") | {"on": draw(st.sampled_from(points))}
    if draw(st.booleans()) and force["type"] not in ("constant", "table"):
        del force["acts"]
    else:
        force |= {"angle": draw(st.floats(-3, 3)), "turns_with": draw(st.sampled_from(["frame", links[0]]))}
    moment = an_action(draw, scene, sliders, "moment") | {"on": draw(st.sampled_from(links))}
    twist = {"type": "torsion_spring", "on": links[0], "stiffness": 4.0, "free_angle": 0.3}
    loads = {"forces": {"f": force}, "moments": {"m": moment, "twist": twist}}
    return Scene.model_validate(scene | loads | {"cylinders": {"c": a_cylinder(draw, scene["input"], sliders)}})


# Properties


def asked(scene: Scene) -> tuple[GraphValues, dict[str, Node]]:
    """Characteristics, bases and directions of all loads."""
    graph = Graph()
    loads = Loads(scene, Kinematics(scene, order(scene), graph, frozenset()))
    nodes = {}
    for load in loads.terms:
        nodes |= {f"{load.action} characteristic": load.characteristic, f"{load.action} basis": load.basis}
        nodes[f"{load.action} velocity"] = load.velocity
        for axis, node in zip("xy", load.grip.direction or (), strict=False):
            nodes[f"{load.action} direction {axis}"] = node
    return GraphValues(scene, graph), nodes


def moves_along_its_loads(scene: Scene) -> bool:
    """Whether no load acts straight across the motion: the sense of what is nothing but rounding is nobody's."""
    values, nodes = asked(scene)
    velocities = values([node for name, node in nodes.items() if name.endswith("velocity")], values.samples)
    return all((v == 0.0).all() or np.abs(v).max() > 1e-9 for v in velocities)


def panels(values: GraphValues, nodes: dict[str, Node]) -> list[tuple[float, float]]:
    cuts = values.cuts([*nodes.values()])
    return [(left, right) for left, right in itertools.pairwise(cuts) if right - left > 10 * MERGED]


def check_switches(scene: Scene) -> None:
    """What is held in a panel holds at all of its positions."""
    values, nodes = asked(scene)
    for left, right in panels(values, nodes):
        q = np.linspace(left + MERGED, right - MERGED, 15)
        here, held = values([*nodes.values()], q), values.in_panel([*nodes.values()], left, right, q)
        for name, a, b in zip(nodes, here, held, strict=True):
            # The same laws of the same numbers; a period more or less in a table's abscissa leaves a rounding.
            np.testing.assert_allclose(a, b, rtol=1e-11, atol=1e-9, err_msg=f"{name} in {left} … {right}")


def check_smoothness(scene: Scene) -> None:
    """A polynomial through a panel's positions, its ends among them, is the load between them."""
    values, nodes = asked(scene)
    widest = (values.last - values.first) / PANELS
    for left, right in panels(values, nodes):
        for begin, end in pairs_of(np.linspace(left, right, 1 + math.ceil((right - left) / widest))):
            check_piece(values, nodes, (left, right), (begin, end), HALVINGS)


def check_piece(values: GraphValues, nodes: dict, panel: tuple, piece: tuple, halvings: int) -> None:
    """The same in a piece of a panel, or in both of its halves.

    What turns quickly, as the velocity of a point does that nearly comes to rest, takes shorter pieces. A jump is
    missed in pieces of any length, and a bend by about a hundredth of what it turns by times their length, at least
    1e-4 here.
    """
    x, between = np.cos(np.linspace(math.pi, 0, DEGREE + 1)), np.linspace(-1, 1, 33)
    middle, half = 0.5 * (piece[0] + piece[1]), 0.5 * (piece[1] - piece[0])
    at = values.in_panel([*nodes.values()], *panel, middle + half * np.concatenate((x, between)))
    for name, row in zip(nodes, at, strict=True):
        fitted = np.polynomial.chebyshev.Chebyshev.fit(x, row[: DEGREE + 1], DEGREE, domain=[-1, 1])(between)
        size = 1e-8 * (1.0 + np.abs(row).max())
        if halvings > 0 and not (np.abs(fitted - row[DEGREE + 1 :]) <= size).all():
            for part in ((piece[0], middle), (middle, piece[1])):
                check_piece(values, nodes, panel, part, halvings - 1)
            return
        np.testing.assert_allclose(fitted, row[DEGREE + 1 :], rtol=0, atol=size, err_msg=name)


def pairs_of(edges: np.ndarray) -> list[tuple[float, float]]:
    return list(itertools.pairwise(edges))


@some
@given(scenes())
def test_loads__switch_at_crossings_and_are_smooth_between(scene):
    assume(moves_along_its_loads(scene))
    check_switches(scene)
    check_smoothness(scene)


LIMITED = crank(length=0.05, start=0.5, stop=2.0)
SLIDING = {"type": "slider", "link": "piston", "guide": "way", "point": "A"}


@pytest.mark.parametrize(
    ("drive", "begin", "duration"),
    [
        (crank(length=0.05, speed=5.0), 0.0, TURN / 5),
        (crank(length=0.05, speed=-5.0), TURN, TURN / 5),
        (LIMITED | {"speed": 3.0}, 0.5, 0.5),
        (LIMITED | {"speed": -3.0}, 2.0, 0.5),
        (SLIDING | {"start": 0.01, "stop": 0.04, "speed": 0.1}, 0.01, 0.3),
        (SLIDING | {"start": 0.04, "stop": 0.01, "speed": -0.1}, 0.04, 0.3),
    ],
)
def test_time__begins_where_the_input_does(drive, begin, duration):
    scene = slider_crank(input=drive, guides={"way": {}, "other": {"angle": 1.2}})
    scene["groups"]["g"]["second"]["guide"] = "other"
    scene, graph = Scene.model_validate(scene), Graph()
    time = uniform_time(Kinematics(scene, order(scene), graph, frozenset()))
    values = GraphValues(scene, graph)
    end = values.first + values.last - begin
    np.testing.assert_allclose(values([time], np.array([begin, end]))[0], [0.0, duration], atol=1e-15)
