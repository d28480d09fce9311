"""Numbers of a scene by their paths, their limits, and scenes written out and read back."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from each_case import each
from hypothesis import given, settings
from hypothesis import strategies as st
from scene_samples import GOOD
from scenes_of_parts import SCENES, on_shaft, slider_crank

from engine import Scene, SceneError, scene_numbers
from engine.scene.scene import SceneNumber, within_limits
from sweeps import read_scene, write_scene

PLATE = {"power": 1500.0, "rated_speed": 148.7, "breakdown_ratio": 2.6, "starting_ratio": 2.2}
EVERY = SCENES | {
    "nameplate": on_shaft(type="induction_motor", synchronous_speed=157.0, **PLATE),
    "whole_wheel": slider_crank(flywheel={"inertia": 0.4, "speed_fluctuation": 0.1}),
}


def read(text: str, folder: Path) -> Scene:
    path = folder / "scene.toml"
    path.write_text(text, encoding="utf8")
    return read_scene(path)


def numbers_of(name: str) -> dict[str, SceneNumber]:
    return scene_numbers(Scene.model_validate(EVERY[name]))


def part_of(data: dict, path: str) -> tuple[dict, str]:
    """The table that holds a number, and the number's key there."""
    *tables, key = path.split(".")
    for table in tables:
        data = data[table]
    return data, key


# Scene, path, a text there, its value converted by hand, its dimension. Numbers that have their unit in a bundled text
# are left out: it couldn't be read if they had another dimension.
EXPECTED = [
    ("spring", "input.speed", "-60 rpm", -2 * np.pi, "angular_speed"),
    ("shaft_on_rod", "shafts.s.ratio", "1/3", 1 / 3, "number"),
    ("four_bar", "groups.bars.mode", -1, -1.0, "number"),
    ("two_guides", "groups.g.second.offset", 0, 0.0, "length"),
    ("dense_ring", "bodies.one.shape.inner_diameter", "0.15 m", 0.15, "length"),
    ("rod", "bodies.one.mass", "1.5 t", 1500.0, "mass"),
    ("over_stroke", "forces.load.scale", "80 %", 0.8, "number"),
    ("square_drag", "forces.load.coefficient", "0.8 N s2/m2", 0.8, "quadratic_drag"),
    ("power_drag", "forces.load.at_speed", "2 km/h", 2 / 3.6, "speed"),
    ("torsion", "moments.load.stiffness", "5 N m/deg", 5 * 180 / np.pi, "torsional_stiffness"),
    ("fan", "moments.load.coefficient", "0.003 N m s2/rad2", 0.003, "torsional_quadratic_drag"),
    ("induction", "moments.load.breakdown_slip", "20 %", 0.2, "number"),
    ("pump", "cylinders.c.ambient", "101.325 kPa", 101_325.0, "pressure"),
    ("two_stroke", "cylinders.c.port", "75 %", 0.75, "number"),
    ("rim", "flywheel.speed_fluctuation", "1/30", 1 / 30, "number"),
    ("heavy_rim", "flywheel.wheel.rim_speed_limit", "35 m/s", 35.0, "speed"),
    ("arms", "flywheel.wheel.arm_area", "30 cm2", 0.003, "area"),
]


@each("name, path, text, value, dimension", EXPECTED)
def test_number__has_the_value_and_dimension_of_the_text(name, path, text, value, dimension, tmp_path):
    data = tomllib.loads(write_scene(Scene.model_validate(EVERY[name])))
    part, key = part_of(data, path)
    part[key] = text
    found = scene_numbers(read(tomli_w.dumps(data), tmp_path))[path]
    assert found.dimension == dimension
    # One rounding of the text's factor, one of the value written here.
    assert found.value == pytest.approx(value, rel=4e-16, abs=0)


def test_numbers__leave_out_tables_counts_and_what_is_not_given():
    for name, left_out in {
        "arms": "input.revolutions input.start flywheel.wheel.arms title bodies.ram_body.x bodies.ram_body.inertia",
        "over_stroke": "forces.load.force forces.load.over_stroke.0",
        "induction": "moments.load.power",
        "yoke": "groups.g.mode",
    }.items():
        assert not numbers_of(name).keys() & set(left_out.split())
        assert all(type(number.value) is float for number in numbers_of(name).values())


def test_within_limits__agrees_with_the_reading_of_texts():
    """The two places where limits are kept, one for columns and one for texts, say the same of every number."""
    seen = set()
    for scene in map(Scene.model_validate, EVERY.values()):
        data = scene.model_dump()
        for path, number in scene_numbers(scene).items():
            part, key = part_of(data, path)
            if (path, part.get("type")) in seen:
                continue
            seen.add((path, part.get("type")))
            held = part[key]
            for value in (-1.0, 0.0, 0.4, 1.0, 3.0, np.nan, np.inf):
                part[key] = value
                try:
                    Scene.model_validate(data)
                    accepted = True
                except SceneError as error:
                    # Limits of one number alone; those that tie two numbers together have a sentence of their own.
                    accepted = all(place.rpartition(".")[2] != key for place, _ in error.problems)
                assert bool(within_limits(number, np.array([value]))[0]) == accepted, (path, value)
            part[key] = held


@each("name", EVERY)
def test_scene_written_and_read__is_the_same_and_has_units(name, tmp_path):
    scene = Scene.model_validate(EVERY[name])
    written = write_scene(scene)
    again = read(written, tmp_path)
    assert again == scene
    assert write_scene(again) == written
    data = tomllib.loads(written)
    for path, number in scene_numbers(scene).items():
        part = data
        for key in path.split("."):
            part = part.get(key) if isinstance(part, dict) else None
        if part is not None and number.dimension != "number":
            assert isinstance(part, str), path
            assert " " in part, path


NUMBERS = ("input.length", "groups.press.second.offset", "bodies.ram.mass", "moments.friction.moment", "gravity")


@settings(max_examples=30)
@given(st.lists(st.floats(1e-300, 1e300), min_size=len(NUMBERS), max_size=len(NUMBERS)))
def test_any_numbers__survive_writing_and_reading_bit_by_bit(tmp_path_factory, values):
    folder = tmp_path_factory.getbasetemp()
    wanted = dict(zip(NUMBERS, values, strict=True))
    numbers = scene_numbers(read(write_scene(read(GOOD, folder), wanted), folder))
    assert {path: numbers[path].value for path in NUMBERS} == wanted
