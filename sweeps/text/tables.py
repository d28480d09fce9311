"""Plain-text tables."""

from collections.abc import Mapping, Sequence


def table(rows: Sequence[Sequence[str]], indent: str = "") -> str:
    """Rows of cells in aligned columns; "" if empty."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ("  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip() for row in rows)
    return "\n".join(indent + line for line in lines)


def table_by_subject(rows: Sequence[Sequence[str]], subjects: Mapping[str, str]) -> str:
    """Rows in aligned columns under subject headings, found by the first cell of each row."""
    ordered = sorted(rows, key=lambda row: (subjects[row[0]], row[0]))
    lines = []
    for row, line in zip(ordered, table(ordered, "    ").splitlines(), strict=True):
        heading = f"  {subjects[row[0]].replace('_', ' ')}"
        if heading not in lines:
            lines.append(heading)
        lines.append(line)
    return "\n".join(lines)
