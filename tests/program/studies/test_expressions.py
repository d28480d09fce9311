import math
import pickle

import mpmath
import numpy as np
import pytest
from each_case import each
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.parts.formulas.expressions import DEEPEST, LONGEST, ExpressionError, joined_by_and, parse
from engine.words.glossary import unknown_name_message

# --- random texts, against Python's own reading of them --------------------------------------------------------

VALUES = {"a": 1.7, "input.length": -0.3, "bodies.rod.center[0]": 1e3, "groups.rod.first.length": 0.0}

SIGNS = "abx019.,()[]{}'\"+-*/%^&|~<>=!:;@#\\\n\t _\x00\ud800é"
WORDS = [
    *("lambda ", " if ", " else ", " for ", " in ", " is ", "not ", " and ", " or ", "yield ", "await "),
    *("sqrt(", "min(", "pi", "**", "'1 mm'", "__", "None", "1e999", "1j", "f'"),
]


def smaller(left, right):
    return math.nan if math.isnan(left) or math.isnan(right) else min(left, right)


# What Python reads instead: numbers of NumPy divide as IEEE 754 has it, and all operations are correctly rounded.
NAMES = {name: f"v{i}" for i, name in enumerate(VALUES)}
SCOPE = {"real": np.float64, "sqrt": np.sqrt, "abs": abs, "min": smaller}
SCOPE |= {NAMES[name]: np.float64(value) for name, value in VALUES.items()}


def formed(*forms):
    """Texts of two operands, each with what Python reads instead of it."""
    return lambda inner: st.tuples(st.sampled_from(forms), inner, inner).map(
        lambda drawn: tuple(drawn[0].format(*operands) for operands in zip(*drawn[1:], strict=True))
    )


literals = st.one_of(st.integers(0, 99), st.floats(0, 1e6, allow_subnormal=False))
leaves = st.one_of(st.sampled_from(list(NAMES.items())), literals.map(lambda x: (str(x), f"real({x})")))
choices = "({} if a < 2 else {})", "({} if a < 1 else {})"
signs = [f"{{}} {sign} {{}}" for sign in ("<", "<=", ">", ">=", "==", "!=")]
operations = formed(
    *("{} + {}", "{} - {}", "{} * {}", "{} / {}", "{} / ({})", "({}) * {}", "-{}", "-({})"),
    *("min({}, {})", "abs({})", "sqrt({})", *choices),
)
numbers = st.recursive(leaves, operations, max_leaves=12)
joined = formed("{} and {}", "{} or {}", "({}) and ({})", "not {}", "not ({})")
conditions = st.recursive(formed(*signs)(numbers), joined, max_leaves=6)


def read_by_python(text):
    with np.errstate(all="ignore"):
        return eval(text.replace(" a ", f" {NAMES['a']} "), {"__builtins__": {}}, SCOPE)


def same(one, other):
    return one == other or (math.isnan(one) and math.isnan(other))


@settings(max_examples=60)
@given(numbers)
def test_random_arithmetic__agrees_with_python(texts):
    expression = parse(texts[0])
    assert not expression.is_condition
    assert same(expression.evaluate(VALUES), read_by_python(texts[1]))


@settings(max_examples=60)
@given(conditions)
def test_random_condition__agrees_with_python(texts):
    expression = parse(texts[0])
    assert expression.is_condition
    assert expression.evaluate(VALUES) is bool(read_by_python(texts[1]))


@settings(max_examples=250)
@given(st.one_of(st.text(max_size=60), st.lists(st.sampled_from([*SIGNS, *WORDS]), max_size=25).map("".join)))
def test_garbage__raises_expression_error_only(text):
    try:
        expression = parse(text, quantity=float)
    except ExpressionError as error:
        str(error).encode()
        return
    assert isinstance(expression.evaluate(dict.fromkeys(expression.names, 0.5)), (float, bool))


# --- meaning -----------------------------------------------------------------------------------------------


@each("name", ["sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "radians"])
def test_function__agrees_with_fifty_digits(name):
    values = np.linspace(0.01, 0.99, 99)
    found = parse(f"{name}(x)").evaluate({"x": values})
    with mpmath.workdps(50):
        exact = [float(getattr(mpmath, name)(mpmath.mpf(float(value)))) for value in values]
    # NumPy's vectorised functions are good to 4 units in the last place; the reference is rounded once.
    np.testing.assert_allclose(found, exact, rtol=5 * np.finfo(float).eps)


@each(
    "text, expected",
    [
        ("-2**2", -4.0),
        ("2**3**2", 512.0),
        ("1 - 2 - 3", -4.0),
        ("atan2(1, -1)", 3 * math.pi / 4),
        ("min(3, 1, 2) + max(3, 1, 2)", 4.0),
        ("  (1\n + 2)\t* 3\n", 9.0),
        ("1 < 2 < 3", True),
        ("1 == 1 != 2 >= 2", True),
        ("not 1 < 2 or 2 < 3", True),
        ("2^-1", 0.5),
        ("1 if 1 < 2 else 2", 1.0),
        ("1 if 1 > 2 else 2 if 1 > 3 else 3", 3.0),
        ("sign(-3) + sign(0) + 10 * sign(7)", 9.0),
        ("9**9**9**9", math.inf),
        ("1 ≤ 1 and 2 ≥ 1 and 1 ≠ 2", True),
        # Without a warning.
        *(("1 / 0", math.inf), ("sqrt(-1)", math.nan), ("log(0)", -math.inf), ("(-8)**0.5", math.nan)),
    ],
)
def test_constant_expression__has_value(text, expected):
    # All but the angles are exact in float64; those are rounded twice.
    assert parse(text).evaluate({}) == pytest.approx(expected, rel=4e-16, nan_ok=True)


def test_arrays__are_evaluated_element_by_element():
    x, y = np.array([1.0, 2.0, math.nan, 4.0]), np.array([4.0, 1.0, 1.0, 4.0])
    expression = parse("x < y or x == y and not x > 4")
    found = expression.evaluate({"x": x, "y": y, "unused": None})
    assert found.dtype == bool
    assert found.tolist() == [True, False, False, True]
    np.testing.assert_array_equal(parse("2 * x - y").evaluate({"x": x, "y": y}), 2 * x - y)
    np.testing.assert_array_equal(parse("x * k").evaluate({"x": x[:, None], "k": y}), x[:, None] * y)


def test_names__are_dotted_paths_once_in_order():
    expression = parse("groups.rod.first.length + bodies.rod.center [ 0 ] * a / groups . rod.first.length + pi")
    assert expression.names == ("groups.rod.first.length", "bodies.rod.center[0]", "a")
    assert parse("bodies[2].center[0]").names == ("bodies[2].center[0]",)


def test_expression__can_be_pickled():
    expression = pickle.loads(pickle.dumps(parse("sqrt(a.b) < 2")))
    assert expression.evaluate({"a.b": np.array([1.0, 9.0])}).tolist() == [True, False]


QUANTITIES = [
    ("12 N m + x", ["12 N m"]),
    ("3 N m s2 * x^2", ["3 N m s2"]),
    ("3 kN/mm / x", ["3 kN/mm"]),
    ("3 N/(m s) * x", ["3 N/(m s)"]),
    ("5 mm-1 mm", ["5 mm", "1 mm"]),
    ("2 m^2 + 3 s^-1 + 4 kg m2", ["2 m^2", "3 s^-1", "4 kg m2"]),
    ("1 N if x > 1 in else 2 N", ["1 N", "1 in", "2 N"]),
    ("min(1 min, 2 s) + 1e3m * x", ["1 min", "2 s", "1e3m"]),
    ("x <= 6 % and y < 40°", ["6 %", "40°"]),
]


@each("text, expected", QUANTITIES)
def test_quantity_without_quotes__is_a_number_and_the_units_that_follow(text, expected):
    given_texts = []
    parse(text, quantity=lambda text: given_texts.append(text) or 1.0)
    assert sorted(given_texts) == sorted(expected)
    assert parse("x > '300 mm'", quantity=lambda text: 0.3).evaluate({"x": np.array([0.2, 0.4])}).tolist() == [
        False,
        True,
    ]
    assert parse("3 kN/x", quantity=lambda text: 3000.0).evaluate({"x": 2.0}) == 1500.0


def test_conditions_joined_by_and__are_given_as_written():
    parts = ["a > 3 mm", "b^2 < 4 or c > '1 s'", "not d < 1"]
    assert joined_by_and("a > 3 mm and (b^2 < 4 or c > '1 s') and not d < 1") == parts
    assert joined_by_and("  (a < 1 and b < 2) and c < 3") == ["a < 1", "b < 2", "c < 3"]


# --- refusals ----------------------------------------------------------------------------------------------


# Reason, and texts with the place that is to blame.
REFUSED = {
    "defined": [("x + (lambda: 1)", 5)],
    "'[x for x in y]' can't be used": [("[x for x in y]", 0)],
    "'{1: 2}' can't": [("{1: 2}", 0)],
    "'[1, 2]' can't": [("[1, 2]", 0)],
    "no such function": [("2 + __import__('os')", 4), ("open('x')", 0), ("a.sin(x)", 0), ("sin(x)(y)", 0)],
    "only a path": [("sin(x).real", 0), ("'a'.join", 0)],
    "words": [
        *(("1 + a.__class__", 4), ("__name__", 0), ("__a.b", 0), ("x[-1]", 0), ("x[1:2]", 0), ("x[y]", 0)),
        *(("x[True]", 0), ("x['k']", 0)),
    ],
    "'*x' can't": [("min(1, *x)", 7)],
    "write sin(...)": [("1 + sin", 4)],
    "takes 2 or more": [("min(1)", 0)],
    "text": [("f'{x}'", 0)],
    "condition is needed": [("1 if x else 2", 5), ("a < b and c", 10), ("not x", 4)],
    "number is needed": [
        *(("1 if x < 1 else y > 2", 16), ("(x < 1 if x < 2 else x < 3) and x < 4", 1), ("(a < b) + 1", 1)),
        *(("sin(a < b)", 4), ("(a < b) == (c < d)", 1)),
    ],
    "": [("x\x00", 0)],
    "write == instead of =": [("x = 1", 2), ("max(1, key=2)", 10)],
    "write == instead of :=": [("(y := 1)", 3)],
    "write >= instead of =>": [("x => 1", 2)],
    "write <= instead of =<": [("x =< 1", 2)],
    "write != instead of <>": [("x <> 1", 2)],
    "write and instead of": [("(a) & b", 4), ("a < 1 && b < 1", 6), ("a; b", 1), ("a < 3 AND b < 2", 6)],
    "write or instead of": [("a | b", 2), ("a < 1 || b < 1", 6), ("a < b Or b < 1", 6)],
    "write not instead of": [("~a", 0), ("!(a < b)", 0), ("NOT a < b", 0)],
    "never closed": [("(1", 0), ("a + (b * (c + 1)", 4), ("a < '3 mm", 4)],
    "never opened": [("a) + (b", 1)],
    "missing after": [("a <", 3), ("a < b and ", 9), ("(a < b) or", 10), ("a + (", 5)],
    "'if' needs an 'else'": [("1 if a < b", 0)],
    "reserved word": [("groups.in.length", 7), ("from > 3", 0)],
    "operator is missing": [("a b", 2), ("2 3", 2), ("a < b $", 6)],
    "write 1.5 for 1,5": [("1,5 * x", 1), ("a < 1, b < 2", 5)],
    "leading +": [("a ^ + b", 4), ("+a", 0)],
    "as in 6 %": [("a % 2", 2)],
    "'@' can't": [("a @ b", 2), ("  δ + é^2 @ 3", 10)],
    "compare numbers by ==": [("a < b in c", 6), ("a is b", 2)],
    "not a real number": [("1j", 0), ("True", 0), ("None", 0), ("...", 0), ("b'x'", 0)],
    "not finite": [("1e999", 0), ("1" + "0" * 400, 0)],
    "a quantity can't be used": [("x < '3 mm'", 4), ("x < 3 mm", 4)],
    "'y' is not a valid unit": [("x * 3 y", 6), ("x * '3 mm' y", 11)],
    "comments": [("a + 1 # note", 6)],
    "missing": [("", 0), (" \n ", 0)],
    "write sin": [("a +\n  δ + sin", 10)],
}


@each("text, place, reason", [(*pair, reason) for reason in REFUSED for pair in REFUSED[reason]])
def test_refused_construct__is_shown_with_its_place(text, place, reason):
    with pytest.raises(ExpressionError) as caught:
        parse(text)
    what, shown, caret, allowed = str(caught.value).split("\n")
    assert reason in what
    assert shown[4:] == "".join(character if character.isprintable() else " " for character in text)[:100] or (
        "\x00" in text or len(text) > 100
    )
    assert caret.index("^") - 4 == place
    assert "sqrt" in allowed
    assert "parentheses" in allowed


@each("before, after", [(3, 3), (60, 39), (61, 40), (200, 200)])
def test_excerpt_of_a_long_expression__shows_where_it_is_cut(before, after):
    with pytest.raises(ExpressionError) as caught:
        parse("a + " * (before // 4) + " " * (before % 4) + "@" + "b" * after)
    _, shown, caret, _ = str(caught.value).split("\n")
    assert shown[caret.index("^")] == "@"
    assert shown.startswith("    …") == (before > 60)
    assert shown.endswith("…") == (after > 39)


def test_too_long__is_refused():
    parse("a" * LONGEST)
    with pytest.raises(ExpressionError, match="longer than 2000"):
        parse("a" * (LONGEST + 1))


def nested(depth):
    return "sin(" * (depth - 1) + "a" + ")" * (depth - 1)


def test_nesting__is_limited():
    parse(nested(DEEPEST))
    with pytest.raises(ExpressionError, match="deeper than 50"):
        parse(nested(DEEPEST + 1))


@each("text", ["-" * 1999 + "1", "(" * 999 + "1" + ")" * 999, "not " * 499 + "a", "a" + "+a" * 999])
def test_extreme_nesting__is_refused_not_fatal(text):
    with pytest.raises(ExpressionError):
        parse(text)


def test_wrong_quantity__is_refused_with_the_reason():
    def quantity(text):
        raise ValueError("expected a length")

    with pytest.raises(ExpressionError, match="'3 kg' is not a quantity: expected a length"):
        parse("a < '3 kg'", quantity=quantity)
    with pytest.raises(ExpressionError, match="not finite"):
        parse("a < 'x'", quantity=lambda text: math.nan)


def test_missing_value__is_refused_with_suggestion():
    with pytest.raises(ExpressionError, match=r"unknown name 'input.lenght'; did you mean 'input.length'\?"):
        parse("input.lenght + 1").evaluate({"input.length": 1.0})


def test_unknown_name_message__lists_what_is_known():
    assert unknown_name_message("zzz", ["b", "a"]) == "unknown name 'zzz'; known are a, b"
    assert unknown_name_message("zzz", (f"n{i:02}" for i in range(25))).endswith("n19 and 5 more")
    assert "no names" in unknown_name_message("zzz", [])
