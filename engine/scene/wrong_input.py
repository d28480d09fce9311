"""Faults of given data in plain words: key, value, allowed values, and a remedy."""

import re
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, Tag, ValidationError

from engine.elements.element import Element, element_kinds
from engine.units.reading import in_text, shown
from engine.words.glossary import listed, nearest

# Maximum number of problems reported at once.
MOST_PROBLEMS = 20

# What a value is expected to be, by the validator's kind of error.
_EXPECTED = {
    "string_type": "a text in quotes",
    "float_type": "a number",
    "int_type": "a whole number",
    "finite_number": "a finite number",
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


_WITHIN = re.compile(r"(\w+(?:\.\w+)+): ")


def _merged(errors: list[dict]) -> list[dict]:
    """Errors of a validator; those of a union's members for one value are merged into one."""
    found: list[dict] = []
    for error in errors:
        expected = _EXPECTED.get(error["type"])
        last = found[-1] if found else {}
        if expected and last.get("expected") and last["input"] is error["input"]:
            last["expected"] += f" or {expected}" if expected not in last["expected"] else ""
        else:
            found.append({**error, "expected": expected})
    return found


def wrong_input(model: type[BaseModel], data: object, error: ValidationError) -> list[tuple[str, str]]:
    """Key and message of each error of a validator.

    Parameters
    ----------
    model : type of BaseModel
        May have `hints`, for keys that are misplaced, or missing: "key", or "table.key" at any depth.
    data : object
        The data refused.
    error : ValidationError
    """
    found = []
    for one in _once_misspelt(model, _merged(error.errors())[: 2 * MOST_PROBLEMS])[:MOST_PROBLEMS]:
        keys = _keys(data, one)
        place, message = ".".join(map(str, keys)), _message(model, one, keys)
        # A model's message may begin with the path of one of its keys.
        if one["type"] == "value_error" and (inner := _WITHIN.match(message)):
            place, message = f"{place}.{inner[1]}".lstrip("."), message[inner.end() :]
        found.append((place, message))
    return found


def _once_misspelt(model: type[BaseModel], errors: list[dict]) -> list[dict]:
    """Errors without those of keys reported missing because they are misspelt."""
    unknown = [one["loc"] for one in errors if one["type"] == "extra_forbidden"]
    meant = {(*at, key) for *at, name in unknown for key in nearest(str(name), _fields_at(model, tuple(at)))}
    return [one for one in errors if one["type"] != "missing" or one["loc"] not in meant]


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


def _message(model: type[BaseModel], error: dict, keys: list[str | int]) -> str:
    kind, value, context = error["type"], error["input"], error.get("ctx", {})
    last = str(keys[-1]) if keys else ""
    hints: dict[str, str] = getattr(model, "hints", {})
    match kind:
        case "extra_forbidden":
            hint = f"; {hints[last]}" if last in hints else ""
            return f"unknown key; {listed(last, _fields_at(model, error['loc'][:-1]), 'allowed')}{hint}"
        case "missing" if isinstance(error["loc"][-1], str):
            choices = bare_annotation(_annotation_at(model, error["loc"]))
            words = f"add one of {', '.join(get_args(choices))}" if get_origin(choices) is Literal else "add it"
            hint = hints.get(f"{keys[0]}.{last}" if len(keys) > 1 else last, words)
            return f"is missing: {hint}"
        case "missing":
            return "has too few entries"
        case "union_tag_invalid":
            allowed = re.findall(r"'([^']+)'", context.get("expected_tags", ""))
            tag = str(context.get("tag"))
            return f"type {tag!r} is not known; {listed(tag, allowed, 'allowed')}"
        case "union_tag_not_found":
            return "the key 'type' is missing: add it"
        case "literal_error":
            allowed = re.findall(r"'([^']+)'", context["expected"]) or [context["expected"]]
            return f"{shown(value)} is not allowed; {listed(str(value), allowed, 'allowed')}"
        case "greater_than" | "greater_than_equal" | "less_than" | "less_than_equal":
            words = {"gt": "greater than", "ge": "at least", "lt": "less than", "le": "at most"}
            bound = next(f"{words[k]} {_as_given(context[k], value)}" for k in words if k in context)
            return f"must be {bound}, got {shown(value)}"
        case "string_pattern_mismatch":
            return f"{shown(value)} is not a name: use letters, digits and single underscores, a letter first"
        case "value_error":
            return str(context["error"])
        case "too_short":
            return f"has too few entries: {context['actual_length']}, at least {context['min_length']}"
        case "too_long":
            return f"has too many entries: {context['actual_length']}, at most {context['max_length']}"
        case _ if "url" not in error:
            # Errors raised by the parts, not by the validator.
            return f"{error['msg']}, got {shown(value)}"
        case _:
            return f"expected {error['expected'] or 'another value'}, got {shown(value)}"


# Units of limits; other limits are 0.
_OWN_UNITS = {"deg": "angle", "°": "angle", "rev": "angle", "rpm": "angular_speed"}


def _as_given(bound: float, value: object) -> str:
    """A limit in the unit of the value."""
    unit = value.strip().lstrip("+-.0123456789eE ") if isinstance(value, str) else ""
    if bound == 0 or unit not in _OWN_UNITS:
        return f"{bound:g}"
    return f"{bound / in_text(f'1 {unit}', _OWN_UNITS[unit]):g} {unit}"


def _annotation_at(model: type[BaseModel], loc: tuple[str | int, ...]) -> Any:
    """Annotation at a location (with union tags)."""
    here: Any = model
    for item in loc:
        here = _descend(here, item)
    return here


def _fields_at(model: type[BaseModel], loc: tuple[str | int, ...]) -> list[str]:
    """Keys allowed at a location."""
    here = bare_annotation(_annotation_at(model, loc))
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
