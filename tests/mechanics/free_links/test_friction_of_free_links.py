"""Friction in the pairs of free links against that of dyads, the law of energy, and the law of each pair.

ROUNDINGS: reactions are sums of some ten products and quotients of numbers of their own size, each good to EPS; the
quality of transmission and the margin against jamming of these machines magnify that some tens of times.
"""

from functools import cache

import numpy as np
import pytest
from free_link_scenes import AS_FREE_LINKS, KINDS, dyads_twice, free_link_scene
from reaction_graphs import ReactionValues, in_all_pairs

from engine import MovingMachine, Scene, Verdict

EPS = np.finfo(float).eps
ROUNDINGS = 1000
Q = np.linspace(0.1, 6.1, 9)


@cache
def of_every_kind(kind: str) -> ReactionValues:
    return ReactionValues(in_all_pairs(free_link_scene(kind).model_dump(exclude_unset=True), 3, 0.2))


def test_friction_of_free_links_that_are_dyads__is_that_of_the_dyads():
    dyads, free = dyads_twice()
    dyads = in_all_pairs(dyads, 5, 0.2)
    free["friction"] = {n: f | {"pair": AS_FREE_LINKS[f["pair"]][0]} for n, f in dyads["friction"].items()}
    one, other = ReactionValues(dyads), ReactionValues(free)
    fields = {name: (name, 1.0) for name in ("input_moment_with_friction", "friction_moment", "frame.reaction_moment")}
    for own in dyads["friction"].values():
        (pair, sign), turns = AS_FREE_LINKS[own["pair"]], "diameter" in own
        for part in ("reaction_x", "friction_moment") if turns else ("reaction", "reaction_moment", "friction_force"):
            fields[f"{own['pair']}.{part}"] = (f"{pair}.{part}", sign)
    expected, found = one(list(fields), Q), other([name for name, _ in fields.values()], Q)
    for name, (own, sign) in fields.items():
        scale = np.abs(expected[name]).max() + (name == "press.second.reaction_moment")
        assert np.abs(expected[name] - sign * found[own]).max() <= ROUNDINGS * EPS * scale, name
    assert one.margins(Q) == pytest.approx(other.margins(Q), rel=ROUNDINGS * EPS)


@pytest.mark.parametrize("kind", KINDS)
def test_friction_in_a_group_of_any_kind__costs_what_the_input_supplies_more(kind):
    of, without = of_every_kind(kind), ReactionValues(free_link_scene(kind))
    force, forces, moment, moments = of.values(list(of.reactions.checks.values()), Q)
    assert (force < ROUNDINGS * EPS * forces).all()
    assert (np.abs(moment) < ROUNDINGS * EPS * moments).all()
    speed = of.scene.input.speed
    powers = of([f"{friction.pair}.friction_power" for friction in of.scene.friction.values()], Q)
    assert all((row >= 0.0).all() for row in powers.values())
    rubbed = of(["input_moment_with_friction"], Q)["input_moment_with_friction"]
    plain = without(["input_moment_by_equilibrium"], Q)["input_moment_by_equilibrium"]
    # Each pair moves as the machine does: what the reactions make the input supply is lost in the pairs.
    more = (rubbed - plain) * speed
    assert more == pytest.approx(sum(powers.values()), rel=0, abs=ROUNDINGS * EPS * np.abs(rubbed * speed).max())


@pytest.mark.parametrize("kind", ["three bars", "slider leg", "six-sided contour"])
def test_friction_in_a_journal__is_its_circle_times_the_whole_reaction(kind):
    of = of_every_kind(kind)
    for own in of.scene.friction.values():
        if own.diameter is not None:
            moment, reaction = of([f"{own.pair}.friction_moment", f"{own.pair}.reaction"], Q).values()
            bush = 4 / np.pi if own.contact == "worn in" else 1.0
            circle = 0.5 * own.diameter * bush * np.sin(np.arctan(own.coefficient))
            # What the last pass leaves is the square of the residual.
            assert np.abs(moment) == pytest.approx(circle * reaction, rel=1e-12, abs=1e-12 * reaction.max())


def test_triad_with_so_much_friction_that_it_jams__has_its_status():
    data = in_all_pairs(free_link_scene("three bars").model_dump(exclude_unset=True), 3, 0.2)
    data["friction"] = {name: data["friction"][name] for name in ("f1", "f3", "f4", "f6")}
    for diameter, verdict in ((0.05, Verdict.OK), (8.0, Verdict.JAMS)):
        machine = MovingMachine(Scene.model_validate(data), {"friction.f3.diameter": diameter})
        assert machine.verdict(["friction_moment"]) == verdict


@pytest.mark.parametrize("joint", ["B", "F"])
def test_drag_on_a_joint_of_free_links__is_that_of_the_dyads(joint):
    # B goes on a circle, F on a line; the drag is against the velocity, whatever links share the joint.
    drag = {"forces": {"drag": {"type": "linear_drag", "on": joint, "coefficient": 10.0}}}
    fields = ["drag.force_x", "drag.force_y", "input_moment_by_equilibrium"]
    dyads, free = (ReactionValues(data | drag)(fields, Q) for data in dyads_twice())
    for name in fields:
        scale = np.abs(dyads[name]).max()
        assert np.abs(free[name] - dyads[name]).max() <= ROUNDINGS * EPS * scale, name
