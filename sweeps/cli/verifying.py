"""The command that verifies: whether a result file is as it was written."""

import sys
from pathlib import Path

import click

from sweeps.cli.shared import errors_as_messages, tell, tell_aside

DAMAGED = 1


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@errors_as_messages
def verify(file: Path) -> None:
    """Compare a result file with its checksums; exit code 1 if it isn't as it was written."""
    from sweeps.store import MappedResult, damage_text

    found = MappedResult(file)
    if not found.has_checksums:
        tell_aside(f"{file} was made by a version that wrote no checksums: nothing to compare with.")
        sys.exit(DAMAGED)
    blocks = [int(i) for i in found.done.nonzero()[0]]
    variants = sum(found.rows(i).stop - found.rows(i).start for i in blocks)
    damaged = found.damaged()
    for name in found.edited:
        tell_aside(f"{file}: its {name.removeprefix('progress/')} isn't as it was written")
    if damaged:
        tell_aside(
            f"{file}: numbers of variants {damage_text(found, damaged)} changed; its study, run again, mends that"
        )
    if damaged or found.edited:
        sys.exit(DAMAGED)
    left = f", {found.variants - variants} aren't computed yet" if variants < found.variants else ""
    tell(f"{file}: {variants} variants as they were written{left}")
