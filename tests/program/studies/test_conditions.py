"""Conditions judged by values with error estimates: what agrees within them is equal, contraries exclude each other."""

import numpy as np
import pytest
from each_case import each
from hypothesis import example, given, settings
from hypothesis import strategies as st

from engine import ExpressionError, any_quantity, dimension_of_unit, dimensions_by_unit
from engine.parts.formulas.expressions import parse
from sweeps.text.conditions import Condition, UnknownNameError, value_with_error

UNITS = {"stroke": "m", "rod": "m", "mass": "kg", "count": "1", "reach": ""}


def condition_of(text: str) -> Condition:
    return Condition(parse(text, any_quantity))


# Whole numbers and their halves, so that sums are exact and limits are met exactly.
NUMBERS = st.integers(-8, 8).map(lambda n: n / 2)
SIZES = st.integers(0, 4).map(lambda n: n / 2)


@st.composite
def linear_conditions(draw: st.DrawFn, depth: int = 2) -> tuple:
    """A condition as its text, and as (sign, n, m) of n·a ? b + m or (word, operands)."""
    kind = draw(st.sampled_from(["and", "or", "not", "compare", "compare"] if depth else ["compare"]))
    if kind == "compare":
        sign = draw(st.sampled_from(["<=", ">=", "==", "!=", "<", ">"]))
        n, m = draw(st.integers(-2, 2)), draw(st.integers(-3, 3))
        return f"{n} * a {sign} b + {m}", (sign, n, m)
    parts = [draw(linear_conditions(depth - 1)) for _ in range(1 if kind == "not" else 2)]
    tree = (kind, [tree for _, tree in parts])
    if kind == "not":
        return f"not ({parts[0][0]})", tree
    return f"({parts[0][0]}) {kind} ({parts[1][0]})", tree


def accepted(tree, a, b, a_error, b_error):
    """What agrees within the estimates is equal, all else is as it is."""
    if tree[0] in ("and", "or", "not"):
        parts = [accepted(part, a, b, a_error, b_error) for part in tree[1]]
        return not parts[0] if tree[0] == "not" else all(parts) if tree[0] == "and" else any(parts)
    sign, n, m = tree
    apart = n * a - b - m
    equal = abs(apart) <= abs(n) * a_error + b_error
    below, above = apart < 0 and not equal, apart > 0 and not equal
    return {"<": below, ">": above, "==": equal, "!=": not equal, "<=": not above, ">=": not below}[sign]


def box(a: float, b: float, a_error: float, b_error: float) -> dict[str, np.ndarray]:
    """Values all over what the error estimates allow, ends and middle among them."""
    rows, columns = np.meshgrid(a + a_error * np.linspace(-1, 1, 9), b + b_error * np.linspace(-1, 1, 9))
    return {"a": rows.ravel(), "b": columns.ravel()}


@settings(max_examples=60)
@given(linear_conditions(), NUMBERS, NUMBERS, SIZES, SIZES)
@example(("1 * a <= b + -1", ("<=", 1, -1)), 0.0, 1.0, 0.0, 0.0)
def test_sides_that_agree_within_their_estimates__count_as_equal(condition, a, b, a_error, b_error):
    text, tree = condition
    judged = condition_of(text).judged({"a": a, "b": b}, {"a": a_error, "b": b_error}, 1)
    assert judged.met[0] == accepted(tree, a, b, a_error, b_error)
    inside = condition_of(text).expression.evaluate(box(a, b, a_error, b_error))
    # What is decided is so for all values within the estimates.
    assert judged.undecided[0] or inside.all() == inside.any() == judged.met[0]
    if a_error == b_error == 0:
        assert not judged.undecided[0]


@settings(max_examples=50)
@given(
    linear_conditions(),
    st.floats(-1e3, 1e3),
    st.floats(-1e3, 1e3),
    st.floats(0, 10) | st.sampled_from([0.0, 1e-12]),
    st.sampled_from(["<", "<=", ">", ">=", "==", "!="]),
)
def test_condition_and_contrary__are_never_both_met_or_missed(condition, a, b, error, sign):
    contrary = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}[sign]
    for one, other in ((f"a {sign} b", f"a {contrary} b"), (condition[0], f"not ({condition[0]})")):
        for text, expected in ((f"({one}) or ({other})", True), (f"({one}) and ({other})", False)):
            for there in (b, a, np.nextafter(a, np.inf)):
                assert condition_of(text).judged({"a": a, "b": there}, {"a": error}, 1).met[0] == expected


WILD_SIZES = st.floats(0, 1e3, allow_subnormal=False) | st.sampled_from([0.0, np.nan, np.inf])
WILD = st.floats(-1e6, 1e6, allow_subnormal=False) | st.sampled_from([0.0, 1.0, np.nan])


@settings(max_examples=60)
@given(linear_conditions(3), st.lists(st.tuples(WILD, WILD, WILD_SIZES, WILD_SIZES), min_size=1, max_size=6))
def test_margin__with_error_estimates_is_below_zero_only_where_the_condition_is_met(written, rows):
    a, b, a_error, b_error = np.array(rows).T
    condition, known = condition_of(written[0]), ({"a": a, "b": b}, {"a": a_error, "b": b_error})
    sure = condition.judged(*known, a.size).met
    worst = condition.margins(*known, a.size).max(axis=0)
    defined = ~(np.isnan(a) | np.isnan(b))
    assert not (sure & defined & (worst > 0)).any()
    assert not (~sure & defined & (worst < 0)).any()
    assert (np.abs(worst) <= 1).all()


@settings(max_examples=200)
@given(
    st.sampled_from(["<=", ">=", "==", "<", ">", "!="]), st.floats(1e-6, 1e6), st.integers(1, 12), st.integers(1, 12)
)
def test_rounding__is_no_difference(sign, a, n, m):
    """n a / m · m / n is a, however it is rounded."""
    met = condition_of(f"{n} * a / {m} {sign} {n} * b").judged({"a": a, "b": a / m}, {}, 1).met[0]
    assert met == (sign in ("<=", ">=", "=="))


def test_errors_of_one_name__go_together():
    judged = condition_of("a < a + 1").judged({"a": np.zeros(1)}, {"a": np.full(1, 9.0)}, 1)
    assert judged.met.tolist() == [True]
    value, error = value_with_error(parse("3 * a - a").tree, {"a": 5.0}, {"a": 0.5})
    assert (value, error) == (10.0, 1.0)


@each("text, undefined", [("a < 1", False), ("not (a < 1)", True), ("a != 1", True)])
def test_undefined_value__is_judged_as_without_figures(text, undefined):
    judged = condition_of(text).judged({"a": np.full(2, np.nan)}, {"a": np.array([0.1, np.nan])}, 2)
    assert judged.met.tolist() == [undefined] * 2
    assert judged.undecided.tolist() == [False] * 2


def test_value_without_an_estimate_where_others_have_one__meets_nothing():
    values, figures = np.array([0.0, 0.0, np.inf]), np.array([0.1, np.nan, np.nan])
    judged = condition_of("a < 1").judged({"a": values}, {"a": figures}, 3)
    assert judged.met.tolist() == [True, False, False]
    assert judged.undecided.tolist() == [False, True, False]


@each("text", ["a > 1 and b > 1", "a > 1 or b > 1", "not (a > 1 or b > 3)"])
def test_number_that_all_variants_share__is_judged_beside_one_of_each(text):
    values, a = {"a": np.array([0.0, 2.0]), "b": 2.0}, [0.0, 2.0]
    expected = [condition_of(text).expression.evaluate({"a": each, "b": 2.0}) for each in a]
    assert condition_of(text).judged(values, {}, 2).met.tolist() == expected
    assert (condition_of(text).margins(values, {}, 2).max(axis=0) <= 0).tolist() == expected


def test_condition__is_checked_when_it_is_read():
    known = dimensions_by_unit(UNITS)
    assert known["stroke"] == dimension_of_unit("m")
    assert Condition.read("stroke > '90 mm'\n  and mass < '2 kg'", known).text == "stroke > '90 mm' and mass < '2 kg'"
    Condition.read("reach > mass", known)
    with pytest.raises(UnknownNameError, match=r"unknown name 'strok'; did you mean 'stroke'\?"):
        Condition.read("strok > '90 mm'", known)
    with pytest.raises(ExpressionError, match="compares a length with a mass"):
        Condition.read("stroke > mass", known)
    with pytest.raises(ExpressionError, match="'stroke' compares nothing; a condition such as 'a < b' is needed here"):
        Condition.read("stroke", known)
