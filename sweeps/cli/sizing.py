"""Commands that size parts of a machine: flywheel, balance."""

from pathlib import Path

import click

from sweeps.cli import needed
from sweeps.cli.shared import ERRORS, Options, WholeNumber, in_options, main, names_in, tell, write_text
from sweeps.text.input_files import InputError


@main.command()
@click.argument("table", type=click.Path(path_type=Path))
@click.option("--speed", required=True, help="Mean of maximum and minimum speed, such as '250 rpm'.")
@click.option(
    "--fluctuation",
    required=True,
    help="Required coefficient of speed fluctuation, (max - min) / mean speed, such as 1/50 or 2 %.",
)
@click.option("--interpolation", type=click.Choice(["linear", "pchip", "spline"]), default="linear", show_default=True)
@click.option("--inertia", default="0", help="Existing inertia of the machine, such as '0.4 kg m2'.")
@click.option("--area-energy", help="Energy per unit of area, '4.5 J'; TABLE then lists areas.")
def flywheel(**asked: str) -> None:
    """Size a flywheel from a turning-moment diagram.

    TABLE is a CSV with the columns `phi [deg]` and `moment [N m]`. With --area-energy it has one column, `area [mm2]`:
    the areas between diagram and mean line in order, positive above the line.
    """
    tell(needed.flywheel_text(**asked))


@main.command("balance")
@click.argument("file", required=False)
@click.option("--links", default="", help="Links on fixed axes, comma-separated (default: the crank).")
@click.option("--place", "places", multiple=True, help="Place on any link, 'rod: -60 mm, 0 mm'; repeatable.")
@click.option("--criterion", type=click.Choice(["rms", "peak", "full"]), default="rms", show_default=True)
@click.option("--radius", help="Radius of the counterweights, '60 mm' (default: the crank's length).")
@click.option("--most", help="Maximum mass of each counterweight, '8 kg'.")
@click.option("--variant", type=WholeNumber(0), help="Machine of one variant of a result file.")
@click.option("--out", type=click.Path(path_type=Path), help="Scene to write, with the counterweights (TOML).")
@click.option("--trial-runs", type=click.Path(path_type=Path), help="CSV of a rotor's trial runs, instead of FILE.")
@click.option("--noise", help="Standard deviation of its readings, '0.1 mm/s'.")
@click.option(
    "--holes", type=WholeNumber(1), help="Number of equally spaced holes for the weights, the first at the mark."
)
@click.option("--planes", help="Planes of an engine's balance shafts, '-80 mm, 80 mm'.")
@ERRORS
@in_options
def balance_command(asked: Options) -> None:
    """Find the counterweights of a mechanism, the balance shafts of an engine, or the correction weights of a rotor.

    FILE is a scene, study or result. Counterweights minimise the shaking force at constant crank speed: its rms, its
    peak, or all of it. Balance shafts cancel the primary and secondary force and couple of an engine element. Rotor
    corrections follow from trial runs: --trial-runs is a table with a row per run, the first without a trial weight,
    and a header such as
    `plane, weight [g], weight_angle [deg], left [mm/s], left_phase [deg]`.
    """
    if (asked.file is None) == (asked.trial_runs is None):
        message = "give either a scene, study or result to balance, or --trial-runs with a table of readings"
        raise InputError.of("balance", message)
    if asked.trial_runs is not None:
        tell(needed.trial_runs_text(asked.trial_runs, asked.noise, asked.holes))
        return
    scene = needed.machine_of(asked.file, asked.variant).scene
    if scene.input is None and needed.engines_of(scene):
        tell(needed.balance_shaft_text(scene, asked.planes))
        return
    found = needed.counterweights_of(
        scene, names_in(asked.links), asked.places, asked.criterion, asked.radius, asked.most
    )
    tell(needed.counterweight_text(scene, found, asked.criterion))
    if asked.out is not None:
        write_text(asked.out, needed.write_scene(found.scene))
        tell(f"Wrote {asked.out}")
