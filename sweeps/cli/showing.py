"""Commands that display: show, plot, orders, animate."""

from pathlib import Path
from shlex import quote

import click

from sweeps.cli import needed, shared
from sweeps.cli.shared import main
from sweeps.cli.waiting import doing
from sweeps.text.input_files import InputError


@main.command()
@click.argument("file", type=click.Path(path_type=Path))
@shared.WHERE
@shared.ORDER
@click.option("--limit", type=shared.WholeNumber(1), default=10, show_default=True, help="Number of variants to list.")
@click.option("--columns", help="Summaries to show, or fields with --at, comma-separated (default: the answers).")
@click.option(
    "--at",
    help="Fields of one machine at crank angles ('37 deg', '0 to 330, 12') or displacements, or its motion at '0.2 s'.",
)
@click.option("--variant", type=shared.WholeNumber(0), help="One variant of a result file.")
@shared.SET
@shared.ALL
@shared.JSON
@shared.ERRORS
@shared.joints_by_letter
@shared.in_options
def show(asked: shared.Options) -> None:
    """Show a result file: contents, verdicts, best variants; or one variant; or, with --at, a machine at positions.

    With --at, FILE can also be a scene or study. The exit code is 1 if the question of the study has no answer.
    """
    if asked.at is not None:
        _show_at(asked)
        return
    if asked.settings:
        raise InputError.of(str(asked.file), "--set requires --at, which shows one machine")
    result = needed.SweepResult(asked.file)
    result.show_own_units()
    shared.tell_altered(asked.file)
    names = shared.names_in(asked.columns or "")
    result.need(names, "columns")
    if asked.variant is not None:
        # Raises an error if there is no such variant.
        result.variant_values(asked.variant)
        shared.tell(needed.variant_text(result, asked.variant, asked.every))
        return
    goal, usual = result.goal, "front > 0" if needed.is_front(result) else None
    sort, descending = asked.sort or (usual and "front"), asked.descending
    if asked.sort is None and goal is not None:
        sort, descending = goal.goal, goal.sign < 0
    condition = asked.where or (goal.where if goal else usual)
    chosen = result.select(condition, sort, descending, most=asked.limit)
    if asked.as_json:
        shared.tell_data(needed.result_data(result, chosen, names) | {"warnings": shared.warnings_of(result)})
        shared.stop_without_answer(result)
        return
    shared.tell(needed.contents_text(result))
    # The answer lists a single machine.
    if result.file.variants > 1 or asked.where or names:
        shared.tell(needed.meeting_text(result, condition, chosen.size))
        if chosen.size:
            shared.tell(needed.variants_text(result, chosen, names, asked.every))
    if not asked.where and (result.file.variants > 1 or not names):
        shared.tell((needed.optimum_text if needed.is_search(result) else needed.answer_text)(result, asked.every))
        shared.tell_warnings(result)
        shared.stop_without_answer(result)


def _show_at(asked: shared.Options) -> None:
    """Show fields of one machine at given positions or times."""
    machine = needed.machine_of(str(asked.file), asked.variant, asked.settings)
    readings = needed.read_at(machine.scene, asked.at, shared.names_in(asked.columns or ""))
    if asked.as_json:
        shared.tell_data(needed.table_data(needed.reading_table(readings, machine.scene.title)))
        return
    if machine.variant is not None:
        shared.tell(f"variant {machine.variant} of {asked.file}:")
    shared.tell(needed.readings_text(readings, asked.every or bool(asked.columns)))


# Options of each kind of plot; --out and --variant belong to all.
SWEEP, DRAWING, CURVES, ELEMENTS = "a sweep", "a mechanism", "curves of fields", "machine elements"
_OPTIONS = {
    SWEEP: ("-x", "-y", "--colour", "--where"),
    DRAWING: ("--at", "--paths", "--with", "--plans", "--bearings", "--motion", "--hodograph", "--beside", "--set"),
    CURVES: ("-x", "-y", "--positions", "--set"),
    ELEMENTS: ("--set",),
}


def _drawn_by(*kinds: str) -> str:
    """Which of these kinds of plot the given options ask for; options of other kinds are refused."""
    context = click.get_current_context()
    named = {param.opts[0]: context.params[param.name] for param in context.command.params}
    given = [option for option, value in named.items() if value and option not in ("file", "--out", "--variant")]
    kind = max(kinds, key=lambda kind: len({*given} & {*_OPTIONS[kind]}))
    if strange := [option for option in given if option not in _OPTIONS[kind]]:
        allowed = ", ".join(_OPTIONS[kind])
        raise InputError.of(", ".join(strange), f"has no effect on the plot of {kind}, whose options are {allowed}")
    return kind


@main.command()
@click.argument("file")
@click.option("--out", type=click.Path(path_type=Path), help="Picture file (.png, .svg, .pdf); default: next to FILE.")
@click.option("--variant", type=shared.WholeNumber(0), help="Variant of a result file to use.")
@click.option(
    "--at", default="", help="Crank angles of the drawing [deg], or displacements such as '20 mm', comma-separated."
)
@click.option("--paths", default="", help="Points whose paths are drawn, comma-separated.")
@click.option(
    "--with", "shown", default="", help="Extra items in the drawing, comma-separated: masses, forces, links, scale."
)
@click.option(
    "--plans",
    is_flag=True,
    help="Also velocity, acceleration and force polygons at the first --at, reactions over the cycle, and loads of the "
    "eight most heavily loaded bearings.",
)
@click.option(
    "--bearings", default="", help="Also the loads of these bearings: A, input, GROUP.first and so on, comma-separated."
)
@click.option(
    "--motion",
    default="",
    help="Also displacement, velocity, acceleration and jerk of these sliders and links, comma-separated.",
)
@click.option("--hodograph", is_flag=True, help="Also the hodograph of the shaking force, and its orders.")
@click.option("--beside", help="With --hodograph: scene, study or result to compare with.")
@click.option("-x", help="x axis: a column (results), or a field instead of the crank angle.")
@click.option("-y", help="y axis: a column (results), or fields of one machine such as B.vx, comma-separated.")
@click.option("--colour", help="Column shown as colour (results).")
@shared.WHERE
@shared.POSITIONS
@shared.SET
@shared.joints_by_letter
@doing("Drawing the pictures")
@shared.in_options
def plot(asked: shared.Options) -> None:
    """Plot a scene (machine and diagrams), a sweep, or the machine of one variant.

    Mechanisms: drawing and diagrams over the cycle, indicator diagrams of cylinders. Rotors and engines: unbalance
    plans and order sheets with a table. Governors: controlling force. Torsional trains: modes, Campbell diagram,
    torques over speed, Holzer tables. Gear trains: velocity diagrams with a table.
    """
    if needed.is_result(asked.file):
        shared.tell_altered(asked.file)
    is_whole, tables = needed.is_result(asked.file) and asked.variant is None, ""
    kind = _drawn_by(*([SWEEP] if is_whole else []), DRAWING, CURVES)
    if kind == SWEEP:
        result = needed.SweepResult(Path(asked.file), where=asked.where)
        made = needed.result_pictures(result, asked.out, asked.x, asked.y, asked.colour)
    elif kind == CURVES:
        machine = needed.machine_of(asked.file, asked.variant, asked.settings)
        fields = shared.names_in(asked.y or "")
        target = asked.out or Path(f"{machine.name}_{'_'.join(fields).replace('.', '_') or 'fields'}.png")
        needed.save(needed.field_curves(machine.scene, fields, asked.x, asked.positions or needed.POSITIONS), target)
        made = [target]
    else:
        machine = needed.machine_of(asked.file, asked.variant, asked.settings)
        scene, stem = machine.scene, asked.out or Path(f"{machine.name}.png")
        if scene.input is None:
            _drawn_by(ELEMENTS)
        places = needed.positions_of(scene, asked.at)
        shown = places, shared.names_in(asked.paths), shared.names_in(asked.shown)
        made = needed.machine_pictures(scene, stem, *shown, parts=shared.names_in(asked.motion))
        if asked.plans or asked.bearings:
            made += needed.plan_pictures(scene, stem, next(iter(places), None)) if asked.plans else []
            made += needed.bearing_pictures(scene, stem, shared.names_in(asked.bearings))
        if asked.hodograph or asked.beside:
            others = {} if scene is machine.before else {"scene": machine.before}
            if asked.beside:
                other = needed.machine_of(asked.beside, None)
                others = {other.name: other.scene}
            # Distinguish equal names.
            others = {f"{name} (other)" if name == machine.name else name: shown for name, shown in others.items()}
            made += needed.save_beside(stem, [("hodograph", needed.hodographs({**others, machine.name: scene}))])
        if scene.elements:
            tables = needed.element_tables(scene)
    if tables:
        shared.tell(tables)
    shared.tell("\n".join(f"Wrote {path}" for path in dict.fromkeys(made)))


@main.command()
@click.argument("file", required=False)
@click.option("--out", type=click.Path(path_type=Path), help="Also draw the orders to this file (.png, .svg, .pdf).")
@click.option("--variant", type=shared.WholeNumber(0), help="Variant of a result file to use.")
def orders(file: str | None, out: Path | None, variant: int | None) -> None:
    """Show the unbalanced orders of force, couple and torque of common engines, or of those in a scene or result."""
    rows = needed.well_known_engines()
    if file is not None:
        rows = needed.engine_rows(needed.machine_of(file, variant).scene)
        if not rows:
            mend = f'add [elements.NAME] with type = "engine"; for a mechanism, `sweeps plot {quote(file)} --hodograph`'
            raise InputError.of(file, f"has no engine; {mend}", key="elements")
    shared.tell(needed.order_table(rows))
    if out is not None:
        needed.save(needed.order_picture(rows), out)
        shared.tell(f"Wrote {out}")


@main.command()
@click.argument("file")
@click.option("--out", type=click.Path(path_type=Path), help="GIF file; default: NAME.gif.")
@click.option("--variant", type=shared.WholeNumber(0), help="Variant of a result file to use.")
@click.option("--element", help="A cam or gear train among the scene's elements, instead of the mechanism.")
@click.option("--paths", default="", help="Points whose paths are drawn, comma-separated.")
@click.option("--frames", type=shared.WholeNumber(4, 1000), default=60, show_default=True)
@shared.SET
@doing("Drawing the frames")
@shared.in_options
def animate(asked: shared.Options) -> None:
    """Write an animated GIF of a scene, study or variant."""
    machine = needed.machine_of(asked.file, asked.variant, asked.settings)
    out = asked.out or Path(f"{machine.name}.gif")
    moving = needed.element_named(machine.scene, ["cam", "gear_train"], asked.element)
    if moving is not None:
        needed.save_animation(lambda count: needed.element_frames(moving, count), out, asked.frames)
    else:
        needed.save_animation(
            lambda count: needed.machine_frames(machine.scene, count, shared.names_in(asked.paths)), out, asked.frames
        )
    shared.tell(f"Wrote {out}")
