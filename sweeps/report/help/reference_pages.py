"""Reference pages of the guide's site, generated from models, registers and verdicts."""

from collections.abc import Mapping

from engine import DIMENSIONS, Quantity, Verdict, common_units, made_ready, unit_label
from sweeps.report.help.key_help import key_texts
from sweeps.text.scene_text import read_scene
from sweeps.text.templates import bundled_templates, templates


def reference_pages() -> dict[str, str]:
    """Markdown text of each page, by name."""
    return {"keys": _keys(), "quantities": _quantities(), "verdicts": _verdicts(), "units": _units()}


def _keys() -> str:
    parts = [f"## {head}\n\n```text\n{text}\n```" for head, text in key_texts().items()]
    return "\n\n".join(["# Keys of scenes and studies\n\nOne key in the terminal: `sweeps help input.length`.", *parts])


def _verdicts() -> str:
    rows = [(str(int(verdict)), verdict.short, verdict.sentence) for verdict in Verdict]
    return f"# Verdicts\n\nThe `status` of a variant, and what to do.\n\n{_table(('code', 'verdict', 'meaning'), rows)}"


def _units() -> str:
    rows = [
        (name.replace("_", " "), unit_label(dimension.unit), dimension.example, ", ".join(common_units(name)))
        for name, dimension in DIMENSIONS.items()
    ]
    return f"# Units\n\n{_table(('dimension', 'SI unit', 'example', 'a bare number is in'), rows)}"


def _quantities() -> str:
    """Quantities of each template that those before it don't have."""
    seen: set[tuple[str, str]] = set()
    parts = [
        "# Quantities\n\nWhat the templates offer, each under the first that has it. Of your machine: "
        "`sweeps quantities SCENE`, with its own names."
    ]
    # The simplest machine first.
    for name, title in sorted(templates().items(), key=lambda row: row[0] != "slider_crank"):
        machine = made_ready(read_scene(bundled_templates()[name]))
        for words, known in (("numbers", machine.available_summaries), ("curves", machine.available_fields)):
            if rows := _unseen(known, seen):
                parts.append(f"## {title}: {words}\n\n{_table(('quantity', 'unit', 'meaning'), rows)}")
    return "\n\n".join(parts)


def _unseen(known: Mapping[str, Quantity], seen: set[tuple[str, str]]) -> list[tuple[str, str, str]]:
    """Rows of the quantities whose last name and unit weren't seen before."""
    rows = []
    for name, quantity in known.items():
        kind = (name.rpartition(".")[2], quantity.units)
        if kind not in seen:
            seen.add(kind)
            rows.append((f"`{name}`", unit_label(quantity.units), quantity.long_name))
    return rows


def _table(heads: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    lines = (heads, ("---",) * len(heads), *rows)
    return "\n".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |" for line in lines)
