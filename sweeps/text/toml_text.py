"""Reading TOML into validated models; errors give file, line, key, value, allowed values and a remedy."""

import re
import tomllib
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from typing import Any

from pydantic import BaseModel, ValidationError

from engine import MOST_PROBLEMS, SceneError, comma_advice, wrong_input
from sweeps.text.input_files import InputError

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
            raise InputError.of(source, f"more than {_LONGEST_KEY} parts between full stops", number)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        found = re.search(r"\(at line (\d+), column (\d+)\)", str(error))
        line = int(found[1]) if found else None
        message = _common_mistake(text, line, source) or _not_toml(text, line, str(error))
        # A line is missing where the text ends too early.
        raise InputError.of(source, message, line or len(text.splitlines())) from None
    except (ValueError, RecursionError):
        raise InputError.of(source, "not valid TOML: a number too long, or tables nested too deep") from None


# Messages of the TOML reader, and the ones shown instead.
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
    "end of document": "the text ends within a value: complete it, and close its bracket or quotation mark",
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


# Common mistakes in a line, and their messages.
_SLIPS: dict[str, str | Callable[[str], str]] = {
    r"=\s*([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?\s*[A-Za-zµ°%][^\"',}\]#]*)": '{0} has a unit, so it needs quotes: "{0}"',
    r"=\s*([-+]?[0-9]+,[0-9]+(?:\s*[A-Za-zµ°%][^\"',}\]#]*)?)\s*(?:$|[#}])": comma_advice,
    r"=\s*((?!true\b|false\b|inf\b|nan\b)[A-Za-z][\w ./*^-]*?)\s*(?:$|[,#}\]])": (
        '{0} is a text, so it needs quotes: "{0}"'
    ),
    "=\\s*([“”„‘’])": 'write straight quotation marks, ", not typographic ones',
    r"^\s*([\w.]+)\s*:": "write KEY = VALUE, not KEY: VALUE",
    r"^\s*((?=\S*[^\x00-\x7f])[\w.]+)\s*=": "{0} is not a name: use the letters a to z, digits and single underscores",
    r"(=)\s*$": "no value after =",
}


def _common_mistake(text: str, line: int | None, source: str) -> str:
    """Diagnosis of common TOML mistakes in a line, or ""."""
    lines = text.splitlines()
    if line is None or not 1 <= line <= len(lines) or not source.endswith(".toml"):
        return ""
    # An incomplete line is reported at the start of the next one.
    for whole in lines[line - 1 : line] + lines[line - 2 : line - 1]:
        written = whole[:_LINE_LOOKED_AT]
        for pattern, words in _SLIPS.items():
            if slip := re.search(pattern, written):
                return (words if callable(words) else words.format)(slip[1].strip())
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
    except SceneError as error:
        problems = error.problems
    except ValidationError as error:
        problems = wrong_input(model, data, error)
    raise InputError(source, problems_in(text, problems, prefix))


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


class Problems:
    """Problems of a text, with the lines of their keys.

    Parameters
    ----------
    source : str
        Name of the text's file.
    text : str
    """

    def __init__(self, source: str, text: str) -> None:
        self.source, self.text = source, text
        self.found: list[tuple[int | None, str, str]] = []

    def add(self, keys: Sequence[str], message: str, entry: str = "") -> None:
        """Note a problem of a key, or of an entry of its list.

        Raises
        ------
        InputError
            There are many.
        """
        place = keys if line_of(self.text, keys) else keys[:1]
        line = line_of_entry(self.text, place, entry) if entry else line_of(self.text, place)
        self.found.append((line, ".".join(keys), message))
        if len(self.found) >= MOST_PROBLEMS:
            self.refuse()

    @contextmanager
    def noted(
        self, errors: type[Exception] | tuple[type[Exception], ...], keys: Sequence[str], entry: str = ""
    ) -> Iterator[None]:
        """Note an error that ends the block as a problem of a key."""
        try:
            yield
        except errors as error:
            self.add(keys, str(error), entry)

    def refuse(self) -> None:
        """Raise an `InputError` with the problems, if there are any."""
        if self.found:
            raise InputError(self.source, self.found)


def line_of(text: str, keys: Sequence[str | int]) -> int | None:
    """Line of a key, or of its nearest enclosing table or key."""
    names = tuple(part for k in keys if not isinstance(k, int) for part in str(k).split("."))
    at, within = _lines_of(text)
    if names in within:
        return within[names]
    return next((at[names[:depth]] for depth in range(len(names), 0, -1) if names[:depth] in at), None)


def line_of_entry(text: str, keys: Sequence[str | int], entry: str) -> int | None:
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
