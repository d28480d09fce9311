"""The report command."""

from pathlib import Path

import click

from sweeps.cli.shared import ERRORS, errors_as_messages, make_folder, tell, tell_altered
from sweeps.cli.waiting import doing


@click.command()
@click.argument("file")
@click.option("--out", type=click.Path(path_type=Path), help="Page to write; default: FILE with .html.")
@ERRORS
@errors_as_messages
def report(file: str, out: Path | None) -> None:
    """Write a report on a result file or scene: one HTML page with the machine in motion, and variants to pick.

    The page is self-contained. Requires pip install 'machine-sweeps[report]'.
    """
    from sweeps.cli.named_machine import is_result
    from sweeps.page.page import write_page
    from sweeps.run.runner import run_study
    from sweeps.study.bundled import find_study
    from sweeps.study.study_reader import read_study
    from sweeps.text.input_files import InputError
    from sweeps.text.whole_files import scratch_folder

    text = None if is_result(file) else find_study(file)
    out = out or Path(file).with_suffix(".html")
    make_folder(out)
    if text is None:
        tell_altered(file)
        with doing("Writing the page"):
            write_page(Path(file), out)
    else:
        study = read_study(text)
        if study.design.size > 1:
            mend = f"run it first, `sweeps run {file}`, then report its result, results/{study.name}.h5"
            raise InputError(file, [(None, "", f"is a study of {study.design.size} variants: {mend}")])
        with scratch_folder() as folder, doing("Writing the page"):
            write_page(run_study(study, folder / f"{study.name}.h5"), out)
    tell(f"Wrote {out}")
