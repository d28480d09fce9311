"""Stephenson's chain III driven by the crank of its triad, and from the far side, where dyads order it."""

import numpy as np
import pytest
from free_link_scenes import triad_data
from machines import rrr
from reaction_graphs import ReactionValues

from engine import Scene
from engine.scene.structure.ordering import order

# Between the ends of the far bar's swing, where its rate vanishes.
Q = np.array([0.5, 1.2, 2.0, 3.6, 4.3, 5.0])


def by_a_triad() -> dict:
    return triad_data() | {"inertia_in_reactions": False}


def by_dyads(modes: tuple[int, int]) -> dict:
    """The same links with the bar on Q as input."""
    data = by_a_triad()
    points, bodies = data["points"], dict(data["bodies"])
    corners = {name: complex(points[name]["x"], points.pop(name)["y"]) for name in "BCD"}
    # A dyad's plate has its axes from D to C; the rod's and the lower bar's begin where their dyads hang.
    along = (corners["C"] - corners["D"]) / abs(corners["C"] - corners["D"])

    def turned(place: complex) -> dict:
        local = (place - corners["D"]) / along
        return {"x": local.real, "y": local.imag}

    points["B"] = {"link": "plate", **turned(corners["B"])}
    bodies["plate_body"] = bodies["plate_body"] | turned(0.05 + 0.03j)
    bodies["rod_body"] = bodies["rod_body"] | {"x": 0.2 - 0.1, "y": -0.02}
    return {
        **{key: data[key] for key in ("gravity", "inertia_in_reactions")},
        "points": points,
        "bodies": bodies,
        "input": {"type": "crank", "link": "upper", "pivot": "Q", "pin": "D", "length": 0.2, "speed": 1.0},
        "groups": {
            "near": rrr("C", ("plate", "D", abs(corners["C"] - corners["D"])), ("lower", "P", 0.2), modes[0]),
            "far": rrr("A", ("rod", "B", 0.2), ("crank", "O", 0.03), modes[1]),
        },
    }


def motion_of(values: ReactionValues, link: str, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Direction of a link, and its angle's first and second derivative by the input."""
    found = values.kinematics.links[link]
    c, s, w, e = values.values([*found.u, found.w, found.e], q)
    return c + 1j * s, w, e


@pytest.mark.parametrize("side", range(len(Q)))
def test_stephenson_iii__is_the_same_from_both_sides(side):
    q = Q[side : side + 1]
    near = ReactionValues(by_a_triad())
    assert [g.group_class for g in order(near.scene).free_groups.values()] == [3]
    upper, rate, bend = motion_of(near, "upper", q)
    theta = np.angle(upper)
    sides = [ReactionValues(by_dyads((one, two))) for one in (1, -1) for two in (1, -1)]
    (far,) = [of for of in sides if np.abs(motion_of(of, "crank", theta)[0] - np.exp(1j * q)) < 1e-6]
    assert not order(Scene.model_validate(by_dyads((1, 1)))).free_groups
    crank, back, back_bend = motion_of(far, "crank", theta)
    # Rounding of a direction, 1e-16, is magnified by the ratio of the motions and by the qualities of transmission.
    exact = 1e-13 * max(1.0, *np.abs(1.0 / rate)) ** 2
    assert crank == pytest.approx(np.exp(1j * q), abs=exact)
    assert back * rate == pytest.approx(np.ones(1), rel=exact)
    # Derivative of the inverse function: φ″ = −θ″/θ′³.
    assert back_bend == pytest.approx(-bend / rate**3, rel=10 * exact)
    # Virtual work at rest: M_φ dφ = M_θ dθ.
    name = "input_moment_by_equilibrium"
    assert near([name], q)[name] == pytest.approx(far([name], theta)[name] * rate, rel=10 * exact, abs=1e-13)
