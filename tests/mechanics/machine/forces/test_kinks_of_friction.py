"""Kinks of pair friction: where a slider changes the edge it bears on, or a rod from push to pull, against quadrature.

A slider-crank with friction in its guide alone. Along the guide the rod's force S, the load F, the inertia force −m a
and the friction are in equilibrium, S cos β = m a − F + sgn(v) f P, with P = max(|S sin β|, |M|/(l/2)) what presses the
edges of a slider of length l that a moment M tilts. Between its kinks all of it is smooth, so that Gauss's rule on the
pieces gives works to rounding, and a search in each piece the extremes.
"""

import itertools
import math
from collections.abc import Callable

import numpy as np
import pytest
from closed_forms import slider_motion
from machines import on, slider_crank
from scipy.optimize import brentq, minimize_scalar

from engine import Machine, Scene, Verdict
from engine.scene.scene import Numbers, scene_numbers

R, ROD, MASS, SPEED, COEFFICIENT, LENGTH = 0.05, 0.16, 2.0, 30.0, 0.2, 0.1
SUMMARIES = ["friction_loss", "g.second.friction_work"]
SUMMARIES += [
    f"{field}.{s}" for field in ("g.second.friction_force", "input_moment_with_friction") for s in ("min", "max")
]
GAUSS = np.polynomial.legendre.leggauss(24)
# Force on the ram, guide's offset, distance of the force's line from the ram's joint.
CASES = {
    "in line": (-900.0, 0.0, 0.0),
    "guide off the axis": (-900.0, 0.03, 0.0),
    "push and pull": (-40.0, 0.0, 0.0),
    "push and pull, guide off the axis": (-40.0, -0.02, 0.0),
    "tilted": (-900.0, 0.02, 0.01),
    "tilted, push and pull": (-60.0, 0.01, 0.02),
}


class Rubbing:
    """The slider-crank at any angle."""

    def __init__(self, force: float, offset: float, aside: float) -> None:
        self.force, self.offset, self.tilt = force, offset, abs(force * aside) / (LENGTH / 2)

    def motion(self, phi: float) -> tuple[float, float, float, float]:
        """Cosine and sine of the rod's angle, rate and second derivative of the ram's place."""
        place, *rates = slider_motion(phi, R, ROD, self.offset)
        return (place - R * math.cos(phi)) / ROD, (self.offset - R * math.sin(phi)) / ROD, *rates

    def thrust(self, phi: float) -> float:
        """Along the guide, what the rod gives but for the friction."""
        return MASS * SPEED**2 * self.motion(phi)[3] - self.force

    def by_normal(self, phi: float) -> float:
        """What presses on the guide where the slider doesn't tilt."""
        c, s, rate, _ = self.motion(phi)
        thrust, way = self.thrust(phi), math.copysign(1.0, rate)
        return abs(thrust * s / (c - COEFFICIENT * way * math.copysign(abs(s), thrust)))

    def friction(self, phi: float) -> float:
        """On the ram along the guide."""
        return -math.copysign(COEFFICIENT, self.motion(phi)[2]) * max(self.by_normal(phi), self.tilt)

    def lost(self, phi: float) -> float:
        return -self.friction(phi) * self.motion(phi)[2]

    def input_moment(self, phi: float) -> float:
        return self.thrust(phi) * self.motion(phi)[2] + self.lost(phi)

    def kinks(self) -> list[float]:
        """Ends of the pieces, the cycle's among them."""
        smooth: list[Callable[[float], float]] = [
            lambda phi: self.motion(phi)[1],
            lambda phi: self.motion(phi)[2],
            self.thrust,
        ]
        turns = np.linspace(1e-3, 1e-3 + 2 * math.pi, 2001)
        found = [0.0, 2 * math.pi]
        for curve in smooth:
            found += self._zeros(curve, turns)
        # Of what presses, a magnitude that jumps nowhere else, between those.
        for a, b in itertools.pairwise(sorted(found)):
            if b - a > 1e-9:
                found += self._zeros(
                    lambda phi: self.by_normal(phi) - self.tilt, np.linspace(a + 1e-12, b - 1e-12, 101)
                )
        return sorted(place % (2 * math.pi) if place > 2 * math.pi else place for place in found)

    @staticmethod
    def _zeros(curve: Callable[[float], float], at: np.ndarray) -> list[float]:
        values = [curve(phi) for phi in at]
        pairs = zip(itertools.pairwise(at), itertools.pairwise(values), strict=True)
        return [brentq(curve, *ends, xtol=1e-15) for ends, (one, two) in pairs if one * two < 0]

    def pieces(self) -> list[tuple[float, float]]:
        return [(a, b) for a, b in itertools.pairwise(self.kinks()) if b - a > 1e-9]

    def integral(self, curve: Callable[[float], float]) -> float:
        total = 0.0
        for a, b in self.pieces():
            edges = np.linspace(a, b, 5)
            for low, high in itertools.pairwise(edges):
                half = 0.5 * (high - low)
                total += half * sum(w * curve(low + half * (1 + x)) for x, w in zip(*GAUSS, strict=True))
        return total

    def greatest(self, curve: Callable[[float], float]) -> float:
        best = -math.inf
        for a, b in self.pieces():
            # Friction jumps where the ram turns back: each side is its own.
            places = np.linspace(a + 1e-11, b - 1e-11, 61)
            values = [curve(phi) for phi in places]
            k = int(np.argmax(values))
            low, high = places[max(k - 1, 0)], places[min(k + 1, 60)]
            found = minimize_scalar(lambda q: -curve(q), bounds=(low, high), method="bounded", options={"xatol": 1e-9})
            best = max(best, max(values), -found.fun)
        return best


def rubbing_scene(force: float, offset: float, aside: float) -> Scene:
    tilting = {"length": LENGTH} if aside else {}
    scene = slider_crank(
        R,
        ROD,
        SPEED,
        bodies={"ram": {"link": "ram", "mass": MASS}},
        forces={"load": {"type": "constant", "on": "K", "angle": 0.0, "force": force}},
        friction={"way": {"pair": "g.second", "coefficient": COEFFICIENT, **tilting}},
    )
    scene["points"]["K"] = on("ram", 0.0, aside)
    scene["groups"]["g"]["second"]["offset"] = offset
    return Scene.model_validate(scene)


@pytest.mark.parametrize("name", CASES)
def test_friction__is_right_between_its_kinks_and_takes_few_panels(name):
    scene, exact = rubbing_scene(*CASES[name]), Rubbing(*CASES[name])
    machine = Machine(scene, SUMMARIES)
    outcome = machine.evaluate({})
    assert outcome.status[0] == Verdict.OK
    loss = exact.integral(exact.lost)
    force, moment = exact.friction, exact.input_moment
    expected = [loss, loss, -exact.greatest(lambda q: -force(q)), exact.greatest(force)]
    expected += [-exact.greatest(lambda q: -moment(q)), exact.greatest(moment)]
    sizes = [loss, loss, *[max(map(abs, expected[2:4]))] * 2, *[max(map(abs, expected[4:]))] * 2]
    for summary, value, size in zip(SUMMARIES, expected, sizes, strict=True):
        found, figure = outcome.summaries[summary][0], outcome.errors[summary][0]
        # The search leaves the square of 1e-9, and slopes at a piece's end times 1e-11.
        assert abs(found - value) <= figure + 1e-10 * size, (summary, found, value, figure)
        assert abs(found - value) <= 1e-9 * size
    # No panel is longer than a fifth of the turn, and beside kinks there are one or two more to each piece.
    panels = machine._measuring(machine._measuring.numbers(Numbers(scene_numbers(scene), {}), 1)).outcome.panels[0]
    assert panels <= 5 + 2 * len(exact.pieces())


def test_friction_in_a_joint_beside_the_guide__has_the_kinks_of_the_guide():
    """A slider that changes its edge bends the forces in its whole group; works add up to the loss at the input."""
    scene = rubbing_scene(*CASES["tilted"]).model_dump(exclude_unset=True)
    scene["friction"]["pin"] = {"pair": "g.first", "coefficient": 0.1, "diameter": 0.03}
    asked = ["g.first.friction_work", "g.second.friction_work", "friction_loss"]
    varied = {"forces.load.force": -(10.0 ** np.random.default_rng(1).uniform(1.5, 3.5, 64))}
    # Each alone, on panels that suit it.
    found = [Machine(Scene.model_validate(scene), [name], (), list(varied)).evaluate(varied) for name in asked]
    pin, guide, loss = (outcome.summaries[name] for name, outcome in zip(asked, found, strict=True))
    allowed = sum(outcome.errors[name] for name, outcome in zip(asked, found, strict=True))
    assert (np.abs(pin + guide - loss) <= allowed).all()
    assert (allowed < 1e-5 * loss).all()


@pytest.mark.parametrize("offset", [0.0, 0.03, -0.02])
def test_force_that_changes_sign_for_a_few_degrees__its_two_kinks_are_seen(offset):
    """The load takes all but a share of 1e-5 to 0.1 of the greatest thrust along the guide."""
    place = math.pi + minimize_scalar(lambda q: -Rubbing(0.0, offset, 0.0).thrust(math.pi + q), bounds=(-2, 2)).x
    depth = 10.0 ** np.random.default_rng(3).uniform(-5.0, -1.0, 32)
    forces = Rubbing(0.0, offset, 0.0).thrust(place) * (1.0 - depth)
    machine = Machine(rubbing_scene(1.0, offset, 0.0), ["friction_loss"], (), ["forces.load.force"])
    outcome = machine.evaluate({"forces.load.force": forces})
    found, figure = outcome.summaries["friction_loss"], outcome.errors["friction_loss"]
    for force, value, error in zip(forces, found, figure, strict=True):
        exact = Rubbing(force, offset, 0.0)
        loss = exact.integral(exact.lost)
        assert abs(value - loss) <= error + 1e-12 * loss
