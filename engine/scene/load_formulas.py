"""Names that the formulas of a scene's loads may use, and checks of these formulas.

A formula may use

- its own numbers, given in the same table;
- `phi`, the crank angle within a cycle, starting at 0; `t`, the time;
- `v`, the velocity of a force's point along the force; `omega`, the angular velocity of the link on which a moment
  acts, or, in a force, of the crank;
- the motion of points, links and sliders: `A.x`, `A.y`, `A.vx`, `A.vy`; `rod.angle` in (−π, π], `rod.angular_velocity`;
  `ram.slide`, `ram.velocity`;
- the stroke of a slider and its ends, `ram.stroke`, `ram.stroke_low`, `ram.stroke_high`, and the distances from these
  ends, `ram.from_low`, `ram.from_high`;
- numbers of the scene by their paths, such as `input.length`.
"""

import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from engine import parts
from engine.parts.actions import FormulaForce, FormulaMoment
from engine.parts.formulas.expressions import (
    ExpressionError,
    TextExpression,
    TextOperation,
    Tree,
    evaluate_tree,
    names_in_tree,
    parse,
    pointed_out,
)
from engine.parts.regimes import RunRegime
from engine.parts.skeleton import FRAME, CrankInput
from engine.scene.attachments import sliders
from engine.scene.names import definitions
from engine.scene.scene import Numbers, Problem, Scene, scene_numbers
from engine.units.dimensions import Powers, described
from engine.units.reading import UNIT_NAMES, any_quantity, dimension_of_unit
from engine.words.glossary import unknown_name_message

TIME = "t"
# Why steady running and closed cycles are impossible under a time-dependent load.
NOTHING_REPEATS = "no motion is periodic"
# Velocities, which are proportional to the input speed.
_RATES = {"v", "omega", "vx", "vy", "velocity", "angular_velocity"}
OF_POINT = {"x": "m", "y": "m", "vx": "m s-1", "vy": "m s-1"}
_OF_LINK = {"angle": "rad", "angular_velocity": "rad s-1"}
OF_SLIDER = {"slide": "m", "velocity": "m s-1", "stroke": "m", "stroke_low": "m", "stroke_high": "m"}
OF_SLIDER |= {"from_low": "m", "from_high": "m"}
# Number of random sets of values of which at least one must give a finite result.
_DRAWS = 32
# Accelerations are results of the loads, so formulas can't use them.
_ACCELERATIONS = {"ax", "ay", "acceleration", "angular_acceleration"}


class LoadFormula(NamedTuple):
    """A formula of a scene.

    Attributes
    ----------
    action : FormulaForce or FormulaMoment
    at : str
        Path of the action in the scene.
    """

    action: FormulaForce | FormulaMoment
    at: str

    @property
    def key(self) -> str:
        """Path of the formula's text."""
        return f"{self.at}.{'force' if isinstance(self.action, FormulaForce) else 'moment'}"

    @property
    def expression(self) -> TextExpression:
        """The parsed formula."""
        text = self.action.force if isinstance(self.action, FormulaForce) else self.action.moment
        return parse(text, any_quantity)

    @property
    def velocities(self) -> set[str]:
        """Names in the formula that are velocities."""
        names = set(self.expression.names) - set(self.action.numbers)
        return {name for name in names if name.rpartition(".")[2] in _RATES}

    @property
    def depends_on_time(self) -> bool:
        """Whether the formula names the time."""
        return TIME in self.expression.names

    def switching_times(self, numbers: Numbers) -> list[float | np.ndarray]:
        """Times at which the formula switches because the time passes a per-variant number [s]."""
        known = {path: numbers[path] for path in numbers}
        known |= {name: numbers[f"{self.at}.numbers.{name}"] for name in self.action.numbers}
        found, switching = [], parts.formulas.switching
        for tree in switching.operations(self.expression.tree):
            for one, other in switching.compared(tree):
                for passing, passed in ((one, other), (other, one)):
                    if passing == TIME and known.keys() >= names_in_tree(passed).keys():
                        with np.errstate(all="ignore"):
                            found.append(evaluate_tree(passed, known))
        return found


def load_formulas(scene: Scene) -> dict[str, LoadFormula]:
    """The formulas of a scene, by the names of their loads."""
    tables = (("forces", scene.forces), ("moments", scene.moments))
    return {
        name: LoadFormula(action, f"{table}.{name}")
        for table, actions in tables
        for name, action in actions.items()
        if isinstance(action, (FormulaForce, FormulaMoment))
    }


def time_dependent(scene: Scene) -> list[str]:
    """Forces and moments that depend on time, by table or formula."""
    tables = {**scene.forces, **scene.moments}.items()
    tabled = [name for name, action in tables if getattr(action, "over_time", None) is not None]
    return tabled + [name for name, formula in load_formulas(scene).items() if formula.depends_on_time]


def units_of_names(scene: Scene, formula: LoadFormula) -> dict[str, str]:
    """SI units of all names that a formula may use, simplest names first."""
    crank = isinstance(scene.input, CrankInput)
    force = isinstance(formula.action, FormulaForce)
    units = {name: described(number.dimension).unit for name, number in formula.action.numbers.items()}
    units |= {"phi": "rad"} if crank else {}
    units |= {"v": "m s-1"} if force else {}
    units |= {"omega": "rad s-1"} if crank or not force else {}
    units |= {TIME: "s"}
    points, _, links = definitions(scene)
    moving = [name for name in points if name not in scene.points or scene.points[name].link != FRAME]
    kinds = ((moving, OF_POINT), (set(links) - {FRAME}, _OF_LINK), (sliders(scene), OF_SLIDER))
    for names, of in kinds:
        units |= {f"{name}.{quantity}": unit for name in sorted(names) for quantity, unit in of.items()}
    for name, shaft in scene.shafts.items():
        if shaft.pivot is None:
            del units[f"{name}.angle"]
    paths = {path: described(number.dimension).unit for path, number in scene_numbers(scene).items()}
    del paths["input.speed"]
    return units | paths


def formula_problems(scene: Scene) -> list[Problem]:
    """Problems of a scene's formulas: names, dimensions, and switching that the solvers can't follow."""
    formulas = load_formulas(scene)
    found = [problem for name, formula in formulas.items() for problem in _problems(scene, name, formula)]
    return found + _timed_where_motion_repeats(scene)


def _timed_where_motion_repeats(scene: Scene) -> list[Problem]:
    """Time-dependent loads that are on in steady running or in an element that needs periodic motion."""
    settled = {f"regimes.{n}": regime for n, regime in scene.regimes.items() if not isinstance(regime, RunRegime)}
    settled |= {f"elements.{n}": e for n, e in scene.elements.items() if e.type == "machine_drive"}
    governing = [n for n, e in scene.elements.items() if e.machine_needed()[0] == ".engine.machine" and e.is_followed]
    found = []
    for name in time_dependent(scene):
        words = f"{name!r} depends on time: {NOTHING_REPEATS}; "
        mend = "switch it off here, or use a run"
        found += [(f"{path}.off", words + mend) for path, what in settled.items() if name not in what.off]
        mend = "leave it out, or omit engine.duration, which follows a change of load over the machine's cycle"
        found += [(f"elements.{n}.engine.duration", words + mend) for n in governing]
    return found


def _problems(scene: Scene, name: str, formula: LoadFormula) -> Iterator[Problem]:
    check = parts.formulas.dimension_check
    units = units_of_names(scene, formula)
    taken = [n for n in formula.action.numbers if n in {"phi", "v", "omega", TIME, "pi", "gravity"}]
    for number in taken:
        yield f"{formula.at}.numbers.{number}", f"{number!r} already has a meaning in formulas; choose another name"
    expression = formula.expression
    unknown = [n for n in expression.names if n not in units]
    for wrong in unknown:
        yield formula.key, _unknown(wrong, units, formula)
    if taken or unknown:
        return
    try:
        known: Mapping[str, Powers] = {n: dimension_of_unit(units[n]) for n in expression.names}
        wanted = dimension_of_unit("N" if isinstance(formula.action, FormulaForce) else "N m")
        check.check_yields(expression, wanted, known)
        _check_curves(expression)
        _check_finite(expression, expression.tree)
        _check_turns(scene, formula)
    except ExpressionError as error:
        yield formula.key, str(error)
        return
    own_speed = {f"{coupling.shaft}.angular_velocity": coupling.shaft for coupling in scene.couplings.values()}
    for read, shaft in own_speed.items():
        if read in expression.names:
            yield formula.key, f"{read!r} can't be used: shaft {shaft!r} turns at a separate speed, behind a coupling"
    yield from _wrong_in_motion(scene, name, formula)


def _unknown(name: str, units: Mapping[str, str], formula: LoadFormula) -> str:
    """Problem of an unknown name, with the allowed names."""
    quantity = name.rpartition(".")[2]
    if name == "input.speed":
        return "'input.speed' is only the mean speed; use the actual one in a formula: omega, v or NAME.velocity"
    if name in UNIT_NAMES:
        return f"{name!r} is a unit: write it after a number, without blanks around a slash, as in 3 N/mm"
    if quantity in _ACCELERATIONS:
        return f"{name!r} can't be used: accelerations follow from the loads"
    own = [n for n in units if "." not in n]
    listed = ", ".join(own)
    what = unknown_name_message(name, units).rstrip("?")
    return (
        f"{what}; a formula may use {listed}, numbers given in [{formula.at}.numbers], "
        f"POINT.x, .y, .vx, .vy, LINK.angle, .angular_velocity, SLIDER.{', .'.join(OF_SLIDER)}, "
        "and numbers of the scene by their paths"
    )


def _check_curves(expression: TextExpression) -> None:
    """Reject comparisons that hold at isolated points only."""
    for tree in parts.formulas.switching.operations(expression.tree):
        if tree.name in ("==", "!="):
            raise _refused(expression, tree, f"{tree.name} holds at isolated points at most; compare by < or >")


def _check_turns(scene: Scene, formula: LoadFormula) -> None:
    """Reject formulas that may switch too often per cycle for every switching event to be found."""
    expression, switching = formula.expression, parts.formulas.switching
    cycles = dict.fromkeys([*formula.action.numbers, *scene_numbers(scene)], 0.0)
    if isinstance(scene.input, CrankInput):
        cycles["phi"] = float(scene.input.revolutions)
        cycles[TIME] = scene.input.revolutions / abs(scene.input.speed)
    else:
        cycles[TIME] = abs((scene.input.stop - scene.input.start) / scene.input.speed) / math.tau
    for tree in switching.operations(expression.tree):
        if any(switching.turns(part, cycles) > switching.MOST_TURNS for x in switching.compared(tree) for part in x):
            what = (
                f"{tree.name} may switch too often in a cycle to be found: use lower powers, and sines of phi "
                f"(or t) times a number written as digits, up to {switching.MOST_TURNS / 2:g} periods in a cycle"
            )
            raise _refused(expression, tree, what)


def _check_finite(expression: TextExpression, tree: Tree) -> None:
    """Reject parts that are never finite, such as 1 / 0 or 1 / (phi - phi)."""
    if isinstance(tree, TextOperation):
        for operand in tree.operands:
            _check_finite(expression, operand)
        draws = np.random.default_rng(0)
        names = names_in_tree(tree)
        values = {name: draws.choice((-1.0, 1.0), _DRAWS) * 10.0 ** draws.uniform(-3.0, 2.0, _DRAWS) for name in names}
        with np.errstate(all="ignore"):
            value = evaluate_tree(tree, values)
        if not np.isfinite(value).any():
            ever = ", whatever the values of its names" if names else ""
            raise _refused(expression, tree, f"not a finite number{ever}")


def _wrong_in_motion(scene: Scene, name: str, formula: LoadFormula) -> Iterator[Problem]:
    """Formulas that regimes can't use: those that jump at a certain speed."""
    regimes = {f"regimes.{n}": regime for n, regime in scene.regimes.items() if name not in regime.off}
    jump = parts.formulas.speed_powers.jump_at_a_speed(formula.expression.tree, formula.velocities) if regimes else None
    if jump is not None:
        what = (
            f"{jump.name} jumps at a certain speed, about which a motion could hover for ever; switch {name!r} off in "
            f"{', '.join(regimes)}, or make it continuous by min, max or exp"
        )
        yield formula.key, str(_refused(formula.expression, jump, what))


def _refused(expression: TextExpression, tree: TextOperation, what: str) -> ExpressionError:
    return ExpressionError(f"{what}:\n{pointed_out(expression.text, tree.column)}")
