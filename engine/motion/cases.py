"""The five cases of I·ε + ½ω²·dI/dφ = M, and what each of a scene's regimes is solved by.

(1) I, M constant; (2) I constant, M(φ) or M(ω) or M(t); (3) I(φ), M(φ); (4) I constant, M(φ, ω); (5) I(φ), M(φ, ω).
Which of them a regime is follows from the structure of the model alone: which links turn in a fixed ratio to the
crank, and which actions are at work.

Source: K. V. Frolov et al., Theory of Mechanisms and Machines (the equation of motion and its cases).
"""

import re
from enum import IntEnum
from typing import NamedTuple

from engine.machine.model import Model
from engine.machine.moments import Term
from engine.motion.moments.dynamics import Dynamics, Reduction
from engine.scene.actions import InductionMotor
from engine.scene.regimes import Regime, RunRegime
from engine.scene.scene import Scene

CLOSED_FORM, ENERGY_FORM, TIME_FORM = "closed form", "energy form", "time form"

_WORDS = {
    "dc_motor": "DC motor",
    "linear_drag": "viscous resistance",
    "quadratic_drag": "resistance by ω²",
    "power_drag": "resistance by a power of ω",
    "constant": "constant",
}
# What in a basis changes with the crank angle.
_ANGLE = re.compile(r"q|cos_q|sin_q|angle_table__\w+")


class Law(IntEnum):
    """Dependence of M that has a closed form where I is constant."""

    CONSTANT = 0
    LINEAR = 1
    SQUARE = 2
    KLOSS = 3
    TIMED = 4


class Case(NamedTuple):
    """What a regime is as a problem of mechanics.

    Attributes
    ----------
    number : int
        1 … 5. Moments that depend on time as well count as those that depend on the speed, but for M(t) alone.
    sentence : str
        In the mechanic's words.
    method : str
        "closed form", "energy form" or "time form". Runs in the energy form go in time near rest, and where a closed
        form ends (the machine stops or turns round on its way) numerics take over.
    law : Law or None
        Which closed form.
    """

    number: int
    sentence: str
    method: str
    law: Law | None


def regime_text(model: Model) -> list[tuple[str, str, str]]:
    """For every regime of a model's scene its name, its case in a sentence, and the method used.

    Parameters
    ----------
    model : Model
    """
    reduction, found = Reduction(model), []
    for name, regime in model.scene.regimes.items():
        case = case_of(Dynamics(reduction, frozenset(regime.off)), regime)
        found.append((name, case.sentence, case.method))
    return found


def case_of(dynamics: Dynamics, regime: Regime) -> Case:
    """Which case a regime is.

    Parameters
    ----------
    dynamics : Dynamics
        With the actions at work in the regime.
    regime : Regime
    """
    sources = _sources(dynamics)
    arguments = frozenset().union(*sources.values())
    turning = _varies(dynamics.model, [basis for _, basis in dynamics.model.linear["reduced_inertia"].terms])
    number = _number(turning, arguments)
    law = None if turning or not isinstance(regime, RunRegime) else _law(dynamics, regime, arguments)
    method = TIME_FORM if dynamics.timed else ENERGY_FORM
    sentence = f"case {number}: {'I(φ)' if turning else 'I constant'}, {_moment(dynamics, sources)}"
    return Case(number, sentence, method if law is None else CLOSED_FORM, law)


def _number(turning: bool, arguments: frozenset[str]) -> int:
    if turning:
        return 3 if arguments <= {"φ"} else 5
    return (1, 2, 4, 4)[len(arguments)]


def _sources(dynamics: Dynamics) -> dict[str, frozenset[str]]:
    """What the moment of each acting motor and load depends on: "φ", "ω", "t"."""
    found = {name: frozenset("ω") for name in dynamics.motors}
    for term in dynamics.model.moments.terms:
        if term.action in dynamics.active and term.basis != "zero":
            found[term.action] = found.get(term.action, frozenset()) | _arguments(dynamics.model, term)
    return found


def _arguments(model: Model, term: Term) -> frozenset[str]:
    law = model.moments.laws.get(term.basis)
    found = set() if term.order == 0 else {"ω"}
    if law is None:
        found |= {"φ"} if _varies(model, [term.basis]) else set()
    else:
        found |= {"t"} if law.clock else set()
        # Engines tell their strokes apart by the crank angle itself.
        own = not law.clock and "nodes[k]" in law.expression
        found |= {"φ"} if own or law.stroke_of or _varies(model, list(law.rows)) else set()
    return frozenset(found)


def _varies(model: Model, variables: list[str]) -> bool:
    """Whether any of some variables of the program changes with the crank angle."""
    names = set(variables).union(*(step.needs for step in model.program.needed(variables)))
    return any(_ANGLE.fullmatch(name) for name in names)


def _law(dynamics: Dynamics, regime: RunRegime, arguments: frozenset[str]) -> Law | None:
    """The closed form of a run with constant I, if there is one for its moments and for the way it ends."""
    orders = {order for _, _, order in dynamics.polynomial}
    if "φ" in arguments or dynamics.laws:
        return None
    if "t" in arguments:
        timed = [law for law in dynamics.reduction.tabulation.laws if law.clock and law.row[5:] in dynamics.active]
        return Law.TIMED if arguments == {"t"} and len(timed) == 1 and regime.time is not None else None
    if any(isinstance(dynamics.model.scene.moments[name], InductionMotor) for name in dynamics.motors):
        return Law.KLOSS if len(dynamics.motors) == 1 and orders <= {0} and regime.speed is not None else None
    if 2 in orders:
        return None if dynamics.motors or 1 in orders else Law.SQUARE
    return Law.LINEAR if dynamics.motors or 1 in orders else Law.CONSTANT


# In words


def _moment(dynamics: Dynamics, sources: dict[str, frozenset[str]]) -> str:
    if not sources:
        return "no moment"
    arguments = frozenset().union(*sources.values())
    if not arguments:
        return f"M constant of {_listed([_named(dynamics.model.scene, name) for name in sources])}"
    inside = ", ".join(a for a in "φωt" if a in arguments)
    of = [_named(dynamics.model.scene, name) for name, own in sources.items() if own]
    return f"M({inside}) of {_listed(of)}"


def _named(scene: Scene, name: str) -> str:
    """Name of an action, and its type in words where the name alone doesn't say it."""
    tables = (scene.forces, scene.moments, scene.cylinders)
    kind = next((table[name].type for table in tables if name in table), None)
    if kind is None:
        return name if name == "gravity" else f"{name} (spring)"
    return f"{name} ({_WORDS.get(kind, kind.replace('_', ' '))})"


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
