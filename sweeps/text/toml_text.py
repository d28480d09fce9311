"""Reading TOML into validated models; errors give file, line, key, value, allowed values and a remedy."""

import re
import tomllib
from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, Tag, ValidationError

from engine import Element, comma_advice, element_kinds, in_text, nearest_names
from sweeps.text.input_files import InputError

# Maximum problems per message.
MOST_PROBLEMS = 20
# Maximum line length for diagnosis, and maximum parts of a key.
_LINE_LOOKED_AT, _LONGEST_KEY = 300, 100
# Separators of keys and values, and of parts of a key.
_APART, _DOT_IN_KEY = re.compile(r"[=\[\]{},#]"), re.compile(r"[\w\"'-]\s*\.(?=\s*[\w\"'-])")


def parse_toml(text: str, source: str) -> dict[str, Any]:
    """Tables of a TOML text.

    Raises
    ------
    InputError
        The text is not TOML; the message gives line and column.
    """
    for number, line in enumerate(text.splitlines(), 1):
        # The TOML reader stores every prefix of a dotted key.
        if len(line) > _LONGEST_KEY and any(_parts(piece) > _LONGEST_KEY for piece in _APART.split(line)):
            raise InputError(source, [(number, "", f"more than {_LONGEST_KEY} parts between full stops")])
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        found = re.search(r"\(at line (\d+), column (\d+)\)", str(error))
        line = int(found[1]) if found else None
        message = _slip(text, line, source) or _not_toml(text, line, str(error))
        raise InputError(source, [(line, "", message)]) from None
    except (ValueError, RecursionError):
        raise InputError(source, [(None, "", "not valid TOML: a number too long, or tables nested too deep")]) from None


# What the TOML reader reports, and what is said instead.
_NOT_TOML = {
    "Cannot overwrite|Duplicate": "appears twice in its table: remove one",
    "Cannot mutate": "belongs to a table in braces above: write it there",
    "Expected '='": "write KEY = VALUE",
    r"Expected '\]": "a ] is missing after the name of the table, or the name has a blank or a sign in it",
    "array": "the list is never closed: a ] is missing",
    "inline table": "the table is never closed: a } is missing",
    "[Uu]nescaped|Escaped|hex": "in double quotes write \\\\ for a backslash, or use single quotes",
    "Unterminated|Illegal": "the quotation mark is never closed, or the text has a control character",
    "newline": "a line holds one KEY = VALUE, and something follows the value",
    "date": "dates and times aren't used; write texts in quotes",
}


def _not_toml(text: str, line: int | None, message: str) -> str:
    """What is wrong with a text that is not TOML, from the reader's message."""
    if twice := re.search(r"Cannot declare \((.*)\) twice", message):
        keys = re.findall(r"'([^']*)'", twice[1])
        return f"not valid TOML: the table [{'.'.join(keys)}] appears twice, first in line {line_of(text, keys)}"
    key = _KEY.match(text.splitlines()[line - 1]) if line else None
    words = next((words for pattern, words in _NOT_TOML.items() if re.search(pattern, message)), "")
    if words.startswith(("appears", "belongs")):
        words = f"{key['keys'] if key else 'a key'} {words}"
    return f"not valid TOML: {words or 'write KEY = VALUE, texts in quotes, tables in brackets'}"


def _parts(piece: str) -> int:
    """Number of parts of a dotted key."""
    return 1 + len(_DOT_IN_KEY.findall(piece))


_BARE_QUANTITY = re.compile(r"=\s*(?P<value>[-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?\s*[A-Za-zµ°%][^\"',}\]#]*)")
_BARE_COMMA = re.compile(r"=\s*(?P<value>[-+]?[0-9]+,[0-9]+(?:\s*[A-Za-zµ°%][^\"',}\]#]*)?)\s*(?:$|[#}])")
_BARE_WORD = re.compile(r"=\s*(?P<value>(?!true\b|false\b|inf\b|nan\b)[A-Za-z][\w ./*^-]*?)\s*(?:$|[,#}\]])")


def _slip(text: str, line: int | None, source: str) -> str:
    """Diagnosis of common TOML mistakes in a line, or ""."""
    lines = text.splitlines()
    if line is None or not 1 <= line <= len(lines) or not source.endswith(".toml"):
        return ""
    # An incomplete line is reported at the start of the next one.
    for whole in lines[line - 1 : line] + lines[line - 2 : line - 1]:
        written = whole[:_LINE_LOOKED_AT]
        if (slip := _BARE_QUANTITY.search(written)) is not None:
            value = slip["value"].strip()
            return f'{value} has a unit, so it needs quotes: "{value}"'
        if (slip := _BARE_COMMA.search(written)) is not None:
            return comma_advice(slip["value"].strip())
        if (slip := _BARE_WORD.search(written)) is not None:
            value = slip["value"].strip()
            return f'{value} is a text, so it needs quotes: "{value}"'
        if re.search("=\\s*[“”„‘’]", written):
            return 'write straight quotation marks, ", not typographic ones'
        if re.match(r"\s*[\w.]+\s*:", written):
            return "write KEY = VALUE, not KEY: VALUE"
        if re.search(r"=\s*$", written):
            return "no value after ="
        if whole.count('"') % 2:
            return "a quotation mark is missing"
    return ""


def validate(model: type[BaseModel], data: dict[str, Any], text: str, source: str, prefix: tuple[str, ...] = ()) -> Any:
    """A model from parsed TOML.

    Parameters
    ----------
    model : type of BaseModel
    data : dict
        Parsed tables.
    text, source : str
        The text, for line numbers, and its name.
    prefix : tuple of str
        Keys of the table that contains the data.

    Raises
    ------
    InputError
        All problems.
    """
    try:
        return model.model_validate(data, context={"text": True})
    except ValidationError as error:
        told = _merged(error.errors())[:MOST_PROBLEMS]
        raise InputError(source, [_problem(model, data, text, e, prefix) for e in told]) from None


# What a value is expected to be, by the validator's kind of error.
_EXPECTED = {
    "string_type": "a text in quotes",
    "float_type": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "int_parsing": "a whole number",
    "float_parsing": "a number",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "list_type": "a list in brackets, [ ]",
    "tuple_type": "a list in brackets, [ ]",
    "dict_type": "a table of keys",
    "model_type": "a table of keys",
    "model_attributes_type": "a table of keys",
}


def _merged(errors: list[dict]) -> list[dict]:
    """Errors of a validator; what a union expects of one value is one error with all the words for it."""
    found: list[dict] = []
    for error in errors:
        expected = _EXPECTED.get(error["type"])
        last = found[-1] if found else {}
        if expected and last.get("expected") and last["input"] is error["input"]:
            last["expected"] += f" or {expected}" if expected not in last["expected"] else ""
        else:
            found.append({**error, "expected": expected})
    return found


def errors_in_words(model: type[BaseModel], error: ValidationError) -> list[tuple[str, str]]:
    """Key and message of each error of a validator, for values that are numbers in SI.

    Parameters
    ----------
    model : type of BaseModel
    error : ValidationError
    """
    found = [(".".join(map(str, e["loc"])), _message(model, e, [*e["loc"]])) for e in _merged(error.errors())]
    return [(key, message.partition(", got ")[0]) for key, message in found]


def _problem(
    model: type[BaseModel], data: dict, text: str, error: dict, prefix: tuple[str, ...]
) -> tuple[int | None, str, str]:
    keys = [*prefix, *_keys(data, error)]
    return line_of(text, keys), ".".join(str(k) for k in keys), _message(model, error, keys)


def _keys(data: object, error: dict) -> list[str | int]:
    """Location of an error without pydantic's union tags."""
    keys: list[str | int] = []
    loc = list(error["loc"])
    for i, item in enumerate(loc):
        in_list = isinstance(data, list) and isinstance(item, int) and item < len(data)
        present = (isinstance(data, dict) and item in data) or in_list
        absent_key = i == len(loc) - 1 and error["type"] == "missing" and isinstance(item, str)
        if present:
            data = data[item]
            keys.append(item)
        elif absent_key:
            keys.append(item)
    return keys


def _shown(value: object) -> str:
    shown = repr(value)
    return shown if len(shown) <= 60 else shown[:57] + "..."


def _message(model: type[BaseModel], error: dict, keys: list[str | int]) -> str:
    kind, value, context = error["type"], error["input"], error.get("ctx", {})
    last = str(keys[-1]) if keys else ""
    match kind:
        case "extra_forbidden":
            allowed = _fields_at(model, error["loc"][:-1])
            explained = _EXPLAINED.get(last, "") if "require" in model.model_fields else ""
            return "unknown key" + _allowed(last, allowed) + explained
        case "missing" if last == "input" and len(keys) <= 2:
            return 'is missing: add a table [input] of type "crank" or "slider"; see `sweeps help input`'
        case "missing" if keys == ["scene"]:
            return 'is missing: name the file of the scene, scene = "press.toml"'
        case "missing":
            return "is missing: add it" if isinstance(error["loc"][-1], str) else "has too few entries"
        case "union_tag_invalid":
            allowed = re.findall(r"'([^']+)'", context.get("expected_tags", ""))
            tag = str(context.get("tag"))
            return f"type {tag!r} is not known" + _allowed(tag, allowed)
        case "union_tag_not_found":
            return "the key 'type' is missing: add it"
        case "literal_error":
            allowed = re.findall(r"'([^']+)'", context["expected"])
            return f"{_shown(value)} is not allowed" + (
                _allowed(str(value), allowed) or f"; allowed: {context['expected']}"
            )
        case "greater_than" | "greater_than_equal" | "less_than" | "less_than_equal":
            words = {"gt": "greater than", "ge": "at least", "lt": "less than", "le": "at most"}
            bound = next(f"{words[k]} {_as_given(context[k], value)}" for k in words if k in context)
            return f"must be {bound}, got {_shown(value)}"
        case "string_pattern_mismatch":
            return f"{_shown(value)} is not a name: use letters, digits and single underscores, a letter first"
        case "value_error":
            return str(context["error"])
        case "too_short":
            return f"has too few entries: {context['actual_length']}, at least {context['min_length']}"
        case "too_long":
            return f"has too many entries: {context['actual_length']}, at most {context['max_length']}"
        case _ if "url" not in error:
            # Errors of the project's own, not of the validator.
            return f"{error['msg']}, got {_shown(value)}"
        case _:
            return f"expected {error['expected'] or 'another value'}, got {_shown(value)}"


# Units of limits; other limits are 0.
_OWN_UNITS = {"deg": "angle", "°": "angle", "rev": "angle", "rpm": "angular_speed"}


def _as_given(bound: float, value: object) -> str:
    """A limit in the unit of the value."""
    unit = value.strip().lstrip("+-.0123456789eE ") if isinstance(value, str) else ""
    if bound == 0 or unit not in _OWN_UNITS:
        return f"{bound:g}"
    return f"{bound / in_text(f'1 {unit}', _OWN_UNITS[unit]):g} {unit}"


_EXPLAINED = {
    "where": "; where belongs to [best] or [optimise]; require, above the first table, drops variants before they are "
    "computed",
    "require": "; require stands above the first table: it drops variants before they are computed",
}


def _allowed(name: str, allowed: list[str]) -> str:
    if not allowed:
        return ""
    near = nearest_names(name, allowed)
    return f"; allowed: {', '.join(allowed)}" + (f"; did you mean {near[0]!r}?" if near else "")


def _fields_at(model: type[BaseModel], loc: tuple[str | int, ...]) -> list[str]:
    """Keys allowed at a location (with union tags)."""
    here: Any = model
    for item in loc:
        here = _descend(here, item)
    here = bare_annotation(here)
    if not (isinstance(here, type) and issubclass(here, BaseModel)):
        return []
    return [field.alias or name for name, field in here.model_fields.items()]


def bare_annotation(annotation: Any) -> Any:
    """An annotation without metadata and None."""
    while get_origin(annotation) is Annotated:
        annotation = get_args(annotation)[0]
    if is_union(annotation):
        arms = [a for a in arms_of(annotation) if a is not type(None)]
        if len(arms) == 1:
            return bare_annotation(arms[0])
    return annotation


def is_union(annotation: Any) -> bool:
    """Whether an annotation is a union."""
    return annotation is Element or get_origin(annotation) is Union or type(annotation).__name__ == "UnionType"


def arms_of(union: Any) -> tuple[Any, ...]:
    """Members of a union."""
    return tuple(element_kinds().values()) if union is Element else get_args(union)


def _descend(annotation: Any, item: str | int) -> Any:
    """Annotation of a key, a table entry, or a union member by tag."""
    here = bare_annotation(annotation)
    if is_union(here):
        return next((bare_annotation(a) for a in arms_of(here) if item in _tags(a)), None)
    if isinstance(here, type) and issubclass(here, BaseModel):
        field = here.model_fields.get(str(item))
        return field.annotation if field else None
    if get_origin(here) in (dict, list, tuple):
        return get_args(here)[-1]
    return here


def _tags(arm: Any) -> tuple[object, ...]:
    """Tags of a union member: its own, or the values of its key "type"."""
    own = tuple(mark.tag for mark in getattr(arm, "__metadata__", ()) if isinstance(mark, Tag))
    if own:
        return own
    model = bare_annotation(arm)
    field = getattr(model, "model_fields", {}).get("type")
    return get_args(field.annotation) if field and get_origin(field.annotation) is Literal else ()


_HEADER = re.compile(r"^\s*\[\[?(?P<keys>[^\[\]]+)\]\]?\s*(#.*)?$")
_KEY = re.compile(r"""^\s*(?P<keys>(?:"[^"]*"|'[^']*'|[\w-]+)(?:\s*\.\s*(?:"[^"]*"|'[^']*'|[\w-]+))*)\s*=""")
_PART = re.compile(r""""[^"]*"|'[^']*'|[\w-]+""")


def problems_in(
    text: str, problems: Iterable[tuple[str, str]], prefix: Sequence[str] = ()
) -> list[tuple[int | None, str, str]]:
    """Problems with their lines.

    Parameters
    ----------
    text : str
    problems : iterable of (str, str)
        Dotted key and message.
    prefix : sequence of str
        Keys of the enclosing table.
    """
    return [(line_of(text, [*prefix, *key.split(".")]), key, message) for key, message in problems]


def line_of(text: str, keys: list[str | int]) -> int | None:
    """Line of a key, or of its nearest enclosing table or key."""
    names = tuple(part for k in keys if not isinstance(k, int) for part in str(k).split("."))
    at, within = _lines_of(text)
    if names in within:
        return within[names]
    return next((at[names[:depth]] for depth in range(len(names), 0, -1) if names[:depth] in at), None)


def line_of_entry(text: str, keys: list[str | int], entry: str) -> int | None:
    """Line of an entry of a key's list, or of the key."""
    start = line_of(text, keys)
    lines = (number for number, line in enumerate(text.splitlines(), 1) if number >= (start or 1) and entry in line)
    return next(lines, start)


@lru_cache(2)
def _lines_of(text: str) -> tuple[dict[tuple[str, ...], int], dict[tuple[str, ...], int]]:
    """First lines of keys and their prefixes.

    Cached for texts with thousands of mistakes.
    """
    at: dict[tuple[str, ...], int] = {}
    within: dict[tuple[str, ...], int] = {}
    table: tuple[str, ...] = ()
    for number, line in enumerate(text.splitlines(), 1):
        if header := _HEADER.match(line):
            table = here = _split(header["keys"])
        elif key := _KEY.match(line):
            here = table + _split(key["keys"])
        else:
            continue
        at.setdefault(here, number)
        for depth in range(1, len(here) + 1):
            within.setdefault(here[:depth], number)
    return at, within


def _split(keys: str) -> tuple[str, ...]:
    return tuple(name for part in _PART.findall(keys) for name in part.strip("\"'").split("."))
