"""Diagrams of one machine over its cycle: reduced inertia and moment, work, the energy loop, and the speed that follows."""

import difflib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from matplotlib import rc_context
from matplotlib.figure import Figure

MM = 25.4
BLUE, ORANGE, GREEN, RED, PURPLE, SKY, YELLOW = PALETTE = (
    "#0072b2",
    "#e69f00",
    "#009e73",
    "#d55e00",
    "#cc79a7",
    "#56b4e9",
    "#f0e442",
)
STYLE = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "mathtext.fontset": "dejavusans",
    "font.size": 8,
    "axes.titlesize": 8.5,
    "axes.labelsize": 8,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "legend.fontsize": 7.5,
    "figure.titlesize": 10,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.3,
    "axes.grid": True,
    "grid.linewidth": 0.4,
    "grid.color": "#d5d8dc",
    "axes.axisbelow": True,
    "legend.framealpha": 0.85,
    "legend.edgecolor": "none",
    "xtick.direction": "in",
    "ytick.direction": "in",
    "pdf.fonttype": 42,
    "svg.fonttype": "path",
    "svg.hashsalt": "machine-sweeps",
    "savefig.dpi": 200,
}


def style():
    return rc_context(STYLE)

def new_figure(width, height):
    return Figure(figsize=(width/MM,height/MM), layout="constrained")

def save(fig, path):
    with style():
        fig.savefig(path)
