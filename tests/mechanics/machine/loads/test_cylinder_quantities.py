"""Cylinders: indicated work against the closed forms of ideal diagrams, swept volume, delivery, pressures."""

import math

import machines
import numpy as np
import pytest

from engine import Machine, MovingMachine, Scene

CRANK, ROD, OFFSET, BORE, SPEED = 0.04, 0.15, 0.02, 0.08, 50.0
AREA = math.pi / 4 * BORE**2
STROKE = math.sqrt((ROD + CRANK) ** 2 - OFFSET**2) - math.sqrt((ROD - CRANK) ** 2 - OFFSET**2)
SWEPT = STROKE * AREA
CLEARANCE, PORT, NC, NE = 0.12, 0.8, 1.32, 1.28
GAS = {"clearance": CLEARANCE, "n_compression": NC, "n_expansion": NE}
ENGINE = {"intake": 0.95e5, "exhaust": 1.05e5, "peak": 45e5}
FOUR_STROKE = GAS | ENGINE | {"type": "four_stroke"}
EITHER_WAY = [(speed, head) for speed in (SPEED, -SPEED) for head in ("high", "low")]


def machine(speed: float, offset: float = OFFSET, **cylinders: dict) -> Scene:
    """An offset slider-crank with cylinders."""
    scene = machines.slider_crank(CRANK, ROD, speed)
    scene["input"]["revolutions"] = 2
    scene["groups"]["g"]["second"]["offset"] = offset
    every = {name: {"piston": "ram", "bore": BORE, **cylinder} for name, cylinder in cylinders.items()}
    return Scene.model_validate(scene | {"cylinders": every})


def ask(speed: float, names: str, **cylinder: object) -> dict[str, float]:
    """Quantities of a cylinder, and `work`, that of its moment on the crank in two turns."""
    asked = [*(f"gas.{name}" for name in names.split()), "gas.moment.mean"]
    outcome = Machine(machine(speed, gas=cylinder), asked).evaluate({})
    found = {name.removeprefix("gas."): float(outcome.summaries[name][0]) for name in asked}
    for name in asked:
        assert outcome.errors[name][0] <= 1e-9 * abs(outcome.summaries[name][0]) + 1e-12, name
    return found | {"work": found["moment.mean"] * 4.0 * math.pi * math.copysign(1.0, speed)}


def polytropic(p: float, v: float, w: float, n: float) -> float:
    """∫ p dV from a volume v at pressure p to a volume w."""
    return p * v / (n - 1.0) * (1.0 - (v / w) ** (n - 1.0))


@pytest.mark.parametrize(("speed", "head"), EITHER_WAY)
def test_compressor__takes_the_work_of_its_diagram_and_delivers_what_it_draws_in(speed, head):
    suction, discharge = 1e5, 6e5
    names = "indicated_work indicated_power swept_volume volume.min volume.max pressure.min pressure.max"
    found = ask(
        speed,
        f"{names} mean_effective_pressure delivery volumetric_efficiency",
        type="compressor", head=head, suction=suction, discharge=discharge, **GAS,
    )  # fmt: skip
    efficiency = 1.0 + CLEARANCE - CLEARANCE * (discharge / suction) ** (1.0 / NE)
    least, most = CLEARANCE * SWEPT, (1 + CLEARANCE) * SWEPT
    opens = most * (suction / discharge) ** (1.0 / NC)
    fills = least * (discharge / suction) ** (1.0 / NE)
    expands = polytropic(discharge, least, fills, NE) + suction * (most - fills)
    work = -expands - polytropic(suction, most, opens, NC) + discharge * (opens - least)
    expected = {"volumetric_efficiency": efficiency, "delivery": efficiency * SWEPT * SPEED / (2 * math.pi)}
    # A compressor's work is done on the gas; the cycle takes two turns.
    expected |= {"indicated_work": 2 * work, "indicated_power": work * SPEED / (2 * math.pi), "work": -2 * work}
    expected |= {"mean_effective_pressure": work / SWEPT, "swept_volume": SWEPT, "volume.min": least}
    expected |= {"volume.max": most, "pressure.min": suction, "pressure.max": discharge}
    assert {name: found[name] for name in expected} == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize(("speed", "head"), EITHER_WAY)
def test_pump_and_engines__do_the_work_of_their_diagrams(speed, head):
    found = ask(speed, "indicated_work delivery", type="pump", head=head, suction=0.8e5, discharge=9e5)
    assert (found["indicated_work"], found["work"]) == pytest.approx((16.4e5 * SWEPT, -16.4e5 * SWEPT), rel=1e-10)
    assert found["delivery"] == pytest.approx(SWEPT * SPEED / (2 * math.pi), rel=1e-12)
    intake, exhaust, peak = ENGINE.values()
    least = CLEARANCE * SWEPT
    for ends, pumped, turns, more in ((1.0, intake - exhaust, 2, FOUR_STROKE), (PORT, 0.0, 1, None)):
        # A four-stroke cycle pumps its charge; with ports the exhaust's pressure does its work back and forth.
        most = (ends + CLEARANCE) * SWEPT
        work = polytropic(peak, least, most, NE) + polytropic(intake, most, least, NC) + pumped * SWEPT
        given = more or GAS | ENGINE | {"type": "two_stroke", "port": PORT}
        found = ask(speed, "indicated_work indicated_power mean_effective_pressure", head=head, **given)
        assert found["indicated_work"] == pytest.approx(2 / turns * work, rel=1e-10)
        assert found["indicated_power"] == pytest.approx(work * SPEED / (2 * math.pi * turns), rel=1e-10)
        assert found["mean_effective_pressure"] == pytest.approx(work / SWEPT, rel=1e-10)
        assert found["work"] == pytest.approx(2 / turns * work, rel=1e-9)


@pytest.mark.parametrize("speed", [SPEED, -SPEED])
def test_four_strokes__follow_the_firing_angle(speed):
    scene = machine(speed, 0.0, first=FOUR_STROKE, second=FOUR_STROKE | {"firing_angle": 2 * math.pi})
    first, second, slope = MovingMachine(scene).fields(["first.moment", "second.moment", "B.x_phi"]).values()
    # A turn later is half of the 720 positions later, whichever way it turns.
    np.testing.assert_allclose(second, np.roll(first, 360), rtol=1e-9, atol=1e-9 * np.abs(first).max())
    power = range(5, 175) if speed > 0 else range(720 - 175, 720 - 5)
    exhaust = range(185, 355) if speed > 0 else range(720 - 355, 720 - 185)
    assert (first[power] * np.sign(speed) > 0).all()
    np.testing.assert_allclose(first[exhaust], -AREA * (ENGINE["exhaust"] - 101_325) * slope[exhaust], rtol=1e-9)


def test_pressure__acts_from_the_head_towards_the_other_end():
    pump = {"type": "pump", "ambient": 0.0, "suction": 0.0, "discharge": 1e5}
    scene = machine(SPEED, right=pump, left=pump | {"head": "low"})
    right, left, slope = MovingMachine(scene).fields(["right.moment", "left.moment", "B.x_phi"]).values()
    np.testing.assert_allclose(right, -1e5 * AREA * np.maximum(slope, 0), atol=1e-9)
    np.testing.assert_allclose(left, 1e5 * AREA * np.minimum(slope, 0), atol=1e-9)
