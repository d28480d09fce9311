"""Rules for flywheels: rim speed, stress, width, and whether there is a need for one at all."""

from collections.abc import Iterator

import numpy as np

from engine import elements
from engine.cycle.measured import Measured
from engine.parts.bodies import WheelForm
from engine.parts.regimes import RunRegime
from engine.scene.scene import Numbers, Scene
from engine.warnings.rule import Rule, limit_of

_WHEEL = "flywheel.wheel"


def _wheel_of(scene: Scene) -> WheelForm | None:
    """The flywheel's form, if its sizes can be computed."""
    flywheel = scene.flywheel
    return flywheel.wheel if flywheel is not None and flywheel.has_size and scene.has_cycle else None


def rim_speed_rules(scene: Scene) -> Iterator[Rule]:
    """Rim speed of a wheel of given diameter; without one the diameter follows from the limit."""
    form = _wheel_of(scene)
    if form is None or (form.diameter is None and form.mean_diameter is None):
        return
    given = form.rim_speed_limit is not None
    usual = elements.flywheel_wheels.MATERIALS[form.material].rim_speed_limit
    of = "rim_speed_limit" if given else f"the limit of {form.material}"

    def judge(n: Numbers, speed: Measured) -> tuple[object, object]:
        return speed, n[f"{_WHEEL}.rim_speed_limit"] if given else usual

    sentence = (
        f"rim speed {{value}} exceeds {{limit}}, {of}: the rim may burst; reduce the diameter or the speed, choose "
        "another material, or set rim_speed_limit if a strength calculation allows more"
    )
    yield Rule(_WHEEL, "above", "m s-1", sentence, judge, ("wheel_rim_speed",))


def hoop_stress_rules(scene: Scene) -> Iterator[Rule]:
    """Hoop stress in the rim against the strength of its material."""
    form = _wheel_of(scene)
    if form is None or form.strength is None:
        return
    sentence = (
        "hoop stress {value} exceeds strength = {limit}: the wheel bursts; reduce the diameter or the speed, or choose "
        "a stronger material"
    )
    yield Rule(
        _WHEEL, "above", "Pa", sentence, lambda n, stress: (stress, n[f"{_WHEEL}.strength"]), ("wheel_hoop_stress",)
    )


def rim_width_rules(scene: Scene) -> Iterator[Rule]:
    """Width of a rim or disc, where a flywheel is needed."""
    if _wheel_of(scene) is None:
        return

    def judge(n: Numbers, width: Measured, used: Measured) -> tuple[object, object]:
        return Measured(np.where(used.value > 0.0, width.value, np.nan), width.error), limit_of(scene, "rim_width", n)

    sentence = (
        "the rim is only {value} wide, below limits.rim_width = {limit}: a wheel of this diameter is hardly needed; "
        "reduce the diameter, or omit the flywheel"
    )
    yield Rule(_WHEEL, "below", "m", sentence, judge, ("wheel_width", "flywheel_used"))


def negative_flywheel_rules(scene: Scene) -> Iterator[Rule]:
    """Flywheel for a required speed fluctuation that the machine meets without one."""
    if scene.flywheel is None or scene.flywheel.speed_fluctuation is None or not scene.has_cycle:
        return
    sentence = (
        "the inertia for this speed_fluctuation is {value}, below {limit}: the machine runs evenly enough "
        "without a flywheel; omit it, or ask for less fluctuation"
    )
    yield Rule("flywheel", "below", "kg m2", sentence, lambda n, exact: (exact, 0.0), ("flywheel_wittenbauer",))


def flywheel_ratio_rules(scene: Scene) -> Iterator[Rule]:
    """Inertia of the flywheel over that of the machine."""
    flywheel = scene.flywheel
    if flywheel is None or not flywheel.has_size or not scene.has_cycle:
        return

    def judge(n: Numbers, used: Measured, machine: Measured) -> tuple[object, object]:
        # On a shaft that turns i times as fast, a wheel of 1/i² of the inertia serves.
        turns = 1.0 if flywheel.wheel is None else n[f"{_WHEEL}.ratio"]
        # A machine without masses has another warning.
        inertia = Measured(np.where(machine.value > 0.0, machine.value, np.nan), machine.error)
        return used / inertia / Measured(turns**2), limit_of(scene, "flywheel_ratio", n)

    sentence = (
        "its inertia, on its own shaft, is {value} times the mean reduced inertia of the machine, above "
        "limits.flywheel_ratio = {limit}; put it on a faster shaft (flywheel.wheel.ratio), or check masses, loads and "
        "speed_fluctuation"
    )
    yield Rule("flywheel", "above", "1", sentence, judge, ("flywheel_used", "reduced_inertia.mean"))


def run_flywheel_rules(scene: Scene) -> Iterator[Rule]:
    """Runs of a machine whose flywheel is sized for steady running only."""
    flywheel, runs = scene.flywheel, [n for n, regime in scene.regimes.items() if isinstance(regime, RunRegime)]
    sized = flywheel is not None and flywheel.inertia is None and flywheel.speed_fluctuation is not None
    if not (runs and sized and scene.has_cycle):
        return
    sentence = (
        f"{' and '.join(runs)} {'is' if len(runs) == 1 else 'are'} computed without the {{value}} that "
        "speed_fluctuation requires; to start and stop the real wheel, give it as flywheel.inertia"
    )
    yield Rule("flywheel", "above", "kg m2", sentence, lambda n, used: (used, 0.0), ("flywheel_used",))
