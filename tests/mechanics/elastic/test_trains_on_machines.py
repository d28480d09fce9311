"""Trains that the scene's own machine excites: against harmonics of its kept curves, and the rigid limit."""

import math

import numpy as np
import pytest
from each_case import refusals
from element_samples import element
from machines import slider_crank
from train_samples import matrices

from engine import Machine, Scene, Verdict
from sweeps.pictures.elements.train_sheet import numbers_of_machine, train_sheet, train_table

TRAIN = {
    "type": "torsional_train",
    "masses": {"motor": {"inertia": 0.2, "damping": 0.02}, "crank_end": {"inertia": 0.05}},
    "shafts": {"shaft": {"between": ["motor", "crank_end"], "stiffness": 800.0, "damping": 0.3}},
    "machine_at": "crank_end",
    "load": "motor",
}


def scene(train=TRAIN, drive=None, **parts) -> Scene:
    parts = {
        "bodies": {"piston_body": {"link": "piston", "mass": 8.0}},
        "forces": {"load": {"type": "linear_drag", "on": "B", "coefficient": 200.0}},
        "elements": {"train": train},
    } | parts
    machine = slider_crank(speed=20.0, slider="piston", **parts)
    return Scene.model_validate(machine | {"input": machine["input"] | (drive or {})})


def excited(made: Scene, speed: float, revolutions: int = 1):
    """Alternating and mean moment of the shaft, by the transform of the kept input moment and the dense matrices."""
    machine = Machine(made, [], ["input_moment"], ["input.speed"])
    rows = machine.evaluate({"input.speed": np.array([speed])}).fields["input_moment"][0]
    harmonics = np.fft.rfft(-rows) * 2 / rows.size
    swing, phi = 0.0, np.linspace(0, math.tau * revolutions, 100_001)
    for k in range(1, 13):
        w = k / revolutions * abs(speed)
        amplitude = harmonics[k] if speed > 0 else harmonics[k].conj()
        _, _, dynamic, basis = matrices(TRAIN, w)
        angles = basis @ np.linalg.solve(dynamic, basis.T @ np.array([0.0, amplitude]))
        moment = (800.0 + 1j * w * 0.3) * (angles[0] - angles[1])
        swing = swing + (moment * np.exp(1j * k / revolutions * phi)).real
    return np.ptp(swing) / 2, -harmonics[0].real / 2


@pytest.mark.parametrize("speed", [20.0, -20.0, 45.0])
def test_shaft_moment__is_that_of_the_transformed_curves(speed):
    made = scene()
    names = ["train.shaft.alternating_moment", "train.shaft.mean_moment", "input_moment.order_2"]
    outcome = Machine(made, names, varied=["input.speed"]).evaluate({"input.speed": np.array([speed])})
    assert outcome.status[0] == Verdict.OK
    alternating, mean = excited(made, speed)
    # 720 positions of a smooth curve leave rounding, 100 000 samples of 12 waves 4e-8.
    assert outcome.summaries[names[0]][0] == pytest.approx(alternating, rel=1e-7)
    assert outcome.summaries[names[1]][0] == pytest.approx(mean, abs=1e-9)
    assert outcome.errors[names[0]][0] < 1e-6 * alternating


def test_cycle_of_two_revolutions__has_half_orders():
    made = scene(drive={"revolutions": 2})
    names = ["train.shaft.alternating_moment", "input_moment.order_0_5", "input_moment.order_1"]
    found = Machine(made, names).evaluate({}).summaries
    assert found[names[0]][0] == pytest.approx(excited(made, 20.0, 2)[0], rel=1e-7)
    # Both revolutions are the same.
    assert found[names[1]][0] < 1e-10 * found[names[2]][0]


def test_mass_without_inertia__has_the_mean_of_the_machine_and_its_flywheel():
    masses = TRAIN["masses"] | {"crank_end": {}}
    machine = {"flywheel": {"inertia": 0.3, "speed_fluctuation": 0.1}}
    filled = scene(TRAIN | {"masses": masses}, **machine)
    mean = Machine(filled, ["reduced_inertia.mean"]).evaluate({}).summaries["reduced_inertia.mean"][0]
    given = scene(TRAIN | {"masses": masses | {"crank_end": {"inertia": mean + 0.3}}}, **machine)
    names = ["train.frequency_1", "train.shaft.alternating_moment"]
    outcome, expected = (Machine(made, names).evaluate({}) for made in (filled, given))
    for name in names:
        assert outcome.summaries[name][0] == pytest.approx(expected.summaries[name][0], rel=1e-12), name
        assert outcome.errors[name][0] < 1e-9 * outcome.summaries[name][0]
    two = math.sqrt(800.0 * (1 / 0.2 + 1 / (mean + 0.3)))
    assert outcome.summaries[names[0]][0] == pytest.approx(two, rel=1e-12)
    text = train_table(filled.elements["train"], numbers_of_machine(filled, "train"))
    assert f"{mean + 0.3:.5g}" in text


def test_sheet__is_drawn_with_the_machines_orders():
    figure = train_sheet(scene(), "train")
    assert len(figure.axes) == 3
    curve = next(line for line in figure.axes[2].get_lines() if line.get_label() == "shaft")
    assert np.isfinite(curve.get_ydata()).all()


test_train_on_a_machine_that_cannot_be__says_what_to_mend = refusals(
    lambda change, drive: scene(TRAIN | change, drive),
    ({"machine_at": "x"}, None, "there is no mass 'x'"),
    ({"masses": {"motor": {}, "crank_end": {}}}, None, "motor.inertia is missing; only the mass that is machine_at"),
    ({"speed": 3.0}, None, "leave all but one out"),
    ({}, {"start": 0.1, "stop": 1.0}, "only a crank that turns fully"),
)


test_train_on_a_machine_without_a_mechanism__is_refused = refusals(element, (TRAIN, "only a crank that turns fully"))


def test_elements_of_a_machine_that_cannot_be_assembled__have_no_numbers():
    drive = {"type": "machine_drive", "stiffness": 400.0, "damping": 0.4, "motor_inertia": 0.2}
    motor = {"type": "dc_motor", "on": "crank", "stall_moment": 100.0, "no_load_speed": 22.0}
    wheel = {"geared_to": "crank", "ratio": 1.0, "inertia": 0.5}
    made = scene(elements={"train": TRAIN, "drive": drive}, moments={"motor": motor}, shafts={"wheel": wheel})
    names = ["train.frequency_1", "drive.stiffness", "drive.greatest_moment"]
    lengths = {"input.length": np.array([1.0, 100.0]) * made.input.length}
    outcome = Machine(made, names, varied=["input.length"]).evaluate(lengths)
    assert list(outcome.status) == [Verdict.OK, Verdict.CANNOT_ASSEMBLE]
    for name in names:
        assert outcome.summaries[name][0] > 0.0
        assert np.isnan([outcome.summaries[name][1], outcome.errors[name][1]]).all(), name
