"""What the commands say of motion: regimes in words, grouped answers, reasons and mends where it fails, refusals."""

import csv
import itertools
import math
import re
from pathlib import Path

import pytest
from commands import done, refused, said
from each_case import each
from press_texts import MOTION, PRESS
from slips import cases, changed

from engine import Machine, Scene, Verdict
from sweeps import SweepResult, read_scene, read_study
from sweeps.report.regime_words import by_regime, regime_words
from sweeps.run import blocks, cost
from sweeps.study.default_summaries import informative_summaries
from sweeps.study.study import Study

# Tests of pictures look at what is drawn.
pytestmark = pytest.mark.usefixtures("blank_pictures")

STUDY = """\
scene = "press.toml"
positions = 120

[vary]
"moments.motor.stall_moment" = {values = ["800 N m", "60 N m", "1 kN m"]}

[outputs]
summaries = ["start.time", "work.speed_fluctuation"]

[best]
minimise = "start.time"
where = "work.speed_fluctuation < 0.1"
"""


@pytest.fixture
def folder(folder) -> Path:
    Path("press.toml").write_text(MOTION)
    Path("study.toml").write_text(STUDY)
    return folder


def change(old: str, new: str) -> None:
    """Write the scene with something replaced."""
    Path("press.toml").write_text(changed(MOTION, old, new))


def indented_under(text: str, head: str) -> list[str]:
    """Lines below one that begins so, as long as they are indented more."""
    lines = text.splitlines()
    at = next(i for i, line in enumerate(lines) if line.lstrip().startswith(head))
    deep = len(lines[at]) - len(lines[at].lstrip())
    return list(itertools.takewhile(lambda line: len(line) - len(line.lstrip()) > deep, lines[at + 1 :]))


# check


def test_check__tells_what_each_regime_does_its_case_its_method_and_its_numbers(folder):
    text = said("check", "press.toml").stdout
    start = indented_under(text, "start: run from rest until 60 rpm; off: punch, brake")
    assert start[0].strip() == "case 5: I(φ), M(ω) of motor (DC motor); energy form"
    work = indented_under(text, "work: steady running; off: brake")
    stop = indented_under(text, "stop: run from where work ended to rest; off: motor, punch")
    assert stop[0].strip() == "case 3: I(φ), M constant of brake (block brake); energy form"
    scene = read_scene("press.toml")
    names = ["start.time", "work.efficiency", "stop.time"]
    exact = Machine(scene, names).evaluate({}).summaries
    for lines, name in zip((start, work, stop), names, strict=True):
        shown = next(line.split() for line in lines if line.split()[0] == name)
        assert float(shown[1]) == pytest.approx(exact[name][0], rel=1e-4)


def test_check_of_a_study_of_motion__estimates_what_it_takes(folder, monkeypatch):
    many = '"flywheel.inertia" = {from = "10 kg m2", to = "90 kg m2", count = 400}\n\n[outputs]'
    Path("study.toml").write_text(STUDY.replace("[outputs]", many))
    probed: list[cost.Cost] = []

    def noted(study: Study) -> cost.Cost:
        probed.append(cost.probe(study))
        return probed[-1]

    monkeypatch.setattr("sweeps.report.check_report.probe", noted)
    text = said("check", "study.toml").stdout
    # Numbers of a block on their own: values and error estimates of two summaries.
    assert probed[0].motion_bytes > read_study("study.toml").design.size * 4 * 8
    assert 0 < probed[0].seconds < 1
    # How many depends on how fast the machine is just now.
    assert re.search(r"saved after (each variant|every \d+ variants)\n", text)
    assert "up to a minute of compilation the first time" in text


def test_variants_computed_together__are_fewer_where_motion_is_asked(folder, monkeypatch):
    monkeypatch.setattr(blocks, "MOST_AT_ONCE_IN_MOTION", 2)
    study = read_study("study.toml")
    assert blocks.most_at_once(study) == 2


# run


def test_run_of_a_scene__groups_its_answers_by_regime(folder):
    text = said("run", "press.toml", "--no-plots").stdout
    heads = [line for line in text.splitlines() if line and not line.startswith(" ")]
    cycle = "cycle at 60 rpm, constant drive torque, all loads except brakes"
    before = ["Crank press", "1  ok", "start", "work", "stop", cycle]
    assert [line.partition(":")[0] for line in heads[:-3]] == before
    assert heads[-3].endswith("more with `sweeps show results/press.h5 --all`.")
    assert heads[-2].startswith("Warning: ")
    assert heads[-1].startswith("Files (")
    rows = [line.split()[0] for line in indented_under(text, "work: ")]
    assert rows[0] == "work.mean_speed"
    assert {"work.speed_fluctuation", "work.efficiency", "work.motor_moment_rms"} <= set(rows)
    assert "work.multiplier" not in rows
    assert "brake_heat" not in " ".join(rows)
    assert "stop.brake_heat" in text


def test_torque_of_a_motor__is_given_at_its_own_shaft_beside_the_rated_one(folder):
    """On a shaft at 24 times the crank's speed the torque is a 24th of that reduced to the crank; the rated P/ω."""
    done("new", "press_with_motor", "--out", "motor.toml")
    regimes, keys = ("start", "work"), ("peak", "rms")
    own = [f"{regime}.motor_shaft_torque_{key}" for regime in regimes for key in keys]
    reduced = [f"{regime}.motor_moment_{key}" for regime in regimes for key in keys]
    scene = read_scene("motor.toml")
    outcome = Machine(scene, [*own, *reduced, "motor.rated_moment"]).evaluate({})
    for one, other in zip(own, reduced, strict=True):
        assert outcome.summaries[one] == pytest.approx(outcome.summaries[other] / 24, rel=1e-15)
        assert outcome.errors[one] == pytest.approx(outcome.errors[other] / 24, rel=1e-6)
    motor = scene.moments["motor"]
    assert outcome.summaries["motor.rated_moment"] == pytest.approx(motor.power / motor.rated_speed, rel=1e-15)


def test_run__draws_the_history_and_the_steady_cycle(folder):
    files = said("run", "press.toml").stdout.split("Files")[1].split()
    names = "press.h5 press.png press_diagrams.png press_history.png press_work.png"
    assert [Path(f).name for f in files if "press" in f] == names.split()


# Name | what stands in the scene | what stands there instead | verdict | regime | words of its reason and of the mend.
FAILURES = cases(r"""
weak motor | stall_moment = "800 N m" | stall_moment = "60 N m" | STALLS | regime work | motors can't carry the loads
    | stronger motor
too fast | speed = "60 rpm"\nat_most | speed = "80 rpm"\nat_most | NO_END | regime start
    | 80 rpm is not reached | cycles, and closer to that speed it slows down | choose a speed that the
driven | off = ["motor", "punch"]\nrest | off = ["brake", "punch"]\nat_most = 5\nrest | NO_END | regime stop
    | it does not come to rest | a slower machine accelerates | switch off the drive
too short | speed = "60 rpm"\nat_most = 20 | cycles = 30\nat_most = 20 | NO_END | regime start
    | regimes.start.at_most ends it early | raise it
""")


@each("case", FAILURES)
def test_motion_that_fails__is_explained_with_its_regime_and_a_mend(case, folder):
    old, new, verdict, *words = FAILURES[case]
    change(old, new)
    ran = said("run", "press.toml", "--no-plots", "--replace").stdout
    result = SweepResult(Path("results/press.h5"))
    assert result.columns["status"][0] == Verdict[verdict]
    assert result.record["groups"][result.columns["status_group"][0]] == words[0].replace("regime ", "regimes.")
    for text in (ran, said("check", "press.toml").stdout) if case == "weak motor" else (ran,):
        line = next(line for line in text.splitlines() if f"{words[0]}: " in line)
        assert all(word in line for word in words), line
    # What is known without the motion is told all the same.
    assert "required_drive_moment" in ran


def test_run_of_a_study__counts_what_stalls_and_says_where_to_look(folder):
    text = said("run", "study.toml", "--no-plots").stdout
    assert any(line.split()[:2] == ["2", "ok"] for line in text.splitlines())
    assert any(line.split()[:2] == ["1", "stalls"] for line in text.splitlines())
    assert [line.split() for line in text.splitlines() if "regimes." in line] == [["regimes.work:", "1"]]
    shown = next(line for line in text.splitlines() if "motion of the first one" in line)
    command = shown.split(": sweeps ")[1].split()
    assert command == ["plot", "results/study.h5", "--variant", "1"]
    made = said(*command).stdout
    assert "study_1_history.png" in made
    assert "work" not in made
    assert "0 variants meet" in said("show", "results/study.h5", "--where", "work.speed_fluctuation < 0.1").stdout


# export


def test_export_history_with_loads__has_a_column_for_each_and_refuses_others(folder):
    said("export", "press.toml", "--history", "--columns", "input.reaction, frame.reaction_x", "--to", "h.csv")
    header, *rows = csv.reader(Path("h.csv").read_text().splitlines())
    assert header[:2] == ["regime", "time [s]"]
    assert header[-2:] == ["input.reaction [N]", "frame.reaction_x [N]"]
    assert list(dict.fromkeys(row[0] for row in rows)) == ["start", "work", "stop"]
    greatest = max(float(row[-2]) for row in rows if row[0] == "stop")
    found = Machine(read_scene("press.toml"), ["stop.input.reaction.max"]).evaluate({})
    value, figure = (part["stop.input.reaction.max"][0] for part in (found.summaries, found.errors))
    # Between two of the history's 360 instants of a cycle a sine falls by this share of its peak.
    assert value - 0.5 * (math.pi / 360) ** 2 * value - figure < greatest < value + figure
    text = refused("export", "press.toml", "--history", "--columns", "input.reactoin", "--to", "h.csv")
    assert "--columns" in text
    assert "did you mean 'input.reaction'" in text
    told = refused("export", "press.toml", "--history", "--to", "h.svg")
    assert "writes a table, .csv, .json, .parquet, .mat, not '.svg'" in told
    Path("press.toml").write_text(PRESS)
    assert "a history needs regimes" in refused("export", "press.toml", "--history", "--to", "h.csv")


def test_export_history_of_a_motion_that_fails__tells_why_on_standard_error(folder):
    change('speed = "60 rpm"\nat_most', 'speed = "80 rpm"\nat_most')
    answer = said("export", "press.toml", "--history", "--to", "h.csv")
    assert answer.exit_code == 0
    assert "The history ends early: regime start: 80 rpm is not reached" in answer.stderr
    assert {line.partition(",")[0] for line in Path("h.csv").read_text().splitlines()[1:]} == {"start"}


# Words


def scene_with(regimes: dict) -> Scene:
    data = read_scene("press.toml").model_dump(exclude_none=True)
    return Scene.model_validate(data | {"regimes": regimes})


def test_regime_words__tell_begin_end_and_what_is_off(folder):
    run = {"type": "run"}
    scene = scene_with(
        {
            "a": run | {"cycles": 1},
            "b": run | {"cycles": 2.5, "from_angle": 1.5707963267948966},
            "c": run | {"time": 3.0, "from_speed": 0.0, "off": ("gravity",)},
            "d": run | {"speed": 6.283185307179586, "from_speed": 3.141592653589793},
            "e": {"type": "steady"},
            "f": run | {"rest": True, "from_angle": 1.5707963267948966},
        }
    )
    assert [regime_words(scene, name) for name in scene.regimes] == [
        "run from rest for 1 cycle",
        "run from φ = 90 ° with the final speed of a for 2.5 cycles",
        "run from rest for 3 s; off: gravity",
        "run from 30 rpm until 60 rpm",
        "steady running",
        "run from φ = 90 ° of e to rest",
    ]


def test_telling_summaries__exist_and_leave_out_what_does_not_act(folder):
    scene = read_scene("press.toml")
    machine = Machine(scene)
    names = informative_summaries(machine)
    assert set(names) <= set(machine.available_summaries)
    of = by_regime(scene, names)
    assert list(of) == ["start", "work", "stop"]
    assert not any("useful" in name or "brake" in name or "final" in name for name in of["start"])
    assert {"work.useful_work", "work.efficiency", "work.multiplier"} <= set(of["work"])
    places = ["stop.final_position", "stop.ram.final_position"]
    assert of["stop"] == ["stop.time", "stop.angle", *places, "stop.brake_heat"]
    assert by_regime(scene, ["ram.stroke", "stop.time"]) == {"": ["ram.stroke"], "stop": ["stop.time"]}


def test_telling_summaries__ask_for_the_flywheel_where_none_is_given(folder):
    asked = 'speed_fluctuation = "1/20"'
    for wheel, told in ((asked, True), (f'{asked}\ninertia = "30 kg m2"', False)):
        change('inertia = "30 kg m2"', wheel)
        assert ("work.flywheel" in informative_summaries(Machine(read_scene("press.toml")))) == told


# A push of 0.1 s when the machine starts: its cycle at constant speed has no reduced moment.
TIMED = f"""{PRESS}
[flywheel]
inertia = "30 kg m2"

[moments.push]
type = "table"
on = "crank"
over_time = ["0 s", "0.1 s"]
moment = ["90 N m", "0 N m"]
interpolation = "linear"

[regimes.start]
type = "run"
time = "0.3 s"
from_speed = "40 rpm"
"""


COMMANDS = """run scene.toml --out r.h5 --no-plots
check scene.toml
show scene.toml --at 10,20
export scene.toml --to t.csv
report scene.toml --out p.html
balance scene.toml
quantities scene.toml"""


@each("command", COMMANDS.splitlines())
def test_load_over_time__leaves_every_command_what_repeats_with_the_cycle(command, press_folder):
    Path("scene.toml").write_text(TIMED, encoding="utf8")
    told = done(*command.split()) + "".join(path.read_text() for path in Path().glob("t.csv"))
    assert "reduced_inertia" in told or not command.startswith(("show", "export", "quant"))
    assert "reduced_moment" not in told
    assert "required_drive_moment" not in told
