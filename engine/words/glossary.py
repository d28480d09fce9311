"""Engineers' synonyms, searched wherever a name is looked up; suggestions for unknown names.

`GLOSSARY` is searched by every list and every "did you mean"; `KEYS` lists other names of the keys of texts, which say
nothing about quantities.
"""

import difflib
import re
from collections.abc import Iterable, Mapping, Sequence

# Known names in a message on an unknown one.
MOST_LISTED = 20


def _by_term(rows: Mapping[str, tuple[str, ...]]) -> dict[str, tuple[str, ...]]:
    return {term: words for terms, words in rows.items() for term in terms.split()}


# Search terms for one thing, and the words for it in names, meanings and keys.
GLOSSARY = _by_term(
    {
        "torque": ("moment",),
        "moment": ("torque",),
        "couple": ("moment", "torque"),
        "bearing": (".reaction", "pins", "journal"),
        "journal": (".reaction", "bearing"),
        "crankpin": ("pins",),
        "gudgeon": ("wrist-pin",),
        "force": ("side thrust",),
        "thrust": ("guide",),
        "side": ("guide", "slot"),
        "quick": ("time_ratio", "return ratio"),
        "return": ("time_ratio",),
        "time": ("quick-return",),
        "equivalent effective referred reflected": ("reduced",),
        "coefficient cyclic irregularity unevenness cs ripple": ("fluctuation",),
        "counterweight": ("shaking", "unbalance", "correction", "balancing"),
        "balancing": ("shaking", "unbalance", "correction"),
        "kutzbach": ("mobility", "basic_ratio", "speed of"),
        "grübler": ("mobility",),
        "willis": ("basic_ratio",),
        "dwell": ("stroke", "swing", "range"),
        "jerk": ("accelerat",),
        "dead centre toggle": ("stroke_low", "stroke_high", "swing_low", "swing_high"),
        "center": ("centre", "stroke_low", "stroke_high", "swing_low", "swing_high"),
        "lift": ("stroke", "displacement", "slide"),
        "motor": ("mean drive",),
        "efficiency": ("loss", "friction"),
        "pressure": ("stress",),
        "units": (),  # not the plural of "unit", as in "per unit error"
        "horsepower": ("power",),
        "weight": ("mass",),
        "greatest": ("peak", "max"),
        "maximum": ("peak", "max"),
        "least": ("min",),
        "minimum": ("min",),
        "startup start-up": ("run",),
        "critical whirling vibration": ("natural frequenc", "resonance"),
    }
)

# Other names of keys, the likeliest meaning first.
KEYS = _by_term(
    {
        "from": ("start",),
        "to": ("stop",),
        "begin": ("from", "start"),
        "start": ("from",),
        "stop": ("to",),
        "end": ("to", "stop"),
        "min minimum": ("low", "from"),
        "max maximum": ("high", "to"),
        "steps number n step": ("count",),
        "list": ("values",),
        "radius": ("length", "diameter"),
        "rpm omega rotation": ("speed",),
        "moment_of_inertia j": ("inertia",),
        "m": ("mass",),
        "mu": ("coefficient", "friction"),
        "friction": ("coefficient",),
        "value": ("force", "moment", "values"),
        "direction": ("angle",),
        "ground joints": ("points",),
        "crank": ("input",),
        "dyads": ("groups",),
        "masses": ("bodies",),
        "torques": ("moments",),
        "parameters variables sweep": ("vary",),
        "results": ("outputs", "summaries"),
        "constraints subject_to condition conditions filter": ("where", "require"),
        "require": ("where",),
    }
)


def speaks_of(text: str, words: Sequence[str]) -> bool:
    """Whether a text contains every one of some words, or a synonym of it, ignoring case.

    Parameters
    ----------
    text : str
    words : sequence of str
        Parts of words match ("accel" finds "acceleration"), and plurals match singulars. A synonym must start a word.
    """
    text = text.lower()
    terms = map(_singular, words)
    return all(term in text or any(_begins_in(text, other) for other in GLOSSARY.get(term, ())) for term in terms)


def _singular(word: str) -> str:
    word = word.lower()
    return word if word in GLOSSARY or len(word) < 4 else word.removesuffix("s")


def _begins_in(text: str, words: str) -> bool:
    return re.search(rf"{'' if words.startswith('.') else '(?<![a-z])'}{re.escape(words)}", text) is not None


def meant(name: str, known: Sequence[str]) -> list[str]:
    """Known names that mean the same as a name in other words, likeliest first.

    Parameters
    ----------
    name : str
        Such as "input.torque".
    known : sequence of str
    """
    table = {word: (*GLOSSARY.get(word, ()), *KEYS.get(word, ())) for word in (*GLOSSARY, *KEYS)}
    whole = [word for word in table.get(name.lower(), ()) if word in known]
    parts = _parts(name)
    if whole or not table.keys() & parts:
        return whole
    found = [k for k in known if all(_in(k, (part, *table.get(part, ()))) for part in parts)]
    return sorted(found, key=lambda k: (len(set(parts) - set(_parts(k))), len(_parts(k))))


def _in(name: str, words: Sequence[str]) -> bool:
    return any(set(_parts(word)) <= set(_parts(name)) for word in words)


def _parts(name: str) -> list[str]:
    return [part for part in re.split(r"[\W_]+", name.lower()) if part]


def nearest(name: str, known: Iterable[str], count: int = 1) -> list[str]:
    """Synonyms of a name, else the names closest to it in spelling, ignoring case."""
    known = list(known)
    lowered: dict[str, str] = {}
    for candidate in known:
        lowered.setdefault(candidate.lower(), candidate)
    found = [] if name.lower() in lowered else meant(name, known)
    return found[:count] or [lowered[match] for match in difflib.get_close_matches(name.lower(), lowered, n=count)]


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Ending of a message about an unknown name: the allowed names, and the nearest one."""
    return listed(name, sorted(known), "known are")


def enumerated(names: Sequence[str]) -> str:
    """Names in a sentence: "a", "a and b", "a, b and c"."""
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def counted(count: int, noun: str) -> str:
    """A number of things: "1 variant", "2 variants"."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def listed(name: str, known: Iterable[str], lead: str) -> str:
    """As `did_you_mean`, in the order of the known names and with another lead: "allowed: mm, SI, US"."""
    known = list(known)
    near = nearest(name, known)
    return f"{lead}: {', '.join(known) or 'none'}" + (f"; did you mean {near[0]!r}?" if near else "")


def unknown_name_message(name: str, known: Iterable[str], words: str = "") -> str:
    """Say that a name is unknown, and which known ones may have been meant.

    Parameters
    ----------
    name : str
        The unknown name.
    known : iterable of str
        The known names.
    words : str, optional
        Text that replaces "unknown name 'NAME'".

    Returns
    -------
    str
        For instance "unknown name 'input.lenght'; did you mean 'input.length'?".
    """
    known = sorted(known)
    words = words or f"unknown name '{name}'"
    return f"{words}; {nearest_or_known(name, known, known)}"


def nearest_or_known(name: str, known: Sequence[str], akin: Sequence[str]) -> str:
    """Ending of a message about an unknown name: the nearest known names, else the first of `akin`."""
    if close := nearest(name, known, 3):
        return f"did you mean {' or '.join(map(repr, close))}?"
    if not akin:
        return "no names are known here"
    more = f" and {len(akin) - MOST_LISTED} more" if len(akin) > MOST_LISTED else ""
    return f"known are {', '.join(akin[:MOST_LISTED])}{more}"
