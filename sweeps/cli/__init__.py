"""The command line: its group of commands."""

from sweeps.cli import asking, exporting, reporting, running, showing, sizing, starting, synthesising
from sweeps.cli.shared import main
