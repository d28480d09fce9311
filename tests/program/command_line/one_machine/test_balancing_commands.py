"""What the commands draw and tell of rotors, engines and shaking forces, and at which positions of an input."""

import math
from pathlib import Path

import numpy as np
import pytest
from commands import done, refused
from drawn_machines import sliding_input
from matplotlib.figure import Figure

from engine import ElementsAlone, Scene, in_line_engine, shaken
from sweeps import SweepResult, read_scene, write_scene
from sweeps.pictures.elements.element_pictures import element_sheet
from sweeps.pictures.elements.engine_sheet import engine_table
from sweeps.pictures.sweep.result_pictures import result_pictures
from sweeps.report.order_table import EngineRow, engine_rows, remaining_orders
from sweeps.text.templates import bundled_templates

# Tests of pictures look at what is drawn.
blank = pytest.mark.usefixtures("blank_pictures")

EPS = np.finfo(float).eps


def wrote(output):
    return [line.removeprefix("Wrote ") for line in output.splitlines() if line.startswith("Wrote ")]


def swept(name, scene, axis, asked):
    """Result of a study that varies one number of a template."""
    done("new", scene)
    text = f'scene = "{scene}.toml"\n[vary]\n{axis}\n[outputs]\n{asked}\n'
    Path(f"{name}.toml").write_text(text, encoding="utf8")
    done("run", f"{name}.toml", "--quiet", "--no-plots")
    return SweepResult(Path(f"results/{name}.h5"))


@pytest.fixture
def seen(folder, monkeypatch):
    """Positions at which machines are to be drawn."""
    found = []

    def draw(*given: object, **_: object) -> list:
        found.append(given[2])
        return []

    monkeypatch.setattr("sweeps.pictures.picture_files.machine_pictures", draw)
    return found


@pytest.fixture
def drawn(folder, monkeypatch):
    """Scenes of which hodographs are to be drawn."""
    found = []

    def noted(scenes):
        found.append(dict(scenes))
        return Figure()

    monkeypatch.setattr("sweeps.pictures.machine.hodographs.hodographs", noted)
    return found


def template(name, **changes):
    scene = read_scene(bundled_templates()[name])
    return scene.elements[name].model_copy(update=changes) if changes else scene


# Elements


def test_plot_of_an_engine__draws_its_sheet_and_tells_its_orders(folder):
    answer = done("plot", "v_twin")
    assert wrote(answer) == ["v_twin_twin_orders.png"]
    assert Path("v_twin_twin_orders.png").stat().st_size > 20_000
    lines = answer.splitlines()
    assert lines[0] == "twin: orders of the crank"
    # Those of the scene: 3.915 kN, turning against the crank, with counterweights.
    assert [line.split()[0] for line in lines[2:6]] == ["1", "2", "4", "6"]
    assert all(words in lines[2] for words in ("38.53 × 30.7 kN ↺", "3.915 kN ↻"))


def test_plot_of_a_variant__draws_the_elements_with_its_numbers(folder):
    axis = '"elements.engine.gas.peak" = { values = ["30 bar", "60 bar"] }'
    result = swept("peaks", "engine", axis, 'summaries = ["engine.mean_torque"]')
    for variant, torque in enumerate(result.columns["engine.mean_torque"]):
        answer = done("plot", "results/peaks.h5", "--variant", str(variant))
        assert f"mean torque {torque:.4g} N·m" in answer
        assert wrote(answer) == [f"peaks_{variant}_engine_orders.png"]
    first, second = (Path(f"peaks_{variant}_engine_orders.png").read_bytes() for variant in range(2))
    assert first != second


@blank
def test_plot_of_elements_beside_a_mechanism__adds_their_pictures(folder):
    slider_crank, rotor = (bundled_templates()[name].read_text() for name in ("slider_crank", "rotor"))
    text = slider_crank + rotor.partition("\n\n")[2]
    Path("both.toml").write_text(text.replace('title = "Rotor, balanced in two planes"\n', ""), encoding="utf8")
    assert wrote(done("plot", "both.toml")) == ["both.png", "both_diagrams.png", "both_rotor_plan.png"]


# The sheet of an engine


def test_engine_sheet__shows_what_the_element_computes():
    engine = template("engine", layout="V", cylinders=2, bank_angle=1.1, firing_order=None, throws=None)
    scene = Scene.model_validate({"elements": {"it": engine.model_dump(exclude_none=True) | {"firing_order": (1, 2)}}})
    engine = scene.elements["it"]
    words = ("primary", "secondary", "third_order", "fourth_order", "fifth_order", "sixth_order")
    names = [f"it.{word}_{kind}" for kind in ("force", "couple") for word in words]
    torques = [f"it.torque_order_{k / 2:g}".replace(".5", "_5") for k in range(1, 13)]
    found = ElementsAlone(scene, [*names, *torques]).evaluate({}).summaries
    figure = element_sheet(engine, "Twin")
    assert figure.get_suptitle() == "Twin"
    # Both rods on one crankpin make no couple, and no sheet of it.
    assert all(abs(found[name][0]) < 1e-9 for name in names[6:])
    _, loop, forces, torque, _, curve = figure.axes
    for axes, some, unit in ((forces, names[:6], "N"), (torque, torques, "N·m")):
        factor = {"k": 1e3}.get(axes.get_ylabel().split(", ")[1][0], 1.0)
        assert axes.get_ylabel().endswith(unit)
        heights = [bar.get_height() * factor for bar in axes.containers[-1]]
        expected = [found[name][0] for name in some]
        # What is rounding alone is shown as nothing.
        assert heights == pytest.approx(expected, rel=1e-12, abs=1e-9)
    assert curve.lines[0].get_ydata().mean() == pytest.approx(curve.lines[1].get_ydata()[0], rel=0.01)
    after = loop.lines[1].get_data()
    vector = 1j * shaken(engine).forces[1].at(np.zeros(1))[0]
    scale = 1e-3 if "kN" in loop.get_xlabel() else 1.0
    assert (after[0][0], after[1][0]) == pytest.approx((scale * vector.real, scale * vector.imag), rel=1e-12)


def test_engine_sheet__without_spacing_and_gas_has_one_row():
    engine = template("engine", spacing=None, gas=None, firing_order=None)
    assert len(element_sheet(engine).axes) == 3


def test_engine_table__tells_what_a_student_expects_of_an_in_line_four():
    lines = engine_table(template("engine").elements["engine"]).splitlines()
    assert [line.split()[:2] for line in lines[1:5]] == [["1", "0"], ["2", "5.509"], ["4", "136.5"], ["6", "3.803"]]
    assert lines[-1].startswith("firing order 1-3-4-2; mean torque 72.89 N·m, torque orders [N·m] 2: ")
    assert [part.split(":")[0] for part in lines[-1].split("] ")[1].split(", ")] == ["2", "4", "6"]


# Order tables


def test_orders__tells_well_known_engines_or_those_of_a_scene(folder):
    assert "V8 90° cross-plane" in done("orders")
    answer = done("orders", "v_twin", "--out", "orders.png")
    assert answer.splitlines()[1].startswith("twin    –       1.616 × 0.3843 ↺  1.107 × 0.6909 ↺")
    assert "At λ = 0.2705: A₁ = 1, A₂ = 0.2756" in answer
    assert wrote(answer) == ["orders.png"]
    assert "has no engine" in refused("orders", "fan_rotor")


def test_engine_rows__are_the_layouts_with_lengths_as_multiples():
    scene = template("engine")
    (row,) = engine_rows(scene)
    plain = remaining_orders(EngineRow("four", in_line_engine(4).layout(), (1, 3, 4, 2)))
    own = remaining_orders(row)
    # Over A6 of 2e-4, in which a transform leaves some 36 roundings.
    assert own.forces.major == pytest.approx(plain.forces.major, abs=36 * 64 * EPS / 2e-4)
    assert own.torque_orders == plain.torque_orders == (2.0, 4.0, 6.0)
    assert row.offset * row.ratio == pytest.approx(0.8 / 140)


# Shaking forces of mechanisms


@blank
def test_hodograph__of_a_scene_and_beside_another(drawn):
    done("new", "slider_crank")
    assert wrote(done("plot", "slider_crank.toml", "--hodograph"))[-1] == "slider_crank_hodograph.png"
    done("plot", "slider_crank.toml", "--beside", "compressor")
    done("plot", "slider_crank.toml", "--beside", "slider_crank.toml")
    others = ["slider_crank"], ["compressor", "slider_crank"], ["slider_crank (other)", "slider_crank"]
    assert [list(scenes) for scenes in drawn] == [*others]


@blank
def test_hodograph_of_a_variant__has_the_scene_as_given_beside(drawn):
    axis = '"bodies.piston_body.mass" = { values = ["1.5 kg", "3 kg"] }'
    swept("masses", "slider_crank", axis, 'summaries = ["piston.stroke"]')
    done("plot", "results/masses.h5", "--variant", "1", "--hodograph")
    (scenes,) = drawn
    assert {name: s.bodies["piston_body"].mass for name, s in scenes.items()} == {"scene": 1.5, "masses_1": 3.0}


# Positions


@pytest.fixture
def rack(folder):
    Path("rack.toml").write_text(write_scene(sliding_input()), encoding="utf8")


def test_at_of_a_sliding_input__is_read_as_lengths(rack, seen):
    done("plot", "rack.toml", "--at", "20 mm, 5 cm")
    assert seen == [(0.02, 0.05)]
    answer = refused("plot", "rack.toml", "--at", "60")
    assert '60 has no unit: write "60 mm"' in answer
    assert "--at '0 mm, 20 mm'" in answer


def test_at_of_a_crank__is_read_as_degrees_or_with_a_unit(seen):
    done("plot", "compressor", "--at", "30, 1.5 rad,90 deg")
    assert seen[0] == pytest.approx((math.pi / 6, 1.5, math.pi / 2), rel=1e-15)
    assert "for example --at 0,60,120" in refused("plot", "compressor", "--at", "sixty")


def test_export_of_a_sliding_input__has_a_position_without_asking(rack):
    for ending in ("svg", "dxf"):
        assert "Wrote a." in done("export", "rack.toml", "--to", f"a.{ending}")
        assert "Wrote b." in done("export", "rack.toml", "--to", f"b.{ending}", "--at", "60 mm")
        # The middle of its range.
        assert Path(f"a.{ending}").stat().st_size == pytest.approx(Path(f"b.{ending}").stat().st_size, rel=0.01)
    done("export", "rack.toml", "--to", "table.csv")
    head, first, second = (line.split(",")[0] for line in Path("table.csv").read_text().splitlines()[:3])
    assert head == "q [mm]"
    assert [float(first), float(second)] == pytest.approx([0.0, 120 / 360])


# Results without a goal


@blank
def test_result_without_a_goal__shows_the_reactions_of_the_first_variant_that_works(folder):
    axis = '"groups.drive.first.length" = { values = ["20 mm", "160 mm"] }'
    asked = 'summaries = ["piston.stroke"]\nfields = ["drive.inner.reaction_x"]'
    result = swept("rods", "slider_crank", axis, asked)
    made = [path.name for path in result_pictures(result)]
    assert made == ["rods.png", "rods_1_reactions.png", "rods_1_bearing_drive_inner.png"]
    # A picture that was asked for comes alone.
    assert len(result_pictures(result, Path("a.png"))) == 1
