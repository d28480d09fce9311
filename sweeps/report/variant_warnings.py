"""Warnings on the unmodified machine of a study, and on variants of a result."""

from collections.abc import Iterable, Mapping

import engine
from sweeps.report.sweep_result import SweepResult
from sweeps.study.study_content import ReadyMachine


def known_summaries(outcome: engine.Outcome) -> dict[str, tuple[float, float]]:
    """Summaries of the first variant with their error estimates; none if it failed."""
    if outcome.status[0] != engine.Verdict.OK:
        return {}
    return {name: (float(row[0]), float(outcome.errors[name][0])) for name, row in outcome.summaries.items()}


def machine_warnings(machine: ReadyMachine, known: Mapping[str, tuple[float, float]]) -> list[str]:
    """Warnings on the unmodified machine of a scene.

    Parameters
    ----------
    machine : Machine or ElementsAlone
    known : mapping of str to (float, float)
        Summaries that are known already, with their error estimates; cheap ones are added.
    """
    further = engine.summaries_for_warnings(machine.scene, without=known, mechanics=machine.mechanics)
    return engine.warnings_in_words(machine.scene, None, {**further, **known})


def result_warnings(result: SweepResult, variants: Iterable[int]) -> list[str]:
    """Warnings on some variants of a result; on the numbers of its scene if there are none.

    Parameters
    ----------
    result : SweepResult
    variants : iterable of int
    """
    found = {variant: _of_variant(result, variant) for variant in variants}
    if not found:
        return engine.warnings_in_words(result.scene)
    several = len(found) > 1
    return [f"variant {variant}: {text}" if several else text for variant, texts in found.items() for text in texts]


def _of_variant(result: SweepResult, variant: int) -> list[str]:
    values, columns = result.variant_values(variant), result.columns
    if columns["status"][variant] != engine.Verdict.OK:
        return engine.warnings_in_words(result.scene, values)
    known = {n: (float(columns[n][variant]), float(columns[f"{n}_error"][variant])) for n in result.summaries}
    further = engine.summaries_for_warnings(result.scene, values, known, result.mechanics)
    return engine.warnings_in_words(result.scene, values, {**further, **known})
