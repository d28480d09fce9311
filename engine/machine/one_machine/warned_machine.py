"""Warnings on one machine in words."""

from collections.abc import Iterable, Mapping
from types import MappingProxyType

from engine.cycle.measured import Measured
from engine.machine.checks import given_numbers
from engine.machine.one_machine.moving_machine import MovingMachine
from engine.mechanism.mechanics import Mechanics
from engine.scene.scene import Numbers, Scene, scene_numbers
from engine.warnings.kinds import rules_by_kind
from engine.words.verdicts import Verdict


def warnings_in_words(
    scene: Scene,
    values: Mapping[str, float] | None = None,
    known: Mapping[str, tuple[float, float]] = MappingProxyType({}),
) -> list[str]:
    """Warnings that follow from the numbers of a scene and from known summaries; others are omitted.

    Parameters
    ----------
    scene : Scene
    values : mapping of path to float, optional
        Numbers (SI) that replace the scene's.
    known : mapping of str to (float, float), optional
        Summaries with their error estimates.
    """
    limits, values = scene_numbers(scene), dict(values or {})
    numbers = Numbers(limits, given_numbers(limits, tuple(values), values, None)[0])
    found = {name: Measured([value], [error]) for name, (value, error) in known.items()}
    return [
        rule.words(numbers, found)
        for rules in rules_by_kind(scene).values()
        for rule in rules
        if all(name in found for name in rule.reads) and rule.broken(numbers, found).value.any()
    ]


def summaries_for_warnings(
    scene: Scene,
    values: Mapping[str, float] | None = None,
    without: Iterable[str] = (),
    mechanics: Mechanics | None = None,
) -> dict[str, tuple[float, float]]:
    """Summaries that warnings on one machine require, with their error estimates; none if the machine fails.

    Those of regimes are omitted, as they cost much more than the cycle.

    Parameters
    ----------
    scene : Scene
    values : mapping of path to float, optional
        Numbers (SI) that replace the scene's.
    without : iterable of str
        Summaries that are known already.
    mechanics : Mechanics, optional
        Mechanics of this scene, reused if the replaced numbers vary in it.
    """
    reads = dict.fromkeys(s for rules in rules_by_kind(scene).values() for rule in rules for s in rule.reads)
    unknown = [name for name in reads if name not in set(without)]
    if scene.input is None or not unknown:
        return {}
    machine = MovingMachine(scene, values, known=mechanics)
    register = machine.register

    def has(name: str) -> bool:
        return register.summary(name) is not None and register.why_not(name) is None

    names = [name for name in unknown if has(name)]
    if not names or machine.verdict_on([register.summary(name).expression() for name in names]) != Verdict.OK:
        return {}
    found = machine.summaries(names)
    return {name: (float(one.value), float(one.error)) for name, one in found.items()}
