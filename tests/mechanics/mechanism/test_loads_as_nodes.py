"""Loads of machines: reduced moments against the oracle's powers, and against the work over small displacements."""

import math

import numpy as np
import pytest
from graph_values import GraphValues
from oracle import Motion
from oracle_dynamics import moments
from press import actions, bodies, press

from engine import Scene
from engine.graph.nodes import Graph, Node
from engine.mechanism.assembly import MovingPoint, Turning
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.loads import Load, Loads
from engine.scene.structure.ordering import order

SPEEDS = (5.0, -3.0)


def loads_of(scene: Scene) -> Loads:
    return Loads(scene, Kinematics(scene, order(scene), Graph(), frozenset()))


def values_of(loads: Loads) -> GraphValues:
    return GraphValues(loads.scene, loads.kinematics.graph)


def moment_of(loads: Loads, name: str) -> Node:
    return loads.kinematics.graph.combination((t.coefficient, t.basis) for t in loads.terms if t.action == name)


def pressed(speed: float) -> Scene:
    """A press with every action."""
    scene = press(**actions(), bodies=bodies())
    scene["input"]["speed"] = speed
    return Scene.model_validate(scene)


@pytest.mark.parametrize("speed", SPEEDS)
def test_reduced_moments__are_powers_over_the_inputs_speed(speed):
    scene = pressed(speed)
    loads, q = loads_of(scene), np.random.default_rng(3).uniform(0.0, 2 * math.pi, 25)
    found = values_of(loads)([moment_of(loads, name) for name in loads.actions], q)
    expected = moments(Motion(scene, q))
    assert set(loads.actions) == set(expected)
    for name, row in zip(loads.actions, found, strict=True):
        reference = np.asarray(expected[name], float)
        # A characteristic of the third power of a velocity, itself good to some ten roundings.
        tolerance = 100 * np.finfo(float).eps * (np.abs(reference).max() + 1e-3)
        np.testing.assert_allclose(row, reference, rtol=0, atol=tolerance, err_msg=name)


def displaced(values: GraphValues, link: Turning, at: MovingPoint, q: np.ndarray, by: float) -> np.ndarray:
    """Displacement of the point of a link that lies in a place at q."""
    now, then = (np.array(values([*link.origin.r, *link.u], place)) for place in (q, q + by))
    place = values([*at.r], q)
    arm = (complex_of(place) - complex_of(now[:2])) / complex_of(now[2:])
    moved = complex_of(then[:2]) + arm * complex_of(then[2:]) - complex_of(place)
    return np.array([moved.real, moved.imag])


def complex_of(vector: np.ndarray) -> np.ndarray:
    return vector[0] + 1j * vector[1]


def turned(values: GraphValues, link: Turning, q: np.ndarray, by: float) -> np.ndarray:
    """Angle by which a link turns."""
    now, then = (complex_of(values([*link.u], place)) for place in (q, q + by))
    return np.angle(then / now)


def work_rate(values: GraphValues, loads: Loads, load: Load, q: np.ndarray) -> np.ndarray:
    """Characteristic times displacement over that of the input, by differences of fourth order."""
    h, weights = 1e-3, {-2: 1 / 12, -1: -2 / 3, 1: 2 / 3, 2: -1 / 12}
    links, grip = loads.kinematics.links, load.grip
    total, ends = np.zeros(q.size), [(grip.link, grip.at, 1.0)]
    if grip.bearer is not None:
        ends.append((*grip.bearer, -1.0))
    for name, at, sense in ends:
        for k, w in weights.items():
            if grip.at is None:
                moved = turned(values, links[name], q, k * h)
            else:
                direction = np.array(values([*grip.direction], q))
                moved = (direction * displaced(values, links[name], at, q, k * h)).sum(axis=0)
            total += sense * w / h * moved
    return values([load.characteristic], q)[0] * total


def test_basis__is_the_work_over_a_small_displacement():
    scene = pressed(5.0)
    loads, q = loads_of(scene), np.random.default_rng(4).uniform(0.0, 2 * math.pi, 25)
    values = values_of(loads)
    for load in loads.terms:
        # Shafts without a pivot have no angle to differ.
        if load.grip.at is None and scene.shafts.get(load.grip.link, None) and not scene.shafts[load.grip.link].pivot:
            continue
        found, expected = values([load.basis], q)[0], work_rate(values, loads, load, q)
        size = np.abs(values([load.characteristic], q)[0]).max()
        # Fourth derivatives of up to a hundred times h⁴/30, and roundings of 1 over h.
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * size, err_msg=load.action)
