"""Commands that show what there is: show, plot, orders, animate."""

import gc
from pathlib import Path

import click

from sweeps.cli.shared import (
    JSON,
    POSITIONS,
    SET,
    errors_as_messages,
    make_folder,
    names_in,
    tell,
    tell_altered,
    tell_data,
)
from sweeps.cli.waiting import doing


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--where", help="Only variants that meet a condition, such as \"wheel_mass < '900 kg'\".")
@click.option("--sort", help="Column to sort by.")
@click.option("--descending", is_flag=True, help="Greatest first.")
@click.option("--limit", type=click.IntRange(min=1), default=10, show_default=True, help="How many variants to list.")
@click.option("--columns", help="Summaries to show, or with --at fields, separated by commas; all unless given.")
@click.option(
    "--at", help="Fields of one machine at crank angles '37 deg', at displacements, or its motion at '0.2 s'."
)
@click.option("--variant", type=int, help="With --at: one variant of a result file.")
@SET
@JSON
@errors_as_messages
def show(
    file: Path,
    where: str | None,
    sort: str | None,
    descending: bool,
    limit: int,
    columns: str | None,
    at: str | None,
    variant: int | None,
    settings: tuple[str, ...],
    as_json: bool,
) -> None:
    """Show a result file: what it holds, its verdicts, its best variants; or with --at one machine at one position.

    With --at, FILE may be a scene or study too.
    """
    if at is not None:
        _show_at(str(file), variant, at, names_in(columns or ""), settings, as_json)
        return
    from sweeps.optimising.optimum import is_front, is_search, optimum_text
    from sweeps.report.files.result_data import result_data
    from sweeps.report.result_report import (
        answer_text,
        counts_text,
        fields_text,
        meeting_text,
        variants_done_text,
        variants_text,
        varied_text,
    )
    from sweeps.report.sweep_result import SweepResult
    from sweeps.text.input_files import InputError

    if settings or variant is not None:
        raise InputError(str(file), [(None, "", "--set and --variant go with --at, which shows one machine")])
    result = SweepResult(file)
    result.show_own_units()
    tell_altered(file)
    names = [n.strip() for n in columns.split(",")] if columns else []
    unknown = [n for n in names if n not in result.columns]
    if unknown:
        raise InputError(
            str(file), [(None, "columns", f"{unknown[0]!r} is not there; there are: {', '.join(result.columns)}")]
        )
    goal, usual = result.goal, "front > 0" if is_front(result) else None
    if sort is None and goal is not None:
        sort, descending = goal.goal, goal.sign < 0
    condition = where or (goal.where if goal else usual)
    chosen = result.select(condition, sort or (usual and "front"), descending, most=limit)
    if as_json:
        tell_data(result_data(result, chosen, names))
        return
    d = result.description
    tell(f"{d.title}: {variants_done_text(result)}")
    tell(f"varied: {varied_text(result)}")
    for line in fields_text(result):
        tell(line)
    tell(counts_text(result))
    tell(f"{meeting_text(result, condition)}; the first {chosen.size}:")
    tell(variants_text(result, chosen, names))
    if where is None:
        tell((optimum_text if is_search(result) else answer_text)(result))


def _show_at(
    file: str, variant: int | None, at: str, names: tuple[str, ...], settings: tuple[str, ...], as_json: bool
) -> None:
    """Show fields of one machine at some positions or instants."""
    from sweeps.cli.named_machine import machine_of, read_at
    from sweeps.report.readings import readings_text
    from sweeps.text.scene_text import with_values

    scene, values, _ = machine_of(file, variant, settings)
    readings = read_at(with_values(scene, values), at, names)
    if as_json:
        from sweeps.report.files.data_files import table_data
        from sweeps.report.files.exports import reading_table

        tell_data(table_data(reading_table(readings, scene.title)))
        return
    tell(readings_text(readings))


@click.command()
@click.argument("file")
@click.option(
    "--out", type=click.Path(path_type=Path), help="Picture file (.png, .svg, .pdf); beside the file unless given."
)
@click.option("--variant", type=int, help="Machine of one variant of a result file.")
@click.option(
    "--at", default="", help="Crank angles of the drawing [deg], or displacements such as '20 mm'; with commas."
)
@click.option("--paths", default="", help="Points whose paths are drawn, separated by commas.")
@click.option(
    "--with", "shown", default="", help="What else the drawing shows, with commas: masses, forces, links, scale."
)
@click.option(
    "--plans",
    is_flag=True,
    help="Also velocity, acceleration and force plans at the first of --at, reactions over the cycle, and loads of the "
    "eight most heavily loaded bearings.",
)
@click.option("--bearings", default="", help="Also loads of these bearings: input, GROUP.first and so on, with commas.")
@click.option("--hodograph", is_flag=True, help="Also the hodograph of the shaking force, and its orders.")
@click.option("--beside", help="Scene, study or result whose shaking force is drawn beside; with --hodograph.")
@click.option("-x", help="Column along x (results); a field along x instead of the crank angle.")
@click.option("-y", help="Column along y, or shown (results); fields of one machine, such as B.vx, with commas.")
@click.option("--colour", help="Column shown as colour (results).")
@POSITIONS
@SET
@errors_as_messages
@doing("Drawing the pictures")
def plot(
    file: str,
    out: Path | None,
    variant: int | None,
    at: str,
    paths: str,
    shown: str,
    plans: bool,
    bearings: str,
    hodograph: bool,
    beside: str | None,
    x: str | None,
    y: str | None,
    colour: str | None,
    positions: int | None,
    settings: tuple[str, ...],
) -> None:
    """Draw: of a scene its machine and diagrams; of a result file the sweep, or the machine of one variant.

    Of a mechanism that is a drawing and diagrams over its cycle; of rotors and engines among the machine elements plans
    of their unbalances and sheets of the orders that shake them, told in a table too; of governors what holds their
    balls; of torsional trains their modes, Campbell diagram and moments over speed, of gear trains pictures of their
    velocities, told in tables too.
    """
    from sweeps.cli.named_machine import is_result, machine_of, positions_of
    from sweeps.pictures import picture_files
    from sweeps.text.scene_text import with_values

    # What is loaded by now stays to the end: the collector of garbage need not go through it at every sheet.
    gc.freeze()
    tables = ""
    if is_result(file):
        tell_altered(file)
    if is_result(file) and variant is None and not (plans or bearings or hodograph or beside or settings):
        from sweeps.pictures.sweep.result_pictures import result_pictures
        from sweeps.report.sweep_result import SweepResult

        made = result_pictures(SweepResult(Path(file)), out, x, y, colour)
    elif x or y:
        scene, values, name = machine_of(file, variant, settings)
        fields = names_in(y or "")
        target = out or Path(f"{name}_{'_'.join(fields).replace('.', '_') or 'fields'}.png")
        made = [picture_files.field_picture(with_values(scene, values), target, fields, x, positions)]
    else:
        scene, values, name = machine_of(file, variant, settings)
        stem, places = out or Path(f"{name}.png"), positions_of(scene, at)
        made = picture_files.machine_pictures(scene, values, stem, places, names_in(paths), names_in(shown))
        if plans or bearings:
            from sweeps.pictures.plans import bearing_pictures, plan_pictures

            made += plan_pictures(scene, stem, next(iter(places), None), values) if plans else []
            made += bearing_pictures(scene, stem, names_in(bearings), values)
        if hodograph or beside:
            other = machine_of(beside, None) if beside else None
            made.append(picture_files.hodograph_picture((scene, values, name), other, stem))
        if scene.elements:
            from sweeps.pictures.elements.element_pictures import element_tables

            tables = element_tables(with_values(scene, values))
    if tables:
        tell(tables)
    tell("\n".join(f"Wrote {path}" for path in dict.fromkeys(made)))


@click.command()
@click.argument("file", required=False)
@click.option(
    "--out", type=click.Path(path_type=Path), help="Picture file (.png, .svg, .pdf) in which to draw them as well."
)
@click.option("--variant", type=int, help="Engines of one variant of a result file.")
@errors_as_messages
def orders(file: str | None, out: Path | None, variant: int | None) -> None:
    """Show which orders of force, couple and torque remain: of well-known engines, or of those in a scene or result."""
    from sweeps.cli.named_machine import machine_of
    from sweeps.pictures.elements.order_picture import order_picture
    from sweeps.report.order_table import engine_rows, order_table, well_known_engines
    from sweeps.text.input_files import InputError
    from sweeps.text.scene_text import with_values

    rows = well_known_engines()
    if file is not None:
        scene, values, _ = machine_of(file, variant)
        rows = engine_rows(with_values(scene, values))
        if not rows:
            raise InputError(file, [(None, "elements", 'none is an engine; add [elements.NAME] with type = "engine"')])
    tell(order_table(rows, markdown=False).removesuffix("\n"))
    if out is not None:
        order_picture(out, rows)
        tell(f"Wrote {out}")


@click.command()
@click.argument("file")
@click.option("--out", type=click.Path(path_type=Path), help="GIF file; NAME.gif unless given.")
@click.option("--variant", type=int, help="Machine of one variant of a result file.")
@click.option("--paths", default="", help="Points whose paths are drawn, separated by commas.")
@click.option("--frames", type=click.IntRange(4, 1000), default=60, show_default=True)
@SET
@errors_as_messages
@doing("Drawing the frames")
def animate(
    file: str, out: Path | None, variant: int | None, paths: str, frames: int, settings: tuple[str, ...]
) -> None:
    """Animate the mechanism of a scene, study or variant as a GIF."""
    from sweeps.cli.named_machine import machine_of
    from sweeps.pictures.machine.animation import save_animation

    scene, values, name = machine_of(file, variant, settings)
    out = out or Path(f"{name}.gif")
    make_folder(out)
    save_animation(scene, out, frames=frames, paths=names_in(paths), values=values)
    tell(f"Wrote {out}")
