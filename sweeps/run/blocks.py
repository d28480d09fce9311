"""Blocks of variants: size and columns."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from engine import Outcome, Verdict
from sweeps.study.study import Study

# Time per block [s], long against its overhead of a few milliseconds, short enough that a killed sweep loses little;
# and memory for its fields.
SECONDS_PER_BLOCK = 1.0
BYTES_PER_BLOCK = 96e6
LARGEST_BLOCK = 65_536
# Up to this many variants are one block, without a trial run.
FEW = 8
# Motion keeps all steps of the variants evaluated together.
MOST_AT_ONCE_IN_MOTION = 4096


def bytes_of_fields(study: Study) -> int:
    """Memory of the kept fields of a variant."""
    if not study.fields:
        return 0
    machine = study.machine()
    kept = (machine.kept_at[name].values if name in machine.kept_at else machine.nodes for name in study.fields)
    return machine.dtype.itemsize * sum(values.size for values in kept)


def largest_block(study: Study) -> int:
    """Number of variants whose columns fit in memory."""
    asked = len(study.summaries) + len(study.sensitivity.quantities)
    numbers = 8 * (2 * asked + 4 * len(study.parameters) + study.machine().numbers_kept + 8)
    fit = 2 ** int(np.log2(BYTES_PER_BLOCK / (bytes_of_fields(study) + numbers)))
    return int(np.clip(fit, 1, LARGEST_BLOCK))


def most_at_once(study: Study) -> int:
    """Number of variants whose evaluation fits in memory."""
    block = largest_block(study)
    return min(block, MOST_AT_ONCE_IN_MOTION) if study.machine().has_regimes else block


def block_size(study: Study, seconds: Callable[[], float]) -> int:
    """Variants per block: a second of work, bounded by memory; a few variants are one block.

    Parameters
    ----------
    study : Study
    seconds : callable
        Measures the time per variant.
    """
    if study.design.size <= FEW:
        return study.design.size
    within = int(min(SECONDS_PER_BLOCK / max(seconds(), 1e-9), LARGEST_BLOCK))
    return max(min(within, largest_block(study), study.design.size), 1)


def evaluate_variants(
    study: Study, values: dict[str, np.ndarray], drop: np.ndarray, buffer: np.ndarray | None = None
) -> dict[str, np.ndarray]:
    """All columns of some variants, computed in parts if memory requires.

    Parameters
    ----------
    study : Study
    values : dict of str to ndarray (variants,)
        Their parameters (SI), including derived ones.
    drop : ndarray (variants,) of bool
        Variants to skip.
    buffer : ndarray, optional
        Memory for their fields.
    """
    if drop.size > (most := most_at_once(study)):
        ends = [*range(0, drop.size, most), drop.size]
        some = [slice(*part) for part in pairwise(ends)]
        parts = [evaluate_variants(study, {n: v[s] for n, v in values.items()}, drop[s]) for s in some]
        return joined(parts)
    if study.paths:
        outcome = study.machine().evaluate({p: values[p] for p in study.paths}, drop, buffer)
    else:
        outcome = _repeated(study.machine().evaluate({}), drop)
    results = {"status": outcome.status, "status_group": outcome.status_group, "status_at": outcome.status_at}
    errors = {f"{name}_error": error for name, error in outcome.errors.items()}
    sensitivity = study.sensitivity.of_variants(values, outcome.status)
    return values | results | outcome.summaries | errors | sensitivity | outcome.fields


def joined(parts: list[dict[str, np.ndarray]]) -> dict[str, np.ndarray]:
    """Concatenated columns of several sets of variants."""
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _repeated(outcome: Outcome, drop: np.ndarray) -> Outcome:
    """The outcome of the unmodified scene, for variants without changed scene numbers."""

    def again(array: np.ndarray) -> np.ndarray:
        return np.repeat(array, drop.size, axis=0)

    status = np.where(drop, np.uint8(Verdict.DROPPED), again(outcome.status))
    summaries, errors, fields = (
        {name: again(row) for name, row in rows.items()} for rows in (outcome.summaries, outcome.errors, outcome.fields)
    )
    group, at = again(outcome.status_group), again(outcome.status_at)
    return Outcome(status.astype(np.uint8), group, at, summaries, errors, fields)
