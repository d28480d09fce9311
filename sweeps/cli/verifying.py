"""The verify command."""

import sys
from pathlib import Path

import click

from engine import counted
from sweeps.cli.shared import main, tell, tell_aside

DAMAGED = 1


@main.command()
@click.argument("file", type=click.Path(path_type=Path))
def verify(file: Path) -> None:
    """Check a result file against its checksums; exit code 1 if it was modified."""
    from sweeps.store import MappedResult, damage_text

    found = MappedResult(file)
    if not found.has_checksums:
        tell_aside(f"{file} has no checksums (written by an older version).")
        sys.exit(DAMAGED)
    blocks = [int(i) for i in found.done.nonzero()[0]]
    variants = sum(found.rows(i).stop - found.rows(i).start for i in blocks)
    damaged = found.damaged()
    for name in found.edited:
        tell_aside(f"{file}: {name.removeprefix('progress/')} was modified")
    if damaged:
        tell_aside(f"{file}: variants {damage_text(found, damaged)} are damaged; run the study again to repair them")
    if damaged or found.edited:
        sys.exit(DAMAGED)
    left = f", {found.variants - variants} not computed yet" if variants < found.variants else ""
    tell(f"{file}: {counted(variants, 'variant')} intact{left}")
