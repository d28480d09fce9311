"""Rules for what acts on a machine: cylinders, windows of loads, motors, friction."""

from collections.abc import Iterator

import numpy as np

from engine import laws, mechanism
from engine.cycle.measured import Measured
from engine.laws.rounding import LEAST_NORMAL
from engine.parts.actions import Tabled
from engine.parts.formulas.by_formula import ByFormula
from engine.parts.motors import Motor
from engine.parts.skeleton import CrankInput
from engine.scene.scene import Numbers, Scene, scene_numbers
from engine.units.display import quantity_text
from engine.warnings.rule import Rule, limit_of

# Tables with friction coefficients, and their key.
_RUBBING = (("friction", "coefficient"), ("moments", "friction"), ("elements", "friction"))


def clearance_rules(scene: Scene) -> Iterator[Rule]:
    """Clearance volumes of cylinders."""
    for path in scene_numbers(scene):
        if path.startswith("cylinders.") and path.endswith(".clearance"):
            sentence = "{value} of the swept volume exceeds limits.clearance = {limit}; is it a percentage?"
            yield Rule(path, "above", "%", sentence, lambda n, path=path: (n[path], limit_of(scene, "clearance", n)))


def discharge_rules(scene: Scene) -> Iterator[Rule]:
    """Compressors whose clearance is too large to reach the discharge pressure."""
    for name, cylinder in scene.cylinders.items():
        if cylinder.type == "compressor":
            sentence = (
                "compression ends at {value}, below discharge = {limit}: the valve never opens, and nothing is "
                "delivered; reduce clearance or discharge"
            )
            yield Rule(f"cylinders.{name}", "below", "Pa", sentence, _compressed(f"cylinders.{name}"))


def _compressed(at: str) -> object:
    def judge(n: Numbers) -> tuple[object, object]:
        numbers = (n[f"{at}.{key}"] for key in ("clearance", "suction", "discharge", "n_compression"))
        return laws.indicator_diagrams.compressor_peak(*numbers), n[f"{at}.discharge"]

    return judge


def suction_rules(scene: Scene) -> Iterator[Rule]:
    """Pumps that the liquid drives."""
    for name, cylinder in scene.cylinders.items():
        if cylinder.type == "pump":
            at = f"cylinders.{name}"
            sentence = "suction = {value} exceeds discharge = {limit}: the liquid drives the machine; is this intended?"
            yield Rule(at, "above", "Pa", sentence, lambda n, at=at: (n[f"{at}.suction"], n[f"{at}.discharge"]))


def friction_rules(scene: Scene) -> Iterator[Rule]:
    """Coefficients of dry friction above those of technical materials."""
    numbers = scene_numbers(scene)
    for table, key in _RUBBING:
        for name in getattr(scene, table):
            path = f"{table}.{name}.{key}"
            # The friction of some elements is a force.
            if path in numbers and numbers[path].dimension == "number":
                sentence = "{value} exceeds limits.friction = {limit}; is it a percentage?"
                yield Rule(path, "above", "1", sentence, lambda n, path=path: (n[path], limit_of(scene, "friction", n)))


def loose_belt_rules(scene: Scene) -> Iterator[Rule]:
    """Belts whose centrifugal tension is all their tension."""
    for name, belt in scene.elements.items():
        if belt.type == "belt" and belt.gives("tension", "linear_density") == ["tension", "linear_density"]:
            sentence = (
                "its centrifugal tension of {value} uses up its tension of {limit}: it transmits no torque; tighten "
                "it, or lower the speed"
            )

            def judge(n: Numbers, at: str = f"elements.{name}") -> tuple[object, object]:
                return n[f"{at}.linear_density"] * n[f"{at}.speed"] ** 2, n[f"{at}.tension"]

            yield Rule(f"elements.{name}", "above", "N", sentence, judge)


def unused_load_rules(scene: Scene) -> Iterator[Rule]:
    """Loads by a table whose rows the machine never reaches, and loads by a formula that vanish everywhere."""
    for table in ("forces", "moments"):
        for name, action in getattr(scene, table).items():
            if isinstance(action, Tabled) and action.over_time is None:
                yield _of_window(scene, f"{table}.{name}", action)
            elif isinstance(action, ByFormula):
                sentence = (
                    "its peak, reduced to the input, is {value}: it does no work anywhere in the cycle; check its "
                    "formula, its point and its direction"
                )
                unit = "N m" if isinstance(scene.input, CrankInput) else "N"
                yield Rule(f"{table}.{name}", "below", unit, sentence, _vanishing, (f"{name}.moment.peak",))


def _vanishing(n: Numbers, peak: Measured) -> tuple[object, object]:
    """A peak minus its error estimate: 0 for a load that vanishes."""
    return np.maximum(peak.value - peak.error, 0.0), LEAST_NORMAL


def _of_window(scene: Scene, at: str, action: Tabled) -> Rule:
    """By how much the machine misses the part of a table that isn't zero."""
    rows, values = np.array(action.abscissae), np.array(action.ordinates)
    acting = np.flatnonzero(values)
    if not acting.size:
        return Rule(at, "below", "1", "all of its rows are {value}: the load never acts", lambda n: (0.0, LEAST_NORMAL))
    # Between a row of 0 and one of another value the load acts.
    shown = rows[max(acting[0] - 1, 0)], rows[min(acting[-1] + 1, rows.size - 1)]
    held = action.outside == "hold"
    begin = -np.inf if held and values[0] != 0.0 else shown[0]
    end = np.inf if held and values[-1] != 0.0 else shown[1]

    def missed(low: Measured, high: Measured) -> tuple[object, object]:
        """Distance between the motion and the window; negative where it enters."""
        return Measured(np.maximum(begin - high.value, low.value - end), low.error + high.error), 0.0

    def over_stroke(n: Numbers, low: Measured, high: Measured) -> tuple[object, object]:
        return missed(low, high) if action.measured_from == "guide" else missed(Measured(0.0), high - low)

    def over_angle(n: Numbers) -> tuple[object, object]:
        # Over a cycle tables repeat.
        drive = scene.input
        ends = (-np.inf, np.inf) if getattr(drive, "start", None) is None else (drive.start, drive.stop)
        return missed(*map(Measured, ends))

    unit = "rad" if action.slider is None else "m"
    window = " … ".join(quantity_text(place, unit) for place in shown)
    if action.slider is None:
        sentence = f"the crank misses its rows, {window}, by {{value}}: the load never acts; check input.start and stop"
        return Rule(at, "above", unit, sentence, over_angle)
    start = "its guide's point" if action.measured_from == "guide" else f"the {action.measured_from} of its stroke"
    sentence = (
        f"{action.slider} misses its rows, {window} from {start}, by {{value}}: the load never acts; move the rows, or "
        "change the stroke"
    )
    reads = (f"{action.slider}.stroke_low", f"{action.slider}.stroke_high")
    return Rule(at, "above", unit, sentence, over_stroke, reads)


def motor_rules(scene: Scene) -> Iterator[Rule]:
    """Rms torque of the motor in steady running against its rated torque, at its own shaft."""
    for regime, settings in scene.regimes.items():
        running = {n: m for n, m in scene.moments.items() if isinstance(m, Motor) and n not in settings.off}
        rated = [name for name, motor in running.items() if getattr(motor, "rated_speed", None) is not None]
        if settings.type != "steady" or len(running) != 1 or not rated:
            continue
        name, at = rated[0], f"moments.{rated[0]}"

        def judge(n: Numbers, rms: Measured, name: str = name, at: str = at) -> tuple[object, object]:
            ratio = np.abs(mechanism.actions.motors.motor_ratio(scene, scene.moments[name], n))
            return rms / Measured(ratio), n[f"{at}.power"] / n[f"{at}.rated_speed"]

        sentence = (
            f"rms torque {{value}} in {regime} exceeds the rated torque {{limit}}: the motor overheats; choose a "
            "larger motor, a heavier flywheel, or less load"
        )
        yield Rule(at, "above", "N m", sentence, judge, (f"{regime}.motor_moment_rms",))
