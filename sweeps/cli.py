"""The command line: run, optimise, check, show, plot, orders, animate, export, new, list, flywheel."""

import time
from pathlib import Path

import click

from sweeps.commands import (
    explained,
    make_folder,
    names_in,
    plots_of,
    run_options,
    stop,
    tell_files,
    tell_version,
    use_threads,
    write,
)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.option("--version", is_flag=True, is_eager=True, expose_value=False, callback=tell_version, help="Version.")
def main() -> None:
    """Planar machines evaluated over many design variants: kinematics, reduced inertia and moments, flywheels.

    Start with `sweeps list`, then `sweeps run crank_press`; `sweeps new slider_crank` writes a scene of your own.
    """


@main.command("list")
@explained
def list_command() -> None:
    """List the bundled studies and the templates for scenes."""
    from sweeps.report import table
    from sweeps.study import bundled, read_study
    from sweeps.template import templates

    click.echo("Studies (sweeps run NAME):")
    click.echo(table([(name, read_study(path).question) for name, path in bundled().items()], "  "))
    click.echo("Templates (sweeps new NAME):")
    click.echo(table([(name, title) for name, title in templates().items()], "  "))


@main.command()
@click.argument("template")
@click.option("--out", type=click.Path(path_type=Path), help="File to write; TEMPLATE.toml unless given.")
@explained
def new(template: str, out: Path | None) -> None:
    """Write a commented scene to start from."""
    from sweeps.template import template_text
    from sweeps.textfile import InputError

    text = template_text(template)
    out = out or Path(f"{template}.toml")
    if out.exists():
        raise InputError(str(out), [(None, "", "exists already; name another file with --out")])
    write(out, text)
    click.echo(f"Wrote {out}. Edit it, then: sweeps check {out}; sweeps plot {out}; sweeps run {out}")


@main.command()
@click.argument("study")
@run_options("results/NAME.h5")
@explained
def run(study: str, out: Path | None, restart: bool, jobs: int | None, no_plots: bool, quiet: bool) -> None:
    """Run a study (a file, or the name of a bundled one) into an HDF5 file; go on where it was interrupted."""
    from sweeps.progress import Progress
    from sweeps.report import answer_text, counts_text, kept_text
    from sweeps.results import Result
    from sweeps.runner import run_study
    from sweeps.study import find_study, read_study

    started = time.perf_counter()
    found = read_study(find_study(study))
    out = out or Path("results") / f"{found.name}.h5"
    make_folder(out)
    use_threads(jobs)
    bar = Progress(found.design.size, quiet)
    try:
        run_study(found, out, restart, bar.update)
    except KeyboardInterrupt:
        stop(bar, kept_text(out, bar.total))
    bar.close()
    result = Result(out)
    plural = "" if found.design.size == 1 else "s"
    click.echo(f"{found.title or found.name}: {found.design.size} variant{plural}")
    click.echo(counts_text(result))
    click.echo(answer_text(result))
    tell_files([out, *([] if no_plots else plots_of(result))], started)


@main.command()
@click.argument("study")
@run_options("results/NAME_optimised.h5")
@explained
def optimise(study: str, out: Path | None, restart: bool, jobs: int | None, no_plots: bool, quiet: bool) -> None:
    """Search a study for the best within what varies, by its [optimise] or [best]; go on where it was interrupted."""
    from sweeps.optimising.optimum import optimum_text
    from sweeps.optimising.runner import generations_kept, optimise_study
    from sweeps.optimising.task import task_of
    from sweeps.progress import Progress
    from sweeps.report import counts_text
    from sweeps.results import Result
    from sweeps.study import find_study, read_study

    started = time.perf_counter()
    found = read_study(find_study(study))
    out = out or Path("results") / f"{found.name}_optimised.h5"
    make_folder(out)
    use_threads(jobs)
    bar = Progress(task_of(found).generations, quiet, "generations")
    try:
        optimise_study(found, out, restart, bar.update)
    except KeyboardInterrupt:
        stop(bar, f"{generations_kept(out)} of {bar.total} generations are done and kept")
    bar.close()
    result = Result(out)
    click.echo(f"{found.title or found.name}: {result.description.variants} candidates")
    click.echo(counts_text(result))
    click.echo(optimum_text(result))
    tell_files([out, *([] if no_plots else plots_of(result))], started)


@main.command()
@click.argument("study")
@click.option("--out", type=click.Path(path_type=Path), default=Path("results"), help="Where the result would go.")
@click.option("--source", is_flag=True, help="Print the generated kernel instead.")
@explained
def check(study: str, out: Path, source: bool) -> None:
    """Say what a study or scene will compute, what not and why, and its time, memory and file size."""
    from sweeps.report import check_text
    from sweeps.study import find_study, read_study

    found = read_study(find_study(study))
    if source:
        click.echo(found.machine().source("whole").text)
    else:
        click.echo(check_text(found, out))


@main.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--where", help="Only variants that meet a condition, such as \"wheel_mass < '900 kg'\".")
@click.option("--sort", help="Column to sort by.")
@click.option("--descending", is_flag=True, help="Greatest first.")
@click.option("--limit", type=click.IntRange(min=1), default=10, show_default=True, help="How many variants to list.")
@click.option("--columns", help="Summaries to show, separated by commas; all unless given.")
@explained
def show(file: Path, where: str | None, sort: str | None, descending: bool, limit: int, columns: str | None) -> None:
    """Show a result file: what it holds, its verdicts, its best variants."""
    from sweeps.optimising.optimum import is_front, is_search, optimum_text
    from sweeps.report import answer_text, counts_text, variants_done_text, variants_text
    from sweeps.results import Result
    from sweeps.textfile import InputError

    result = Result(file)
    names = [n.strip() for n in columns.split(",")] if columns else []
    unknown = [n for n in names if n not in result.columns]
    if unknown:
        raise InputError(
            str(file), [(None, "columns", f"{unknown[0]!r} is not there; there are: {', '.join(result.columns)}")]
        )
    goal, usual = result.goal, "front > 0" if is_front(result) else None
    if sort is None and goal is not None:
        sort, descending = goal.goal, goal.sign < 0
    chosen = result.select(where or (goal.where if goal else usual), sort or (usual and "front"), descending)
    d = result.description
    click.echo(f"{d.title}: {variants_done_text(result)}")
    click.echo(f"varied: {d.attributes.get('grid', '')}")
    if result.fields:
        click.echo(f"fields over {d.positions} positions: {', '.join(result.fields)}")
    click.echo(counts_text(result))
    click.echo(f"{chosen.size} variants meet the condition; the first {min(limit, chosen.size)}:")
    click.echo(variants_text(result, chosen[:limit], names))
    if where is None:
        click.echo((optimum_text if is_search(result) else answer_text)(result))


@main.command()
@click.argument("file")
@click.option(
    "--out", type=click.Path(path_type=Path), help="Picture file (.png, .svg, .pdf); beside the file unless given."
)
@click.option("--variant", type=int, help="Machine of one variant of a result file.")
@click.option(
    "--at", default="", help="Crank angles of the drawing [deg], or displacements such as '20 mm'; with commas."
)
@click.option("--paths", default="", help="Points whose paths are drawn, separated by commas.")
@click.option("--plans", is_flag=True, help="Also velocity, acceleration and force plans at the first of --at.")
@click.option("--hodograph", is_flag=True, help="Also the hodograph of the shaking force, and its orders.")
@click.option("--beside", help="Scene, study or result whose shaking force is drawn beside; with --hodograph.")
@click.option("-x", help="Column along x (results).")
@click.option("-y", help="Column along y, or shown (results).")
@click.option("--colour", help="Column shown as colour (results).")
@explained
def plot(
    file: str,
    out: Path | None,
    variant: int | None,
    at: str,
    paths: str,
    plans: bool,
    hodograph: bool,
    beside: str | None,
    x: str | None,
    y: str | None,
    colour: str | None,
) -> None:
    """Draw: of a scene its machine and diagrams; of a result file the sweep, or the machine of one variant.

    Of a mechanism that is a drawing and diagrams over its cycle; of rotors and engines among the machine elements plans
    of their unbalances and sheets of the orders that shake them, told in a table too.
    """
    from sweeps import pictures
    from sweeps.element_pictures import element_tables
    from sweeps.named_machine import is_result, machine_of, positions_of
    from sweeps.plans import plan_pictures
    from sweeps.scenefile import with_values

    tables = ""
    if is_result(file) and variant is None and not (plans or hodograph or beside):
        made = pictures.result_pictures(Path(file), out, x, y, colour)
    else:
        scene, values, name = machine_of(file, variant)
        stem, places = out or Path(f"{name}.png"), positions_of(scene, at)
        made = pictures.machine_pictures(scene, values, stem, places, names_in(paths))
        made += plan_pictures(scene, stem, next(iter(places), None), values) if plans else []
        if hodograph or beside:
            other = machine_of(beside, None) if beside else None
            made.append(pictures.hodograph_picture((scene, values, name), other, stem))
        tables = element_tables(with_values(scene, values))
    if tables:
        click.echo(tables)
    click.echo("\n".join(f"Wrote {path}" for path in made))


@main.command()
@click.argument("file", required=False)
@click.option("--out", type=click.Path(path_type=Path), help="Picture file (.png, .svg, .pdf) to draw them too.")
@click.option("--variant", type=int, help="Engines of one variant of a result file.")
@explained
def orders(file: str | None, out: Path | None, variant: int | None) -> None:
    """Tell which orders of force, couple and torque remain: of well-known engines, or of those of a scene or result."""
    from sweeps.named_machine import machine_of
    from sweeps.order_table import engine_rows, order_picture, order_table, well_known_engines
    from sweeps.scenefile import with_values
    from sweeps.textfile import InputError

    rows = well_known_engines()
    if file is not None:
        scene, values, _ = machine_of(file, variant)
        rows = engine_rows(with_values(scene, values))
        if not rows:
            raise InputError(file, [(None, "elements", 'none is an engine; add [elements.NAME] with type = "engine"')])
    click.echo(order_table(rows, markdown=False), nl=False)
    if out is not None:
        order_picture(out, rows)
        click.echo(f"Wrote {out}")


@main.command()
@click.argument("file")
@click.option("--out", type=click.Path(path_type=Path), help="GIF file; NAME.gif unless given.")
@click.option("--variant", type=int, help="Machine of one variant of a result file.")
@click.option("--paths", default="", help="Points whose paths are drawn, separated by commas.")
@click.option("--frames", type=click.IntRange(min=4), default=60, show_default=True)
@explained
def animate(file: str, out: Path | None, variant: int | None, paths: str, frames: int) -> None:
    """Animate the mechanism of a scene, study or variant as a GIF."""
    from sweeps.animation import animate as make
    from sweeps.named_machine import machine_of

    scene, values, name = machine_of(file, variant)
    out = out or Path(f"{name}.gif")
    make_folder(out)
    make(scene, out, frames=frames, paths=names_in(paths), values=values)
    click.echo(f"Wrote {out}")


@main.command()
@click.argument("file")
@click.option("--to", type=click.Path(path_type=Path), required=True, help="File to write: .csv, .svg, .dxf or .toml.")
@click.option("--variant", type=int, help="One variant of a result file.")
@click.option("--at", default="", help="Crank angle of the drawing [deg], or displacement such as '20 mm'.")
@click.option("--where", help="Only variants that meet a condition (CSV of a result).")
@click.option("--history", is_flag=True, help="The motion through the regimes, instant by instant (CSV).")
@explained
def export(file: str, to: Path, variant: int | None, at: str, where: str | None, history: bool) -> None:
    """Write results, positions or a history as CSV, the drawing as SVG or DXF, one variant as a scene (TOML)."""
    from sweeps import exports
    from sweeps.named_machine import is_result, machine_of, positions_of
    from sweeps.textfile import InputError

    if history and to.suffix != ".csv":
        raise InputError(str(to), [(None, "--history", f"writes .csv, not {to.suffix!r}; name a .csv file")])
    make_folder(to)
    machine = ""
    match to.suffix:
        case ".csv" if history:
            scene, values, machine = machine_of(file, variant)
            if ended := exports.history_csv(scene, values, to):
                click.echo(f"The history ends early: {ended}", err=True)
        case ".csv" if is_result(file) and variant is None:
            exports.result_csv(Path(file), to, where)
        case ".csv":
            scene, values, machine = machine_of(file, variant)
            exports.positions_csv(scene, values, to)
        case ".svg" | ".dxf":
            scene, values, machine = machine_of(file, variant)
            exports.drawing(scene, values, to, next(iter(positions_of(scene, at)), None))
        case ".toml":
            scene, values, machine = machine_of(file, variant)
            exports.scene_toml(scene, values, to)
        case _:
            raise InputError(str(to), [(None, "--to", f"ending {to.suffix!r}: allowed are .csv, .svg, .dxf, .toml")])
    click.echo(f"Wrote {to}" + (f" of {machine}" if machine else ""))


@main.command()
@click.argument("table", type=click.Path(path_type=Path))
@click.option("--speed", required=True, help="Mean speed, such as '250 rpm'.")
@click.option("--fluctuation", required=True, help="Coefficient of speed fluctuation asked for, such as 1/50 or 2 %.")
@click.option("--interpolation", type=click.Choice(["linear", "pchip", "spline"]), default="linear", show_default=True)
@explained
def flywheel(table: Path, speed: str, fluctuation: str, interpolation: str) -> None:
    """Size a flywheel from a turning-moment table: a CSV with the columns `phi [deg]` and `moment [N m]`."""
    from sweeps.flywheel_table import flywheel_text

    click.echo(flywheel_text(table, speed, fluctuation, interpolation))
