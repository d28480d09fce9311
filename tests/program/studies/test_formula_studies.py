"""Studies of loads by formula: their numbers vary, are derived, and results are differentiated by them."""

import math

import numpy as np
import pytest
from press_texts import slider_crank_text

from sweeps import InputError, read, read_study, run_study

SCENE = f"""
{slider_crank_text(speed="300 rpm")}
[forces.buffer]
type = "formula"
on = "B"
angle = "0 deg"
force = "-k * (ram.slide - x0) - c * (ram.slide - x0)^3 if ram.slide > x0 and v > 0 else 0"
numbers = {{ k = "8 N/mm", x0 = "240 mm", c = "2 N/mm3" }}

[moments.fan]
type = "formula"
on = "crank"
moment = "-m * omega^2"
numbers.m = "3e-3 N m s2"
"""
STUDY = """
question = "How far out, how stiff?"
scene = "machine.toml"

[vary]
"forces.buffer.numbers.x0" = { from = "200 mm", to = "240 mm", count = 3 }
"forces.buffer.numbers.c" = { values = ["1 N/mm3", "5 kN/cm3"] }

[derive]
"forces.buffer.numbers.k" = "8 N/mm if forces.buffer.numbers.x0 > 210 mm else 3 N/mm"

[outputs]
summaries = ["buffer.moment.mean", "required_power"]
derivatives = ["buffer.moment.mean by forces.buffer.numbers.x0", "required_power by moments.fan.numbers.m"]
"""
HIGH, SPEED = 0.25, 10 * math.pi


def test_study__varies_derives_and_differentiates_by_numbers_of_formulas(tmp_path):
    (tmp_path / "machine.toml").write_text(SCENE, encoding="utf8")
    (tmp_path / "study.toml").write_text(STUDY, encoding="utf8")
    run_study(read_study(tmp_path / "study.toml"), tmp_path / "study.h5")
    data = read(tmp_path / "study.h5")
    x0, k, c = (data[f"forces.buffer.numbers.{name}"].values for name in ("x0", "k", "c"))
    np.testing.assert_allclose(x0, np.repeat([0.2, 0.22, 0.24], 2), rtol=1e-15)
    np.testing.assert_allclose(k, np.repeat([3e3, 8e3, 8e3], 2), rtol=1e-15)
    np.testing.assert_allclose(c, np.tile([1e9, 5e9], 3), rtol=1e-15)
    assert data["forces.buffer.numbers.c"].attrs["units"] == "kg m-2 s-2"
    depth = HIGH - x0
    mean = -(k * depth**2 / 2 + c * depth**4 / 4) / (2 * math.pi)
    np.testing.assert_allclose(data["buffer.moment.mean"].values, mean, rtol=1e-11)
    np.testing.assert_allclose(data["required_power"].values, -(mean - 3e-3 * SPEED**2) * SPEED, rtol=1e-11)
    by_place = data["buffer.moment.mean.by.forces.buffer.numbers.x0"].values
    figure = data["buffer.moment.mean.by.forces.buffer.numbers.x0_error"].values
    # Along the study, what is derived from the place moves with it: not here, but where the condition turns over.
    slope = (k * depth + c * depth**3) / (2 * math.pi)
    assert (np.abs(by_place - slope) <= figure + 1e-9 * slope).all()
    by_fan = data["required_power.by.moments.fan.numbers.m"].values
    np.testing.assert_allclose(by_fan, SPEED**3, rtol=1e-9)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('to = "240 mm"', 'to = "240 N"'), "expected a length such as '80 mm', got 'N'"),
        (('["1 N/mm3", "5 kN/cm3"]', '["1 N/mm3", "5 kN/cm2"]'), "expected a quantity in kg m-2 s-2"),
        (
            ("numbers.c", "numbers.cc"),
            "numbers.cc: is not a number that the scene gives; did you mean",
        ),
        (('"8 N/mm if', '"8 N if'), "gives a force or a stiffness"),
    ],
)
def test_wrong_value_of_a_number__is_answered(tmp_path, change, words):
    (tmp_path / "machine.toml").write_text(SCENE, encoding="utf8")
    (tmp_path / "study.toml").write_text(STUDY.replace(*change), encoding="utf8")
    with pytest.raises(InputError, match=words.replace("(", r"\(")):
        read_study(tmp_path / "study.toml")
