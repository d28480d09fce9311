"""Friction in pairs and meshes: forces, losses, efficiency, and the margin against jamming."""

from functools import partial

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
from engine.quantities.register import (
    Declared,
    Field,
    InputUnits,
    Summary,
    answer_summary,
    check_summary,
    drive_words,
    mean,
    ranked_summary,
)
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

    def work(of: str, name: str) -> Expression:
        return abs(Integral(getattr(m.reactions, of)[name]))

    def residual() -> Expression:
        return maximum(Exactly(0.0), *(unresolved_peak(s.residual) for s in m.reactions.settlings.values()))

    def margin() -> Expression:
        return minimum(Exactly(1.0), *(least(s.margin) for s in m.reactions.settlings.values()))

    for friction in scene.friction.values():
        pair = known[friction.pair]
        where = f"in {pair.place}, pair {pair.name}"
        if pair.kind == "revolute":
            yield variable(f"{pair.name}.friction_moment", f"moment of friction on {pair.link} {where}", "N m")
        else:
            along = "the cam's tangent (contact normal turned left)" if pair.kind == "contact" else ""
            words = f"friction on {pair.link} along {along or 'its x axis'} {where}"
            yield variable(f"{pair.name}.friction_force", words, "N")
        yield variable(f"{pair.name}.friction_power", f"power lost to friction {where}", "W")
        words = f"work lost to friction in {pair.place}, {span}"
        yield Summary(f"{pair.name}.friction_work", words, "J", partial(work, "lost", pair.name))
    for name in lossy_meshes(scene):
        where = f"in the mesh of {name} with {mesh_driver(scene, name)}"
        yield variable(f"{name}.mesh_loss", f"power lost {where}", "W")
        yield Summary(f"{name}.mesh_work", f"work lost {where}, {span}", "J", partial(work, "lost_in_teeth", name))
    yield variable("friction_moment", "reduced moment of all friction in pairs and meshes", unit)
    words = f"{drive_words(m.scene)}, with friction in pairs"
    yield variable("input_moment_with_friction", words, unit, "peak")
    words = f"work lost to friction in all pairs {span}"
    yield answer_summary("friction_loss", words, "J", partial(work, "variables", "friction_moment"))
    words = "maximum relative change of a normal force in the last iteration"
    yield check_summary("friction_residual", words, "1", residual)
    words = "minimum determinant of the friction equations: 1 without friction, 0 at jamming"
    yield answer_summary("jamming_margin", words, "1", margin)
    if m.has_cycle:
        # Without useful or driving loads the efficiency says nothing.
        works = any(term.role in ("useful", "driving") for term in m.loads.terms)
        of = "useful work and work delivered at the input over driving work and work supplied there, over the cycle"
        words = f"mechanical efficiency: {of}"
        yield ranked_summary(works)("mechanical_efficiency", words, "1", lambda: _efficiency(m), may_be_undefined=True)


def _efficiency(m: Mechanics) -> Expression:
    """Mechanical efficiency over a cycle: mean power delivered over mean power supplied; undefined if none is."""
    sense = VariantNumber(input_sense(m.kinematics))
    useful, driving = (mean(m, m.moment_of(frozenset({role}))) * sense for role in ("useful", "driving"))
    taken = (-mean(m, m.moment_of()) - mean(m, m.reactions.variables["friction_moment"])) * sense
    out = _positive(-useful) + _positive(-taken)
    return out / (_positive(driving) + _positive(taken))


def _positive(x: Expression) -> Expression:
    return maximum(x, x * 0.0)
