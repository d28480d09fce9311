"""Run a study block by block into a result file; resumable at any time."""

import json
import platform
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import AbstractContextManager, nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from engine import Verdict, threads, units_shown
from sweeps.run.blocks import block_size, largest_block
from sweeps.run.cluster.cluster_errors import UnfinishedError
from sweeps.run.columns import field_columns, number_columns, position_axis
from sweeps.run.cost import on_shafts_text, seconds_of_variant
from sweeps.run.reuse import Blocks, EarlierResult, Excerpt, excerpts_of, filled_in
from sweeps.store import Column, FileLayout, MappedResult, Store, StoreError, make_folder_of, part_path, update_texts
from sweeps.study.study import Study, check_study
from sweeps.study.study_record import numbers_record, study_record
from sweeps.text.scene_text import write_scene
from sweeps.text.versions import own_version, versions_of

if TYPE_CHECKING:
    from distributed import Client

    from sweeps.run.cluster.crew import Crew

# Failed blocks named in a message.
FAILURES_NAMED = 3
# Blocks computed while one is written.
IN_ADVANCE = 2
# Attributes that don't affect numbers.
WORDS = ("title", "question", "study", "study_json", "scene", "scene_text")


def layout_of(study: Study) -> FileLayout:
    """Layout of a study's result file."""
    machine = study.machine()
    fields, axes = field_columns(machine, study.fields)
    columns = [Column(name, name, study.unit(name)) for name in study.parameters]
    columns += [*number_columns(machine, study.summaries), *study.sensitivity.columns, *fields]
    return FileLayout(
        variants=study.design.size,
        block=min(largest_block(study), study.design.size),
        columns=tuple(columns),
        attributes=_attributes(study),
        coordinates=study.parameters,
        status_codes={int(v): v.name.lower() for v in Verdict if v != Verdict.NOT_COMPUTED},
        position=position_axis(machine),
        axes=tuple(axes.values()),
    )


def _attributes(study: Study) -> dict[str, str]:
    versions = {"machine-sweeps": own_version()} | versions_of("numba", "llvmlite", "numpy", "h5py")
    versions["python"] = platform.python_version()
    return {
        "title": study.title or study.name,
        "question": study.question,
        "study": study.text,
        "study_json": json.dumps(study_record(study) | {"groups": [*study.machine().groups], "units": units_shown()}),
        "scene": write_scene(study.scene),
        "scene_text": study.scene_text,
        "study_hash": study.digest,
        "versions": ", ".join(f"{k} {v}" for k, v in versions.items()),
        "machine": f"{platform.machine()} {platform.system()}, {threads()} threads",
    }


def run_study(
    study: Study,
    path: Path | str,
    restart: bool = False,
    progress: Callable[[int, int], None] | None = None,
    replace_former: bool = False,
    tell: Callable[[str], None] | None = None,
    client: "Client | None" = None,
) -> Path:
    """Run or resume a study into a result file.

    Results in an earlier file of that name are reused: of an interrupted run, or of a study that since got more
    variants, summaries or fields, or another question, [best] or texts. A file with further results is kept as
    the previous one.

    Parameters
    ----------
    study : Study
    path : Path or str
        Result file; NAME.part.h5 during the run.
    restart : bool
        Discard an earlier result and compute everything.
    progress : callable, optional
        Called with (variants done, of those in earlier runs) before the first block and after each one.
    replace_former : bool
        Replace the file of another study.
    tell : callable, optional
        Receives messages about earlier files.
    client : Client, optional
        Client of the Dask cluster that computes the blocks.

    Returns
    -------
    Path
        The finished file.

    Raises
    ------
    AskError
        It isn't a study.
    StoreError
        The file can't be written, or the existing file isn't a sweep result.
    ClusterError
        No usable worker.
    UnfinishedError
        Some blocks failed to compute, or the scheduler is lost; the others are kept.
    """
    check_study(study)
    path, tell = Path(path), tell or (lambda sentence: None)
    make_folder_of(path)
    layout = layout_of(study)
    if not restart and _finished_file_is_valid(path, layout, tell):
        return path
    if on_shafts := on_shafts_text(study):
        tell(on_shafts)
    alone = partial(seconds_of_variant, study)
    with (
        crew_of(client, study, layout, tell) as crew,
        Store.open(path, layout, restart, lambda: block_size(study, crew.seconds if crew else alone)) as store,
    ):
        tell_all(store, tell)
        if store.finished:
            tell(complete_text(path))
            return path
        earlier = [EarlierResult(source, study, store.layout) for source in store.sources]
        pending = store.pending
        sizes = {i: store.layout.slice(i).stop - store.layout.slice(i).start for i in pending}
        done = before = study.design.size - sum(sizes.values())
        if progress:
            progress(done, before)
        for i, columns in _computed(study, store, earlier, crew):
            store.write(i, columns)
            done += sizes[i]
            if progress:
                progress(done, before)
        if store.pending:
            raise UnfinishedError(_unfinished_text(store, crew.failures))
        former = {source: found for source, found in zip(store.sources, earlier, strict=True) if source.exists()}
        contained = [source for source, found in former.items() if found.is_within(study)]
        dropped = restart or replace_former or path in contained
        store.finish("" if crew is None else f"computed by {crew.words}", keep_former=not dropped)
        for source in contained if not replace_former else former:
            if source != path:
                source.unlink(missing_ok=True)
        tell_all(store, tell)
    return path


def crew_of(
    client: "Client | None", study: Study, layout: FileLayout, tell: Callable[[str], None]
) -> AbstractContextManager["Crew | None"]:
    """Context manager of the workers for a study; None without a cluster.

    Parameters
    ----------
    client : Client or None
    study : Study
    layout : FileLayout
        Layout of its file.
    tell : callable
        Receives messages on refusals and waiting.
    """
    if client is None:
        return nullcontext()
    # Dask may not be installed.
    from sweeps.run.cluster.crew import Crew

    return Crew(client, Blocks(study, layout), tell)


def _computed(
    study: Study, store: Store, earlier: Sequence[EarlierResult], crew: "Crew | None"
) -> Iterator[tuple[int, dict[str, np.ndarray]]]:
    """Columns of all pending blocks: in order, or in any order on a cluster."""

    def excerpts(i: int) -> list[Excerpt]:
        return excerpts_of(earlier, study, store.layout.slice(i))

    if crew is None:
        blocks, machine = Blocks(study, store.layout), study.machine()
        yield from _in_advance(
            lambda i, buffer: blocks.columns(store.layout.slice(i), excerpts(i), buffer),
            store.pending,
            [machine.new_buffer(store.layout.block) for _ in range(min(threads(), IN_ADVANCE) + 1)],
        )
        return
    from sweeps.run.cluster.on_workers import compute_block

    jobs = ((i, (store.layout.slice(i), [e.outline for e in excerpts(i)])) for i in store.pending)
    for i, (columns, origin) in crew.results(compute_block, jobs):
        yield i, columns if origin is None else filled_in(columns, origin, excerpts(i))


def _in_advance(
    compute: Callable[[int, np.ndarray], dict[str, np.ndarray]], pending: Sequence[int], buffers: Sequence[np.ndarray]
) -> Iterator[tuple[int, dict[str, np.ndarray]]]:
    """Blocks in order: while one is written, the next are computed, each with a separate buffer."""
    pool = ThreadPoolExecutor(max(len(buffers) - 1, 1), thread_name_prefix="blocks")
    running: deque[tuple[int, Future]] = deque()
    try:
        for k, i in enumerate(pending):
            # The buffer is free again: its block has been written.
            running.append((i, pool.submit(compute, i, buffers[k % len(buffers)])))
            if len(running) == len(buffers):
                done, block = running.popleft()
                yield done, block.result()
        for i, block in running:
            yield i, block.result()
    finally:
        pool.shutdown(cancel_futures=True)


def _unfinished_text(store: Store, failures: Mapping[int, str]) -> str:
    """Message on failed blocks, with the first reason."""
    rows = [store.layout.slice(i) for i in sorted(failures)]
    shown = ", ".join(f"{r.start} … {r.stop - 1}" for r in rows[:FAILURES_NAMED])
    more = f" and {len(rows) - FAILURES_NAMED} blocks more" if len(rows) > FAILURES_NAMED else ""
    why = failures[min(failures)]
    kept = f"The others are kept in {store.part}; repeat the command to retry."
    return f"variants {shown}{more} couldn't be computed ({why}). {kept}"


def complete_text(path: Path) -> str:
    """Message on a result that is complete already."""
    return f"{path} is complete: nothing was computed. --restart recomputes it."


def tell_all(store: Store, tell: Callable[[str], None]) -> None:
    """Report new notes of a store."""
    while store.notes:
        tell(store.notes.pop(0))


def _finished_file_is_valid(path: Path, layout: FileLayout, tell: Callable[[str], None]) -> bool:
    """Whether a finished file of another version has the study's results; updates its texts."""
    for found in (path, part_path(path)):
        try:
            mapped = MappedResult(found)
            record = json.loads(mapped.attributes["study_json"])
            ours = json.loads(layout.attributes["study_json"])
            same = numbers_record(record) == numbers_record(ours)
        except (StoreError, KeyError, ValueError, TypeError, RecursionError):
            continue
        words = {name: layout.attributes[name] for name in WORDS}
        if same and not mapped.edited and record.get("engine") == ours["engine"]:
            update_texts(found, words)
        elif same and not mapped.edited:
            version = mapped.attributes.get("versions", "").split(",")[0] or "an earlier version"
            if found == path and mapped.done.all() and not mapped.damaged():
                update_texts(found, words | {"study_json": json.dumps(ours | {"engine": record.get("engine")})})
                tell(f"{path} was made by {version}; its numbers are valid. --restart recomputes them.")
                return True
            tell(f"{found} was made by {version}: everything is recomputed.")
    return False
