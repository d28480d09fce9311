"""Linkages of other programs as scenes: what their files say of places is where the engine finds the joints."""

import json
import math
import string
from pathlib import Path

import numpy as np
import pytest
from commands import done, refused
from each_case import each

from engine import MovingMachine
from sweeps import import_scene


def ref(name):
    return {"ref": name}


def joint(kind, name, x, y, **more):
    return {"type": kind, "name": name, "x": x, "y": y, **more}


def fixed(name, x, y):
    return {"inline": True, **joint("Static", name, x, y)}


# A crank-rocker with a coupler point on it, a slider driven by that, and a fixed point given in place.
JOINTS = {
    "name": "Four-bar, slider",
    "joints": [
        joint("Static", "A", 0, 0),
        joint("Crank", "B", 0.5, 0.6, joint0=ref("A"), distance=1, angle=-0.3),
        joint("Revolute", "C", 3, 2, joint0=ref("B"), joint1=fixed("D 1", 3, 0), distance0=3, distance1=1.5),
        joint("Fixed", "P", 0, 0, joint0=ref("B"), joint1=ref("C"), distance=1.2, angle=0.6),
        joint("Prismatic", "S", -7, -1, joint0=ref("P"), revolute_radius=5)
        | {"joint1": fixed("E", 0, -1), "joint2": fixed("F", 1, -1)},
    ],
}

LINKS = {
    "name": "",
    "joints": [
        {"id": "O", "type": "ground", "position": [0, 0]},
        {"id": "D", "type": "ground", "position": [3.0, 0.0]},
        {"id": "A", "type": "revolute", "position": [math.cos(1.0), math.sin(1.0)]},
        {"id": "B", "type": "revolute", "position": [2.5, 2.0]},
        {"id": "T", "type": "tracker", "ref_joint1_id": "A", "ref_joint2_id": "B", "distance": 2.0, "angle": -0.4},
    ],
    "links": [
        {"id": "ground", "type": "ground", "joints": ["O", "D"]},
        {"id": "motor", "type": "driver", "joints": ["O", "A"], "motor_joint": "O", "angular_velocity": 0.1},
        {"id": "coupler", "type": "link", "joints": ["A", "B"]},
        {"id": "rocker", "type": "link", "joints": ["B", "D"]},
    ],
    "ground": "ground",
}

# An offset slider-crank, a point on its rod; the slider's guide passes below its joint.
ROWS = """\
ground,input,R,0,0,tfft
input,coupler,R,10,44
coupler,follower,R,150, 37
follower,ground,P,120,30,10
coupler,R,60,80
"""
ADDRESS = (
    "http://example.org/?set=s50|f0.5&mech=ground input R 97.194 -5.099 0.000 tfff|input leg R 60 30 0 tfff|"
    "leg output R 160.055 60 0 tfff|output ground R 184.674 0.209 0 tfff|"
)


def places(scene, crank_angle, names):
    """Where the engine finds points at a crank angle, x + iy [m]."""
    drive = scene.input.model_copy(update={"start": crank_angle, "stop": crank_angle + 1e-3})
    asked = [f"{name}.{axis}" for name in names for axis in "xy"]
    rows = MovingMachine(scene.model_copy(update={"input": drive}), positions=8).fields(asked)
    return [complex(rows[f"{name}.x"][0], rows[f"{name}.y"][0]) for name in names]


def test_joints_of_pylinkage__are_held_as_they_say(tmp_path):
    file = tmp_path / "l.json"
    file.write_text(json.dumps(JOINTS))
    scene = import_scene(file, unit=0.1)
    # A step of a negative angle turns clockwise.
    assert (scene.title, scene.input.speed) == ("Four-bar, slider", pytest.approx(-2 * math.pi))
    for angle in (0.876, 2.0, 4.4):
        b, c, p, s = (place / 0.1 for place in places(scene, angle, ("B", "C", "P", "S")))
        # Roundings of lengths of at most 8.
        assert b == pytest.approx(np.exp(1j * angle), abs=1e-13)
        assert [abs(c - b), abs(c - 3), abs(s - p)] == pytest.approx([3, 1.5, 5], abs=1e-13)
        assert p == pytest.approx(b + 1.2 * np.exp(0.6j) * (c - b) / 3, abs=1e-13)
        assert s.imag == pytest.approx(-1, abs=1e-13)
        # C above the line from B to D, S to the left: as the file's coordinates are.
        assert ((3 - b).conjugate() * (c - b)).imag > 0
        assert s.real < p.real


def test_links_of_pylinkage__stand_where_the_file_has_them(tmp_path):
    file = tmp_path / "l.json"
    file.write_text(json.dumps(LINKS))
    a, b, t = (place / 1e-3 for place in places(import_scene(file), 1.0, ("A", "B", "T")))
    assert a == pytest.approx(np.exp(1j), abs=1e-13)
    assert b == pytest.approx(2.5 + 2j, abs=1e-12)
    assert t == pytest.approx(a + 2 * np.exp(-0.4j) * (b - a) / abs(b - a), abs=1e-12)


def test_rows_of_pmks__stand_where_the_file_has_them(tmp_path):
    file = tmp_path / "m.txt"
    file.write_text(ROWS)
    scene = import_scene(file)
    found = [place / 1e-3 for place in places(scene, math.atan2(44, 10), ("J2", "J3", "J5"))]
    assert found == pytest.approx([10 + 44j, 150 + 37j, 60 + 80j], abs=1e-11)
    # The guide is inclined by 10°: later on the joint has moved along it.
    (later,) = (place / 1e-3 for place in places(scene, 2.5, ("J3",)))
    assert math.degrees(np.angle(-(later - found[1]))) == pytest.approx(10, abs=1e-9)


def test_address_of_pmks__is_read_by_the_command(folder):
    Path("m.url").write_text(ADDRESS)
    done("import", "m.url", "--unit", "1 cm", "--speed", "90 rpm")
    text = Path("m.toml").read_text()
    assert text.startswith("# Imported from m.url")
    done("check", "m.toml")
    assert "exists already" in refused("import", "m.url")


DIGITS = string.digits + string.ascii_uppercase + string.ascii_lowercase + "_-"


def shared(joints, links, switches="0P", integers="K,0", choices="101", check=True):
    """Address of PMKS+: joints (switches, name, x, y, angle), links (kind, name, joints), in thousandths."""

    def number(value):
        digits, left = "", abs(value)
        while left or not digits:
            digits, left = DIGITS[left % 64] + digits, left // 64
        return ("0" if value < 0 else "") + digits

    rows = [f"{DIGITS[flags]}{name},{name},{','.join(map(number, places))}" for flags, name, *places in joints]
    bars = [f"{kind}{name},{name},Fe,Fe,0,0,c5cae9,{','.join(members)},," for kind, name, members in links]
    whole = f"{switches}.SS.{integers}.{choices}.{'.'.join([*rows, '', *bars])}...N_"
    return f"https://app.pmksplus.com/?{whole}{DIGITS[len(whole) % 62 if check else (len(whole) + 1) % 62]}"


# A slider-crank with a point on its rod; switches: 1 slides, 2 is the input, 4 on the frame.
HINGES = [(6, "A", 0, 0, 0), (0, "B", -1200, 4100, 0), (0, "C", 15000, -3700, 0), (0, "P", 6000, 8000, 0)]
GUIDE = (5, "S", 15000, -3700, 175)
BARS = [("YR", "AB", "AB"), ("YR", "BCP", "BCP"), ("YP", "CS", "CS")]


def test_address_of_pmks_plus__stands_where_it_says_at_its_speed(tmp_path):
    file = tmp_path / "m.url"
    file.write_text(shared([*HINGES, GUIDE], BARS))
    scene = import_scene(file)
    # 20 rpm clockwise; centimetres, the joints in thousandths of them.
    assert scene.input.speed == pytest.approx(-20 * math.pi / 30, rel=1e-15)
    b, c, p = (place / 1e-5 for place in places(scene, math.atan2(4100, -1200), ("B", "C", "P")))
    assert [b, c, p] == pytest.approx([-1200 + 4100j, 15000 - 3700j, 6000 + 8000j], abs=1e-7)
    (later,) = (place / 1e-5 for place in places(scene, 3.0, ("C",)))
    assert np.angle(-(later - c)) == pytest.approx(0.175, abs=1e-9)
    # An option has the last word.
    slow = import_scene(file, unit=1.0, speed="3 rpm")
    assert slow.input.speed == pytest.approx(0.1 * math.pi, rel=1e-15)
    assert slow.input.length == pytest.approx(abs(-1.2 + 4.1j), rel=1e-15)


def test_welded_links_of_pmks_plus__are_one(tmp_path):
    file = tmp_path / "m.url"
    parts = [("NR", "BC", "BC"), ("NR", "CP", "CP")]
    file.write_text(shared([*HINGES, GUIDE], [*BARS, *parts], choices="2112", switches="3u").removeprefix("https:"))
    scene = import_scene(file)
    assert [group.first.link for group in scene.groups.values()] == ["BCP"]
    assert (scene.input.speed > 0, scene.input.length) == (True, pytest.approx(abs(-1.2 + 4.1j), rel=1e-15))


def changed(data, kind, **values):
    joints = [one | values if one["type"] == kind else one for one in data["joints"]]
    return json.dumps(data | {"joints": joints})


@each(
    "text, words",
    [
        ("hello", "row 1, 'hello'"),
        ("a,b,R,1,x", "must be numbers"),
        ("ground,a,G,1,1", "G of ground and a is not supported"),
        ("a,b,R,1,1", "no driver"),
        ("ground,a,R,1,1\nb,c,R,2,2", "moves no other link"),
        ("ground,a,R,0,0\na,b,R,1,1\nb,c,R,2,2", "can't be split into dyads"),
        ("{", "is not JSON"),
        ("{}", "no list of joints"),
        ('{"joints": [{"type": "Static"}]}', "KeyError 'name'"),
        (changed(JOINTS, "Revolute", distance0=30), "C can't be assembled"),
        (changed(JOINTS, "Revolute", joint0=ref("Q")), "refer to each other in a circle"),
        (changed(JOINTS, "Prismatic", joint1=ref("B")), "a moving line"),
        (changed(JOINTS, "Prismatic", type="Screw"), "'Screw' is not one of"),
        (changed(LINKS, "tracker", type="prismatic"), "is not supported; supported: ground, revolute, tracker"),
        (shared([*HINGES, GUIDE], BARS, choices="901"), "(choice 9); give --unit"),
        (shared([*HINGES, (1, *GUIDE[1:])], BARS), "is not on a single guide of the frame"),
        (shared([*HINGES, (*GUIDE, 3)], BARS), "supported: joints, and sliders on the frame"),
        (shared([*HINGES, GUIDE], [("YR", "AQ", "AQ")]), "a joint 'Q' that is not in the address"),
        (shared([(4, *HINGES[0][1:]), *HINGES[1:], (7, *GUIDE[1:])], BARS), "it must be a crank"),
        (shared([(6, "A", 0, 0)], []), "the format is too old"),
    ],
)
def test_what_becomes_no_scene__is_refused_in_words(folder, text, words):
    Path("l.dat").write_text(text)
    answer = refused("import", "l.dat")
    assert words in answer
    assert not Path("l.toml").exists()
