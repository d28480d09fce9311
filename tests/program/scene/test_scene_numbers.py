"""Numbers of a scene by their paths, their limits, and scenes written out and read back."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scene_samples import SLIDING

from engine import Scene, scene_numbers
from engine.scene.scene import SceneNumber, within_limits
from sweeps.text.scene_text import read_scene, write_scene

CRANK = """\
title = "All that a crank can drive"
source = "made up"
gravity = "9.81 m/s2"

[points]
O = {x = "0 mm", y = "0 mm"}
D = {x = "260 mm", y = "20 mm"}
E = {x = "-180 mm", y = "-30 mm"}
W = {x = "0 mm", y = "-0.3 m"}
knob = {link = "wheel", x = "60 mm", y = "0 mm"}
tip = {link = "rocker", x = "180 mm", y = "5 mm"}

[guides]
way = {angle = "-90 deg"}
side = {x = "30 mm", y = "0.4 m", angle = "0.25 rad"}
slot = {link = "rocker", x = "50 mm", angle = "10 deg"}
bed = {x = "1 m", angle = "90 deg"}

[input]
type = "crank"
pivot = "O"
pin = "A"
length = "50 mm"
speed = "-60 rpm"
revolutions = 2

[shafts]
wheel = {geared_to = "crank", ratio = -0.5, pivot = "W", phase = "30 deg", inertia = "20 kg cm2"}
fan = {geared_to = "rocker", ratio = "1/3", inertia = "1 kg m2"}

[groups.bars]
type = "RRR"
inner = "B"
first = {link = "rod", joint = "A", length = "220 mm"}
second = {link = "rocker", joint = "D", length = "150 mm"}
mode = -1

[groups.press]
type = "RRP"
inner = "C"
first = {link = "pitman", joint = "B", length = "0.3 m"}
second = {link = "ram", guide = "way", offset = "12 mm"}

[groups.shaper]
type = "RPR"
first = {link = "die", joint = "A"}
second = {link = "lever", joint = "E", offset = "3 mm"}

[groups.cross]
type = "PRP"
inner = "X"
first = {link = "along", guide = "slot", offset = "1 mm"}
second = {link = "across", guide = "side"}

[groups.yoke]
type = "RPP"
first = {link = "stone", joint = "knob"}
second = {link = "frame_saw", guide = "bed", slot_angle = "90 deg"}

[bodies]
crank = {link = "crank", mass = "2 kg", x = "10 mm", y = "-1 mm", inertia = "0.01 kg m2"}
rod = {link = "rod", density = "7850 kg/m3", shape = {type = "rod", length = "220 mm", area = "6 cm2"}}
wheel = {link = "wheel", mass = "3 kg", shape = {type = "disc", diameter = "0.3 m"}}
ram = {link = "ram", mass = "1.5 t"}

[bodies.lever]
link = "lever"
x = "0 mm"
density = "7.85 kg/dm3"
shape = {type = "ring", diameter = "0.3 m", inner_diameter = "0.2 m", thickness = "1 cm"}

[bodies.rocker]
link = "rocker"
x = "70 mm"
density = "2700 kg/m3"
shape = {type = "plate", length = "150 mm", width = "30 mm", thickness = "8 mm"}

[forces]
weight = {type = "constant", on = "tip", angle = "-1.5 rad", force = "120 N", turns_with = "rocker", role = "harmful"}
rub = {type = "against_motion", on = "C", force = "40 N", angle = "-90 deg", acts = "along"}
oil = {type = "linear_drag", on = "B", coefficient = "40 N s/m"}
air = {type = "quadratic_drag", on = "B", coefficient = "0.8 N s2/m2"}
mud = {type = "power_drag", on = "B", force = "3 N", at_speed = "2 km/h", exponent = 1.5}

[forces.punch]
type = "table"
on = "C"
angle = "90 deg"
slider = "ram"
measured_from = "high end"
over_stroke = ["0 mm", "1 mm", "8 mm"]
force = ["0 kN", "100 kN", "60 kN"]
interpolation = "pchip"
outside = "zero"
acts = "against"
scale = "80 %"

[forces.turn]
type = "table"
on = "B"
angle = "0 deg"
over_angle = ["0 deg", "90 deg", "720 deg"]
force = ["0 N", "0.1 kN", "0 N"]
interpolation = "linear"

[moments]
hoist = {type = "constant", on = "lever", moment = "-7 N m"}
brake = {type = "against_motion", on = "rocker", moment = "2 N m"}
bath = {type = "linear_drag", on = "fan", coefficient = "0.2 N m s/rad"}
blades = {type = "quadratic_drag", on = "fan", coefficient = "0.003 N m s2/rad2"}
paste = {type = "power_drag", on = "lever", moment = "1 N m", at_speed = "30 rpm", exponent = 0.5}
coil = {type = "torsion_spring", on = "lever", stiffness = "5 N m/deg", free_angle = "12 deg"}
dc = {type = "dc_motor", on = "wheel", stall_moment = "0.2 kN m", no_load_speed = "1500 rpm"}

[moments.clock]
type = "table"
on = "rocker"
over_time = ["0 ms", "400 ms"]
moment = ["1 N m", "2 N m"]
interpolation = "linear"
outside = "hold"

[moments.kloss]
type = "induction_motor"
on = "crank"
synchronous_speed = "1500 rpm"
breakdown_moment = "40 N m"
breakdown_slip = "20 %"

[moments.plate]
type = "induction_motor"
on = "crank"
synchronous_speed = "1500 rpm"
power = "1.5 kW"
rated_speed = "1420 rpm"
breakdown_ratio = 2.6
starting_ratio = 2.2

[springs]
back = {between = ["D", "tip"], stiffness = "5 N/mm", free_length = "80 mm", damping = "12 N s/m"}

[cylinders]

[cylinders.cold]
type = "compressor"
piston = "ram"
bore = "80 mm"
clearance = "5 %"
suction = "1 bar"
discharge = "6 bar"
head = "low"

[cylinders.water]
type = "pump"
piston = "across"
bore = "3 cm"
suction = "0.8 bar"
discharge = "1.2 MPa"
ambient = "101.325 kPa"

[cylinders.otto]
type = "four_stroke"
piston = "ram"
bore = "80 mm"
clearance = 0.1
intake = "0.9 bar"
exhaust = "1.1 bar"
peak = "45 bar"
firing_angle = "360 deg"

[cylinders.moped]
type = "two_stroke"
piston = "ram"
bore = "40 mm"
clearance = 0.12
intake = "1 bar"
exhaust = "1.1 bar"
peak = "30 bar"
port = "75 %"
n_compression = 1.3

[flywheel]
inertia = "0.4 kg m2"
speed_fluctuation = "1/30"

[flywheel.wheel]
type = "arms"
density = "7850 kg/m3"
rim_speed_limit = "35 m/s"
diameter = "1.2 m"
thickness_ratio = 0.08
ratio = 2
arms = 8
arm_area = "30 cm2"
hub_diameter = "20 cm"
hub_width = "25 cm"
"""

SLIDER = SLIDING.replace('start = "0 mm"', 'start = "-10 mm"').replace("[guides.way]", '[guides.way]\ny = "-12 mm"')
CRANKED = """[input]
type = "crank"
pivot = "O"
pin = "A"
length = "9 mm"
speed = "2 rad/s"
start = "-20 deg"
stop = "1 rev"

"""
LIMITED = SLIDER[: SLIDER.index("[input]")] + CRANKED + SLIDER[SLIDER.index("[groups") :]
LIMITED = LIMITED.replace("[points]\n", '[points]\nO = {x = "0 m", y = 0}\n')
TEXTS = {"crank": CRANK, "slider": SLIDER, "limited": LIMITED}


def scene_of(text: str, folder: Path) -> Scene:
    path = folder / "scene.toml"
    path.write_text(text, encoding="utf8")
    return read_scene(path)


@pytest.fixture
def crank(tmp_path) -> Scene:
    return scene_of(CRANK, tmp_path)


# Converted by hand; equality is exact, as texts are converted with correct rounding.
EXPECTED = {
    "gravity": (9.81, "acceleration"),
    "points.D.x": (0.26, "length"),
    "points.knob.y": (0.0, "length"),
    "guides.way.angle": (-np.pi / 2, "angle"),
    "guides.side.y": (0.4, "length"),
    "input.length": (0.05, "length"),
    "input.speed": (-2 * np.pi, "angular_speed"),
    "shafts.wheel.ratio": (-0.5, "number"),
    "shafts.wheel.inertia": (0.002, "inertia"),
    "shafts.fan.ratio": (1 / 3, "number"),
    "groups.bars.mode": (-1.0, "number"),
    "groups.press.first.length": (0.3, "length"),
    "groups.press.second.offset": (0.012, "length"),
    "groups.shaper.second.offset": (0.003, "length"),
    "groups.cross.second.offset": (0.0, "length"),
    "groups.yoke.second.slot_angle": (np.pi / 2, "angle"),
    "bodies.rod.density": (7850.0, "density"),
    "bodies.rod.shape.area": (6e-4, "area"),
    "bodies.lever.shape.inner_diameter": (0.2, "length"),
    "bodies.ram.mass": (1500.0, "mass"),
    "forces.punch.scale": (0.8, "number"),
    "forces.oil.coefficient": (40.0, "damping"),
    "forces.air.coefficient": (0.8, "quadratic_drag"),
    "forces.mud.at_speed": (2 / 3.6, "speed"),
    "moments.coil.stiffness": (5 * 180 / np.pi, "torsional_stiffness"),
    "moments.bath.coefficient": (0.2, "torsional_damping"),
    "moments.blades.coefficient": (0.003, "torsional_quadratic_drag"),
    "moments.kloss.breakdown_slip": (0.2, "number"),
    "moments.plate.power": (1500.0, "power"),
    "springs.back.stiffness": (5000.0, "stiffness"),
    "cylinders.water.ambient": (101_325.0, "pressure"),
    "cylinders.moped.port": (0.75, "number"),
    "flywheel.speed_fluctuation": (1 / 30, "number"),
    "flywheel.wheel.rim_speed_limit": (35.0, "speed"),
    "flywheel.wheel.arm_area": (0.003, "area"),
}


def test_numbers__have_the_paths_values_and_dimensions_of_the_text(crank):
    numbers = scene_numbers(crank)
    for path, (value, dimension) in EXPECTED.items():
        assert numbers[path].dimension == dimension, path
        # One rounding of the text's factor, one of the value written here.
        assert numbers[path].value == pytest.approx(value, rel=4e-16, abs=0), path


def test_numbers__leave_out_tables_counts_and_what_is_not_given(crank):
    numbers = scene_numbers(crank)
    left_out = """input.revolutions input.start forces.punch.force forces.punch.over_stroke.0 flywheel.wheel.arms
    bodies.ram.x bodies.ram.inertia moments.kloss.power groups.yoke.mode title"""
    assert not numbers.keys() & set(left_out.split())
    assert not any(type(n.value) is not float for n in numbers.values())


def test_numbers_of_a_sliding_input__are_displacements(tmp_path):
    numbers = scene_numbers(scene_of(SLIDER, tmp_path))
    found = [numbers[f"input.{key}"][:2] for key in ("start", "stop", "speed")]
    assert found == [(-0.01, "length"), (0.05, "length"), (1.0, "speed")]


@pytest.mark.parametrize(
    ("path", "values", "keep"),
    [
        ("input.length", [1e-9, 0.0, -0.0, -1.0, np.nan, np.inf], [1, 0, 0, 0, 0, 0]),
        ("points.D.x", [-1.0, 0.0, 1e9, np.nan, -np.inf], [1, 1, 1, 0, 0]),
        ("bodies.ram.mass", [0.0, 2.0, -1e-12], [1, 1, 0]),
        ("groups.bars.mode", [1.0, -1.0, 0.0, 0.5, 2.0, -1.0 + 1e-12, np.nan], [1, 1, 0, 0, 0, 0, 0]),
        ("flywheel.speed_fluctuation", [0.0, 1e-6, 1.999, 2.0], [0, 1, 1, 0]),
        ("flywheel.inertia", [0.0, -1.0], [1, 0]),
        ("flywheel.wheel.thickness_ratio", [0.0, 0.49, 0.5], [0, 1, 0]),
        ("cylinders.moped.port", [0.0, 0.5, 1.0, 1.01], [0, 1, 1, 0]),
        ("moments.plate.breakdown_ratio", [1.0, 1.01], [0, 1]),
        ("springs.back.free_length", [0.0, -0.1], [1, 0]),
        ("input.speed", [-5.0, 5.0], [1, 1]),
    ],
)
def test_within_limits__keeps_what_a_text_could_hold(path, values, keep, crank):
    assert within_limits(scene_numbers(crank)[path], np.array(values)).tolist() == [bool(k) for k in keep]


def test_within_limits__agrees_with_the_reading_of_texts(crank):
    """The two places where limits are kept, one for columns and one for texts, say the same of every number."""
    data = crank.model_dump()
    for path, number in scene_numbers(crank).items():
        for value in (-1.0, 0.0, 0.4, 1.0, 3.0):
            *tables, key = path.split(".")
            part = data
            for table in tables:
                part = part[table]
            held, part[key] = part[key], value
            try:
                Scene.model_validate(data)
                accepted = True
            except ValueError as error:
                # Limits of one number alone; those that tie two numbers together have a sentence of their own.
                accepted = all(e["type"] == "value_error" and e["loc"][-1:] != (key,) for e in error.errors())
            part[key] = held
            assert bool(within_limits(number, np.array([value]))[0]) == accepted, (path, value)


def test_within_limits__keeps_the_shape():
    number = SceneNumber(1.0, "length", ())
    assert within_limits(number, np.zeros((2, 3))).shape == (2, 3)


@pytest.mark.parametrize("name", TEXTS)
def test_scene_written_and_read__is_the_same(name, tmp_path):
    scene = scene_of(TEXTS[name], tmp_path)
    written = write_scene(scene)
    again = scene_of(written, tmp_path)
    assert again == scene
    assert write_scene(again) == written


def test_written_scene__has_units_wherever_a_number_has_a_dimension(crank):
    data = tomllib.loads(write_scene(crank))
    for path, number in scene_numbers(crank).items():
        part = data
        for key in path.split("."):
            part = part.get(key) if isinstance(part, dict) else None
        if part is not None and number.dimension != "number":
            assert isinstance(part, str), path
            assert " " in part, path
    assert data["forces"]["punch"]["over_stroke"] == ["0.0 m", "0.001 m", "0.008 m"]
    assert data["moments"]["clock"]["over_time"] == ["0.0 s", "0.4 s"]


def test_written_variant__has_its_numbers_and_all_others_unchanged(crank, tmp_path):
    values = {
        "input.length": 0.0625,
        "groups.bars.mode": 1.0,
        "groups.press.mode": -1.0,
        "gravity": 0.0,
        "points.O.x": 0.125,
        "guides.slot.y": 0.001,
        "bodies.rod.y": 0.25,
        "bodies.rod.shape.area": 7e-4,
        "cylinders.water.ambient": 2e5,
        "cylinders.cold.n_expansion": 1.25,
        "forces.turn.scale": 3.0,
        "flywheel.wheel.ratio": 1.0,
        "shafts.wheel.phase": 0.1,
    }
    before = scene_numbers(crank)
    after = scene_numbers(scene_of(write_scene(crank, values), tmp_path))
    assert after.keys() == before.keys()
    assert {p: n.value for p, n in after.items()} == {p: n.value for p, n in before.items()} | values


NUMBERS = ("input.length", "groups.press.second.offset", "bodies.ram.mass", "moments.blades.coefficient", "gravity")


@settings(deadline=None, max_examples=60)
@given(st.lists(st.floats(1e-300, 1e300), min_size=len(NUMBERS), max_size=len(NUMBERS)))
def test_any_numbers__survive_writing_and_reading_bit_by_bit(tmp_path_factory, values):
    folder = tmp_path_factory.getbasetemp()
    scene = scene_of(CRANK, folder)
    wanted = dict(zip(NUMBERS, values, strict=True))
    numbers = scene_numbers(scene_of(write_scene(scene, wanted), folder))
    assert {path: numbers[path].value for path in NUMBERS} == wanted


def test_texts_with_csv_and_with_lists__give_the_same_scene(tmp_path):
    lists = CRANK.replace('"0 mm", "1 mm", "8 mm"', '"0 mm", "1 mm", "8.5 mm"')
    inside = 'over_stroke = ["0 mm", "1 mm", "8.5 mm"]\nforce = ["0 kN", "100 kN", "60 kN"]'
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "p.csv").write_text("# measured\nforce [kN], over_stroke [mm]\n0,0\n 100 ,1\n6e1,8.5\n\n")
    assert inside in lists
    assert scene_of(lists.replace(inside, 'file = "data/p.csv"'), tmp_path) == scene_of(lists, tmp_path)
