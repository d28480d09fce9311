"""Cylinders on a machine: the work of a cycle against the area of its indicator diagram."""

import math

import numpy as np
import pytest
from machines import crank, slider_crank

from engine import Machine, MovingMachine, Scene

TURN = 2 * math.pi
P = {"suction": 1.0e5, "discharge": 6.0e5, "intake": 0.9e5, "exhaust": 1.1e5, "peak": 50e5}
BORE, CLEARANCE, PORT, NC, NE = 0.08, 0.12, 0.8, 1.32, 1.25

GAS = {"clearance": CLEARANCE, "n_compression": NC, "n_expansion": NE}
CYLINDERS = {
    "compressor": GAS | {"suction": P["suction"], "discharge": P["discharge"]},
    "pump": {"suction": P["suction"], "discharge": P["discharge"]},
    "four_stroke": GAS | {"intake": P["intake"], "exhaust": P["exhaust"], "peak": P["peak"]},
    "two_stroke": GAS | {"intake": P["intake"], "exhaust": P["exhaust"], "peak": P["peak"], "port": PORT},
}


def polytropic_work(p, before, after, n):
    """∫p dV of p Vⁿ = constant, with its pressure at the end."""
    end = p * (before / after) ** n
    return (p * before - end * after) / (n - 1), end


def indicated(kind):
    """Work of the gas per cycle over piston area × stroke [Pa]: the closed area of its diagram."""
    least, most = CLEARANCE, 1 + CLEARANCE
    if kind == "pump":
        return P["suction"] - P["discharge"]
    if kind == "compressor":
        low, high = P["suction"], P["discharge"]
        opens = most * (low / high) ** (1 / NC)
        shuts = least * (high / low) ** (1 / NE)
        squeezed, _ = polytropic_work(low, most, opens, NC)
        expanded, _ = polytropic_work(high, least, shuts, NE)
        return squeezed + high * (least - opens) + expanded + low * (most - shuts)
    end = most if kind == "four_stroke" else PORT + CLEARANCE
    power, _ = polytropic_work(P["peak"], least, end, NE)
    squeezed, _ = polytropic_work(P["intake"], end, least, NC)
    # A four-stroke cycle pumps its charge; with ports the exhaust's pressure does its work back and forth.
    return power + squeezed + (P["intake"] - P["exhaust"] if kind == "four_stroke" else 0)


def engine(cylinders, **more):
    scene = slider_crank(cylinders=cylinders)
    scene["input"] = crank(length=0.05, speed=100.0, revolutions=2)
    return Scene.model_validate(scene | more)


ALL = {
    f"{kind.replace('_', '')}_{head}": {"type": kind, "piston": "ram", "bore": BORE, "head": head} | numbers
    for kind, numbers in CYLINDERS.items()
    for head in ("high", "low")
}
VARIED = {
    "input.speed": np.array([100.0, -100.0, 100.0, -100.0, 30.0]),
    "groups.g.second.offset": np.array([0.0, 0.0, 0.03, 0.03, -0.05]),
    "groups.g.first.length": np.array([0.2, 0.2, 0.15, 0.15, 0.11]),
}
POSITIONS = 14_400


@pytest.fixture(scope="module")
def outcome():
    asked = [f"{name}.moment.mean" for name in ALL]
    return Machine(engine(ALL), asked, varied=list(VARIED), positions=POSITIONS).evaluate(VARIED)


@pytest.mark.parametrize("name", list(ALL))
def test_work_of_a_cycle__is_the_area_of_the_diagram(outcome, name):
    rod, offset = VARIED["groups.g.first.length"], VARIED["groups.g.second.offset"]
    stroke = np.sqrt((rod + 0.05) ** 2 - offset**2) - np.sqrt((rod - 0.05) ** 2 - offset**2)
    kind = ALL[name]["type"]
    cycles = 1 if kind == "four_stroke" else 2
    area = math.pi / 4 * BORE**2
    expected = cycles * indicated(kind) * area * stroke
    # The machine turns with its speed: backwards, its moments do their work over a falling angle.
    found = outcome.summaries[f"{name}.moment.mean"] * 2 * TURN * np.sign(VARIED["input.speed"])
    # Jumps of p, in the steps of 4π/14 400 in which a port or the next stroke begins; the piston moves at most r a rad
    # (and up to 1.9 r with the shortest rod). In a dead centre it stands still, so the port alone counts.
    jump = 2 * cycles * 10e5 * area * 0.1 * (2 * TURN / POSITIONS) / 2 if kind == "two_stroke" else 0.0
    np.testing.assert_allclose(found, expected, rtol=1e-5, atol=jump)


@pytest.mark.parametrize("speed", [100.0, -100.0])
def test_four_strokes__follow_the_firing_angle(speed):
    one = {"type": "four_stroke", "piston": "ram", "bore": BORE} | CYLINDERS["four_stroke"]
    scene = engine({"first": one, "second": one | {"firing_angle": TURN}})
    fields = ["first.moment", "second.moment", "B.x_phi"]
    first, second, slope = MovingMachine(scene, {"input.speed": speed}).fields(fields).values()
    # A turn later is half of the 720 positions later, whichever way it turns.
    np.testing.assert_allclose(second, np.roll(first, 360), rtol=1e-9, atol=1e-9 * np.abs(first).max())
    power = range(5, 175) if speed > 0 else range(720 - 175, 720 - 5)
    exhaust = range(185, 355) if speed > 0 else range(720 - 355, 720 - 185)
    assert (first[power] * np.sign(speed) > 0).all()
    area = math.pi / 4 * BORE**2
    expected = -area * (P["exhaust"] - 101_325) * slope[exhaust]
    np.testing.assert_allclose(first[exhaust], expected, rtol=1e-9)


def test_pressure__acts_from_the_head_towards_the_other_end():
    pump = {"type": "pump", "piston": "ram", "bore": BORE, "ambient": 0.0, "suction": 0.0, "discharge": 1e5}
    scene = engine({"right": pump, "left": pump | {"head": "low"}})
    right, left, slope = MovingMachine(scene).fields(["right.moment", "left.moment", "B.x_phi"]).values()
    area = math.pi / 4 * BORE**2
    np.testing.assert_allclose(right, -1e5 * area * np.maximum(slope, 0), atol=1e-9)
    np.testing.assert_allclose(left, 1e5 * area * np.minimum(slope, 0), atol=1e-9)


def test_required_power__is_the_indicated_power():
    machine = engine({"c": {"type": "compressor", "piston": "ram", "bore": BORE} | CYLINDERS["compressor"]})
    asked = ["required_power", "required_drive_moment", "mean_useful_moment"]
    outcome = Machine(machine, asked, varied=["input.speed"]).evaluate({"input.speed": np.array([100.0, -50.0])})
    power = -indicated("compressor") * math.pi / 4 * BORE**2 * 0.1 * np.array([100.0, 50.0]) / TURN
    # The bends of the diagram, where valves open, cost h²; the figures say how much.
    found, errors = outcome.summaries["required_power"], outcome.errors["required_power"]
    assert (np.abs(found - power) <= errors).all()
    np.testing.assert_allclose(found, power, rtol=2e-4)
    np.testing.assert_allclose(outcome.summaries["required_drive_moment"] * [100.0, -50.0], found, rtol=1e-12)
    drive = outcome.summaries["required_drive_moment"]
    np.testing.assert_allclose(outcome.summaries["mean_useful_moment"], drive, rtol=1e-12)
