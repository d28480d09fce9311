"""A press with every kind of body, shaft and action."""

from machines import four_bar, frame, on, rrp


def press(**parts: dict) -> dict:
    """Crank, coupler and rocker; a link from the rocker drives a ram on a slanting guide; gears and idle shafts."""
    scene = four_bar(
        C=on("rocker", 0.7, 0.1),
        S=frame(-0.6, 0.2),
        T=frame(2.4, 1.4),
        R=on("ram", 0.1, 0.05),
        K=on("coupler", 0.4, 0.2),
        M=on("gear", 0.2, 0.1),
    )
    scene["guides"] = {"way": {"x": 1.2, "y": 0.4, "angle": 0.25}}
    scene["groups"]["drive"] = rrp("E", ("link", "C", 0.9), "ram", "way", 0.05)
    scene["shafts"] = {
        "gear": {"geared_to": "crank", "ratio": -2.0, "inertia": 0.03, "pivot": "S", "phase": 0.4},
        "motor_shaft": {"geared_to": "crank", "ratio": 6.0, "inertia": 0.01},
        "fan": {"geared_to": "rocker", "ratio": 2.5, "inertia": 0.2},
    }
    return scene | {"gravity": 9.81, **parts}


def bodies() -> dict:
    """Every shape, by mass and by density, with and without a centre of its own."""
    return {
        "crank_body": {"link": "crank", "mass": 4.0, "x": 0.12, "y": -0.03, "inertia": 0.05},
        "coupler_body": {"link": "coupler", "mass": 3.0, "shape": {"type": "rod", "length": 1.0}},
        "link_body": {
            "link": "link",
            "density": 7800.0,
            "x": 0.5,
            "y": 0.02,
            "shape": {"type": "rod", "length": 0.9, "area": 4e-4},
        },
        "rocker_body": {
            "link": "rocker",
            "density": 7200.0,
            "x": 0.35,
            "shape": {"type": "plate", "length": 0.9, "width": 0.15, "thickness": 0.02},
        },
        "disc_on_rocker": {"link": "rocker", "mass": 2.5, "x": 0.8, "shape": {"type": "disc", "diameter": 0.2}},
        "gear_body": {
            "link": "gear",
            "density": 7850.0,
            "x": 0.02,
            "shape": {"type": "disc", "diameter": 0.3, "thickness": 0.03},
        },
        "ring_on_ram": {
            "link": "ram",
            "density": 7850.0,
            "shape": {"type": "ring", "diameter": 0.2, "inner_diameter": 0.1, "thickness": 0.05},
        },
        "ring_on_link": {
            "link": "link",
            "mass": 0.7,
            "shape": {"type": "ring", "diameter": 0.1, "inner_diameter": 0.04},
        },
        "ram_body": {"link": "ram", "mass": 12.0, "x": 0.1, "y": 0.2},
    }


def forces() -> dict:
    """Every characteristic of a force, with every direction and limit."""
    stroke_table = {"type": "table", "slider": "ram", "on": "R", "angle": 0.25}
    return {
        "cut": {"type": "constant", "on": "R", "angle": 0.1, "turns_with": "ram", "acts": "along", "force": 900.0},
        "push": {"type": "constant", "on": "B", "angle": 0.4, "acts": "against", "force": -150.0},
        "follower": {"type": "constant", "on": "K", "angle": 1.0, "turns_with": "coupler", "force": 80.0},
        "rub": {"type": "against_motion", "on": "R", "force": 60.0},
        "rub_one_way": {"type": "against_motion", "on": "K", "angle": 0.3, "acts": "along", "force": 40.0},
        "oil": {"type": "linear_drag", "on": "E", "angle": 0.2, "turns_with": "link", "coefficient": 30.0},
        "air": {"type": "quadratic_drag", "on": "B", "coefficient": 12.0},
        "mud": {
            "type": "power_drag",
            "on": "K",
            "angle": -0.6,
            "acts": "against",
            "force": 50.0,
            "at_speed": 0.8,
            "exponent": 1.5,
        },
        "paste": {"type": "power_drag", "on": "R", "force": 35.0, "at_speed": 1.2, "exponent": 0.7},
        "by_guide": stroke_table
        | {
            "over_stroke": [0.9, 1.1, 1.3],
            "force": [100.0, -200.0, 50.0],
            "interpolation": "linear",
            "outside": "zero",
        },
        "from_low": stroke_table
        | {
            "over_stroke": [0.0, 0.1, 0.2, 0.5],
            "force": [10.0, 100.0, 150.0, 400.0],
            "interpolation": "pchip",
            "measured_from": "low end",
            "scale": 2.0,
        },
        "from_high": stroke_table
        | {
            "over_stroke": [-0.1, 0.1, 0.2, 0.5],
            "force": [40.0, 100.0, 20.0, 60.0],
            "interpolation": "spline",
            "measured_from": "high end",
            "acts": "along",
        },
        "by_angle": {
            "type": "table",
            "on": "B",
            "angle": 1.2,
            "over_angle": [0.5, 2.0, 4.0],
            "force": [50.0, 90.0, -30.0],
            "interpolation": "linear",
        },
    }


def actions() -> dict:
    """Forces, moments, springs and cylinders of all kinds but motors, and nothing over time: it has a cycle."""
    return {
        "forces": forces(),
        "moments": {
            "steady": {"type": "constant", "on": "rocker", "moment": -25.0, "acts": "against"},
            "motor": {"type": "constant", "on": "motor_shaft", "moment": 3.0, "role": "driving"},
            "brake": {"type": "against_motion", "on": "rocker", "moment": 8.0},
            "bearing": {"type": "linear_drag", "on": "fan", "coefficient": 0.4},
            "blades": {"type": "quadratic_drag", "on": "fan", "coefficient": 0.05, "acts": "along"},
            "screw": {"type": "power_drag", "on": "gear", "moment": 2.0, "at_speed": 3.0, "exponent": 2.3},
            "twist": {"type": "torsion_spring", "on": "rocker", "stiffness": 30.0, "free_angle": 1.2},
            "by_crank": {
                "type": "table",
                "on": "rocker",
                "over_angle": [0.0, 1.0, 3.0, 5.0],
                "moment": [5.0, 20.0, 10.0, 0.0],
                "interpolation": "linear",
                "acts": "along",
            },
        },
        "springs": {"coil": {"between": ["R", "T"], "stiffness": 400.0, "free_length": 0.8, "damping": 15.0}},
        "cylinders": {"pump": {"type": "pump", "piston": "ram", "bore": 0.08, "suction": 8e4, "discharge": 6e5}},
    }
