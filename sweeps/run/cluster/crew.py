"""The workers of a run and their jobs.

Dask balances the load and restarts jobs of lost workers. It only uses workers that were greeted, run the same program,
and have compiled the study.
"""

import itertools
import json
import pickle
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import Future as Call
from concurrent.futures import ThreadPoolExecutor
from queue import Empty, Queue
from typing import Any, NamedTuple, Self

import numpy as np
from distributed import Client, Future, KilledWorker
from distributed.client import CancelledError
from distributed.comm import connect
from distributed.core import send_recv
from distributed.protocol.serialize import merge_and_deserialize

from engine import counted
from sweeps.run.blocks import joined
from sweeps.run.cluster import on_workers
from sweeps.run.cluster.cluster_errors import ClusterError, UnfinishedError
from sweeps.run.reuse import Blocks

# Attempts per failing job.
ATTEMPTS = 3
# Jobs per worker: one running, one queued.
UNDER_WAY = 2
# Minimum candidates per job.
WORTH_SENDING = 16
# Interval between checks for workers [s].
LOOK = 1.0
# Refusals reported individually.
NAMED = 3
# Texts and numbers, which contain no code.
PLAIN = ["msgpack"]


# Job number and function arguments.
Job = tuple[int, tuple]


class _Attempt(NamedTuple):
    job: Job
    workers: frozenset[str]


class _GoneError(Exception):
    """All workers that may have a result are gone."""


class Crew:
    """Cluster workers prepared for a study. Use as a context manager.

    Parameters
    ----------
    client : Client
    blocks : Blocks
        Blocks of the study.
    tell : callable
        Receives messages on refusals and waiting.

    Attributes
    ----------
    members : dict of str to Greeting
        Workers ready now, by address.
    failures : dict of int to str
        Abandoned jobs and reasons.

    Raises
    ------
    ClusterError
        When computing: no usable worker.
    UnfinishedError
        At any time: the scheduler is lost.
    """

    def __init__(self, client: Client, blocks: Blocks, tell: Callable[[str], None]) -> None:
        self.client, self.blocks, self.tell = client, blocks, tell
        self._content = pickle.dumps(blocks)
        self.digest = on_workers.digest_of_content(self._content)
        self.members: dict[str, on_workers.Greeting] = {}
        self.failures: dict[int, str] = {}
        self._seen: dict[str, on_workers.Greeting] = {}
        self._refused: dict[str, str] = {}
        self._aside = ThreadPoolExecutor(1, thread_name_prefix="crew")
        self._fetching = ThreadPoolExecutor(1, thread_name_prefix="fetching")
        self._greeting: Call | None = None
        self._looked = -LOOK
        self._waits = False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self._aside.shutdown(wait=False)
        self._fetching.shutdown(wait=False)

    @property
    def words(self) -> str:
        """Workers, threads and processors used."""
        threads = sum(member.threads for member in self._seen.values())
        kinds = Counter(member.processor for member in self._seen.values())
        processors = ", ".join(f"{kind} ({count})" for kind, count in sorted(kinds.items()))
        return f"{counted(len(self._seen), 'worker')}, {counted(threads, 'thread')}; processors: {processors}"

    # Members

    def _look(self) -> None:
        """Update the members at intervals, greeting new workers while others work."""
        if self._greeting and self._greeting.done():
            done, self._greeting = self._greeting, None
            self._welcome(*done.result())
        if time.monotonic() - self._looked < LOOK:
            return
        self._looked = time.monotonic()
        try:
            there = self.client.nthreads()
        except OSError:
            raise self._lost() from None
        self.members = {address: member for address, member in self.members.items() if address in there}
        self._refused = {address: why for address, why in self._refused.items() if address in there}
        new = sorted(there.keys() - self.members.keys() - self._refused.keys())
        if new and not self._greeting:
            self._greeting = self._aside.submit(self._greet, {worker: there[worker] for worker in new})

    def _greet(self, threads: dict[str, int]) -> tuple[dict[str, on_workers.Greeting], dict[str, str]]:
        """Prepare workers: those now ready, and why others are refused."""
        own, ready, refused = on_workers.own_greeting().versions, {}, {}
        try:
            greetings = self.client.sync(_greetings, self.client, list(threads))
        except OSError:
            return {}, {}
        for worker, found in greetings.items():
            if isinstance(found, str):
                refused[worker] = found
            elif differing := [name for name, version in own.items() if found.versions.get(name) != version]:
                refused[worker] = _other_version(differing[0], found.versions, own)
            else:
                ready[worker] = found._replace(threads=threads[worker])
        answers = self._asked(on_workers.make_ready, list(ready), self._content)
        refused |= {w: f"it can't compile the study ({why})" for w, why in answers.items() if why is not None}
        return {worker: ready[worker] for worker, why in answers.items() if why is None}, refused

    def _asked(self, function: Callable, workers: list[str], *arguments: object) -> dict[str, Any]:
        """Answers or errors of some workers, without workers that disappear."""
        if not workers:
            return {}
        try:
            found = self.client.run(function, *arguments, workers=workers, on_error="return")
        except OSError:
            return {}
        return {worker: answer for worker, answer in found.items() if not isinstance(answer, OSError)}

    def _welcome(self, ready: dict[str, on_workers.Greeting], refused: dict[str, str]) -> None:
        self.members |= ready
        self._seen |= ready
        self._refused |= refused
        if refused and (self.members or self._waits):
            self.tell(f"Excluded: {self._refusals()}")
        if ready:
            self._waits = False

    def _refusals(self) -> str:
        shown = [f"worker {worker}: {why}" for worker, why in sorted(self._refused.items())[:NAMED]]
        more = len(self._refused) - len(shown)
        return "; ".join([*shown, *([f"and {more} more"] if more else [])])

    def _tell_waiting(self, why: str) -> None:
        if not self._waits and not self._greeting:
            self._waits = True
            self.tell(f"{why[0].upper()}{why[1:]}: waiting for one.")

    def _lost(self) -> UnfinishedError:
        kept = "written results are kept; repeat the command, with a new scheduler or without --cluster, to resume"
        return UnfinishedError(f"the connection to the Dask scheduler is lost: {kept}")

    def assemble(self) -> None:
        """Wait until a worker is ready.

        Raises
        ------
        ClusterError
            No usable worker.
        """
        self._look()
        while not self.members:
            if self._refused and not self._greeting:
                raise ClusterError(f"the cluster has no usable worker: {self._refusals()}")
            self._tell_waiting("no workers")
            time.sleep(LOOK / 10)
            self._look()

    # Jobs

    def seconds(self) -> float:
        """Time per variant on a worker."""
        seconds = dict(self.results(on_workers.time_variant, [(0, ())])).get(0)
        if seconds is None:
            raise UnfinishedError(f"can't compute any variant ({self.failures[0]})")
        return seconds

    def share_out(self, values: dict[str, np.ndarray], drop: np.ndarray) -> dict[str, np.ndarray]:
        """Columns of candidates, as from `evaluate_variants`.

        Parameters
        ----------
        values : dict of str to ndarray (count,)
            Parameters (SI).
        drop : ndarray (count,) of bool
            Candidates to skip.

        Raises
        ------
        UnfinishedError
            Some candidates failed to compute.
        """
        self.assemble()
        pieces = max(min(UNDER_WAY * len(self.members), drop.size // WORTH_SENDING), 1)
        some = [slice(*ends) for ends in itertools.pairwise(i * drop.size // pieces for i in range(pieces + 1))]
        jobs = (({name: column[s] for name, column in values.items()}, drop[s]) for s in some)
        found = dict(self.results(on_workers.compute_candidates, enumerate(jobs)))
        if self.failures:
            why = self.failures[min(self.failures)]
            raise UnfinishedError(f"candidates couldn't be computed ({why}): earlier generations are kept")
        return joined([found[i] for i in range(pieces)])

    def results(self, function: Callable, jobs: Iterable[Job]) -> Iterator[tuple[int, Any]]:
        """Job numbers and results in any order; abandoned jobs go to `failures`.

        Jobs are taken on demand and results fetched one by one, to bound memory.

        Parameters
        ----------
        function : callable
            Called on workers with the study's digest and the job's arguments.
        jobs : iterable of Job
        """
        self.assemble()
        self.failures = {}
        waiting, suspects, deaths = iter(jobs), deque[Job](), Counter[int]()
        under_way: dict[Future, _Attempt] = {}
        ended: Queue[Future] = Queue()
        while True:
            self._look()
            for job in self._next(waiting, suspects, len(under_way)):
                workers = frozenset(self.members)
                how = {"workers": sorted(workers), "retries": ATTEMPTS - 1, "pure": False}
                future = self.client.submit(function, self.digest, *job[1], **how)
                under_way[future] = _Attempt(job, workers)
                future.add_done_callback(ended.put)
            if not under_way and self.members:
                return
            alone = len(under_way) == 1
            for future in self._ended(under_way, ended):
                attempt = under_way[future]
                error = self._error_of(future)
                if error is None:
                    try:
                        found = self._fetched(future, attempt)
                    except _GoneError:
                        # As for running jobs, below.
                        continue
                    del under_way[future]
                    yield attempt.job[0], found
                    continue
                del under_way[future]
                if isinstance(error, on_workers.NotReadyError):
                    self.members.pop(str(error), None)
                    suspects.append(attempt.job)
                elif not isinstance(error, KilledWorker):
                    self.failures[attempt.job[0]] = f"{type(error).__name__}: {error}"
                elif alone:
                    self.failures[attempt.job[0]] = "it kills its workers"
                else:
                    suspects.append(attempt.job)
            for future in [f for f, attempt in under_way.items() if not attempt.workers & self.members.keys()]:
                job = under_way.pop(future).job
                future.cancel()
                deaths[job[0]] += 1
                if deaths[job[0]] < ATTEMPTS:
                    suspects.append(job)
                else:
                    self.failures[job[0]] = f"its workers were lost {ATTEMPTS} times"

    def _next(self, waiting: Iterator[Job], suspects: deque[Job], busy: int) -> Iterator[Job]:
        """Jobs to start now.

        Jobs of lost workers run one at a time, to find the culprit.
        """
        if not self.members:
            self._tell_waiting("no worker is left")
        elif suspects:
            if not busy:
                yield suspects.popleft()
        else:
            yield from itertools.islice(waiting, max(UNDER_WAY * len(self.members) - busy, 0))

    def _ended(self, under_way: Mapping[Future, _Attempt], ended: Queue[Future]) -> list[Future]:
        """Finished jobs, after at most a second."""
        if not under_way:
            time.sleep(LOOK / 10)
            return []
        try:
            found = [ended.get(timeout=LOOK)]
        except Empty:
            return []
        while not ended.empty():
            found.append(ended.get())
        return [future for future in found if future in under_way]

    def _error_of(self, future: Future) -> BaseException | None:
        """Why a finished job failed."""
        try:
            return future.exception() if future.status != "finished" else None
        except (CancelledError, OSError):
            raise self._lost() from None

    def _fetched(self, future: Future, attempt: _Attempt) -> Any:
        """Fetch a result, which may be lost with its worker."""
        call = self._fetching.submit(future.result)
        while True:
            try:
                return call.result(timeout=LOOK)
            except (CancelledError, OSError):
                # Includes timeouts.
                if call.done():
                    raise self._lost() from None
            self._look()
            if not attempt.workers & self.members.keys():
                raise _GoneError


def _other_version(name: str, theirs: Mapping[str, str], ours: Mapping[str, str]) -> str:
    found = f"it has {name} {theirs.get(name)}, this machine has {ours[name]}"
    return f"{found}; install the same version there and restart the worker"


async def _greetings(client: Client, workers: list[str]) -> dict[str, on_workers.Greeting | str]:
    """Greetings of answering workers, or why one is incompatible.

    Their answers are not unpickled. The question is an expression, so that a missing module still gives an answer.
    """
    expression = f"__import__({on_workers.greet.__module__!r}, fromlist=['greet']).greet()"
    call = {"function": pickle.dumps(eval), "args": pickle.dumps((expression,)), "kwargs": pickle.dumps({})}
    comm = await connect(client.scheduler.address, deserialize=False, **client.connection_args)
    request = {"op": "broadcast", "msg": {"op": "run", **call}, "workers": workers, "on_error": "ignore"}
    answers = await send_recv(comm, serializers=PLAIN, close=True, **request)
    return {worker: _greeting(answer) for worker, answer in answers.items()}


def _greeting(answer: Mapping[str, Any]) -> on_workers.Greeting | str:
    """A worker's greeting, or why it is incompatible."""
    if answer.get("status") != "OK":
        return _stranger(str(answer.get("exception_text")))
    try:
        sent = answer["result"]
        found = on_workers.Greeting(**json.loads(merge_and_deserialize(sent.header, sent.frames, deserializers=PLAIN)))
        return found._replace(versions={**found.versions}, processor=str(found.processor))
    except Exception as error:
        # Incompatible workers may send anything.
        return _stranger(f"{type(error).__name__}: {error}")


def _stranger(error: str) -> str:
    """Why a worker doesn't answer correctly."""
    if "ModuleNotFoundError" in error:
        missing = error.partition("No module named ")[2].strip("\"')\\ ") or "machine-sweeps"
        return f"it has no {missing}; pip install 'machine-sweeps[cluster]' there and restart the worker"
    return f"it has another version of machine-sweeps ({error}); install the same version there and restart the worker"
