"""Plans of wheels, racks, cams and second inputs: places followed as positions alone show them, known polygons."""

import cmath
import math

import numpy as np
import pytest
from driving_cams import CIRCLE, SLIDING, changed
from geared_links import CRANK
from plan_machines import HIGHER, cycle_of, poses

from engine import Scene
from sweeps.pictures.plans.files import plan_pictures
from sweeps.pictures.plans.forces.loads import loads_on_links
from sweeps.pictures.plans.polygons import accelerations, velocities
from sweeps.pictures.plans.pose import MachineCycle

EXACT = 1e-12
# Weights of derivatives at the middle of nine nodes (B. Fornberg, 1988).
FIRST = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
SECOND = np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560])


def link_of(pose, plan, name):
    """The link that an image is of: it is told of one under another's point, the rest have its number."""
    if name in plan.under:
        return plan.under[name]
    number = int(name[1:])
    (link,) = [link for link, n in pose.cycle.link_numbers.items() if n == number]
    cams = {cam.follower.link: cam.on for cam in pose.scene.cams.values()}
    return cams[link] if name[0] == "C" else link


@pytest.mark.parametrize("name", HIGHER)
def test_images_of_contacts__as_their_links_carry_them(name):
    """A place kept in the axes of a link is followed over nine nodes, by their positions alone."""
    checked = 0
    cycle = cycle_of(name)
    # None of them within four nodes of where a section of a cam's law ends.
    for k in (77, 260, 640):
        pose = cycle.at(cycle.motion.q[k])
        around = np.arange(k - 4, k + 5)
        step = cycle.motion.q[1] - cycle.motion.q[0]
        for order, weights, plan in ((1, FIRST, velocities(pose)), (2, SECOND, accelerations(pose))):
            for image, vector in plan.images.items():
                if image.rstrip("'") not in plan.places:
                    continue
                origin, along = cycle.motion.axes(link_of(pose, plan, image))
                kept = (plan.places[image.rstrip("'")] - origin[k]) / along[k]
                path = origin[around] + kept * along[around]
                rate = (weights @ path) * (cycle.omega / step) ** order
                # Links 0.3 m about move with parts of seven periods in a turn at most: ninth and tenth derivatives of
                # those leave a step⁸ 7⁹/630 and a step⁸ 7¹⁰/3150. A rounding of 1e-16 is divided by the step once or
                # twice.
                far = max(abs(path)) + 0.3
                left = step**8 * 7.0**9 / 630 * (7 / 5) ** (order - 1) + 40 * 1e-16 / step**order
                assert abs(vector - rate) < left * far * cycle.omega**order, image
                checked += 1
    assert checked >= 6


def test_eccentric_circle_under_a_flat_face__its_centre_is_that_of_curvature():
    """The profile's centre turns with the crank, 20 mm from it; the face takes its height, as a yoke's slot does."""
    follower = {"type": "translating", "link": "tappet", "guide": "way", "contact": "flat"}
    data = changed(
        SLIDING, points__top__x=0, guides__way__x=0, cams__cam__sections=CIRCLE, cams__cam__follower=follower,
        cams__cam__begin="-90 deg",
    )  # fmt: skip
    pose = MachineCycle(Scene.model_validate(data)).at(math.radians(50))
    omega, arm = pose.cycle.omega, 0.02 * cmath.exp(1j * pose.motion.q[pose.k])
    for plan, rate in ((velocities(pose), 1j * omega), (accelerations(pose), -(omega**2))):
        assert plan.places["C2"] == pytest.approx(arm, abs=1e-14)
        assert plan.images["C2"] == pytest.approx(rate * arm, rel=EXACT)
        assert plan.images["C2'"] == pytest.approx(1j * (rate * arm).imag, rel=EXACT, abs=EXACT * omega)


def test_wheel_rolling_on_a_circle__acceleration_of_what_touches():
    """A planet of radius r on a fixed sun R: what touches has ω_p² r R/(r + R), from the sun (Euler and Savary)."""
    sun, planet = 0.02, 0.03
    data = {
        "points": {"O": {"x": 0, "y": 0}},
        "input": CRANK | {"revolutions": 3},
        "shafts": {
            "planet": {
                "geared_to": "frame", "carrier": "crank", "pivot": "A", "ratio": -sun / planet, "inertia": 0.001,
            }
        },
    }  # fmt: skip
    pose = MachineCycle(Scene.model_validate(data)).at(0.7)
    turn, u = pose.cycle.omega * (1 + sun / planet), cmath.exp(1j * pose.motion.q[pose.k])
    assert pose.turn("planet").omega == pytest.approx(turn, rel=EXACT)
    assert abs(velocities(pose).images["P2"]) < EXACT
    expected = turn**2 * planet * sun / (planet + sun) * u
    assert accelerations(pose).images["P2"] == pytest.approx(expected, rel=EXACT)
    (leg,) = [leg for leg in accelerations(pose).legs if leg.start == "P2'"]
    assert [step.kind for step in leg.steps] == ["normal"]


def test_force_on_a_planet__along_the_line_of_action():
    """Teeth push along the tangent of the base circles, 20° off that of the pitch circles."""
    pose = poses("cardan circles")[0]
    (force,) = [load for load in loads_on_links(pose)["planet"] if load.pair == "planet.teeth"]
    across = 1j * (force.at - pose.point("A").place)
    lean = abs(cmath.phase(force.force / across))
    assert min(lean, math.pi - lean) == pytest.approx(math.radians(20), rel=1e-10)


def test_cam_with_friction__pushes_beside_the_normal_by_the_rollers_friction():
    pose = poses("rubbing cam")[1]
    pushing, rubbing = [load for load in loads_on_links(pose)["arm"] if load.pair == "cam.contact"]
    assert rubbing.is_friction
    assert not pushing.is_friction
    assert abs((pushing.force.conjugate() * rubbing.force).real) < EXACT * abs(pushing.force) ** 2
    # A roller's friction is that on its pin: f d/D of the pressing force, D its own diameter.
    assert abs(rubbing.force) == pytest.approx(0.1 * 8 / 16 * abs(pushing.force), rel=1e-3)


def test_plan_pictures__a_sheet_of_forces_for_what_a_cam_drives(tmp_path):
    made = [path.name for path in plan_pictures(HIGHER["roller"], tmp_path / "a.svg", 1.0)]
    assert made == [
        "a_velocity.svg", "a_acceleration.svg", "a_forces_crank.svg", "a_forces_tappet.svg", "a_reactions.svg",
        "a_bearing_input.svg",
    ]  # fmt: skip
