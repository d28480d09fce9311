"""Walks of machines along the angle and along time: against closed forms, conservation, and each other."""

import math
from typing import NamedTuple

import numpy as np
import pytest
from motion_scenes import GRAVITY, INERTIA, MOMENTS, pendulum, rotor, run, slider_crank
from mpmath import mp

from engine import Scene
from engine.graph.nodes import value_of
from engine.mechanism.mechanics import Mechanics
from engine.motion.moments.dynamics import Dynamics, Reduction
from engine.motion.moments.grid import edges_of
from engine.motion.one_speed import MachineSystem, along_angle, along_time
from engine.scene.scene import Numbers, scene_numbers
from engine.stepping.methods import EIGHT, FOUR
from engine.stepping.system import Walks
from engine.stepping.walk import Why

TURN = 2.0 * math.pi
MASS, ARM, OWN = 2.0, 0.25, 0.05
WEIGHT, SWINGING = MASS * GRAVITY * ARM, OWN + MASS * ARM**2


class Machine(NamedTuple):
    """A machine with its system along the angle or along time, and all else that a walk needs."""

    printed: MachineSystem
    dynamics: Dynamics


def machine(scene: dict, form: str, works: str = "") -> Machine:
    mechanics = Mechanics(Scene.model_validate(scene))
    made = (along_angle if form == "angle" else along_time)(mechanics, bool(works), frozenset(works.split()))
    off = frozenset(mechanics.scene.regimes["go"].off)
    return Machine(MachineSystem(*made, mechanics), Dynamics(Reduction(mechanics), off))


def walked(own: Machine, states: np.ndarray, goal: float, method: int = EIGHT, **given: object) -> Walks:
    """Walk from states (states, variants); what isn't given is as in a run without limits."""
    sizes, dynamics, count = own.printed.sizes, own.dynamics, states.shape[1]
    numbers = Numbers(scene_numbers(dynamics.reduction.mechanics.scene), given.pop("varied", {}))
    way, one = np.ones(count), np.ones(count)
    variants = dynamics.driven(dynamics.reduction.variants(numbers, way, np.zeros(count)))
    unit = numbers.with_values({"input.speed": way})
    known = {size: value_of(c, unit) if a not in dynamics.off else 0.0 for size, (a, c) in sizes.loads.items()}
    known |= {size: float(name in dynamics.motors) for size, name in sizes.motors.items()}
    limits = {sizes.above: np.inf, sizes.below: -np.inf, sizes.brisk: 1e300, sizes.stay: np.inf}
    known |= {sizes.wheel: 0.0, sizes.way: way, sizes.facing: one} | limits
    known |= {getattr(sizes, name): given.pop(name) for name in ("above", "below") if name in given}
    lane = {"start": 0.0, "direction": way, "facing": one, "clock": 0.0, "goal": goal, "other_goal": np.inf}
    lane |= {"tolerance": 1e-12, "farthest": 0.25 * math.pi, "turned": 0.0, "pace": 0.25 * math.pi}
    recorded, extremes = given.pop("recorded", 0), given.pop("extremes", False)
    lane |= given
    start = np.zeros((len(own.printed.rates), count))
    start[: len(states)] = states
    edges = np.concatenate(edges_of(way, variants.breaks, dynamics.cycle, 0.0))
    made = own.printed.tabulation.parameters(numbers, way, variants.ends, known)
    task = own.printed.task(dynamics.cycle, method, extremes)
    return own.printed.run(task, made, edges, np.zeros((0, count)), lane, start, recorded=recorded)


@pytest.fixture(scope="module")
def driven() -> Machine:
    return machine(rotor({"go": run("dc", time=1.0)}), "angle")


def start_up(omega: float) -> tuple[float, float]:
    """Time and angle in which a DC motor brings the rotor from 10 rad/s to a speed, from I ω' = M (1 − ω/ω₀)."""
    stall, idle = mp.mpf(MOMENTS["dc"]["stall_moment"]), mp.mpf(MOMENTS["dc"]["no_load_speed"])
    pace = mp.mpf(INERTIA) * idle / stall
    time = pace * mp.log((idle - 10) / (idle - mp.mpf(omega)))
    return float(time), float(idle * time - pace * (mp.mpf(omega) - 10))


def test_start_up__ends_at_its_speed_after_the_time_of_the_closed_form(driven):
    omega = np.array([12.0, 40.0, 90.0])
    found = walked(driven, np.full((1, 3), 0.5 * INERTIA * 100.0), np.inf, above=omega)
    assert found.why.tolist() == [Why.GUARD] * 3
    exact = np.array([start_up(speed) for speed in omega]).T
    # A step misses 1e-12 of the greatest work of a step, and of the time of a cycle; there are less than a hundred.
    np.testing.assert_allclose(np.sqrt(2.0 * found.states[0] / INERTIA), omega, rtol=1e-14)
    np.testing.assert_allclose([found.states[1], found.turned], exact, rtol=1e-10)


def test_start_up__ends_at_its_time_between_edges(driven):
    time, angle = start_up(60.0)
    found = walked(driven, np.array([[0.5 * INERTIA * 100.0]]), np.inf, other_goal=time)
    assert found.why[0] == Why.OTHER_GOAL
    np.testing.assert_allclose(found.turned, angle, rtol=1e-10)


def test_runge_and_kutta__are_of_order_four(driven):
    turned, exact = 6.0 * TURN, []
    for per_turn in (8, 16, 32):
        length = TURN / per_turn
        found = walked(driven, np.array([[0.5 * INERTIA * 100.0]]), turned, FOUR, farthest=length, pace=length)
        exact.append(found.states[1, 0])
    best = walked(driven, np.array([[0.5 * INERTIA * 100.0]]), turned).states[1, 0]
    off = np.abs(np.array(exact) - best)
    # 2⁴ for half the length, but for terms of the next order.
    assert 12.0 < off[0] / off[1] < 20.0
    assert 14.0 < off[1] / off[2] < 18.0


@pytest.fixture(scope="module")
def weighed() -> Machine:
    return machine(slider_crank({"go": run("gravity", time=1.0)}), "angle", "motors all")


def test_weights__give_back_what_they_take_and_repeated_cycles_are_the_first_one(weighed):
    begin = np.array([[2.0, 5.0, 50.0]])
    found = walked(weighed, begin, 40.0 * TURN)
    # Rounding of a step is some units in the last place of the energy, and there are a thousand.
    np.testing.assert_allclose(found.states[0], begin[0], rtol=1e-12)
    once = walked(weighed, begin, TURN)
    np.testing.assert_allclose(found.states[1], 40.0 * once.states[1], rtol=1e-11)
    assert (np.abs(found.states[0] - begin[0]) <= found.carried_errors[0]).all()


def test_walks__are_the_same_alone_and_among_others_to_the_last_bit():
    own = machine(slider_crank({"go": run("dc cut gravity", time=1.0)}, flywheel=0.1), "angle", "motors useful")
    begin = np.linspace(5.0, 80.0, 131)[None]
    together = walked(own, begin, 7.3 * TURN, tolerance=1e-7)
    for v in (0, 63, 64, 130):
        alone = walked(own, begin[:, v : v + 1], 7.3 * TURN, tolerance=1e-7)
        assert np.array_equal(together.states[:, v], alone.states[:, 0]), v


def test_recorded_steps__are_the_motion_between_their_ends():
    own = machine(slider_crank({"go": run("dc gravity", time=1.0)}, flywheel=0.1), "angle")
    found = walked(own, np.array([[20.0]]), TURN, recorded=200)
    assert found.why[0] == Why.GOAL
    shown = 8
    for step in found.recorded[: int(found.steps[0]) : 5, :, 0]:
        at, length, _, *rows = step
        energy = rows[:shown]
        middle = walked(own, np.array([[energy[0]]]), at + 0.5 * length, turned=at)
        # The polynomial of degree seven through its places, in the middle of the step.
        places = 0.5 - 0.5 * np.cos(np.pi * np.arange(shown) / (shown - 1))
        value = np.polynomial.Polynomial.fit(places, energy, shown - 1)(0.5)
        # It misses a term of order eight of a step that itself misses 1e-12: its size is that of the estimate's root.
        assert value == pytest.approx(middle.states[0, 0], rel=1e-9)


@pytest.mark.parametrize("amplitude", [0.3, 1.2, 2.8])
def test_pendulum__rests_after_half_the_period_by_the_elliptic_integral(amplitude):
    own = machine(pendulum({"go": run("gravity", time=1.0)}, MASS, ARM, OWN), "time")
    begin, count = -math.pi / 2 - amplitude, 1
    found = walked(own, np.zeros((2, count)), np.inf, start=begin, pace=1e-3)
    period = 4.0 * mp.ellipk(mp.sin(mp.mpf(amplitude) / 2) ** 2) / mp.sqrt(mp.mpf(WEIGHT) / SWINGING)
    assert found.why[0] == Why.GUARD + 3
    # A step misses 1e-12 of its angle and of the speed; near the end the speed changes by 1e-12 of the greatest in a
    # time of about as much.
    assert found.turned[0] == pytest.approx(2.0 * amplitude, rel=1e-10)
    assert found.at[0] == pytest.approx(float(period / 2), rel=1e-9)
    bottom = walked(own, np.zeros((2, count)), np.inf, start=begin, pace=1e-3, extremes=True)
    # ½ I ω² is the weight's drop.
    fastest = math.sqrt(2.0 * WEIGHT * (1.0 - math.cos(amplitude)) / SWINGING)
    assert bottom.fastest[0] == pytest.approx(fastest, rel=1e-10)


def test_angle_and_time__are_the_same_motion():
    scene = slider_crank({"go": run("dc cut gravity fan", time=1.0)}, flywheel=0.1)
    first, second = machine(scene, "angle"), machine(scene, "time")
    # At φ = 0 the ram stands still.
    inertia = 0.02 + 2.0 * 0.03**2
    turned = walked(first, np.array([[0.5 * inertia * 400.0]]), 3.0 * TURN)
    timed = walked(second, np.array([[0.0], [20.0]]), np.inf, other_goal=3.0 * TURN, pace=1e-2)
    assert timed.why[0] == Why.OTHER_GOAL
    np.testing.assert_allclose(timed.at, turned.states[1], rtol=1e-10)
    np.testing.assert_allclose(0.5 * inertia * timed.states[1] ** 2, turned.states[0], rtol=1e-10)
