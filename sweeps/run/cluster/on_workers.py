"""Functions for cluster workers: identify, store a study with its compiled code, compute its blocks.

A worker computes one block at a time with all its Dask threads; further blocks are queued there, so that the next one
starts while the last result is sent.
"""

import asyncio
import hashlib
import json
import pickle
import platform
import threading
from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from distributed import Worker, get_worker
from llvmlite.binding import get_host_cpu_name

from engine import set_threads, sources_digest, threads
from sweeps.run.blocks import evaluate_variants
from sweeps.run.cost import seconds_of_variant
from sweeps.run.reuse import Blocks, Excerpt
from sweeps.text.versions import versions_of

# Prepared studies per worker.
MACHINES_KEPT = 2
# Stored studies per worker.
STUDIES_KEPT = 64

_ONE_AT_A_TIME = threading.Lock()
_studies: dict[str, bytes] = {}


class NotReadyError(RuntimeError):
    """A restarted worker lacks the study. The text is its address."""


class Greeting(NamedTuple):
    """Identity of a process.

    Attributes
    ----------
    versions : dict of str to str
        Versions of everything that numbers depend on.
    processor : str
        As LLVM names it.
    threads : int
    """

    versions: dict[str, str]
    processor: str
    threads: int


def own_greeting() -> Greeting:
    """Identity of this process."""
    versions = {"python": platform.python_version()} | versions_of("numba", "llvmlite", "numpy", "scipy")
    # Last, as it includes the others.
    versions["machine-sweeps"] = sources_digest("sweeps")[:12]
    return Greeting(versions, get_host_cpu_name(), threads())


def greet() -> str:
    """Identity of a worker as JSON, checked before unpickling its data."""
    return json.dumps(own_greeting()._asdict())


async def make_ready(content: bytes, dask_worker: Worker) -> None:
    """Store a study on a worker and compile it.

    Parameters
    ----------
    content : bytes
        Pickled `Blocks`.
    dask_worker : Worker
    """
    await asyncio.to_thread(_keep, content, dask_worker.state.nthreads)


def _keep(content: bytes, count: int) -> None:
    set_threads(count)
    digest = digest_of_content(content)
    while len(_studies) >= STUDIES_KEPT:
        del _studies[next(iter(_studies))]
    _studies[digest] = content
    with _ONE_AT_A_TIME:
        study = blocks_of(digest).study
        evaluate_variants(study, *study.values(0, 1))


def digest_of_content(content: bytes) -> str:
    """Name of a pickled study."""
    return hashlib.sha256(content).hexdigest()


@lru_cache(MACHINES_KEPT)
def blocks_of(digest: str) -> Blocks:
    """A stored study with its machine.

    Parameters
    ----------
    digest : str
        As for `digest_of_content`.
    """
    if digest not in _studies:
        raise NotReadyError(get_worker().address)
    return pickle.loads(_studies[digest])


def compute_block(
    digest: str, variants: slice, excerpts: Sequence[Excerpt]
) -> tuple[dict[str, np.ndarray], np.ndarray | None]:
    """Columns of a block of a stored study, as from `Blocks.computed`.

    Parameters
    ----------
    digest : str
    variants : slice
        Those of the block.
    excerpts : sequence of Excerpt
        Outlines of its reusable parts.
    """
    with _ONE_AT_A_TIME:
        return blocks_of(digest).computed(variants, excerpts)


def compute_candidates(digest: str, values: dict[str, np.ndarray], drop: np.ndarray) -> dict[str, np.ndarray]:
    """Columns of candidates, as from `evaluate_variants`.

    Parameters
    ----------
    digest : str
    values : mapping of str to ndarray (candidates,)
        Numbers of the scene (SI).
    drop : ndarray (candidates,) of bool, optional
        Candidates to skip.
    """
    with _ONE_AT_A_TIME:
        return evaluate_variants(blocks_of(digest).study, values, drop)


def time_variant(digest: str) -> float:
    """Time per variant of a stored study on this worker [s]."""
    with _ONE_AT_A_TIME:
        return seconds_of_variant(blocks_of(digest).study)


def make_noise(count: int) -> np.ndarray:
    """Incompressible bytes, to measure the network."""
    return np.frombuffer(np.random.default_rng(0).bytes(count), np.uint8)
