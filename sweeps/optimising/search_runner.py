"""Run a search into a result file in the format of a sweep; resumable at any time.

During the search every generation is a block of a separate file. A resumed search starts from the first generation and
reads stored candidates instead of evaluating them, so its path is identical bit for bit.
"""

import json
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from engine import Verdict, counted, quantity_text
from sweeps.optimising.pareto import pareto_front
from sweeps.optimising.searching import CLEARANCE, descend, refine, search_method_of
from sweeps.optimising.spread import spread_columns, spreads
from sweeps.optimising.trials import Batch, Trials
from sweeps.run.blocks import LARGEST_BLOCK, joined
from sweeps.run.runner import WORDS, complete_text, crew_of, layout_of, tell_all
from sweeps.store import (
    Column,
    DamagedError,
    FileLayout,
    MappedResult,
    Store,
    StoreError,
    columns_of_number,
    make_folder_of,
    part_path,
    read_columns,
    update_texts,
)
from sweeps.store.creating import remove_unlocked
from sweeps.study.search_task import GENETIC, LOCAL, SearchTask, search_record, task_of
from sweeps.study.study import Study, check_study
from sweeps.study.study_text import Best
from sweeps.text.versions import versions_of

if TYPE_CHECKING:
    from distributed import Client

# Arguments: generations done, those done in earlier runs, and the best result so far as text.
OnGeneration = Callable[[int, int, str], None]


def optimise_study(
    study: Study,
    path: Path | str,
    restart: bool = False,
    progress: OnGeneration | None = None,
    replace_former: bool = False,
    tell: Callable[[str], None] | None = None,
    client: "Client | None" = None,
) -> Path:
    """Optimise a study into a result file, resuming an interrupted search.

    The file holds every candidate as a variant, with two extra columns: `generation` (the final local search counts as
    one more), and `front`, the position on the Pareto front by the first objective, 0 off it. With one objective the
    best candidate is the front.

    Parameters
    ----------
    study : Study
    path : Path or str
        Result file; during the search the candidates are kept in NAME.candidates.part.h5.
    restart : bool
        Discard an earlier result of that name.
    progress : callable, optional
        Called before the first generation and after each one.
    replace_former : bool
        Replace the file of another search instead of keeping it as the previous one.
    tell : callable, optional
        Receives messages about earlier files.
    client : Client, optional
        Client of the Dask cluster that computes the candidates.

    Returns
    -------
    Path
        The finished file.

    Raises
    ------
    AskError
        It isn't a study.
    InputError
        The study has nothing to optimise.
    StoreError
        The file can't be written, or the existing file isn't a sweep result.
    ClusterError
        No worker is usable.
    UnfinishedError
        Some candidates failed to compute, or the scheduler is lost; earlier generations are kept.
    """
    check_study(study)
    path, task, tell = Path(path), task_of(study), tell or (lambda sentence: None)
    work, keep = path.with_name(f"{path.stem}.candidates{path.suffix}"), not restart and not replace_former
    with crew_of(client, task.study, layout_of(task.study), tell) as crew:
        trials = Trials(task, crew)
        if path.exists() and not restart and _is_finished(path, trials, tell):
            # A search killed after its result was finished leaves this file; another process may be using it.
            with suppress(StoreError):
                remove_unlocked(part_path(work))
            return path
        make_folder_of(path)
        if task.method == LOCAL:
            _finish(trials, path, *_downhill(trials), keep, tell)
            return path
        search = search_method_of(task)
        with Store.open(work, _layout(trials, task.population * task.generations, task.population), restart) as store:
            tell_all(store, tell)
            search(_History(trials, store, progress).evaluate)
            _finish(trials, path, *_refined(trials, read_columns(store.part)), keep, tell)
            store.discard()
    return path


def _refined(trials: Trials, found: dict[str, np.ndarray]) -> tuple[dict[str, np.ndarray], str]:
    """The candidates of all generations and of a local search from their best one, and how they were found."""
    task, found = trials.task, {n: values[found["status"] != Verdict.NOT_COMPUTED] for n, values in found.items()}
    batch = trials.judged(found)
    best, last = _best(batch), int(found["generation"].max()) + 1
    words = counted(last, "generation")
    if task.method != GENETIC and best is not None:
        start = task.variables.coordinates({name: found[name][best] for name in task.variables.names})
        better = refine(task, trials, start, batch.costs[best, 0])
        found = joined([found, *(_numbered(one, last) for one in better)])
        words += ", then local search"
    return found, words


def _is_finished(path: Path, trials: Trials, tell: Callable[[str], None]) -> bool:
    """Whether a file is this search's undamaged result; updates its texts."""
    try:
        mapped = MappedResult(path)
    except DamagedError as error:
        tell(f"{error} The search is run again.")
        return False
    if mapped.attributes.get("study_hash") != trials.task.digest:
        return False
    if mapped.edited or mapped.damaged():
        tell(f"{path} is damaged: the search is run again.")
        return False
    layout = _final_layout(trials, mapped.variants)
    update_texts(path, {name: layout.attributes[name] for name in WORDS})
    tell(complete_text(path))
    return True


def _downhill(trials: Trials) -> tuple[dict[str, np.ndarray], str]:
    """The feasible candidates of a local search, or its start if there are none, and words on the outcome."""
    task = trials.task
    passed = descend(task, trials, task.start, task.generations)
    words = "local search"
    if not passed:
        passed = [trials.columns(task.variables.values(task.start[None]), 1, drop=True)]
        words += f", which found no feasible candidate: it keeps {CLEARANCE:g} (relative) clear of each limit, so "
        words += "write A == B as abs(A - B) <= TOLERANCE, or choose another start"
    return _numbered(joined(passed), 0), words


class _History:
    """The generations of a search: stored ones are read, the others evaluated and written.

    Parameters
    ----------
    trials : Trials
    store : Store
        One block for each generation.
    progress : callable or None
    """

    def __init__(self, trials: Trials, store: Store, progress: OnGeneration | None) -> None:
        self.task, self.trials, self.store, self.progress = trials.task, trials, store, progress
        self.pending = set(store.pending)
        self.before = store.layout.blocks - len(self.pending)
        self.done, self.best = 0, None
        if progress:
            progress(self.before, self.before, "")

    def evaluate(self, coordinates: np.ndarray) -> Batch:
        """Columns and costs of the next generation."""
        varied, count = self.task.variables.values(coordinates), coordinates.shape[0]
        if self.done in self.pending:
            found = self.trials.columns(varied, count, drop=True)
            self.store.write(self.done, _filled(_numbered(found, self.done), self.task.population))
        else:
            found = self._kept(varied, count)
        self.done += 1
        batch = self.trials.judged(found)
        if self.progress and self.done > self.before:
            self.progress(self.done, self.before, self._words(batch))
        return batch

    def _kept(self, varied: dict[str, np.ndarray], count: int) -> dict[str, np.ndarray]:
        found = {name: values[:count] for name, values in self.store.read(self.done).items()}
        if not all(np.array_equal(found[name], values) for name, values in varied.items()):
            raise StoreError(
                f"{self.store.part} can't be resumed: generation {self.done} would differ, because other "
                f"versions of SciPy or pymoo ({_versions()}) search differently. Start over with --restart."
            )
        return found

    def _words(self, batch: Batch) -> str:
        objective = self.task.objectives[0]
        if len(self.task.objectives) > 1:
            return f"{int(batch.met.sum())} of {batch.met.size} feasible"
        least = batch.costs[batch.met, 0].min(initial=np.inf)
        self.best = least if self.best is None else min(least, self.best)
        return f"{objective.name} {quantity_text(objective.sign * self.best, objective.units)}"


def _numbered(found: dict[str, np.ndarray], generation: int) -> dict[str, np.ndarray]:
    return found | {"generation": np.full(found["status"].size, generation, np.int32)}


def _filled(found: dict[str, np.ndarray], count: int) -> dict[str, np.ndarray]:
    """Columns of a generation, padded to a full block with entries marked as not computed."""
    missing = count - found["status"].size
    filled = {name: np.append(values, np.repeat(values[-1:], missing)) for name, values in found.items()}
    filled["status"][count - missing :] = Verdict.NOT_COMPUTED
    return filled


def _best(batch: Batch) -> int | None:
    """The feasible candidate of minimum cost."""
    costs = np.where(batch.met, batch.costs[:, 0], np.inf)
    return int(np.argmin(costs)) if batch.met.any() else None


def _front_positions(batch: Batch) -> np.ndarray:
    """Positions on the Pareto front by ascending first cost, 0 off it; ties go to the first candidate."""
    places = np.zeros(batch.met.size, np.int32)
    met = np.flatnonzero(batch.met)
    costs = batch.costs[met]
    if costs.shape[1] == 1:
        front = np.argmin(costs, axis=0) if met.size else np.zeros(0, int)
    else:
        front = np.flatnonzero(pareto_front(costs))
        front = front[np.unique(costs[front], axis=0, return_index=True)[1]]
    places[met[front]] = np.arange(1, front.size + 1)
    return places


def _finish(
    trials: Trials, path: Path, found: dict[str, np.ndarray], way: str, keep: bool, tell: Callable[[str], None]
) -> None:
    """Write the result: all candidates, their positions on the front, and the spread from tolerances on it."""
    places = _front_positions(trials.judged(found))
    found = found | {"front": places} | spreads(trials.task, found, np.flatnonzero(places))
    count = places.size
    with Store.open(path, _final_layout(trials, count), restart=not keep) as store:
        # No blocks are pending if another process has finished this search.
        for i in store.pending:
            store.write(i, {name: values[store.layout.slice(i)] for name, values in found.items()})
        by = "" if trials.crew is None else f"; computed by {trials.crew.words}"
        store.finish(f"{counted(count, 'candidate')}, {way}{by}", keep_former=keep)
        tell_all(store, tell)


# The file


def _final_layout(trials: Trials, count: int) -> FileLayout:
    layout = _layout(trials, count, min(count, LARGEST_BLOCK))
    front = Column("front", "position on the Pareto front, 0 off it", "1", dtype=np.int32)
    return replace(layout, columns=(*layout.columns, front, *spread_columns(trials.task)))


def _layout(trials: Trials, count: int, block: int) -> FileLayout:
    """A sweep's layout plus the objectives and each candidate's generation."""
    task, base = trials.task, layout_of(trials.task.study)
    extra = [Column("generation", "generation of the search", "1", dtype=np.int32)]
    for objective in task.objectives:
        if not objective.is_column:
            words = " ".join(objective.expression.text.split())
            extra += columns_of_number(objective.name, words, objective.units or "1")
    record = json.loads(base.attributes["study_json"]) | {"best": _goal(task), "search": search_record(task)}
    attributes = {"study_json": json.dumps(record), "study_hash": task.digest, "searched_with": _versions()}
    columns = (*base.columns, *extra)
    return replace(base, variants=count, block=block, columns=columns, attributes=base.attributes | attributes)


def _goal(task: SearchTask) -> dict[str, Any] | None:
    """The objective in the form of [best]; None for several objectives."""
    if len(task.objectives) > 1:
        return None
    (objective,) = task.objectives
    return Best(**{objective.way: objective.name}, where=[c.text for c in task.conditions]).model_dump()


def _versions() -> str:
    return ", ".join(f"{name} {version}" for name, version in versions_of("scipy", "pymoo").items())
