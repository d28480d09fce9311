"""The five cases of I·ε + ½ω²·dI/dφ = M, and what each of a scene's regimes is solved by.

(1) I, M constant; (2) I constant, M(φ) or M(ω) or M(t); (3) I(φ), M(φ); (4) I constant, M(φ, ω); (5) I(φ), M(φ, ω).
Which of them a regime is follows from the structure of the machine alone: which links turn in a fixed ratio to the
crank, and which actions are at work.

Source: K. V. Frolov et al., Theory of Mechanisms and Machines (the equation of motion and its cases).
"""

from enum import IntEnum
from typing import NamedTuple

from engine.graph.nodes import Node, Position, reached
from engine.mechanism.acting import Load
from engine.mechanism.mechanics import Mechanics
from engine.motion.moments.dynamics import Dynamics, Reduction
from engine.parts.actions import InductionMotor, Tabled
from engine.parts.regimes import Regime, RunRegime
from engine.scene.load_formulas import load_formulas
from engine.scene.pairs import has_friction
from engine.scene.scene import Scene

CLOSED_FORM, ENERGY_FORM, TIME_FORM = "closed form", "energy form", "time form"

_WORDS = {
    "dc_motor": "DC motor",
    "linear_drag": "viscous resistance",
    "quadratic_drag": "resistance by ω²",
    "power_drag": "resistance by a power of ω",
    "constant": "constant",
    "formula": "by formula",
}


class MomentLaw(IntEnum):
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
        "closed form", "energy form" or "time form", and a method that a run names. Runs in the energy form go in time
        near rest, and where a closed form ends (the machine stops or turns round on its way) numerics take over.
    law : MomentLaw or None
        Which closed form.
    """

    number: int
    sentence: str
    method: str
    law: MomentLaw | None


def regime_text(mechanics: Mechanics) -> list[tuple[str, str, str]]:
    """For every regime of a scene its name, its case in a sentence, and the method used.

    Parameters
    ----------
    mechanics : Mechanics
        Of a scene with regimes.
    """
    reduction, found = Reduction(mechanics), []
    for name, regime in mechanics.scene.regimes.items():
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
    turning = _varies(dynamics.reduction.mechanics.reduced.inertia)
    rubs = has_friction(dynamics.reduction.mechanics.scene)
    number = _number(turning, arguments | {"φ", "ω"} if rubs else arguments)
    couplings = dynamics.reduction.mechanics.scene.couplings
    if not isinstance(regime, RunRegime):
        couplings = {name: coupling for name, coupling in couplings.items() if coupling.type == "fluid_coupling"}
    stepwise = rubs or couplings or not dynamics.reduction.has_cycle
    named = isinstance(regime, RunRegime) and regime.method is not None
    closed = isinstance(regime, RunRegime) and not (turning or stepwise or named)
    law = _law(dynamics, regime, arguments) if closed else None
    method = TIME_FORM if dynamics.timed or stepwise else ENERGY_FORM
    if named:
        method = f"{ENERGY_FORM}, by {regime.method} in {regime.steps_per_turn} steps a turn"
    sentence = f"case {number}: {'I(φ)' if turning else 'I constant'}, {_moment(dynamics, sources)}"
    sentence += ", and friction in pairs by φ, ω² and ε" if rubs else ""
    for name, coupling in couplings.items():
        joined = "open" if name in regime.off else "at work"
        sentence += f"; at two speeds, of the crank and of shaft {coupling.shaft}, with {name} {joined}"
    return Case(number, sentence, method if law is None else CLOSED_FORM, law)


def _number(turning: bool, arguments: frozenset[str]) -> int:
    if turning:
        return 3 if arguments <= {"φ"} else 5
    return (1, 2, 4, 4)[len(arguments)]


def _sources(dynamics: Dynamics) -> dict[str, frozenset[str]]:
    """What the moment of each acting motor and load depends on: "φ", "ω", "t"."""
    reduction = dynamics.reduction
    found = {name: frozenset("ω") for name in dynamics.motors}
    for load in reduction.loads.terms:
        if load.action in dynamics.active and load.basis is not reduction.mechanics.graph.zero:
            found[load.action] = found.get(load.action, frozenset()) | _arguments(load, reduction.time)
    return found


def _arguments(load: Load, time: Node) -> frozenset[str]:
    found = set() if load.order == 0 else {"ω"}
    found |= {"φ"} if _varies(load.basis) else set()
    return frozenset(found | ({"t"} if time in reached([load.basis]) else set()))


def _varies(node: Node) -> bool:
    """Whether a node changes with the crank angle."""
    return any(isinstance(behind, Position) for behind in reached([node]))


def _law(dynamics: Dynamics, regime: RunRegime, arguments: frozenset[str]) -> MomentLaw | None:
    """The closed form of a run with constant I, if there is one for its moments and for the way it ends."""
    orders = {order for _, _, order in dynamics.polynomial}
    if "φ" in arguments or dynamics.laws:
        return None
    if "t" in arguments:
        reduction = dynamics.reduction
        timed = [key for key in reduction.keys if key.action in dynamics.active and reduction.depends_on_time(key)]
        actions = reduction.mechanics.scene.forces | reduction.mechanics.scene.moments
        tabled = len(timed) == 1 and isinstance(actions[timed[0].action], Tabled)
        return MomentLaw.TIMED if arguments == {"t"} and tabled and regime.time is not None else None
    scene = dynamics.reduction.mechanics.scene
    formulas = load_formulas(scene)
    if any(order > 0 and dynamics.reduction.keys[i].action in formulas for i, _, order in dynamics.polynomial):
        # It may drive the faster it goes, which closed forms leave out.
        return None
    if any(isinstance(scene.moments[name], InductionMotor) for name in dynamics.motors):
        return MomentLaw.KLOSS if len(dynamics.motors) == 1 and orders <= {0} and regime.speed is not None else None
    if 2 in orders:
        return None if dynamics.motors or 1 in orders else MomentLaw.SQUARE
    return MomentLaw.LINEAR if dynamics.motors or 1 in orders else MomentLaw.CONSTANT


# In words


def _moment(dynamics: Dynamics, sources: dict[str, frozenset[str]]) -> str:
    if not sources:
        return "no moment"
    arguments, scene = frozenset().union(*sources.values()), dynamics.reduction.mechanics.scene
    if not arguments:
        return f"M constant of {_listed([_named(scene, name) for name in sources])}"
    inside = ", ".join(a for a in "φωt" if a in arguments)
    of = [_named(scene, name) for name, own in sources.items() if own]
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
