"""Reference commands: quantities, help, compare."""

import sys
from pathlib import Path

import click

from sweeps.cli.shared import DIFFERENT, ERRORS, main, tell


@main.command()
@click.argument("file")
@click.argument("words", nargs=-1)
def quantities(file: str, words: tuple[str, ...]) -> None:
    """List the quantities of a scene, study or result: name, symbol, unit, meaning. WORDS filter the list."""
    from sweeps.cli.named_machine import machine_of
    from sweeps.report.help.quantity_list import quantities_text

    tell(quantities_text(machine_of(file, None).written, file, words))


@main.command("help")
@click.argument("words", nargs=-1)
def help_command(words: tuple[str, ...]) -> None:
    """Explain a key of scenes and studies, input.length, a table, or a type such as compressor; or search for words."""
    from sweeps.report.help.key_help import key_text, tables_text

    tell(key_text(" ".join(words)) if words else tables_text())


@main.command("compare")
@click.argument("one", type=click.Path(path_type=Path))
@click.argument("other", type=click.Path(path_type=Path))
@ERRORS
def compare_command(one: Path, other: Path) -> None:
    """Compare two result files: best against best, differences in scene and study, values within error estimates.

    The exit code is 1 if values or verdicts differ.
    """
    from sweeps.report.answers.comparison import comparison
    from sweeps.report.sweep_result import SweepResult

    results = SweepResult(one), SweepResult(other)
    results[0].show_own_units()
    found = comparison(*results)
    tell(found.text)
    if not found.agrees:
        sys.exit(DIFFERENT)
