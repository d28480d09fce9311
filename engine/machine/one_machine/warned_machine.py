"""Warnings on one machine in words."""

from collections.abc import Iterable, Mapping

import numpy as np

from engine.cycle.measured import Measured
from engine.machine.checks import given_numbers
from engine.machine.elements.elements_alone import made_ready
from engine.scene.scene import Numbers, Scene, scene_numbers
from engine.verdicts import Verdict
from engine.warnings.asked_warnings import computable_rules
from engine.warnings.kinds import rules_by_kind


def warnings_from_numbers(scene: Scene, values: Mapping[str, float] | None = None) -> list[str]:
    """Warnings that follow from the numbers of a scene, without any computation of its motion.

    Parameters
    ----------
    scene : Scene
    values : mapping of path to float, optional
        Numbers (SI) that replace the scene's.
    """
    return warnings_in_words(scene, values, {})


def warnings_in_words(
    scene: Scene, values: Mapping[str, float] | None, known: Mapping[str, tuple[float, float]]
) -> list[str]:
    """Warnings that follow from the numbers of a scene and from known summaries; others are omitted.

    Parameters
    ----------
    scene : Scene
    values : mapping of path to float or None
        Numbers (SI) that replace the scene's.
    known : mapping of str to (float, float)
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
    scene: Scene, values: Mapping[str, float] | None = None, without: Iterable[str] = ()
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
    """
    values, known = dict(values or {}), set(without)
    has = made_ready(scene).has_summary if scene.input else known.__contains__
    reads = dict.fromkeys(s for rules in computable_rules(scene, has).values() for rule in rules for s in rule.reads)
    names = [s for s in reads if s not in known and s.partition(".")[0] not in scene.regimes]
    if not names:
        return {}
    outcome = made_ready(scene, names, varied=values).evaluate({path: np.array([v]) for path, v in values.items()})
    if outcome.status[0] != Verdict.OK:
        return {}
    return {name: (float(outcome.summaries[name][0]), float(outcome.errors[name][0])) for name in names}
