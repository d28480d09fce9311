"""Pictures of sweeps: what is drawn is what the result holds, failed variants are told apart."""

import math
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.figure import Figure

from engine import Verdict
from sweeps.errors import PictureError
from sweeps.maps import curves, field_band, map2d, plot_result, scatter
from sweeps.pareto import pareto_front
from sweeps.sweep_data import SweepData


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
    return SweepData(arrays, units, names, parameters, ("mass", "cost"), shape, status, phi)


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
    labels = [text.get_text() for text in top.get_legend().get_texts()]
    assert labels == ["error figure", "can't be assembled", "best"]
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
    figure = Figure()
    axes = figure.add_subplot()
    map2d(axes, data, x, y, "mass", best=7)
    mesh = axes.collections[1]
    cells = np.ma.filled(mesh.get_array(), np.nan)
    expected = data.arrays["mass"].reshape(5, 4) * 1000
    assert cells == pytest.approx(expected.T if x == "a" else expected, nan_ok=True)
    assert axes.collections[0].get_hatch()
    assert axes.collections[0].get_array().count() == 2
    star = axes.lines[0].get_xydata()[0]
    assert star == pytest.approx([1000 * data.arrays[x][7], 1000 * data.arrays[y][7]])
    assert [t.get_text() for t in figure.legends[0].get_texts()] == ["best", "can't be assembled"]


def test_scatter__front_of_the_two_shown():
    data = grid_data((20, 20))
    rng = np.random.default_rng(3)
    mass, cost = rng.random((2, 400))
    data = data._replace(arrays=dict(data.arrays) | {"mass": mass, "cost": cost})
    axes = Figure().add_subplot()
    scatter(axes, data, "mass", "cost", "a", minimise=(True, False))
    front = pareto_front(np.column_stack([mass, cost]), (True, False))
    drawn = axes.lines[0].get_xydata() / [1000, 1]
    order = np.argsort(mass[front])
    assert drawn == pytest.approx(np.column_stack([mass, cost])[front][order])


@pytest.mark.parametrize(
    ("shape", "asked", "axes"),
    [
        ((12,), {}, 2),
        ((6, 5), {}, 2),
        ((6, 1), {}, 2),
        ((6, 5), {"y": "moment"}, 1),
        ((6, 5), {"x": "mass", "y": "cost"}, 1),
        ((3, 4, 5), {}, 2),
        ((3, 4, 5), {"x": "mass", "colour": "a"}, 2),
    ],
)
@pytest.mark.parametrize("failed", [(), (1, 2), "all"])
def test_plot_result__suits_the_grid(shape, asked, axes, failed, tmp_path):
    failed = range(math.prod(shape)) if failed == "all" else failed
    data = grid_data(shape, failed, ("a", "b", "c")[: len(shape)])
    file = tmp_path / "a.svg"
    nothing_to_show = len(failed) > 2 and (asked.get("y") == "moment" or (len(shape) == 3 and not asked))
    if nothing_to_show:
        with pytest.raises(PictureError, match="variant"):
            plot_result(data, file, **asked)
        return
    figure = plot_result(data, file, best=None if failed else 3, **asked)
    ElementTree.parse(file)
    # A map loses its colour bar where no cell has a colour.
    assert len(figure.axes) == (1 if len(failed) > 2 and shape == (6, 5) else axes)


def test_random_samples__are_no_grid():
    data = grid_data((30,), parameters=("a",))
    shuffled = np.random.default_rng(1).permutation(30)
    data = data._replace(arrays={name: values[shuffled] for name, values in data.arrays.items()})
    assert data.grid_parameters() == []
    assert grid_data((4, 1, 5), parameters=("a", "b", "c")).grid_parameters() == ["a", "c"]


def test_unknown_column__refused_with_those_there_are(tmp_path):
    with pytest.raises(PictureError, match="'weight' is not in this result; there are: a, b, mass, cost, moment"):
        plot_result(grid_data((3, 3)), tmp_path / "a.png", y="weight")


def test_field_as_colour__refused(tmp_path):
    with pytest.raises(PictureError, match=r"'moment' is a field.*shown as y"):
        plot_result(grid_data((3, 3)), tmp_path / "a.png", colour="moment")
