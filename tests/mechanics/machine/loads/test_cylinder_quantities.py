"""Cylinders: indicated work against the closed forms of ideal diagrams, swept volume, delivery."""

import math

import machines
import pytest

from engine import Machine, Scene

CRANK, ROD, BORE, SPEED = 0.04, 0.15, 0.08, 50.0
AREA = math.pi / 4 * BORE**2
SWEPT = 2 * CRANK * AREA
COMMON = "swept_volume indicated_work indicated_power volume.min volume.max pressure.min pressure.max"


def machine(revolutions: int = 1, speed: float = SPEED, head: str = "high", **cylinder: object) -> dict:
    """A slider-crank with a cylinder."""
    scene = machines.slider_crank(CRANK, ROD, speed, "drive")
    scene["input"]["revolutions"] = revolutions
    return scene | {"cylinders": {"gas": {"piston": "ram", "bore": BORE, "head": head, **cylinder}}}


def ask(scene: dict, names: str) -> dict[str, float]:
    asked = [f"gas.{name}" for name in names.split()]
    outcome = Machine(Scene.model_validate(scene), asked).evaluate({})
    found = {name.removeprefix("gas."): float(outcome.summaries[name][0]) for name in asked}
    for name in asked:
        assert outcome.errors[name][0] <= 1e-9 * abs(outcome.summaries[name][0]) + 1e-12, name
    return found


def polytropic(p: float, v: float, w: float, n: float) -> float:
    """∫ p dV from a volume v at pressure p to a volume w."""
    return p * v / (n - 1.0) * (1.0 - (v / w) ** (n - 1.0))


@pytest.mark.parametrize("speed", [SPEED, -SPEED])
@pytest.mark.parametrize("head", ["high", "low"])
def test_compressor__takes_the_work_of_its_diagram_and_delivers_what_it_draws_in(speed, head):
    c, suction, discharge, n, m = 0.06, 1e5, 6e5, 1.35, 1.25
    given = {"clearance": c, "suction": suction, "discharge": discharge, "n_compression": n, "n_expansion": m}
    found = ask(
        machine(1, speed, head, type="compressor", **given),
        f"{COMMON} mean_effective_pressure delivery volumetric_efficiency",
    )
    efficiency = 1.0 + c - c * (discharge / suction) ** (1.0 / m)
    assert found["volumetric_efficiency"] == pytest.approx(efficiency, rel=1e-12)
    assert found["delivery"] == pytest.approx(efficiency * SWEPT * SPEED / (2 * math.pi), rel=1e-12)
    least, most = c * SWEPT, (1 + c) * SWEPT
    opens = most * (suction / discharge) ** (1.0 / n)
    fills = least * (discharge / suction) ** (1.0 / m)
    expands = polytropic(discharge, least, fills, m) + suction * (most - fills)
    compresses = polytropic(suction, most, opens, n) - discharge * (opens - least)
    assert found["indicated_work"] == pytest.approx(-(expands + compresses), rel=1e-12)
    assert found["indicated_power"] == pytest.approx(-(expands + compresses) * SPEED / (2 * math.pi), rel=1e-12)
    assert found["mean_effective_pressure"] == pytest.approx(-(expands + compresses) / SWEPT, rel=1e-12)
    assert found["swept_volume"] == pytest.approx(SWEPT, rel=1e-12)
    assert (found["volume.min"], found["volume.max"]) == pytest.approx((least, most), rel=1e-12)
    assert (found["pressure.min"], found["pressure.max"]) == pytest.approx((suction, discharge), rel=1e-12)


def test_pump__lifts_its_swept_volume_from_suction_to_discharge():
    found = ask(machine(type="pump", suction=0.8e5, discharge=9e5), f"{COMMON} delivery")
    assert found["indicated_work"] == pytest.approx(8.2e5 * SWEPT, rel=1e-12)
    assert found["delivery"] == pytest.approx(SWEPT * SPEED / (2 * math.pi), rel=1e-12)


def test_four_stroke__does_the_work_of_two_polytropes_less_that_of_pumping_once_in_two_turns():
    c, intake, exhaust, peak, n, m = 0.12, 0.95e5, 1.05e5, 45e5, 1.32, 1.28
    given = {"clearance": c, "intake": intake, "exhaust": exhaust, "peak": peak}
    found = ask(machine(2, type="four_stroke", **given), f"{COMMON} mean_effective_pressure")
    least, most = c * SWEPT, (1 + c) * SWEPT
    work = polytropic(peak, least, most, m) + polytropic(intake, most, least, n) + (intake - exhaust) * SWEPT
    assert found["indicated_work"] == pytest.approx(work, rel=1e-12)
    assert found["indicated_power"] == pytest.approx(work * SPEED / (4 * math.pi), rel=1e-12)
    assert found["mean_effective_pressure"] == pytest.approx(work / SWEPT, rel=1e-12)
