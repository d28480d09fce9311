"""Reading TOML texts into validated models; errors name file, line, key, value, what is allowed and the remedy."""

import re
import tomllib
from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, Tag, ValidationError

from engine import Element, element_kinds, in_text, nearest_names
from sweeps.text.engineer_units import show_in_units
from sweeps.text.input_files import InputError

# Most problems in one message.
MOST_PROBLEMS = 20
# Characters of a line in which slips are looked for, and parts that a key may have.
_LINE_LOOKED_AT, _LONGEST_KEY = 300, 100
# What parts keys from each other and from values, and a full stop within a key.
_APART, _DOT_IN_KEY = re.compile(r"[=\[\]{},#]"), re.compile(r"[\w\"'-]\s*\.(?=\s*[\w\"'-])")


def parse_toml(text: str, source: str) -> dict[str, Any]:
    """Tables of a TOML text.

    Raises
    ------
    InputError
        The text is not TOML; the message gives line and column.
    """
    for number, line in enumerate(text.splitlines(), 1):
        # A reader of TOML keeps every beginning of a dotted key.
        if len(line) > _LONGEST_KEY and any(_parts(piece) > _LONGEST_KEY for piece in _APART.split(line)):
            raise InputError(source, [(number, "", f"more than {_LONGEST_KEY} parts between full stops")])
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        found = re.search(r"\(at line (\d+), column (\d+)\)", str(error))
        line = int(found[1]) if found else None
        message = str(error).split(" (at ")[0]
        raise InputError(source, [(line, "", _slip(text, line, source) or f"not valid TOML: {message}")]) from None
    except (ValueError, RecursionError):
        raise InputError(source, [(None, "", "not valid TOML: a number too long, or tables nested too deep")]) from None


def _parts(piece: str) -> int:
    """How many parts a piece of a line has, if it is a dotted key."""
    return 1 + len(_DOT_IN_KEY.findall(piece))


_BARE_QUANTITY = re.compile(r"=\s*(?P<value>[-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?\s*[A-Za-zµ°%][^\"',}\]#]*)")
_BARE_COMMA = re.compile(r"=\s*(?P<value>[-+]?[0-9]+,[0-9]+(?:\s*[A-Za-zµ°%][^\"',}\]#]*)?)\s*(?:$|[#}])")
_BARE_WORD = re.compile(r"=\s*(?P<value>(?!true\b|false\b|inf\b|nan\b)[A-Za-z][\w ./*^-]*?)\s*(?:$|[,#}\]])")


def _slip(text: str, line: int | None, source: str) -> str:
    """What is wrong with a line that is no TOML, where that is a usual slip; "" where it isn't, or in other files."""
    lines = text.splitlines()
    if line is None or not 1 <= line <= len(lines) or not source.endswith(".toml"):
        return ""
    # A line that ends too early is reported at the beginning of the next one.
    for whole in lines[line - 1 : line] + lines[line - 2 : line - 1]:
        written = whole[:_LINE_LOOKED_AT]
        if (slip := _BARE_QUANTITY.search(written)) is not None:
            value = slip["value"].strip()
            return f'{value} has a unit, so it stands in quotes: "{value}"'
        if (slip := _BARE_COMMA.search(written)) is not None:
            value = slip["value"].strip()
            return f'{value} has a decimal comma: write a point, as in "{value.replace(",", ".")}"'
        if (slip := _BARE_WORD.search(written)) is not None:
            value = slip["value"].strip()
            return f'{value} is a text, so it stands in quotes: "{value}"'
        if re.search(r"=\s*$", written):
            return "after the = there is no value"
        if whole.count('"') % 2:
            return "a quotation mark is missing: texts begin and end with one"
    return ""


def validate(model: type[BaseModel], data: dict[str, Any], text: str, source: str, prefix: tuple[str, ...] = ()) -> Any:
    """A model from parsed TOML.

    Parameters
    ----------
    model : type of BaseModel
    data : dict
        Parsed tables.
    text, source : str
        The text, to find lines in, and its name.
    prefix : tuple of str
        Keys of the table in which the data stand in the text.

    Raises
    ------
    InputError
        All that is wrong with it, not only the first.
    """
    context: dict[str, Any] = {"text": True}
    try:
        made = model.model_validate(data, context=context)
    except ValidationError as error:
        told = error.errors()[:MOST_PROBLEMS]
        raise InputError(source, [_problem(model, data, text, e, prefix) for e in told]) from None
    if "units" in context:
        show_in_units(context["units"])
    return made


def _problem(
    model: type[BaseModel], data: dict, text: str, error: dict, prefix: tuple[str, ...]
) -> tuple[int | None, str, str]:
    keys = [*prefix, *_keys(data, error)]
    return line_of(text, keys), ".".join(str(k) for k in keys), _message(model, error, keys)


def _keys(data: object, error: dict) -> list[str | int]:
    """Location of an error without the tags of unions that pydantic puts into it."""
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
            return "unknown key" + _allowed(last, allowed)
        case "missing" if last == "input" and len(keys) <= 2:
            return 'is missing: a machine has a table [input] of type "crank" or "slider"; see `sweeps help input`'
        case "missing":
            return "is missing" if isinstance(error["loc"][-1], str) else "has too few entries"
        case "union_tag_invalid":
            allowed = re.findall(r"'([^']+)'", context.get("expected_tags", ""))
            tag = str(context.get("tag"))
            return f"type {tag!r} is not known" + _allowed(tag, allowed)
        case "union_tag_not_found":
            return "the key 'type' is missing: it says what kind this is"
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
        case "model_type" | "dict_type" | "model_attributes_type":
            return f"expected a table of keys, got {_shown(value)}"
        case _:
            return f"{error['msg']}, got {_shown(value)}"


# Units in which limits are given where a value was given in them; other limits are 0.
_OWN_UNITS = {"deg": "angle", "°": "angle", "rev": "angle", "rpm": "angular_speed"}


def _as_given(bound: float, value: object) -> str:
    """A limit in the unit of the value that passes it: an angle in degrees where that is in degrees."""
    unit = value.strip().lstrip("+-.0123456789eE ") if isinstance(value, str) else ""
    if bound == 0 or unit not in _OWN_UNITS:
        return f"{bound:g}"
    return f"{bound / in_text(f'1 {unit}', _OWN_UNITS[unit]):g} {unit}"


# Keys that others would call otherwise.
_SYNONYMS = {
    "from": ("start",),
    "to": ("stop",),
    "begin": ("from", "start"),
    "start": ("from",),
    "stop": ("to",),
    "end": ("to", "stop"),
    "min": ("low", "from"),
    "max": ("high", "to"),
    "minimum": ("low", "from"),
    "maximum": ("high", "to"),
    "steps": ("count",),
    "number": ("count",),
    "n": ("count",),
    "list": ("values",),
    "radius": ("length", "diameter"),
    "rpm": ("speed",),
    "omega": ("speed",),
    "rotation": ("speed",),
    "moment_of_inertia": ("inertia",),
    "j": ("inertia",),
    "weight": ("mass",),
    "m": ("mass",),
    "mu": ("coefficient", "friction"),
    "friction": ("coefficient",),
    "torque": ("moment",),
    "value": ("force", "moment", "values"),
    "direction": ("angle",),
    "ground": ("points",),
    "joints": ("points",),
    "crank": ("input",),
    "dyads": ("groups",),
    "masses": ("bodies",),
    "torques": ("moments",),
    "parameters": ("vary",),
    "results": ("outputs",),
    "constraints": ("require", "subject_to"),
}


def _allowed(name: str, allowed: list[str]) -> str:
    if not allowed:
        return ""
    near = [word for word in _SYNONYMS.get(name.lower(), ()) if word in allowed] or nearest_names(name, allowed)
    return f"; allowed: {', '.join(allowed)}" + (f"; did you mean {near[0]!r}?" if near else "")


def _fields_at(model: type[BaseModel], loc: tuple[str | int, ...]) -> list[str]:
    """Keys that the model allows at a location (with union tags in it)."""
    here: Any = model
    for item in loc:
        here = _descend(here, item)
    here = bare_annotation(here)
    if not (isinstance(here, type) and issubclass(here, BaseModel)):
        return []
    return [field.alias or name for name, field in here.model_fields.items()]


def bare_annotation(annotation: Any) -> Any:
    """An annotation without its marks and without None."""
    while get_origin(annotation) is Annotated:
        annotation = get_args(annotation)[0]
    if is_union(annotation):
        arms = [a for a in arms_of(annotation) if a is not type(None)]
        if len(arms) == 1:
            return bare_annotation(arms[0])
    return annotation


def is_union(annotation: Any) -> bool:
    """Whether an annotation is one of several, as that of any machine element is."""
    return annotation is Element or get_origin(annotation) is Union or type(annotation).__name__ == "UnionType"


def arms_of(union: Any) -> tuple[Any, ...]:
    """What a union is one of."""
    return tuple(element_kinds().values()) if union is Element else get_args(union)


def _descend(annotation: Any, item: str | int) -> Any:
    """Annotation of a key, an entry of a table, or an arm of a union named by its tag."""
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
    """Tags by which an arm of a union is named: its own, or the values of its key "type"."""
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
    """Problems with the lines of a text at which they are.

    Parameters
    ----------
    text : str
    problems : iterable of (str, str)
        The key, its steps joined by dots, and what is wrong.
    prefix : sequence of str
        Keys of the table in which these keys stand.
    """
    return [(line_of(text, [*prefix, *key.split(".")]), key, message) for key, message in problems]


def line_of(text: str, keys: list[str | int]) -> int | None:
    """Line of a TOML text that holds a key, or the deepest table or key around it that has a line of its own."""
    names = tuple(part for k in keys if not isinstance(k, int) for part in str(k).split("."))
    at, within = _lines_of(text)
    if names in within:
        return within[names]
    return next((at[names[:depth]] for depth in range(len(names), 0, -1) if names[:depth] in at), None)


@lru_cache(2)
def _lines_of(text: str) -> tuple[dict[tuple[str, ...], int], dict[tuple[str, ...], int]]:
    """First lines of a TOML text by the keys that they hold, and by all beginnings of these keys.

    Kept, as a text with thousands of mistakes is looked through for each of them.
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
