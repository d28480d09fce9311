"""From the text after --cluster to a client of a Dask scheduler."""

import logging
import os
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from engine import threads
from sweeps.run.cluster.cluster_errors import ClusterError

if TYPE_CHECKING:
    from distributed import Client

LOCAL = re.compile(r"local:([1-9]\d{0,3})")
# Seconds that a scheduler has to answer.
PATIENCE = 10
# Dask has its workers give freed memory back at once; blocks, which need it again, take longer by that.
WITH_MEMORY_KEPT = {"distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": None}


@contextmanager
def connected(address: str) -> Iterator["Client"]:
    """A client of a cluster, while something runs on it.

    Parameters
    ----------
    address : str
        Of a scheduler, such as "tcp://node1:8786"; or "local:8", which starts eight processes on this machine that
        share its cores.

    Raises
    ------
    ClusterError
        Dask isn't installed, or there is no scheduler at that address.
    """
    try:
        import dask
        import distributed
    except ImportError as error:
        message = f"--cluster needs Dask ({error}): pip install 'machine-sweeps[cluster]'"
        raise ClusterError(message) from None
    # What concerns the study is said in sentences.
    logging.getLogger("distributed").setLevel(logging.CRITICAL + 1)
    local = LOCAL.fullmatch(address)
    if address.startswith("local") and not local:
        raise ClusterError(f"{address!r}: write local:8 for eight processes on this machine")
    if local:
        count = int(local[1])
        # A signal ends the program at once, and Python's own helper would complain of semaphores it then removes.
        others = filter(None, [os.environ.get("PYTHONWARNINGS")])
        os.environ["PYTHONWARNINGS"] = ",".join([*others, "ignore:resource_tracker:UserWarning"])
        with (
            dask.config.set(WITH_MEMORY_KEPT),
            distributed.LocalCluster(
                n_workers=count,
                threads_per_worker=max(threads() // count, 1),
                # Any port that is free, for this machine alone.
                dashboard_address="127.0.0.1:0",
                scheduler_kwargs={"dashboard": False},
                silence_logs=logging.CRITICAL + 1,
            ) as cluster,
            distributed.Client(cluster) as client,
        ):
            yield client
        return
    with _reached(address) as client:
        yield client


@contextmanager
def _reached(address: str) -> Iterator["Client"]:
    from distributed import Client
    from distributed.versions import VersionMismatchWarning

    try:
        with warnings.catch_warnings():
            # Versions that numbers depend on are compared when workers are greeted.
            warnings.simplefilter("ignore", VersionMismatchWarning)
            client = Client(address, timeout=PATIENCE)
    except (OSError, ValueError, TimeoutError) as error:
        raise ClusterError(
            f"no Dask scheduler answers at {address} ({error}). `dask scheduler` starts one, and tells its address; "
            f"local:2 needs none."
        ) from None
    try:
        yield client
    finally:
        # What a lost scheduler doesn't answer isn't waited for.
        client.close(timeout=1)
