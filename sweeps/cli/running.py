"""Commands that compute: check, run, optimise."""

import time
from pathlib import Path

import click

from sweeps.cli.shared import (
    ALL,
    CLUSTER,
    ERRORS,
    JSON,
    cluster_client,
    errors_as_messages,
    make_folder,
    plots_of,
    run_options,
    stop_without_answer,
    study_options,
    tell,
    tell_aside,
    tell_data,
    tell_files,
    tell_outdated,
    tell_warnings,
    use_threads,
    warnings_of,
    workers_text,
)
from sweeps.text.interruption import keeping


@click.command()
@click.argument("study")
@click.option("--out", type=click.Path(path_type=Path), default=Path("results"), help="Result file to plan for.")
@click.option("--source", is_flag=True, help="Print the generated kernel instead.")
@CLUSTER
@study_options
@ALL
@ERRORS
@errors_as_messages
def check(
    study: str,
    out: Path,
    source: bool,
    cluster: str | None,
    settings: tuple[str, ...],
    positions: int | None,
    accuracy: str | None,
    every: bool,
) -> None:
    """Show what a study or scene will compute, what is skipped and why, and the time, memory and file size."""
    from sweeps.report.check_report import check_text
    from sweeps.study.bundled import find_study
    from sweeps.study.settings import changed_study
    from sweeps.study.study_reader import read_study

    found = changed_study(read_study(find_study(study)), settings, positions, accuracy)
    if source:
        tell(found.machine().source())
    else:
        with cluster_client(cluster) as client:
            tell(check_text(found, out, client, tell_aside, every))


@click.command()
@click.argument("study")
@run_options("results/NAME.h5")
@study_options
@ALL
@JSON
@ERRORS
@errors_as_messages
def run(
    study: str,
    out: Path | None,
    restart: bool,
    replace: bool,
    jobs: int | None,
    cluster: str | None,
    no_plots: bool,
    quiet: bool,
    settings: tuple[str, ...],
    positions: int | None,
    accuracy: str | None,
    every: bool,
    as_json: bool,
) -> None:
    """Run a study (a file, or the name of a bundled one) into an HDF5 file, resuming an interrupted run.

    Existing results are reused, so variants, summaries and fields can be added. A file with other or further results is
    kept as NAME.previous.h5.

    The exit code is 1 if no variant has a result, or none meets the conditions of the question.
    """
    from sweeps.report.check_report import between_positions_text
    from sweeps.report.files.result_data import result_data
    from sweeps.report.result_report import answer_text, counts_text
    from sweeps.report.sweep_result import SweepResult
    from sweeps.run.progress import ProgressBar
    from sweeps.run.runner import run_study
    from sweeps.store import variants_kept
    from sweeps.study.bundled import find_study
    from sweeps.study.settings import changed_study
    from sweeps.study.study_reader import read_study

    started = time.perf_counter()
    file = find_study(study)
    found = changed_study(read_study(file), settings, positions, accuracy)
    out = out or Path("results") / f"{found.name}.h5"
    make_folder(out)
    use_threads(jobs)
    bar = ProgressBar(found.design.size, quiet, kept=0 if restart else variants_kept(out))
    with keeping(bar.kept_text):
        with cluster_client(cluster, jobs) as client:

            def update(done: int, before: int) -> None:
                bar.update(done, before, workers_text(client))

            run_study(found, out, restart, update, replace, tell_aside, client)
        bar.close()
        result = SweepResult(out, found)
        if as_json:
            best = result.best()
            told = [best] if best is not None else range(min(found.design.size, 1))
            made = [out, *([] if no_plots else plots_of(result, file))]
            further = {"warnings": warnings_of(result), "files": [str(path) for path in made]}
            tell_data(result_data(result, told) | further)
            stop_without_answer(result)
            return
        plural = "" if found.design.size == 1 else "s"
        tell(f"{found.title or found.name}: {found.design.size} variant{plural}")
        tell(counts_text(result))
        tell(answer_text(result, every))
        tell_warnings(result)
        if hidden := between_positions_text(found):
            tell(hidden)
        made = [out, *([] if no_plots else plots_of(result, file))]
        tell_files(made, started)
        tell_outdated(out, made)
    stop_without_answer(result)


@click.command()
@click.argument("study")
@run_options("results/NAME_optimised.h5")
@ALL
@ERRORS
@errors_as_messages
def optimise(
    study: str,
    out: Path | None,
    restart: bool,
    replace: bool,
    jobs: int | None,
    cluster: str | None,
    no_plots: bool,
    quiet: bool,
    every: bool,
) -> None:
    """Optimise a study over its variables by its [optimise] or [best], resuming an interrupted search.

    The exit code is 1 if no candidate meets the conditions.
    """
    from sweeps.optimising.optimum import optimum_text
    from sweeps.optimising.runner import optimise_study
    from sweeps.report.result_report import counts_text
    from sweeps.report.sweep_result import SweepResult
    from sweeps.run.progress import ProgressBar
    from sweeps.study.bundled import find_study
    from sweeps.study.search_task import task_of
    from sweeps.study.study_reader import read_study

    started = time.perf_counter()
    file = find_study(study)
    found = read_study(file)
    out = out or Path("results") / f"{found.name}_optimised.h5"
    make_folder(out)
    use_threads(jobs)
    bar = ProgressBar(task_of(found).generations, quiet, "generations")
    with keeping(bar.kept_text):
        with cluster_client(cluster, jobs) as client:

            def update(done: int, before: int, words: str) -> None:
                bar.update(done, before, ", ".join(filter(None, (words, workers_text(client)))))

            optimise_study(found, out, restart, update, replace, tell_aside, client)
        bar.close()
        result = SweepResult(out)
        tell(f"{found.title or found.name}: {result.description.variants} candidates")
        tell(counts_text(result))
        tell(optimum_text(result, every))
        tell_warnings(result)
        made = [out, *([] if no_plots else plots_of(result, file))]
        tell_files(made, started)
        tell_outdated(out, made)
    stop_without_answer(result)
