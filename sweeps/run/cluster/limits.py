"""Bottleneck of a run on a cluster: workers, network or the client's disk."""

import math
import time
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sweeps.run.cluster.cluster_errors import UnfinishedError
from sweeps.run.cluster.crew import Crew
from sweeps.run.cluster.on_workers import make_noise, time_variant
from sweeps.store import FileLayout, Store
from sweeps.text.whole_files import scratch_folder

# Bytes sent and written to measure speed, and number of repetitions.
TRIED = 32_000_000
TRIES = 3
BLOCKS_TRIED = 8


class ClusterLimits(NamedTuple):
    """Variants per second of each part of a cluster.

    Attributes
    ----------
    workers, network, disk : float
        All workers computing, the client fetching, the client writing.
    """

    workers: float
    network: float
    disk: float

    @property
    def seconds(self) -> float:
        """Overall time per variant: the client fetches and writes alternately while workers compute."""
        return max(1.0 / self.workers, 1.0 / self.network + 1.0 / self.disk)

    @property
    def least(self) -> str:
        """The bottleneck."""
        if self.seconds * self.workers <= 1.0:
            return "workers"
        return "network" if self.network < self.disk else "disk"


def measure_limits(crew: Crew, folder: Path) -> ClusterLimits:
    """Measure the bottleneck of a study on a cluster.

    Parameters
    ----------
    crew : Crew
    folder : Path
        Result folder, for a temporary test file.

    Raises
    ------
    ClusterError
        No usable worker, or a worker fails.
    StoreError
        The folder isn't writable.
    """
    crew.assemble()
    layout = crew.blocks.layout
    row = sum(math.prod(layout.shape(c)[1:]) * np.dtype(c.dtype).itemsize for c in layout.columns)
    return ClusterLimits(_computed_rate(crew), _fetched_rate(crew) / row, _written_rate(layout, row, folder) / row)


def _computed_rate(crew: Crew) -> float:
    """Variants per second of all workers together."""
    submit = crew.client.submit
    timed = [submit(time_variant, crew.digest, workers=[worker], pure=False) for worker in crew.members]
    try:
        return sum(1.0 / seconds for seconds in crew.client.gather(timed))
    except Exception as error:
        # Any error of the study or of Dask.
        raise UnfinishedError(f"a worker can't compute the study ({type(error).__name__}: {error})") from None


def _fetched_rate(crew: Crew) -> float:
    """Bytes per second from a worker."""
    least = math.inf
    for _ in range(TRIES):
        noise = crew.client.submit(make_noise, TRIED, workers=list(crew.members), pure=False)
        crew.client.submit(len, noise).result()
        begin = time.perf_counter()
        noise.result()
        least = min(least, time.perf_counter() - begin)
    return TRIED / least


def _written_rate(layout: FileLayout, row: int, folder: Path) -> float:
    """Bytes per second of results, from creating the file to renaming it."""
    count = max(TRIED // (row * BLOCKS_TRIED), 1)
    draft = replace(layout, variants=count * BLOCKS_TRIED, block=count)
    noise = np.random.default_rng(0)
    shapes = {c: (count, *draft.shape(c)[1:]) for c in draft.columns}
    block = {
        c.name: noise.random(shape).astype(c.dtype) if np.dtype(c.dtype).kind == "f" else np.zeros(shape, c.dtype)
        for c, shape in shapes.items()
    }
    with scratch_folder(folder) as scratch:
        begin = time.perf_counter()
        with Store.open(scratch / "trial.h5", draft) as store:
            for i in store.pending:
                store.write(i, block)
            store.finish()
        seconds = time.perf_counter() - begin
    return row * count * BLOCKS_TRIED / seconds
