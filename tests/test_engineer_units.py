"""Units as an engineer reads them."""

import math

import numpy as np
import pytest

from sweeps.engineer_units import engineer_unit


@pytest.mark.parametrize(
    ("units", "largest", "factor", "label"),
    [
        ("m", 0.25, 1e3, "mm"),
        ("m", 12.0, 1.0, "m"),
        ("rad", 3.0, 180 / math.pi, "°"),
        ("rad s-1", 100.0, 30 / math.pi, "rpm"),
        ("N", 900.0, 1.0, "N"),
        ("N", -1.2e4, 1e-3, "kN"),
        ("N m", 2.5e3, 1e-3, "kN·m"),
        ("kg m2", 0.5, 1.0, "kg·m²"),
        ("kg", 0.02, 1e3, "g"),
        ("Pa", 6e5, 1e-3, "kPa"),
        ("W", 3e6, 1e-6, "MW"),
        ("1", 0.3, 1.0, "1"),
    ],
)
def test_engineer_unit__as_on_a_drawing(units, largest, factor, label):
    found, text = engineer_unit(units, np.array([0.0, largest, np.nan]))
    assert found == pytest.approx(factor)
    assert text == label
