"""The command line: its group of commands."""

from sweeps.cli import (
    asking,
    exporting,
    importing,
    reporting,
    running,
    showing,
    sizing,
    starting,
    synthesising,
    verifying,
)
from sweeps.cli.shared import main
