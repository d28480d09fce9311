"""`sweeps flywheel`: from a table of moments, and from the areas of a diagram."""

import math
import re
from pathlib import Path

import pytest
from commands import refused, said

# Khurmi, 16.16: 1 mm² is 250 N·m times 3°; printed 32.7 kg·m².
AREAS = "area [mm2]\n160\n-172\n168\n-191\n197\n-162\n"
ASKED = ("--speed", "600 rpm", "--fluctuation", "2 %")


@pytest.fixture(autouse=True)
def folder(folder):
    Path("areas.csv").write_text(AREAS)
    Path("moments.csv").write_text("phi [deg], moment [N m]\n0, 100\n180, 100\n180, -100\n360, -100\n360, 100\n")
    return folder


def inertia_in(answer: str) -> float:
    return float(re.search(r"flywheel inertia\s+([\d.]+) kg·m²", answer)[1])


def test_areas__give_the_printed_flywheel():
    answer = said("flywheel", "areas.csv", *ASKED, "--area-energy", f"{250 * math.radians(3)!r} J").stdout
    assert inertia_in(answer) == pytest.approx(32.7, abs=0.05)
    # The sums are 160, -12, 156, -35, 162, 0.
    assert re.search(r"fastest after\s+5 areas", answer)
    assert re.search(r"slowest after\s+4 areas", answer)
    assert "mean moment" not in answer


def test_inertia_that_is_there__is_taken_off():
    # Half a turn at 100 N·m: 100 π J = I δ ω².
    asked = 100 * math.pi / (0.02 * (20 * math.pi) ** 2)
    assert inertia_in(said("flywheel", "moments.csv", *ASKED).stdout) == pytest.approx(asked, rel=1e-4)
    scale = ("--area-energy", f"{250 * math.radians(3)!r} J", "--inertia", "2.7 kg m2")
    assert inertia_in(said("flywheel", "areas.csv", *ASKED, *scale).stdout) == pytest.approx(30.0, abs=0.05)
    less = said("flywheel", "moments.csv", *ASKED, "--inertia", "1.5 kg m2").stdout
    assert inertia_in(less) == pytest.approx(asked - 1.5, rel=1e-4)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["areas.csv"], "no column 'phi': the header must be 'phi [deg], moment [N m]', it has area"),
        (["moments.csv", "--area-energy", "3 J"], "no column 'area': the header must be 'area [mm2]'"),
        (["areas.csv", "--area-energy", "3"], "--area-energy: 3 has no unit"),
        (["areas.csv", "--area-energy", "0 J"], "give the energy of a unit of area, above 0"),
        (["moments.csv", "--inertia", "3 kg"], "expected an inertia"),
    ],
)
def test_flywheel_that_cannot_be_sized__is_refused(arguments, words):
    assert words in refused("flywheel", *arguments, *ASKED)
