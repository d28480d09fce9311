"""What workers of a cluster do: they tell what they are, keep a study with its machine code, and compute its blocks.

A worker computes one block at a time, with as many threads as Dask gives it: further blocks wait there, so that the
next one begins while the last one's numbers are sent.
"""

import asyncio
import hashlib
import json
import pickle
import platform
import threading
from collections.abc import Mapping, Sequence
from functools import cache, lru_cache
from pathlib import Path
from typing import NamedTuple

import llvmlite
import numba
import numpy as np
import scipy
from distributed import Worker, get_worker
from llvmlite.binding import get_host_cpu_name

from engine import Outcome, set_threads, sources_digest, threads
from sweeps.run.blocks import evaluate_variants
from sweeps.run.carrying import Blocks, Excerpt
from sweeps.run.cost import seconds_of_variant

# Studies whose machines a worker keeps.
MACHINES_KEPT = 2
# Studies that it could make ready again.
STUDIES_KEPT = 64

_ONE_AT_A_TIME = threading.Lock()
_studies: dict[str, bytes] = {}


class NotReadyError(RuntimeError):
    """A worker hasn't the study: one that was started anew under the address of another. The text is its address."""


class Greeting(NamedTuple):
    """What a process says of itself.

    Attributes
    ----------
    versions : dict of str to str
        Of all that numbers depend on, by what it is.
    processor : str
        As LLVM names it.
    host : str
    threads : int
    """

    versions: dict[str, str]
    processor: str
    host: str
    threads: int


@cache
def program_digest() -> str:
    """Digest of all sources of this program and of the compilers' versions."""
    digest = hashlib.sha256(sources_digest().encode())
    root = Path(__file__).parents[2]
    for path in sorted(root.rglob("*.py")):
        digest.update(f"\0{path.relative_to(root).as_posix()}\0".encode() + path.read_bytes())
    return digest.hexdigest()


def own_greeting() -> Greeting:
    """What this process is."""
    versions = {
        "Python": platform.python_version(),
        "numba": numba.__version__,
        "llvmlite": llvmlite.__version__,
        "NumPy": np.__version__,
        "SciPy": scipy.__version__,
        # Last, as it differs wherever one of the others does.
        "machine-sweeps": program_digest()[:12],
    }
    return Greeting(versions, get_host_cpu_name(), platform.node(), threads())


def greet() -> str:
    """What a worker is, as a JSON text: it must be known before anything that the worker pickled is unpickled."""
    return json.dumps(own_greeting()._asdict())


async def make_ready(content: bytes, dask_worker: Worker) -> None:
    """Keep a study on a worker, and compile what it takes.

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
        evaluate_variants(study, study.machine(), *study.values(0, 1))


def digest_of_content(content: bytes) -> str:
    """Name of a pickled study."""
    return hashlib.sha256(content).hexdigest()


@lru_cache(MACHINES_KEPT)
def blocks_of(digest: str) -> Blocks:
    """A study that is kept, with its machine.

    Parameters
    ----------
    digest : str
        As for `digest_of_content`.
    """
    if digest not in _studies:
        raise NotReadyError(get_worker().address)
    return pickle.loads(_studies[digest])


def compute_block(
    digest: str, start: int, stop: int, excerpts: Sequence[Excerpt]
) -> tuple[dict[str, np.ndarray], np.ndarray | None]:
    """Columns of a block of a study that is kept, as of `Blocks.computed`.

    Parameters
    ----------
    digest : str
    start, stop : int
        The block's variants.
    excerpts : sequence of Excerpt
        Outlines of what earlier files hold of it.
    """
    with _ONE_AT_A_TIME:
        return blocks_of(digest).computed(slice(start, stop), excerpts)


def compute_candidates(digest: str, values: Mapping[str, np.ndarray], drop: np.ndarray | None) -> Outcome:
    """Outcome of candidates of a search, as of the machine's `evaluate`.

    Parameters
    ----------
    digest : str
    values : mapping of str to ndarray (candidates,)
        Numbers of the scene (SI).
    drop : ndarray (candidates,) of bool, optional
        Which of them are not to be evaluated.
    """
    with _ONE_AT_A_TIME:
        return blocks_of(digest).study.machine().evaluate(values, drop)


def time_variant(digest: str) -> float:
    """What a variant of a study that is kept takes on this worker [s]."""
    with _ONE_AT_A_TIME:
        study = blocks_of(digest).study
        return seconds_of_variant(study, study.machine())


def make_noise(count: int) -> np.ndarray:
    """So many bytes that can't be compressed, to see how fast they are sent."""
    return np.frombuffer(np.random.default_rng(0).bytes(count), np.uint8)
