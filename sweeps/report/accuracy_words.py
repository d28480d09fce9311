"""How well a required accuracy is reached: judged by a sample of the variants before a run, by all of them after it."""

import numpy as np

from engine import ACCURACY_REACHED, POSITIONS_USED, Outcome, Verdict
from sweeps.report.sweep_result import SweepResult
from sweeps.study.study import Study


def share_text(share: float) -> str:
    """A share as engineers write it."""
    return f"{100 * share:.6g} %" if share >= 1e-6 else f"{share:.3g}"


def reached_text(reached: np.ndarray, used: np.ndarray, accuracy: float) -> str:
    """How many of the variants that can be computed reach an accuracy, and with how many positions.

    Parameters
    ----------
    reached, used : ndarray (variants,)
        Columns `accuracy_reached` and `positions_used`; NaN of variants that fail.
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
        words += "; for the others more positions did not help: see their error figures (accuracy_reached = 0)"
    return words


def of_result(result: SweepResult) -> list[str]:
    """A line about the accuracy of a result, if one was asked."""
    if result.accuracy is None or ACCURACY_REACHED.name not in result.columns:
        return []
    return [reached_text(result.columns[ACCURACY_REACHED.name], result.columns[POSITIONS_USED.name], result.accuracy)]


def of_sample(study: Study, outcome: Outcome) -> str:
    """The same, expected from a sample of a study's variants."""
    works = int((outcome.status == Verdict.OK).sum())
    reached, used = (outcome.summaries[quantity.name] for quantity in (ACCURACY_REACHED, POSITIONS_USED))
    text = reached_text(reached, used, study.accuracy)
    return f"{text} (of {works} variants tried)"
