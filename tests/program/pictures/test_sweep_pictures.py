"""Pictures of sweeps: what is drawn is what the result holds, failed variants are told apart."""

import math
from itertools import combinations
from xml.etree import ElementTree

import numpy as np
import pytest
from each_case import each, refusals
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D

from engine import Verdict
from sweeps.pictures.machine.diagrams import diagrams
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import PALE, house_style, new_figure, save, wrapped
from sweeps.pictures.sweep import parallel_coordinates
from sweeps.pictures.sweep.maps import curves, field_band, map2d, plot_result
from sweeps.pictures.sweep.parallel_coordinates import chosen_columns, parallel
from sweeps.pictures.sweep.sweep_data import SweepData
from sweeps.store import FieldAxis
from sweeps.study.bundled import STUDIES
from sweeps.text.scene_text import read_scene


def grid_data(shape, failed=(), parameters=("a", "b")):
    places = [np.linspace(0.1, 0.2, n) * (k + 1) for k, n in enumerate(shape)]
    columns = [column.ravel() for column in np.meshgrid(*places, indexing="ij")]
    count = math.prod(shape)
    status = np.zeros(count, np.uint8)
    status[list(failed)] = Verdict.CANNOT_ASSEMBLE
    mass = np.where(status == 0, sum(columns) ** 2, np.nan)
    phi = np.arange(36) * math.pi / 18
    field = np.where(status[:, None] == 0, mass[:, None] * np.sin(phi), np.nan)
    arrays = dict(zip(parameters, columns, strict=True))
    arrays |= {"mass": mass, "mass_error": 0.1 * mass, "cost": -(sum(columns) ** 2), "moment": field}
    units = dict.fromkeys(parameters, "m") | {"mass": "kg", "cost": "1", "moment": "N m"}
    names = {"a": "a", "b": "b", "mass": "mass of the wheel", "cost": "cost", "moment": "moment"}
    axes = {"moment": FieldAxis("phi", "crank angle", "rad", phi)}
    return SweepData(arrays, units, names, parameters, ("mass", "cost"), shape, status, axes)


def test_curves__values_error_band_and_failed_variants():
    figure = Figure()
    curves(figure, grid_data((9,), failed=[0, 1], parameters=("a",)), "a", ["mass", "cost"], best=4)
    top, bottom = figure.axes
    assert top.lines[0].get_xdata() == pytest.approx(np.linspace(100, 200, 9))
    assert np.isnan(top.lines[0].get_ydata()[:2]).all()
    # A variant that failed isn't shown, whatever number it left behind.
    assert np.isnan(bottom.lines[0].get_ydata()[:2]).all()
    assert top.lines[1].get_xdata() == pytest.approx([100, 112.5])
    assert top.lines[2].get_xdata() == pytest.approx([150])
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["error estimate", "can't be assembled", "best"]
    assert top.get_legend() is None
    assert top.get_ylabel() == "Mass of the wheel, g"
    assert bottom.get_xlabel() == "a, mm"


def test_field_band__least_and_greatest_of_the_computed_variants():
    data = grid_data((4, 3), failed=[11])
    axes = Figure().add_subplot()
    field_band(axes, data, "moment", best=2)
    (band,) = axes.collections
    heights = band.get_paths()[0].vertices[:, 1]
    sound = data.arrays["moment"][:11]
    assert [heights.min(), heights.max()] == pytest.approx([sound.min(), sound.max()])
    assert axes.lines[1].get_ydata()[:-1] == pytest.approx(data.arrays["moment"][2])
    assert axes.get_xlim() == pytest.approx((0, 360))


@pytest.mark.parametrize(("x", "y"), [("a", "b"), ("b", "a")])
def test_map__cells_where_their_parameters_are_and_failed_ones_hatched(x, y):
    data = grid_data((5, 4), failed=[3, 19])
    axes = Figure().add_subplot()
    map2d(axes, data, x, y, "mass", best=7)
    mesh = axes.collections[1]
    cells = np.ma.filled(mesh.get_array(), np.nan)
    expected = data.arrays["mass"].reshape(5, 4) * 1000
    assert cells == pytest.approx(expected.T if x == "a" else expected, nan_ok=True)
    assert axes.collections[0].get_hatch()
    assert axes.collections[0].get_array().count() == 2
    star = axes.lines[0].get_xydata()[0]
    assert star == pytest.approx([1000 * data.arrays[x][7], 1000 * data.arrays[y][7]])
    assert [t.get_text() for t in axes.figure.legends[0].get_texts()] == ["best", "can't be assembled"]


@pytest.mark.parametrize("smooth", [True, False])
def test_map__contour_lines_only_where_they_can_be_followed(smooth):
    data = grid_data((30, 30))
    mass = data.arrays["mass"] if smooth else np.random.default_rng(1).random(900)
    axes = Figure().add_subplot()
    map2d(axes, data._replace(arrays=dict(data.arrays) | {"mass": mass}), "a", "b", "mass")
    assert any(isinstance(drawn, ContourSet) for drawn in axes.collections) == smooth


def test_map__of_listed_sizes_has_a_tick_each_and_no_lines_between_them():
    data = grid_data((5, 4))
    teeth = np.repeat(np.arange(20.0, 25.0), 4)
    whole = data._replace(arrays=dict(data.arrays) | {"a": teeth}, units=dict(data.units) | {"a": "1"})
    for sized, ticks in ((data._replace(listed=["a"]), "100 125 150 175 200"), (whole, "20 21 22 23 24")):
        axes = Figure().add_subplot()
        map2d(axes, sized, "a", "b", "mass")
        assert not any(isinstance(drawn, ContourSet) for drawn in axes.collections)
        assert [tick.get_text() for tick in axes.get_xticklabels()] == ticks.split()


@each(
    "shape, asked, axes",
    [
        *(((12,), {}, 2), ((6, 5), {}, 2), ((6, 1), {}, 2), ((3, 4, 5), {}, 2), ((6, 5), {"y": "moment"}, 1)),
        *(((6, 5), {"x": "mass", "y": "cost"}, 1), ((3, 4, 5), {"x": "mass", "colour": "a"}, 2)),
    ],
)
@each("failed", [(), "all"])
def test_plot_result__suits_the_grid(shape, asked, axes, failed, tmp_path):
    failed = range(math.prod(shape)) if failed == "all" else failed
    data = grid_data(shape, failed, ("a", "b", "c")[: len(shape)])
    nothing_to_show = len(failed) > 2 and (asked.get("y") == "moment" or (len(shape) == 3 and not asked))
    if nothing_to_show:
        with pytest.raises(PictureError, match="variant"):
            plot_result(data, **asked)
        return
    figure = plot_result(data, best=None if failed else 3, **asked)
    save(figure, tmp_path / "a.svg")
    ElementTree.parse(tmp_path / "a.svg")
    # A map loses its colour bar where no cell has a colour.
    assert len(figure.axes) == (1 if len(failed) > 2 and shape == (6, 5) else axes)


@each("shape, along, shuffled", [((30,), "a", True), ((5, 6), "", True), ((4, 1, 5), "ac", False)])
def test_grid__is_of_more_than_one_value_a_number_in_their_order(shape, along, shuffled):
    data = grid_data(shape, parameters=("a", "b", "c")[: len(shape)])
    rows = np.random.default_rng(1).permutation(math.prod(shape)) if shuffled else slice(None)
    data = data._replace(arrays={name: values[rows] for name, values in data.arrays.items()})
    assert data.grid_parameters() == list(along)


# Variants that miss the condition for the best one


def conditioned(shape, out, failed=(), parameters=("a", "b")):
    data = grid_data(shape, failed, parameters)
    candidates = data.ok.copy()
    candidates[list(out)] = False
    return data._replace(condition="mass < '2 kg' and b > '3 mm'", candidates=candidates)


def texts_of(legend):
    return [text.get_text().replace("\N{NO-BREAK SPACE}", " ") for text in legend.get_texts()]


MISSING = "misses: mass < '2 kg' and b > '3 mm'"


def test_curves__missing_variants_are_pale():
    figure = Figure()
    data = conditioned((9,), [0, 1, 2], failed=[8], parameters=("a",))
    curves(figure, data, "a", ["mass"])
    pale = next(line for line in figure.axes[0].lines if line.get_color() == PALE)
    assert np.isfinite(pale.get_ydata()).tolist() == [True] * 3 + [False] * 6
    assert pale.get_ydata()[:3] == pytest.approx(1000 * data.arrays["mass"][:3])
    assert texts_of(figure.legends[0]) == ["error estimate", MISSING, "can't be assembled"]


def test_map__missing_cells_are_veiled():
    axes = Figure().add_subplot()
    data = conditioned((5, 4), [0, 7, 8], failed=[3])
    map2d(axes, data, "a", "b", "mass")
    veil = axes.collections[-1].get_array()
    # Rows of the picture run along b, the second axis of the grid.
    assert np.argwhere(~np.ma.getmaskarray(veil)).tolist() == [[0, 0], [0, 2], [3, 1]]
    assert texts_of(axes.figure.legends[0]) == [MISSING, "can't be assembled"]


def test_field_band__of_what_meets_the_condition_within_that_of_all():
    axes = Figure().add_subplot()
    data = conditioned((4, 3), range(6), failed=[11])
    field_band(axes, data, "moment")
    of_all, of_chosen = (band.get_paths()[0].vertices[:, 1].max() for band in axes.collections)
    assert of_all == pytest.approx(data.arrays["moment"][:11].max())
    assert of_chosen == pytest.approx(data.arrays["moment"][6:11].max())
    assert texts_of(axes.get_legend()) == ["all 11 variants", "5 variants with mass < '2 kg' and b > '3 mm'", "median"]


@each(
    "shape, asked",
    [((6,), {}), ((6, 5), {}), ((3, 4, 5), {}), ((6, 5), {"y": "moment"}), ((6, 5), {"x": "mass", "y": "cost"})],
)
def test_picture_where_no_variant_meets_the_condition__is_drawn_all_the_same(shape, asked, tmp_path):
    data = conditioned(shape, range(math.prod(shape)), parameters=("a", "b", "c")[: len(shape)])
    figure = plot_result(data, **asked)
    save(figure, tmp_path / "a.svg")
    ElementTree.parse(tmp_path / "a.svg")
    # Fields have a band of all variants, and none of those that meet the condition.
    told = f"all {math.prod(shape)} variants" if asked == {"y": "moment"} else MISSING
    (texts,) = [texts_of(legend) for legend in figure.findobj(Legend)]
    assert texts[-1] == told


def test_long_condition__is_cut_in_a_legend():
    data = grid_data((2,), parameters=("a",))._replace(condition=" and ".join(["mass < '2 kg'"] * 50))
    label = data.legend_of("misses:")
    assert len(label) < 220
    assert label.endswith(" …")
    assert all(len(line) <= 70 for line in label.splitlines())
    assert "2\N{NO-BREAK SPACE}kg" in label
    assert "2 kg" not in label


def test_legend_of_the_energy_loop__lies_beside_all_axes():
    figure = diagrams(read_scene(STUDIES / "flywheels" / "scenes" / "crank_press.toml"))
    figure.draw_without_rendering()
    legend = figure.legends[0].get_window_extent()
    assert not any(legend.overlaps(ax.get_window_extent()) for ax in figure.axes)
    assert not any(ax.get_legend() for ax in figure.axes)


test_column_that_cannot_be_shown__refused = refusals(
    lambda asked: plot_result(grid_data((3, 3)), **asked),
    ({"y": "weight"}, "'weight' is not in this result; known are: a, b, cost, mass, moment; did you mean 'mass'"),
    ({"colour": "moment"}, r"'moment' is a field, which can only be y"),
)


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_saving__finds_the_layout_and_draws_once(ending, tmp_path):
    figure, drawn = new_figure(60, 60), []

    class Counted(Line2D):
        def draw(self, renderer):
            drawn.append(self.axes.get_position().x0)
            super().draw(renderer)

    axes = figure.add_subplot(ylabel="torque")
    axes.add_line(Counted([0, 1], [0, 1]))
    unlaid = axes.get_position().x0
    save(figure, tmp_path / f"picture.{ending}")
    assert len(drawn) == 1
    assert drawn != [unlaid]


# Parallel coordinates: which columns, and labels and numbers that keep clear of each other.


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


def named(letter, count):
    return [f"{letter}{i}" for i in range(count)]


SOME = (["a", "b"], ["mass", "cost", "force"])


@each(
    "varied, summaries, colour, expected",
    [
        (*SOME, "force", ["a", "b", "force", "mass", "cost"]),
        (*SOME, "a", ["a", "b", "mass", "cost", "force"]),
        (named("p", 12), named("s", 5), "s3", [*named("p", 9), "s3"]),
        (["p"], named("s", 12), "s3", ["p", "s3", "s0", "s1", "s2", *named("s", 9)[4:]]),
    ],
)
def test_chosen_columns__ten_at_most_varied_then_the_colour_then_summaries(varied, summaries, colour, expected):
    assert chosen_columns(columns(varied, summaries), colour) == expected


def test_column_that_is_the_same_in_all_computed_variants__left_out():
    data = columns(["a", "b"], ["mass"])
    data.arrays["b"][:] = 1.0
    data.arrays["b"][7] = 2.0
    data.status[7] = Verdict.CANNOT_ASSEMBLE
    assert chosen_columns(data, "mass") == ["a", "mass"]


def test_chosen_columns__none_for_what_the_condition_makes_equal():
    data = columns(*SOME)._replace(condition="cost == 3 and force < 2")
    assert chosen_columns(data, "mass") == ["a", "b", "mass", "force"]
    assert chosen_columns(data, "cost") == ["a", "b", "cost", "force", "mass"]


def test_labels__horizontal_names_with_units():
    data = columns(long_paths(7), ["wheel_mass"])
    with house_style():
        axes = new_figure(180, 110).add_subplot()
        parallel(axes, data, [*data.varied, *data.summaries], "wheel_mass")
    labels = axes.get_xticklabels()
    assert {label.get_rotation() for label in labels} == {0.0}
    assert labels[-1].get_text().replace("_\n", "_").replace("\n", " ") == "wheel_mass, kg·m²/rad"


def test_wrapped__broken_at_blanks_dots_and_underscores():
    assert wrapped("groups.drive.first.length, mm", 14) == ["groups.drive.", "first.length,", "mm"]
    assert wrapped("ram.stroke_time_ratio", 8) == ["ram.", "stroke_", "time_", "ratio"]
    assert wrapped("at 0.25 of the eccentricity", 8) == ["at 0.25", "of the", "eccentricity"]
