"""The page of a result or machine: report, watch."""

import time
from pathlib import Path
from shlex import quote
from threading import Thread

import click

from sweeps.cli import needed
from sweeps.cli.shared import ERRORS, main, tell, tell_altered
from sweeps.cli.waiting import doing
from sweeps.text.input_files import InputError
from sweeps.text.interruption import keeping

# Interval between checks of the files [s].
LOOK = 0.05


@main.command()
@click.argument("file")
@click.option("--out", type=click.Path(path_type=Path), help="Page to write; default: FILE with .html.")
@ERRORS
def report(file: str, out: Path | None) -> None:
    """Write a report on a result file or scene: one HTML page with the machine in motion, and variants to pick.

    The page is self-contained. Requires pip install 'machine-sweeps[report]'.
    """
    text = None if needed.is_result(file) else needed.find_study(file)
    out = out or Path(file).with_suffix(".html")
    if text is None:
        tell_altered(file)
        with doing("Writing the page"):
            needed.write_page(Path(file), out)
    else:
        study = needed.read_study(text)
        if study.design.size > 1:
            mend = f"run it first, `sweeps run {quote(str(file))}`, then report its result, results/{study.name}.h5"
            raise InputError.of(file, f"is a study of {study.design.size} variants: {mend}")
        with needed.scratch_folder() as folder, doing("Writing the page"):
            needed.write_page(needed.run_study(study, folder / f"{study.name}.h5"), out)
    tell(f"Wrote {out}")


@main.command()
@click.argument("file")
def watch(file: str) -> None:
    """Show the machine of a scene or study in a browser, and again whenever the file is saved.

    Only this computer can reach the page: the machine in motion with its curves, or what is wrong, with line numbers.
    Ctrl-C ends it. Requires pip install 'machine-sweeps[report]'.
    """
    if needed.is_result(file):
        raise InputError.of(file, "is a result, which doesn't change; sweeps report makes its page")
    page = needed.WatchedPage(needed.find_study(file).name, lambda: needed.machine_of(file, None).scene)
    with needed.PageServer(page) as server, keeping(lambda: "the page isn't served any more"):
        Thread(target=server.serve_forever, daemon=True).start()
        tell(f"{file} is shown at {server.address} (Ctrl-C ends this)")
        said = ""
        while True:
            if page.message != said:
                said = page.message
                tell(said or "No mistakes left.", err=True)
            time.sleep(LOOK)
            page.look()
