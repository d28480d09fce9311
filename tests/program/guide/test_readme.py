"""The texts and commands of README and guide are run as they stand."""

import re
import shlex
from pathlib import Path

import matplotlib.pyplot
import numpy as np
import pytest
import tomlkit
from click.testing import CliRunner
from unit_scans import foreign

from engine import Machine, Verdict, made_ready
from sweeps import SweepResult, read_scene, read_study, run_study
from sweeps.cli import main
from sweeps.optimising.search_runner import optimise_study

ROOT = Path(__file__).parents[3]
README = (ROOT / "README.md").read_text(encoding="utf8")
COMPRESSOR = ("machine", "flywheel")
GUIDE = {page.stem: page.read_text(encoding="utf8") for page in sorted((ROOT / "sweeps" / "guide").rglob("*.md"))}
# What the chapter on Python imports.
LINKAGE = """{"joints": [
    {"type": "Static", "name": "O", "x": 0, "y": 0}, {"type": "Static", "name": "D", "x": 22, "y": 0},
    {"type": "Crank", "name": "A", "x": 6, "y": 0, "joint0": {"ref": "O"}, "distance": 6, "angle": 0.1},
    {"type": "Revolute", "name": "B", "x": 20, "y": 14, "joint0": {"ref": "A"}, "joint1": {"ref": "D"},
     "distance0": 20, "distance1": 14}]}"""


AXIS = '[points]\nC = { x = "300 mm", y = 0 }'
# What the compressor lacks for the fragments of each chapter, in their order.
HOSTS = {
    "cams": ['[points]\nC = { x = "-200 mm", y = 0 }\n[input]\nrevolutions = 2'],
    "gears": [AXIS, "", "", "", AXIS, AXIS, AXIS],
    "inputs": ["", AXIS + "\n[input]\nrevolutions = 15", ""],
    "motion": [
        """[moments]
        motor = { type = "dc_motor", on = "crank", stall_moment = "200 N m", no_load_speed = "310 rpm" }
        brake = { type = "block_brake", on = "crank", force = "1 kN", friction = 0.35, radius = "150 mm" }
        [regimes]
        work = { type = "steady", off = ["brake"] }""",
        """[input]
        start = "20 deg"
        stop = "160 deg"
        [forces]
        oil = { type = "constant", on = "B", force = "9 kN", angle = 0, role = "driving" }
        return_oil = { type = "constant", on = "B", force = "9 kN", angle = "180 deg", role = "driving" }""",
        '[shafts]\ndrum = { geared_to = "crank", ratio = 0.1 }\naxle = { geared_to = "crank", ratio = 0.2 }',
        "",
    ],
}


def merged(*texts):
    """One scene of several texts, whose tables may meet; without the flywheel, which needs a crank that turns fully."""
    whole = {}
    for text in texts:
        for name, table in tomlkit.parse(text).unwrap().items():
            whole[name] = whole.get(name, {}) | table if isinstance(table, dict) else table
    return tomlkit.dumps({name: table for name, table in whole.items() if name != "flywheel"})


def blocks(language, text):
    return re.findall(rf"```{language}\n(.*?)```", text, flags=re.S)


def compressor():
    """The machine of the tutorial, to which the fragments of the chapters are added."""
    return "\n".join(text for step in COMPRESSOR for text in blocks("toml compressor.toml", GUIDE[step]))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with the scenes, the study and the tables of README and guide."""
    path = tmp_path_factory.mktemp("readme")
    scene = compressor()
    chapters = {name: "".join(blocks("toml", text)) for name, text in GUIDE.items()}
    chapters["forces"] = "".join(blocks("toml rubbing.toml", GUIDE["forces"])) + chapters["forces"]
    chapters["formulas"] = "".join(blocks("toml loaded.toml", GUIDE["formulas"]))
    texts = {
        "compressor": scene,
        "compressor_friction": scene + chapters["forces"],
        "compressor_formulas": scene + chapters["formulas"],
        "compressor_motion": scene + chapters["motion"],
        "compressor_coupled": scene + chapters["motion"] + chapters["couplings"],
        "compressor_whole": scene + chapters["formulas"] + chapters["motion"] + chapters["forces"],
        "study": chapters["study"],
        "sizes": chapters["searching"],
        "plate": "".join(blocks("toml plate.toml", GUIDE["links"])),
        "cam": "".join(blocks("toml cam.toml", GUIDE["cams"])),
        "reducer": "".join(blocks("toml reducer.toml", GUIDE["gears"])),
    }
    for name, text in texts.items():
        (path / f"{name}.toml").write_text(text, encoding="utf8")
    places = [f"{60 * np.cos(t)}, {25 * np.sin(t)}" for t in np.linspace(0, 2 * np.pi, 16, endpoint=False)]
    (path / "wanted.csv").write_text("\n".join(["x [mm], y [mm]", *places]), encoding="utf8")
    (path / "linkage.json").write_text(LINKAGE, encoding="utf8")
    (runs,) = blocks("csv", GUIDE["balancing"])
    (path / "runs.csv").write_text(runs, encoding="utf8")
    (path / "torque.csv").write_text("phi [deg], moment [N m]\n0,0\n90,1000\n180,0\n270,-200\n360,0\n", encoding="utf8")
    return path


def commands():
    """Every `sweeps` command of README and guide, without its comment."""
    # Other chapters show the results of the chapter on studies.
    chapters = sorted(GUIDE, key=lambda name: name != "study")
    texts = [block for text in (README, *(GUIDE[name] for name in chapters)) for block in blocks("sh", text)]
    lines = [line.split("  #")[0].strip() for block in texts for line in block.splitlines()]
    return [line for line in lines if line.startswith("sweeps ")]


def kind_of(words):
    """Command, type of file and options: commands of one kind do the same."""
    options = {word for word in words if word[0] == "-"} - {"--out", "--no-plots"}
    return words[0], *(Path(word).suffix for word in words[1:2]), *sorted(options)


def run_by_worked_pages():
    """Kinds of commands on worked pages, whose outputs are tested with them."""
    lines = [line for text in GUIDE.values() for block in blocks("console", text) for line in block.splitlines()]
    return {kind_of(shlex.split(line)[2:]) for line in lines if line.startswith("$ sweeps ")}


def test_chapters__are_all_in_the_readme():
    assert set(re.findall(r"\(sweeps/guide/(?:[a-z]+/)?([a-z]+)\.md\)", README)) == set(GUIDE)


def test_readme__is_read_in_one_go():
    assert len(README.splitlines()) < 120


def test_readme__shows_a_piece_of_the_tutorial():
    (piece,) = blocks("toml fragment", README)
    assert tomlkit.parse(piece).unwrap()["groups"] == tomlkit.parse(compressor()).unwrap()["groups"]


# The bundled studies, the site, the page beside the editor and clusters have tests of their own.
ELSEWHERE = ("sweeps run crank_press", "sweeps optimise four_bar_counterweights", "sweeps guide --web", "sweeps watch")


def test_commands__run_in_the_order_written(folder, blank_pictures, monkeypatch):
    monkeypatch.chdir(folder)
    listed, seen = commands(), run_by_worked_pages()
    assert len(listed) >= 12
    run_study(read_study("study.toml"), "results/study.h5")
    for command in listed:
        words = shlex.split(command)[1:]
        if command.startswith(ELSEWHERE) or "--cluster" in words or (kind_of(words) in seen and words[0] != "new"):
            continue
        seen.add(kind_of(words))
        result = CliRunner().invoke(main, words + ["--frames", "8"] * (words[0] == "animate"))
        assert result.exit_code == 0, f"{command}\n{result.output}"
        # Keys of scenes, and reasons of the guide, have units of every system.
        assert words[0] in ("guide", "help") or foreign(result.output, "mm") == [], command


def test_standard_sizes__give_the_best_machine_as_the_guide_says(folder, monkeypatch):
    """Every machine of the guide's sizes, computed by itself; the search finds the best of them."""
    monkeypatch.chdir(folder)
    study = read_study("sizes.toml")
    cranks, rods, rims = ([0.04, 0.045, 0.05, 0.056, 0.063], [0.16, 0.2, 0.25], [0.4, 0.5, 0.6])
    grid = np.stack(np.meshgrid(cranks, rods, rims, indexing="ij"), axis=-1).reshape(-1, 3)
    values = dict(zip(study.paths, grid.T, strict=True))
    outcome = Machine(study.scene, ["piston.stroke", "wheel_mass"], varied=study.paths).evaluate(values)
    fits = (outcome.summaries["piston.stroke"] > 0.09 + 1e-9) & (grid[:, 0] + grid[:, 1] <= 0.27)
    best = grid[np.argmin(np.where(fits, outcome.summaries["wheel_mass"], np.inf))]
    assert best.tolist() == [0.05, 0.2, 0.6]
    for found in (run_study(study, "swept.h5"), optimise_study(study, "searched.h5")):
        result = SweepResult(found)
        assert [result.columns[path][result.best()] for path in study.paths] == best.tolist()


def test_python__runs(folder, monkeypatch):
    """Every snippet by itself, where there is results/study.h5."""
    monkeypatch.chdir(folder)
    if not Path("results/study.h5").exists():
        run_study(read_study("study.toml"), "results/study.h5")
    names: dict[str, dict] = {}
    for page, text in {"README": README, **GUIDE}.items():
        for number, snippet in enumerate(blocks("python", text)):
            found = names[f"{page} {number}"] = {}
            exec(compile(snippet, page, "exec"), found)
    assert names["python 1"]["outcome"].summaries["flywheel_wittenbauer"].shape == (3,)
    assert dict(names["python 1"]["data"].sizes)["variant"] == 21 * 3 * 256
    assert dict(names["python 2"]["data"].sizes)["variant"] == 21
    assert names["python 3"]["power"].sizes["rod_ratio"] == 256
    assert float(names["python 3"]["peak_moment"].min()) > 0.0
    # xarray plots by pyplot, which keeps figures.
    matplotlib.pyplot.close("all")


@pytest.mark.parametrize("chapter", HOSTS)
def test_fragments__are_understood_in_a_scene(chapter, tmp_path):
    found = blocks("toml fragment", GUIDE[chapter])
    for fragment, host in zip(found, HOSTS[chapter], strict=True):
        (tmp_path / "scene.toml").write_text(merged(compressor(), host, fragment), encoding="utf8")
        read_scene(tmp_path / "scene.toml")


def test_all_together__can_be_ordered(folder):
    scene = read_scene(folder / "compressor_whole.toml")
    assert {"rings", "buffer", "fan", "motor"} <= {*scene.forces, *scene.moments}


ASKED = ["friction_loss", "drive.inner.friction_work", "mechanical_efficiency", "input.reaction.max"]


def named_in(text, pattern):
    """Quantities that a text names, of which there are some."""
    found = sorted(set(re.findall(f"`({pattern})`", text)))
    assert len(found) >= 7
    return found


def test_quantities__are_those_that_the_guide_names(folder):
    gears = [name for name in named_in(GUIDE["gears"], r"reducer\.[a-z_.]+") if not name.endswith("reduced_inertia")]
    # What the text says of fluid couplings is of other machines.
    couplings = named_in(GUIDE["couplings"].split("A `fluid_coupling`")[0], r"(?:couple|work)\.[a-z_]+")
    friction = [*ASKED, "shaking_force.order_1", "jamming_margin"]
    for name, asked in (("compressor_friction", friction), ("reducer", gears), ("compressor_coupled", couplings)):
        outcome = made_ready(read_scene(folder / f"{name}.toml"), asked).evaluate({})
        assert outcome.status == [Verdict.OK]
        assert np.isfinite([outcome.summaries[name] for name in asked]).all()
    fields = Machine(read_scene(folder / "plate.toml")).available_fields
    assert {"group_of_plate.certificate", "group_of_plate.transmission", "rod.A.reaction_x"} <= set(fields)


def test_guide__shows_its_chapters():
    listed = CliRunner().invoke(main, ["guide"])
    assert all(name in listed.output for name in GUIDE)
    assert CliRunner().invoke(main, ["guide", "cams"]).output == GUIDE["cams"]
    wrong = CliRunner().invoke(main, ["guide", "motoin"])
    assert wrong.exit_code != 0
    assert "did you mean 'motion'" in wrong.output
