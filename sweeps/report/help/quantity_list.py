"""The quantities of a scene with symbol, unit and meaning, filtered by words or their synonyms."""

from collections.abc import Iterable, Sequence

from engine import STATISTICS, Quantity, Scene, full_names, made_ready, nearest_names, speaks_of, table_unit, unit_label
from sweeps.text.input_files import InputError
from sweeps.text.tables import table


def quantities_text(scene: Scene, source: str, words: Sequence[str] = ()) -> str:
    """The available quantities of a scene, filtered by words.

    Parameters
    ----------
    scene : Scene
    source : str
        Name of the scene's file, for messages.
    words : sequence of str
        Each, or a synonym of it, must occur in the name, symbol, unit or meaning, ignoring case. Statistics of fields
        such as "ram.velocity.max" are found too.

    Raises
    ------
    InputError
        No match; the message suggests similar names.
    """
    words = [full_names(scene, word) for word in words]
    fields = made_ready(scene).available_fields
    statistics = [w for w in words if w.rpartition(".")[0] in fields and w.rpartition(".")[2] in STATISTICS]
    summaries = made_ready(scene, statistics).available_summaries
    numbers, curves = _holding(summaries.values(), words), _holding(fields.values(), words)
    if not numbers and not curves:
        near = nearest_names(words[0], {**summaries, **fields}, 3)
        hint = f"did you mean {' or '.join(map(repr, near))}?" if near else "without words all are listed"
        hint += f"; `sweeps help {' '.join(words)}` searches keys and guide"
        raise InputError.of(source, f"no quantity matches {' and '.join(map(repr, words))}; {hint}")
    parts = ["Summaries (one number per variant):", _listed(numbers)] if numbers else []
    if curves:
        ways = ", ".join(f"{way} ({meaning.removesuffix(' of')})" for way, meaning in STATISTICS.items())
        letter = "The joint's letter on the drawing also names its force: A.reaction.peak."
        parts += [
            "Fields (curves over the cycle):",
            _listed(curves),
            f"Every field also gives summaries NAME.STATISTIC: {ways}.",
            *([letter] if any(".reaction" in curve.name for curve in curves) else []),
        ]
    return "\n".join(parts)


def _holding(quantities: Iterable[Quantity], words: Sequence[str]) -> list[Quantity]:
    """Quantities that contain all words."""
    return [q for q in quantities if speaks_of(f"{q.name} {q.symbol} {q.long_name} {_unit(q)}", words)]


def _unit(quantity: Quantity) -> str:
    return unit_label(table_unit(quantity.units)[1])


def _listed(quantities: Iterable[Quantity]) -> str:
    return table([(q.name, q.symbol, _unit(q) or "–", q.long_name) for q in quantities], "  ")
