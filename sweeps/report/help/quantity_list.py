"""What may be asked of a scene: every quantity with its symbol, unit and meaning, searched by words."""

from collections.abc import Iterable, Sequence

from engine import STATISTICS, Quantity, Scene, made_ready, nearest_names
from sweeps.text.engineer_units import unit_label
from sweeps.text.input_files import InputError
from sweeps.text.tables import table


def quantities_text(scene: Scene, source: str, words: Sequence[str] = ()) -> str:
    """Everything that may be asked of a scene, or what of it has all of some words in it.

    Parameters
    ----------
    scene : Scene
    source : str
        Name of the scene's file, for messages.
    words : sequence of str
        Each must occur in a quantity's name, symbol, unit or meaning, whatever its capitals. The name of a statistic
        of a field, "ram.velocity.max", is found too.

    Raises
    ------
    InputError
        Nothing has these words in it; the message names what is near.
    """
    fields = made_ready(scene).available_fields
    statistics = [w for w in words if w.rpartition(".")[0] in fields and w.rpartition(".")[2] in STATISTICS]
    summaries = made_ready(scene, statistics).available_summaries
    numbers, curves = _holding(summaries.values(), words), _holding(fields.values(), words)
    if not numbers and not curves:
        near = nearest_names(words[0], {**summaries, **fields}, 3)
        hint = f"did you mean {' or '.join(map(repr, near))}?" if near else "leave the words out to see everything"
        message = f"nothing that may be asked has {' and '.join(map(repr, words))} in it; {hint}"
        raise InputError(source, [(None, "", message)])
    parts = ["Summaries, one number of each variant:", _listed(numbers)] if numbers else []
    if curves:
        ways = ", ".join(f"{way} ({meaning.removesuffix(' of')})" for way, meaning in STATISTICS.items())
        parts += ["Fields, curves over the cycle:", _listed(curves), f"Of every field a summary NAME.WAY: {ways}."]
    return "\n".join(parts)


def _holding(quantities: Iterable[Quantity], words: Sequence[str]) -> list[Quantity]:
    """Quantities that have all words in them."""
    wanted = [word.lower() for word in words]
    return [q for q in quantities if all(word in _everything_about(q) for word in wanted)]


def _everything_about(quantity: Quantity) -> str:
    return " ".join((quantity.name, quantity.symbol, quantity.long_name, unit_label(quantity.units))).lower()


def _listed(quantities: Iterable[Quantity]) -> str:
    return table([(q.name, q.symbol, unit_label(q.units) or "–", q.long_name) for q in quantities], "  ")
