"""Commands to get started: list, new, import, schema, modes, guide."""

from collections.abc import Callable, Mapping
from pathlib import Path
from shlex import quote

import click

import engine
from sweeps.cli import needed
from sweeps.cli.shared import main, tell, write_text
from sweeps.cli.waiting import doing


@main.command("list")
def list_command() -> None:
    """List the bundled studies and the templates for scenes."""
    tell("Studies (sweeps run NAME):")
    tell(needed.table_by_subject(needed.questions(), needed.bundled_studies()))
    tell("Templates (sweeps new NAME):")
    tell(needed.table_by_subject(needed.templates(), needed.bundled_templates()))


@main.command()
@click.argument("template")
@click.option("--out", type=click.Path(path_type=Path), help="File to write; default: TEMPLATE.toml.")
def new(template: str, out: Path | None) -> None:
    """Write a commented scene to start from."""
    text = needed.template_text(template)
    out = out or Path(f"{template}.toml")
    write_text(out, text)
    file = quote(str(out))
    tell(f"Wrote {out}. Edit it, then: sweeps check {file}; sweeps plot {file}; sweeps run {file}")
    tell("Editors complete and check it after: sweeps schema")


@main.command("import")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--unit", help="Length unit of FILE (default: 1 mm, or the unit in a PMKS+ address).")
@click.option("--speed", help="Crank speed (default: 60 rpm, or the speed in a PMKS+ address).")
@click.option("--out", type=click.Path(path_type=Path), help="Scene to write; default: FILE with .toml.")
def import_command(file: Path, unit: str | None, speed: str | None, out: Path | None) -> None:
    """Convert a linkage from pylinkage (JSON), PMKS (rows of joints, or an address with mech=) or PMKS+ to a scene.

    For PMKS+, FILE contains the shared address, https://app.pmksplus.com/?…
    """
    if speed is not None:
        needed.numbers_in_row("--speed", speed, ("angular_speed",))
    size = None if unit is None else needed.numbers_in_row("--unit", unit, ("length",))[0]
    scene = needed.import_scene(file, size, speed)
    out = out or file.with_suffix(".toml")
    write_text(out, f"# Imported from {file.name}: kinematics only.\n\n{needed.write_scene(scene)}")
    tell(f"Wrote {out}: sweeps check {quote(str(out))}; sweeps plot {quote(str(out))}")


@main.command()
@click.option("--out", type=click.Path(path_type=Path), default=Path("."), help="Folder of the scenes; default: this.")
def schema(out: Path) -> None:
    """Write JSON Schemas of scenes and studies, by which editors complete keys and mark mistakes while you type.

    VS Code with the extension Even Better TOML reads them for files next to them that begin with the line
    `#:schema scene.schema.json`, or `#:schema study.schema.json` for studies; templates have that line.
    """
    for name, text in needed.schema_texts().items():
        write_text(out / name, text, replace=True)
        tell(f"Wrote {out / name}")


@main.command()
@click.argument("scene")
@click.option(
    "--out", type=click.Path(path_type=Path), help="Picture file (.png, .svg, .pdf); default: SCENE_modes.png."
)
@click.option("--no-plots", is_flag=True, help="Only list them.")
def modes(scene: str, out: Path | None, no_plots: bool) -> None:
    """List the real assembly modes of free links at the first position, with a picture of each.

    A scene selects a mode by the approximate position of a point: near.B = { x = "80 mm", y = "20 mm" }.
    """
    machine = needed.machine_of(scene, None)
    found = engine.assembly_modes(machine.scene)
    tell(needed.mode_table(found))
    if found and not no_plots:
        made = needed.mode_pictures(machine.scene, found, out or Path(f"{machine.name}_modes.png"))
        for path, refusal in made.items():
            tell(f"Wrote {path}" if refusal is None else f"Not drawn: {path}: {refusal}")


@main.command("guide")
@click.argument("chapter", required=False)
@click.option("--web", is_flag=True, help="Make a site of the whole guide, with pictures, search and reference.")
@click.option(
    "--out", type=click.Path(path_type=Path), help="Folder of the site; default: guide, opened in the browser."
)
def guide_command(chapter: str | None, web: bool, out: Path | None) -> None:
    """Show a chapter or a reference page of the guide, or list them all.

    The site of --web needs no network; building it requires pip install 'machine-sweeps[guide]'.
    """
    if web or out is not None:
        with doing("Building the site"):
            first = needed.build_site(reference_pages(), out or Path("guide"))
        tell(f"Wrote {first}")
        if out is None:
            click.launch(str(first))
    elif chapter in needed.GENERATED:
        tell(reference_pages()[chapter]())
    else:
        tell(needed.chapters_text() if chapter is None else needed.chapter_text(chapter))


def reference_pages() -> Mapping[str, Callable[[], str]]:
    """Functions that generate the Markdown of each reference page, by name."""
    return {"commands": commands_page, **needed.PAGES}


def commands_page() -> str:
    """Help on all commands, in Markdown."""
    helps = (
        f"## {name}\n\n```text\n{command.get_help(click.Context(command, info_name=f'sweeps {name}'))}\n```"
        for name, command in sorted(main.commands.items())
    )
    return "\n\n".join(["# Commands", *helps])
