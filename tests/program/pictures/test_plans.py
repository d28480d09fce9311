"""Plans as numbers: vectors against derivatives of positions, polygons that close, links in equilibrium."""

import math
from functools import cache

import numpy as np
import pytest
from each_case import each
from matplotlib.figure import Figure
from matplotlib.text import Text
from plan_machines import (
    CLOSED,
    EVERY,
    EXACT,
    FREE,
    HIGHER,
    assert_in_equilibrium,
    assert_legs_meet,
    largest,
    motion_of,
    poses,
    rubbing,
)
from rubbing_machines import RHO, press, yoke

from engine import Scene
from sweeps.pictures.drawing import DrawnMotion
from sweeps.pictures.plans.files import plan_pictures
from sweeps.pictures.plans.forces.force_plan import force_lines, force_polygon
from sweeps.pictures.plans.forces.free_body import free_body
from sweeps.pictures.plans.forces.loads import group_loads, loads_on_links
from sweeps.pictures.plans.polygons import accelerations, velocities
from sweeps.pictures.plans.pose import pose_at
from sweeps.pictures.plans.sheets import force_sheet

# Derivatives by Fourier series of 720 points: a rounding of the positions, 1e-16 of the mechanism's size (at most ten
# cranks), is multiplied by the highest order, 360, once or twice, and summed over as many.
BY_FOURIER = 10 * 1e-16 * 360**2 * math.sqrt(360)


# Velocities and accelerations


@each("name", EVERY)
@each("plan_of", [velocities, accelerations])
def test_legs__meet_in_the_images_of_points(name, plan_of):
    for pose in poses(name):
        plan = plan_of(pose)
        assert_legs_meet(plan)
        for leg in plan.legs:
            start, end = (point.rstrip("'") for point in (leg.start, leg.end))
            kinds = [step.kind for step in leg.steps]
            if "tangential" in kinds and name not in FREE:
                # Along the bar and across it, so that their sum leaves no choice.
                arm = np.subtract(*(plan.places[n] if n in plan.places else pose.point(n).place for n in (end, start)))
                (normal, tangential), room = (step.vector for step in leg.steps), EXACT * largest(plan) * abs(arm)
                assert kinds == ["normal", "tangential"]
                assert (normal * arm.conjugate()).real <= 0
                assert max(abs((normal * arm.conjugate()).imag), abs((tangential * arm.conjugate()).real)) < room
            # What touches where wheels roll has no other acceleration against each other.
            assert leg.start != f"{end}'" or end not in plan.places or end[0] != "P" or kinds == ["normal"]
        # A second way to a point is what makes the plan a polygon: every group has one, every shaft its own.
        assert len(plan.legs) >= (name != "drum") + 2 * len(pose.scene.groups) + len(pose.scene.links)


@each("name", CLOSED)
def test_images__derivatives_of_positions_by_fourier(name):
    motion = motion_of(name)
    turns = motion.scene.input.revolutions
    orders = 1j * np.fft.fftfreq(motion.q.size, 1 / motion.q.size) / turns
    crank_length = motion.numbers.get("input.length", 0.0)
    for pose in poses(name):
        for order, plan in ((1, velocities(pose)), (2, accelerations(pose))):
            for point, image in plan.images.items():
                if point not in motion.points:
                    continue
                rate = np.fft.ifft(orders**order * np.fft.fft(motion.points[point]))[pose.k] * motion.omega**order
                assert abs(image - rate) < BY_FOURIER * crank_length * abs(motion.omega) ** order


@each("name", EVERY)
def test_places_of_links__move_as_their_points(name):
    for pose in poses(name):
        for point, part in pose.scene.points.items():
            found, expected = pose.rigid(part.link, pose.point(point).place), pose.point(point)
            assert abs(found.v - expected.v) <= EXACT * largest(velocities(pose))
            assert abs(found.a - expected.a) <= EXACT * largest(accelerations(pose))


def test_coriolis_step_of_the_quick_return__twice_turn_times_sliding():
    motion = motion_of("quick return")
    arm = motion.points["A"] - motion.points["D"]
    orders = 1j * np.fft.fftfreq(arm.size, 1 / arm.size)

    def rate(row):
        return np.fft.ifft(orders * np.fft.fft(row)).real * motion.omega

    # The lever points up throughout: its angle from the y axis has no jump.
    turn, sliding = rate(np.angle(arm / 1j)), rate(np.abs(arm))
    for pose in poses("quick return"):
        (leg,) = [leg for leg in accelerations(pose).legs if (leg.start, leg.end) == ("A'", "A")]
        expected = 2j * (turn * sliding * arm / np.abs(arm))[pose.k]
        assert [step.kind for step in leg.steps] == ["coriolis", "relative"]
        assert abs(leg.steps[0].vector - expected) < BY_FOURIER * 0.11 * 6.0**2


def test_link_of_three_points__is_a_triangle_of_its_images():
    pose = pose_at(motion_of("four-bar"), 1.0)
    assert velocities(pose).links == accelerations(pose).links == (("A", "B", "P"),)


# Forces


def assert_closed(pose, parts):
    """Plans of forces of groups or links."""
    for part in parts:
        forces = [load.force for load in force_polygon(pose, part)]
        assert abs(sum(forces)) <= EXACT * max(map(abs, forces), default=0.0)


@each("name", EVERY)
def test_loads__every_link_in_equilibrium_and_every_force_plan_closed(name):
    for pose in poses(name):
        assert_in_equilibrium(pose)
        assert_closed(pose, [*pose.scene.groups, *pose.motion.structure.free_groups])


def test_force_plan_of_a_group__without_its_inner_pair_and_reactions_last():
    pose = pose_at(motion_of("slider_crank"), 1.0)
    loads = group_loads(pose, "drive")
    assert [load.text for load in loads] == [f"${s}$" for s in ("G_{2}", "U_{2}", "G_{3}", "U_{3}", "R_{03}", "R_{12}")]


# Wheels, racks, cams and second inputs: places followed as positions alone show them, known polygons


# Weights of derivatives at the middle of nine nodes (B. Fornberg, 1988).
FIRST = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
SECOND = np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560])


def link_of(pose, plan, name):
    """The link that an image is of: it is told of one under another's point, the rest have its number."""
    if name in plan.under:
        return plan.under[name]
    number = int(name[1:])
    (link,) = [link for link, n in pose.motion.link_numbers.items() if n == number]
    cams = {cam.follower.link: cam.on for cam in pose.scene.cams.values()}
    return cams[link] if name[0] == "C" else link


@pytest.mark.parametrize("name", HIGHER)
def test_images_of_contacts__as_their_links_carry_them(name):
    """A place kept in the axes of a link is followed over nine nodes, by their positions alone."""
    checked = 0
    motion = motion_of(name)
    # None of them within four nodes of where a section of a cam's law ends.
    for k in (77, 260, 640):
        pose = pose_at(motion, motion.q[k])
        around = np.arange(k - 4, k + 5)
        step = motion.q[1] - motion.q[0]
        for order, weights, plan in ((1, FIRST, velocities(pose)), (2, SECOND, accelerations(pose))):
            for image, vector in plan.images.items():
                if image.rstrip("'") not in plan.places:
                    continue
                origin, along = motion.axes[link_of(pose, plan, image)]
                kept = (plan.places[image.rstrip("'")] - origin[k]) / along[k]
                path = origin[around] + kept * along[around]
                rate = (weights @ path) * (motion.omega / step) ** order
                # Links 0.3 m about move with parts of seven periods in a turn at most: ninth and tenth derivatives of
                # those leave a step⁸ 7⁹/630 and a step⁸ 7¹⁰/3150. A rounding of 1e-16 is divided by the step once or
                # twice.
                far = max(abs(path)) + 0.3
                left = step**8 * 7.0**9 / 630 * (7 / 5) ** (order - 1) + 40 * 1e-16 / step**order
                assert abs(vector - rate) < left * far * motion.omega**order, image
                checked += 1
    assert checked >= 6


def test_plan_pictures__a_sheet_of_forces_for_what_a_cam_drives(tmp_path, blank_pictures):
    made = [path.name for path in plan_pictures(HIGHER["roller"], tmp_path / "a.svg", 1.0)]
    assert made == [
        "a_velocity.svg", "a_acceleration.svg", "a_forces_crank.svg", "a_forces_tappet.svg", "a_reactions.svg",
        "a_bearing_input.svg",
    ]  # fmt: skip


# Friction in the pairs: links in equilibrium, friction circles, friction angles, edges


# All kinds of groups, shafts, both kinds of inputs, guides that move; some sliders tilt.
RUBBING = [("PRP", 0.02), ("turning yoke", None), ("geared five-bar", None), ("sliding input", 0.06)]


@cache
def poses_of(name, length):
    motion = DrawnMotion(rubbing(name, length))
    return [pose_at(motion, motion.q[k]) for k in (77, 301, 655)]


def press_at_one(coefficient):
    return pose_at(Scene.model_validate(press(coefficient)), 1.0)


# Equilibrium


@pytest.mark.parametrize(("name", "length"), RUBBING)
def test_loads_with_friction__every_link_in_equilibrium_and_every_force_plan_closed(name, length):
    for pose in poses_of(name, length):
        assert_in_equilibrium(pose)
        assert_closed(pose, (*pose.scene.groups, *pose.motion.structure.links))


def test_force_plan_of_a_group__has_friction_beside_its_reaction():
    pose = poses_of("turning yoke", None)[0]
    assert [load.text for load in group_loads(pose, "h")][-3:] == ["$R_{35}$", r"$F_{\mathrm{f}35}$", "$R_{04}$"]


# Lines of reactions


def test_short_slider_with_an_overhung_load__bears_on_both_edges():
    f, length = 0.3, 0.12
    pose = pose_at(Scene.model_validate(yoke(length, f)), 1.0)
    front, rear, friction = (load for load in loads_on_links(pose)["yoke"] if load.pair == "g.second")
    assert front.at - rear.at == pytest.approx(length, rel=1e-12)
    assert front.force == pytest.approx(-rear.force, rel=1e-12)
    assert abs(friction.force) == pytest.approx(f * (abs(front.force) + abs(rear.force)), rel=1e-12)
    assert {load.text for load in (front, rear)} == {r"$R^{\prime}_{03}$", r"$R^{\prime\prime}_{03}$"}


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
