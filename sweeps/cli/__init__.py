"""The command line: its group of commands."""

from sweeps.cli import asking, computing, exporting, reporting, showing, sizing, starting, synthesising
from sweeps.cli.shared import main
