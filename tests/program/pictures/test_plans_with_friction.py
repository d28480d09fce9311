"""Plans of forces with friction in the pairs: links in equilibrium, friction circles, friction angles, edges."""

import cmath
import math
from functools import cache

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text
from plan_machines import moment_about, rubbing
from rubbing_machines import RHO, press, yoke
from test_plans import assert_closed, assert_in_equilibrium

from engine import Scene
from sweeps.pictures.plans.forces.force_plan import force_lines
from sweeps.pictures.plans.forces.free_body import free_body
from sweeps.pictures.plans.forces.loads import group_loads, loads_on_links
from sweeps.pictures.plans.pose import MachineCycle
from sweeps.pictures.plans.sheets import force_sheet

# All kinds of groups, shafts, both kinds of inputs, guides that move; some sliders tilt.
RUBBING = [("PRP", 0.02), ("turning yoke", None), ("geared five-bar", None), ("sliding input", 0.06)]


@cache
def poses_of(name, length):
    cycle = MachineCycle(rubbing(name, length))
    return [cycle.at(cycle.motion.q[k]) for k in (77, 301, 655)]


def press_at_one(coefficient):
    return MachineCycle(Scene.model_validate(press(coefficient))).at(1.0)


def distance(point, load):
    """Of a point from the line of a force, positive to its left [m]."""
    return ((point - load.at) * load.force.conjugate()).imag / abs(load.force)


# Equilibrium


@pytest.mark.parametrize(("name", "length"), RUBBING)
def test_loads_with_friction__every_link_in_equilibrium_and_every_force_plan_closed(name, length):
    for pose in poses_of(name, length):
        assert_in_equilibrium(pose)
        assert_closed(pose, (*pose.scene.groups, *pose.cycle.structure.links))


def test_force_plan_of_a_group__has_friction_beside_its_reaction():
    pose = poses_of("turning yoke", None)[0]
    assert [load.text for load in group_loads(pose, "h")][-3:] == ["$R_{35}$", r"$F_{\mathrm{f}35}$", "$R_{04}$"]


# Lines of reactions


def test_reactions_of_a_massless_rod__on_one_line_that_touches_both_friction_circles():
    pose = press_at_one(0.15)
    a, b = (pose.motion.points[name][pose.k] for name in "AB")
    at_a, at_b = loads_on_links(pose)["rod"]
    # Radii of some 2 mm as differences of places of some 400 mm.
    roundings = 1000 * np.finfo(float).eps
    assert at_a.force == pytest.approx(-at_b.force, rel=1e-13)
    for load in (at_a, at_b):
        assert abs(distance(a, load)) == pytest.approx(RHO["A"], rel=roundings)
        assert abs(distance(b, load)) == pytest.approx(RHO["B"], rel=roundings)
    assert (at_a.rho, at_b.rho) == pytest.approx((RHO["A"], RHO["B"]), rel=1e-12)
    # The rod turns clockwise on the crank and on the slider: friction turns it the other way.
    assert pose.turn("rod").omega < 0 < pose.turn("crank").omega
    assert distance(a, at_a) > 0
    assert distance(b, at_b) > 0


def test_force_of_a_guide__leans_by_the_friction_angle_against_the_motion():
    f = 0.15
    pose = press_at_one(f)
    own = [load for load in loads_on_links(pose)["ram"] if load.pair == "drive.second"]
    normal, friction = (load for load in own if not load.is_moment)
    assert friction.is_friction
    assert abs(cmath.phase((normal.force + friction.force) / normal.force)) == pytest.approx(math.atan(f), rel=1e-12)
    assert pose.slide("ram")[0] * friction.force.real < 0


def test_short_slider_with_an_overhung_load__bears_on_both_edges():
    f, length = 0.3, 0.12
    pose = MachineCycle(Scene.model_validate(yoke(length, f))).at(1.0)
    front, rear, friction = (load for load in loads_on_links(pose)["yoke"] if load.pair == "g.second")
    assert front.at - rear.at == pytest.approx(length, rel=1e-12)
    assert front.force == pytest.approx(-rear.force, rel=1e-12)
    assert abs(friction.force) == pytest.approx(f * (abs(front.force) + abs(rear.force)), rel=1e-12)
    assert {load.text for load in (front, rear)} == {r"$R^{\prime}_{03}$", r"$R^{\prime\prime}_{03}$"}


def test_long_slider__is_pressed_where_its_moment_puts_the_force():
    pose = MachineCycle(Scene.model_validate(yoke(0.9, 0.1))).at(1.0)
    # Driving force and resistance, a couple with the overhang of the block, lie apart by as much.
    pressing = [load for load in loads_on_links(pose)["yoke"] if load.pair == "g.second" and not load.is_friction]
    driving = next(load for load in loads_on_links(pose)["yoke"] if load.pair == "g.inner")
    assert all(abs(load.at - pose.origin("yoke").place) <= 0.45 * (1 + 1e-12) for load in pressing)
    moment = moment_about(pose.origin("yoke").place, pressing)
    expected = -moment_about(pose.origin("yoke").place, [driving])
    assert moment == pytest.approx(expected, rel=1e-12)


# Drawing


def test_free_body_with_friction__shows_the_friction_circle_to_scale():
    ax = Figure(figsize=(5, 5)).add_axes((0, 0, 1, 1))
    pose = press_at_one(0.15)
    loads = free_body(pose, "rod", ax)
    circles = [line for line in ax.lines if len(line.get_xdata()) == 49]
    radii = sorted((np.ptp(line.get_xdata()) + np.ptp(line.get_ydata())) / 4 for line in circles)
    assert radii == pytest.approx([RHO["B"], RHO["A"]], rel=1e-12)
    assert force_lines(loads)[1] == r"$\rho_{12}$ = 3 mm"


def test_force_sheet_with_friction__says_what_its_letters_mean():
    pose = press_at_one(0.15)
    notes = [text.get_text() for text in force_sheet(pose, "drive").findobj(Text)]
    assert any(r"\rho_{12}$: radius of the friction circle" in note for note in notes)
