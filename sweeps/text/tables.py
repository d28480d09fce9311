"""Plain-text tables."""

import shutil
import textwrap
from collections.abc import Mapping, Sequence

# Columns of text at least, in a narrow terminal too.
NARROWEST = 20


def table(rows: Sequence[Sequence[str]], indent: str = "") -> str:
    """Rows of cells in aligned columns; "" if empty."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ("  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip() for row in rows)
    return "\n".join(indent + line for line in lines)


def table_by_subject(rows: Sequence[Sequence[str]], subjects: Mapping[str, str]) -> str:
    """Names and texts in two columns, wrapped at the terminal's width, under subject headings found by the name."""
    ordered = sorted(rows, key=lambda row: (subjects[row[0]], row[0]))
    left = " " * (max(len(name) for name, _ in ordered) + 6)
    width = max(shutil.get_terminal_size().columns, len(left) + NARROWEST)
    lines = []
    for name, text in ordered:
        heading = f"  {subjects[name].replace('_', ' ')}"
        if heading not in lines:
            lines.append(heading)
        first = f"    {name}".ljust(len(left))
        lines += textwrap.wrap(text, width, initial_indent=first, subsequent_indent=left, break_on_hyphens=False)
    return "\n".join(lines)
