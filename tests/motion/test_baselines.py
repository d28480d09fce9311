"""The textbooks' methods against motions that are known: their order, their error estimates, what they keep."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from engine import Scene
from engine.mechanism.mechanics import Mechanics
from engine.motion.moments.dynamics import Dynamics, Reduction
from engine.motion.steppers.baselines import frozen_moments, trapezoids
from engine.scene.scene import Numbers, scene_numbers

EPS = np.finfo(float).eps
STALL, NO_LOAD, OWN, MASS, RADIUS, ROD = 30.0, 40.0, 0.2, 3.0, 0.1, 0.4
METHODS = [(frozen_moments, 1), (trapezoids, 2)]

SCENE = {
    "points": {"O": {"x": 0, "y": 0}},
    "guides": {"ways": {}},
    "input": {"type": "crank", "pivot": "O", "pin": "A", "length": RADIUS, "speed": 10.0},
    "groups": {
        "drive": {
            "type": "RRP",
            "inner": "B",
            "first": {"link": "rod", "joint": "A", "length": ROD},
            "second": {"link": "ram", "guide": "ways"},
        }
    },
    "bodies": {"drum": {"link": "crank", "mass": 1.0, "inertia": OWN}, "ram_body": {"link": "ram", "mass": MASS}},
    "moments": {
        "motor": {"type": "dc_motor", "on": "crank", "no_load_speed": NO_LOAD, "stall_moment": STALL},
        "rub": {"type": "against_motion", "on": "crank", "moment": 4.0},
        "turn": {
            "type": "table",
            "on": "crank",
            "over_angle": [0.0, 1.0, 6.0],
            "moment": [2.0, -3.0, 2.5],
            "interpolation": "spline",
        },
    },
}


def made(steps, off=(), variants=1, **scene):
    """Dynamics, variants and tables of a cycle, without the actions `off`."""
    scene = Scene.model_validate({**SCENE, **scene})
    reduction = Reduction(Mechanics(scene))
    dynamics = Dynamics(reduction, frozenset(off))
    every = reduction.variants(Numbers(scene_numbers(scene), {}), np.ones(variants), np.zeros(variants))
    driven = dynamics.driven(every)
    return dynamics, driven, dynamics.tables(driven, dynamics.grid(driven, np.zeros(variants), dynamics.cycle, steps))


def inertia(phi):
    """Of the ram, m (dx/dφ)² with x = r cos φ + √(l² − r² sin² φ), and of the drum."""
    s, c = RADIUS * np.sin(phi), RADIUS * np.cos(phi)
    return OWN + MASS * (s + s * c / np.sqrt(ROD**2 - s * s)) ** 2


def reference(energy, cycles):
    """ω and t after some cycles under the motor and the friction, dE/dφ = M(√(2E/I)), dt/dφ = 1/ω."""

    def rates(phi, y):
        omega = np.sqrt(2.0 * y[0] / inertia(phi))
        return [STALL * (1.0 - omega / NO_LOAD) - 4.0, 1.0 / omega]

    end = 2.0 * np.pi * cycles
    found = solve_ivp(rates, (0.0, end), [energy, 0.0], method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    return np.sqrt(2.0 * found[0] / inertia(end)), found[1]


@pytest.mark.parametrize(("method", "order"), METHODS)
def test_baseline__has_its_order_and_knows_its_error(method, order):
    energy, cycles = 12.0, 2
    omega, time = reference(energy, cycles)
    errors = []
    for steps in (120, 240, 480):
        found = method(*made(steps, {"turn"}), np.array([energy]), cycles)
        assert found.omega.shape == found.time.shape == (cycles * steps + 1, 1)
        errors.append((found.omega[-1, 0] - omega, found.time[-1, 0] - time))
        # The leading term alone makes the estimate; what follows it is less by about the step, 0.05 rad at most.
        estimates = np.array([found.omega_error[-1, 0], found.time_error[-1, 0]])
        assert np.abs(errors[-1]) == pytest.approx(estimates, rel=0.15)
    orders = np.log2(np.abs(errors[:-1]) / np.abs(errors[1:]))
    assert orders == pytest.approx(np.full((2, 2), order), abs=0.1)


@pytest.mark.parametrize(("method", "order"), METHODS)
def test_machine_without_moments__keeps_its_energy(method, order):
    dynamics, variants, tables = made(60, {"motor", "rub", "turn"})
    found = method(dynamics, variants, tables, np.array([7.0]), 3)
    kinetic = 0.5 * tables.inertia[0:-1:2, 0] * found.omega[:60, 0] ** 2
    assert kinetic == pytest.approx(np.full(60, 7.0), rel=4 * EPS)
    # Every turn the same.
    assert (found.omega[60:120] == found.omega[:60]).all()
    assert found.omega_error.max() == 0.0


def test_frozen_moments__are_exact_where_nothing_changes():
    scene = {"groups": {}, "guides": {}, "bodies": {"drum": SCENE["bodies"]["drum"]}}
    found = frozen_moments(*made(30, {"motor", "turn"}, **scene), np.array([0.5 * OWN * 40.0**2]), 2)
    # ω² = ω0² − 2 M φ/I, t = I (ω0 − ω)/M; some 120 steps.
    phi = np.linspace(0.0, 4.0 * np.pi, 61)
    omega = np.sqrt(1600.0 - 2.0 * 4.0 / OWN * phi)
    assert found.omega[:, 0] == pytest.approx(omega, rel=200 * EPS)
    assert found.time[:, 0] == pytest.approx(OWN / 4.0 * (40.0 - omega), rel=200 * EPS, abs=1e-15)
    assert found.omega_error.max() <= 200 * EPS * 40.0


def test_trapezoids__are_exact_for_a_moment_that_is_straight_between_nodes():
    straight = {"turn": {**SCENE["moments"]["turn"], "over_angle": [0.0, np.pi], "interpolation": "linear"}}
    straight["turn"]["moment"] = [6.0, -2.0]
    dynamics, variants, tables = made(32, moments=straight)
    found = trapezoids(dynamics, variants, tables, np.array([50.0]))
    # ∫M dφ from 6 to −2 over half a turn and back again.
    phi = np.linspace(0.0, 2.0 * np.pi, 33)
    half = np.minimum(phi, 2.0 * np.pi - phi)
    work = 6.0 * half - 4.0 / np.pi * half**2
    work = np.where(phi <= np.pi, work, 4.0 * np.pi - work)
    even = dynamics.grid(variants, np.zeros(1), dynamics.cycle, 32).even
    omega = found.omega[even[:, 0], 0]
    assert 0.5 * inertia(phi) * omega**2 == pytest.approx(50.0 + work, rel=100 * EPS)


@pytest.mark.parametrize(("method", "order"), METHODS)
def test_machine_that_stops__is_unknown_from_there_and_others_go_on(method, order):
    dynamics, variants, tables = made(60, {"motor", "turn"}, variants=2)
    # 4 N·m take 25 J a turn.
    found = method(dynamics, variants, tables, np.array([5.0, 50.0]))
    stopped = np.isnan(found.omega[:, 0])
    assert stopped.argmax() == pytest.approx(60 * 5.0 / (2.0 * np.pi * 4.0), abs=2)
    assert stopped[stopped.argmax() :].all()
    assert np.isfinite(found.omega[:, 1]).all()
    assert np.isfinite(found.time[:, 1]).all()
