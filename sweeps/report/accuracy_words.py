"""Report of the accuracy reached: from a sample of variants before a run, from all of them after it."""

import numpy as np

from engine import ACCURACY_REACHED, POSITIONS_USED, Outcome, Verdict
from sweeps.report.sweep_result import SweepResult
from sweeps.study.study import Study


def share_text(share: float) -> str:
    """A fraction as a percentage."""
    return f"{100 * share:.6g} %" if share >= 1e-6 else f"{share:.3g}"


def reached_text(reached: np.ndarray, used: np.ndarray, accuracy: float) -> str:
    """Share of the computed variants that reach an accuracy, and their number of positions.

    Parameters
    ----------
    reached, used : ndarray (variants,)
        Columns `accuracy_reached` and `positions_used`; NaN for failed variants.
    accuracy : float
    """
    known = np.isfinite(reached)
    count, got = int(known.sum()), int(np.nansum(reached))
    if not count:
        return f"accuracy {share_text(accuracy)}: no variant could be computed"
    whole = "all" if got == count else f"{got} of {count}"
    low, middle, high = np.nanmin(used), np.nanmedian(used), np.nanmax(used)
    with_how_many = f"{low:.0f} positions" if low == high else f"{low:.0f} to {high:.0f} positions, mostly {middle:.0f}"
    words = f"accuracy {share_text(accuracy)}: reached by {whole}, with {with_how_many}"
    if got < count:
        words += "; more positions did not help the others: see their error estimates (accuracy_reached = 0)"
    return words


def of_result(result: SweepResult) -> list[str]:
    """A line on the accuracy of a result, if one was requested."""
    if result.accuracy is None or ACCURACY_REACHED.name not in result.columns:
        return []
    return [reached_text(result.columns[ACCURACY_REACHED.name], result.columns[POSITIONS_USED.name], result.accuracy)]


def of_sample(study: Study, outcome: Outcome) -> str:
    """A line on the expected accuracy, from a sample of a study's variants."""
    works = int((outcome.status == Verdict.OK).sum())
    reached, used = (outcome.summaries[quantity.name] for quantity in (ACCURACY_REACHED, POSITIONS_USED))
    text = reached_text(reached, used, study.accuracy)
    return f"{text} (sample of {works} variants)"
