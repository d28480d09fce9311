"""Pictures of elements over their coefficient of friction: their curves are the textbook's formulas."""

import math

import numpy as np
import pytest
from element_samples import BELT, GUIDE, INCLINE, JACK, JOURNAL, WEDGE, scene

from sweeps.pictures.elements.element_pictures import element_pictures
from sweeps.pictures.elements.friction_sheet import friction_sheet
from sweeps.pictures.style import new_figure


def curves(element) -> dict:
    figure = friction_sheet(scene(it=element).elements["it"], new_figure(180, 80), "it")
    return {line.get_label(): np.array(line.get_data()) for ax in figure.axes for line in ax.get_lines()}


def test_belt__its_tensions_are_eytelweins():
    drawn = curves(BELT)
    friction, ratio = drawn["tension ratio"]
    assert friction[-1] == pytest.approx(0.6)
    assert ratio == pytest.approx(np.exp(friction * 3.0), rel=1e-12)
    # In kN, as the shaft bears more than one at the friction given.
    assert drawn["slack tension"][1] == pytest.approx(0.9 / ratio, rel=1e-12)


def test_incline__its_efficiency_is_that_of_the_plane():
    friction, efficiency = curves(INCLINE)["efficiency"]
    # Of a pull along the plane: tan α / (tan α + μ).
    assert efficiency == pytest.approx(math.tan(0.35) / (math.tan(0.35) + friction), rel=1e-12)


def test_guide__its_curves_end_where_it_jams():
    friction, force = curves({**GUIDE, "overhang": 0.4, "load": 0.0})["drive force"]
    # A slider of length l pushed at an overhang h jams from l/(2h) on.
    assert (np.isnan(force) == (friction >= 0.25)).all()


def test_pictures__of_these_elements_and_no_journal(tmp_path):
    machine = scene(jack=JACK, drive=BELT, key=WEDGE, ramp=INCLINE, way=GUIDE, pin=JOURNAL)
    made = element_pictures(machine, tmp_path / "m.png")
    assert [path.name for path in made] == [
        f"m_{name}_friction.png" for name in ("jack", "drive", "key", "ramp", "way")
    ]
    assert all(path.stat().st_size > 0 for path in made)
