"""Whatever is written about a machine is in one system of units, that of its numbers."""

import re
import shutil
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from commands import done, said
from matplotlib.text import Text
from press_texts import PRESS_WITH_FLYWHEEL
from unit_scans import BANNED, foreign, units_of, words_of_page

from engine import display_unit, made_ready, quantity_text, show_units, show_units_of
from sweeps import read_study
from sweeps.pictures.plans.files import plan_pictures
from sweeps.study.bundled import STUDIES, bundled_studies
from sweeps.text.scene_text import read_scene
from sweeps.text.templates import bundled_templates

# A press in the units that a designer in Ohio types; hardly any of its quantities is named in them.
OHIO = {"0 mm": "0 in", "50 mm": "2 in", "200 mm": "8 in", "60 rpm": "60 RPM", "100 kg": "220 lb", "100 kN": "20 kip"}
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
scene = "inches.toml"
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
def inches(press_folder):
    Path("inches.toml").write_text(MACHINE)
    yield "inches.toml"
    show_units({})


@pytest.fixture
def written(monkeypatch):
    """Texts of all figures that are saved; they are laid out, but not drawn."""
    found: list[str] = []

    def saved(figure, file, **_):
        figure.draw_without_rendering()
        found.extend(text.get_text() for text in figure.findobj(Text) if text.get_text())
        file.write(b"<svg/>")

    monkeypatch.setattr("sweeps.pictures.style._lettered", lambda figure: None)
    monkeypatch.setattr("sweeps.pictures.style.Sheet.savefig", saved)
    return found


def test_everything_about_a_machine__is_in_its_units(inches, written):
    Path("study.toml").write_text(STUDY)
    texts = {
        "run": done("run", "study.toml", "--no-plots"),
        # Name, symbol, unit and meaning; symbols are letters too.
        "quantities": re.sub(r"(?m)^(  \S+ +)\S+", r"\1", done("quantities", inches)),
        "show": done("show", "results/study.h5"),
        "at": done("show", inches, "--at", "20,100"),
        "machine": done("run", inches, "--no-plots"),
    }
    done("plot", inches, "--out", "machine.svg")
    done("report", "results/study.h5", "--out", "page.html")
    done("export", "results/study.h5", "--to", "study.csv", "--columns", "excess_work,reduced_inertia_phi")
    done("export", inches, "--to", "machine.csv")
    texts["page"] = words_of_page(Path("page.html"))
    heads = [Path(name).read_text().partition("\n")[0] for name in ("study.csv", "machine.csv")]
    texts["tables"] = ",".join(heads).replace(",", "\n")
    plan_pictures(read_scene(inches), Path("plan.svg"))
    texts["pictures"] = "\n".join(written)
    assert len(written) > 20
    assert any("lbf" in text for text in written)
    assert {name: found for name, text in texts.items() if (found := foreign(text, "US"))} == {}

    shown = texts["machine"]
    # In line, the stroke is twice the crank; the punch does 4 in · 20 kip a second; a horsepower is 550 · 12 lbf·in/s.
    assert re.search(r"ram\.stroke\s*→\s*4 .*in\b", shown)
    power = re.search(r"required_power\s*→\s*([\d.]+).* hp", shown)
    assert float(power[1]) == pytest.approx(80_000 / 6600, rel=1e-4)


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


# Everything bundled, shown in units that none of it is typed in, and sizes of its quantities in every system


BUNDLED = {**bundled_templates(), **bundled_studies()}
SYSTEMS = ("mm", "US", "SI")
# Sizes of numbers that machines have, in SI units.
SIZES = 3.0 * 10.0 ** np.arange(-9, 10)


@cache
def si_units_of(name: str) -> frozenset[str]:
    """SI units of all summaries and fields of a bundled scene."""
    machine = made_ready(read_study(BUNDLED[name]).scene)
    known = {**machine.available_summaries, **getattr(machine, "available_fields", {})}
    return frozenset(quantity.units for quantity in known.values())


# Templates, and studies of elements that no template has.
SHOWN = [*bundled_templates(), "braking_car", "screw_jack", "locomotive", "valve_train"]


@pytest.mark.parametrize("name", SHOWN)
def test_bundled__is_shown_in_us_units(name, folder):
    path = Path("machine.toml")
    if STUDIES in BUNDLED[name].parents:
        shutil.copytree(STUDIES, "studies")
        path = "studies" / BUNDLED[name].relative_to(STUDIES)
    path.write_text(f'units = "US"\n{BUNDLED[name].read_text("utf8")}', "utf8")
    # Name, symbol, unit and meaning; symbols are letters too.
    texts = [re.sub(r"(?m)^(  \S+ +)\S+", r"\1", done("quantities", str(path)))]
    study = read_study(path)
    # Of a mechanism numbers are shown in units of the quantities that are listed.
    text = "" if study.scene.input else done("check", str(path), "--all")
    texts += [line for line in text.splitlines() if line.strip() not in (study.title, study.question)]
    show_units({})
    assert [line for text in texts for line in foreign(text, "US")] == []


@pytest.mark.parametrize("system", SYSTEMS)
def test_number_of_any_size__is_in_one_unit_of_its_system_apart_from_metric_prefixes(system):
    wrong, known = [], frozenset.union(*map(si_units_of, BUNDLED))
    show_units({"system": system})
    for units in sorted(known):
        wrong += foreign("\n".join(quantity_text(float(size), units) for size in SIZES), system)
        labels = {display_unit(units, np.array([size]))[1] for size in SIZES}
        # Many turns are revolutions; kN for N, L for cm³.
        if system != "mm" and units != "rad":
            wrong += [units] if len(labels) > 1 else []
    show_units({})
    assert wrong == []
