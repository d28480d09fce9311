"""Candidates of a search distributed over cluster workers."""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np

from engine import Outcome
from sweeps.run.blocks import joined
from sweeps.run.cluster.cluster_errors import UnfinishedError
from sweeps.run.cluster.crew import UNDER_WAY, Crew
from sweeps.run.cluster.on_workers import compute_candidates

# Minimum candidates per job.
WORTH_SENDING = 16


def share_out(crew: Crew, values: Mapping[str, np.ndarray], dropped: np.ndarray | None, count: int) -> Outcome:
    """Outcome of candidates, as from the machine's `evaluate`.

    Parameters
    ----------
    crew : Crew
    values : mapping of str to ndarray (count,)
        Numbers of the scene (SI).
    dropped : ndarray (count,) of bool, optional
        Candidates to skip.
    count : int

    Raises
    ------
    UnfinishedError
        Some candidates failed to compute.
    """
    crew.assemble()
    pieces = max(min(UNDER_WAY * len(crew.members), count // WORTH_SENDING), 1)
    ends = pairwise(i * count // pieces for i in range(pieces + 1))
    some = [slice(*part) for part in ends]
    jobs = (({p: v[s] for p, v in values.items()}, None if dropped is None else dropped[s]) for s in some)
    found = dict(crew.results(compute_candidates, enumerate(jobs)))
    if crew.failures:
        why = crew.failures[min(crew.failures)]
        raise UnfinishedError(f"candidates couldn't be computed ({why}): earlier generations are kept")
    return _joined([found[i] for i in range(pieces)])


def _joined(parts: list[Outcome]) -> Outcome:
    alone = (np.concatenate([part[i] for part in parts]) for i in range(3))
    tables = (joined([part[i] for part in parts]) for i in range(3, 6))
    return Outcome(*alone, *tables)
