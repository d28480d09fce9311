"""Arithmetic and conditions over names and dotted paths, in the texts of scenes and studies.

Two constructs follow engineers' notation: a quantity, `12 N m`, and a power, `omega^2`. Both are first converted to
Python's spelling. Python's parser then parses the text, and each construct is translated into a tree of arithmetic.
Constructs that are not listed are rejected. The text is never evaluated as Python.
"""

import ast
import functools
import itertools
import keyword
import math
import re
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from engine.units.reading import UNIT_NAMES
from engine.words.glossary import unknown_name_message

LONGEST = 2000
DEEPEST = 50

_OF_ONE = {
    **{"sqrt": np.sqrt, "sin": np.sin, "cos": np.cos, "tan": np.tan},
    **{"asin": np.arcsin, "acos": np.arccos, "atan": np.arctan, "abs": np.abs, "sign": np.sign},
    **{"exp": np.exp, "log": np.log, "radians": np.radians, "degrees": np.degrees},
}
# Functions with the number of their operands: (minimum, maximum).
FUNCTIONS = {name: (ufunc, 1, 1) for name, ufunc in _OF_ONE.items()} | {
    "atan2": (np.arctan2, 2, 2),
    "min": (np.minimum, 2, LONGEST),
    "max": (np.maximum, 2, LONGEST),
}

ALLOWED = (
    "numbers, pi, quantities such as 300 mm or '6 %', dotted paths such as bodies.rod.mass, "
    "+ - * / ^, comparisons, and, or, not, A if CONDITION else B, parentheses, " + ", ".join(FUNCTIONS)
)

_ARITHMETIC = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**"}
_COMPARISONS = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!="}

_UFUNCS = {
    **{"+": np.add, "-": np.subtract, "*": np.multiply, "/": np.divide, "**": np.power, "negative": np.negative},
    **{"<": np.less, "<=": np.less_equal, ">": np.greater, ">=": np.greater_equal},
    **{"==": np.equal, "!=": np.not_equal},
    **{"and": np.logical_and, "or": np.logical_or, "not": np.logical_not, "if": np.where},
    **{name: ufunc for name, (ufunc, _, _) in FUNCTIONS.items()},
}

_REPEATED = {"and", "or", "min", "max"}

# Mathematical symbols and their spelling for the parser.
_SIGNS = {"^": "**", "≤": "<=", "≥": ">=", "≠": "!="}
# Operators and words of other programs and their equivalents here.
_FOREIGN = {
    **{"=": "==", ":=": "==", "=>": ">=", "=<": "<=", "<>": "!=", "!": "not", "~": "not", ";": "and"},
    **{"&": "and", "&&": "and", "|": "or", "||": "or"},
}
_HINTS = {
    ast.Tuple: "commas separate the operands of a function only; join conditions by 'and', write 1.5 for 1,5",
    ast.UAdd: "leave the leading + out",
    ast.Mod: "% may only follow a number, as in 6 %",
    ast.Lambda: "functions can't be defined here",
    ast.JoinedStr: "text with {} can't be used here",
}


class ExpressionError(ValueError):
    """An invalid expression; the message shows the place and the allowed constructs."""


class TextQuantity(NamedTuple):
    """A quantity with its unit: value (SI) and text."""

    value: float
    text: str


class TextOperation(NamedTuple):
    """An operation, comparison or function: its operands and its column in the text.

    The operands of "if" are the condition, the value if it holds, and the value if not.
    """

    name: str
    operands: tuple["Tree", ...]
    column: int


# A number, a quantity, a name, or an operation on others.
Tree = float | TextQuantity | str | TextOperation


@dataclass(frozen=True)
class TextExpression:
    """A parsed expression, made by `parse`.

    Attributes
    ----------
    text : str
        The expression as written.
    names : tuple of str
        The dotted paths it uses, without repetition, in order of first appearance.
    is_condition : bool
        Whether it yields true or false instead of a number.
    tree : float, TextQuantity, str or TextOperation
        Its structure.
    """

    text: str
    names: tuple[str, ...]
    is_condition: bool
    tree: Tree = field(repr=False)

    def evaluate(self, values: Mapping[str, float | np.ndarray]) -> float | bool | np.ndarray:
        """Evaluate elementwise in float64.

        Division by zero gives an infinity or NaN, the root of a negative number NaN, without warning. A comparison
        with NaN is false (so `not (x < 1)` is true for NaN).

        Parameters
        ----------
        values : mapping of str to float or ndarray
            A value for each of `names`, with shapes that broadcast; other entries are ignored.

        Returns
        -------
        float, bool or ndarray
            An array if any of the values used is one; bool if `is_condition`.

        Raises
        ------
        ExpressionError
            One of `names` has no value.
        """
        for name in self.names:
            if name not in values:
                raise ExpressionError(f"in '{self.text}': {unknown_name_message(name, values)}")
        with np.errstate(all="ignore"):
            result = evaluate_tree(self.tree, values)
        return result if np.ndim(result) else result.item()


@functools.lru_cache(maxsize=1024)
def parse(text: str, quantity: Callable[[str], float] | None = None) -> TextExpression:
    """Parse an expression.

    Parameters
    ----------
    text : str
        For instance ``groups.rod.first.length > 300 mm and 2 * input.length < groups.rod.second.length``.
    quantity : callable, optional
        Converts the text of a quantity, 300 mm, to a number in SI; raises ValueError for invalid text. By default,
        quantities are rejected.

    Returns
    -------
    TextExpression

    Raises
    ------
    ExpressionError
        The text is not an expression, uses a construct that isn't allowed, is longer than 2000 characters or nested
        deeper than 50.
    """
    line = _one_line(text)
    if len(line) > LONGEST:
        raise _refusal(line, LONGEST, f"longer than {LONGEST} characters")
    if not line.strip():
        raise _refusal(line, 0, "an expression is missing")
    # A comment would swallow the following lines, which are joined to it.
    if "#" in line:
        raise _refusal(line, line.index("#"), "comments can't be used here")
    code = _code_of(line)
    translator = _Translator(code, quantity)
    tree, is_condition = translator.translate(_syntax_tree(code), depth=1)
    return TextExpression(text, tuple(translator.names), is_condition, tree)


def joined_by_and(text: str) -> list[str]:
    """Texts of the conditions joined by `and` in a valid condition."""
    code = _code_of(_one_line(text))
    tree = _syntax_tree(code)
    if not (isinstance(tree, ast.BoolOp) and isinstance(tree.op, ast.And)):
        return [text]
    parts = (code.line[code.column(value.col_offset) : code.column(value.end_col_offset)] for value in tree.values)
    return [inner for part in parts for inner in joined_by_and(part)]


def pointed_out(text: str, column: int) -> str:
    """The expression's text, or an excerpt of a long one, with a caret below a column."""
    first = max(0, column - 60)
    line = _one_line(text)
    shown = "".join(character if character.isprintable() else "?" for character in line[first : column + 40])
    before, after = "…" * (first > 0), "…" * (column + 40 < len(line))
    return f"    {before}{shown}{after}\n    {' ' * (len(before) + column - first)}^"


def _one_line(text: str) -> str:
    """The text on one line, so that a column identifies a place; each character keeps its column."""
    return "".join(" " if character.isspace() else character for character in text)


def evaluate_tree(tree: Tree, values: Mapping[str, float | np.ndarray]) -> np.ndarray:
    """Evaluate an expression or a part of one in float64, as in `TextExpression.evaluate`."""
    if isinstance(tree, float):
        return np.float64(tree)
    if isinstance(tree, TextQuantity):
        return np.float64(tree.value)
    if isinstance(tree, str):
        return np.asarray(values[tree], dtype=np.float64)
    return apply_operation(tree.name, [evaluate_tree(operand, values) for operand in tree.operands])


def apply_operation(name: str, operands: Sequence[np.ndarray]) -> np.ndarray:
    """Value of an operation, comparison or function."""
    ufunc = _UFUNCS[name]
    return functools.reduce(ufunc, operands) if name in _REPEATED else ufunc(*operands)


def names_in_tree(tree: Tree) -> dict[str, None]:
    """Names used in a part of an expression, without repetition, in order."""
    if isinstance(tree, TextOperation):
        return {name: None for operand in tree.operands for name in names_in_tree(operand)}
    return {tree: None} if isinstance(tree, str) else {}


def is_zero(tree: Tree) -> bool:
    """Whether a part of an expression is a bare 0, which has any dimension."""
    if isinstance(tree, TextOperation) and tree.name == "negative":
        return is_zero(tree.operands[0])
    return isinstance(tree, float) and tree == 0


class _Code(NamedTuple):
    """An expression in Python's spelling.

    Attributes
    ----------
    line : str
        The expression as written, on one line.
    text : str
        For Python's parser, without leading blanks, which it would take for an indentation.
    columns : list of int
        Column in the line for each character of the text, and for its end.
    """

    line: str
    text: str
    columns: list[int]

    def column(self, offset: int) -> int:
        """Column in the line for the parser's offset, which counts bytes."""
        return self.columns[len(self.text.encode()[:offset].decode())]


# A number or its start; a name, including digits; quoted text; a symbol to replace; a foreign operator to reject.
_TOKEN = re.compile(
    r"(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)|(?P<word>[^\W\d]\w*)|"
    r"(?P<quoted>'(?:[^'\\]|\\.)*'|\"(?:[^\"\\]|\\.)*\")|(?P<open>['\"])|(?P<sign>[\^≤≥≠])|"
    r"(?P<foreign>=>|=<|<>|&&?|\|\|?|:=|;|~|!(?!=)|(?<![<>=!])=(?!=))"
)
_JOINING = re.compile(r"(?i:and|or|not|if|else)")
_UNFINISHED = re.compile(r"(?:[-+*/^<>=,(]|\b(?:and|or|not|if|else))\s*$")
# A unit with its power. A hyphen joins pounds with feet or inches; elsewhere it is a minus.
_UNIT = rf"(?:(?:ft|in)-lb[fs]?|lb[fs]?-(?:ft|in)|{'|'.join(UNIT_NAMES)})(?![^\W\d_])"
_UNIT += r"(?:(?:\^|\*\*)-?[1-9]|[1-9])?(?![\w.(])"
# The units that follow a number. Blanks join units, as in "N m". A slash without blanks joins units, as in "N/mm" or
# "N/(m s)"; with blanks it divides.
_UNITS = re.compile(rf" *(?:[%°]|{_UNIT}(?: *{_UNIT})*(?:/(?:{_UNIT}|\({_UNIT}(?:[ *]{_UNIT})*\)))*)")


def _code_of(line: str) -> _Code:
    """Convert an expression to Python's spelling: quantities in quotes, powers as `**`."""
    pieces: list[tuple[str, int]] = []
    place = len(line) - len(line.lstrip())
    while place < len(line):
        token = _TOKEN.match(line, place)
        end = token.end() if token else place + 1
        if token:
            _check_token(line, token)
        if token and token["number"] and (units := _UNITS.match(line, end)):
            end = units.end()
            pieces += [("'", place), *((line[i], i) for i in range(place, end)), ("'", end - 1)]
        elif token and token["sign"]:
            pieces += [(character, place) for character in _SIGNS[token["sign"]]]
        else:
            pieces += [(line[i], i) for i in range(place, end)]
        if token and (token["number"] or token["quoted"]):
            _no_stray_word(line, end)
        place = end
    return _Code(line, "".join(text for text, _ in pieces), [*(column for _, column in pieces), len(line)])


def _check_token(line: str, token: re.Match) -> None:
    """Reject operators and words of other programs, and unclosed quotation marks."""
    here = _FOREIGN.get(token[0])
    is_name = "." in (line[token.start() - 1 : token.start()], line[token.end() : token.end() + 1])
    if token["word"] and not is_name and _JOINING.fullmatch(token[0]) and not token[0].islower():
        here = token[0].lower()
    if token[0] == "=" and not line[: token.start()].strip():
        raise _refusal(line, token.start(), "leave the leading = out")
    if here:
        raise _refusal(line, token.start(), f"write {here} instead of {token[0]}")
    if token["open"]:
        raise _refusal(line, token.start(), f"the quotation mark {token[0]} is never closed")


def _no_stray_word(line: str, end: int) -> None:
    """Reject a word after a quantity and a blank: an operator is missing, or the word is not a unit."""
    word = re.compile(r" +([^\W\d]\w*)").match(line, end)
    if word and not keyword.iskeyword(word[1]) and not _JOINING.fullmatch(word[1]):
        what = f"{word[1]!r} is not a valid unit here, or an operator is missing before it"
        raise _refusal(line, word.start(1), what)


def _syntax_tree(code: _Code) -> ast.expr:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = ast.parse(code.text, mode="eval")
    except SyntaxError as error:
        column = code.columns[min(max(error.offset or 1, 1) - 1, len(code.text))]
        raise _refusal(code.line, *_slip(code.line, column)) from None
    except (ValueError, RecursionError, MemoryError):
        what = "this can't be read (nested too deep, or with characters that aren't text)"
        raise _refusal(code.line, 0, what) from None
    return tree.body


def _slip(line: str, column: int) -> tuple[int, str]:
    """Column and description of a syntax error, found near a column."""
    opened: list[int] = []
    for token in re.finditer(r"'[^']*'|\"[^\"]*\"|[()]", line):
        if token[0] == "(":
            opened.append(token.start())
        elif token[0] == ")" and not opened:
            return token.start(), "this bracket was never opened"
        elif token[0] == ")":
            opened.pop()
    if (end := _UNFINISHED.search(line)) is not None:
        return len(line.rstrip()), f"something is missing after {end[0].strip()!r}"
    if opened:
        return opened[-1], "this bracket is never closed"
    word = re.compile(r"\w+").match(line, column)
    if re.search(r"\bif\b", line) and not re.search(r"\belse\b", line):
        return column, "an 'if' needs an 'else'"
    if word and keyword.iskeyword(word[0]):
        return column, f"{word[0]!r} is a reserved word and can't be used here"
    return column, "an operator is missing here, or this sign has no meaning"


def _refusal(line: str, column: int, what: str) -> ExpressionError:
    """Error to raise, with a caret under the place."""
    return ExpressionError(f"{what}:\n{pointed_out(line, column)}\nallowed: {ALLOWED}")


class _Translator:
    """Translates Python's syntax tree into a `Tree`."""

    def __init__(self, code: _Code, quantity: Callable[[str], float] | None) -> None:
        self.code, self.quantity = code, quantity
        self.names: dict[str, None] = {}

    def translate(self, node: ast.expr, depth: int) -> tuple[Tree, bool]:
        """Translate a node; also return whether it is a condition."""
        if depth > DEEPEST:
            raise self.refusal(node, f"nested, or chained by + - * /, deeper than {DEEPEST}")
        match node:
            case ast.Constant():
                return self.constant(node), False
            case ast.Name() | ast.Attribute() | ast.Subscript():
                return self.name(node), False
            case ast.Call():
                return self.call(node, depth), False
            case ast.UnaryOp(op=ast.USub()):
                return self.operation("negative", [self.number(node.operand, depth)], node), False
            case ast.BinOp() if type(node.op) in _ARITHMETIC:
                left, right = self.number(node.left, depth), self.number(node.right, depth)
                return TextOperation(_ARITHMETIC[type(node.op)], (left, right), self.after(node.left)), False
            case ast.UnaryOp(op=ast.Not()):
                return self.operation("not", [self.condition(node.operand, depth)], node), True
            case ast.IfExp():
                condition = self.condition(node.test, depth)
                numbers = (self.number(part, depth) for part in (node.body, node.orelse))
                return TextOperation("if", (condition, *numbers), self.after(node.body)), False
            case ast.BoolOp():
                word = "and" if isinstance(node.op, ast.And) else "or"
                return self.operation(word, (self.condition(value, depth) for value in node.values), node), True
            case ast.Compare():
                return self.comparison(node, depth), True
            case _:
                begin, end = (self.column(offset) for offset in (node.col_offset, node.end_col_offset))
                if isinstance(node, ast.BinOp):
                    begin, end = self.after(node.left), self.column(node.right.col_offset)
                elif isinstance(node, ast.Tuple) and node.elts:
                    begin = self.after(node.elts[0])
                words = f"{self.code.line[begin:end].strip(' (')!r} can't be used here"
                raise self.refusal(begin, _HINTS.get(type(getattr(node, "op", node)), words))

    def operation(self, name: str, operands: Iterable[Tree], node: ast.expr) -> TextOperation:
        return TextOperation(name, tuple(operands), self.column(node.col_offset))

    def number(self, node: ast.expr, depth: int) -> Tree:
        tree, is_condition = self.translate(node, depth + 1)
        if is_condition:
            raise self.refusal(node, "a number is needed here, this is a condition")
        return tree

    def condition(self, node: ast.expr, depth: int) -> Tree:
        tree, is_condition = self.translate(node, depth + 1)
        if not is_condition:
            raise self.refusal(node, "a condition is needed here, and this compares nothing")
        return tree

    def comparison(self, node: ast.Compare, depth: int) -> TextOperation:
        nodes = (node.left, *node.comparators)
        for operator, left in zip(node.ops, nodes, strict=False):
            if type(operator) not in _COMPARISONS:
                raise self.refusal(self.after(left), "compare numbers by ==, !=, <, <=, > or >=")
        operands = [self.number(operand, depth) for operand in nodes]
        pairs = [
            TextOperation(_COMPARISONS[type(operator)], pair, self.after(left))
            for operator, pair, left in zip(node.ops, itertools.pairwise(operands), nodes, strict=False)
        ]
        return pairs[0] if len(pairs) == 1 else self.operation("and", pairs, node)

    def call(self, node: ast.Call, depth: int) -> TextOperation:
        name = node.func.id if isinstance(node.func, ast.Name) else None
        if name not in FUNCTIONS:
            raise self.refusal(node, "no such function")
        if node.keywords:
            raise self.refusal(node.keywords[0].value, "operands have no names here")
        _, fewest, most = FUNCTIONS[name]
        if not fewest <= len(node.args) <= most:
            needed = f"{fewest} or more" if most > fewest else str(fewest)
            raise self.refusal(node, f"{name} takes {needed} operand(s), not {len(node.args)}")
        return self.operation(name, (self.number(operand, depth) for operand in node.args), node)

    def constant(self, node: ast.Constant) -> float | TextQuantity:
        is_quantity = isinstance(node.value, str)
        value = self.converted(node) if is_quantity else node.value
        if type(value) not in (int, float):
            raise self.refusal(node, f"{value!r} is not a real number")
        # Python's integers are exact: 9**9**9**9 would exhaust the memory.
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            raise self.refusal(node, "this number is not finite")
        return TextQuantity(number, node.value) if is_quantity else number

    def converted(self, node: ast.Constant) -> float:
        if self.quantity is None:
            raise self.refusal(node, "a quantity can't be used here")
        try:
            return float(self.quantity(node.value))
        except ValueError as error:
            raise self.refusal(node, f"{node.value!r} is not a quantity: {error}") from error

    def name(self, node: ast.expr) -> float | str:
        path = self.path(node)
        if path == "pi":
            return math.pi
        if path in FUNCTIONS:
            raise self.refusal(node, f"{path} is a function: write {path}(...)")
        self.names[path] = None
        return path

    def path(self, node: ast.expr) -> str:
        parts = []
        while not isinstance(node, ast.Name):
            match node:
                case ast.Attribute(value=value, attr=word) if not word.startswith("__"):
                    parts.append(f".{word}")
                case ast.Subscript(value=value, slice=ast.Constant(value=index)) if type(index) is int:
                    parts.append(f"[{index}]")
                case ast.Attribute() | ast.Subscript():
                    raise self.refusal(node, "a path is made of words, dots and numbers in brackets")
                case _:
                    raise self.refusal(node, "only a path can have a dot or a bracket after it")
            node = value
        if node.id.startswith("__"):
            raise self.refusal(node, "a path is made of words, dots and numbers in brackets")
        return node.id + "".join(reversed(parts))

    def refusal(self, place: ast.AST | int, what: str) -> ExpressionError:
        """Error to raise, with a caret under the place (a node or a column)."""
        if isinstance(place, ast.AST):
            place = self.column(place.col_offset)
        return _refusal(self.code.line, place, what)

    def after(self, operand: ast.expr) -> int:
        """Column of the operator after an operand."""
        column = self.column(operand.end_col_offset)
        while self.code.line[column] in " )":
            column += 1
        return column

    def column(self, offset: int) -> int:
        """Column of the parser's offset, which counts bytes."""
        return self.code.column(offset)
