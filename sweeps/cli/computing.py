"""Commands that compute: check, run, optimise."""

import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from engine import counted, set_threads
from sweeps.cli import needed, shared
from sweeps.cli.shared import main
from sweeps.text.input_files import InputError
from sweeps.text.interruption import keeping

if TYPE_CHECKING:
    from sweeps.report.sweep_result import SweepResult
    from sweeps.run.progress import ProgressBar


@main.command()
@click.argument("study")
@click.option("--out", type=click.Path(path_type=Path), default=Path("results"), help="Planned result file.")
@click.option("--source", is_flag=True, help="Print the generated functions as LLVM instructions instead.")
@shared.CLUSTER
@shared.study_options
@shared.ALL
@shared.ERRORS
@shared.in_options
def check(asked: shared.Options) -> None:
    """Show what a study or scene will compute, what is skipped and why, and the time, memory and file size."""
    found = needed.read_study(needed.find_study(asked.study))
    found = needed.changed_study(found, asked.settings, asked.positions, asked.accuracy)
    if asked.source:
        shared.tell(found.machine().source())
    else:
        with shared.cluster_client(asked.cluster) as client:
            shared.tell(needed.check_text(found, asked.out, client, shared.print_on_stderr, asked.every))


def _made(asked: shared.Options, result: "SweepResult", study: Path) -> list[Path]:
    """The result with its plots."""
    return [result.path, *([] if asked.no_plots else shared.plots_of(result, study))]


def _compute(asked: shared.Options, bar: "ProgressBar", compute: Callable[..., Path]) -> None:
    """Compute a result file with progress, on the command's threads or cluster."""
    if asked.out.suffix != ".h5":
        raise InputError.of(str(asked.out), "results are HDF5: give a file that ends in .h5", key="--out")
    if asked.jobs is not None:
        set_threads(asked.jobs)
    with shared.cluster_client(asked.cluster, asked.jobs) as client:

        def update(done: int, before: int, words: str = "") -> None:
            bar.update(done, before, ", ".join(filter(None, (words, shared.workers_text(client)))))

        compute(asked.out, asked.restart, update, asked.replace, shared.print_on_stderr, client)
    bar.close()


def _tell(
    asked: shared.Options, result: "SweepResult", study: Path, begun: float, answer: Sequence[str], remark: str = ""
) -> None:
    """Print the answer of a result, its warnings, and the files made by a computation that began at `begun`."""
    for sentence in answer:
        shared.tell(sentence)
    shared.tell_warnings(result)
    if remark:
        shared.tell(remark)
    made = _made(asked, result, study)
    shared.tell(f"Files ({time.perf_counter() - begun:.1f} s):")
    shared.tell("\n".join(f"  {path}" for path in made))
    shared.tell_outdated(result.path, made)


@main.command()
@click.argument("study")
@shared.run_options("results/NAME.h5")
@shared.study_options
@shared.ALL
@shared.JSON
@shared.ERRORS
@shared.in_options
def run(asked: shared.Options) -> None:
    """Run a study (a file, or the name of a bundled one) into an HDF5 file, resuming an interrupted run.

    Existing results are reused, so variants, summaries and fields can be added. A file with other or further results is
    kept as NAME.previous.h5.

    The exit code is 1 if no variant has a result, or none meets the conditions of the question.
    """
    begun, file = time.perf_counter(), needed.find_study(asked.study)
    found = needed.changed_study(needed.read_study(file), asked.settings, asked.positions, asked.accuracy)
    asked.out, count = asked.out or Path("results") / f"{found.name}.h5", found.design.size
    bar = needed.ProgressBar(count, asked.quiet, kept=0 if asked.restart else needed.variants_kept(asked.out))
    with keeping(bar.kept_text):
        _compute(asked, bar, partial(needed.run_study, found))
        result = needed.SweepResult(asked.out, found)
        if asked.as_json:
            best = result.best()
            told = [best] if best is not None else range(min(count, 1))
            files = [str(path) for path in _made(asked, result, file)]
            data = needed.result_data(result, told)
            shared.tell_data(data | {"warnings": shared.warnings_of(result), "files": files})
        else:
            head = f"{found.title or found.name}: {counted(count, 'variant')}"
            answer = head, needed.counts_text(result), needed.answer_text(result, asked.every)
            _tell(asked, result, file, begun, answer, needed.between_positions_text(found))
    shared.stop_without_answer(result)


@main.command()
@click.argument("study")
@shared.run_options("results/NAME_optimised.h5")
@shared.ALL
@shared.ERRORS
@shared.in_options
def optimise(asked: shared.Options) -> None:
    """Optimise a study over its variables by its [optimise] or [best], resuming an interrupted search.

    The exit code is 1 if no candidate meets the conditions.
    """
    begun, file = time.perf_counter(), needed.find_study(asked.study)
    found = needed.read_study(file)
    asked.out = asked.out or Path("results") / f"{found.name}_optimised.h5"
    bar = needed.ProgressBar(needed.task_of(found).generations, asked.quiet, "generations")
    with keeping(bar.kept_text):
        _compute(asked, bar, partial(needed.optimise_study, found))
        result = needed.SweepResult(asked.out)
        head = f"{found.title or found.name}: {counted(result.file.variants, 'candidate')}"
        _tell(asked, result, file, begun, (head, needed.counts_text(result), needed.optimum_text(result, asked.every)))
    shared.stop_without_answer(result)
