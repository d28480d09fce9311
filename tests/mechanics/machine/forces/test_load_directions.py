"""Where bearings are loaded: closed forms of an unbalanced wheel, and directions sorted by NumPy."""

import math

import numpy as np
import pytest
from machines import crank, frame, moving
from press import actions, bodies, press
from scipy.special import ellipe

from engine import Machine, Scene, Verdict
from engine.cycle.measures.unloaded_arcs import LEAST_LOAD
from engine.scene.pairs import Pair, pairs
from engine.scene.scene import scene_numbers
from sweeps.text.scene_text import read_scene
from sweeps.text.templates import bundled_templates

EPS = np.finfo(float).eps
TURN = 2 * math.pi


def summaries_of(pair: str, link: str) -> list[str]:
    kinds = ("load_direction", "load_spread", "unloaded_arc", "unloaded_middle")
    return [f"{pair}.{kind}_of_{link}" for kind in kinds]


def answers(scene: dict, names: list[str], **settings: object) -> dict[str, tuple[float, float]]:
    outcome = Machine(Scene.model_validate(scene), names, **settings).evaluate({})
    assert outcome.status[0] == Verdict.OK
    return {name: (float(outcome.summaries[name][0]), float(outcome.errors[name][0])) for name in names}


def close(answer: tuple[float, float], expected: float) -> bool:
    """Whether an angle is the expected one within its error estimate and some roundings."""
    value, error = answer
    return abs(math.remainder(value - expected, TURN)) <= error + 8 * EPS


# An unbalanced wheel

WEIGHT, RADIUS = 30.0, 0.1


def wheel(share: float) -> dict:
    """A wheel whose unbalance pulls by so much of its weight."""
    return {
        "points": {"O": frame(0.0, 0.0)},
        "gravity": 10.0,
        "input": crank(speed=math.sqrt(share * 10.0 / RADIUS)),
        "bodies": {"disc": {"link": "crank", "mass": WEIGHT / 10.0, "x": RADIUS}},
    }


@pytest.mark.parametrize(("share", "positions"), [(0.02, 24), (0.3, 96), (0.9, 720)])
def test_wheel_heavier_than_its_unbalance_pulls__loads_its_bush_below(share, positions):
    found = answers(wheel(share), summaries_of("input", "frame"), positions=positions)
    direction, spread, arc, middle = found.values()
    assert close(direction, -math.pi / 2)
    assert close(middle, math.pi / 2)
    assert abs(arc[0] - (TURN - 2 * math.asin(share))) <= arc[1]
    # The mean of |W + U e^(i phi)| is an elliptic integral, the mean vector W.
    mean = 2 / math.pi * (1 + share) * ellipe(4 * share / (1 + share) ** 2)
    assert abs(spread[0] - (1 - 1 / mean)) <= spread[1] + 8 * EPS


@pytest.mark.parametrize("share", [0.02, 0.9])
def test_wheel_heavier_than_its_unbalance_pulls__loads_its_shaft_all_around(share):
    direction, spread, arc, middle = answers(wheel(share), summaries_of("input", "crank")).values()
    # The mean force on the shaft, in its axes, is what holds the unbalance.
    assert close(direction, math.pi)
    mean = 2 / math.pi * (1 + share) * ellipe(4 * share / (1 + share) ** 2)
    assert abs(spread[0] - (1 - share / mean)) <= spread[1] + 8 * EPS
    assert 0 <= arc[0] <= arc[1]
    assert math.isnan(middle[0])


def test_wheel_lighter_than_its_unbalance_pulls__loads_its_shaft_on_one_side():
    share = 4.0
    _, _, arc, middle = answers(wheel(share), summaries_of("input", "crank")).values()
    assert abs(arc[0] - (TURN - 2 * math.asin(1 / share))) <= arc[1]
    assert close(middle, 0.0)


def test_steady_load__in_one_direction():
    direction, spread, arc, middle = answers(wheel(1e-12), summaries_of("input", "frame")).values()
    assert close(direction, -math.pi / 2)
    assert abs(spread[0]) <= spread[1] + 8 * EPS
    assert arc[0] == pytest.approx(TURN, rel=1e-11)
    assert close(middle, math.pi / 2)


def test_no_load__no_direction():
    scene = wheel(1.0) | {"bodies": {}}
    found = answers(scene, summaries_of("input", "frame"))
    assert [math.isnan(value) for value, _ in found.values()] == [True, True, False, True]
    assert found["input.unloaded_arc_of_frame"][0] == TURN


# Any machine


def bearings(scene: Scene, *names: str) -> list[Pair]:
    return [pair for pair in pairs(scene) if pair.name in names]


def sorted_arc(force: np.ndarray) -> tuple[float, float]:
    """Widest gap between sorted directions, and its middle."""
    angles = np.sort(np.angle(force[np.abs(force) >= LEAST_LOAD * np.abs(force).max()]))
    gaps = np.diff(angles, append=angles[0] + TURN)
    widest = gaps.argmax()
    return gaps[widest], angles[widest] + gaps[widest] / 2


def with_chords(force: np.ndarray) -> np.ndarray:
    """A force at close positions, and on straight lines between these where it turns much, but for its jumps."""
    step, largest = np.diff(force), np.abs(force).max()
    turns = (np.abs(np.angle(force[1:] / force[:-1])) > 0.01) & (np.abs(step) < 0.02 * largest)
    chords = force[:-1][turns] + np.linspace(0.0, 1.0, 200)[:, None] * step[turns]
    return np.append(force, chords.ravel())


def arcs_of_variants(template: str, count: int, spread: float, positions: int):
    """Unloaded arcs of random variants of a template: name and variant, force at positions, arc and its estimate."""
    scene = read_scene(bundled_templates()[template])
    revolute = [pair for pair in pairs(scene) if pair.kind == "revolute"]
    names = [f"{pair.name}.unloaded_arc_of_{link}" for pair in revolute for link in (pair.link, pair.other)]
    links = {link for pair in revolute for link in (pair.link, pair.other)} - {"frame"}
    fields = [f"{pair.name}.reaction_{axis}" for pair in revolute for axis in "xy"]
    fields += [f"{link}.angle" for link in links]
    rng, numbers = np.random.default_rng(8), scene_numbers(scene)
    paths = [path for path, n in numbers.items() if path.endswith((".length", ".mass", "speed", ".force")) and n.value]
    varied = {path: numbers[path].value * rng.uniform(1.0 - spread, 1.0 + spread, count) for path in paths}
    outcome = Machine(scene, names, fields, paths, positions).evaluate(varied)
    sound = np.flatnonzero(outcome.status == Verdict.OK)
    assert sound.size > count // 2
    for pair in revolute:
        force = outcome.fields[f"{pair.name}.reaction_x"] + 1j * outcome.fields[f"{pair.name}.reaction_y"]
        for link, sign in ((pair.link, 1), (pair.other, -1)):
            own = sign * force * np.exp(-1j * outcome.fields.get(f"{link}.angle", np.zeros(1)))
            name = f"{pair.name}.unloaded_arc_of_{link}"
            for i in sound:
                yield (name, i), own[i], outcome.summaries[name][i], outcome.errors[name][i]


@pytest.mark.parametrize("template", ["offset_slider_crank", "toggle", "geared_five_bar"])
def test_bearings_of_variants__as_sorted_by_numpy_however_panels_fall(template):
    # Directions begin and end anywhere on the circle; forces jump, and nearly vanish.
    for case, force, found, error in arcs_of_variants(template, 12, 0.1, 20_000):
        # No direction lies in the arc, but those of chords by what they miss of the curve.
        assert -error - 0.01 < sorted_arc(with_chords(force))[0] - found < 0.05, (case, found)


def test_error_figures__hold_at_any_accuracy():
    # Forces of this press jump where its ram turns back.
    scene = press(bodies=bodies(), forces={"cut": actions()["forces"]["cut"]})
    revolute = bearings(Scene.model_validate(scene), "input", "drive.inner")
    names = [n for pair in revolute for link in (pair.link, pair.other) for n in summaries_of(pair.name, link)]
    coarse, fine = (answers(scene, names, accuracy=accuracy) for accuracy in (1e-2, 1e-9))
    for name, (value, error) in coarse.items():
        gap = value - fine[name][0]
        gap = gap if "spread" in name or "arc" in name else math.remainder(gap, TURN)
        assert abs(gap) <= error + fine[name][1], (name, value, error, fine[name])


def test_arc_that_ends_where_a_force_between_teeth_changes_sides__holds_at_any_accuracy():
    """The direction has a kink there, next to an end of a panel."""
    scene, rng = read_scene(bundled_templates()["elliptical_wheels"]), np.random.default_rng(4)
    numbers = {path: scene_numbers(scene)[path].value for path in ("points.D.x", "groups.drive.first.length")}
    varied = {path: value * rng.uniform(0.7, 1.4, 256) for path, value in numbers.items()}
    for name in ("second.unloaded_arc_of_frame", "second.unloaded_middle_of_frame"):
        exact = Machine(scene, [name], (), list(varied), accuracy=1e-12).evaluate(varied)
        for accuracy in (1e-3, 1e-6, None):
            found = Machine(scene, [name], (), list(varied), accuracy=accuracy).evaluate(varied)
            off = np.abs(np.remainder(found.summaries[name] - exact.summaries[name] + math.pi, TURN) - math.pi)
            known = np.isfinite(off)
            assert (off[known] <= (found.errors[name] + exact.errors[name])[known]).all()


def test_direction_of_a_reaction__continuous_angle_of_its_components():
    fields = [f"input.reaction{part}" for part in ("_direction", "_x", "_y")]
    angle, x, y = moving(wheel(4.0), fields, 72)[1].values()
    np.testing.assert_allclose(np.exp(1j * angle), (x + 1j * y) / np.hypot(x, y), rtol=0, atol=1e-13)
    # The force turns with the unbalance, once around.
    assert np.abs(np.diff(angle)).max() < math.pi
    assert angle[-1] - angle[0] == pytest.approx(TURN * 71 / 72, abs=0.1)


@pytest.mark.parametrize("accuracy", [1e-4, None, 1e-11])
def test_bar_that_is_pushed_and_pulled__has_its_oil_hole_on_the_same_side_in_all_variants(accuracy):
    """Both sides of a light bar are unloaded: rounding must not choose between them."""
    scene = press() | {"bodies": {"ram_body": {"link": "ram", "mass": 5.0}}}
    varied = {"groups.drive.first.length": np.linspace(0.85, 1.0, 64)}
    names = [f"drive.{pair}.unloaded_{kind}_of_link" for kind in ("arc", "middle") for pair in ("first", "inner")]
    outcome = Machine(Scene.model_validate(scene), names, varied=list(varied), accuracy=accuracy).evaluate(varied)
    for name in names:
        exact = math.pi if "arc" in name else -math.pi / 2
        np.testing.assert_array_less(np.abs(outcome.summaries[name] - exact), outcome.errors[name] + 8 * EPS)
