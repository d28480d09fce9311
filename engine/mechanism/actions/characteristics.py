"""The characteristics of forces and moments as nodes: constant, table, formula, against the motion, drag.

With v the transfer velocity along a load and ω the input speed, the actual velocity is v ω. A load that grows with a
power of it is that power of v times a per-variant number. Factors that switch with the sign of v are held.
"""

from collections.abc import Iterator, Mapping

import numpy as np

from engine import mechanism
from engine.graph.nodes import Node
from engine.laws.elementary import power
from engine.laws.loads import acts_in_direction, constant_against_motion
from engine.mechanism.actions.paths import Along, input_sense
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.link_loads import Characteristic
from engine.parts import actions
from engine.scene.load_formulas import LoadFormula

_SENSES = {"along": 1.0, "against": -1.0}
_Action = actions.ForceAction | actions.MomentAction


def characteristics(
    kinematics: Kinematics, action: _Action, at: str, along: Along, time: Node, speed: Node | None
) -> Iterator[Characteristic]:
    """Magnitude of a force or moment; loads by a formula and of moved masses have a part for each power of the speed.

    Parameters
    ----------
    kinematics : Kinematics
    action : force or moment of the scene
        Neither a motor nor a torsion spring.
    at : str
        Path of the action in the scene.
    along : Along
        Motion of the loaded point or link.
    time : Node
        [s].
    speed : Node or None
        Magnitude of the input speed [rad/s]; None for the scene's speed.
    """
    acts = _acts(kinematics, action, along)
    if isinstance(action, (actions.FormulaForce, actions.FormulaMoment)):
        factor, formula = kinematics.graph.held(acts), LoadFormula(action, at)
        by_formula = mechanism.actions.formulas.formula_characteristics
        yield from by_formula(kinematics, formula, along, factor, time, speed)
    elif isinstance(action, actions.Carried):
        yield from mechanism.actions.carried_masses.carried_characteristics(kinematics, action, at, along)
    else:
        yield _characteristic(kinematics, action, at, along, acts, time)


def _characteristic(
    kinematics: Kinematics, action: _Action, at: str, along: Along, acts: Node, time: Node
) -> Characteristic:
    graph, v = kinematics.graph, along.velocity
    value = f"{at}.force" if at.startswith("forces.") else f"{at}.moment"
    match action.type:
        case "constant":
            return Characteristic(graph.number(value), graph.held(acts))
        case "table":
            value = mechanism.actions.tables.tabled(kinematics, action, acts, time)
            return Characteristic(graph.number(f"{at}.scale"), value)
        case "against_motion":
            force = graph.derived(f"{at} at speed", lambda n: n[value] * _sense(n))
            return Characteristic(force, _against(along, acts))
        case "linear_drag":
            drag = graph.derived(f"{at} at speed", lambda n: n[f"{at}.coefficient"] * n["input.speed"])
            return Characteristic(drag, -v * graph.held(acts), 1)
        case "quadratic_drag":
            drag = graph.derived(
                f"{at} at speed", lambda n: n[f"{at}.coefficient"] * n["input.speed"] * np.abs(n["input.speed"])
            )
            return Characteristic(drag, _against(along, acts) * (v * v), 2)
        case "power_drag":
            exponent = f"{at}.exponent"
            growth = graph.apply(power, abs(v), graph.number(exponent))
            drag = graph.derived(f"{at} at speed", lambda n: _power_drag(n, at, value))
            return Characteristic(drag, _against(along, acts) * growth, exponent)
        # All others are brakes.
        case _:
            braking = mechanism.actions.brakes.braking_moment
            moment = graph.derived(f"{at} at speed", lambda n: braking(action, at, n) * _sense(n))
            return Characteristic(moment, _against(along, acts))


def _sense(numbers: Mapping) -> float | np.ndarray:
    return np.sign(numbers["input.speed"])


def _power_drag(numbers: Mapping, at: str, value: str) -> float | np.ndarray:
    share = np.abs(numbers["input.speed"] / numbers[f"{at}.at_speed"]) ** numbers[f"{at}.exponent"]
    return numbers[value] * _sense(numbers) * share


def _acts(kinematics: Kinematics, action: _Action, along: Along) -> Node:
    """Factor 1, or 0 while the link moves in a direction in which the action does not act; not held."""
    sense = _SENSES.get(getattr(action, "acts", "always"))
    if sense is None:
        return kinematics.graph.one
    return along.switch(acts_in_direction, sense * input_sense(kinematics))


def _against(along: Along, acts: Node) -> Node:
    """−1 in the direction of the velocity, times the factor `acts`; held."""
    graph = along.velocity.graph
    if along.turning is None:
        return graph.held(-acts)
    return graph.held(along.switch(constant_against_motion, 1.0) * acts)
