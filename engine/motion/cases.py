"""The five cases of I·ε + ½ω²·dI/dφ = M, and the case and method of each of a scene's regimes.

(1) I, M constant; (2) I constant, M(φ) or M(ω) or M(t); (3) I(φ), M(φ); (4) I constant, M(φ, ω); (5) I(φ), M(φ, ω).
The case of a regime follows from the structure of the machine only: from the links in a fixed ratio to the crank, and
the acting forces and torques.

Source: K. V. Frolov et al., Theory of Mechanisms and Machines (the equation of motion and its cases).
"""

from engine.graph.nodes import Node, Position, reached
from engine.mechanism.link_loads import Load
from engine.mechanism.mechanics import Mechanics
from engine.motion.moments.dynamics import Dynamics, Reduction
from engine.parts.regimes import Regime, RunRegime
from engine.scene.pairs import has_friction, own_drives
from engine.scene.scene import Scene
from engine.words.glossary import enumerated

_WORDS = {
    "dc_motor": "DC motor",
    "table_motor": "motor by a table",
    "linear_drag": "viscous resistance",
    "quadratic_drag": "resistance by ω²",
    "power_drag": "resistance by a power of ω",
    "constant": "constant",
    "formula": "by formula",
}


def regime_text(mechanics: Mechanics) -> list[tuple[str, str, str]]:
    """Name, case in words and method of every regime of a scene.

    Torques that also depend on time count as dependent on the speed, except pure M(t). The method is "energy form" or
    "time form", plus the method that a run names; runs in the energy form use the time form near rest.

    Parameters
    ----------
    mechanics : Mechanics
        Mechanics of a scene with regimes.
    """
    reduction, regimes = Reduction(mechanics), mechanics.scene.regimes
    return [(name, *_case_of(Dynamics(reduction, frozenset(r.off)), r)) for name, r in regimes.items()]


def _case_of(dynamics: Dynamics, regime: Regime) -> tuple[str, str]:
    """The case of a regime in words, and its method."""
    sources, mechanics = _sources(dynamics), dynamics.reduction.mechanics
    arguments = frozenset().union(*sources.values())
    turning = _varies(mechanics.reduced.inertia)
    rubs = has_friction(mechanics.scene)
    number = _number(turning, arguments | {"φ", "ω"} if rubs else arguments)
    couplings = mechanics.scene.couplings
    if not isinstance(regime, RunRegime):
        couplings = {name: coupling for name, coupling in couplings.items() if coupling.type == "fluid_coupling"}
    in_time = dynamics.in_time or rubs or couplings
    method = "time form" if in_time else "energy form"
    if isinstance(regime, RunRegime) and regime.method is not None:
        method = f"energy form, by {regime.method} in {regime.steps_per_turn} steps a turn"
    sentence = f"case {number}: {'I(φ)' if turning else 'I constant'}, {_moment(dynamics, sources)}"
    sentence += ", and friction in pairs by φ, ω² and ε" if rubs else ""
    servos = own_drives(mechanics.scene)
    sentence += f"; {enumerated(servos)} by a law, with its own drive" if servos else ""
    for name, coupling in couplings.items():
        joined = "open" if name in regime.off else "at work"
        sentence += f"; at two speeds, of the crank and of shaft {coupling.shaft}, with {name} {joined}"
    return sentence, method


def _number(turning: bool, arguments: frozenset[str]) -> int:
    if turning:
        return 3 if arguments <= {"φ"} else 5
    return (1, 2, 4, 4)[len(arguments)]


def _sources(dynamics: Dynamics) -> dict[str, frozenset[str]]:
    """Arguments "φ", "ω", "t" on which the torque of each acting motor and load depends."""
    reduction = dynamics.reduction
    found = {name: frozenset("ω") for name in dynamics.motors}
    for load in reduction.loads.terms:
        if load.action in dynamics.active and load.basis is not reduction.mechanics.graph.zero:
            found[load.action] = found.get(load.action, frozenset()) | _arguments(load, reduction)
    return found


def _arguments(load: Load, reduction: Reduction) -> frozenset[str]:
    behind = reached([load.basis])
    found = {"ω"} if load.order != 0 or reduction.speed in behind else set()
    found |= {"φ"} if _varies(load.basis) else set()
    return frozenset(found | ({"t"} if reduction.time in behind else set()))


def _varies(node: Node) -> bool:
    """Whether a node changes with the crank angle."""
    return any(isinstance(behind, Position) for behind in reached([node]))


# In words


def _moment(dynamics: Dynamics, sources: dict[str, frozenset[str]]) -> str:
    if not sources:
        return "no moment"
    arguments, scene = frozenset().union(*sources.values()), dynamics.reduction.mechanics.scene
    if not arguments:
        return f"M constant of {enumerated([_named(scene, name) for name in sources])}"
    inside = ", ".join(a for a in "φωt" if a in arguments)
    of = [_named(scene, name) for name, own in sources.items() if own]
    return f"M({inside}) of {enumerated(of)}"


def _named(scene: Scene, name: str) -> str:
    """Name of an action, with its type in words unless the name contains it."""
    tables = (scene.forces, scene.moments, scene.cylinders)
    kind = next((table[name].type for table in tables if name in table), None)
    if kind is None:
        return name if name == "gravity" else f"{name} (spring)"
    return f"{name} ({_WORDS.get(kind, kind.replace('_', ' '))})"
