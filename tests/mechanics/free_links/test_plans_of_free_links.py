"""Plans of free links: polygons that close, images against the engine's derivatives, links in equilibrium."""

from functools import cache

import numpy as np
import pytest
from free_link_scenes import free_link_scene
from matplotlib.text import Text
from plan_machines import moment_about

from engine import Scene
from sweeps.pictures.plans.forces.force_plan import force_polygon
from sweeps.pictures.plans.forces.loads import loads_on_links
from sweeps.pictures.plans.polygons import accelerations, velocities
from sweeps.pictures.plans.pose import MachineCycle
from sweeps.pictures.plans.sheets import kinematic_sheet

# A plan adds a few vectors of the engine's, each good to some tens of roundings of the largest in it.
EXACT = 1e-12


# A group that begins with a special point, and one that has none and slides.
KINDS = ("three bars", "sliding plate")
RUBBING = {
    "three bars": {"pin": {"pair": "lower.C", "coefficient": 0.2, "diameter": 0.05}},
    "sliding plate": {"slot": {"pair": "plate.slot", "coefficient": 0.2, "length": 0.1}},
}


@cache
def cycle_of(kind: str) -> MachineCycle:
    data = free_link_scene(kind).model_dump(exclude_unset=True)
    return MachineCycle(Scene.model_validate(data | {"friction": RUBBING[kind]}))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("plan_of", [velocities, accelerations])
def test_ways_to_images__meet(kind, plan_of):
    for at in (0.7, 4.0):
        plan = plan_of(cycle_of(kind).at(at))
        largest = max(map(abs, plan.images.values()))
        for leg in plan.legs:
            end = plan.images.get(leg.start, 0j) + sum(step.vector for step in leg.steps)
            assert abs(end - plan.images.get(leg.end, 0j)) < EXACT * largest, leg
        # A polygon for every link at least: all of them are drawn.
        assert len(plan.legs) > len(cycle_of(kind).scene.links)


def test_special_point__moves_along_two_bars_as_their_outer_joints_do():
    pose = cycle_of("three bars").at(0.7)
    plan = velocities(pose)
    (special,) = plan.special
    for bar in special.bars:
        outer, inner = (pose.point(name) for name in (bar.outer, bar.inner))
        along = (inner.place - outer.place) / abs(inner.place - outer.place)
        assert abs(((special.place - outer.place).conjugate() * along).imag) < EXACT
        assert (plan.images[special.name].conjugate() * along).real == pytest.approx(
            (outer.v.conjugate() * along).real, abs=EXACT
        )


@pytest.mark.parametrize("kind", KINDS)
def test_loads_with_friction__every_free_link_in_equilibrium(kind):
    cycle = cycle_of(kind)
    (group,) = cycle.structure.free_groups
    for at in (0.7, 4.0):
        pose = cycle.at(at)
        on_links = loads_on_links(pose)
        scale = max(abs(load.force) for loads in on_links.values() for load in loads)
        for link, loads in on_links.items():
            origin = pose.origin(link).place
            # Links of some decimetres: moments are as exact as forces.
            assert abs(sum(load.force for load in loads)) <= EXACT * scale
            assert abs(moment_about(origin, loads)) <= EXACT * scale, link
        assert abs(sum(load.force for load in force_polygon(pose, group))) <= EXACT * scale


def test_sheet_of_a_triad__names_its_special_point():
    figure = kinematic_sheet(cycle_of("three bars").at(0.7), "acceleration")
    texts = [text.get_text() for text in figure.findobj(Text)]
    assert any("special points of Assur: $W$ on 5" in text for text in texts)


def test_origin_of_a_sliding_plate__is_on_its_guide():
    cycle = cycle_of("sliding plate")
    pose = cycle.at(0.7)
    point, direction = (values[pose.k] for values in cycle.motion.guides["slot"])
    assert ((pose.origin("plate").place - point) / direction).imag == pytest.approx(0.01, abs=EXACT)
    assert np.isfinite(pose.origin("plate").a)
