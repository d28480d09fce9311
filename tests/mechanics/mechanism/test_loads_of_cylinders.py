"""Cylinders: the work of their reduced moments, summed panel by panel, against the areas of the indicator diagrams."""

import itertools
import math

import numpy as np
import pytest
from graph_values import GraphValues
from machines import crank, slider_crank

from engine import Scene
from engine.graph.nodes import Graph
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.loads import Loads
from engine.scene.structure.ordering import order

BORE, CLEARANCE, PORT, NC, NE = 0.08, 0.12, 0.8, 1.32, 1.25
AREA = math.pi / 4 * BORE**2
CRANK, ROD, OFFSET = 0.05, 0.15, 0.03
STROKE = math.sqrt((ROD + CRANK) ** 2 - OFFSET**2) - math.sqrt((ROD - CRANK) ** 2 - OFFSET**2)
GAS = {"clearance": CLEARANCE, "n_compression": NC, "n_expansion": NE}
LINES = {"suction": 1.0e5, "discharge": 6.0e5}
BURNT = {"intake": 0.9e5, "exhaust": 1.1e5, "peak": 50e5}
KINDS = {
    "compressor": GAS | LINES,
    # So much clearance that the valves never open: the gas is a spring.
    "shut": GAS | LINES | {"clearance": 3.0, "type": "compressor", "n_expansion": NC},
    "pump": LINES,
    "four_stroke": GAS | BURNT,
    "two_stroke": GAS | BURNT | {"port": PORT},
}
PARTS, NODES = 12, 16


def polytropic_work(p: float, before: float, after: float, n: float) -> float:
    """∫p dV of p Vⁿ = constant."""
    return (p * before - p * (before / after) ** n * after) / (n - 1)


def indicated(kind: str) -> float:
    """Area of a closed diagram, of volumes over the swept volume."""
    least, most, low, high = CLEARANCE, 1 + CLEARANCE, LINES["suction"], LINES["discharge"]
    match kind:
        case "shut":
            return 0.0
        case "pump":
            return low - high
        case "compressor":
            opens, shuts = most * (low / high) ** (1 / NC), least * (high / low) ** (1 / NE)
            along_lines = high * (least - opens) + low * (most - shuts)
            return polytropic_work(low, most, opens, NC) + polytropic_work(high, least, shuts, NE) + along_lines
    end = most if kind == "four_stroke" else PORT + least
    burnt = polytropic_work(BURNT["peak"], least, end, NE) + polytropic_work(BURNT["intake"], end, least, NC)
    # A four-stroke cycle pumps its charge; with ports the exhaust's pressure does its work back and forth.
    return burnt + (BURNT["intake"] - BURNT["exhaust"] if kind == "four_stroke" else 0.0)


@pytest.mark.parametrize("speed", [100.0, -100.0])
def test_work_of_a_cycle__is_the_area_of_the_diagram(speed):
    cylinders = {
        f"{kind}_{head}": {"type": kind, "piston": "ram", "bore": BORE, "head": head} | numbers
        for kind, numbers in KINDS.items()
        for head in ("high", "low")
    }
    scene = slider_crank(CRANK, ROD, cylinders=cylinders) | {"input": crank(length=CRANK, speed=speed, revolutions=2)}
    scene["groups"]["g"]["second"]["offset"] = OFFSET
    scene = Scene.model_validate(scene)
    graph = Graph()
    loads = Loads(scene, Kinematics(scene, order(scene), graph, frozenset()))
    values = GraphValues(scene, graph)
    moments = [graph.combination([(load.coefficient, load.basis)]) for load in loads.terms]
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    works, sizes = np.zeros((2, len(moments)))
    for left, right in itertools.pairwise(values.cuts()):
        for begin, end in itertools.pairwise(np.linspace(left, right, PARTS + 1)):
            half = 0.5 * (end - begin)
            rows = np.array(values.in_panel(moments, left, right, begin + half * (1 + nodes)))
            works += half * rows @ weights
            sizes += half * np.abs(rows) @ weights
    for load, work, size in zip(loads.terms, works, sizes, strict=True):
        kind = load.action.rpartition("_")[0]
        cycles = 1 if kind == "four_stroke" else 2
        # The machine turns with its speed: backwards, its moments do their work over a falling angle.
        expected = cycles * indicated(kind) * AREA * STROKE * np.sign(speed)
        # Roundings of some thousand positions' moments, and of the places of the cuts, where p jumps.
        assert work == pytest.approx(expected, abs=1e-12 * size), load.action
