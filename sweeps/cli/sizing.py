"""Commands that size a part of a machine by itself: flywheel."""

from pathlib import Path

import click

from sweeps.cli.shared import errors_as_messages


@click.command()
@click.argument("table", type=click.Path(path_type=Path))
@click.option("--speed", required=True, help="Mean speed, such as '250 rpm'.")
@click.option("--fluctuation", required=True, help="Coefficient of speed fluctuation asked for, such as 1/50 or 2 %.")
@click.option("--interpolation", type=click.Choice(["linear", "pchip", "spline"]), default="linear", show_default=True)
@errors_as_messages
def flywheel(table: Path, speed: str, fluctuation: str, interpolation: str) -> None:
    """Size a flywheel from a turning-moment table: a CSV with the columns `phi [deg]` and `moment [N m]`."""
    from sweeps.report.flywheel_table import flywheel_text

    click.echo(flywheel_text(table, speed, fluctuation, interpolation))
