"""Seven machines as their users type them, in metric and in US units, from the file to the report.

Each is held to two or three numbers that textbooks give in closed form, read from what is printed.
"""

import math
import re
from collections.abc import Callable
from pathlib import Path
from string import Template
from typing import NamedTuple

import pytest
from commands import done
from unit_scans import foreign, words_of_page

from engine import show_units

IN, LB, G = 0.0254, 0.45359237, 9.80665
LBF = LB * G
# Units of texts and answers, by definition.
SI = {
    **{"mm": 1e-3, "m": 1.0, "in": IN, "ft": 12 * IN, "cm³": 1e-6, "in³": IN**3},
    **{"rpm": math.pi / 30, "°": math.pi / 180, "s": 1.0},
    **{"kg": 1.0, "lb": LB, "kg m2": 1.0, "lb-in2": LB * IN**2, "lb-ft2": LB * (12 * IN) ** 2},
    **{"N": 1.0, "kN": 1e3, "lbf": LBF, "tonf": 2000 * LBF},
    **{"N m": 1.0, "N·m": 1.0, "kN·m": 1e3, "lbf-ft": LBF * 12 * IN, "lbf·ft": LBF * 12 * IN, "lbf·in": LBF * IN},
    **{"J": 1.0, "kJ": 1e3, "ft·lbf": LBF * 12 * IN, "W": 1.0, "kW": 1e3, "hp": 550 * LBF * 12 * IN},
    **{"kPa": 1e3, "GPa": 1e9, "psi": LBF / IN**2, "m/s": 1.0, "in/s": IN, "ft/s": 12 * IN},
    **{"m/s²": 1.0, "in/s²": IN, "ft/s²": 12 * IN, "m/s³": 1.0, "mm/s³": 1e-3, "in/s³": IN, "ft/s³": 12 * IN},
    **{"": 1.0, "N/mm": 1e3, "lbf/in": LBF / IN},
}


class Typed(NamedTuple):
    """A machine: its text, its numbers in metric and in US units, and what they make by hand, in SI."""

    text: str
    numbers: dict[str, tuple[str, str]]
    by_hand: Callable[..., dict[str, float]]


SLIDER_CRANK = """
[points]
O = { x = "$zero", y = "$zero" }

[guides]
way = { angle = "90 deg" }

[input]
type = "crank"
pivot = "O"
pin = "A"
length = "$crank"
speed = "$speed"

[groups.drive]
type = "RRP"
inner = "B"
first = { link = "rod", joint = "A", length = "$rod" }
second = { link = "slider", guide = "way" }

[bodies]
rod = { link = "rod", mass = "$rod_mass", x = "$centre", inertia = "$inertia" }
slider = { link = "slider", mass = "$mass" }
"""


def compressor(crank: float, bore: float, speed: float, suction: float, discharge: float, **_: float) -> dict:
    """Polytropic compressor with 5 % clearance, n = 1.3: η = 1 + c − c (p₂/p₁)^(1/n)."""
    swept, ratio = math.pi / 4 * bore**2 * 2 * crank, discharge / suction
    filled = 1.0 + 0.05 - 0.05 * ratio ** (1 / 1.3)
    work = 1.3 / 0.3 * suction * filled * swept * (ratio ** (0.3 / 1.3) - 1.0)
    return {
        "slider.stroke": 2 * crank,
        "air.swept_volume": swept,
        "air.volumetric_efficiency": filled,
        "air.indicated_power": work * speed / (2 * math.pi),
    }


COMPRESSOR = Typed(
    f"""\
title = "Air compressor"
{SLIDER_CRANK}
[cylinders.air]
type = "compressor"
piston = "slider"
bore = "$bore"
head = "high"
clearance = "5 %"
suction = "$suction"
discharge = "$discharge"
n_compression = 1.3
n_expansion = 1.3
ambient = "$suction"

[flywheel]
speed_fluctuation = "1/50"
""",
    {
        "zero": ("0 mm", "0 in"),
        "crank": ("40 mm", "1.5 in"),
        "rod": ("160 mm", "6 in"),
        "speed": ("960 rpm", "900 rpm"),
        "rod_mass": ("1.2 kg", "3 lb"),
        "centre": ("50 mm", "2 in"),
        "inertia": ("0.004 kg m2", "12 lb-in2"),
        "mass": ("0.8 kg", "2 lb"),
        "bore": ("80 mm", "3 in"),
        "suction": ("100 kPa", "14.7 psi"),
        "discharge": ("800 kPa", "117.6 psi"),
    },
    compressor,
)


def press(crank: float, rod: float, speed: float, thickness: float, force: float, **_: float) -> dict:
    """Blanking: the work F t of a stroke; above the bottom by t, cos φ = (b² + r² − l²)/(2 r b) with b = l + r − t."""
    work, low = force * thickness, rod + crank - thickness
    turned = math.acos((low**2 + crank**2 - rod**2) / (2 * crank * low))
    leaning, mean = math.asin(crank * math.sin(turned) / rod), work / (2 * math.pi)
    return {
        "slider.stroke": 2 * crank,
        "required_drive_moment": mean,
        "required_power": mean * speed,
        # Where the punch meets the plate, its force holds the ram's inertia forces to a fraction of a per mille.
        "input_moment.peak": force * crank * math.sin(turned + leaning) / math.cos(leaning),
        # The flywheel gives what the motor doesn't over the angle of the cut, but for the last of it: near the dead
        # centre, x = r (1 + r/l) φ²/2, the motor is stronger than the plate, by M²/(2 F r (1 + r/l)) in all.
        "excess_work": work - mean * turned + mean**2 / (2 * force * crank * (1 + crank / rod)),
    }


PRESS = Typed(
    f"""\
title = "Blanking press"
{SLIDER_CRANK.replace("90 deg", "-90 deg")}
[forces.blanking]
type = "table"
on = "B"
angle = "90 deg"
slider = "slider"
measured_from = "high end"
over_stroke = ["$zero", "$thickness"]
force = ["$force", "$force"]
interpolation = "linear"
outside = "zero"
acts = "against"
role = "useful"

[flywheel]
speed_fluctuation = "1/10"
""",
    {
        "zero": ("0 mm", "0 in"),
        "crank": ("50 mm", "2 in"),
        "rod": ("300 mm", "12 in"),
        "speed": ("50 rpm", "60 rpm"),
        # So light that their inertia is below the digits compared.
        "rod_mass": ("1 kg", "2 lb"),
        "centre": ("100 mm", "4 in"),
        "inertia": ("0.01 kg m2", "30 lb-in2"),
        "mass": ("2 kg", "4 lb"),
        "thickness": ("6 mm", "0.25 in"),
        "force": ("250 kN", "30 tonf"),
    },
    press,
)


def winch(inertia: float, rotor: float, load: float, stall: float, no_load: float, **_: float) -> dict:
    """Direct-current motor over gears of 20: i M₀ (1 − i ω/ω₀) = M_L, and exponential run-up with τ = J ω₀/(i² M₀)."""
    ratio = 20
    final = no_load / ratio * (1.0 - load / (ratio * stall))
    constant = (inertia + ratio**2 * rotor) * no_load / (ratio**2 * stall)
    return {
        "hoisting.mean_speed": final,
        "hoisting.motor_power": load * final,
        "hoisting.motor_shaft_torque_peak": load / ratio,
        # To nine tenths of the final speed.
        "start.time": constant * math.log(10.0),
    }


WINCH = Typed(
    """\
title = "Winch"

[points]
O = { x = "$zero", y = "$zero" }

[input]
type = "crank"
link = "drum"
pivot = "O"
pin = "A"
length = "$radius"
speed = "50 rpm"

[bodies]
drum = { link = "drum", mass = "$mass", inertia = "$inertia" }

[shafts]
motor_shaft = { geared_to = "drum", ratio = 20, inertia = "$rotor" }

[moments.load]
type = "constant"
on = "drum"
moment = "-$load"
role = "useful"

[moments.motor]
type = "dc_motor"
on = "motor_shaft"
stall_moment = "$stall"
no_load_speed = "$no_load"

[regimes.start]
type = "run"
speed = "45 rpm"

[regimes.hoisting]
type = "steady"
""",
    {
        "zero": ("0 mm", "0 in"),
        "radius": ("200 mm", "8 in"),
        "mass": ("150 kg", "330 lb"),
        "inertia": ("3 kg m2", "72 lb-ft2"),
        "rotor": ("0.02 kg m2", "0.5 lb-ft2"),
        # Four fifths of the no-load speed, 50 rpm at the drum: start ends at nine tenths of that.
        "load": ("400 N m", "300 lbf-ft"),
        "stall": ("100 N m", "75 lbf-ft"),
        "no_load": ("1250 rpm", "1250 rpm"),
    },
    winch,
)


def shaper(crank: float, distance: float, lever: float, begin: float, end: float, force: float, **_: float) -> dict:
    """Swinging lever: sin ψ = r/d, stroke 2 L sin ψ, quick-return ratio (π + 2ψ)/(π − 2ψ)."""
    swing = math.asin(crank / distance)
    return {
        "ram.stroke": 2 * lever * math.sin(swing),
        "ram.stroke_time_ratio": (math.pi + 2 * swing) / (math.pi - 2 * swing),
        "lever.swing": 2 * swing,
        "required_drive_moment": force * (end - begin) / (2 * math.pi),
        # In mid-stroke the lever turns fastest backwards, by r/(d − r) of the crank's speed.
        "lever.angular_velocity.peak": 40 * math.pi / 30 * crank / (distance - crank),
    }


SHAPER = Typed(
    """\
title = "Shaper"

[points]
D = { x = "$zero", y = "$zero" }
O = { x = "$zero", y = "$distance" }
P = { link = "lever", x = "$lever", y = "$zero" }

[guides]
bed = { y = "$height", angle = "180 deg" }

[input]
type = "crank"
pivot = "O"
pin = "A"
length = "$crank"
speed = "40 rpm"

[groups.slot]
type = "RPR"
first = { link = "block", joint = "A" }
second = { link = "lever", joint = "D" }

[groups.drive]
type = "RRP"
inner = "B"
first = { link = "drag_link", joint = "P", length = "$drag" }
second = { link = "ram", guide = "bed" }

[bodies]
ram = { link = "ram", mass = "$mass" }

[forces.cutting]
type = "table"
on = "B"
angle = "0 deg"
slider = "ram"
measured_from = "low end"
over_stroke = ["$begin", "$end"]
force = ["$force", "$force"]
interpolation = "linear"
outside = "zero"
acts = "against"
role = "useful"
""",
    {
        "zero": ("0 mm", "0 in"),
        "distance": ("250 mm", "10 in"),
        "lever": ("500 mm", "20 in"),
        "height": ("480 mm", "19 in"),
        "crank": ("100 mm", "4 in"),
        "drag": ("220 mm", "9 in"),
        "mass": ("150 kg", "320 lb"),
        "begin": ("20 mm", "1 in"),
        "end": ("380 mm", "15 in"),
        "force": ("2 kN", "450 lbf"),
    },
    shaper,
)


def cam(lift: float, speed: float, mass: float, preload: float, stiffness: float, **_: float) -> dict:
    """Cycloidal rise over β = 120°: peaks 2 h ω/β, 2π h ω²/β² and 4π² h ω³/β³."""
    angle = math.radians(120)
    peak = 2 * math.pi * lift * (speed / angle) ** 2
    # The spring's k s exceeds what the follower's m a relieves, so the contact is least loaded in the lower dwell.
    return {
        "cam.greatest_velocity": 2 * lift * speed / angle,
        "cam.greatest_acceleration": peak,
        "cam.greatest_jerk": 4 * math.pi**2 * lift * (speed / angle) ** 3,
        "cam.least_contact_force": preload,
    }


CAM = Typed(
    """\
title = "Disc cam"

[elements.cam]
type = "cam"
base_radius = "$base"
speed = "$speed"

[elements.cam.sections]
rise = { type = "rise", law = "cycloidal", angle = "120 deg", lift = "$lift" }
top = { type = "dwell", angle = "60 deg" }
return = { type = "return", law = "cycloidal", angle = "120 deg" }
bottom = { type = "dwell" }

[elements.cam.follower]
type = "translating"
contact = "roller"
roller_radius = "$roller"
mass = "$mass"
preload = "$preload"
stiffness = "$stiffness"
""",
    {
        "base": ("40 mm", "1.5 in"),
        "speed": ("300 rpm", "300 rpm"),
        "lift": ("20 mm", "0.75 in"),
        "roller": ("12 mm", "0.5 in"),
        "mass": ("0.8 kg", "2 lb"),
        "preload": ("100 N", "20 lbf"),
        "stiffness": ("8 N/mm", "40 lbf/in"),
    },
    cam,
)


def reducer(module: float, speed: float, torque: float, **_: float) -> dict:
    """Ring held: i = 1 + z₃/z₁ = 1 + 96/24; without friction the moments are in the same ratio."""
    ratio = 1 + 96 / 24
    return {
        "reducer.arm.speed": speed / ratio,
        "reducer.motor.moment": torque / ratio,
        "reducer.motor.power": torque / ratio * speed,
        "reducer.outer.centre_distance": module * (24 + 36) / 2,
    }


REDUCER = Typed(
    """\
title = "Planetary reducer"

[elements.reducer]
type = "gear_train"
module = "$module"

[elements.reducer.wheels]
sun = { shaft = "motor", teeth = 24, width = "$width" }
planet = { shaft = "idler", teeth = 36, width = "$width" }
ring = { shaft = "frame", teeth = 96 }

[elements.reducer.shafts]
motor = { speed = "$speed" }
idler = { carrier = "arm" }
arm = { planets = 3, moment = "-$torque" }

[elements.reducer.meshes]
outer = { between = ["sun", "planet"] }
inner = { between = ["planet", "ring"], type = "internal" }
""",
    {
        "module": ("2 mm", "0.1 in"),
        "width": ("25 mm", "1 in"),
        "speed": ("1500 rpm", "1750 rpm"),
        "torque": ("100 N m", "80 lbf-ft"),
    },
    reducer,
)


def train(engine: float, generator: float, diameter: float, length: float, modulus: float, firing: float, **_) -> dict:
    """Two masses on a shaft: k = π G d⁴/(32 l), ω² = k (1/J₁ + 1/J₂); shaft torque T J₂/(J₁ + J₂)/(1 − Ω²/ω²)."""
    stiffness = math.pi * modulus * diameter**4 / (32 * length)
    natural = math.sqrt(stiffness * (1 / engine + 1 / generator))
    order = 2 * 1500 * math.pi / 30
    return {
        "train.frequency_1": natural,
        "train.coupling.alternating_moment": firing
        * generator
        / (engine + generator)
        / abs(1 - (order / natural) ** 2),
    }


TRAIN = Typed(
    """\
title = "Engine and generator"

[elements.train]
type = "torsional_train"
modes = 1
speed = "1500 rpm"
load = "generator"

[elements.train.masses]
engine = { inertia = "$engine" }
generator = { inertia = "$generator" }

[elements.train.shafts.coupling]
between = ["engine", "generator"]
parts.shaft = { type = "shaft", diameter = "$diameter", length = "$length", shear_modulus = "$modulus" }

[elements.train.excitations]
mean = { on = "engine", order = 0, amplitude = "$mean" }
firing = { on = "engine", order = 2, amplitude = "$firing" }
""",
    {
        "engine": ("4 kg m2", "96 lb-ft2"),
        "generator": ("6 kg m2", "144 lb-ft2"),
        "diameter": ("60 mm", "2.25 in"),
        "length": ("500 mm", "20 in"),
        "modulus": ("80 GPa", "11500000 psi"),
        "mean": ("300 N m", "220 lbf-ft"),
        "firing": ("500 N m", "370 lbf-ft"),
    },
    train,
)

MACHINES = {
    "compressor": COMPRESSOR,
    "winch": WINCH,
    "shaper": SHAPER,
    "press": PRESS,
    "cam": CAM,
    "reducer": REDUCER,
    "train": TRAIN,
}


def in_si(text: str) -> float:
    """A typed number with its unit."""
    number, _, unit = text.partition(" ")
    return float(number) * SI[unit]


def printed(text: str, name: str) -> float:
    """A printed result in SI: the number and unit after "NAME →"."""
    found = re.search(rf"(?m)^ *{re.escape(name)} +→ +(\S+)(?: ± \S+)?(?: (\S+))?(?:  |$)", text)
    assert found, f"{name} isn't shown:\n{text}"
    return float(found[1]) * SI[found[2] or ""]


@pytest.mark.parametrize("system", ["mm", "US"])
@pytest.mark.parametrize("name", MACHINES)
def test_machine__is_answered_from_its_file_to_its_report(name, system, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    machine, column = MACHINES[name], ["mm", "US"].index(system)
    typed = {key: texts[column] for key, texts in machine.numbers.items()}
    Path(f"{name}.toml").write_text(Template(machine.text).substitute(typed))
    result = f"results/{name}.h5"
    texts = {"check": done("check", f"{name}.toml"), "run": done("run", f"{name}.toml", "--no-plots")}
    by_hand = machine.by_hand(**{key: in_si(text) for key, text in typed.items()})
    assert {n: printed(texts["run"], n) for n in by_hand} == pytest.approx(by_hand, rel=2e-4)
    texts["show"] = done("show", result, "--columns", ",".join(by_hand))
    # A report draws all pictures: of each machine once, in the units that nothing is written in by default.
    if system == "US":
        done("report", result, "--out", "page.html")
        texts["report"] = words_of_page(Path("page.html"))
        assert machine.text.partition('"')[2].partition('"')[0] in texts["report"]
    show_units({})
    assert all(re.search(rf"\b{n}\b", texts["show"]) for n in by_hand)
    assert {command: found for command, text in texts.items() if (found := foreign(text, system))} == {}
