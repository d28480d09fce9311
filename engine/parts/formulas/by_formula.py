"""Loads given by a formula: its text and its own numbers."""

import math
from collections.abc import Iterator
from typing import Annotated

from pydantic import AfterValidator, ValidationInfo, model_validator

from engine.parts.formulas.expressions import ExpressionError, parse
from engine.parts.skeleton import Name, Part, SceneNumber
from engine.units.reading import any_quantity, in_text, recognised


def _readable(text: str) -> str:
    try:
        expression = parse(text, any_quantity)
    except ExpressionError as error:
        raise ValueError(str(error)) from None
    if expression.is_condition:
        raise ValueError(f"{text!r} is a condition; a number is needed: write A if {text} else B")
    return text


FormulaText = Annotated[str, AfterValidator(_readable)]


class FormulaNumber(Part):
    """A number of a formula: its value (SI), and its dimension by name, or by its SI unit if it has no name.

    Text takes any unit, "3 kN/mm"; a number without a unit is dimensionless.
    """

    value: float
    dimension: str

    @model_validator(mode="before")
    @classmethod
    def _from_quantity(cls, given: object, info: ValidationInfo) -> object:
        if isinstance(given, (FormulaNumber, dict)) and not (info.context and info.context.get("text")):
            return given
        value, dimension = recognised(given) if isinstance(given, str) else (in_text(given, "number"), "number")
        return {"value": value, "dimension": dimension}

    def numbers_within(self, path: str = "") -> Iterator[tuple[str, SceneNumber]]:
        """The number itself, without limits."""
        yield path, SceneNumber(self.value, self.dimension, ())

    def at(self, value: float) -> "FormulaNumber":
        """Copy with another value (SI)."""
        if not math.isfinite(value):
            raise ValueError(f"must be a finite number, got {value}")
        return self.model_copy(update={"value": float(value)})


class ByFormula(Part):
    """A quantity given by a formula, which may use its own `numbers` by name."""

    numbers: dict[Name, FormulaNumber] = {}
