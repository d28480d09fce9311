"""One machine by NumPy against compiled code: fields of machines of all kinds, whatever its parts are called."""

import math

import numpy as np
import pytest
from machines import crank, frame, rrp, slider_crank

from engine import Machine, MovingMachine, Scene, Verdict
from sweeps.study.bundled import STUDIES
from sweeps.text.scene_text import read_scene
from sweeps.text.templates import template_text

# Of them all: tables and formulas of loads, cylinders, friction that tilts sliders, cams, non-circular wheels, gears,
# free links, sliding inputs.
SCENES = ("crank_press", "stirling_engine", "toggle_press", "valve_gear", "elliptical_wheels", "dwelling_triad")
POSITIONS = 360


@pytest.fixture(scope="module", params=SCENES)
def both(request):
    scene = read_scene(next(STUDIES.glob(f"*/scenes/{request.param}.toml")))
    moving = MovingMachine(scene, positions=POSITIONS)
    # Neighbours are of one kind, such as x and y of a point: of each machine others are asked.
    fields = list(moving.register.fields)[-SCENES.index(request.param) % 3 :: 3]
    return moving, Machine(scene, fields=fields, positions=POSITIONS).evaluate({})


def test_fields__are_those_of_compiled_code_to_rounding(both):
    moving, outcome = both
    fields = moving.register.fields
    rows, compiled = moving.fields(fields), {name: row[0] for name, row in outcome.fields.items()}
    # A derivative by an angle has the unit of what it is of.
    units = {name: field.units.removesuffix(" rad-1") for name, field in fields.items()}
    peaks: dict[str, float] = {}
    for name, row in rows.items():
        peak = np.abs(row[np.isfinite(row)]).max(initial=0.0)
        peaks[units[name]] = max(peak, peaks.get(units[name], 0.0))
    for name, row in compiled.items():
        # A force that vanishes is rounding of those that don't, some hundreds of operations old. Works and speeds come
        # from two integrations, each to 1e-9 of its peak or better.
        share = 1e-9 if name in ("work", "speed") else 1e-11
        with np.errstate(invalid="ignore"):
            gap = rows[name] - row
        # A direction that turns back within a step turned either way.
        gap = gap - math.tau * np.round(gap / math.tau) if units[name] == "rad" else gap
        # An inertia force that vanishes but for rounding has its line of action anywhere.
        known = np.isfinite(gap) if name.endswith("inertia_offset") else np.isfinite(row)
        np.testing.assert_allclose(gap[known], 0.0, rtol=0, atol=share * peaks[units[name]], err_msg=name)
        assert np.isfinite(rows[name][known]).all()


def test_verdict__is_that_of_compiled_code(both):
    moving, outcome = both
    assert moving.verdict(outcome.fields) == Verdict(int(outcome.status[0]))


@pytest.mark.parametrize(
    ("values", "verdict"),
    [
        ({}, Verdict.OK),
        # The rod is shorter than the crank, as long, or of negative length.
        ({"groups.g.first.length": 0.03}, Verdict.CANNOT_ASSEMBLE),
        ({"groups.g.first.length": 0.05}, Verdict.SINGULAR),
        ({"groups.g.first.length": -0.2}, Verdict.OUTSIDE_LIMITS),
    ],
)
def test_verdict__says_why_a_slider_crank_has_no_fields(values, verdict):
    moving = MovingMachine(Scene.model_validate(slider_crank(0.05, 0.2)), values)
    assert moving.verdict(["B.x", "B.vx"]) == verdict
    assert np.isfinite(moving.fields(["B.x"])["B.x"]).all() == (verdict in (Verdict.OK, Verdict.SINGULAR))


@pytest.mark.parametrize("name", ["way", "O"])
def test_group_named_as_a_guide_or_a_point__moves_as_under_any_name(name, tmp_path):
    path, found = tmp_path / "scene.toml", []
    text = template_text("scotch_yoke")
    assert "[groups.drive" in text
    for changed in (text, text.replace("[groups.drive", f"[groups.{name}")):
        path.write_text(changed)
        found.append(Machine(read_scene(path), ["yoke.stroke"]).evaluate({}).summaries["yoke.stroke"][0])
    assert found[0] == found[1] == pytest.approx(0.1, rel=1e-12)


def test_rod_to_a_slot_in_the_crank__has_to_span_the_distance_of_the_slots_line():
    length, offset, tilt, q = 0.02, 0.05, 0.4, 1.1
    data = {"points": {"O": frame(0.0, 0.0), "C": frame(0.3, 0.1)}, "input": crank(length=0.1)}
    data["guides"] = {"slot": {"link": "crank", "x": 0.03, "y": 0.02, "angle": tilt}}
    data["groups"] = {"g": rrp("B", ("rod", "C", length), "block", "slot", offset)}
    # Seen from the crank: C turned back by q.
    seen = (0.3 + 0.1j) * np.exp(-1j * q) - (0.03 + 0.02j)
    found = MovingMachine(Scene.model_validate(data), positions=[q]).dyad_gap("g")
    assert found.distance[0] == pytest.approx(abs((seen * np.exp(-1j * tilt)).imag - offset), rel=1e-12)
    assert found[1:] == (0.0, length)
