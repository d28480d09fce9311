"""What workers of a cluster are given to do in tests: blocks that are slow, fail, or kill whoever computes them."""

import os
import signal
import time
from pathlib import Path

import numpy as np
from distributed import Client

from sweeps.run.cluster import on_workers
from sweeps.run.cluster.crew import Crew
from sweeps.run.reuse import Blocks
from sweeps.run.runner import layout_of
from sweeps.study.study import Study

# Of the study in which each block is 40 variants: the first variant of the third block.
THIRD = 80


def crew_on(client: Client, study: Study) -> Crew:
    return Crew(client, Blocks(study, layout_of(study)), print)


def forget() -> None:
    """As if the worker had been started anew."""
    on_workers._studies.clear()
    on_workers.blocks_of.cache_clear()


def squared(digest: str, number: int) -> int:
    return number**2


def squared_but_one(digest: str, number: int) -> int:
    if number == 3:
        raise ArithmeticError("three is refused")
    return number**2


def squared_by_survivors(digest: str, number: int) -> int:
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(0.02)
    return number**2


def block_but_one(digest: str, variants: slice, excerpts: list) -> dict[str, np.ndarray]:
    if variants.start == THIRD:
        raise ArithmeticError("this block is refused")
    return on_workers.compute_block(digest, variants, excerpts)


def block_killing_once(digest: str, variants: slice, excerpts: list) -> dict[str, np.ndarray]:
    """In mid-block the worker of the third block is killed, the first time."""
    note = Path(os.environ["CLUSTER_TEST_NOTE"])
    if variants.start == THIRD and not note.exists():
        note.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return on_workers.compute_block(digest, variants, excerpts)


def slow_block(digest: str, variants: slice, excerpts: list) -> dict[str, np.ndarray]:
    time.sleep(0.2)
    return on_workers.compute_block(digest, variants, excerpts)
