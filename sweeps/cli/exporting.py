"""The export command: files for other programs."""

from pathlib import Path
from typing import NamedTuple

import click

from sweeps.cli.shared import (
    POSITIONS,
    SET,
    WHERE,
    WholeNumber,
    errors_as_messages,
    in_record,
    joints_by_letter,
    make_folder,
    names_in,
    tell,
    tell_altered,
    variants_only,
)
from sweeps.cli.waiting import doing

TABLES, DRAWINGS = (".csv", ".json", ".parquet", ".mat"), (".svg", ".dxf")


class _Exported(NamedTuple):
    """What `export` is asked."""

    file: str
    to: Path
    variant: int | None
    at: str
    where: tuple[str, ...]
    history: bool
    element: str | None
    columns: str
    overwrite: bool
    positions: int | None
    settings: tuple[str, ...]


@click.command()
@click.argument("file")
@click.option(
    "--to",
    type=click.Path(path_type=Path),
    required=True,
    help="File to write: .csv, .json, .parquet, .mat, .svg, .dxf or .toml.",
)
@click.option("--variant", type=WholeNumber(0), help="One variant of a result file.")
@click.option(
    "--at", default="", help="Crank angles [deg], displacements such as '20 mm', or instants such as '0.2 s'."
)
@WHERE
@click.option("--history", is_flag=True, help="Time history through the regimes (tables).")
@click.option("--element", help="A cam element: its motion curves (CSV) or outlines (SVG, DXF).")
@click.option(
    "--columns",
    default="",
    help="Comma-separated: columns or fields of a result, fields of a machine, loads for --history.",
)
@click.option("--overwrite", is_flag=True, help="Overwrite an existing scene.")
@POSITIONS
@SET
@errors_as_messages
@joints_by_letter
@in_record(_Exported)
def export(asked: _Exported) -> None:
    """Write results, positions or a history as a table, a drawing as SVG or DXF, or one variant as a scene (TOML).

    Tables are in the scene's units. The drawing shows the mechanism, or the cam of a scene that has only a cam. A scene
    keeps its author's comments and units; only the variant's numbers change. Fields of a result (--columns) get one row
    per variant and position.
    """
    from sweeps.cli.named_machine import is_result, machine_of, numbers_replaced, positions_of, read_at, scene_text_of
    from sweeps.pictures import picture_files
    from sweeps.pictures.elements.cam_drawing import cam_named, export_cam
    from sweeps.report.files import exports
    from sweeps.report.files.data_files import write_table
    from sweeps.text.input_files import InputError
    from sweeps.text.scene_text import with_values

    if asked.to.suffix not in (*TABLES, *DRAWINGS, ".toml"):
        allowed = ", ".join((*TABLES, *DRAWINGS, ".toml"))
        raise InputError.of(str(asked.to), f"ending {asked.to.suffix!r}: allowed are {allowed}", key="--to")
    if asked.history and asked.to.suffix not in TABLES:
        message = f"writes a table, {', '.join(TABLES)}, not {asked.to.suffix!r}"
        raise InputError.of(str(asked.to), message, key="--history")

    if is_result(asked.file):
        tell_altered(asked.file)

    of_one = asked.variant is not None or asked.at or asked.history or asked.settings or asked.element
    is_sweep = asked.to.suffix in TABLES and is_result(asked.file) and not of_one
    variants_only(asked.where, is_sweep)
    if is_sweep:
        make_folder(asked.to)
        columns, source, where = names_in(asked.columns), Path(asked.file), asked.where
        with doing("Writing the table"):
            table = exports.result_columns(source, columns, where) if columns else exports.result_table(source, where)
            write_table(asked.to, table)
        tell(f"Wrote {asked.to}")
        return
    scene, values, name = machine_of(asked.file, asked.variant, asked.settings)
    machine = with_values(scene, values)
    make_folder(asked.to)
    if asked.to.suffix == ".toml":
        given, replaced = numbers_replaced(asked.file, values, asked.settings)
        exports.scene_toml(given, replaced, asked.to, scene_text_of(asked.file), asked.overwrite)
    elif (cam := cam_named(machine, asked.element)) is not None:
        export_cam(cam, asked.to)
    elif asked.to.suffix in DRAWINGS:
        picture_files.drawing_file(scene, values, asked.to, next(iter(positions_of(scene, asked.at)), None))
    elif asked.history:
        table, ended = exports.history_table(machine, {}, names_in(asked.columns))
        write_table(asked.to, table)
        if ended:
            tell(f"The history ends early: {ended}", err=True)
    elif asked.at:
        write_table(asked.to, exports.reading_table(read_at(machine, asked.at, names_in(asked.columns)), scene.title))
    else:
        write_table(asked.to, exports.position_table(machine, {}, asked.positions or 360, names_in(asked.columns)))
    tell(f"Wrote {asked.to} of {name}")
