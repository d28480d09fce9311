"""What a cluster costs beside one process, and what would limit a thousand cores; writes cluster.md beside itself."""

import math
import os
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from distributed import Client
from llvmlite.binding import get_host_cpu_name

from engine import set_threads
from sweeps import Study, read_study, run_study
from sweeps.run import runner
from sweeps.run.blocks import LARGEST_BLOCK, block_size, most_at_once
from sweeps.run.carrying import Blocks
from sweeps.run.cluster.connecting import connected
from sweeps.run.cluster.crew import Crew
from sweeps.run.cluster.on_workers import make_noise
from sweeps.run.runner import layout_of
from sweeps.store import Store
from sweeps.study.bundled import bundled_studies
from sweeps.study.sampling import Columns, Design

HERE = Path(__file__).parent
PAIRS, BLOCKS = 7, 4
BLOCK_SECONDS = (0.3, 1.0)
VARIANTS, HOSTS, THREADS = 10**9, 31, 32
# Bytes a second of a network of 10 Gbit/s.
NETWORK = 1.25e9
EMPTY_JOBS, NOISE, WRITTEN = 300, 64_000_000, 8
STUDIES = ("crank_press", "four_stroke_engine", "toggle_press", "emergency_stop", "press_start")
BESIDE = "press_start"

HEAD = """# A cluster

Processor {processor}, {cores} cores, shared with others (load {load:.1f} when this was begun): everything is measured
in processor time. Made by `python results/performance/cluster.py`.

## Beside one process

`{beside}`, a study of motion, {micros:.0f} µs a variant: {blocks} blocks, computed and written by one process on one
thread; or computed by one worker with one thread, while the client fetches and writes. Runs are taken in pairs, one
right after the other: medians of {pairs} ratios, with the least and the greatest. The worker's time is what a run takes
where the client has a core of its own.

| block [s] | variants | worker / one process | worker and client / one process |
|---|---|---|---|
"""

PAPER = """
## 10⁹ variants on 1000 cores, on paper

{hosts} workers of {threads} threads. Computing scales with the cores, as variants have nothing to do with each other
(assumed), from what a variant takes on one thread here. One client fetches all rows over a network of 10 Gbit/s
(assumed). Of its processor it takes {fetch:.2f} s to fetch a GB, {write:.2f} s to check and write it (a disk slower
than that limits sooner), and {job:.1f} ms for each block, its scheduler with it (all measured).

| study | variant [µs] | row [B] | file [GB] | workers [s] | network [s] | client [s] | limit | cores busy |
|---|---|---|---|---|---|---|---|---|
"""

END = """
The client saturates first: each GB is fetched, checked and written by it, and each block costs it some milliseconds.
The last column says how many cores keep it busy. Beyond that more cores don't help; fewer columns, `require`, or parts
of a study on several clients do. `sweeps check STUDY --cluster ADDRESS` measures the same on the cluster at hand.
"""


def again_and_again(study: Study, size: int) -> Study:
    """The first variants of a study, repeated, none of them dropped."""
    values, drop = study.values(0, min(study.design.size, 2 * size))
    columns = [np.resize(values[name][~drop], size) for name in study.design.names]
    return replace(study, design=Design((Columns(study.design.names, columns),)), require=())


def processor_time(function: Callable, *arguments: object) -> float:
    """What a function takes, once it has run before [s]."""
    function(*arguments)
    begin = time.process_time()
    function(*arguments)
    return time.process_time() - begin


def variant_time(study: Study) -> float:
    """What a variant takes in a block of full size [s]."""
    asked = again_and_again(study, most_at_once(study, study.machine()))
    blocks = Blocks(asked, layout_of(asked, asked.machine()))
    return processor_time(blocks.columns, slice(0, asked.design.size)) / asked.design.size


def paired_ratios(study: Study, client: Client, block: int) -> np.ndarray:
    """What a run takes with a cluster over what it takes without: the worker, worker and client (pairs, 2)."""
    asked = again_and_again(study, block * BLOCKS)
    runner.block_size = lambda *_: block
    found = []
    with tempfile.TemporaryDirectory() as folder:
        # The first pair loads machine code.
        for _ in range(PAIRS + 1):
            on, alone = (run_time(asked, Path(folder) / "r.h5", client, where) for where in (client, None))
            found.append(on / alone[1])
    return np.array(found[1:])


def run_time(study: Study, path: Path, client: Client, where: Client | None) -> np.ndarray:
    """Processor time of the worker, and of it and this process, in a run [s]."""

    def now() -> np.ndarray:
        worker = sum(client.run(time.process_time).values())
        return np.array([worker, worker + time.process_time()])

    begin = now()
    run_study(study, path, restart=True, client=where)
    return now() - begin


def nothing(digest: str, number: int) -> int:
    """A block that takes no time."""
    return number


def job_time(client: Client, study: Study) -> float:
    """What a block that does nothing takes of this process, the scheduler in it [s]."""
    with Crew(client, Blocks(study, layout_of(study, study.machine())), print) as crew:
        crew.assemble()
        begin = time.process_time()
        for _ in crew.results(nothing, ((i, (i,)) for i in range(EMPTY_JOBS))):
            pass
        return (time.process_time() - begin) / EMPTY_JOBS


def fetch_time(client: Client) -> float:
    """What fetching takes of this process, a byte [s]."""
    noise = client.submit(make_noise, NOISE)
    client.submit(len, noise).result()
    return processor_time(noise.result) / NOISE


def write_time(study: Study) -> float:
    """What writing blocks of full size takes, a byte [s]."""
    size = most_at_once(study, study.machine())
    asked = again_and_again(study, size * WRITTEN)
    blocks = Blocks(asked, replace(layout_of(asked, asked.machine()), block=size))
    columns = blocks.columns(slice(0, size))
    with tempfile.TemporaryDirectory() as folder:
        begin = time.process_time()
        with Store.open(Path(folder) / "w.h5", blocks.layout) as store:
            for i in store.pending:
                store.write(i, columns)
            store.finish()
        return (time.process_time() - begin) / (size * WRITTEN * row_bytes(study))


def row_bytes(study: Study) -> int:
    """What the file holds of a variant."""
    layout = layout_of(study, study.machine())
    return sum(math.prod(layout.shape(c)[1:]) * np.dtype(c.dtype).itemsize for c in layout.columns)


def paper_rows(fetch: float, write: float, job: float) -> Iterator[str]:
    """A row of the table for each study."""
    for name in STUDIES:
        study = read_study(bundled_studies()[name])
        seconds, row, cores = variant_time(study), row_bytes(study), HOSTS * THREADS
        many = again_and_again(study, LARGEST_BLOCK)
        blocks = VARIANTS / block_size(many, many.machine(), partial(float, seconds / THREADS))
        parts = {
            "workers": VARIANTS * seconds / cores,
            "network": VARIANTS * row / NETWORK,
            "client": VARIANTS * row * (fetch + write) + blocks * job,
        }
        limit = max(parts, key=parts.get)
        busy = cores * parts["workers"] / parts[limit]
        times = " | ".join(f"{value:.0f}" for value in parts.values())
        size = f"{VARIANTS * row / 1e9:.0f}"
        yield f"| {name} | {seconds * 1e6:.3g} | {row} | {size} | {times} | {limit} | {busy:.0f} |"


def main() -> None:
    load, study = os.getloadavg()[0], read_study(bundled_studies()[BESIDE])
    set_threads(1)
    seconds, write = variant_time(study), write_time(read_study(bundled_studies()[STUDIES[0]]))
    with connected("local:1") as client:
        job, fetch = job_time(client, study), fetch_time(client)
        lines = []
        for length in BLOCK_SECONDS:
            block = max(round(length / seconds), 1)
            ratios = paired_ratios(study, client, block)
            shown = (f"{statistics.median(of):.3f} ({min(of):.3f} – {max(of):.3f})" for of in ratios.T)
            lines.append(f"| {length:g} | {block} | {' | '.join(shown)} |")
    rows = paper_rows(fetch, write, job)
    head = {"processor": get_host_cpu_name(), "cores": os.cpu_count(), "load": load, "pairs": PAIRS, "beside": BESIDE}
    text = HEAD.format(**head, micros=seconds * 1e6, blocks=BLOCKS) + "\n".join(lines) + "\n"
    costs = {"fetch": fetch * 1e9, "write": write * 1e9, "job": job * 1e3}
    text += PAPER.format(hosts=HOSTS, threads=THREADS, **costs) + "\n".join(rows) + "\n" + END
    (HERE / "cluster.md").write_text(text, encoding="utf8")
    print(text)


if __name__ == "__main__":
    main()
