"""Parallel coordinates: which columns, and labels and numbers that keep clear of each other."""

from itertools import combinations

import numpy as np
from each_case import each
from matplotlib.backends.backend_agg import FigureCanvasAgg

from engine import Verdict
from sweeps.pictures.style import house_style, new_figure, wrapped
from sweeps.pictures.sweep import parallel_coordinates
from sweeps.pictures.sweep.parallel_coordinates import chosen_columns, parallel
from sweeps.pictures.sweep.sweep_data import SweepData

PATHS = [
    "input.length",
    "groups.drive.first.length",
    "groups.conrod_of_the_press.second.offset",
    "guides.ram_way.angle",
]
WORDS = "greatest moment of the drive over one cycle at uniform speed of the main shaft"


def columns(varied, summaries, scale=1.0, variants=20):
    rng = np.random.default_rng(5)
    names = [*varied, *summaries]
    arrays = {name: scale * rng.random(variants) for name in names}
    units = dict.fromkeys(varied, "m") | dict.fromkeys(summaries, "kg m2 rad-1")
    words = {name: WORDS[: 29 + 12 * i] for i, name in enumerate(summaries)}
    return SweepData(arrays, units, words, varied, summaries, (variants,), np.zeros(variants, np.uint8))


def long_paths(count):
    return [f"{PATHS[i % 4]}{i // 4 or ''}" for i in range(count)]


def outlines(figure, axes):
    """Corners on paper [px] of labels and numbers, as they stand, slanting ones too."""
    renderer = FigureCanvasAgg(figure).get_renderer()
    figure.draw_without_rendering()
    for text in [*axes.get_xticklabels(), *axes.texts]:
        turn = np.exp(1j * np.radians(text.get_rotation()))
        slanting = text.get_window_extent(renderer)
        centre = complex(slanting.x0 + slanting.x1, slanting.y0 + slanting.y1) / 2
        angle = text.get_rotation()
        text.set_rotation(0)
        box = text.get_window_extent(renderer)
        text.set_rotation(angle)
        corners = np.array([-1 - 1j, 1 - 1j, 1 + 1j, -1 + 1j]) / 2
        yield centre + turn * (corners.real * box.width + 1j * corners.imag * box.height)


def apart(one, two):
    """Whether a line along a side of one of two rectangles separates them."""
    for u in (one[1] - one[0], one[2] - one[1], two[1] - two[0], two[2] - two[1]):
        a, b = ((corners * u.conjugate()).real for corners in (one, two))
        if a.max() <= b.min() or b.max() <= a.min():
            return True
    return False


@each("varied, summaries", [(1, 1), (3, 4), (7, 5)])
@each("scale", [1.0, -1.234e-7])
def test_labels_and_numbers__none_on_another(varied, summaries, scale):
    data = columns(long_paths(varied), [f"summary_{i}" for i in range(summaries)], scale)
    with house_style():
        figure = new_figure(180, 110)
        axes = figure.add_subplot()
        parallel(axes, data, [*data.varied, *data.summaries], "summary_0", best=3)
        found = list(outlines(figure, axes))
        height = axes.get_window_extent().height / figure.bbox.height
    assert len(found) == 3 * (varied + summaries)
    assert all(apart(one, two) for one, two in combinations(found, 2))
    # Labels must leave room for what they name.
    assert height > 0.4


def test_lines_of_many_variants__are_evenly_chosen(monkeypatch):
    monkeypatch.setattr(parallel_coordinates, "MOST_LINES", 5)
    axes = new_figure(180, 110).add_subplot()
    parallel(axes, columns(["a", "b"], ["mass"]), ["a", "b", "mass"], "mass")
    assert axes.get_title(loc="right") == "5 of 20 variants (evenly sampled)"
    assert len(axes.collections[0].get_paths()) == 5


def test_chosen_columns__varied_then_the_colour_then_summaries_in_order():
    data = columns(["a", "b"], ["mass", "cost", "force"])
    assert chosen_columns(data, "force") == ["a", "b", "force", "mass", "cost"]
    assert chosen_columns(data, "a") == ["a", "b", "mass", "cost", "force"]


def test_chosen_columns_of_many__ten_with_the_colour_among_them():
    data = columns([f"p{i}" for i in range(12)], [f"s{i}" for i in range(5)])
    assert chosen_columns(data, "s3") == [*(f"p{i}" for i in range(9)), "s3"]
    data = columns(["p"], [f"s{i}" for i in range(12)])
    assert chosen_columns(data, "s3") == ["p", "s3", "s0", "s1", "s2", *(f"s{i}" for i in range(4, 9))]


def test_column_that_is_the_same_in_all_computed_variants__left_out():
    data = columns(["a", "b"], ["mass"])
    data.arrays["b"][:] = 1.0
    data.arrays["b"][7] = 2.0
    data.status[7] = Verdict.CANNOT_ASSEMBLE
    assert chosen_columns(data, "mass") == ["a", "mass"]


def test_chosen_columns__none_for_what_the_condition_makes_equal():
    data = columns(["a", "b"], ["mass", "cost", "force"])._replace(condition="cost == 3 and force < 2")
    assert chosen_columns(data, "mass") == ["a", "b", "mass", "force"]
    assert chosen_columns(data, "cost") == ["a", "b", "cost", "force", "mass"]


def test_labels__horizontal_names_with_units():
    data = columns(long_paths(7), ["wheel_mass"])
    with house_style():
        axes = new_figure(180, 110).add_subplot()
        parallel(axes, data, [*data.varied, *data.summaries], "wheel_mass")
    labels = axes.get_xticklabels()
    assert {label.get_rotation() for label in labels} == {0.0}
    assert labels[-1].get_text().replace("\n", " ") == "wheel mass, kg·m²/rad"


def test_wrapped__broken_at_blanks_and_dots_only():
    assert wrapped("groups.drive.first.length, mm", 14) == ["groups.drive.", "first.length,", "mm"]
    assert wrapped("at 0.25 of the eccentricity", 8) == ["at 0.25", "of the", "eccentricity"]
