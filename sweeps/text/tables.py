"""Plain-text tables."""

import shutil
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

# Minimum number of text columns, even in a narrow terminal.
NARROWEST = 20


def table(rows: Sequence[Sequence[str]], indent: str = "") -> str:
    """Rows of cells in aligned columns; "" if empty."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ("  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip() for row in rows)
    return "\n".join(indent + line for line in lines)


def column(words: str, units: str, values: Iterable[float]) -> list[str]:
    """Cells of a column: its head with the unit shown, then numbers in it, a dash for those that don't exist.

    Parameters
    ----------
    words : str
    units : str
        CF unit ("kg m2") of the values, "1" for plain numbers.
    values : iterable of float
    """
    # Slow to import, and `sweeps list` needs tables too.
    import numpy as np

    from engine import display_unit

    values = np.array([*values])
    factor, label = display_unit(units, values)
    head = words if label == "1" else f"{words}, {label}"
    return [head, *("–" if np.isnan(value) else f"{factor * value:.5g}" for value in values)]


def table_by_subject(texts: Mapping[str, str], files: Mapping[str, Path]) -> str:
    """Names and texts in two columns, wrapped at the terminal's width, under the names of their files' folders."""
    left = " " * (max(map(len, texts)) + 6)
    width = max(shutil.get_terminal_size().columns, len(left) + NARROWEST)
    lines = []
    for name in sorted(texts, key=lambda name: (files[name].parent.name, name)):
        heading = f"  {files[name].parent.name.replace('_', ' ')}"
        if heading not in lines:
            lines.append(heading)
        first = f"    {name}".ljust(len(left))
        lines += textwrap.wrap(texts[name], width, initial_indent=first, subsequent_indent=left, break_on_hyphens=False)
    return "\n".join(lines)
