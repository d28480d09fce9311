"""Commands that answer questions about files: quantities, help, compare, verify."""

import sys
from pathlib import Path

import click

from engine import counted
from sweeps.cli import needed
from sweeps.cli.shared import DAMAGED, DIFFERENT, ERRORS, main, print_on_stderr, tell


@main.command()
@click.argument("file")
@click.argument("words", nargs=-1)
def quantities(file: str, words: tuple[str, ...]) -> None:
    """List the quantities of a scene, study or result: name, symbol, unit, meaning. WORDS filter the list."""
    tell(needed.quantities_text(needed.machine_of(file, None).written, file, words))


@main.command("help")
@click.argument("words", nargs=-1)
def help_command(words: tuple[str, ...]) -> None:
    """Explain a key such as input.length, a table, or a type such as compressor; or search for words."""
    tell(needed.key_text(" ".join(words)) if words else needed.tables_text())


@main.command("compare")
@click.argument("one", type=click.Path(path_type=Path))
@click.argument("other", type=click.Path(path_type=Path))
@ERRORS
def compare_command(one: Path, other: Path) -> None:
    """Compare two result files: best against best, differences in scene and study, values within error estimates.

    The exit code is 1 if values or verdicts differ.
    """
    results = needed.SweepResult(one), needed.SweepResult(other)
    results[0].show_own_units()
    found = needed.comparison(*results)
    tell(found.text)
    if not found.agrees:
        sys.exit(DIFFERENT)


@main.command()
@click.argument("file", type=click.Path(path_type=Path))
def verify(file: Path) -> None:
    """Check a result file against its checksums; exit code 1 if it was modified."""
    found = needed.MappedResult(file)
    variants = sum(rows.stop - rows.start for rows in map(found.rows, found.done.nonzero()[0].tolist()))
    damaged = found.damaged()
    for name in found.edited:
        print_on_stderr(f"{file}: {name.removeprefix('progress/')} was modified")
    if damaged:
        print_on_stderr(
            f"{file}: variants {needed.damage_text(found, damaged)} are damaged; run the study again to repair them"
        )
    if damaged or found.edited:
        sys.exit(DAMAGED)
    left = f", {found.variants - variants} not computed yet" if variants < found.variants else ""
    tell(f"{file}: {counted(variants, 'variant')} intact{left}")
