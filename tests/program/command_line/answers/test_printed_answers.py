"""Bundled machines in metric and in US units, from the file to the report.

What is printed of each, read with its unit, is held to numbers that textbooks give in closed form.
"""

import math
import re
from pathlib import Path

import pytest
from commands import done
from each_case import each
from unit_scans import foreign, words_of_page

from engine import Scene, show_units
from sweeps import read_scene
from sweeps.study.bundled import STUDIES
from sweeps.text.templates import bundled_templates

IN, G = 0.0254, 9.80665
LBF = 0.45359237 * G
# Units of answers, by definition.
SI = {
    **{"mm": 1e-3, "m": 1.0, "in": IN, "ft": 12 * IN, "cm³": 1e-6, "in³": IN**3, "L": 1e-3, "mi": 5280 * 12 * IN},
    **{"rpm": math.pi / 30, "°": math.pi / 180, "s": 1.0, "": 1.0, "m/s": 1.0, "in/s": IN, "ft/s": 12 * IN},
    **{"m/s²": 1.0, "in/s²": IN, "ft/s²": 12 * IN, "m/s³": 1.0, "in/s³": IN, "ft/s³": 12 * IN},
    **{"N": 1.0, "kN": 1e3, "lbf": LBF, "N·m": 1.0, "lbf·ft": LBF * 12 * IN, "lbf·in": LBF * IN},
    **{"J": 1.0, "ft·lbf": LBF * 12 * IN, "W": 1.0, "kW": 1e3, "hp": 550 * LBF * 12 * IN},
}


def compressor(scene: Scene) -> dict[str, float]:
    """Polytropic compressor: η = 1 + c − c (p₂/p₁)^(1/n)."""
    air, crank = scene.cylinders["air"], scene.input
    swept, ratio, n = math.pi / 4 * air.bore**2 * 2 * crank.length, air.discharge / air.suction, air.n_expansion
    filled = 1.0 + air.clearance - air.clearance * ratio ** (1 / n)
    work = n / (n - 1) * air.suction * filled * swept * (ratio ** ((n - 1) / n) - 1.0)
    return {
        "piston.stroke": 2 * crank.length,
        "air.swept_volume": swept,
        "air.volumetric_efficiency": filled,
        "air.indicated_power": work * crank.speed / (2 * math.pi),
    }


def cam(scene: Scene) -> dict[str, float]:
    """Modified sine over β: peaks 4π/(π + 4) h ω/β, 4π²/(π + 4) h ω²/β² and 16π³/(π + 4) h ω³/β³."""
    cam, rise = scene.elements["cam"], scene.elements["cam"].sections["opening"]
    rate, lift, arm = cam.speed / rise.angle, rise.lift / (math.pi + 4), cam.base_radius + cam.follower.roller_radius
    return {
        "cam.greatest_velocity": 4 * math.pi * lift * rate,
        "cam.greatest_acceleration": 4 * math.pi**2 * lift * rate**2,
        "cam.greatest_jerk": 16 * math.pi**3 * lift * rate**3,
        # The contact is least loaded in the lower dwell; there the normal leans by the offset over the arm.
        "cam.least_contact_force": (cam.follower.load + cam.follower.preload)
        / math.sqrt(1 - (cam.follower.offset / arm) ** 2),
    }


def car(scene: Scene) -> dict[str, float]:
    """All wheels brake at the limit of friction: a = μ g, way v t + v²/(2 a)."""
    car = scene.elements["all"]
    deceleration = car.friction * G
    return {
        "all.deceleration": deceleration,
        "all.stopping_distance": car.speed * car.reaction_time + car.speed**2 / (2 * deceleration),
        "all.stopping_time": car.reaction_time + car.speed / deceleration,
    }


MACHINES = {
    "compressor": (STUDIES / "flywheels/scenes/compressor.toml", compressor),
    "cam": (bundled_templates()["cam"], cam),
    "braking_car": (STUDIES / "motion/scenes/braking_car.toml", car),
}


def printed(text: str, name: str) -> float:
    """A printed result in SI: the number and unit after "NAME →"."""
    found = re.search(rf"(?m)^ *{re.escape(name)} +→ +(\S+)(?: ± \S+)?(?: (\S+))?(?:  |$)", text)
    assert found, f"{name} isn't shown:\n{text}"
    return float(found[1]) * SI[found[2] or ""]


@pytest.fixture(params=["mm", "US"])
def system(request):
    yield request.param
    show_units({})


@each("name", MACHINES)
def test_machine__is_answered_from_its_file_to_its_report(name, system, folder):
    path, by_hand = MACHINES[name]
    Path(f"{name}.toml").write_text(f'units = "{system}"\n{path.read_text("utf8")}', "utf8")
    scene, result = read_scene(Path(f"{name}.toml")), f"results/{name}.h5"
    expected = by_hand(scene)
    texts = {"check": done("check", f"{name}.toml"), "run": done("run", f"{name}.toml", "--no-plots")}
    texts["show"] = done("show", result, "--columns", ",".join(expected), "--all")
    assert {n: printed(texts["show"], n) for n in expected} == pytest.approx(expected, rel=2e-4)
    # A report draws all pictures: of elements alone, as one of a mechanism has a test of its own.
    if system == "US" and scene.input is None:
        done("report", result, "--out", "page.html")
        texts["report"] = words_of_page(Path("page.html"))
        assert scene.title in texts["report"]
    # A title may hold any unit.
    untitled = {command: text.replace(scene.title, "") for command, text in texts.items()}
    assert {command: found for command, text in untitled.items() if (found := foreign(text, system))} == {}
