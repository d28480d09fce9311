"""Connect to a Dask scheduler by the text after --cluster."""

import logging
import os
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from engine import threads
from sweeps.run.cluster.cluster_errors import ClusterError
from sweeps.text.versions import extra
from sweeps.text.whole_files import scratch_folder

if TYPE_CHECKING:
    from distributed import Client

LOCAL = re.compile(r"local:([1-9]\d{0,3})")
# Timeout for a scheduler's answer [s].
PATIENCE = 10
# Dask's immediate trimming of freed memory slows down blocks, which need it again.
WITH_MEMORY_KEPT = {"distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": None}


# No dashboard: it would be open to everybody.
WITHOUT_PAGES = {"distributed.scheduler.http.routes": [], "distributed.worker.http.routes": []}


@contextmanager
def connected(address: str) -> Iterator["Client"]:
    """Context manager of a cluster client.

    Parameters
    ----------
    address : str
        Scheduler address "tcp://node1:8786" or, with certificates, "tls://node1:8786"; it and its workers can run
        programs here as this user. "local:8" starts eight private processes that share this machine's cores.

    Raises
    ------
    ClusterError
        Dask or cryptography isn't installed, or there is no scheduler at that address.
    """
    with extra("cluster", "--cluster", ClusterError):
        import cryptography  # noqa: F401  (Dask makes certificates with it)
        import dask
        import distributed
    # The program reports errors itself.
    logging.getLogger("distributed").setLevel(logging.CRITICAL + 1)
    local = LOCAL.fullmatch(address)
    if address.startswith("local") and not local:
        raise ClusterError(f"{address!r}: write local:8 for eight processes on this machine")
    if local:
        count = int(local[1])
        # After a signal Python's resource tracker would warn of semaphores.
        others = filter(None, [os.environ.get("PYTHONWARNINGS")])
        os.environ["PYTHONWARNINGS"] = ",".join([*others, "ignore:resource_tracker:UserWarning"])
        with (
            # Python imports from Dask's scratch folder first, and anybody may have made the default,
            # /tmp/dask-scratch-space.
            scratch_folder(dask.config.get("temporary-directory", None)) as folder,
            dask.config.set(
                WITH_MEMORY_KEPT | WITHOUT_PAGES | _new_certificate() | {"temporary-directory": str(folder)}
            ),
            distributed.LocalCluster(
                n_workers=count,
                protocol="tls",
                threads_per_worker=max(threads() // count, 1),
                # Any free local port.
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


def _new_certificate() -> dict[str, object]:
    """Dask settings that restrict communication to processes with a new key, kept in memory."""
    from distributed import Security

    made = Security.temporary()
    roles = {
        f"distributed.comm.tls.{role}.{part}": getattr(made, f"tls_{role}_{part}")
        for role in ("client", "scheduler", "worker")
        for part in ("cert", "key")
    }
    return roles | {"distributed.comm.tls.ca-file": made.tls_ca_file}


@contextmanager
def _reached(address: str) -> Iterator["Client"]:
    from distributed import Client
    from distributed.versions import VersionMismatchWarning

    try:
        with warnings.catch_warnings():
            # Relevant versions are compared when greeting workers.
            warnings.simplefilter("ignore", VersionMismatchWarning)
            client = Client(address, timeout=PATIENCE)
    except (TypeError, RuntimeError):
        # Missing certificates, or certificates required for an address without them.
        raise ClusterError(
            f"{address} needs tls:// and certificates: set them in Dask's configuration, or in the "
            f"variables DASK_DISTRIBUTED__COMM__TLS__CA_FILE, ..__TLS__CLIENT__CERT and ..__TLS__CLIENT__KEY."
        ) from None
    except (OSError, ValueError, TimeoutError) as error:
        raise ClusterError(
            f"no Dask scheduler answers at {address} ({error}). `dask scheduler` starts one and prints its address; "
            f"local:2 doesn't need one."
        ) from None
    try:
        yield client
    finally:
        # Don't wait for a lost scheduler.
        client.close(timeout=1)
