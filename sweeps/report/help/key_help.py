"""Help on the keys of scenes and studies, from their models: type, unit, default, limits."""

import re
from collections.abc import Iterator, Sequence
from functools import cache
from inspect import cleandoc
from typing import Any, Literal, NamedTuple, get_args, get_origin

import numpy as np
from annotated_types import Ge, Gt, Le, Lt, MinLen
from pydantic import BaseModel
from pydantic.fields import FieldInfo

import engine
from sweeps.guide.chapters import SUBJECTS, chapters
from sweeps.study.bundled import questions
from sweeps.study.study_text import StudyText
from sweeps.text.input_files import InputError
from sweeps.text.tables import table
from sweeps.text.templates import templates

# Maximum numbers of keys and chapters in the answer to a search.
MOST_KEYS, MOST_CHAPTERS, MOST_EXAMPLES = 12, 3, 3
# Chapters of the guide that aren't searched.
NO_SUBJECTS = (*SUBJECTS["tutorial"], "developers", "words")
# Placeholder in a path for user-defined names.
NAME, PATH = "NAME", "PATH"
_BY_PATH = ("vary", "derive", "tolerances", "start")
_LIMITS = {
    Gt: ("greater than", "gt"),
    Ge: ("at least", "ge"),
    Lt: ("less than", "lt"),
    Le: ("at most", "le"),
    engine.NonZero: ("not", "ne"),
}


class Key(NamedTuple):
    """A key of a scene or study.

    Attributes
    ----------
    path : tuple of str
        Tables and key, with NAME for user-defined names.
    kind : str
        The table's `type` if that determines its keys, else "".
    model : type of BaseModel
        Model of its table.
    field : FieldInfo
    places : tuple of tuple of str
        Its path, and those of its named tables.
    """

    path: tuple[str, ...]
    kind: str
    model: type[BaseModel]
    field: FieldInfo
    places: tuple[tuple[str, ...], ...]

    @property
    def is_type(self) -> bool:
        """Whether it gives the type of its table."""
        return self.path[-1] == "type"

    @property
    def tables(self) -> list[type[BaseModel]]:
        """Models of the tables that it contains."""
        return list(dict.fromkeys(arm for arm, _ in tables_in(self.field.annotation, self.path)))

    @property
    def types(self) -> list[str]:
        """Types of these tables."""
        return [kind for kind in map(_type_of, self.tables) if kind]


def key_text(asked: str) -> str:
    """Help on a key, table or type: meaning, values, default and limits; else keys and chapters about the words.

    Parameters
    ----------
    asked : str
        A path such as "input.length" or "bodies.ram.mass", a key such as "mass", a table such as "cylinders", a type
        such as "compressor", or words such as "quick return".

    Raises
    ------
    InputError
        Not found; the message suggests similar names.
    """
    parts = tuple(part for part in asked.strip("[] ").split(".") if part)
    searches = (
        lambda key: any(_matches(path, parts) for path in key.places),
        lambda key: parts == (key.kind,) and key.is_type,
        lambda key: _ends_with(key.path, parts),
    )
    found = next((keys for fits in searches if parts and (keys := [*filter(fits, _keys())])), [])
    if not found and (about := _about(asked.split())):
        return about
    if not found:
        known = {".".join(key.path[n:]) for key in _keys() for n in range(len(key.path)) if key.path[n] != NAME}
        near = engine.nearest_names(asked, known | {key.kind for key in _keys() if key.kind}, 3)
        hint = f"did you mean {' or '.join(map(repr, near))}?" if near else "`sweeps help` lists all tables"
        if " " in asked.strip():
            hint = f"no text has all these words; try fewer, such as `sweeps help {max(asked.split(), key=len)}`"
        raise InputError.of("help", f"scenes and studies have no key or type {asked!r}; {hint}")
    return "\n\n".join(_paragraphs(found))


def key_texts() -> dict[str, str]:
    """Help on each table and each type, by name."""
    tables = [key.path[0] for key in _keys() if key.model in (engine.Scene, StudyText)]
    kinds = [key.kind for key in _keys() if key.kind and key.is_type]
    return {name: key_text(name) for name in dict.fromkeys([*tables, *kinds])}


def _about(words: Sequence[str]) -> str:
    """Keys, chapters, bundled studies and templates that speak of all of some words; "" if none do."""
    words = [word for word in words if word not in ("a", "of", "the")]
    if not words:
        return ""
    rows: dict[str, str] = {}
    for key in _keys():
        kind = key.kind if key.is_type else ""
        name = kind or key.path[-1]
        if name not in (NAME, PATH) and engine.speaks_of(name.replace("_", " "), words):
            rows.setdefault(name, f"a type of {key.path[0]}" if kind else _first_sentence(key))
    nearest = sorted(rows.items(), key=lambda row: words[0].lower() not in row[0])
    times = {name: _mentions(text, words) for name, text in chapters().items() if name not in NO_SUBJECTS}
    ranked = sorted(times, key=lambda name: (name in words, times[name]), reverse=True)
    guide = [name for name in ranked if any(times[name])][:MOST_CHAPTERS]
    parts = [f"About {' '.join(words)!r}:"]
    if rows:
        parts += ["Keys (`sweeps help KEY`):", table(nearest[:MOST_KEYS], "  ")]
    if guide:
        parts.append(f"Guide: {', '.join(f'`sweeps guide {name}`' for name in guide)}")
    # Templates first: they are shorter.
    texts = {f"sweeps new {name}": f"{name}: {title}" for name, title in templates().items()}
    texts |= {f"sweeps run {name}": f"{name}: {asked}" for name, asked in questions().items()}
    # Those with the words themselves come before those with synonyms.
    times = {command: _mentions(text.replace("_", " "), words) for command, text in texts.items()}
    found = [command for command in sorted(times, key=times.get, reverse=True) if any(times[command])]
    if examples := found[:MOST_EXAMPLES]:
        parts.append(f"Examples: {', '.join(f'`{command}`' for command in examples)}")
    parts.append(f"Quantities: `sweeps quantities SCENE {' '.join(words)}`")
    return "\n".join(parts) if rows or guide or examples else ""


def _mentions(text: str, words: Sequence[str]) -> tuple[int, int]:
    """Number of lines with the words themselves, and of lines with them or their synonyms."""
    lines = text.lower().splitlines()
    exact = sum(all(word.lower() in line for word in words) for line in lines)
    return exact, sum(engine.speaks_of(line, words) for line in lines)


def tables_text() -> str:
    """All top-level tables and keys of scenes and studies, with a sentence on each."""
    parts = []
    for words, model in (("Scenes", engine.Scene), ("Studies", StudyText)):
        rows = [(key.path[0], _first_sentence(key)) for key in _keys() if key.model is model]
        parts += [f"{words} (details: `sweeps help KEY`):", table(rows, "  ")]
    return "\n".join(parts)


@cache
def _keys() -> tuple[Key, ...]:
    return (*_walk(engine.Scene, (), ""), *_walk(StudyText, (), ""))


def _walk(model: type[BaseModel], path: tuple[str, ...], kind: str) -> Iterator[Key]:
    """Keys of a model and its tables."""
    for name, field in model.model_fields.items():
        here = (*path, field.alias or name)
        tables = [*tables_in(field.annotation, here)]
        yield Key(here, kind, model, field, (here, *(places for _, places in tables)))
        for arm, places in tables:
            if len(places) < 9:
                yield from _walk(arm, places, _type_of(arm) or "")


def tables_in(annotation: Any, path: tuple[str, ...]) -> Iterator[tuple[type[BaseModel], tuple[str, ...]]]:
    """Models allowed at a path, and the paths of their keys."""
    here = engine.bare_annotation(annotation)
    if engine.is_union(here):
        for arm in engine.arms_of(here):
            yield from tables_in(arm, path)
    elif get_origin(here) is dict:
        yield from tables_in(get_args(here)[1], (*path, PATH if path[-1] in _BY_PATH else NAME))
    elif get_origin(here) in (list, tuple):
        for arm in get_args(here):
            yield from tables_in(arm, path)
    elif isinstance(here, type) and issubclass(here, BaseModel) and here is not engine.FormulaNumber:
        yield here, path


def _type_of(model: type[BaseModel]) -> str | None:
    """The value of a model's key `type`."""
    field = model.model_fields.get("type")
    values = get_args(field.annotation) if field and get_origin(field.annotation) is Literal else ()
    return values[0] if len(values) == 1 else None


def _matches(path: tuple[str, ...], parts: Sequence[str]) -> bool:
    """Whether parts match this path, with any name for each NAME; a varied path contains dots."""
    if PATH in path:
        at = path.index(PATH)
        rest = len(path) - at - 1
        return len(parts) > len(path) - 1 and _matches(path[:at] + path[at + 1 :], (*parts[:at], *parts[-rest:]))
    return len(path) == len(parts) and all(a in (b, NAME) for a, b in zip(path, parts, strict=True))


def _ends_with(path: tuple[str, ...], parts: Sequence[str]) -> bool:
    return path[-1] not in (NAME, PATH) and _matches(path[-len(parts) :], parts) and path[-len(parts)] != NAME


# Placeholder for the types that share a text.
_TYPES = "\0"


def _paragraphs(found: Sequence[Key]) -> Iterator[str]:
    """A paragraph per distinct text, headed by all its paths; types with the same text share it."""
    kinds: dict[tuple[str, str], list[str]] = {}
    for key in found:
        whole = key.is_type and key.kind
        text = f'  type = "{key.kind}": {paragraph(key.model)}\n{_keys_text(key.model)}' if whole else _one_text(key)
        place = ".".join(key.path[:-1] if whole else key.path)
        kinds.setdefault((place, text), []).append(key.kind)
    said: dict[str, list[str]] = {}
    for (place, text), of in kinds.items():
        said.setdefault(text.replace(_TYPES, ", ".join(map(repr, dict.fromkeys(of)))), []).append(place)
    for text, places in said.items():
        yield f"{', '.join(places)}\n{text}"


def _one_text(key: Key) -> str:
    """Help on one key, or the keys of a table."""
    tables, kinds = key.tables, key.types
    whose = f"of type {_TYPES}: " if key.kind else ""
    lines = [f"  {whose}{sentence}" for sentence in [_meaning(key)] if sentence]
    if not tables:
        lines = lines or [f"  {whose}a key of: {_sentences(key.model)[0]}"]
        return "\n".join([*lines, f"  value: {_takes(key.field)}", f"  {_necessity(key.field)}", *_example(key)])
    if len(kinds) > 1:
        return "\n".join([*lines, f"  type: one of {', '.join(kinds)} (`sweeps help TYPE` lists the keys)"])
    if len(tables) == 1:
        return "\n".join([*lines, _keys_text(tables[0])])
    each = (f"  either: {paragraph(arm)}\n{_keys_text(arm)}" for arm in tables)
    return "\n".join([*lines, *each])


def _keys_text(model: type[BaseModel]) -> str:
    rows = [
        (field.alias or name, _takes(field), _necessity(field))
        for name, field in model.model_fields.items()
        if name != "type" or not _type_of(model)
    ]
    return table(rows, "    ")


def paragraph(model: type[BaseModel]) -> str:
    """A model's description on one line."""
    return " ".join(cleandoc(model.__doc__ or "").split())


def _sentences(model: type[BaseModel]) -> list[str]:
    return re.split(r"(?<=[.])\s+(?=[A-Z`])", paragraph(model))


def _first_sentence(key: Key) -> str:
    tables, kinds = key.tables, key.types
    if len(tables) == 1:
        return _sentences(tables[0])[0]
    shown = f"{', '.join(kinds[:8])}{', …' if len(kinds) > 8 else ''}"
    return shown if kinds else _takes(key.field)


def key_line(key: Key) -> str:
    """Help on a key in a line, without the keys of its tables."""
    takes = f"types: {', '.join(key.types)}" if key.types else ""
    if not key.tables:
        takes = f"{_takes(key.field)}; {_necessity(key.field)}"
    return " — ".join(part for part in (_meaning(key), takes) if part)


def _meaning(key: Key) -> str:
    """Description of a key: the table's, or the sentences that name the key."""
    if len(key.tables) == 1:
        return paragraph(key.tables[0])
    models = [m for m in key.model.__mro__ if issubclass(m, BaseModel) and m.__doc__]
    sentences = [s for model in models for s in _sentences(model) if f"`{key.path[-1]}`" in s]
    return " ".join(dict.fromkeys(sentences))


def _necessity(field: FieldInfo) -> str:
    if field.is_required():
        return "required"
    default = field.default
    if default is None or isinstance(default, BaseModel) or default in ({}, [], (), ""):
        return "optional"
    if isinstance(default, bool):
        return f"default: {str(default).lower()}"
    return f"default: {_as_typed(default, engine.field_dimension(field)) if isinstance(default, float) else default}"


def _as_typed(value: float, dimension: str | None) -> str:
    """A number as people type it."""
    if not value or dimension in (None, "number"):
        return f"{value:g}"
    factor, label = engine.display_unit(engine.described_dimension(dimension).unit, np.array([value]))
    return f"{value * factor:.10g} {label}"


def _takes(field: FieldInfo) -> str:
    """Allowed values of a key, with limits."""
    marks, dimension = engine.field_marks(field), engine.field_dimension(field)
    here = engine.bare_annotation(field.annotation)
    limits = [
        f"{words} {_as_typed(getattr(mark, at), dimension)}"
        for mark in marks
        for kind, (words, at) in _LIMITS.items()
        if isinstance(mark, kind)
    ]
    several = get_origin(here) in (list, tuple)
    is_name = here is str and any(getattr(mark, "pattern", None) for mark in marks)
    kind = "a name" if is_name else _kind(here, dimension)
    least = next((m.min_length for m in marks if isinstance(m, MinLen)), 0)
    kind = f"a list of entries, each {kind}" if several else kind
    return ", ".join([kind, *limits, *(["at least one"] if least else [])])


def _kind(here: Any, dimension: str | None) -> str:
    if dimension == "number":
        return "a number, a fraction such as '1/30' or a percentage"
    if dimension is not None:
        return f"{dimension.replace('_', ' ')}, '{engine.described_dimension(dimension).example}'"
    if get_origin(here) is Literal:
        return " or ".join(map(_in_toml, get_args(here)))
    if get_origin(here) in (list, tuple):
        return _kind(engine.bare_annotation(get_args(here)[0]), None)
    if get_origin(here) is dict:
        return f"a table, each entry {_kind(engine.bare_annotation(get_args(here)[1]), None)}"
    if engine.is_union(here):
        return " or ".join(dict.fromkeys(_kind(engine.bare_annotation(arm), None) for arm in engine.arms_of(here)))
    if isinstance(here, type) and issubclass(here, BaseModel):
        return "a quantity in any unit" if here is engine.FormulaNumber else "a table"
    return {bool: "true or false", int: "a whole number", float: "a number", dict: "a table"}.get(here, "a text")


def _in_toml(value: str | float) -> str:
    return "true" if value is True else f'"{value}"' if isinstance(value, str) else str(value)


def _example(key: Key) -> list[str]:
    """An example line, if possible."""
    dimension = engine.field_dimension(key.field)
    here = engine.bare_annotation(key.field.annotation)
    if dimension == "number" or (dimension is None and get_origin(here) is not Literal):
        return []
    value = _in_toml(get_args(here)[0] if dimension is None else engine.described_dimension(dimension).example)
    return [f"  example: {key.path[-1]} = {f'[{value}]' if get_origin(here) in (list, tuple) else value}"]
