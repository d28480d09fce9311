"""Diagrams of one machine: the engine's rows, Wittenbauer's tangents, dead centres, motion, shaking forces."""

import math
from xml.etree import ElementTree

import machines
import numpy as np
import pytest
from drawn_machines import four_bar, scotch_yoke, slider_crank, sliding_input
from each_case import refusals
from machines import crank, frame, rrp

from engine import Machine, MovingMachine, Scene, balance, quantity_text
from sweeps import read_scene
from sweeps.pictures.machine.cycle_sheets import indicator_diagrams, motion_of_part
from sweeps.pictures.machine.diagrams import diagrams
from sweeps.pictures.machine.hodographs import hodographs, order_sizes, shaking_force
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import save
from sweeps.text.templates import bundled_templates

AIR = {"type": "compressor", "piston": "piston", "bore": 0.09, "clearance": 0.06, "suction": 1e5, "discharge": 6e5}
COMPRESSOR = slider_crank(title="Compressor", cylinders={"air": AIR}, flywheel={"speed_fluctuation": 0.04})


def test_diagrams__six_panels_with_the_engine_s_rows(tmp_path):
    figure = diagrams(COMPRESSOR)
    save(figure, tmp_path / "a.svg")
    ElementTree.parse(tmp_path / "a.svg")
    assert len(figure.axes) == 6
    fields = ["reduced_inertia", "reduced_inertia_phi", "reduced_moment", "work", "speed"]
    names = ["flywheel_wittenbauer", "speed_fluctuation"]
    outcome = Machine(COMPRESSOR, summaries=names, fields=fields).evaluate({})
    for axes, name in zip([figure.axes[i] for i in (0, 1, 2, 3, 5)], fields, strict=True):
        line = axes.lines[0]
        factor = 30 / math.pi if name == "speed" else 1.0
        row = factor * outcome.fields[name][0]
        # Works and speeds follow from integrals by two codes, each to 1e-9 of its peak or better.
        assert line.get_ydata()[:-1] == pytest.approx(row, abs=1e-9 * np.abs(row).max(), rel=0)
        assert line.get_ydata()[-1] == line.get_ydata()[0]
        assert line.get_xdata()[[0, -1]] == pytest.approx([0, 360])
    # As in the text, to the last digit.
    wheel, delta = (float(outcome.summaries[name][0]) for name in names)
    assert figure.axes[4].get_title() == f"Energy loop: required flywheel {quantity_text(wheel, 'kg m2')}"
    mean = quantity_text(COMPRESSOR.input.speed, "rad s-1")
    title = figure.axes[5].get_title().replace("\N{NO-BREAK SPACE}", " ")
    assert title == f"δ = {quantity_text(delta, '1')}, mean {mean}"


def test_mean_moment__is_that_of_the_cycle_where_the_load_jumps():
    """10 N m over 100.2 of 360 degrees; the mean of rows half a degree apart would be that of 100 or 100.5."""
    load = {"type": "formula", "on": "crank", "moment": "-m if phi > begin and phi < end else 0 * m"}
    load["numbers"] = {"m": "10 N m", "begin": "100.1 deg", "end": "200.3 deg"}
    figure = diagrams(four_bar(moments={"load": load}))
    title = figure.axes[2].get_title().replace("\N{NO-BREAK SPACE}", " ")
    assert f"mean \N{MINUS SIGN}{10 * 100.2 / 360:.5g} N" in title


def test_tangents__touch_the_loop_from_outside_with_the_slopes_of_the_speeds():
    axes = diagrams(COMPRESSOR).axes[4]
    loop, _, upper, _, lower, _ = axes.lines
    inertia, work = loop.get_data()
    for line, sign in ((upper, 1), (lower, -1)):
        (x0, x1), (y0, y1) = line.get_data()
        slope = (y1 - y0) / (x1 - x0)
        assert slope == pytest.approx(0.5 * 6.0**2 * (1 + sign * 0.02) ** 2)
        above = sign * (y0 + slope * (inertia - x0) - work)
        assert above.min() == pytest.approx(0, abs=1e-9 * np.ptp(work))


def test_loop__has_its_angles_within_the_axes_and_clear_of_the_curve():
    for scene in (COMPRESSOR, read_scene(bundled_templates()["crank_shaper"])):
        figure = diagrams(scene)
        figure.draw_without_rendering()
        axes = figure.axes[4]
        seen, loop = axes.get_window_extent(), axes.transData.transform(axes.lines[0].get_xydata())
        boxes = [text.get_window_extent() for text in axes.texts if text.get_text()]
        assert len(boxes) == 4
        for box in boxes:
            assert seen.x0 <= box.x0 < box.x1 <= seen.x1
            assert seen.y0 <= box.y0 < box.y1 <= seen.y1
            assert not any(box.contains(*point) for point in loop)
            assert not any(box.overlaps(other) for other in boxes if other is not box)


def test_rounding__is_drawn_as_zero():
    """A constant torque does no work in excess."""
    load = {"type": "constant", "on": "crank", "moment": -1962.0}
    figure = diagrams(Scene.model_validate({"points": {"O": frame(0, 0)}, "input": crank(), "moments": {"load": load}}))
    assert not figure.axes[3].lines[0].get_ydata().any()
    assert figure.axes[3].get_ylim() == (-1, 1)


def test_diagrams_without_cycle__four_panels_over_the_displacement():
    figure = diagrams(sliding_input())
    assert len(figure.axes) == 4
    assert figure.axes[0].get_xlabel() == "displacement of rack q, mm"
    assert figure.axes[0].lines[0].get_xdata()[[0, -1]] == pytest.approx([0, 120])


def test_diagrams_without_flywheel__speed_left_out_with_the_reason():
    figure = diagrams(four_bar())
    assert "no flywheel" in figure.axes[5].texts[0].get_text()


def test_diagrams_of_a_machine_that_cannot_be_assembled__refused():
    with pytest.raises(PictureError, match="can't be assembled"):
        diagrams(MovingMachine(COMPRESSOR, {"groups.g.first.length": 0.01}))


@pytest.mark.parametrize(
    ("changes", "panels"),
    [
        ({"forces.p.force": 1e308, "input.length": 1e3, "groups.g.first.length": 4e3}, {2, 3, 4}),
        ({"forces.p.force": 1e308}, {2, 3, 4}),
        ({"bodies.piston.mass": 1e300, "input.speed": 1e200}, {4}),
        ({"bodies.rod.inertia": 1e308}, {0}),
    ],
)
def test_diagrams_of_what_is_not_finite__say_so_in_place_of_its_panels(changes, panels, tmp_path):
    punch = {"type": "constant", "on": "B", "force": 1e4, "angle": 3.0, "acts": "against"}
    scene = slider_crank(forces={"p": punch}, flywheel={"speed_fluctuation": 0.04})
    figure = diagrams(MovingMachine(scene, changes))
    save(figure, tmp_path / "a.png")
    told = {i for i, axes in enumerate(figure.axes) if any("undefined" in text.get_text() for text in axes.texts)}
    assert told >= panels


def shaken_engine(**parts) -> Scene:
    usual = {"title": "Engine", "input": crank(revolutions=2)}
    usual |= {"bodies": {"piston_body": {"link": "piston", "mass": 2000.0}}}
    return Scene.model_validate(machines.slider_crank(rod=1.2, slider="piston", **usual | parts))


def test_orders__are_those_of_the_engine():
    names = [f"shaking_force.order_{n}" for n in (1, 2, 4)]
    web = {"link": "crank", "mass": 900.0, "x": 0.2, "y": 0.1}
    scene = shaken_engine(bodies={"piston_body": {"link": "piston", "mass": 2000.0}, "web": web})
    outcome = Machine(scene, names).evaluate({})
    expected = [outcome.summaries[name][0] for name in names]
    sizes = order_sizes(shaking_force(scene, "it"), 2)
    # Two ways of summing 720 terms.
    np.testing.assert_allclose(sizes[[0, 1, 3]], expected, rtol=0, atol=1e-13 * expected[0])


def test_picture__shows_closed_loops_and_bars_of_both_machines():
    before = shaken_engine()
    after = balance(before, ["crank"], criterion="rms").scene
    figure = hodographs({"before": before, "after": after})
    left, right = figure.axes
    loops = [line for line in left.get_lines() if line.get_label() in ("before", "after")]
    for loop, scene in zip(loops, (before, after), strict=True):
        x, y = loop.get_data()
        force = shaking_force(scene, "it") / 1e3
        assert (x[0], y[0]) == (x[-1], y[-1])
        # Of the order of 10 kN, shown in kN.
        np.testing.assert_allclose(x[:-1] + 1j * y[:-1], force, rtol=1e-14)
    bars = [[bar.get_height() for bar in group] for group in right.containers]
    assert [group.get_label() for group in right.containers] == ["before", "after"]
    # Half of the first order turns with the crank.
    assert bars[1][0] == pytest.approx(bars[0][0] / 2, rel=1e-12)
    assert bars[1][1:] == pytest.approx(bars[0][1:], abs=1e-12 * bars[0][0])
    assert figure.get_suptitle() == "Engine: shaking force"


test_machine_without_a_hodograph__is_said = refusals(
    lambda parts: hodographs({"it": shaken_engine(**parts)}),
    ({"input": crank(start=0.0, stop=1.0)}, "no hodograph of it: it needs a crank that turns fully"),
    ({"groups": {"g": rrp("B", ("rod", "A", 0.2), "piston", "way")}}, "no hodograph of it: a group can't be assembled"),
)


def test_area_of_an_indicator_diagram__is_the_indicated_work():
    scene = slider_crank(cylinders={"air": AIR})
    figure = indicator_diagrams(MovingMachine(scene))
    volume, pressure = figure.axes[0].lines[0].get_data()
    # In cm³ and kPa, by trapezia between 720 positions.
    area = 1e-3 * abs(np.sum(0.5 * (pressure[1:] + pressure[:-1]) * np.diff(volume)))
    outcome = Machine(scene, summaries=["air.indicated_work"]).evaluate({})
    assert area == pytest.approx(outcome.summaries["air.indicated_work"][0], rel=1e-3)
    assert f"air: {outcome.summaries['air.indicated_work'][0]:.5g} J" in figure.axes[0].get_title()


def test_scotch_yoke__has_the_jerk_of_a_cosine():
    scene = scotch_yoke()
    radius, speed = scene.input.length, scene.input.speed
    figure = motion_of_part(MovingMachine(scene), "yoke")
    angle, jerk = figure.axes[3].lines[0].get_data()
    phi = np.radians(angle) - scene.guides["way"].angle
    assert np.abs(jerk) == pytest.approx(np.abs(radius * speed**3 * np.sin(phi)), abs=1e-8 * radius * speed**3)
    assert [line.get_ydata().size for ax in figure.axes for line in ax.lines] == [721] * 4


def test_part_that_is_none__is_refused_with_those_there_are():
    with pytest.raises(PictureError, match=r"'bar' is not a slider or link of this machine; choose from: .*piston"):
        motion_of_part(MovingMachine(slider_crank()), "bar")
