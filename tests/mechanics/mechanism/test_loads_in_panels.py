"""What switches in a load, over scenes of any kind: all of it where the graph says.

Within a panel a held node has the value of the panel's middle. If a load jumped or bent at a place that the graph
doesn't name, what is held would differ from what holds at some position.
"""

import itertools

import numpy as np
from graph_values import GraphValues
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from machines import crank, frame, on, rpr, rrp, slider_crank

from engine import Scene
from engine.graph.nodes import Graph, Node
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.loads import Loads
from engine.scene.structure.ordering import order

# Cuts closer than this are one: rounding moves a place at which a curve has a slope by less. Nearer to a dead centre a
# stroke, which changes by the square of the distance, may lie beyond its end by rounding.
MERGED = 1e-6
ACTS = st.sampled_from(["always", "along", "against"])
FORCE = st.floats(-500, 500)


# Scenes: a mechanism, the points that can be loaded, its sliders and its links


def any_slider_crank(draw: st.DrawFn) -> tuple:
    scene = slider_crank(0.05, draw(st.floats(0.12, 0.4)), draw(st.sampled_from([5.0, -5.0])))
    scene["guides"]["way"] = {"angle": draw(st.floats(-3, 3)), "y": draw(st.floats(-0.02, 0.02))}
    scene["points"] |= {"K": on("rod", 0.05, 0.03), "R": on("ram", 0.02, 0.01)}
    if draw(st.booleans()):
        scene["input"] |= {"start": -0.7, "stop": draw(st.floats(0.5, 5.0))}
    return scene, ["A", "B", "K", "R", "O"], ["ram"], ["crank", "rod"]


def any_shaper(draw: st.DrawFn) -> tuple:
    scene = {
        "points": {"O": frame(0, 0), "D": frame(0.02, draw(st.floats(-0.4, -0.2))), "T": on("lever", 0.7, 0.0)},
        "guides": {"way": {"y": 0.3}},
        "input": crank(length=0.1, speed=draw(st.sampled_from([7.0, -7.0]))),
        "groups": {"slot": rpr(("block", "A"), ("lever", "D")), "drive": rrp("E", ("link", "T", 0.9), "ram", "way")},
    }
    return scene, ["T", "E", "A"], ["ram", "block"], ["lever", "block", "link"]


def a_table(draw: st.DrawFn, sliders: list[str]) -> dict:
    """Rows as close as a tenth of a millimetre or radian, steps among them."""
    over, begin, longest = draw(st.sampled_from([("over_stroke", 0.0, 0.05), ("over_time", 0.0, 0.3)]))
    gaps = draw(st.lists(st.floats(1e-4, longest), min_size=3, max_size=3))
    interpolation = draw(st.sampled_from(["linear", "pchip", "spline"]))
    if interpolation == "linear" and draw(st.booleans()):
        gaps[1] = 0.0
    table = {over: list(np.cumsum([begin, *gaps])), "interpolation": interpolation, "outside": "zero"}
    if over == "over_stroke":
        table |= {"slider": draw(st.sampled_from(sliders))}
        table |= {"measured_from": draw(st.sampled_from(["guide", "low end", "high end"]))}
    return table


def an_action(draw: st.DrawFn, sliders: list[str], value: str) -> dict:
    """Any characteristic of a force or moment."""
    kind = draw(st.sampled_from(["constant", "against_motion", "quadratic_drag", "power_drag", "table"]))
    own = {
        "constant": {value: 50.0},
        "against_motion": {value: 30.0},
        "quadratic_drag": {"coefficient": 7.0},
        # With a whole exponent it is smooth, with another one not at rest.
        "power_drag": {value: 20.0, "at_speed": 0.7, "exponent": 3.0},
        "table": {value: draw(st.lists(FORCE, min_size=4, max_size=4)), **a_table(draw, sliders)},
    }[kind]
    return {"type": kind, "acts": draw(ACTS)} | own


def a_cylinder(draw: st.DrawFn, sliders: list[str]) -> dict:
    """A compressor that may not reach its discharge pressure, a pump or an engine."""
    gas, lines = {"clearance": draw(st.floats(0.2, 0.6))}, {"suction": 1e5, "discharge": draw(st.floats(1.5e5, 2e6))}
    kind, own = draw(
        st.sampled_from(
            [
                ("compressor", gas | lines),
                ("pump", lines),
                ("two_stroke", gas | {"intake": 0.9e5, "exhaust": 1.1e5, "peak": 4e6, "port": 0.7}),
            ]
        )
    )
    head = draw(st.sampled_from(["high", "low"]))
    return {"type": kind, "piston": draw(st.sampled_from(sliders)), "bore": 0.01, "head": head} | own


@st.composite
def scenes(draw: st.DrawFn) -> Scene:
    """A machine with a force, a moment, a torsion spring and a cylinder."""
    scene, points, sliders, links = draw(st.sampled_from([any_slider_crank, any_shaper]))(draw)
    force = an_action(draw, sliders, "force") | {"on": draw(st.sampled_from(points))}
    if draw(st.booleans()) and force["type"] not in ("constant", "table"):
        del force["acts"]
    else:
        force |= {"angle": draw(st.floats(-3, 3)), "turns_with": draw(st.sampled_from(["frame", links[0]]))}
    moment = an_action(draw, sliders, "moment") | {"on": draw(st.sampled_from(links))}
    twist = {"type": "torsion_spring", "on": links[0], "stiffness": 4.0, "free_angle": 0.3}
    loads = {"forces": {"f": force}, "moments": {"m": moment, "twist": twist}}
    return Scene.model_validate(scene | loads | {"cylinders": {"c": a_cylinder(draw, sliders)}})


def asked(scene: Scene) -> tuple[GraphValues, dict[str, Node]]:
    """Characteristics, bases, velocities and directions of all loads."""
    graph = Graph()
    nodes = {}
    for load in Loads(scene, Kinematics(scene, order(scene), graph, frozenset())).terms:
        nodes |= {f"{load.action} characteristic": load.characteristic, f"{load.action} basis": load.basis}
        nodes[f"{load.action} velocity"] = load.velocity
        for axis, node in zip("xy", load.grip.direction or (), strict=False):
            nodes[f"{load.action} direction {axis}"] = node
    return GraphValues(scene, graph), nodes


@settings(max_examples=15)
@given(scenes())
def test_what_is_held_in_a_panel__holds_at_all_of_its_positions(scene):
    values, nodes = asked(scene)
    velocities = values([node for name, node in nodes.items() if name.endswith("velocity")], values.samples)
    # The sense of what is nothing but rounding, straight across the motion, is nobody's.
    assume(all((v == 0.0).all() or np.abs(v).max() > 1e-9 for v in velocities))
    for left, right in itertools.pairwise(values.cuts([*nodes.values()])):
        if right - left > 10 * MERGED:
            q = np.linspace(left + MERGED, right - MERGED, 15)
            here, held = values([*nodes.values()], q), values.in_panel([*nodes.values()], left, right, q)
            for name, a, b in zip(nodes, here, held, strict=True):
                # The same laws of the same numbers; a period more or less in a table's abscissa leaves a rounding.
                np.testing.assert_allclose(a, b, rtol=1e-11, atol=1e-9, err_msg=f"{name} in {left} … {right}")
