"""Whatever is written about a machine is in one system of units, that of its numbers."""

import re
from pathlib import Path

import matplotlib.figure
import numpy as np
import pytest
from commands import done, refused, said
from matplotlib.text import Text
from press_texts import PRESS, PRESS_WITH_FLYWHEEL
from unit_scans import BANNED, foreign, units_of, words_of_page

from engine import quantity_text, show_units, show_units_of
from sweeps.pictures.plans.files import plan_pictures
from sweeps.text.scene_text import read_scene

# A press in the units that a designer in Ohio types; hardly any of its quantities is named in them.
OHIO = {"0 mm": "0 in", "50 mm": "2 in", "200 mm": "10 in", "60 rpm": "60 RPM", "100 kg": "220 lb", "100 kN": "20 kip"}
MACHINE = f"""\
gravity = "386.09 in/s2"
{PRESS_WITH_FLYWHEEL}
[bodies.rod]
link = "rod"
mass = "40 lbs"
x = "3 in"
inertia = "400 lb-in2"
"""
for metric, american in OHIO.items():
    MACHINE = MACHINE.replace(f'"{metric}"', f'"{american}"')
STUDY = """\
scene = "press.toml"
[vary]
"input.length" = "2 in to 3 in, 3"
[outputs]
summaries = ["ram.stroke", "flywheel_wittenbauer", "excess_work", "required_power", "input_moment.peak", "B.ay.peak"]
fields = ["reduced_inertia_phi"]
[best]
minimise = "excess_work"
"""


@pytest.mark.parametrize(
    ("shown", "system"),
    [("torque, kN·m", "US"), ("x [m s-2]", "US"), ("3.1 kg", "US"), ("9 lbf/in", "mm"), ("2 hp", "SI"), ("5 kJ", "SI")],
)
def test_pattern__finds_units_of_another_system(shown, system):
    assert units_of(BANNED[system]).search(shown)


@pytest.fixture
def press(folder, request):
    Path("press.toml").write_text(MACHINE if request.param == "US" else f'units = "{request.param}"\n{MACHINE}')
    Path("study.toml").write_text(STUDY)
    yield request.param
    show_units({})


@pytest.fixture
def written(monkeypatch):
    """Texts of all figures that are saved."""
    found: list[str] = []
    save = matplotlib.figure.Figure.savefig

    def saved(self, *arguments, **options):
        save(self, *arguments, **options)
        found.extend(text.get_text() for text in self.findobj(Text) if text.get_text())

    monkeypatch.setattr(matplotlib.figure.Figure, "savefig", saved)
    return found


@pytest.mark.parametrize("press", ["US"], indirect=True)
def test_everything_about_a_machine__is_in_its_units(press, written):
    texts = {
        "run": done("run", "study.toml"),
        # Name, symbol, unit and meaning; symbols are letters too.
        "quantities": re.sub(r"(?m)^(  \S+ +)\S+", r"\1", done("quantities", "press.toml")),
        "show": done("show", "results/study.h5"),
        "at": done("show", "press.toml", "--at", "20,100"),
        "machine": done("run", "press.toml", "--no-plots"),
    }
    done("plot", "press.toml", "--out", "press.svg")
    done("report", "results/study.h5", "--out", "page.html")
    done("export", "results/study.h5", "--to", "study.csv", "--columns", "excess_work,reduced_inertia_phi")
    done("export", "press.toml", "--to", "press.csv")
    texts["page"] = words_of_page(Path("page.html"))
    texts["tables"] = "\n".join(Path(t).read_text().partition("\n")[0] for t in ("study.csv", "press.csv")).replace(
        ",", "\n"
    )
    texts["pictures"] = "\n".join(written)
    assert len(written) > 20
    assert {name: found for name, text in texts.items() if (found := foreign(text, press))} == {}


@pytest.mark.parametrize("press", ["US"], indirect=True)
def test_numbers_in_american_units__are_those_of_the_machine(press):
    shown = done("run", "press.toml", "--no-plots")
    # In line, the stroke is twice the crank; the punch does 4 in · 20 kip a second; a horsepower is 550 · 12 lbf·in/s.
    assert re.search(r"ram\.stroke\s*→\s*4 .*in\b", shown)
    power = re.search(r"required_power\s*→\s*([\d.]+).* hp", shown)
    assert float(power[1]) == pytest.approx(80_000 / 6600, rel=1e-4)


@pytest.mark.parametrize("press", ["US"], indirect=True)
def test_plan__is_in_american_units(press, written):
    scene = read_scene(Path("press.toml"))
    plan_pictures(scene, Path("plan.svg"))
    assert any("lbf" in text for text in written)
    assert foreign("\n".join(written), "US") == []


def test_system__is_that_of_most_texts_or_the_one_named():
    assert show_units_of({"a": "3 in", "b": {"c": ["1 lbf", "2 lbf"]}, "d": "30 deg", "e": "1 m"}) == "US"
    assert show_units_of({"a": "3 in", "b": "2 mm", "c": "2 kg"}) == "mm"
    assert show_units_of({"units": "SI", "a": "3 in"}) == "SI"
    assert quantity_text(0.05, "m") == "0.05 m"
    # A unit of the scene's own is kept, and so are those made of it.
    assert show_units_of({"a": "3 ft", "b": "2 ft-lb"}) == "US"
    assert [quantity_text(0.3048, unit) for unit in ("m", "m s-1")] == ["1 ft", "1 ft/s"]
    assert quantity_text(1.3558179483314004, "N m") == "1 ft·lbf"
    show_units({})


@pytest.mark.parametrize("press", ["US"], indirect=True)
def test_number_with_a_comma__is_refused_as_ambiguous(press):
    Path("press.toml").write_text(MACHINE.replace('"20 kip"', '"120,000 lbf"'))
    assert "forces.punch.force: '120,000 lbf' is ambiguous: 120000 or 120.000?" in refused("run", "press.toml")
    Path("press.toml").write_text(MACHINE.replace('"20 kip"', "120,000"))
    assert "ambiguous: 120000 or 120.000?" in refused("run", "press.toml")
    Path("press.toml").write_text(MACHINE.replace('"20 kip"', '"60 ton"'))
    assert "2000 lb" in refused("run", "press.toml")


@pytest.mark.parametrize("press", ["US"], indirect=True)
def test_system_that_there_is_not__is_refused_with_those_there_are(press):
    Path("press.toml").write_text('units = "imperial"\n' + MACHINE)
    assert "allowed: mm, SI, US" in said("check", "press.toml").output


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
