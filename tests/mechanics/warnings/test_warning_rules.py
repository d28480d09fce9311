"""Every warning just beyond its limit and just within it, against numbers calculated by hand."""

import math

import numpy as np
import pytest
from machines import rrr, slider_crank

from engine import (
    WARNING_KINDS,
    ElementsAlone,
    Machine,
    Scene,
    is_warning,
    summaries_for_warnings,
    warnings_in_words,
)
from engine.parts.requirements import WarningLimits

CRANK = {"type": "crank", "pivot": "O", "pin": "A", "length": 0.05, "speed": 20.0}
# Only the crank matters: what follows it has no mass and no load.
FLYWHEEL = {"wheel": {"type": "rim", "diameter": 1.0}, "inertia": 1.0}
FLUCTUATION = {"speed_fluctuation": 0.05}
HALF_WAVE = {"load": {"type": "formula", "on": "crank", "moment": "'10 N m' * (sin(phi) - 1)"}}
DROP = {"drop": {"type": "run", "time": 0.1}}
COMPRESSOR = {
    "type": "compressor", "piston": "ram", "bore": 0.08, "clearance": 0.2, "suction": "1 bar", "discharge": "8 bar"
}  # fmt: skip
DISC = {"disc": {"link": "crank", "mass": 1.0}}
RAM = {"ram_body": {"link": "ram", "mass": 1.0}}
PUSH = {"type": "constant", "on": "B", "angle": 0.0, "force": 100.0}
ROWS = PUSH | {"type": "table", "force": [100.0, 100.0], "interpolation": "linear", "outside": "zero"}
LOW_ANGLE = {"transmission_angle": "30 deg"}


def scene(rod=0.2, speed=20.0, **parts):
    """A slider-crank with a crank of 50 mm: the ram's stroke is 100 mm, from rod − 50 mm to rod + 50 mm."""
    crank = {"input": CRANK | {"speed": speed, **parts.pop("drive", {})}}
    return Scene.model_validate(slider_crank(rod=rod, group="pair") | crank | parts)


def found(machine):
    """Warnings on a machine, and the names of those that its columns flag."""
    known = summaries_for_warnings(machine)
    words = warnings_in_words(machine, None, known)
    made = Machine(machine) if machine.input else ElementsAlone(machine)
    names = [n for n in made.available_summaries if is_warning(n)]
    outcome = type(made)(machine, [*names, *known]).evaluate({})
    flagged = [n.partition(".")[2] for n in names if n != "warnings" and outcome.summaries[n][0]]
    # NumPy alone finds what compiled code does.
    assert {name: value for name, (value, _) in known.items()} == {
        name: pytest.approx(outcome.summaries[name][0], rel=1e-9, abs=1e-12) for name in known
    }
    assert list(outcome.summaries) == [*names, *known]
    assert not names or outcome.summaries["warnings"][0] == len(words)
    return words, flagged


def rim(speed=20.0, inertia=1.0, limits=None, **numbers):
    flywheel = {"inertia": inertia, "wheel": FLYWHEEL["wheel"] | numbers}
    return scene(speed=speed, flywheel=flywheel, limits=limits or {})


def compressing(rod=0.2, **numbers):
    return scene(rod=rod, bodies=RAM, cylinders={"gas": COMPRESSOR | numbers})


def pumping(suction):
    pump = {"type": "pump", "piston": "ram", "bore": 0.08, "suction": suction, "discharge": "8 bar"}
    return scene(bodies=RAM, cylinders={"liquid": pump})


def rubbing(coefficient):
    return scene(friction={"pin": {"pair": "pair.inner", "coefficient": coefficient, "diameter": 0.001}})


def four_bar(limit):
    """Crank 40 mm, coupler and rocker 100 mm, frame 120 mm."""
    bars = rrr("B", ("coupler", "A", 0.1), ("rocker", "D", 0.1))
    points = {"O": {"x": 0.0, "y": 0.0}, "D": {"x": 0.12, "y": 0.0}}
    return scene(
        points=points, guides={}, drive={"length": 0.04}, groups={"bars": bars}, limits={"transmission_angle": limit}
    )


def gear(teeth, **numbers):
    """A pinion and a wheel of 60 teeth, 20° pressure angle."""
    train = {
        "type": "gear_train",
        "wheels": {"pinion": {"shaft": "in", "teeth": teeth, **numbers}, "wheel": {"shaft": "out", "teeth": 60}},
        "shafts": {"in": {"speed": 10.0}, "out": {}},
        "meshes": {"mesh": {"between": ["pinion", "wheel"]}},
    }
    return Scene.model_validate({"elements": {"train": train}})


def belt(speed):
    """A belt of 1 kg/m under 100 N: at 10 m/s the centrifugal tension is as much."""
    numbers = {"diameter": 0.2, "wrap": math.pi, "friction": 0.3, "tension": 100.0, "linear_density": 1.0}
    return Scene.model_validate({"elements": {"belt": {"type": "belt", "speed": speed, **numbers}}})


def with_motor(load):
    """A DC motor of 200 W at 100 rad/s, so of 2 N·m, on a shaft five times as fast as the crank."""
    motor = {"type": "dc_motor", "on": "fast", "no_load_speed": 110.0, "power": 200.0, "rated_speed": 100.0}
    resisting = {"type": "against_motion", "on": "crank", "moment": load, "role": "useful"}
    return scene(
        shafts={"fast": {"geared_to": "crank", "ratio": 5.0, "inertia": 0.01}},
        bodies={"disc": {"link": "crank", "mass": 1.0, "inertia": 1.0}},
        moments={"motor": motor, "load": resisting},
        regimes={"duty": {"type": "steady"}},
    )


def rod_of(length, force):
    """A steel rod of 20 mm diameter, whose radius of gyration is 5 mm, slow enough to feel the force alone."""
    shape = {"type": "rod", "length": length, "area": math.pi * 0.01**2}
    return scene(
        rod=length,
        speed=0.01,
        bodies={"rod_body": {"link": "rod", "shape": shape, "density": 7850.0}, **RAM},
        forces={"push": PUSH | {"force": force}},
    )


def as_free_links(machine):
    """The slider-crank with its dyad as a group of free links."""
    given = machine.model_dump(exclude_unset=True)
    dyad = given.pop("groups")["pair"]
    rod = {"joints": ["A", "B"], "length": dyad["first"]["length"]}
    near = {"B": {"x": rod["length"] + 0.05, "y": 0.0}}
    return Scene.model_validate(given | {"links": {"rod": rod, "ram": {"joints": ["B"], "guide": "way"}}, "near": near})


def pushed(bodies, **force):
    return scene(bodies=bodies, forces={"push": PUSH | force})


def formula(text):
    return pushed(RAM, type="formula", force=text)


def rows(table, **parts):
    return scene(bodies=RAM, forces={"cut": ROWS | table}, **parts)


def stroke_rows(begin, end, measured_from):
    return rows({"over_stroke": [begin, end], "slider": "ram", "measured_from": measured_from})


def turning(inertia, **parts):
    """A machine whose reduced inertia is that of a disc on its crank."""
    return scene(bodies={"disc": {"link": "crank", "mass": 1.0, "inertia": inertia}}, **parts)


def half_wave(inertia, flywheel=FLUCTUATION, **parts):
    return turning(inertia, moments=HALF_WAVE, flywheel=flywheel, **parts)


# Kind, machine beyond the limit, machine within it, what the warning says.
CASES = [
    # v = ωD/2: 90.1 rad/s · 0.5 m = 45.05 m/s, above 45 m/s of cast iron.
    ("rim_speed", rim(90.1), rim(89.9), "45.05 m/s exceeds 45 m/s"),
    ("rim_speed", rim(90.1, rim_speed_limit=45.04), rim(90.1, rim_speed_limit=45.06), "45.04 m/s, rim_speed_limit"),
    # σ = ρv²: 7850 kg/m³ · (45 m/s)² = 15.896 MPa.
    (
        "hoop_stress",
        rim(90.0, material="steel", strength=15.89e6),
        rim(90.0, material="steel", strength=15.9e6),
        "15.896 MPa exceeds strength = 15.89 MPa",
    ),
    # J = ½ρπb(R⁴ − r⁴), R = 0.5 m, r = 0.4 m: 0.41733 kg·m² for b = 1 mm of cast iron.
    ("rim_width", rim(inertia=0.417), rim(inertia=0.418), "only 0.99921 mm wide, below limits.rim_width = 1 mm"),
    (
        "rim_width",
        rim(inertia=0.418, limits={"rim_width": "1.01 mm"}),
        rim(inertia=0.418, limits={"rim_width": "1 mm"}),
        "below limits.rim_width = 1.01 mm",
    ),
    # ΔW of 10 N·m · sin φ is 20 J; with δ = 0.05 at 20 rad/s I + I_F = 20/(0.05 · 400) = 1 kg·m².
    ("negative_flywheel", half_wave(1.01), half_wave(0.99), "is -0.01 kg·m², below 0 kg·m²"),
    (
        "run_flywheel",
        half_wave(0.5, regimes=DROP),
        half_wave(0.5, FLUCTUATION | {"inertia": 0.5}, regimes=DROP),
        "drop is computed without the 0.5 kg·m²",
    ),
    (
        "clearance",
        compressing(clearance=0.51, discharge="2 bar"),
        compressing(clearance=0.5, discharge="2 bar"),
        "51 % of the swept volume exceeds limits.clearance = 50 %",
    ),
    # ((1 + 0.2)/0.2)^1.3 = 10.271.
    (
        "discharge",
        compressing(discharge="10.28 bar"),
        compressing(discharge="10.26 bar"),
        "ends at 1.0271 MPa, below discharge = 1.028 MPa",
    ),
    ("suction", pumping("8.1 bar"), pumping("7.9 bar"), "suction = 810 kPa exceeds discharge = 800 kPa"),
    ("friction", rubbing(1.6), rubbing(1.4), "1.6 exceeds limits.friction = 1.5"),
    ("loose_belt", belt(10.01), belt(9.99), "of 100.2 N uses up its tension of 100 N"),
    ("unused_load", stroke_rows(0.101, 0.2, "low end"), stroke_rows(0.099, 0.2, "low end"), "200 mm from the low end"),
    ("unused_load", stroke_rows(0.101, 0.2, "high end"), stroke_rows(0.099, 0.2, "high end"), "misses its rows, 101"),
    # The ram moves from 150 mm to 250 mm.
    ("unused_load", stroke_rows(0.1, 0.149, "guide"), stroke_rows(0.1, 0.151, "guide"), "guide's point, by 1 mm"),
    ("unused_load", formula("'1 N' * max(0, phi - 6.3)"), formula("'1 N' * max(0, phi - 6.2)"), "no work anywhere"),
    # r/l = cos γ: 39.715° with a rod of 65 mm, 40.75° with 66 mm; 29.94° with 57.7 mm, 30.11° with 57.8 mm.
    ("transmission_angle", scene(rod=0.065), scene(rod=0.066), "39.715 °, below limits.transmission_angle = 40"),
    (
        "transmission_angle",
        scene(rod=0.0577, limits=LOW_ANGLE),
        scene(rod=0.0578, limits=LOW_ANGLE),
        "below limits.transmission_angle = 30",
    ),
    # cos γ = (100² + 100² − (120 − 40)²)/(2 · 100 · 100) = 0.68: 47.156°.
    ("transmission_angle", four_bar("47.2 deg"), four_bar("47.1 deg"), "bars: its transmission angle falls to 47.156"),
    # λ = l/(d/4).
    ("slenderness", rod_of(1.001, -100.0), rod_of(0.999, -100.0), "slenderness 200.2 exceeds"),
    ("slenderness", rod_of(1.001, -100.0), rod_of(1.001, 100.0), "and the rod is compressed"),
    ("slenderness", as_free_links(rod_of(1.001, -100.0)), as_free_links(rod_of(1.001, 100.0)), "200.2 exceeds"),
    ("massless_link", as_free_links(pushed(DISC)), as_free_links(pushed(RAM)), "acts on link ram, whose mass is 0"),
    ("massless_link", pushed(DISC), pushed(RAM), "acts on link ram, whose mass is 0"),
    ("no_masses", scene(moments=HALF_WAVE), scene(moments=HALF_WAVE, bodies=RAM), "the machine has loads but 0 masses"),
    # 2/sin² 20° = 17.097; with a shift of 0.1 15.388.
    ("undercut", gear(17), gear(18), "17 teeth, below 17.097"),
    ("undercut", gear(15, profile_shift=0.1), gear(16, profile_shift=0.1), "15 teeth, below 15.388"),
]


@pytest.mark.parametrize(
    ("kind", "beyond", "within", "says"), CASES, ids=[f"{i} {case[0]}" for i, case in enumerate(CASES)]
)
def test_warning__is_given_beyond_its_limit_and_not_within(kind, beyond, within, says):
    words, flagged = found(beyond)
    assert [kind] == flagged
    assert len(words) == 1
    assert says in words[0]
    assert kind not in found(within)[1]


@pytest.mark.parametrize(
    ("beyond", "within", "wheel"),
    [(100.1, 99.9, None), (400.4, 399.6, {"type": "disc", "diameter": "200 mm", "ratio": 2.0})],
)
def test_flywheel_ratio__counts_the_wheel_on_its_own_shaft(beyond, within, wheel):
    for inertia, flagged in ((beyond, ["flywheel_ratio"]), (within, [])):
        machine = turning(1.0, flywheel={"inertia": inertia, "wheel": wheel})
        assert found(machine)[1] == flagged


@pytest.mark.parametrize(("load", "warned"), [(10.1, True), (9.9, False)])
def test_motor_torque__is_compared_at_the_motor(load, warned):
    """10 N·m at the crank are 2 N·m at the motor, its rated torque."""
    machine = with_motor(load)
    outcome = Machine(machine, ["warnings", "warnings.motor_torque", "duty.motor_moment_rms"]).evaluate({})
    assert list(outcome.summaries["warnings.motor_torque"]) == [float(warned)] == list(outcome.summaries["warnings"])
    rms = "duty.motor_moment_rms"
    known = {rms: (outcome.summaries[rms][0], outcome.errors[rms][0])}
    words = warnings_in_words(machine, None, known)
    assert len(words) == warned
    assert not warned or "2.02 N·m in duty exceeds the rated torque 2 N·m" in words[0]
    # What costs a regime isn't computed for a warning alone.
    assert warnings_in_words(machine, None, summaries_for_warnings(machine)) == []


def test_every_kind__has_a_case():
    assert {kind.name for kind in WARNING_KINDS} == {case[0] for case in CASES} | {"flywheel_ratio", "motor_torque"}


def test_scene_alone__is_enough_where_no_quantity_is_read():
    enough = {"clearance", "discharge", "suction", "friction", "loose_belt", "massless_link", "no_masses", "undercut"}
    for kind, beyond, within, says in CASES:
        words = warnings_in_words(beyond)
        assert (len(words) == 1 and says in words[0]) if kind in enough else words == []
        assert warnings_in_words(within) == []


def test_rows_outside_the_range_of_the_crank__are_found_without_computation():
    def limited(begin):
        return rows({"over_angle": [begin, 2.0]}, drive={"start": 0.0, "stop": 1.0})

    assert "the crank misses its rows, 63.025 ° … 114.59 °, by 5.7296 °" in warnings_in_words(limited(1.1))[0]
    assert warnings_in_words(limited(0.9)) == []


def test_rows_that_are_all_zero__never_act():
    machine = rows({"force": [0.0, 0.0], "over_stroke": [0.0, 1.0], "slider": "ram"})
    assert "all of its rows are 0" in warnings_in_words(machine)[0]


def test_columns__follow_the_numbers_of_each_variant():
    machine = compressing()
    path = "cylinders.gas.clearance"
    outcome = Machine(machine, ["warnings.clearance", "warnings"], varied=[path]).evaluate(
        {path: [0.4, 0.6, 0.2, -1.0]}
    )
    # Above 0.24 the compressor doesn't reach its discharge pressure: ((1 + c)/c)^1.3 = 8.
    np.testing.assert_array_equal(outcome.summaries["warnings.clearance"], [0.0, 1.0, 0.0, np.nan])
    np.testing.assert_array_equal(outcome.summaries["warnings"], [1.0, 2.0, 0.0, np.nan])
    np.testing.assert_array_equal(outcome.errors["warnings"], [0.0, 0.0, 0.0, np.nan])


def test_limit__may_vary():
    machine = scene(rod=0.065, limits={})
    path = "limits.transmission_angle"
    asked = Machine(machine, ["warnings.transmission_angle"], varied=[path])
    outcome = asked.evaluate({path: np.radians([39.0, 40.0])})
    np.testing.assert_array_equal(outcome.summaries["warnings.transmission_angle"], [0.0, 1.0])


@pytest.mark.parametrize(
    ("key", "allows"),
    [
        ("transmission_angle", 0.0),
        ("clearance", 9.0),
        ("slenderness", 999.0),
        ("rim_width", 0.0),
        ("flywheel_ratio", 1e6),
        ("friction", 9.0),
    ],
)
def test_limit_that_allows_more__silences_its_warning(key, allows):
    beyond = {kind: machine for kind, machine, _, _ in reversed(CASES)} | {
        "flywheel_ratio": turning(1.0, flywheel={"inertia": 101.0})
    }
    machine = beyond[key]
    limited = machine.model_copy(update={"limits": WarningLimits(**{key: allows})})
    known = summaries_for_warnings(machine)
    assert len(warnings_in_words(machine, None, known)) == 1
    assert warnings_in_words(limited, None, known) == []


def test_number_on_its_limit__is_undecided():
    """A rim at 45 m/s to the last digits is no reason to warn, but the flag is uncertain."""
    machine = rim(90.0)
    outcome = Machine(machine, ["warnings.rim_speed"]).evaluate({})
    assert (outcome.summaries["warnings.rim_speed"][0], outcome.errors["warnings.rim_speed"][0]) == (0.0, 1.0)
    assert warnings_in_words(machine, None, summaries_for_warnings(machine)) == []


def test_machine_that_fails__has_the_warnings_of_its_numbers():
    machine = compressing(rod=0.04, clearance=3.0)
    assert summaries_for_warnings(machine) == {}
    assert len(warnings_in_words(machine, None, {})) == 2


def test_load_over_time__leaves_out_what_it_makes_undefined():
    machine = rows({"over_time": [0.0, 1.0]}, flywheel=FLYWHEEL)
    names = Machine(machine).available_summaries
    assert "warnings.rim_speed" not in names
    assert "warnings.transmission_angle" in names
    assert "pair.transmission_angle" in summaries_for_warnings(machine)


def test_slow_machine__needs_no_masses():
    assert found(scene(moments=HALF_WAVE, inertia_in_reactions=False)) == ([], [])
