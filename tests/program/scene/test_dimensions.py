"""Dimensions of expressions: the same verdicts and dimensions as Pint's own arithmetic, and messages that help."""

from functools import cache

import numpy as np
import pint
import pytest
from each_case import each
from hypothesis import given, settings
from hypothesis import strategies as st

from engine import (
    DIMENSIONS,
    ExpressionError,
    any_quantity,
    check_yields,
    dimension_of,
    dimension_of_unit,
    unit_of_dimension,
)
from engine.parts.formulas.dimension_check import dimension_in_words
from engine.parts.formulas.expressions import parse

UNITS = {"length": "m", "bore": "m", "mass": "kg", "time": "s", "force": "N", "pressure": "Pa", "n": "1"}
UNITS |= {"inertia": "kg m2", "work": "J", "phi": "rad", "omega": "rad s-1"}
KNOWN = {name: dimension_of_unit(unit) for name, unit in UNITS.items()}
# The reference: quantities of Pint's own registry, in which radians are plain numbers, computed by Python.
SPELT = {"kg m2": "kg * m**2", "rad s-1": "rad / s", "1": ""}


@cache
def quantities():
    registry = pint.UnitRegistry()
    return {name: registry.Quantity(np.float64(1.5), SPELT.get(unit, unit)) for name, unit in UNITS.items()}


def chosen(one, other):
    """Stands for min and max: refuses what can't be added."""
    return one + other


FUNCTIONS = {"sqrt": lambda q: q**0.5, "abs": abs, "min": chosen, "max": chosen}

trees = st.recursive(
    st.sampled_from(sorted(UNITS)),
    lambda inner: st.one_of(
        st.tuples(st.sampled_from(["{} * {}", "{} / {}", "{} + {}", "{} - {}", "min({}, {})"]), inner, inner),
        st.tuples(st.sampled_from(["sqrt({})", "abs({})", "-{}", "{}**2", "{}**-1", "{}**(1/2)"]), inner),
    ).map(lambda parts: "(" + parts[0].format(*parts[1:]) + ")"),
    max_leaves=6,
)


def verdict_of_pint(text):
    """Powers of length, mass and time; None where Pint refuses."""
    try:
        with np.errstate(all="ignore"):
            found = eval(text, {"__builtins__": {}}, quantities() | FUNCTIONS)
    except pint.DimensionalityError:
        return None
    return {base: float(power) for base, power in found.dimensionality.items()}


def verdict(text):
    try:
        found = dimension_of(parse(text), KNOWN)
    except ExpressionError:
        return None
    return {f"[{base}]": float(power) for base, power in found.plain._asdict().items() if power}


@settings(max_examples=80)
@given(trees)
def test_random_expression__has_the_dimension_that_pint_computes(text):
    # Halves of halves are exact in binary, so the powers agree exactly.
    assert verdict(text) == verdict_of_pint(text)


# Unit, and expressions that have it.
SOUND = {
    "m": [
        *("0.3 * length", "length + 0", "0 - length", "max(0, length, -0)", "length + '3 mm'", "sqrt(length * bore)"),
        "(length**3)**(1/3) + length",
    ],
    "1": [
        *("sin(phi) + phi + 1", "(pressure / '1 bar')**(1 / n)", "exp(-time / '2 s')"),
        *("length < bore and not mass > '2 kg' or omega > '60 rpm'", "length > 0"),
    ],
    "rad s-1": ["2 * omega", "min(omega, '100 rpm')"],
    "m s-1": ["omega * length"],
    "N m": ["inertia * omega**2 / 2 + work"],
    "rad": ["atan2(length, bore)", "radians(30) + phi"],
    "m3 s-1": ["'431.1 l' / '60 s'"],
    "": ["length**0.5"],
}


@each("text, unit", [(text, unit) for unit in SOUND for text in SOUND[unit]])
def test_sound_expression__has_its_unit(text, unit):
    assert unit_of_dimension(dimension_of(parse(text, any_quantity), KNOWN)) == unit


@each(
    "text, place, words",
    [
        ("0 < length < bore < mass", 18, "compares a length with a mass"),
        ("-0.1 + length", 5, "-0.1 has no unit: write '-0.1 m'"),
        ("length > 300", 7, "compares a length with a plain number; 300 has no unit: write '300 m' or '300 mm'"),
        ("omega > 1500", 6, "an angular speed with a plain number; 1500 has no unit: write '1500 rad/s' or '1500 rpm'"),
        ("(time * 2) == force", 11, "compares a time with a force"),
        ("atan2(length, mass)", 0, "takes the atan2 of a length and a mass"),
        ("1 + log(length)", 4, "log takes a plain number, this is a length"),
        ("cos(length)", 0, "cos takes an angle or a plain number, this is a length"),
        ("length**n", 6, "the power of a length must be a fixed number"),
        ("2**mass", 1, "a power must be a plain number, this is a mass"),
        ("'1 l' / '1 s' > length", 14, "compares a quantity in m3 s-1 with a length"),
        ("not (length > 0 and length < mass)", 27, "compares a length with a mass"),
    ],
)
def test_unsound_expression__is_refused_with_its_place(text, place, words):
    with pytest.raises(ExpressionError) as caught:
        dimension_of(parse(text, any_quantity), KNOWN)
    message, shown, caret = str(caught.value).split("\n")
    assert words in message
    assert shown.strip() == text
    assert caret.index("^") - 4 == place


def test_what_is_yielded__must_have_the_dimension_wanted():
    check_yields(parse("2 * bore"), KNOWN["length"], KNOWN)
    check_yields(parse("0"), KNOWN["length"], KNOWN)
    check_yields(parse("n / 2"), KNOWN["phi"], KNOWN)
    with pytest.raises(ExpressionError, match=r"'mass / 2' gives a mass, but this is a length$"):
        check_yields(parse("mass / 2"), KNOWN["length"], KNOWN)
    with pytest.raises(ExpressionError, match="gives a plain number, but this is a mass; 3 has no unit: write '3 kg'"):
        check_yields(parse("3"), KNOWN["mass"], KNOWN)


def test_every_dimension__is_found_again_by_its_unit():
    for name, described in DIMENSIONS.items():
        dimension = dimension_of_unit(described.unit)
        assert dimension_of_unit(unit_of_dimension(dimension)) == dimension, name
        assert name.replace("_", " ").removeprefix("plain ") in dimension_in_words(dimension)
