"""Hodographs of shaking forces: what they show is what the engine computes, and what can't be shown is said."""

import machines
import numpy as np
import pytest
from each_case import refusals
from machines import crank, rrp

from engine import Machine, Scene, balance
from sweeps.pictures.machine.hodographs import hodographs, order_sizes, shaking_force


def slider_crank(**parts) -> Scene:
    usual = {"title": "Engine", "input": crank(revolutions=2)}
    usual |= {"bodies": {"piston_body": {"link": "piston", "mass": 2000.0}}}
    return Scene.model_validate(machines.slider_crank(rod=1.2, slider="piston", **usual | parts))


def test_orders__are_those_of_the_engine():
    names = [f"shaking_force.order_{n}" for n in (1, 2, 4)]
    web = {"link": "crank", "mass": 900.0, "x": 0.2, "y": 0.1}
    scene = slider_crank(bodies={"piston_body": {"link": "piston", "mass": 2000.0}, "web": web})
    outcome = Machine(scene, names).evaluate({})
    expected = [outcome.summaries[name][0] for name in names]
    sizes = order_sizes(shaking_force(scene, "it"), 2)
    # Two ways of summing 720 terms.
    np.testing.assert_allclose(sizes[[0, 1, 3]], expected, rtol=0, atol=1e-13 * expected[0])


def test_picture__shows_closed_loops_and_bars_of_both_machines():
    before = slider_crank()
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
    lambda parts: hodographs({"it": slider_crank(**parts)}),
    ({"input": crank(start=0.0, stop=1.0)}, "no hodograph of it: it needs a crank that turns fully"),
    ({"groups": {"g": rrp("B", ("rod", "A", 0.2), "piston", "way")}}, "no hodograph of it: a group can't be assembled"),
)
