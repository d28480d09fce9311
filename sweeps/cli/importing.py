"""The command that reads linkages of other programs: import."""

from pathlib import Path

import click

from sweeps.cli.shared import errors_as_messages, tell, write_text


@click.command("import")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--unit", help="What a unit of length of FILE is; 1 mm unless given or told by an address of PMKS+.")
@click.option("--speed", help="Speed of the crank; 60 rpm unless given or told by an address of PMKS+.")
@click.option("--out", type=click.Path(path_type=Path), help="Scene to write; FILE with .toml unless given.")
@errors_as_messages
def import_command(file: Path, unit: str | None, speed: str | None, out: Path | None) -> None:
    """Write the scene of a linkage saved by pylinkage (JSON), PMKS (rows of joints, or an address with mech=) or PMKS+.

    Of PMKS+ FILE holds the address that it shares, https://app.pmksplus.com/?…
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
