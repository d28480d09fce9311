"""Several bodies on one link act as their resultant, computed here in rational arithmetic.

Tolerances are some roundings (EPS) of the greatest value: a resultant is made of a dozen operations.
"""

from fractions import Fraction

import numpy as np
import pytest
from machines import moving
from oracle import EPS
from press import press

from engine import Machine, Scene
from engine.scene.masses import resultant_masses

DYNAMICS = [
    "reduced_inertia",
    "reduced_inertia_phi",
    "gravity.moment",
    "input_moment",
    "shaking_force",
    "shaking_moment",
]


def resultant(*parts):
    """Mass, centre and moment of inertia of (mass, x, y, moment of inertia), by the parallel axis theorem."""
    exact = [tuple(map(Fraction, part)) for part in parts]
    mass = sum(m for m, *_ in exact)
    x, y = (sum(part[0] * part[axis] for part in exact) / mass for axis in (1, 2))
    inertia = sum(j + m * ((px - x) ** 2 + (py - y) ** 2) for m, px, py, j in exact)
    return dict(zip(("mass", "x", "y", "inertia"), map(float, (mass, x, y, inertia)), strict=True))


def body(link, part):
    return {"link": link, **dict(zip(("mass", "x", "y", "inertia"), part, strict=True))}


def scenes_of(on_links):
    """The press with the bodies of each link apart, and with one body in their place."""
    apart = {f"part_{link}_{i}": body(link, p) for link, parts in on_links.items() for i, p in enumerate(parts)}
    joined = {f"whole_{link}": {"link": link, **resultant(*parts)} for link, parts in on_links.items()}
    return [press(bodies=bodies) for bodies in (apart, joined)]


def links_of(scene):
    return sorted(
        {name for g in scene["groups"].values() for side in ("first", "second") for name in [g[side]["link"]]}
    )


LINKS = ["crank", *links_of(press(bodies={}))]
PARTS = [(3.0, 0.4, 0.1, 0.02), (1.0, -0.2, 0.05, 0.0), (0.25, 0.0, -0.3, 0.5), (0.0, 7.0, 7.0, 0.125)]


def test_parts_of_bodies__act_as_their_resultant():
    scenes = scenes_of({link: PARTS[i % 2 :] for i, link in enumerate(LINKS)})
    known = Machine(Scene.model_validate(scenes[1])).available_fields
    reactions = [field for field in known if ".reaction" in field]
    apart, joined = (moving(scene, [*DYNAMICS, *reactions], 48)[1] for scene in scenes)
    # Reactions follow from small systems of equations: tolerances are of the greatest of them.
    greatest = max(np.abs(joined[name]).max() for name in reactions)
    for name in [*DYNAMICS, *reactions]:
        scale = greatest if name in reactions else np.abs(joined[name]).max()
        np.testing.assert_allclose(apart[name], joined[name], rtol=0, atol=500 * EPS * scale)


def test_bodies_without_mass__leave_their_inertia():
    link = LINKS[1]
    rows = []
    for parts in ([(0.0, 0.0, 0.0, 0.5), (0.0, 1.0, 2.0, 0.5)], [(0.0, 0.0, 0.0, 1.0)]):
        scene = press(bodies={f"b{i}": body(link, part) for i, part in enumerate(parts)})
        rows.append(moving(scene, ["reduced_inertia"], 24)[1]["reduced_inertia"])
    np.testing.assert_array_equal(*rows)
    assert (rows[0] > 0).any()


def test_body_named_as_another_link__is_not_taken_for_its_resultant():
    first, second = LINKS[1], LINKS[2]
    parts = {first: body(second, PARTS[0]), "p": body(first, PARTS[1]), "q": body(first, PARTS[2])}
    renamed = {"r": parts[first], "p": parts["p"], "q": parts["q"]}
    rows = [moving(press(bodies=bodies), DYNAMICS, 24)[1] for bodies in (parts, renamed)]
    for name in DYNAMICS:
        np.testing.assert_array_equal(rows[0][name], rows[1][name])


@pytest.mark.parametrize("count", [30, 300])
def test_many_bodies__are_one_mass_to_a_link(count):
    bodies = {f"b{i}": body(LINKS[i % len(LINKS)], PARTS[i % 3]) for i in range(count)}
    masses = resultant_masses(Scene.model_validate(press(bodies=bodies)), frozenset())
    assert [mass.link for mass in masses.values()] == LINKS
