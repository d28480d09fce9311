"""The import command: linkages from other programs."""

from pathlib import Path

import click

from sweeps.cli.shared import main, tell, write_text


@main.command("import")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--unit", help="Length unit of FILE (default: 1 mm, or the unit in a PMKS+ address).")
@click.option("--speed", help="Crank speed (default: 60 rpm, or the speed in a PMKS+ address).")
@click.option("--out", type=click.Path(path_type=Path), help="Scene to write; default: FILE with .toml.")
def import_command(file: Path, unit: str | None, speed: str | None, out: Path | None) -> None:
    """Convert a linkage from pylinkage (JSON), PMKS (rows of joints, or an address with mech=) or PMKS+ to a scene.

    For PMKS+, FILE contains the shared address, https://app.pmksplus.com/?…
    """
    from sweeps.imports.foreign_scene import import_scene
    from sweeps.text.numbers_in_row import numbers_in_row
    from sweeps.text.scene_text import write_scene

    if speed is not None:
        numbers_in_row("--speed", speed, ("angular_speed",))
    size = None if unit is None else numbers_in_row("--unit", unit, ("length",))[0]
    scene = import_scene(file, size, speed)
    out = out or file.with_suffix(".toml")
    write_text(out, f"# Imported from {file.name}: kinematics only.\n\n{write_scene(scene)}")
    tell(f"Wrote {out}: sweeps check {out}; sweeps plot {out}")
