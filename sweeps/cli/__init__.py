"""The command line: its group of commands."""

import click

from sweeps.cli.asking import compare_command, help_command, quantities
from sweeps.cli.exporting import export
from sweeps.cli.importing import import_command
from sweeps.cli.reporting import report, watch
from sweeps.cli.running import check, optimise, run
from sweeps.cli.shared import Commands, tell_version
from sweeps.cli.showing import animate, orders, plot, show
from sweeps.cli.sizing import balance_command, flywheel
from sweeps.cli.starting import guide_command, list_command, modes, new, schema
from sweeps.cli.synthesising import synthesise
from sweeps.cli.verifying import verify


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.option("--version", is_flag=True, is_eager=True, expose_value=False, callback=tell_version, help="Version.")
def main() -> None:
    """Evaluate planar machines over many design variants: kinematics, reduced inertia and torque, flywheels.

    Start with `sweeps list`, then `sweeps run crank_press`; `sweeps new slider_crank` writes a scene of your own.

    \b
    The Tab key completes commands and options after this line in the shell's start-up file:
      ~/.bashrc                   eval "$(_SWEEPS_COMPLETE=bash_source sweeps)"
      ~/.zshrc                    eval "$(_SWEEPS_COMPLETE=zsh_source sweeps)"
      ~/.config/fish/config.fish  _SWEEPS_COMPLETE=fish_source sweeps | source
    Editors complete scenes and studies after `sweeps schema`.
    """  # noqa: D301


for _command in (
    list_command,
    help_command,
    guide_command,
    new,
    schema,
    synthesise,
    import_command,
    modes,
    quantities,
    check,
    run,
    optimise,
    verify,
    show,
    compare_command,
    plot,
    report,
    watch,
    orders,
    animate,
    export,
    flywheel,
    balance_command,
):
    main.add_command(_command)
