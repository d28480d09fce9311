"""The export command: files for other programs."""

from pathlib import Path

import click

from sweeps.cli import needed, shared
from sweeps.cli.shared import main, write_text
from sweeps.cli.waiting import doing
from sweeps.text.input_files import InputError

DRAWINGS = (".svg", ".dxf")


@main.command()
@click.argument("file")
@click.option(
    "--to",
    type=click.Path(path_type=Path),
    required=True,
    help="File to write: .csv, .json, .parquet, .mat, .svg, .dxf or .toml.",
)
@click.option("--variant", type=shared.WholeNumber(0), help="One variant of a result file (drawings: the best).")
@click.option(
    "--at", default="", help="Crank angles [deg], displacements such as '20 mm', or instants such as '0.2 s'."
)
@shared.WHERE
@shared.ORDER
@click.option("--limit", type=shared.WholeNumber(1), help="Number of variants to write.")
@click.option("--history", is_flag=True, help="Time history through the regimes (tables).")
@click.option("--element", help="A cam element: its motion curves (a table) or outlines (SVG, DXF).")
@click.option(
    "--columns",
    default="",
    help="Comma-separated: columns or fields of a result, fields of a machine, loads for --history.",
)
@click.option("--overwrite", is_flag=True, help="Overwrite an existing scene.")
@shared.POSITIONS
@shared.SET
@shared.joints_by_letter
@shared.in_options
def export(asked: shared.Options) -> None:
    """Write results, positions or a history as a table, a drawing as SVG or DXF, or one variant as a scene (TOML).

    Tables are in the scene's units. The drawing shows the mechanism, or the cam of a scene that has only a cam. A scene
    keeps its author's comments and units; only the variant's numbers change. Fields of a result (--columns) get one row
    per variant and position.
    """
    tables = needed.TABLE_ENDINGS
    if asked.to.suffix not in (allowed := (*tables, *DRAWINGS, ".toml")):
        message = f"ending {asked.to.suffix!r}: allowed are {', '.join(allowed)}"
        raise InputError.of(str(asked.to), message, key="--to")
    if asked.history and asked.to.suffix not in tables:
        message = f"writes a table, {', '.join(tables)}, not {asked.to.suffix!r}"
        raise InputError.of(str(asked.to), message, key="--history")

    if needed.is_result(asked.file):
        shared.tell_altered(asked.file)

    of_one = asked.variant is not None or asked.at or asked.history or asked.settings or asked.element
    is_sweep = asked.to.suffix in tables and needed.is_result(asked.file) and not of_one
    for option in ("where", "sort", "descending", "limit"):
        if getattr(asked, option) and not is_sweep:
            raise InputError.of(f"--{option}", "is for the table of a whole result file; here one machine is written")
    if is_sweep:
        chosen = asked.where, asked.sort, asked.descending, asked.limit
        with doing("Writing the table"):
            table = needed.result_table(Path(asked.file), shared.names_in(asked.columns), *chosen)
            needed.write_table(asked.to, table)
        shared.tell(f"Wrote {asked.to}")
        return
    machine = needed.machine_of(asked.file, asked.variant, asked.settings)
    scene, columns = machine.scene, shared.names_in(asked.columns)
    if asked.to.suffix == ".toml":
        write_text(asked.to, machine.edited(asked.to.parent), asked.overwrite, "name another file, or give --overwrite")
    elif (cam := needed.element_named(scene, ["cam"], asked.element)) is not None:
        needed.export_cam(cam, asked.to)
    elif asked.to.suffix in DRAWINGS:
        places = needed.positions_of(scene, asked.at)
        needed.drawing_file(scene, asked.to, next(iter(places), None))
    elif asked.history:
        table, ended = needed.history_table(scene, columns)
        needed.write_table(asked.to, table)
        if ended:
            shared.tell(f"The history ends early: {ended}", err=True)
    else:
        at, positions = asked.at, asked.positions or 360
        readings = needed.read_at(scene, at, columns) if at else needed.readings_at(scene, positions, columns)
        needed.write_table(asked.to, needed.reading_table(readings, scene.title))
    shared.tell(f"Wrote {asked.to} of {machine.name}")
