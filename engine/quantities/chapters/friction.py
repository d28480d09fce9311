"""Friction in pairs and meshes: forces, losses, efficiency, and the margin against jamming."""

from engine.elements.element import Rank
from engine.mechanism.actions.paths import input_sense
from engine.mechanism.mechanics import Mechanics
from engine.quantities.expressions import (
    Exactly,
    Expression,
    Integral,
    VariantNumber,
    least,
    maximum,
    minimum,
    unresolved_peak,
)
from engine.quantities.quantity import drive_words
from engine.quantities.register import Declared, Field, InputUnits, Summary, mean
from engine.scene.pairs import contact_pairs, has_friction, lossy_meshes, mesh_driver, pairs


def declare(mechanics: Mechanics) -> Declared:
    """Friction pair by pair, its reduced moment, losses, efficiency and the margin against jamming."""
    m, scene = mechanics, mechanics.scene
    if not has_friction(scene):
        return
    known = {pair.name: pair for pair in [*pairs(scene), *contact_pairs(scene)]}
    unit = InputUnits.of(scene).moment
    span = "over the cycle" if m.has_cycle else "over the input's range"

    def variable(name: str, words: str, units: str, *answers: str) -> Field:
        return Field(name, words, units, lambda: m.reactions.variables[name], answers=answers)

    for friction in scene.friction.values():
        pair = known[friction.pair]
        where = f"in {pair.place}, pair {pair.name}"
        if pair.kind == "revolute":
            yield variable(f"{pair.name}.friction_moment", f"moment of friction on {pair.link} {where}", "N m")
        else:
            along = "the cam's tangent (contact normal turned left)" if pair.kind == "contact" else ""
            words = f"friction on {pair.link} along {along or 'its own direction'} {where}"
            yield variable(f"{pair.name}.friction_force", words, "N")
        yield variable(f"{pair.name}.friction_power", f"power lost to friction {where}", "W")
        yield Summary(
            f"{pair.name}.friction_work",
            f"work lost to friction in {pair.place}, {span}",
            "J",
            lambda name=pair.name: abs(Integral(m.reactions.lost[name])),
        )
    for name in lossy_meshes(scene):
        where = f"in the mesh of {name} with {mesh_driver(scene, name)}"
        yield variable(f"{name}.mesh_loss", f"power lost {where}", "W")
        yield Summary(
            f"{name}.mesh_work",
            f"work lost {where}, {span}",
            "J",
            lambda name=name: abs(Integral(m.reactions.lost_in_teeth[name])),
        )
    yield variable("friction_moment", "reduced moment of all friction in pairs and meshes", unit)
    words = f"{drive_words(m.scene)}, with friction in pairs"
    yield variable("input_moment_with_friction", words, unit, "peak")
    yield Summary(
        "friction_loss",
        f"work lost to friction in all pairs {span}",
        "J",
        lambda: abs(Integral(m.reactions.variables["friction_moment"])),
        rank=Rank.ANSWER,
    )
    yield Summary(
        "friction_residual",
        "maximum relative change of a normal force in the last iteration",
        "1",
        lambda: maximum(Exactly(0.0), *(unresolved_peak(s.residual) for s in m.reactions.settlings.values())),
        rank=Rank.CHECK,
    )
    yield Summary(
        "jamming_margin",
        "minimum determinant of the friction equations: 1 without friction, 0 at jamming",
        "1",
        lambda: minimum(Exactly(1.0), *(least(s.margin) for s in m.reactions.settlings.values())),
        rank=Rank.ANSWER,
    )
    if m.has_cycle:
        # Without a useful or driving load nothing comes out by definition.
        works = any(term.role in ("useful", "driving") for term in m.loads.terms)
        of = "useful work and work delivered at the input over driving work and work supplied there, over the cycle"
        yield Summary(
            "mechanical_efficiency",
            f"mechanical efficiency: {of}",
            "1",
            lambda: _efficiency(m),
            may_be_undefined=True,
            rank=Rank.ANSWER if works else Rank.FURTHER,
        )


def _efficiency(m: Mechanics) -> Expression:
    """Mechanical efficiency over a cycle: mean power delivered over mean power supplied; undefined if none is."""
    sense = VariantNumber(input_sense(m.kinematics))
    useful, driving = (mean(m, m.moment_of(frozenset({role}))) * sense for role in ("useful", "driving"))
    taken = (-mean(m, m.moment_of()) - mean(m, m.reactions.variables["friction_moment"])) * sense
    out = _positive(-useful) + _positive(-taken)
    return out / (_positive(driving) + _positive(taken))


def _positive(x: Expression) -> Expression:
    return maximum(x, x * 0.0)
