"""Counterweights against closed forms, brute force, and bounds that no others can pass."""

import math

import numpy as np
import pytest
from each_case import refusals
from hypothesis import given, settings
from hypothesis import strategies as st
from machines import crank, four_bar, frame, rrp, rrr
from machines import slider_crank as crank_and_ram
from oracle import EPS

from engine import Machine, MovingMachine, Scene, Verdict
from engine.machine.balancing import least_shaking
from engine.machine.balancing.counterweights import BalanceError, CounterweightPlace, balance
from engine.machine.balancing.least_shaking import GAP, DependentError, Unknown, least_peak, least_rms

SPEED = 5.0
SHAKING = ("shaking_force_x", "shaking_force_y", "shaking_moment")


def shaking_of(scene: Scene) -> np.ndarray:
    """Shaking of a scene by the engine, (3, positions)."""
    machine = MovingMachine(scene, positions=360)
    assert machine.verdict(SHAKING) == Verdict.OK
    return np.stack([*machine.fields(SHAKING).values()])


# Least root mean square and least peak


def problem(seed: int) -> tuple[np.ndarray, np.ndarray, list[Unknown]]:
    """Balancing vectors and masses on what turns and swings, with and without limits, some of which are reached."""
    rng = np.random.default_rng(seed)
    phi = 2 * np.pi * np.arange(120) / 120
    columns, unknowns = [], []
    for i in range(rng.integers(1, 4)):
        angle = (phi, 0.7 * np.sin(phi + 1), -2 * phi)[i]
        way = np.exp(1j * (angle + rng.uniform(0, 6))) * rng.uniform(0.1, 10)
        size = int(rng.integers(1, 3))
        columns += [way, 1j * way][:size]
        unknowns.append(Unknown(size, float(rng.choice([np.inf, 0.05, 0.5]) * 10 / abs(way[0]))))
    orders = np.arange(-3, 4)[:, None]
    b = (rng.normal(size=7) + 1j * rng.normal(size=7)) * 5 @ np.exp(1j * orders * phi)
    a = np.stack([np.stack((c.real, c.imag), -1) for c in columns], -1)
    return a, np.stack((b.real, b.imag), -1), unknowns


def places_of(unknowns: list[Unknown]) -> list[slice]:
    ends = np.cumsum([u.size for u in unknowns])
    return [slice(end - u.size, end) for u, end in zip(unknowns, ends, strict=True)]


def allowed(z: np.ndarray, unknowns: list[Unknown]) -> np.ndarray:
    """Points within the limits, from any ones (points, unknowns)."""
    z = z.copy()
    for u, place in zip(unknowns, places_of(unknowns), strict=True):
        if u.size == 1:
            z[:, place] = np.clip(z[:, place], 0, u.most)
        else:
            z[:, place] *= np.minimum(1, u.most / np.linalg.norm(z[:, place], axis=1, keepdims=True))
    return z


def left(z: np.ndarray, a: np.ndarray, b: np.ndarray, peak: bool) -> np.ndarray:
    squares = ((np.einsum("kpn,zn->zkp", a, z) + b) ** 2).sum(axis=2)
    return np.sqrt(squares.max(axis=1) if peak else squares.mean(axis=1))


@pytest.mark.parametrize("peak", [False, True])
@settings(max_examples=12)
@given(seed=st.integers(0, 10**6))
def test_optimum__surpasses_brute_force_and_brute_force_its_bound(peak, seed):
    a, b, unknowns = problem(seed)
    found = (least_peak if peak else least_rms)(a, b, unknowns)
    z = found.unknowns
    np.testing.assert_allclose(allowed(z[None], unknowns)[0], z, rtol=8 * EPS)
    assert found.value == pytest.approx(left(z[None], a, b, peak)[0], rel=1e-13)
    before = left(0 * z[None], a, b, peak)[0]
    # By construction; the least squares' bound misses by roundings of what was there before, squared under a root.
    assert -1e-12 * before <= found.value - found.bound <= (GAP if peak else 1e-7) * before
    rng = np.random.default_rng(seed)
    scale = np.abs(z).max() + before / np.sqrt((a**2).sum(axis=1).mean(axis=0).max())
    for spread in (1.0, 1e-2, 1e-4):
        tried = left(allowed(z + spread * scale * rng.normal(size=(300, z.size)), unknowns), a, b, peak)
        assert tried.min() >= found.value - (GAP if peak else 1e-14) * before


@settings(max_examples=12)
@given(seed=st.integers(0, 10**6), steps=st.integers(0, 8))
def test_bound_of_a_search_that_is_cut_short__holds_nevertheless(seed, steps):
    a, b, unknowns = problem(seed)
    best = least_rms(a, b, unknowns)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(least_shaking, "MOST_STEPS", steps)
        rough = least_rms(a, b, unknowns)
    assert rough.bound <= best.value * (1 + 1e-12)
    assert rough.value >= best.value * (1 - 1e-12)


def test_nothing_that_shakes__needs_nothing():
    a, b, unknowns = problem(3)
    for solve in (least_rms, least_peak):
        found = solve(a, 0 * b, unknowns)
        assert not found.unknowns.any()
        assert found.value == found.bound == 0.0


def test_unknowns_of_the_same_effect__are_refused():
    a, b, _ = problem(1)
    with pytest.raises(DependentError) as refusal:
        least_rms(np.concatenate((a[:, :, :1], a[:, :, :1]), axis=2), b, [Unknown(1), Unknown(1)])
    assert refusal.value.columns.tolist() == [0, 1]


# Full balance

fraction = st.floats(-1.0, 1.0)


@st.composite
def four_bars(draw):
    """Crank-rockers of all proportions that transmit well, with three bodies anywhere on their links."""
    crank_length = draw(st.floats(0.05, 0.4))
    coupler, rocker = (draw(st.floats(0.9, 1.2)) for _ in range(2))
    x, y = 1.0 + draw(fraction) * 0.1, draw(fraction) * 0.2
    bodies = {}
    for link in ("crank", "coupler", "rocker"):
        mass, inertia = draw(st.floats(0.1, 10)), draw(st.floats(0.01, 1))
        place = {"x": 0.05 + draw(st.floats(0.0, 1.0)), "y": 0.01 + draw(st.floats(0.0, 0.5))}
        bodies[f"{link}_body"] = {"link": link, "mass": mass, "inertia": inertia, **place}
    return {
        "points": {"O": frame(0.1, -0.2), "D": frame(0.1 + x, -0.2 + y)},
        "input": crank(length=crank_length),
        "groups": {"bars": rrr("B", ("coupler", "A", coupler), ("rocker", "D", rocker))},
        "bodies": bodies,
    }


@settings(max_examples=8)
@given(four_bars())
def test_full_balance_of_a_four_bar__is_that_of_berkof_and_lowen(data):
    scene = Scene.model_validate(data)
    found = balance(scene, ["crank", "rocker"])
    b = {name.removesuffix("_body"): body for name, body in scene.bodies.items()}
    moment = {link: body.mass * complex(body.x, body.y) for link, body in b.items()}
    bars = scene.groups["bars"]
    share = moment["coupler"] / bars.first.length
    # What the coupler's linearly dependent vector leaves on the two others.
    on_crank = moment["crank"] + (b["coupler"].mass - share) * scene.input.length
    on_rocker = moment["rocker"] + share * bars.second.length
    for weight, closed in zip(found.counterweights, (on_crank, on_rocker), strict=True):
        # Roundings of the rows, times the condition of the two links' effects: rockers that swing little are alike.
        size = abs(on_crank) + abs(on_rocker) + b["coupler"].mass
        assert abs(weight.mass * complex(weight.x, weight.y) + closed) <= 1e-11 * size
        assert math.hypot(weight.x, weight.y) == pytest.approx(scene.input.length, rel=4 * EPS)
        assert weight.unbalance == pytest.approx(abs(closed), abs=1e-11 * size)
    peaks = [np.hypot(*shaking_of(s)[:2]).max() for s in (scene, found.scene)]
    # Terms of the sum are at most those of all masses at the ends of their links.
    terms = SPEED**2 * sum(abs(m) for m in moment.values()) * 10
    assert peaks[1] <= 1e-13 * terms
    assert found.before == pytest.approx(np.sqrt((shaking_of(scene)[:2] ** 2).sum(axis=0).mean()), rel=1e-12)


def slider_crank(**parts) -> Scene:
    """Crank, rod and piston, moments taken about Q."""
    points, bodies = {"O": frame(0.0, 0.0), "Q": frame(0.2, 0.3)}, {"piston_body": {"link": "piston", "mass": 2.0}}
    parts = {"points": points, "bodies": bodies} | parts
    return Scene.model_validate(crank_and_ram(0.3, 1.2, slider="piston", **parts))


def test_full_balance_of_a_slider_crank__takes_a_place_beyond_the_crank_pin():
    rod = {"link": "rod", "mass": 1.5, "x": 0.4, "inertia": 0.1}
    scene = slider_crank(bodies={"piston_body": {"link": "piston", "mass": 2.0}, "rod_body": rod})
    found = balance(scene, ["crank"], [CounterweightPlace("rod", -0.5)], radius=0.25)
    on_crank, on_rod = found.counterweights
    beyond = (2.0 * 1.2 + 1.5 * 0.4) / 0.5
    assert on_rod.mass == pytest.approx(beyond, rel=1e-12)
    assert on_crank.mass == pytest.approx((2.0 + 1.5 + beyond) * 0.3 / 0.25, rel=1e-12)
    assert on_crank.x == pytest.approx(-0.25, rel=1e-12)
    assert np.hypot(*shaking_of(found.scene)[:2]).max() <= 1e-13 * found.before * 10


# Partial balance

PULL = 2.0 * 0.3 * SPEED**2


def test_least_rms_of_a_slider_crank__takes_half_of_the_reciprocating_mass():
    found = balance(slider_crank(), ["crank"], criterion="rms")
    (weight,) = found.counterweights
    # Of the first order, m r cos φ, half turns with the crank: it alone can be taken away.
    assert weight.mass == pytest.approx(2.0 / 2, rel=1e-12)
    assert weight.x == pytest.approx(-0.3, rel=1e-12)
    assert abs(weight.y) < 1e-12
    assert found.after == pytest.approx(found.bound, rel=1e-9)
    assert found.before**2 - found.after**2 == pytest.approx((PULL / 2) ** 2, rel=1e-12)


def test_lanchester_shafts__leave_the_fourth_order_alone():
    shafts = {
        name: {"geared_to": "crank", "ratio": ratio, "pivot": "O"}
        for name, ratio in (("first", -1.0), ("second", 2.0), ("against", -2.0))
    }
    found = balance(slider_crank(shafts=shafts), ["crank", *shafts], criterion="rms")
    names = [f"shaking_force.order_{n}" for n in (1, 2, 4)]
    before, after = (Machine(s, names).evaluate({}).summaries for s in (slider_crank(), found.scene))
    np.testing.assert_allclose([after[n][0] for n in names], [0, 0, before[names[2]][0]], rtol=0, atol=1e-12 * PULL)
    sizes = [weight.unbalance for weight in found.counterweights]
    # Half of an order on each of two shafts; one that turns twice as fast pulls four times as much.
    second = before[names[1]][0] / SPEED**2 / 2 / 4
    np.testing.assert_allclose(sizes, [0.3, 0.3, second, second], rtol=1e-11)


def test_limits__are_kept_and_reached():
    found = balance(slider_crank(), ["crank"], criterion="rms", most={"crank": 0.12})
    assert found.counterweights[0].unbalance == pytest.approx(0.12, rel=1e-12)
    assert found.after == pytest.approx(found.bound, rel=1e-9)
    placed = balance(
        slider_crank(),
        [],
        [CounterweightPlace("crank", -0.3, most=0.5), CounterweightPlace("crank", 0.3, 0.3)],
        criterion="rms",
    )
    assert [w.mass for w in placed.counterweights] == [0.5, 0.0]


@pytest.mark.parametrize("criterion", ["rms", "peak"])
def test_moment_with_its_weight__is_that_of_the_balanced_machine(criterion):
    data = four_bar(Q=frame(0.5, 0.4)) | {
        "shafts": {"wheel": {"geared_to": "rocker", "ratio": -3.0, "inertia": 0.05}},
        "bodies": {"b": {"link": "coupler", "mass": 2.0, "x": 0.45, "y": -0.12, "inertia": 0.15}},
        "balance": {"about": "Q"},
    }
    scene, weight = Scene.model_validate(data), 3.0
    places = [CounterweightPlace("rocker", -0.3), CounterweightPlace("rocker", 0.1, 0.3)]
    found = balance(scene, ["crank"], places, criterion, moment_weight=weight)
    rows = [shaking_of(s) * np.array([[1.0], [1.0], [weight]]) for s in (scene, found.scene)]
    size = {"rms": lambda r: np.sqrt((r**2).sum(axis=0).mean()), "peak": lambda r: np.sqrt((r**2).sum(axis=0)).max()}
    assert found.before == pytest.approx(size[criterion](rows[0]), rel=1e-12)
    assert found.after == pytest.approx(size[criterion](rows[1]), rel=1e-12)
    assert found.after < 0.7 * found.before
    assert found.after - found.bound <= 2 * GAP * found.before


def test_counterweights__are_bodies_of_the_scene_under_free_names():
    once = balance(slider_crank(), ["crank"], criterion="rms", radius=0.1).scene
    twice = balance(
        once, [], [CounterweightPlace("crank", 0.2), CounterweightPlace("crank", 0.0, 0.1)], criterion="rms"
    ).scene
    assert list(twice.bodies) == ["piston_body", *(f"crank_counterweight{end}" for end in ("", "_2", "_3"))]
    assert math.hypot(once.bodies["crank_counterweight"].x, once.bodies["crank_counterweight"].y) == pytest.approx(0.1)


test_what_cannot_be_balanced__is_said = refusals(
    lambda settings_: balance(slider_crank(), **settings_),
    ({"links": ["crank"]}, "on crank don't balance this machine fully: … N are left"),
    ({"links": ["cramk"]}, "'cramk' is not a link of this scene; … did you mean 'crank'?"),
    ({"links": ["rod"]}, "'rod' doesn't turn about a fixed axis: give a place on it; or choose from crank"),
    ({}, "no link may have a counterweight"),
    ({"links": ["crank"], "criterion": "least"}, "criterion = 'least': allowed are 'full', 'rms' and 'peak'"),
    ({"links": ["crank"], "most": {"rod": 1.0}}, "most['rod'] = 1.0: give mass times radius above 0"),
    ({"links": ["crank"], "criterion": "rms", "radius": 0.0}, "radius = 0.0: give a positive distance"),
    (
        {"links": ["crank"], "places": [CounterweightPlace("crank", 0.1)]},
        "counterweights on crank have the same effect",
    ),
)


def test_moment_on_a_link_that_swings__asks_for_a_place():
    scene = Scene.model_validate(four_bar() | {"bodies": {"b": {"link": "coupler", "mass": 2.0, "x": 0.45}}})
    with pytest.raises(BalanceError, match="on 'rocker' depends on its radius: give a place on it"):
        balance(scene, ["crank", "rocker"], criterion="rms", moment_weight=1.0)


def test_machine_that_does_not_turn__has_no_balance():
    with pytest.raises(BalanceError, match="the crank must turn fully"):
        balance(slider_crank(input=crank(start=0.0, stop=1.0)), ["crank"])
    with pytest.raises(BalanceError, match="can't be assembled"):
        balance(slider_crank(groups={"g": rrp("B", ("rod", "A", 0.2), "piston", "way")}), ["crank"])
