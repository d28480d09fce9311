"""Units as an engineer reads them."""

import math

import numpy as np
import pytest
from each_case import each

from engine import display_unit, figure_text, quantity_text


@each(
    "units, largest, factor, label",
    [
        ("m", 0.25, 1e3, "mm"),
        ("rad", 3.0, 180 / math.pi, "°"),
        ("rad s-1", 100.0, 30 / math.pi, "rpm"),
        ("N", -1.2e4, 1e-3, "kN"),
        ("N m", 2.5e3, 1e-3, "kN·m"),
        ("kg", 0.02, 1e3, "g"),
        ("Pa", 6e5, 1e-3, "kPa"),
        ("1", 0.3, 1.0, "1"),
    ],
)
def test_engineer_unit__as_on_a_drawing(units, largest, factor, label):
    found, text = display_unit(units, np.array([0.0, largest, np.nan]))
    assert found == pytest.approx(factor)
    assert text == label


@each(
    "value, error, shown",
    [
        (66.34, 0.41, "66.3 ± 0.4"),
        (0.0731, 0.012, "0.07 ± 0.01"),
        (99.96, 0.095, "100.0 ± 0.1"),
        (1234.6, 80.0, "1230 ± 80"),
        (-0.2, 0.7, "-0.2 ± 0.7"),
        (-0.2, 3.0, "0 ± 3"),
        (2.4e-7, 3.1e-5, "0 ± 3e-05"),
        (1.503e-9, 2e-11, "1.50e-09 ± 2e-11"),
        (120.0, 4e-13, "120"),
        (1 / 3, None, "0.33333"),
        (1 / 3, math.nan, "0.33333"),
        (0.0, 1e-5, "0 ± 1e-05"),
    ],
)
def test_figure__has_no_digits_beyond_its_error(value, error, shown):
    assert figure_text(value, error, 5) == shown


def test_quantity__is_rounded_in_the_unit_shown():
    assert quantity_text(0.12345, "m", 0.0004) == "123.5 ± 0.4 mm"
    assert quantity_text(math.nan, "m", 0.0004) == "–"
