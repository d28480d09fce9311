"""Quick-return mechanisms found from stroke and time ratio: by other reckonings, and as the engine measures them."""

import math
from pathlib import Path

import numpy as np
import pytest
from commands import refused, said
from each_case import refusals
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar

from engine import Machine
from sweeps import read_scene
from sweeps.synthesis.quick_return import quick_crank_rocker, quick_lever, quick_return_angle, quick_slider_crank
from sweeps.synthesis.synthesis_error import SynthesisError

RATIOS = st.floats(1.02, 2.5)
LENGTHS = st.floats(1e-3, 1e3)


def extremes(position):
    """Greatest and least value over a turn, and the crank angles there: by looking everywhere, then nearby."""
    angles = np.linspace(0.0, 2 * math.pi, 721)
    values = position(angles)
    found = []
    for sign, k in ((-1, int(np.argmax(values))), (1, int(np.argmin(values)))):
        near = (angles[k] - 0.02, angles[k] + 0.02)
        best = minimize_scalar(
            lambda a, sign=sign: sign * position(a), bounds=near, method="bounded", options={"xatol": 1e-12}
        )
        found.append((float(position(best.x)), best.x))
    return found


def measured_ratio(highest, lowest):
    up = (highest[1] - lowest[1]) % (2 * math.pi)
    slow = max(up, 2 * math.pi - up)
    return slow / (2 * math.pi - slow)


# Where values are extreme they are flat: a search knows the place only to the root of rounding, about 1e-8 of a radian,
# and the ratio to (1 + K)²/2π of two such; 1e-6 leaves room for sharp ends, where transmission angles are small.
PLACES = 1e-6


@given(stroke=LENGTHS, ratio=RATIOS, share=st.floats(0.0, 1.0))
def test_slider_crank__has_stroke_and_ratio(stroke, ratio, share):
    theta = quick_return_angle(ratio)
    rod = stroke * (0.5 + share * (0.5 / math.sin(theta / 2) - 0.5))
    try:
        found = quick_slider_crank(stroke, ratio, rod)
    except SynthesisError:
        assume(False)
    assume(math.sin(found.least_transmission) > 0.1)

    def slider(angle):
        return found.crank * np.cos(angle) + np.sqrt(rod**2 - (found.crank * np.sin(angle) - found.offset) ** 2)

    highest, lowest = extremes(slider)
    assert highest[0] - lowest[0] == pytest.approx(stroke, rel=1e-9)
    assert measured_ratio(highest, lowest) == pytest.approx(ratio, abs=PLACES)


@settings(max_examples=15)
@given(rocker=LENGTHS, swing=st.floats(0.3, 2.0), ratio=st.floats(1.0, 1.5))
def test_crank_rocker__has_swing_and_ratio(rocker, swing, ratio):
    try:
        found = quick_crank_rocker(rocker, swing, ratio)
    except SynthesisError:
        assume(False)
    assume(math.sin(found.least_transmission) > 0.1)

    def direction(angle):
        pin = found.crank * np.exp(1j * np.asarray(angle))
        to = pin - found.frame
        inside = (abs(to) ** 2 + found.rocker**2 - found.coupler**2) / (2 * abs(to) * found.rocker)
        return np.mod(np.angle(to), 2 * math.pi) - np.arccos(inside)

    highest, lowest = extremes(direction)
    assert highest[0] - lowest[0] == pytest.approx(swing, rel=1e-9)
    assert measured_ratio(highest, lowest) == pytest.approx(ratio, abs=PLACES)


@settings(max_examples=15)
@given(ratio=st.floats(1.05, 1.4), swing=st.floats(0.5, 1.5))
def test_coupler_of_its_own__is_the_best(ratio, swing):
    try:
        best = quick_crank_rocker(1.0, swing, ratio)
    except SynthesisError:
        assume(False)
    for factor in (0.7, 0.9, 0.99, 1.01, 1.1, 1.5):
        try:
            other = quick_crank_rocker(1.0, swing, ratio, factor * best.coupler)
        except SynthesisError:
            continue
        # The search ends where lengths differ by 1e-7; the angle may be steep there.
        assert other.least_transmission < best.least_transmission + 1e-5


@given(stroke=LENGTHS, ratio=st.floats(1.01, 20.0), frame=LENGTHS)
def test_lever__swings_between_tangents_of_the_crank_circle(stroke, ratio, frame):
    found = quick_lever(stroke, ratio, frame)
    # The pin's direction from the lever's bearing is extreme where arcsin(crank/frame) is reached, by trigonometry.
    half = math.asin(found.crank / frame)
    assert (math.pi + 2 * half) / (math.pi - 2 * half) == pytest.approx(ratio, rel=1e-12)
    assert 2 * found.lever * math.sin(half) == pytest.approx(stroke, rel=1e-12)


test_what_cannot_be__is_refused_in_words = refusals(
    lambda make: make(),
    (lambda: quick_slider_crank(0.3, 0.5), "at least 1"),
    (lambda: quick_slider_crank(0.3, math.nan), "at least 1"),
    (lambda: quick_slider_crank(-0.3, 1.2), "greater than 0"),
    (lambda: quick_slider_crank(0.3, 1.0), "give the rod"),
    (lambda: quick_slider_crank(0.3, 3.5), "less than 3"),
    (lambda: quick_slider_crank(0.3, 1.4, 5.0), "about 0.15 … to 0.5 … m"),
    (lambda: quick_crank_rocker(0.1, 1.0, 6.0), "slotted lever"),
    (lambda: quick_crank_rocker(0.1, 4.0, 1.2), "between 0 and 180°"),
    (lambda: quick_crank_rocker(0.1, 1.0, 1.2, 50.0), "it may be about"),
    (lambda: quick_lever(0.3, 1.0, 0.2), "greater than 1"),
    (lambda: quick_lever(0.3, 1.5, math.inf), "pivots"),
)


# As commands, measured by the engine, which knows the ends of strokes to rounding; scenes have all digits of numbers.
ROUNDING = 1e-11


def measured(*asked):
    machine = Machine(read_scene("found.toml"), asked)
    return [float(values[0]) for values in machine.evaluate({}).summaries.values()]


@pytest.mark.parametrize(
    ("command", "asked", "expected"),
    [
        (
            ("slider-crank", "--stroke", "300 mm", "--ratio", "1.4"),
            ("slider.stroke", "slider.stroke_time_ratio"),
            (0.3, 1.4),
        ),
        (
            ("crank-rocker", "--swing", "60 deg", "--rocker", "140 mm", "--ratio", "1.2", "--speed", "-90 rpm"),
            ("rocker.swing", "rocker.swing_time_ratio"),
            (math.pi / 3, 1.2),
        ),
        (
            ("shaper", "--stroke", "300 mm", "--ratio", "1.6", "--frame", "240 mm"),
            ("ram.stroke", "ram.stroke_time_ratio"),
            (0.3, 1.6),
        ),
        (
            ("shaper", "--stroke", "300 mm", "--ratio", "20", "--frame", "240 mm"),
            ("ram.stroke", "ram.stroke_time_ratio"),
            (0.3, 20.0),
        ),
        (
            ("slider-crank", "--stroke", "12 in", "--ratio", "1.4"),
            ("slider.stroke", "slider.stroke_time_ratio"),
            (12 * 0.0254, 1.4),
        ),
    ],
)
def test_command__writes_a_scene_that_does_what_was_wanted(tmp_path, monkeypatch, command, asked, expected):
    monkeypatch.chdir(tmp_path)
    answer = said("synthesise", *command, "--out", "found.toml")
    assert answer.exit_code == 0, answer.output
    assert measured(*asked) == pytest.approx(expected, rel=ROUNDING)
    # A person may have edited it since.
    assert "exists already" in refused("synthesise", *command, "--out", "found.toml")
    text = Path("found.toml").read_text()
    assert text.startswith("# ")
    # In the units of the options.
    assert (' in"' in text, ' mm"' in text) == ("12 in" in command, "12 in" not in command)


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (("slider-crank", "--stroke", "300", "--ratio", "1.3"), ("--stroke", "300 mm")),
        (("slider-crank", "--stroke", "300 mm", "--ratio", "1.3", "--speed", "3 m"), ("--speed", "rpm")),
        (("crank-rocker", "--swing", "60 mm", "--rocker", "1 m", "--ratio", "1.1"), ("--swing", "angle")),
        (("shaper", "--stroke", "300 mm", "--ratio", "0.9", "--frame", "1 m"), ("at least 1",)),
    ],
)
def test_nonsense__is_refused_with_the_option(tmp_path, monkeypatch, command, words):
    monkeypatch.chdir(tmp_path)
    answer = refused("synthesise", *command)
    assert all(word in answer for word in words), answer
    assert not list(tmp_path.iterdir())
