"""Reference pages of the guide, generated from models, registers, verdicts and docstrings."""

from collections.abc import Callable

from engine import DIMENSIONS, STATISTICS, Verdict, common_units, unit_label
from sweeps.report.help.interface_page import interface_page
from sweeps.report.help.key_help import key_texts
from sweeps.report.help.quantity_families import MACHINE, quantity_families


def _keys() -> str:
    parts = [f"## {head}\n\n```text\n{text}\n```" for head, text in key_texts().items()]
    return "\n\n".join(["# Keys of scenes and studies\n\nOne key in the terminal: `sweeps help input.length`.", *parts])


def _verdicts() -> str:
    rows = [(str(int(verdict)), verdict.short, verdict.name.lower(), verdict.sentence) for verdict in Verdict]
    heads = ("status", "verdict", "name in datasets", "meaning, and what to do")
    return f"# Verdicts\n\nThe `status` of a variant.\n\n{_table(heads, rows)}"


def _units() -> str:
    rows = [
        (name.replace("_", " "), unit_label(dimension.unit), dimension.example, ", ".join(common_units(name)))
        for name, dimension in DIMENSIONS.items()
    ]
    return f"# Units\n\n{_table(('dimension', 'SI unit', 'example', 'a bare number is in'), rows)}"


def _quantities() -> str:
    """Families of quantities: those of the machine, of each kind of part, of each type of element."""
    statistics = ", ".join(f"`{key}` ({words.removesuffix(' of')})" for key, words in STATISTICS.items())
    parts = [
        "# Quantities\n\nCapital letters stand for your names: `piston.stroke` is a `LINK.stroke`. Of your machine: "
        "`sweeps quantities SCENE`. A curve over the cycle also gives the numbers NAME.STATISTIC: "
        f"{statistics}."
    ]
    for owner, families in quantity_families().items():
        rows = [(f"`{f.name}`", unit_label(f.units), "curve" if f.curve else "", f.long_name) for f in families]
        head = owner if owner == MACHINE or owner.startswith("Element ") else f"Of a {owner}"
        parts.append(f"## {head}\n\n{_table(('quantity', 'unit', 'kind', 'meaning'), rows)}")
    return "\n\n".join(parts)


def _table(heads: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    lines = (heads, ("---",) * len(heads), *rows)
    return "\n".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |" for line in lines)


# Each page's function, by name, in reading order.
PAGES: dict[str, Callable[[], str]] = {
    "keys": _keys,
    "quantities": _quantities,
    "verdicts": _verdicts,
    "units": _units,
    "interface": interface_page,
}
