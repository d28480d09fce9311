"""Numbers come out in the unit that they went in."""

from pathlib import Path

import numpy as np
import pytest
from commands import done, said
from press_texts import PRESS

from engine import show_units

INCHES = (
    PRESS.replace('"0 mm"', '"0 in"')
    .replace("50 mm", "2 in")
    .replace("200 mm", "8 in")
    .replace("100 kg", "220 lb")
    .replace("100 kN", "20 kip")
)


@pytest.fixture
def inches(press_folder):
    Path("inches.toml").write_text(INCHES)
    yield "inches.toml"
    show_units({})


def test_result_of_a_scene_in_inches__is_shown_so_later_and_others_are_not(inches, press_folder):
    done("run", inches, "--no-plots", "--out", "r.h5")
    done("run", "press.toml", "--no-plots", "--out", "mm.h5")
    assert "mm" in said("show", "mm.h5").stdout
    units = said("show", "r.h5", "--columns", "ram.stroke").stdout
    assert " in\n" in units
    assert "mm" in said("show", "mm.h5", "--columns", "ram.stroke").stdout


def table_of(path: str) -> dict[str, list[str]]:
    header, *rows = (line.split(",") for line in Path(path).read_text(encoding="utf8").splitlines())
    return dict(zip(header, zip(*rows, strict=True), strict=True))


def test_tables__come_in_the_units_shown(inches, press_folder):
    Path("study.toml").write_text('scene = "inches.toml"\n[vary]\n"input.length" = "50 mm to 4 in, 2"\n')
    done("run", "study.toml", "--no-plots")
    Path("si.toml").write_text('units = "SI"\n' + Path("study.toml").read_text())
    done("run", "si.toml", "--no-plots")
    show_units({})
    done("export", "results/study.h5", "--to", "own.csv")
    done("export", "results/si.h5", "--to", "si.csv")
    si, own = table_of("si.csv"), table_of("own.csv")
    # In line, the stroke is twice the crank; one rounding of 1/0.0254, one of the product.
    assert [float(x) for x in own["ram.stroke [in]"]] == pytest.approx([100 / 25.4, 8.0], rel=1e-12)
    assert [float(x) for x in own["input.length [in]"]] == pytest.approx([50 / 25.4, 4.0], rel=4e-16)
    assert [float(x) for x in si["input.length [m]"]] == [0.05, 0.1016]
    assert own["ram.stroke_error [in]"] != si["ram.stroke_error [m]"]
    done("export", "inches.toml", "--to", "own.csv", "--columns", "B.y")
    place, height = (np.array(column, float) for column in table_of("own.csv").values())
    assert list(table_of("own.csv")) == ["phi [deg]", "B.y [in]"]
    assert height[place == 90.0] == pytest.approx(-6.0, rel=1e-12)
