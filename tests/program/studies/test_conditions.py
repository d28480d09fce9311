"""Conditions judged by values with error figures: what is sure holds everywhere within them, what is open both ways."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine import any_quantity
from engine.parts.formulas.dimension_check import dimension_of_unit, dimensions_by_unit
from engine.parts.formulas.expressions import ExpressionError, parse
from sweeps.text.conditions import Condition, UnknownNameError, errors_in, value_with_error

UNITS = {"stroke": "m", "rod": "m", "mass": "kg", "count": "1", "reach": ""}


def condition_of(text: str) -> Condition:
    return Condition(parse(text, any_quantity))


# Whole numbers and their halves, so that sums are exact and limits are met exactly.
NUMBERS = st.integers(-8, 8).map(lambda n: n / 2)
SIZES = st.integers(0, 4).map(lambda n: n / 2)


@st.composite
def linear_conditions(draw: st.DrawFn, depth: int = 2) -> str:
    kind = draw(st.sampled_from(["and", "or", "not", "compare", "compare"] if depth else ["compare"]))
    if kind == "compare":
        sign = draw(st.sampled_from(["<=", ">=", "==", "!=", "<", ">"]))
        return f"{draw(st.integers(-2, 2))} * a {sign} b + {draw(st.integers(-3, 3))}"
    if kind == "not":
        return f"not ({draw(linear_conditions(depth - 1))})"
    return f"({draw(linear_conditions(depth - 1))}) {kind} ({draw(linear_conditions(depth - 1))})"


def box(a: float, b: float, a_error: float, b_error: float) -> dict[str, np.ndarray]:
    """Values all over what the error figures allow, ends and middle among them."""
    rows, columns = np.meshgrid(a + a_error * np.linspace(-1, 1, 9), b + b_error * np.linspace(-1, 1, 9))
    return {"a": rows.ravel(), "b": columns.ravel()}


@settings(deadline=None, max_examples=300)
@given(linear_conditions(), NUMBERS, NUMBERS, SIZES, SIZES)
def test_what_is_sure__holds_for_all_values_within_the_figures(text, a, b, a_error, b_error):
    condition = condition_of(text)
    judged = condition.judged({"a": a, "b": b}, {"a": a_error, "b": b_error}, 1)
    inside = condition.met(box(a, b, a_error, b_error), 81)
    assert not judged.met[0] or inside.all()
    assert not judged.missed[0] or not inside.any()
    assert judged.undecided[0] == (not judged.met[0] and not judged.missed[0])
    if a_error == b_error == 0:
        assert (judged.met[0], judged.missed[0]) == (inside[0], not inside[0])


@settings(deadline=None, max_examples=200)
@given(st.sampled_from(["<=", ">=", "<", ">"]), NUMBERS, NUMBERS, SIZES, SIZES)
def test_what_is_open__goes_either_way_within_the_figures(sign, a, b, a_error, b_error):
    condition = condition_of(f"a {sign} b")
    judged = condition.judged({"a": a, "b": b}, {"a": a_error, "b": b_error}, 1)
    inside = condition.met(box(a, b, a_error, b_error), 81)
    assert judged.undecided[0] == (inside.any() and not inside.all())


def test_errors_of_one_name__go_together():
    judged = condition_of("a < a + 1").judged({"a": np.zeros(1)}, {"a": np.full(1, 9.0)}, 1)
    assert judged.met.tolist() == [True]
    value, error = value_with_error(parse("3 * a - a").tree, {"a": 5.0}, {"a": 0.5})
    assert (value, error) == (10.0, 1.0)


@pytest.mark.parametrize(("text", "undefined"), [("a < 1", False), ("not (a < 1)", True), ("a != 1", True)])
def test_undefined_value__is_judged_as_without_figures(text, undefined):
    judged = condition_of(text).judged({"a": np.full(2, np.nan)}, {"a": np.array([0.1, np.nan])}, 2)
    assert judged.met.tolist() == [undefined] * 2
    assert judged.missed.tolist() == [not undefined] * 2


def test_value_without_a_figure_where_others_have_one__leaves_everything_open():
    values, figures = np.array([0.0, 0.0, np.inf]), np.array([0.1, np.nan, np.nan])
    judged = condition_of("a < 1").judged({"a": values}, {"a": figures}, 3)
    assert judged.met.tolist() == [True, False, False]
    assert judged.missed.tolist() == [False, False, True]


def test_figures__are_found_beside_their_columns():
    columns = {"stroke": np.zeros(1), "stroke_error": np.ones(1), "rod": np.zeros(1)}
    assert errors_in(columns) == {"stroke": columns["stroke_error"]}


def test_condition__is_checked_when_it_is_read():
    known = dimensions_by_unit(UNITS)
    assert known["stroke"] == dimension_of_unit("m")
    assert Condition.read("stroke > '90 mm'\n  and mass < '2 kg'", known).text == "stroke > '90 mm' and mass < '2 kg'"
    Condition.read("reach > mass", known)
    with pytest.raises(UnknownNameError, match=r"unknown name 'strok'; did you mean 'stroke'\?"):
        Condition.read("strok > '90 mm'", known)
    with pytest.raises(ExpressionError, match="compares a length with a mass"):
        Condition.read("stroke > mass", known)
    with pytest.raises(ExpressionError, match="'stroke' is a number; a condition such as 'a < b' is needed here"):
        Condition.read("stroke", known)
