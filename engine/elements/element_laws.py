"""What is computed of each kind of machine element: its scalar law, and what the law is given and gives.

A law takes the numbers of one element and gives all of its results, in the order of its `results`. An infinite
result means that friction jams: no force or moment moves the element.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.compiling.decorators import scalar
from engine.elements.element_models import BeltElement, GuideElement, MachineElement, ScrewElement
from engine.laws.brakes import axle_shares
from engine.laws.friction.belts import (
    belt_moment,
    centrifugal_tension,
    gripped_share,
    shaft_force,
    slack_share,
    speed_of_most_power,
    tension_ratio,
    tight_tension,
)
from engine.laws.friction.coefficients import NEW, WORN_IN
from engine.laws.friction.guides import (
    edge_forces,
    jamming_overhang,
    overhung_drive,
    slider_friction,
    tilts,
    vee_friction,
)
from engine.laws.friction.inclines import incline_down, incline_up, self_locking, wedge_drive, wedge_withdraw
from engine.laws.friction.journals import friction_circle, journal_moment
from engine.laws.friction.rolling import pull, reduced_friction, reduced_radius, rollers_moment, rolling_moment, rolls
from engine.laws.friction.screws import (
    collar_moment,
    flank_friction,
    locking_friction,
    lower_efficiency,
    lower_moment,
    raise_efficiency,
    raise_moment,
    thread_slope,
)
from engine.laws.rounding import NUDGE
from engine.verdicts import Verdict

THREAD_ANGLES = {"square": 0.0, "trapezoidal": math.radians(30.0), "metric": math.radians(60.0)}
BUSHES = {"line": 1.0, "new": NEW, "worn in": WORN_IN, "half-round, new": NEW, "half-round, worn in": WORN_IN}

Given = Callable[[str], float | np.ndarray]

# A relative change of a number that is large against rounding and small against what laws curve over.
# Roundings of a result's size that an error figure is made of.
ROUNDING = 16


class ElementResult(NamedTuple):
    """A result of a law: its name, meaning and unit, the key it needs to be given, whether it may have no value.

    One that is `exact` says yes or no and has no error figure.
    """

    name: str
    long_name: str
    units: str
    needs: str | None = None
    may_be_undefined: bool = False
    exact: bool = False


class ElementLaw(NamedTuple):
    """The law of a kind of element.

    Attributes
    ----------
    function : callable
        A compiled scalar law.
    arguments : callable
        Its arguments, from the element and its numbers by their keys.
    results : tuple of ElementResult
    """

    function: Callable
    arguments: Callable[[MachineElement, Given], tuple]
    results: tuple[ElementResult, ...]


class LawOfArrays(NamedTuple):
    """The law of an element that is no scalar one.

    Attributes
    ----------
    function : callable
        From the numbers of all variants (numbers, variants) it gives their results (results, variants) and, of the same
        shape, the magnitudes whose rounding these carry, that of the numbers with it; and verdicts (variants,) where
        the law judges variants itself.
    arguments, results
        As for `ElementLaw`.
    block : int
        For how many variants at a time it is called.
    infinite : Verdict
        On a variant with an infinite result.
    """

    function: Callable[[np.ndarray], tuple[np.ndarray, ...]]
    arguments: Callable[[MachineElement, Given], tuple]
    results: tuple[ElementResult, ...]
    block: int = 2048
    infinite: Verdict = Verdict.JAMS


def with_nudges(values: Callable[[np.ndarray], np.ndarray]) -> Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]:
    """A law's results with the magnitudes whose rounding they carry, found by changing its numbers a little, in turn.

    Parameters
    ----------
    values : callable
        Results (results, variants) from numbers (numbers, variants).
    """

    def both(numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        count, variants = numbers.shape
        # All at once, as further variants: first those that stay as they are.
        every = np.repeat(numbers[:, None, :], count + 1, axis=1)
        k = np.arange(count)
        every[k, k + 1] *= 1.0 + NUDGE
        found = values(every.reshape(count, -1)).reshape(-1, count + 1, variants)
        rows = found[:, 0]
        with np.errstate(invalid="ignore"):
            moved = np.abs(found[:, 1:] - rows[:, None])
        moved = np.where(np.isnan(moved), math.inf, moved).sum(axis=1)
        return rows, np.abs(rows) + moved / (NUDGE * ROUNDING)

    return both


@scalar
def screw(
    load: float, diameter: float, lead: float, angle: float, friction: float, collar_diameter: float, collar: float
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """Screw with its thrust collar: results as listed in `LAWS`."""
    radius, collar_radius, slope = diameter / 2, collar_diameter / 2, thread_slope(lead, diameter)
    reduced = flank_friction(friction, angle / 2)
    held = collar_moment(load, collar_radius, collar)
    up = raise_moment(load, radius, slope, reduced) + held
    down = lower_moment(load, radius, slope, reduced) + held
    return (
        math.atan(slope),
        math.atan(reduced),
        up,
        down,
        held,
        raise_efficiency(load, radius, slope, up),
        lower_efficiency(load, radius, slope, down),
        0.0 if down < 0.0 else 1.0,
        locking_friction(radius, slope, angle / 2, collar_radius, collar),
    )


@scalar
def belt(
    diameter: float, wrap: float, friction: float, groove: float, tension: float, moment: float, q: float, speed: float
) -> tuple[float, float, float, float, float, float, float, float]:
    """Belt of a given tension, or moment where the tension is NaN: results as listed in `LAWS`."""
    radius, reduced = diameter / 2, vee_friction(friction, groove / 2)
    centrifugal = centrifugal_tension(q, speed)
    tight = tight_tension(moment, centrifugal, reduced, wrap, radius) if math.isnan(tension) else tension
    carried = belt_moment(tight, centrifugal, reduced, wrap, radius)
    pressing = max(tight - centrifugal, 0.0)
    slack = pressing * slack_share(reduced, wrap)
    return (
        tension_ratio(reduced, wrap),
        tight,
        tight - pressing * gripped_share(reduced, wrap),
        carried,
        shaft_force(pressing, slack, wrap),
        carried / radius * speed,
        centrifugal,
        speed_of_most_power(tight, q),
    )


@scalar
def wedge(load: float, angle: float, friction: float, base: float, guide: float) -> tuple[float, float, float, float]:
    """Wedge: results as listed in `LAWS`."""
    slope = math.tan(angle)
    drive, withdraw = (
        wedge_drive(load, slope, friction, base, guide),
        wedge_withdraw(load, slope, friction, base, guide),
    )
    return drive, withdraw, load * slope / drive, 0.0 if withdraw < 0.0 else 1.0


@scalar
def incline(
    load: float, angle: float, friction: float, static: float, pull_angle: float
) -> tuple[float, float, float, float, float, float]:
    """Incline: results as listed in `LAWS`."""
    up = incline_up(load, angle, friction, pull_angle)
    return (
        math.atan(friction),
        up,
        incline_up(load, angle, static, pull_angle),
        incline_down(load, angle, friction, pull_angle),
        load * math.sin(angle) / (up * math.cos(pull_angle)),
        self_locking(math.tan(angle), static),
    )


@scalar
def journal(load: float, diameter: float, friction: float, factor: float, speed: float) -> tuple[float, float, float]:
    """Journal: results as listed in `LAWS`."""
    moment = journal_moment(load, diameter / 2, friction, factor)
    return friction_circle(diameter / 2, friction, factor), moment, moment * abs(speed)


@scalar
def guide(
    load: float, resistance: float, overhang: float, length: float, friction: float, vee: float, factor: float
) -> tuple[float, float, float, float, float, float, float, float]:
    """Slider on its guide: results as listed in `LAWS`."""
    half, reduced = length / 2, factor * vee_friction(friction, vee / 2)
    drive = overhung_drive(resistance, load, overhang, half, reduced)
    front, rear = edge_forces(load, drive * overhang, half)
    return (
        reduced,
        drive,
        slider_friction(load, drive * overhang, half, reduced),
        front,
        rear,
        tilts(load, drive * overhang, half),
        jamming_overhang(half, reduced),
        resistance / drive,
    )


@scalar
def roller(
    load: float, diameter: float, arm: float, friction: float, height: float, mate: float
) -> tuple[float, float, float, float, float, float, float]:
    """Roller on a plane or on a second roller: results as listed in `LAWS`."""
    radius = diameter / 2
    return (
        rolling_moment(load, arm),
        reduced_friction(arm, height),
        pull(load, arm, height, friction),
        rolls(arm, height, friction),
        friction * load * radius,
        reduced_radius(radius, mate / 2),
        rollers_moment(load, arm, radius, mate / 2),
    )


@scalar
def car(
    speed: float, front: float, rear: float, base: float, behind: float, h: float, slope: float, delay: float, g: float
) -> tuple[float, float, float, float]:
    """Braking car: results as listed in `LAWS`; NaN for one that doesn't come to rest."""
    on_front, on_rear = axle_shares(base, behind, h, front, rear)
    held = g * (math.cos(slope) * (front * on_front + rear * on_rear) + math.sin(slope))
    slowing = held if held > 0.0 else math.nan
    return slowing, speed * delay + speed * speed / (2 * slowing), delay + speed / slowing, on_front


def _screw_arguments(element: ScrewElement, given: Given) -> tuple:
    angle = given("thread_angle") if element.thread is None else THREAD_ANGLES[element.thread]
    keys = ("friction", "collar_diameter", "collar_friction")
    return given("load"), given("mean_diameter"), given("pitch") * element.starts, angle, *(given(k) for k in keys)


def _belt_arguments(element: BeltElement, given: Given) -> tuple:
    usual = {"groove_angle": math.pi, "tension": math.nan, "moment": math.nan, "linear_density": 0.0, "speed": 0.0}
    others = (usual[k] if getattr(element, k) is None else given(k) for k in usual)
    return given("diameter"), given("wrap"), given("friction"), *others


def _guide_arguments(element: GuideElement, given: Given) -> tuple:
    numbers = (given(k) for k in ("load", "resistance", "overhang", "length", "friction"))
    return *numbers, _or(element, given, "vee_angle", math.pi), BUSHES.get(element.form, 1.0)


def _flag(name: str, words: str) -> ElementResult:
    return ElementResult(name, f"whether {words}", "1", exact=True)


def _or(element: MachineElement, given: Given, key: str, other: float | np.ndarray) -> float | np.ndarray:
    return other if getattr(element, key) is None else given(key)


LAWS = {
    "screw": ElementLaw(
        screw,
        _screw_arguments,
        (
            ElementResult("lead_angle", "lead angle of the thread", "rad"),
            ElementResult(
                "friction_angle", "angle of friction of the thread, with the inclination of its flanks", "rad"
            ),
            ElementResult("raise_moment", "moment that raises the load", "N m"),
            ElementResult("lower_moment", "moment that lowers the load, negative where the load drives", "N m"),
            ElementResult("collar_moment", "moment of friction at the thrust collar", "N m"),
            ElementResult("raise_efficiency", "efficiency of raising the load", "1"),
            ElementResult("lower_efficiency", "share of the sinking load's work that the screw passes on", "1"),
            _flag("self_locking", "the load stays by itself (1 or 0)"),
            ElementResult("locking_friction", "least coefficient of friction with which the load stays by itself", "1"),
        ),
    ),
    "car": ElementLaw(
        car,
        lambda e, given: (
            given("speed"),
            *(given("friction") if e.brakes in (axle, "all") else 0.0 for axle in ("front", "rear")),
            *(given(k) for k in ("wheelbase", "rear_distance", "height", "slope", "reaction_time", "gravity")),
        ),
        (
            ElementResult("deceleration", "greatest deceleration of the braking car", "m s-2"),
            ElementResult("stopping_distance", "way to rest, that of the reaction time with it", "m"),
            ElementResult("stopping_time", "time to rest, the reaction time with it", "s"),
            ElementResult("front_share", "share of the load on the road that the front wheels bear", "1"),
        ),
    ),
    "belt": ElementLaw(
        belt,
        _belt_arguments,
        (
            ElementResult(
                "tension_ratio", "tension of the tight strand over the slack one's, without centrifugal", "1"
            ),
            ElementResult("tight_tension", "tension of the tight strand", "N"),
            ElementResult("slack_tension", "tension of the slack strand", "N"),
            ElementResult("moment", "greatest moment without slip", "N m"),
            ElementResult("shaft_force", "force of the belt on the shaft", "N"),
            ElementResult("power", "greatest power without slip", "W", "speed"),
            ElementResult("centrifugal_tension", "tension that keeps the belt on its circle", "N", "linear_density"),
            ElementResult("speed_of_most_power", "speed of most power at this tension", "m s-1", "linear_density"),
        ),
    ),
    "wedge": ElementLaw(
        wedge,
        lambda e, given: (
            *(given(k) for k in ("load", "angle", "friction")),
            _or(e, given, "base_friction", given("friction")),
            given("guide_friction"),
        ),
        (
            ElementResult("drive_force", "force that drives the wedge in", "N"),
            ElementResult(
                "withdraw_force", "force that withdraws the wedge, negative where the load presses it out", "N"
            ),
            ElementResult("efficiency", "efficiency of driving the wedge in", "1"),
            _flag("self_locking", "the wedge stays by itself (1 or 0)"),
        ),
    ),
    "incline": ElementLaw(
        incline,
        lambda e, given: (
            *(given(k) for k in ("load", "angle", "friction")),
            _or(e, given, "static_friction", given("friction")),
            given("pull_angle"),
        ),
        (
            ElementResult("friction_angle", "angle of friction", "rad"),
            ElementResult("up_force", "force that moves the load up", "N"),
            ElementResult("start_force", "force that sets the load going upwards", "N"),
            ElementResult("down_force", "force that moves the load down, negative where it has to be held", "N"),
            ElementResult("efficiency", "efficiency of moving the load up", "1", may_be_undefined=True),
            _flag("self_locking", "the load stays by itself (1 or 0)"),
        ),
    ),
    "journal": ElementLaw(
        journal,
        lambda e, given: (
            *(given(k) for k in ("load", "diameter", "friction")),
            BUSHES[e.contact],
            _or(e, given, "speed", 0.0),
        ),
        (
            ElementResult("friction_circle", "radius of the friction circle", "m"),
            ElementResult("friction_moment", "moment of friction in the journal", "N m"),
            ElementResult("friction_power", "power lost in the journal", "W", "speed"),
        ),
    ),
    "guide": ElementLaw(
        guide,
        _guide_arguments,
        (
            ElementResult(
                "effective_friction", "coefficient of friction in terms of the force that presses the slider", "1"
            ),
            ElementResult("drive_force", "force that moves the slider", "N"),
            ElementResult("friction_force", "friction of the slider", "N"),
            ElementResult("front_edge_force", "force on the front edge of the slider", "N"),
            ElementResult(
                "rear_edge_force", "force on the rear edge of the slider, negative on the opposite face", "N"
            ),
            _flag("tilts", "the slider bears on opposite faces of the guide (1 or 0)"),
            ElementResult("jamming_overhang", "overhang at which the slider jams", "m", may_be_undefined=True),
            ElementResult("efficiency", "work on the resistance over that of the force that moves the slider", "1"),
        ),
    ),
    "roller": ElementLaw(
        roller,
        lambda e, given: (
            *(given(k) for k in ("load", "diameter", "rolling_arm", "friction")),
            _or(e, given, "pull_height", given("diameter") / 2),
            _or(e, given, "mate_diameter", math.inf),
        ),
        (
            ElementResult("rolling_moment", "moment of rolling friction", "N m"),
            ElementResult("rolling_friction", "rolling friction as a coefficient", "1"),
            ElementResult("pull_force", "force that moves the roller", "N"),
            _flag("rolls", "the pulled roller rolls (1) or slides (0)"),
            ElementResult("traction_moment", "greatest moment that sliding friction passes on", "N m"),
            ElementResult(
                "reduced_radius", "radius of the roller on a plane that fits as closely", "m", "mate_diameter"
            ),
            ElementResult(
                "drive_moment", "moment that overcomes the rolling friction of both rollers", "N m", "mate_diameter"
            ),
        ),
    ),
}
