"""Random machines for the measurements of accuracy: structures with their loads, all numbers drawn at random.

Dimensions are drawn so that transmission angles from good to a few degrees occur; masses and loads vary over decades.
Machines that can't be assembled over the whole turn are drawn again.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine import Machine, Scene

SEED = 20_240_817
STATISTICS = ("min", "max", "mean", "rms", "min_at", "max_at")
CYCLE = ("required_drive_moment", "required_power", "excess_work", "speed_fluctuation", "speed_min", "speed_max")
ASKED = ("flywheel_excess_work", "flywheel_merzalov", "flywheel_wittenbauer", "excess_work_difference")
DYNAMIC = (
    "reduced_inertia",
    "reduced_inertia_phi",
    "reduced_moment",
    "input_moment",
    "input.reaction",
    "shaking_force",
)

Varied = dict[str, np.ndarray]


class Kind(NamedTuple):
    """A structure with its loads: the scene, how its numbers are drawn, fields and summaries to compare."""

    name: str
    scene: Scene
    draw: Callable[[np.random.Generator, int], Varied]
    fields: tuple[str, ...]
    summaries: tuple[str, ...]

    @property
    def asked(self) -> list[str]:
        """All summaries."""
        statistics = [f"{field}.{what}" for field in (*DYNAMIC, *self.fields) for what in STATISTICS]
        sizes = ASKED if self.scene.flywheel.speed_fluctuation is not None else ()
        orders = tuple(f"shaking_force.order_{n}" for n in (1, 2, 4))
        return [*statistics, *self.summaries, *CYCLE, *sizes, *orders]


def _uniform(low: float, high: float) -> Callable:
    return lambda random, count: random.uniform(low, high, count)


def _decades(low: float, high: float) -> Callable:
    return lambda random, count: low * (high / low) ** random.random(count)


def _drawn(**ranges: Callable) -> Callable:
    """Numbers of a scene drawn independently; `__` stands for the dot of a path."""

    def draw(random: np.random.Generator, count: int) -> Varied:
        return {path.replace("__", "."): draw_one(random, count) for path, draw_one in ranges.items()}

    return draw


def _bodies(**links: float) -> dict:
    """A body on each link, with its centre off the link's axis."""
    return {
        f"{link}_body": {"link": link, "mass": mass, "x": 0.05, "y": 0.01, "inertia": 0.01 * mass}
        for link, mass in links.items()
    }


def _body_ranges(*links: str) -> dict[str, Callable]:
    ranges = {}
    for link in links:
        at = f"bodies__{link}_body__"
        ranges |= {f"{at}mass": _decades(0.1, 10.0), f"{at}x": _uniform(-0.05, 0.15), f"{at}y": _uniform(-0.03, 0.03)}
        ranges |= {f"{at}inertia": _decades(1e-4, 0.1)}
    return ranges


COMMON = {"input__speed": lambda random, count: _decades(3.0, 100.0)(random, count) * random.choice([-1, 1], count)}
GIVEN = {"flywheel__inertia": _decades(0.3, 300.0)}
SIZED = {"flywheel__speed_fluctuation": _decades(0.003, 0.1)}


def _scene(points: dict, groups: dict, bodies: dict, sized: bool, **others: dict) -> Scene:
    drive = {"type": "crank", "pivot": "O", "pin": "A", "length": 0.05, "speed": 10.0}
    flywheel = {"speed_fluctuation": 0.02} if sized else {"inertia": 30.0}
    parts = {"points": {"O": {"x": 0, "y": 0}, **points}, "input": drive, "groups": groups, "bodies": bodies}
    return Scene.model_validate({"gravity": 9.81, **parts, "flywheel": flywheel, **others})


def _rrr(inner: str, first: str, joint: str, second: str, pivot: str, lengths: tuple[float, float]) -> dict:
    sides = ((first, joint, lengths[0]), (second, pivot, lengths[1]))
    one, two = ({"link": link, "joint": at, "length": length} for link, at, length in sides)
    return {"type": "RRR", "inner": inner, "first": one, "second": two}


def _rrp(inner: str, rod: str, joint: str, slider: str, length: float = 0.2) -> dict:
    second = {"link": slider, "guide": "way", "offset": 0.0}
    return {"type": "RRP", "inner": inner, "first": {"link": rod, "joint": joint, "length": length}, "second": second}


# Slider-cranks

SLIDER_CRANK = {
    "points": {},
    "groups": {"g": _rrp("B", "rod", "A", "ram")},
    "bodies": _bodies(crank=2.0, rod=1.0, ram=3.0),
    "guides": {"way": {"angle": 0.0}},
}
SLIDER_CRANK_RANGES = {
    **COMMON,
    "input__length": _uniform(0.04, 0.08),
    "guides__way__angle": _uniform(-3.0, 3.0),
    "groups__g__first__length": lambda random, count: 0.085 + _decades(1e-3, 0.3)(random, count),
    "groups__g__second__offset": _uniform(-0.03, 0.03),
    **_body_ranges("crank", "rod", "ram"),
}
SLIDER_CRANK_FIELDS = ("ram.velocity", "ram.acceleration", "g.inner.reaction", "g.second.reaction")
RAM = ("ram.stroke", "ram.stroke_low", "ram.stroke_high_at", "ram.stroke_time_ratio", "g.transmission_angle")


def _turning(count: int, amplitude: float) -> tuple[list[float], list[float]]:
    """A smooth torque over the crank angle, as rows of a table."""
    angles = [2 * math.pi * k / count for k in range(count)]
    return angles, [amplitude * (math.sin(a) + 0.4 * math.cos(2 * a + 1) - 0.2 * math.sin(3 * a)) for a in angles]


def _slider_crank(name: str, sized: bool, ranges: dict, **others: dict) -> Kind:
    parts = {**SLIDER_CRANK, **others, "points": {**SLIDER_CRANK["points"], **others.get("points", {})}}
    draw = _drawn(**SLIDER_CRANK_RANGES, **(SIZED if sized else GIVEN), **ranges)
    return Kind(name, _scene(sized=sized, **parts), draw, SLIDER_CRANK_FIELDS, RAM)


def _slider_cranks() -> list[Kind]:
    smooth, kinked = (_turning(12, 30.0), _turning(9, 30.0))
    spline = {"type": "table", "on": "crank", "over_angle": smooth[0], "moment": smooth[1], "interpolation": "spline"}
    line = {"type": "table", "on": "crank", "over_angle": kinked[0], "moment": kinked[1], "interpolation": "linear"}
    press = {"type": "table", "on": "B", "angle": 0.0, "slider": "ram", "measured_from": "high end"}
    press |= {"over_stroke": [0.0, 0.01, 0.02], "force": [800.0, 1000.0, 500.0], "interpolation": "linear"}
    press |= {"outside": "zero", "acts": "against"}
    gas = {"type": "compressor", "piston": "ram", "bore": 0.08, "clearance": 0.06, "suction": 1e5, "discharge": 7e5}
    return [
        _slider_crank(
            "slider-crank",
            True,
            {
                "springs__s__stiffness": _decades(100.0, 1e4),
                "springs__s__damping": _decades(1.0, 100.0),
                "forces__drag__coefficient": _decades(1.0, 100.0),
                "moments__torque__scale": _decades(0.1, 10.0),
            },
            points={"H": {"x": 0.1, "y": 0.4}},
            springs={"s": {"between": ("B", "H"), "stiffness": 1e3, "free_length": 0.2, "damping": 5.0}},
            forces={"drag": {"type": "linear_drag", "on": "A", "coefficient": 5.0}},
            moments={"torque": spline},
        ),
        _slider_crank(
            "press",
            True,
            {"forces__work__scale": _decades(0.1, 10.0), "forces__work__angle": _uniform(-3.0, 3.0)},
            forces={"work": press},
        ),
        _slider_crank(
            "compressor",
            True,
            {
                "cylinders__gas__bore": _uniform(0.04, 0.1),
                "cylinders__gas__clearance": _uniform(0.03, 0.15),
                "cylinders__gas__discharge": _uniform(2e5, 1e6),
            },
            cylinders={"gas": gas},
        ),
        _slider_crank(
            "turning moment", False, {"moments__torque__scale": _decades(0.1, 10.0)}, moments={"torque": line}
        ),
    ]


# Four-bars and six-bars

FOUR_BAR = {"g": _rrr("B", "rod", "A", "rocker", "D", (0.2, 0.15))}
FOUR_BAR_RANGES = {
    **COMMON,
    "input__length": _uniform(0.03, 0.06),
    "groups__g__first__length": _uniform(0.12, 0.3),
    "groups__g__second__length": _uniform(0.08, 0.25),
    "points__D__x": _uniform(0.1, 0.3),
    "points__D__y": _uniform(-0.1, 0.1),
    **_body_ranges("crank", "rod", "rocker"),
}
ROCKER = ("rocker.swing", "rocker.swing_low", "rocker.swing_high_at", "rocker.swing_time_ratio", "g.transmission_angle")


def _four_bars() -> list[Kind]:
    fields = ("B.x", "rocker.angular_velocity", "rocker.angular_acceleration", "g.inner.reaction")
    parts = {"groups": FOUR_BAR, "bodies": _bodies(crank=2.0, rod=1.0, rocker=3.0)}
    pivots = {"D": {"x": 0.22, "y": 0.01}, "H": {"x": -0.1, "y": 0.3}}
    drag = {"type": "linear_drag", "on": "rocker", "coefficient": 0.1}
    smooth = _scene(
        pivots,
        **parts,
        sized=True,
        moments={"drag": drag, "load": {"type": "constant", "on": "rocker", "moment": 5.0}},
        springs={"s": {"between": ("H", "B"), "stiffness": 500.0, "free_length": 0.2}},
    )
    rubbed = _scene(
        pivots, **parts, sized=False, moments={"rub": {"type": "against_motion", "on": "rocker", "moment": 5.0}}
    )
    loads = {
        "moments__drag__coefficient": _decades(0.01, 1.0),
        "moments__load__moment": _uniform(-20.0, 20.0),
        "springs__s__stiffness": _decades(50.0, 5e3),
    }
    rub = {"moments__rub__moment": _decades(0.3, 30.0)}
    return [
        Kind("crank-rocker", smooth, _drawn(**FOUR_BAR_RANGES, **SIZED, **loads), fields, ROCKER),
        Kind("rubbed crank-rocker", rubbed, _drawn(**FOUR_BAR_RANGES, **GIVEN, **rub), fields, ROCKER),
    ]


def _six_bars() -> list[Kind]:
    pivots = {"D": {"x": 0.18, "y": 0}, "G": {"x": 0.28, "y": 0.01}, "E": {"link": "rocker", "x": 0, "y": -0.18}}
    groups = FOUR_BAR | {"h": _rrr("F", "link", "E", "agitator", "G", (0.25, 0.15))}
    names = ("rod", "rocker", "link", "agitator")
    drag = {"type": "quadratic_drag", "on": "agitator", "coefficient": 0.06}
    watt = _scene(pivots, groups, _bodies(**dict.fromkeys(names, 1.0)), True, moments={"water": drag})
    watt_ranges = {
        "points__E__x": _uniform(-0.03, 0.03),
        "points__E__y": _uniform(-0.15, -0.08),
        "points__G__x": _uniform(0.25, 0.4),
        "points__G__y": _uniform(-0.1, 0.05),
        "groups__h__first__length": _uniform(0.15, 0.4),
        "groups__h__second__length": _uniform(0.1, 0.3),
        "moments__water__coefficient": _decades(0.001, 1.0),
    }
    four = {k: v for k, v in FOUR_BAR_RANGES.items() if "crank_body" not in k and "rod_body" not in k}
    knee = {"g": FOUR_BAR["g"] | {"mode": -1}, "h": _rrp("C", "lower", "B", "ram", 0.15)}
    coining = {"type": "table", "on": "C", "angle": 1.5, "slider": "ram", "measured_from": "high end"}
    coining |= {"over_stroke": [0.0, 0.004], "force": [400.0, 100.0], "interpolation": "linear", "outside": "zero"}
    toggle = _scene(
        {"D": {"x": 0.2, "y": 0.15}},
        knee,
        _bodies(rod=1.0, rocker=1.0, lower=1.0, ram=5.0),
        False,
        guides={"way": {"x": 0.2, "y": 0.1, "angle": -1.57}},
        forces={"work": coining | {"acts": "against"}},
    )
    toggle_ranges = {
        "guides__way__x": _uniform(0.15, 0.3),
        "guides__way__angle": _uniform(-2.2, -1.0),
        "groups__h__first__length": _uniform(0.1, 0.4),
        "forces__work__scale": _decades(0.1, 10.0),
    }
    return [
        Kind(
            "Watt six-bar",
            watt,
            _drawn(**four, **_body_ranges("link", "agitator"), **SIZED, **watt_ranges),
            ("F.x", "agitator.angular_velocity", "agitator.angular_acceleration", "g.inner.reaction"),
            ("agitator.swing", "agitator.swing_low", "agitator.swing_high_at", "h.transmission_angle"),
        ),
        Kind(
            "toggle press",
            toggle,
            _drawn(**four, **_body_ranges("lower", "ram"), **GIVEN, **toggle_ranges),
            ("C.x", "ram.velocity", "ram.acceleration", "h.second.reaction"),
            ("ram.stroke", "ram.stroke_high", "ram.stroke_low_at", "h.transmission_angle"),
        ),
    ]


def _quick_returns() -> list[Kind]:
    cutting = {"type": "table", "on": "B", "angle": 0.0, "slider": "ram", "measured_from": "low end"}
    cutting |= {"over_stroke": [0.015, 0.05], "force": [2e3, 2e3], "interpolation": "linear", "outside": "zero"}
    slot = {"type": "RPR", "first": {"link": "block", "joint": "A"}, "second": {"link": "lever", "joint": "D"}}
    shaper = _scene(
        {"D": {"x": 0, "y": -0.2}, "P": {"link": "lever", "x": 0.3, "y": 0}},
        {"q": slot, "g": _rrp("B", "drag_link", "P", "ram")},
        _bodies(block=1.0, lever=5.0, drag_link=1.0, ram=10.0),
        True,
        guides={"way": {"y": 0.1, "angle": 3.14}},
        forces={"cutting": cutting | {"acts": "against"}},
    )
    ranges = {
        "input__length": _uniform(0.04, 0.15),
        "points__D__y": _uniform(-0.3, -0.16),
        "points__P__x": _uniform(0.25, 0.35),
        "guides__way__y": _uniform(0.0, 0.2),
        "guides__way__angle": _uniform(2.9, 3.4),
        "groups__q__second__offset": _uniform(-0.02, 0.02),
        "groups__g__first__length": _uniform(0.15, 0.4),
        "forces__cutting__scale": _decades(0.01, 1.0),
    }
    bodies = _body_ranges("block", "lever", "drag_link", "ram")
    yoke = _scene(
        {},
        {
            "g": {
                "type": "RPP",
                "first": {"link": "block", "joint": "A"},
                "second": {"link": "yoke", "guide": "way", "slot_angle": 1.57},
            }
        },
        _bodies(crank=2.0, block=1.0, yoke=5.0),
        False,
        guides={"way": {"angle": 0.0}},
        cylinders={"water": {"type": "pump", "piston": "yoke", "bore": 0.05, "suction": 5e4, "discharge": 5e5}},
    )
    yoke_ranges = {
        "input__length": _uniform(0.03, 0.1),
        "guides__way__angle": _uniform(-3.0, 3.0),
        "groups__g__second__slot_angle": _uniform(0.3, 2.8),
        "cylinders__water__bore": _uniform(0.02, 0.08),
        "cylinders__water__discharge": _decades(2e5, 2e6),
    }
    return [
        Kind(
            "crank shaper",
            shaper,
            _drawn(**COMMON, **SIZED, **ranges, **bodies),
            ("ram.velocity", "ram.acceleration", "q.inner.reaction", "g.inner.reaction"),
            (
                "ram.stroke",
                "ram.stroke_low_at",
                "ram.stroke_time_ratio",
                "q.transmission_angle",
                "g.transmission_angle",
            ),
        ),
        Kind(
            "Scotch yoke",
            yoke,
            _drawn(**COMMON, **GIVEN, **yoke_ranges, **_body_ranges("crank", "block", "yoke")),
            ("yoke.velocity", "yoke.acceleration", "g.inner.reaction", "g.second.reaction"),
            ("yoke.stroke", "yoke.stroke_low", "yoke.stroke_high_at", "yoke.stroke_time_ratio"),
        ),
    ]


def _swinging_blocks() -> list[Kind]:
    block = {"type": "RPR", "first": {"link": "block", "joint": "D"}, "second": {"link": "rod", "joint": "A"}}
    drag = {"type": "linear_drag", "on": "rod", "coefficient": 0.1}
    scene = _scene(
        {"D": {"x": 0.2, "y": 0.01}}, {"q": block}, _bodies(crank=2.0, rod=1.0, block=3.0), True, moments={"drag": drag}
    )
    ranges = {
        "input__length": _uniform(0.03, 0.06),
        "points__D__x": _uniform(0.07, 0.3),
        "points__D__y": _uniform(-0.1, 0.1),
        "groups__q__second__offset": _uniform(-0.02, 0.02),
        "moments__drag__coefficient": _decades(0.001, 0.1),
    }
    return [
        Kind(
            "swinging block",
            scene,
            _drawn(**COMMON, **SIZED, **ranges, **_body_ranges("crank", "rod", "block")),
            ("rod.angular_velocity", "rod.angular_acceleration", "q.inner.reaction"),
            ("q.transmission_angle",),
        )
    ]


def kinds() -> list[Kind]:
    """The structures."""
    return [*_slider_cranks(), *_four_bars(), *_six_bars(), *_quick_returns(), *_swinging_blocks()]


def translated(scene: Scene, varied: Varied, distance: np.ndarray) -> Varied:
    """The same machines with all points and guides of the frame moved, each machine by its distance [m]."""
    found = dict(varied)
    for kind, parts in (("points", scene.points), ("guides", scene.guides)):
        for name, part in parts.items():
            for axis in "xy" if part.link == "frame" else "":
                path = f"{kind}.{name}.{axis}"
                found[path] = varied.get(path, np.full(varied["input.length"].size, getattr(part, axis))) + distance
    return found


def machines(kind: Kind, count: int, seed: int = SEED) -> Varied:
    """Numbers of machines that can be assembled over the whole turn and run through the cycle."""
    random = np.random.default_rng([seed, *kind.name.encode()])
    found: Varied = {}
    asked = [f"{g}.transmission_angle" for g in kind.scene.groups] + ["speed_fluctuation"]
    while not found or next(iter(found.values())).size < count:
        drawn = kind.draw(random, 4 * count)
        works = Machine(kind.scene, asked, varied=list(drawn)).evaluate(drawn).status == 0
        found = {path: np.append(found.get(path, []), values[works]) for path, values in drawn.items()}
    return {path: values[:count] for path, values in found.items()}
