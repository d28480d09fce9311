"""Candidates of a search distributed over cluster workers."""

from itertools import pairwise

import numpy as np

from sweeps.run.blocks import joined
from sweeps.run.cluster.cluster_errors import UnfinishedError
from sweeps.run.cluster.crew import UNDER_WAY, Crew
from sweeps.run.cluster.on_workers import compute_candidates

# Minimum candidates per job.
WORTH_SENDING = 16


def share_out(crew: Crew, values: dict[str, np.ndarray], drop: np.ndarray) -> dict[str, np.ndarray]:
    """Columns of candidates, as from `evaluate_variants`.

    Parameters
    ----------
    crew : Crew
    values : dict of str to ndarray (count,)
        Parameters (SI).
    drop : ndarray (count,) of bool
        Candidates to skip.

    Raises
    ------
    UnfinishedError
        Some candidates failed to compute.
    """
    crew.assemble()
    pieces = max(min(UNDER_WAY * len(crew.members), drop.size // WORTH_SENDING), 1)
    some = [slice(*ends) for ends in pairwise(i * drop.size // pieces for i in range(pieces + 1))]
    jobs = (({name: column[s] for name, column in values.items()}, drop[s]) for s in some)
    found = dict(crew.results(compute_candidates, enumerate(jobs)))
    if crew.failures:
        why = crew.failures[min(crew.failures)]
        raise UnfinishedError(f"candidates couldn't be computed ({why}): earlier generations are kept")
    return joined([found[i] for i in range(pieces)])
