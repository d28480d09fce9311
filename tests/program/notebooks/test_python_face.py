"""What Python and notebooks get: datasets, tables, figures, and how things show themselves."""

import gc
import json
import sys
import weakref
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from commands import done, ran
from matplotlib.figure import Figure

import sweeps
from engine import AskError, Machine, Scene
from sweeps.pictures.picture_error import PictureError

CRANKS = np.array([0.04, 0.05, 0.06, 0.25])
STROKE = "ram.stroke"


VARIED = {"input.length": CRANKS}


@pytest.fixture
def machine(press_folder):
    """A press over four cranks, of which one is longer than its rod."""
    return Machine(sweeps.read_scene("press.toml"), [STROKE], ["B.y"], ["input.length"], positions=48)


@pytest.fixture
def outcome(machine):
    return machine.evaluate(VARIED)


@pytest.fixture
def data(outcome, machine):
    return sweeps.to_xarray(outcome, machine, VARIED)


# Datasets


def test_dataset_of_an_outcome__holds_what_the_outcome_does_with_units(data):
    # In line, the stroke is twice the crank; rounding of a sum of three lengths of at most 0.3 m.
    assert data[STROKE].values[:2] == pytest.approx(2 * CRANKS[:2], abs=1e-15)
    assert data[STROKE].attrs["units"] == data[f"{STROKE}_error"].attrs["units"] == data["input.length"].attrs["units"]
    assert data["B.y"].dims == ("variant", "phi")
    assert data["B.y"].sel(phi=0.0).values[0] == pytest.approx(-np.sqrt(0.2**2 - 0.04**2), rel=1e-14)
    names = dict(zip(data.status.attrs["flag_values"], data.status.attrs["flag_meanings"].split(), strict=True))
    assert [names[code] for code in data.status.values] == ["ok", "ok", "ok", "cannot_assemble"]
    assert np.isfinite(data.status_at.values[3])


def test_table_of_an_outcome__has_a_row_for_each_variant(machine, outcome):
    table = sweeps.to_dataframe(outcome, machine, VARIED)
    assert list(table) == ["input.length [m]", "verdict", f"{STROKE} [m]", f"{STROKE}_error [m]"]
    assert list(table["verdict"]) == ["ok", "ok", "ok", "cannot_assemble"]
    assert table.loc[1, f"{STROKE} [m]"] == outcome.summaries[STROKE][1]
    assert table.index.name == "variant"
    texts = {"input.length": [f"{1e3 * length} mm" for length in VARIED["input.length"]]}
    assert sweeps.to_dataframe(outcome, machine, texts)["input.length [m]"].tolist() == VARIED["input.length"].tolist()


def test_grid__has_a_dimension_for_each_path(press_result):
    flat, grid = sweeps.read(press_result), sweeps.read(press_result, grid=True)
    assert grid.sizes == {"input.length": 4, "bodies.ram.mass": 2}
    assert grid["input.length"].values.tolist() == [0.04, 0.06, 0.25, 0.05]
    assert grid["bodies.ram.mass"].values.tolist() == [50.0, 100.0]
    assert grid["excess_work"].attrs == flat["excess_work"].attrs
    for variant in range(8):
        own = {name: flat[name].values[variant] for name in grid.sizes}
        for name in ("excess_work", "excess_work_error", "status", "variant"):
            # The machine of 250 mm can't be assembled: its numbers are NaN in both.
            np.testing.assert_array_equal(grid[name].sel(own).values, flat[name].values[variant])
    assert grid[STROKE].sel({"input.length": 0.06, "bodies.ram.mass": 100.0}) == pytest.approx(0.12, abs=1e-15)


TOGETHER = """
[vary]
"input.length" = { low = "40 mm", high = "60 mm" }
"bodies.ram.mass" = { low = "50 kg", high = "60 kg" }
[sampling]
method = "sobol"
count = 4
"""


@pytest.mark.parametrize(
    ("vary", "words"), [("", "is a single machine"), (TOGETHER, "input.length and bodies.ram.mass vary together")]
)
def test_variants_without_a_grid__are_refused_in_words(press_folder, vary, words):
    Path("s.toml").write_text(f'scene = "press.toml"\n[outputs]\nsummaries = ["{STROKE}"]\n{vary}')
    done("run", "s.toml", "--no-plots", "--quiet", "--out", "s.h5")
    with pytest.raises(sweeps.StoreError, match=words):
        sweeps.read("s.h5", grid=True)


# Figures


def test_figures__are_made_without_pyplot_and_are_let_go_of(machine, data, press_result):
    scene = machine.scene
    figures = [
        sweeps.plot_mechanism(scene, [0.3], ["B"]),
        sweeps.plot_fields(scene, ["B.vy"], positions=48),
        sweeps.plot_sweep(press_result),
        sweeps.plot_sweep(Path(press_result), y="excess_work", x="input.length"),
        sweeps.plot_sweep(data),
        sweeps.plot_sweep(data, y="B.y"),
    ]
    for figure in figures:
        assert isinstance(figure, Figure)
        png, size = figure._repr_png_()
        assert png.startswith(b"\x89PNG")
        assert 250 < size["width"] < 800
    assert not list(Path().glob("*.png"))
    assert "matplotlib.pyplot" not in sys.modules or not sys.modules["matplotlib.pyplot"].get_fignums()
    left = [weakref.ref(figure) for figure in figures]
    del figure, figures
    gc.collect()
    assert [ref() for ref in left] == [None] * len(left)


def test_curve_of_a_dataset__shows_its_numbers(data):
    line = sweeps.plot_sweep(data).axes[0].lines[0]
    # In millimetres; the one that can't be assembled leaves a gap.
    np.testing.assert_allclose(line.get_xdata(), [40, 50, 60, 250])
    np.testing.assert_allclose(line.get_ydata(), [80, 100, 120, np.nan], rtol=1e-12)


def test_figures_of_nothing__are_refused(machine, data):
    with pytest.raises(PictureError, match="no regimes"):
        sweeps.plot_history(machine.scene)
    alone = Scene.model_validate({"elements": {"k": {"type": "oscillator", "mass": "1 kg", "stiffness": "1 N/m"}}})
    for plot in (sweeps.plot_mechanism, sweeps.plot_diagrams):
        with pytest.raises(PictureError, match="only machine elements"):
            plot(alone)
        with pytest.raises(AskError, match="is not a scene"):
            plot("press.toml")
    with pytest.raises(PictureError, match="no variants"):
        sweeps.plot_sweep(data.drop_vars("status"))
    with pytest.raises(AskError, match=r"to_xarray\(outcome, machine, values\)"):
        sweeps.plot_sweep(machine.evaluate({"input.length": ["50 mm"]}))


# How things show themselves


def test_representation__is_a_line(machine, outcome):
    assert repr(machine.scene) == "<Scene 'Crank press': input crank, RRP slide, 1 body, 1 force>"
    assert repr(machine) == "<Machine 'Crank press': varied input.length; summaries ram.stroke; fields B.y>"
    assert (
        repr(outcome) == "<Outcome of 4 variants: 3 ok, 1 can't be assembled; summaries ram.stroke [m]; fields B.y [m]>"
    )
    study = sweeps.read_study("study.toml")
    of = "8 variants of 4 input.length × 2 bodies.ram.mass"
    assert repr(study) == f"<Study 'Which crank?': {of}; ram.stroke, excess_work>"


def test_html__holds_a_drawing_and_the_numbers(machine, outcome):
    for thing, words in (
        (machine.scene, "groups.slide.first.length"),
        (machine, "summaries and"),
        (sweeps.read_study("study.toml"), "Which crank does the least work?"),
    ):
        text = sweeps.to_html(thing)
        # Well-formed: it can stand inside any page. Names of XML's other spaces are declared by the drawing itself.
        tree = ET.fromstring(text)
        assert tree.find(".//{http://www.w3.org/2000/svg}svg") is not None
        assert words in text
    rows = ET.fromstring(sweeps.to_html(outcome)).findall(".//tr")
    assert [cell.text for cell in rows[4]][:2] == ["3", "can't be assembled"]
    assert rows[1][2].text.startswith("0.08")


def test_two_scenes__are_each_shown_in_their_system(machine):
    american = machine.scene.model_copy(update={"units": "US"})
    shown = [sweeps.to_html(scene) for scene in (american, machine.scene, american)]
    assert shown[0] == shown[2]
    assert [" in</td>" in text for text in shown] == [True, False, True]
    assert [" mm</td>" in text for text in shown] == [False, True, False]
    labels = [sweeps.plot_fields(scene, ["B.vx"]).axes[0].get_ylabel() for scene in (american, machine.scene)]
    assert "in/s" in labels[0]
    assert "m/s" in labels[1]


def test_html__takes_a_title_for_text_not_for_markup(machine):
    text = sweeps.to_html(machine.scene.model_copy(update={"title": "<script>alert(1)</script> $x"}))
    assert "<script>" not in text
    assert "&lt;script&gt;" in text


def test_html_of_what_cannot_be_drawn__says_why(machine):
    far = machine.scene.points["O"].model_copy(update={"x": 10.0})
    apart = machine.scene.model_copy(update={"points": machine.scene.points | {"O": far}})
    assert "<svg" not in sweeps.to_html(apart)
    assert "<table>" in sweeps.to_html(apart)
    with pytest.raises(TypeError, match="int can't be displayed"):
        sweeps.to_html(3)


NOTEBOOK = """
import sys, types
kept = {}
class Formatter:
    def for_type_by_name(self, module, name, show): kept[module, name] = show
shell = types.SimpleNamespace(display_formatter=types.SimpleNamespace(formatters={"text/html": Formatter()}))
sys.modules["IPython"] = types.SimpleNamespace(get_ipython=lambda: shell)
import sweeps, engine
from sweeps.study.study import Study
for kind in (engine.Scene, engine.Machine, engine.ElementsAlone, engine.Outcome, Study):
    assert kept.pop((kind.__module__, kind.__name__)) is sweeps.to_html
assert not kept
"""


def test_notebook__is_told_how_to_show_every_type():
    ended = ran("-c", NOTEBOOK)
    assert (ended.returncode, ended.stderr) == (0, "")


# Notebooks of the gallery, cell by cell


GALLERY = Path(__file__).parents[3] / "results" / "gallery"


def run(name):
    """Run the cells of a notebook, and return its names."""
    notebook = json.loads((GALLERY / name).read_text(encoding="utf8"))
    names = {}
    for number, cell in enumerate(notebook["cells"]):
        if cell["cell_type"] == "code":
            # Outputs are made when it is opened; kept, they would differ from machine to machine.
            assert cell["outputs"] == []
            exec(compile("".join(cell["source"]), f"{name}, cell {number}", "exec"), names)
    return names


def test_hacksaw__has_stroke_and_ratio_with_every_rod(capsys):
    names = run("hacksaw.ipynb")
    summaries = names["outcome"].summaries
    assert (names["outcome"].status == 0).all()
    # Both are known to rounding by the closed form and by the ends of the stroke as measured.
    np.testing.assert_allclose(summaries["saw.stroke"], 0.150, rtol=1e-12)
    np.testing.assert_allclose(summaries["saw.stroke_time_ratio"], 1.4, rtol=1e-11)
    found = [m.least_transmission for m in names["machines"]]
    np.testing.assert_allclose(summaries["drive.transmission_angle"], found, rtol=1e-11)
    assert capsys.readouterr().out == "rod 175 mm: flywheel of 6.4 kg m²\n"


def test_every_notebook__has_a_test():
    assert [path.name for path in GALLERY.glob("*.ipynb")] == ["hacksaw.ipynb"]
