"""Plans as numbers: vectors against derivatives of positions, polygons that close, links in equilibrium."""

import math

import numpy as np
import pytest
from drawn_machines import slider_crank
from each_case import each
from plan_machines import CLOSED, HIGHER, MACHINES, cycle_of, moment_about, poses

from engine import Machine, MovingMachine
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.plans.forces.force_plan import force_polygon
from sweeps.pictures.plans.forces.loads import group_loads, loads_on_links
from sweeps.pictures.plans.polygons import accelerations, velocities
from sweeps.pictures.plans.pose import MachineCycle

# A plan adds a few vectors of the engine's, each good to some tens of roundings of the largest in it.
EXACT = 1e-12
# Derivatives by Fourier series of 720 points: a rounding of the positions, 1e-16 of the mechanism's size (at most ten
# cranks), is multiplied by the highest order, 360, once or twice, and summed over as many.
BY_FOURIER = 10 * 1e-16 * 360**2 * math.sqrt(360)


def largest(plan):
    return max(map(abs, plan.images.values()))


# Velocities and accelerations


@each("name", [*MACHINES, *HIGHER])
@each("plan_of", [velocities, accelerations])
def test_legs__meet_in_the_images_of_points(name, plan_of):
    for pose in poses(name):
        plan = plan_of(pose)
        for leg in plan.legs:
            end = plan.images.get(leg.start, 0j) + sum(step.vector for step in leg.steps)
            assert abs(end - plan.images.get(leg.end, 0j)) < EXACT * largest(plan)
        # A second way to a point is what makes the plan a polygon: every group has one, every shaft its own.
        assert len(plan.legs) >= 1 + 2 * len(pose.scene.groups)


@each("name", CLOSED)
def test_images__derivatives_of_positions_by_fourier(name):
    cycle = cycle_of(name)
    turns = cycle.scene.input.revolutions
    orders = 1j * np.fft.fftfreq(cycle.motion.q.size, 1 / cycle.motion.q.size) / turns
    crank_length = cycle.numbers["input.length"]
    for pose in poses(name):
        for order, plan in ((1, velocities(pose)), (2, accelerations(pose))):
            for point, image in plan.images.items():
                if point not in cycle.motion.points:
                    continue
                rate = np.fft.ifft(orders**order * np.fft.fft(cycle.motion.points[point]))[pose.k] * cycle.omega**order
                assert abs(image - rate) < BY_FOURIER * crank_length * abs(cycle.omega) ** order


@each("name", [*MACHINES, *HIGHER])
def test_places_of_links__move_as_their_points(name):
    for pose in poses(name):
        for point, part in pose.scene.points.items():
            found, expected = pose.rigid(part.link, pose.point(point).place), pose.point(point)
            assert abs(found.v - expected.v) <= EXACT * largest(velocities(pose))
            assert abs(found.a - expected.a) <= EXACT * largest(accelerations(pose))


def test_steps_of_the_crank_slider__closed_form():
    omega, r, rod, phi = 6.0, 0.05, 0.2, math.radians(130.0)
    plan = accelerations(MachineCycle(slider_crank()).at(phi))
    turn = -omega * r * math.cos(phi) / math.sqrt(rod**2 - (r * math.sin(phi)) ** 2)
    (of_rod,) = [leg for leg in plan.legs if (leg.start, leg.end) == ("A", "B")]
    normal, tangential = of_rod.steps
    assert (normal.kind, tangential.kind) == ("normal", "tangential")
    assert abs(normal.vector) == pytest.approx(turn**2 * rod, rel=1e-12)
    beta = -math.asin(r / rod * math.sin(phi))
    assert normal.vector / abs(normal.vector) == pytest.approx(-complex(math.cos(beta), math.sin(beta)), rel=1e-12)
    assert abs((normal.vector.conjugate() * tangential.vector).real) < 1e-12 * abs(normal.vector) ** 2


def test_coriolis_step_of_the_quick_return__twice_turn_times_sliding():
    cycle = cycle_of("quick return")
    arm = cycle.motion.points["A"] - cycle.motion.points["D"]
    orders = 1j * np.fft.fftfreq(arm.size, 1 / arm.size)

    def rate(row):
        return np.fft.ifft(orders * np.fft.fft(row)).real * cycle.omega

    # The lever points up throughout: its angle from the y axis has no jump.
    turn, sliding = rate(np.angle(arm / 1j)), rate(np.abs(arm))
    for pose in poses("quick return"):
        (leg,) = [leg for leg in accelerations(pose).legs if (leg.start, leg.end) == ("A'", "A")]
        expected = 2j * (turn * sliding * arm / np.abs(arm))[pose.k]
        assert [step.kind for step in leg.steps] == ["coriolis", "relative"]
        assert abs(leg.steps[0].vector - expected) < BY_FOURIER * 0.11 * 6.0**2


def test_link_of_three_points__is_a_triangle_of_its_images():
    pose = cycle_of("four-bar").at(1.0)
    assert velocities(pose).links == accelerations(pose).links == (("A", "B", "P"),)


# Forces


def assert_in_equilibrium(pose):
    on_links = loads_on_links(pose)
    scale = max([abs(load.force) for loads in on_links.values() for load in loads], default=0.0)
    size = abs(np.ptp(np.concatenate(list(pose.motion.points.values()))))
    for link, loads in on_links.items():
        origin = pose.origin(link).place
        # A few roundings of the largest force, and of its moment over the size of the mechanism, times what the
        # transmission of forces enlarges them by: ten and more near the ends of a swing.
        least = max([scale * size, *(abs(load.moment) for load in loads)])
        assert abs(sum(load.force for load in loads)) <= EXACT * scale
        assert abs(moment_about(origin, loads)) <= EXACT * least


def assert_closed(pose, parts):
    """Plans of forces of groups or links."""
    for part in parts:
        forces = [load.force for load in force_polygon(pose, part)]
        assert abs(sum(forces)) <= EXACT * max(map(abs, forces), default=0.0)


@each("name", [*MACHINES, *HIGHER])
def test_loads__every_link_in_equilibrium_and_every_force_plan_closed(name):
    for pose in poses(name):
        assert_in_equilibrium(pose)
        assert_closed(pose, pose.scene.groups)


def test_force_plan_of_a_group__without_its_inner_pair_and_reactions_last():
    pose = cycle_of("slider_crank").at(1.0)
    loads = group_loads(pose, "drive")
    assert [load.text for load in loads] == [f"${s}$" for s in ("G_{2}", "U_{2}", "G_{3}", "U_{3}", "R_{03}", "R_{12}")]


def acting(cycle, action, k):
    """Force or moment of an action on the link that it is described for."""
    found = [force for force in cycle.link_forces if (force.kind, force.name) == ("load", action)]
    own = [force for force in found if (force.link, force.source) == (found[0].link, found[0].source)]
    return sum((force.moment if force.force is None else force.force)[k] for force in own)


@each("name", MACHINES)
def test_acting_forces__their_power_is_their_reduced_moment(name):
    cycle, scene = cycle_of(name), MACHINES[name]
    known = Machine(scene).available_fields
    actions = [field.removesuffix(".force_x") for field in known if field.endswith(".force_x")]
    moments = [field.removesuffix(".acting_moment") for field in known if field.endswith(".acting_moment")]
    fields = [f"{action}.moment" for action in (*actions, *moments)]
    reduced = MovingMachine(scene, positions=720).fields(fields)
    for pose in poses(name):
        for action in actions:
            if action in scene.forces:
                velocity = pose.point(scene.forces[action].on).v
            elif action in scene.springs:
                a, b = scene.springs[action].between
                velocity = pose.point(b).v - pose.point(a).v
            else:
                velocity = pose.origin(scene.cylinders[action].piston).v
            power = (acting(cycle, action, pose.k).conjugate() * velocity).real
            # Two products and a sum of the same numbers in another order.
            greatest = np.abs(reduced[f"{action}.moment"]).max() * abs(cycle.omega)
            assert power == pytest.approx(reduced[f"{action}.moment"][pose.k] * cycle.omega, abs=1e-12 * greatest)
        for action in moments:
            power = acting(cycle, action, pose.k) * pose.turn(scene.moments[action].on).omega
            assert power == pytest.approx(reduced[f"{action}.moment"][pose.k] * cycle.omega, rel=1e-12)


def test_force_plan_of_what_is_not_there__refused():
    with pytest.raises(PictureError, match=r"'rods' is neither a group nor a moving link.*did you mean 'rod'"):
        force_polygon(cycle_of("slider crank").at(1.0), "rods")
