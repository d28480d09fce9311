"""Scenes that hold every part a scene may have but machine elements and motion, each in its positions."""

import math

from driving_cams import SLIDING, SWINGING, changed
from free_link_scenes import triad_data
from machines import crank, four_bar, frame, on, prp, rpr, rrp
from noncircular_wheels import CHAIN, ELLIPSES
from racks import DOUBLER, LIFT, ON_CRANK
from rubbing_machines import yoke


def slider_crank(**tables: dict) -> dict:
    scene = {
        "gravity": 9.81,
        "points": {"O": frame(0, 0), "P": frame(0.3, 0.3), "K": on("rod", 0.1, 0.03), "Q": frame(0.4, 0.0)},
        "guides": {"way": {"y": 0.01}},
        "input": crank(length=0.05, speed=5.0),
        "groups": {"g": rrp("B", ("rod", "A", 0.2), "ram", "way")},
        "bodies": {
            "rod_body": {"link": "rod", "mass": 2.0, "x": 0.1, "inertia": 0.01},
            "ram_body": {"link": "ram", "mass": 1.0, "y": 0.05},
        },
    }
    return scene | {key: {**scene.get(key, {}), **more} for key, more in tables.items()}


def limited(scene: dict) -> dict:
    scene["input"] |= {"start": 0.2, "stop": 3.0}
    return scene


def table(**own: object) -> dict:
    return {"type": "table", "interpolation": "linear"} | own


ANGLES = {"over_angle": [0.5, 1.5, 4.0], "moment": [5.0, 9.0, -3.0]}
TIMES = {"over_time": [0.1, 0.2, 0.4], "moment": [5.0, 9.0, -3.0]}
STROKE = {"slider": "ram", "on": "B", "angle": 0.3, "force": [7.0, 9.0, 3.0, 5.0]}
OF_SHAFT = {"shafts": {"s": {"geared_to": "crank", "ratio": 2.0}}}


def on_shaft(**own: object) -> dict:
    return slider_crank(**OF_SHAFT, moments={"load": {"on": "s"} | own})


def shaft(**own: object) -> dict:
    return slider_crank(
        shafts={"s": {"geared_to": "crank", "ratio": 2.0} | own},
        moments={"load": {"type": "constant", "on": "s", "moment": 3.0}},
    )


def body(**own: object) -> dict:
    return slider_crank(bodies={"one": {"link": "rod"} | own})


def wheel(**own: object) -> dict:
    return slider_crank() | {"flywheel": {"speed_fluctuation": 0.02, "wheel": own}}


def loaded(**parts: dict) -> dict:
    """A slider-crank with a load on its slider."""
    return force(type="constant", on="B", angle=math.pi, force=100.0) | parts


def force(**own: object) -> dict:
    return slider_crank(forces={"load": own})


def law(**own: object) -> dict:
    masses = {"second_body": {"link": "second", "mass": 1.0, "x": 0.1}}
    second = {"type": "crank", "pivot": "C"} | own
    return slider_crank(points={"C": frame(0.5, 0.0)}, inputs={"second": second}, bodies=masses)


def rubbing(**own: object) -> dict:
    return slider_crank(friction={"f": {"coefficient": 0.1} | own})


def cylinder(**own: object) -> dict:
    gas = {"piston": "ram", "bore": 0.05, "clearance": 0.1, "intake": 1e5, "exhaust": 1.1e5, "peak": 4e6}
    scene = slider_crank(cylinders={"c": gas | own})
    scene["input"]["revolutions"] = 2 if own["type"] == "four_stroke" else 1
    return scene


def slide(**own: object) -> dict:
    second = {"second": {"type": "slider", "guide": "up"} | own}
    masses = {"second_body": {"link": "second", "mass": 1.0}}
    return slider_crank(guides={"up": {"x": 0.4, "angle": 1.0}}, inputs=second, bodies=masses)


def brake(**own: object) -> dict:
    return on_shaft(force=10.0, friction=0.3, **own)


def program(key: str) -> dict:
    return {
        "up": {"type": "rise", "law": "cycloidal", "angle": 2.0, key: 0.025},
        "back": {"type": "return", "law": "3-4-5", "angle": 2.0},
        "low": {"type": "dwell"},
    }


ROWS = {"over_angle": [0.0, 2.0, 4.0], "lift": [0.0, 0.02, 0.01]}
BAND = {"type": "band_brake", "radius": 0.1, "lever_arm": 0.5, "slack_arm": 0.1}
TWO_GUIDES = {
    "points": {"O": frame(0, 0)},
    "input": crank(length=0.05),
    "guides": {"a": {"angle": 0.1}, "b": {"link": "crank", "x": 0.05, "angle": 1.5}},
    "groups": {"g": prp("B", ("one", "a", 0.0), ("other", "b", 0.0))},
    "bodies": {"m": {"link": "one", "mass": 2.0}},
}
RING = {"type": "ring", "diameter": 0.2, "inner_diameter": 0.1, "thickness": 0.01}
FLAT = {"type": "translating", "link": "tappet", "guide": "way", "contact": "flat"}
WANTED = {"over_angle": [0.2, 1.5, 4.0]}
ARMS = {"type": "arms", "arm_area": 1e-3, "hub_diameter": 0.05, "hub_width": 0.04}
LINES = {"piston": "ram", "bore": 0.05, "suction": 1e5, "discharge": 5e5}
SCENES = {
    "four_bar": four_bar(1, K=on("coupler", 0.4, 0.1)) | {"bodies": {"a": {"link": "coupler", "mass": 1.0, "x": 0.4}}},
    "range": limited(slider_crank(moments={"load": table(on="rod", **ANGLES), "clock": table(on="rod", **TIMES)})),
    "over_angle": slider_crank(moments={"load": table(on="rod", **ANGLES)}),
    "over_stroke": force(**table(**STROKE, over_stroke=[0.16, 0.18, 0.2, 0.22])),
    "from_low": force(**table(**STROKE, measured_from="low end", over_stroke=[0.01, 0.02, 0.05, 0.07])),
    "against": force(type="against_motion", on="K", force=10.0),
    "against_along": force(type="against_motion", on="K", angle=0.2, force=10.0),
    "drag": force(type="linear_drag", on="K", coefficient=10.0),
    "power_drag": force(type="power_drag", on="K", force=5.0, at_speed=0.3, exponent=1.5),
    "formula": force(type="formula", on="K", force="k * K.x", numbers={"k": "3 N/m"}),
    "constant": force(type="constant", on="K", angle=0.3, force=10.0),
    "bare_shaft": shaft(inertia=0.1),
    "shaft": shaft(pivot="Q"),
    "toothed_shaft": shaft(pivot="Q", pressure_angle=0.3),
    "lossy_shaft": shaft(efficiency=0.9),
    "shaft_on_rod": shaft(geared_to="rod"),
    "moment": on_shaft(type="constant", moment=3.0),
    "resistance": on_shaft(type="against_motion", moment=3.0),
    "fan": on_shaft(type="quadratic_drag", coefficient=0.3),
    "hoist": on_shaft(type="hoist", mass=3.0, drum_radius=0.1),
    "vehicle": on_shaft(type="vehicle", mass=3.0, wheel_radius=0.1),
    "rolling": on_shaft(type="vehicle", mass=3.0, wheel_radius=0.1, rolling=0.1),
    "climbing": on_shaft(type="vehicle", mass=3.0, wheel_radius=0.1, slope=0.1, drag_area=0.3),
    "conveyor": on_shaft(type="conveyor", load_mass=3.0, drum_radius=0.1),
    "long_conveyor": on_shaft(type="conveyor", load_mass=3.0, drum_radius=0.1, friction=0.1),
    "lift": on_shaft(type="conveyor", load_mass=3.0, drum_radius=0.1, incline=0.1),
    "dc": on_shaft(type="dc_motor", no_load_speed=20.0, stall_moment=10.0),
    "induction": on_shaft(type="induction_motor", synchronous_speed=20.0, breakdown_moment=10.0, breakdown_slip=0.2),
    "curve": on_shaft(type="table_motor", speed=[0.0, 8.0, 20.0], moment=[4.0, 6.0, 0.0]),
    "torsion": slider_crank(moments={"load": {"type": "torsion_spring", "on": "rod", "stiffness": 3.0}}),
    "spring": slider_crank(springs={"load": {"between": ["P", "B"], "stiffness": 100.0}}),
    "damper": slider_crank(springs={"load": {"between": ["P", "B"], "damping": 10.0}}),
    "point_mass": body(mass=1.0, x=0.1),
    "rod": body(mass=1.0, shape={"type": "rod", "length": 0.2}),
    "dense_rod": body(density=7000.0, shape={"type": "rod", "length": 0.2, "area": 1e-3}),
    "disc": body(mass=1.0, shape={"type": "disc", "diameter": 0.2}),
    "dense_ring": body(density=7000.0, shape=RING),
    "plate": body(mass=1.0, shape={"type": "plate", "length": 0.2, "width": 0.1}),
    "swing": body(mass=1.0, x=0.1, swing={"type": "compound", "period": 1.0, "distance": 0.1}),
    "rim": wheel(type="rim", diameter=1.0, strength=1e8),
    "free_rim": wheel(type="rim"),
    "heavy_rim": wheel(type="rim", density=7000.0, rim_speed_limit=20.0),
    "disc_wheel": wheel(type="disc", diameter=1.0),
    "arms": wheel(**ARMS, diameter=1.0),
    "mean_rim": wheel(type="mean rim", mean_diameter=1.0),
    "even_input": law(ratio=1),
    "wavy_input": law(harmonics={"one": {"order": 1, "cosine": 0.3}}),
    "pump": slider_crank(cylinders={"c": LINES | {"type": "pump"}}),
    "compressor": slider_crank(cylinders={"c": LINES | {"type": "compressor", "clearance": 0.1}}),
    "base": slider_crank(base={"acceleration_x": 1.0}),
    "wanted_path": slider_crank(wanted={"w": {"type": "path", "point": "K", "x": [0.1, 0.12], "y": [0.02, 0.03]}}),
    "wanted_slide": slider_crank(wanted={"w": {"type": "slider", "of": "ram", "slide": [0.1, 0.2, 0.1], **WANTED}}),
    "wanted_angle": slider_crank(wanted={"w": {"type": "link", "of": "rod", "angle": [0.1, 0.4, 0.2], **WANTED}}),
    "doubler": DOUBLER,
    "lossy_doubler": changed(DOUBLER, pinions__wheel__efficiency=0.9, racks__table__efficiency=0.9),
    "lifted": LIFT,
    "rack_on_crank": ON_CRANK,
    "ellipses": ELLIPSES,
    "chain": CHAIN,
    "cam": changed(SLIDING, cams__cam__sections=program("lift")),
    "flat_cam": changed(SLIDING, cams__cam__sections=program("lift"), cams__cam__follower=FLAT),
    "tabled_cam": changed(SLIDING, cams__cam__sections=None, cams__cam__table=ROWS),
    "swinging_cam": SWINGING,
    "journal": rubbing(pair="g.inner", diameter=0.02),
    "worn_journal": rubbing(pair="g.inner", diameter=0.02, contact="worn in"),
    "rule_journal": rubbing(pair="g.inner", diameter=0.02, above_prismatic=0.3),
    "way": rubbing(pair="g.second"),
    "vee": rubbing(pair="g.second", form="vee", vee_angle=1.0),
    "stribeck": rubbing(pair="g.second", static_coefficient=0.2, stribeck_speed=0.1),
    "pin": loaded(pins={"p": {"pair": "g.inner", "diameter": 0.02, "width": 0.03}}),
    "tube": loaded(struts={"s": {"link": "rod", "diameter": 0.02, "inner_diameter": 0.01}}),
    "flat_rod": loaded(struts={"s": {"link": "rod", "width": 0.02, "thickness": 0.004, "material": "E335"}}),
    "yoke": yoke(0.3, 0.1),
    "two_guides": TWO_GUIDES,
    "four_stroke": cylinder(type="four_stroke"),
    "two_stroke": cylinder(type="two_stroke", port=0.8),
    "block_brake": brake(type="block_brake", radius=0.1),
    "disc_brake": brake(type="disc_brake", inner_radius=0.05, outer_radius=0.1),
    "band_brake": brake(**BAND, wrap=3.0),
    "lined_band": brake(**BAND, blocks=8, block_angle=0.3),
    "bifilar": body(mass=1.0, x=0.1, swing={"type": "bifilar", "period": 1.0, "spacing": 0.1, "length": 1.0}),
    "trifilar": body(mass=1.0, x=0.1, swing={"type": "trifilar", "period": 1.0, "radius": 0.1, "length": 1.0}),
    "replaced": body(mass=1.0, x=0.1, inertia=0.004, replace={"type": "dynamic", "at": ["A", "K"], "mass": 0.2}),
    "statically": body(mass=1.0, x=0.1, inertia=0.004, replace={"type": "static", "at": ["A", "B"]}),
    "slide": slide(harmonics={"one": {"order": 1, "cosine": 0.03}}),
    "slide_sections": slide(sections=program("lift")),
    "slide_table": slide(table=ROWS),
    "swing_sections": law(sections=program("swing")),
    "over_time_input": law(period=2 * math.pi / 5, harmonics={"one": {"order": 1, "cosine": 0.3}}),
    "even_in_time": law(speed=5.0),
    "triad": triad_data(),
    "formula_moment": on_shaft(type="formula", moment="k * omega", numbers={"k": "3 N m s"}),
    "drag_moment": on_shaft(type="linear_drag", coefficient=1.0),
    "power_moment": on_shaft(type="power_drag", moment=1.0, at_speed=2.0, exponent=1.5),
    "square_drag": force(type="quadratic_drag", on="K", coefficient=10.0),
    "planet": slider_crank(
        shafts={"s": {"geared_to": "frame", "carrier": "crank", "pivot": "A", "ratio": 2.0}},
        bodies={"p": {"link": "s", "mass": 1.0, "x": 0.03}},
    ),
    "slider": {
        "points": {"D": frame(0.05, 0.25)},
        "guides": {"way": {"angle": 0.2}},
        "input": {"type": "slider", "link": "piston", "guide": "way", "point": "P"}
        | {"start": 0.0, "stop": 0.1, "speed": 0.3},
        "groups": {"g": rpr(("block", "P"), ("lever", "D"))},
        "bodies": {"l": {"link": "lever", "mass": 1.0, "x": 0.1}},
    },
}
