"""Plain-text tables."""

import shutil
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path

# Columns of text at least, in a narrow terminal too.
NARROWEST = 20


def table(rows: Sequence[Sequence[str]], indent: str = "") -> str:
    """Rows of cells in aligned columns; "" if empty."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ("  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip() for row in rows)
    return "\n".join(indent + line for line in lines)


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
