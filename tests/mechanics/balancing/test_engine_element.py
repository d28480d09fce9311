"""Engines as elements of a scene, and the table of their orders."""

import math
import re

import numpy as np
import pytest
from each_case import refusals

from engine import ElementsAlone, Scene, Verdict
from engine.elements.engines.harmonics import piston_harmonics
from sweeps.report.order_table import order_table, well_known_engines
from sweeps.text.scene_text import scene_from
from sweeps.text.toml_text import parse_toml

TWIN = {
    "type": "engine",
    "layout": "V",
    "cylinders": 2,
    "bank_angle": "90 deg",
    "stroke": "80 mm",
    "rod": "130 mm",
    "piston_mass": "400 g",
    "rod_mass": "450 g",
    "rod_centre": "40 mm",
    "throw_mass": "500 g",
    "balanced_reciprocating": 0.5,
    "speed": "6000 rpm",
}


def asked(element, names, **varied):
    scene = Scene.model_validate({"elements": {"it": element}})
    paths = {f"elements.it.{key}": np.atleast_1d(values) for key, values in varied.items()}
    return ElementsAlone(scene, [f"it.{name}" for name in names], varied=paths).evaluate(paths)


def test_elements_of_all_layouts__are_evaluated_in_a_scene_from_text():
    text = "\n".join(
        f"""
[elements.{name}]
type = "engine"
{keys}
spacing = "100 mm"
stroke = "80 mm"
rod = "140 mm"
piston_mass = "400 g"
speed = "3000 rpm"
"""
        for name, keys in {
            "four": 'layout = "in-line"\ncylinders = 4',
            "flat": 'layout = "V"\ncylinders = 8\nbank_angle = "90 deg"\n'
            'throws = ["0 deg", "180 deg", "180 deg", "0 deg"]',
            "arrow": 'layout = "W"\ncylinders = 12\nbank_angle = "60 deg"',
            "beetle": 'layout = "boxer"\ncylinders = 4',
            "star": 'layout = "radial"\ncylinders = 9\nbalanced_reciprocating = 0.5',
        }.items()
    )
    scene = scene_from(parse_toml(text, "engines.toml"), text, "engines.toml", None)
    names = [f"{n}.{q}" for n in scene.elements for q in ("primary_force", "secondary_force", "secondary_couple")]
    outcome = ElementsAlone(scene, names).evaluate({})
    assert outcome.status[0] == Verdict.OK
    unit = 0.4 * 0.04 * (100 * math.pi) ** 2 * piston_harmonics(40 / 140, (2,)).real[0]
    found = {name: float(value[0]) / unit for name, value in outcome.summaries.items() if value[0] != 0}
    expected = {"four.secondary_force": 4, "flat.secondary_force": 4 * math.sqrt(2), "arrow.secondary_force": 6}
    assert found == pytest.approx({**expected, "beetle.secondary_couple": 0.2}, rel=1e-13)


def test_element_whose_crank_cannot_turn__has_a_verdict():
    outcome = asked(TWIN, ["primary_force"], stroke=np.array([0.08, 0.26, 0.3]))
    assert outcome.status.tolist() == [Verdict.OK, Verdict.NOT_FINITE, Verdict.NOT_FINITE]
    assert np.isnan(outcome.summaries["it.primary_force"][1:]).all()


test_element_that_cannot_be__is_refused = refusals(
    lambda changes: Scene.model_validate({"elements": {"it": {**TWIN, **changes}}}),
    ({"layout": "in-line"}, "bank_angle goes with layout = 'V' or 'W'; the layout is 'in-line'"),
    ({"cylinders": 3}, "3 cylinders can't stand in 2 banks"),
    ({"throws": [0.0, 1.0]}, "2 throws are given; this layout has 1"),
    ({"rod": "30 mm"}, "it must be longer than half the stroke, 40 mm"),
    ({"layout": "radial", "bank_angle": None, "throws": [0.0]}, "throws goes with layout … the layout is 'radial'"),
)


# Tables and pictures


def test_order_table__says_what_a_student_expects():
    table = order_table(well_known_engines())
    rows = [re.split(" {2,}", line) for line in table.splitlines()]
    lines = {row[0]: " | ".join(row[1:]) for row in rows}
    assert lines["in-line 4"].startswith("180° | 0 | 4 line | 0 | 0 | ")
    assert lines["in-line 4"].endswith("| 2, 4, 6")
    assert lines["single cylinder"].endswith("| 0.5, 1, 1.5, 2 …")
    assert lines["in-line 6"].startswith("120° | 0 | 0 | 0 | 0 | force 6")
    assert "| 0 | 0 | 3.162 ↺ | 0 |" in lines["V8 90° cross-plane"]
    assert "| 0 | 0 | 0.449 line | 4.98 line |" in lines["in-line 5"]
    assert lines["V6 90°, 3 throws"].startswith("150/90° |")
    assert "4.5 ↺ | 0 | 0 | 0 | 0 | 4.5" in lines["radial 9"]
    assert rows[0][:3] == ["engine", "firing", "primary force"]
    assert "A₂ = 0.3071" in table
