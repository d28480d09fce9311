"""The command line: what is said, where it is said, and with which exit code."""

import ast
import itertools
import os
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import click.testing
import pytest

from engine.jit import set_threads
from sweeps import cli
from sweeps.results import Result
from sweeps.scenefile import read_scene
from sweeps.study import bundled, read_study
from sweeps.template import templates

ROOT = Path(__file__).parents[1]

SCENE = """\
title = "Crank press"

[points]
O = {x = "0 mm", y = "0 mm"}

[guides]
way = {angle = "-90 deg"}

[input]
type = "crank"
pivot = "O"
pin = "A"
length = "50 mm"
speed = "60 rpm"

[groups.slide]
type = "RRP"
inner = "B"
first = {link = "rod", joint = "A", length = "200 mm"}
second = {link = "ram", guide = "way"}

[bodies.ram]
link = "ram"
mass = "100 kg"

[forces.punch]
type = "constant"
on = "B"
angle = "90 deg"
force = "100 kN"
acts = "against"
"""

STUDY = """\
title = "Which crank?"
question = "Which crank does the least work?"
scene = "press.toml"
positions = 48

[vary]
"input.length" = {values = ["40 mm", "60 mm", "250 mm", "50 mm"]}
"bodies.ram.mass" = {values = ["50 kg", "100 kg"]}

[outputs]
summaries = ["ram.stroke", "excess_work"]

[best]
minimise = "excess_work"
where = "ram.stroke > '90 mm'"
"""


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("press.toml").write_text(SCENE)
    Path("study.toml").write_text(STUDY)
    yield tmp_path
    set_threads(0)


@pytest.fixture
def result(folder) -> str:
    assert said("run", "study.toml", "--no-plots", "--out", "r.h5").exit_code == 0
    return "r.h5"


def said(*arguments: str) -> click.testing.Result:
    """A command's answer; it never ends in an exception of its own."""
    answer = click.testing.CliRunner().invoke(cli.main, arguments)
    assert answer.exception is None or isinstance(answer.exception, SystemExit), answer.exception
    return answer


def refused(*arguments: str) -> str:
    """What a command says on standard error when it refuses."""
    answer = said(*arguments)
    assert answer.exit_code == 2, answer.output
    assert answer.stderr
    assert "Traceback" not in answer.output
    return answer.stderr


def python(*arguments: str, **options: object) -> subprocess.CompletedProcess:
    """A command as a process of its own, with pipes for its output."""
    return subprocess.run(
        [sys.executable, "-m", "sweeps", *arguments],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        **options,
    )


# run


def test_run__tells_counts_blame_answer_and_files(folder):
    answer = said("run", "study.toml", "--no-plots")
    assert answer.exit_code == 0
    lines = answer.stdout.splitlines()
    assert lines[0] == "Which crank?: 8 variants"
    assert any(line.split()[:2] == ["6", "ok"] for line in lines)
    assert any(line.startswith("2") and "cannot assemble" in line and "lengthen" in line for line in lines)
    assert any("group slide: 2" in line for line in lines)
    assert "Which crank does the least work?" in lines
    assert any(line.startswith("Answer: the least excess_work where ram.stroke > '90 mm' is") for line in lines)
    assert any(line.split() == ["input.length", "=", "50", "mm"] for line in lines)
    assert lines[-1].strip() == str(Path("results/study.h5"))
    assert answer.stderr == ""
    assert Result(Path("results/study.h5")).best() == 6


def test_run_of_a_scene__answers_for_the_machine_as_it_is(folder):
    answer = said("run", "press.toml", "--no-plots", "--out", "p.h5")
    assert answer.exit_code == 0
    assert "Crank press: 1 variant" in answer.stdout
    assert Result(Path("p.h5")).columns["status"].tolist() == [0]


def test_run_twice__leaves_the_finished_file(result):
    before = Path(result).stat().st_mtime_ns
    assert said("run", "study.toml", "--no-plots", "--out", result).exit_code == 0
    assert Path(result).stat().st_mtime_ns == before


def test_run_of_a_changed_study__needs_restart(result):
    Path("study.toml").write_text(STUDY.replace('"50 kg"', '"55 kg"'))
    message = refused("run", "study.toml", "--no-plots", "--out", result)
    for word in ("r.h5", "another study", '"50 kg"', '"55 kg"', "--restart"):
        assert word in message
    assert said("run", "study.toml", "--no-plots", "--out", result, "--restart").exit_code == 0
    assert Result(Path(result)).columns["bodies.ram.mass"][0] == 55


def test_run_with_jobs__gives_the_same_numbers(result):
    assert said("run", "study.toml", "--no-plots", "--out", "one.h5", "--jobs", "1").exit_code == 0
    one, all_cores = Result(Path("one.h5")).columns, Result(Path(result)).columns
    assert all(one[name].tobytes() == all_cores[name].tobytes() for name in all_cores)


@pytest.mark.parametrize("jobs", ["0", "-1", "many"])
def test_run_with_impossible_jobs__is_refused(jobs, folder):
    assert "--jobs" in refused("run", "study.toml", "--jobs", jobs)


def test_run_without_candidates__says_so_and_succeeds(folder):
    Path("study.toml").write_text(STUDY.replace("> '90 mm'", "> '9 m'"))
    answer = said("run", "study.toml", "--no-plots")
    assert answer.exit_code == 0
    assert "No variant was computed that meets the conditions" in answer.stdout


def test_run_where_nothing_assembles__says_so_and_succeeds(folder):
    Path("study.toml").write_text(STUDY.replace('"40 mm", "60 mm", "250 mm", "50 mm"', '"250 mm"'))
    answer = said("run", "study.toml", "--no-plots")
    assert answer.exit_code == 0
    assert "cannot assemble" in answer.stdout
    assert "No variant" in answer.stdout


def test_run_of_an_unknown_study__suggests_the_near_one(folder):
    message = refused("run", "crank_pres")
    assert "no such file" in message
    assert "did you mean 'crank_press'?" in message


def test_run_of_a_bad_study__tells_file_line_and_key(folder):
    Path("study.toml").write_text(STUDY.replace('"60 mm"', '"60 kg"'))
    message = refused("run", "study.toml", "--no-plots")
    assert message.startswith("Error: study.toml, line 7: vary.input.length: expected a length")
    assert not Path("results").exists()


def test_run_of_a_bad_scene__tells_the_scene_s_file(folder):
    Path("press.toml").write_text(SCENE.replace('joint = "A"', 'joint = "Z"'))
    assert "press.toml, line 19: groups.slide.first.joint: 'Z' is not a point" in refused("run", "study.toml")


def test_out_under_a_file__is_refused(folder):
    assert "press.toml" in refused("run", "study.toml", "--no-plots", "--out", "press.toml/r.h5")


def test_out_that_is_a_folder__is_refused(folder):
    Path("there.h5").mkdir()
    assert "there.h5 is a folder" in refused("run", "study.toml", "--no-plots", "--out", "there.h5")


def test_out_in_a_read_only_place__is_refused(folder):
    # The system's own tree is read-only even for an administrator.
    place = Path("/sys") if os.geteuid() == 0 else folder / "locked"
    place.mkdir(exist_ok=True)
    if os.geteuid():
        place.chmod(0o500)
    message = refused("run", "study.toml", "--no-plots", "--out", str(place / "r.h5"))
    assert str(place / "r") in message
    assert "--out" in message


def test_out_of_another_program__is_refused_and_kept(folder):
    Path("r.h5").write_text("my notes")
    assert "r.h5" in refused("run", "study.toml", "--no-plots", "--out", "r.h5")
    assert Path("r.h5").read_text() == "my notes"


def test_interrupt__has_its_own_exit_code(folder, monkeypatch):
    def stopped(*arguments: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("sweeps.runner.run_study", stopped)
    answer = said("run", "study.toml", "--no-plots")
    assert answer.exit_code == 130
    assert "Interrupted: 0 of 8 variants are done and kept; the same command goes on from there." in answer.stderr
    assert answer.stdout == ""


def interrupted(after: int) -> click.testing.Result:
    """A run stopped by the keyboard after so many variants, in blocks of three."""

    def stop(self: object, done: int, before: int) -> None:
        if done >= after:
            raise KeyboardInterrupt

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sweeps.runner.block_size", lambda study, machine: 3)
        patch.setattr("sweeps.progress.Progress.update", stop)
        return said("run", "study.toml", "--no-plots", "--out", "r.h5")


def test_interrupt__tells_how_many_variants_are_done_and_goes_on_from_there(folder, monkeypatch):
    assert "Interrupted: 3 of 8 variants are done and kept; the same command goes on" in interrupted(3).stderr
    assert said("show", "r.part.h5").stdout.startswith("Which crank?: 3 of 8 variants done; run the study again")
    assert "Interrupted: 6 of 8 variants" in interrupted(6).stderr
    monkeypatch.setattr("sweeps.runner.block_size", lambda study, machine: 3)
    assert said("run", "study.toml", "--no-plots", "--out", "r.h5").exit_code == 0
    assert said("show", "r.h5").stdout.startswith("Which crank?: 8 variants, all done")


REQUIRE = """require = [
  "bodies.ram.mass < '90 kg'",
  "input.length <= '60 mm'",
]
"""


def test_what_each_condition_drops__is_told_by_check_run_and_show(folder):
    Path("study.toml").write_text(STUDY.replace("positions", f"{REQUIRE}positions"))
    # Of 4 lengths × 2 masses: one mass in four lengths, one length in two masses; one variant fails both.
    counts = ["bodies.ram.mass < '90 kg': 4, 3 by this alone", "input.length <= '60 mm': 2, 1 by this alone"]
    checked = said("check", "study.toml").stdout
    assert "required, 5 of 8 dropped:" in checked
    assert all(line in checked for line in counts)
    ran, shown = said("run", "study.toml", "--no-plots", "--out", "r.h5").stdout, said("show", "r.h5").stdout
    for text in (ran, shown):
        lines = [line.strip() for line in text.splitlines()]
        dropped = next(i for i, line in enumerate(lines) if "dropped by a constraint" in line)
        assert lines[dropped].startswith("5 ")
        assert lines[dropped + 1 : dropped + 3] == counts
        # Failures of groups are told apart from what is dropped.
        assert "group slide" not in text


def test_what_each_condition_drops__counts_only_what_is_done(folder):
    Path("study.toml").write_text(STUDY.replace("positions", f"{REQUIRE}positions"))
    interrupted(3)
    # The first three variants: 40 mm with both masses, 60 mm with 50 kg.
    assert "bodies.ram.mass < '90 kg': 1, 1 by this alone" in said("show", "r.part.h5").stdout
    assert "input.length <= '60 mm': 0, 0 by this alone" in said("show", "r.part.h5").stdout


def test_what_each_condition_drops__is_a_share_by_a_sample_where_variants_are_many(folder, monkeypatch):
    from sweeps import report

    monkeypatch.setattr(report, "MOST_COUNTED", 64)
    monkeypatch.setattr(report, "LARGEST_BLOCK", 4)
    vary = '"input.length" = {from = "40 mm", to = "60 mm", count = 4001}'
    start, end = STUDY.index('"input.length"'), STUDY.index("[outputs]")
    text = STUDY[:start] + vary + "\n" + STUDY[end:]
    Path("study.toml").write_text(text.replace("positions", "require = [\"input.length > '45 mm'\"]\npositions"))
    line = next(line for line in said("check", "study.toml").stdout.splitlines() if "required" in line)
    share = float(line.split("about ")[1].split(" %")[0])
    # Sixteen samples evenly taken: the border lies within one of them.
    assert abs(share - 25) <= 100 / 15


def test_words_of_reports__are_the_engineer_s(result):
    texts = [said(*arguments).stdout for arguments in (("check", "study.toml"), ("show", result))]
    assert not any("block" in text for text in texts)


def test_progress_into_a_pipe__is_plain_lines_now_and_then(folder, monkeypatch):
    ticks = itertools.count(0.0, 40.0)
    clock = SimpleNamespace(monotonic=lambda: next(ticks), perf_counter=time.perf_counter)
    monkeypatch.setattr("sweeps.progress.time", clock)
    monkeypatch.setattr("sweeps.runner.block_size", lambda study, machine: 4)
    answer = said("run", "study.toml", "--no-plots")
    lines = answer.stderr.splitlines()
    assert len(lines) == 2
    assert lines[0].startswith("4 of 8 variants, ")
    assert lines[0].endswith(" s left")
    assert "\r" not in answer.stderr
    assert said("run", "study.toml", "--no-plots", "--restart", "--quiet").stderr == ""


# check


def test_check__tells_what_is_computed_and_what_it_costs_and_writes_nothing(folder):
    before = sorted(folder.rglob("*"))
    answer = said("check", "study.toml")
    assert answer.exit_code == 0
    assert answer.stderr == ""
    for words in (
        "Which crank?",
        "group slide: RRP of rod and ram",
        "W = 3n − 2p₁ = 3·3 − 2·4 = 1",
        "assembles over the whole cycle",
        "8 = input.length [4] × bodies.ram.mass [2]",
        "Computed at each of 48 positions",
        "Left out, as nothing asked needs it",
        "acceleration",
        "MB beside the program's own",
        "free",
    ):
        assert words in answer.stdout
    # In line, the stroke is twice the crank of 50 mm.
    assert any(line.split()[:2] == ["ram.stroke", "100"] for line in answer.stdout.splitlines())
    assert sorted(folder.rglob("*")) == before


def test_check_of_a_machine_that_turns_in_part__names_the_ranges(folder):
    Path("press.toml").write_text(SCENE.replace('"50 mm"', '"250 mm"'))
    answer = said("check", "press.toml")
    assert answer.exit_code == 0
    # Upright guide: the rod of 200 mm reaches while |250 cos φ| < 200, from 36.87° to 143.13° and opposite.
    line = next(line for line in answer.stdout.splitlines() if "assembles only" in line)
    assert "36.9" in line
    assert "143.1" in line
    assert "input.start and input.stop" in line


def test_check_of_a_machine_that_nowhere_assembles__says_so(folder):
    text = SCENE.replace('guide = "way"}', 'guide = "way", offset = "2 m"}')
    Path("press.toml").write_text(text)
    answer = said("check", "press.toml")
    assert answer.exit_code == 0
    assert "can't be assembled at any position" in answer.stdout


def test_check_source__is_python_to_read(folder):
    answer = said("check", "study.toml", "--source")
    assert answer.exit_code == 0
    module = ast.parse(answer.stdout)
    assert "kernel" in [node.name for node in module.body if isinstance(node, ast.FunctionDef)]
    assert "rrp_position(" in answer.stdout


def test_check_of_nothing__is_refused(folder):
    assert "nothing.toml" in refused("check", "nothing.toml")


# show


def table_of(stdout: str) -> list[list[str]]:
    """Rows of the table of variants: below its two lines of heads."""
    lines = stdout.splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("variant "))
    rows = itertools.takewhile(lambda line: line[:1].isdigit(), lines[first + 2 :])
    return [row.split() for row in rows]


def test_show__lists_what_meets_the_study_s_condition_the_best_first(result):
    answer = said("show", result)
    assert answer.exit_code == 0
    assert answer.stderr == ""
    assert answer.stdout.splitlines()[0] == "Which crank?: 8 variants, all done"
    assert [row[0] for row in table_of(answer.stdout)] == ["6", "7", "2", "3"]
    assert [row[1] for row in table_of(answer.stdout)] == ["50", "50", "60", "60"]
    assert "Answer: the least excess_work" in answer.stdout


def test_show_where_sort_limit_and_columns__choose(result):
    answer = said("show", result, "--where", "bodies.ram.mass > '60 kg'", "--sort", "ram.stroke", "--descending")
    assert [row[0] for row in table_of(answer.stdout)] == ["3", "7", "1"]
    assert "3 variants meet the condition" in answer.stdout
    answer = said("show", result, "--where", "ram.stroke > 0", "--sort", "ram.stroke", "--limit", "2")
    assert [row[0] for row in table_of(answer.stdout)] == ["0", "1"]
    answer = said("show", result, "--columns", "excess_work, status")
    head = next(line for line in answer.stdout.splitlines() if line.startswith("variant "))
    assert head.split() == ["variant", "input.length", "bodies.ram.mass", "excess_work", "status"]


def test_show_where_nothing_fits__shows_an_empty_table(result):
    answer = said("show", result, "--where", "ram.stroke > '9 m'")
    assert answer.exit_code == 0
    assert "0 variants meet the condition" in answer.stdout
    assert table_of(answer.stdout) == []


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--sort", "ram.strok"], ("sort", "did you mean 'ram.stroke'")),
        (["--columns", "ram.strok"], ("columns", "'ram.strok'", "ram.stroke")),
        (["--where", "ram.strok > 1"], ("where", "did you mean 'ram.stroke'")),
        (["--where", "ram.stroke >"], ("where", "ram.stroke >")),
        (["--where", "ram.stroke"], ("where", "condition")),
        (["--where", "ram.stroke > '3 foo'"], ("where", "3 foo")),
        (["--where", "__import__('os').system('touch stolen')"], ("where", "allowed")),
        (["--limit", "0"], ("--limit",)),
        (["--limit", "x"], ("--limit",)),
        (["--colour", "red"], ("--colour",)),
    ],
)
def test_show_with_a_bad_option__is_refused(options, words, result):
    message = refused("show", result, *options)
    assert all(word in message for word in words), message
    assert not Path("stolen").exists()


WRONG = {
    "empty": b"",
    "text.toml": b"title = 'x'",
    "random": bytes(range(256)),
    "damaged.h5": b"\x89HDF\r\n\x1a\n" + bytes(100),
    "folder": None,
    "nothing": None,
    "r.h5": None,
}
KINDS = [
    ("run check plot animate", "empty", "is empty; `sweeps new slider_crank` writes a scene"),
    ("show", "empty", "it is empty, so no result of a sweep"),
    ("run check plot animate", "text.toml", "scene: is missing"),
    ("show", "text.toml", "it is no HDF5 file, so no result of a sweep. Scenes and studies are looked at with"),
    ("run check plot animate", "random", "is not UTF-8 text"),
    ("show", "random", "it is no HDF5 file"),
    ("run check", "damaged.h5", "is a result file (HDF5), not a text; look at it with `sweeps show`"),
    ("show plot animate", "damaged.h5", "it is damaged or cut off"),
    ("run check plot animate", "folder", "is a folder; give a study or a scene"),
    ("show", "folder", "this is a folder"),
    ("show", ".", "this is a folder"),
    ("run check plot animate", "nothing", "there is no such file, and no bundled study of that name"),
    ("show", "nothing", "there is no such file. Results are .h5 files"),
    ("run check", "r.h5", "is a result file (HDF5), not a text; look at it with `sweeps show`"),
]


@pytest.mark.parametrize(
    ("command", "file", "words"), [(command, file, words) for all_, file, words in KINDS for command in all_.split()]
)
def test_file_of_the_wrong_kind__is_refused_in_one_sentence(command, file, words, result):
    Path("folder").mkdir()
    for name, content in WRONG.items():
        if content is not None:
            Path(name).write_bytes(content)
    message = refused(command, file)
    assert words in message
    assert f" {file}: " in message or f"{file}, line" in message
    assert len(message.splitlines()) == 1
    for foreign in ("h5py", "Unable", "Errno", "synchronously", "Traceback"):
        assert foreign not in message


def test_text_without_any_known_key__is_told_to_be_neither_study_nor_scene(folder):
    Path("other.toml").write_text("[project]\nname = 'x'\n")
    assert "neither a study (it has no key 'scene') nor a scene" in refused("check", "other.toml")


def test_result_under_another_name__is_known_by_its_content(result):
    Path(result).rename("r.dat")
    assert said("plot", "r.dat", "--variant", "2", "--out", "p.png").stdout.startswith("Wrote p.png")
    assert said("export", "r.dat", "--to", "r.csv").exit_code == 0
    assert len(Path("r.csv").read_text().splitlines()) == 9


def test_condition_of_another_dimension__is_refused_by_show_and_export(result):
    for command in (("show", result), ("export", result, "--to", "r.csv")):
        message = refused(*command, "--where", "ram.stroke > '2 kg'")
        assert "compares a length with a mass" in message
        assert "no unit: write '2 m'" in refused(*command, "--where", "ram.stroke > 2")


SLIDING = SCENE.replace(
    'type = "crank"\npivot = "O"\npin = "A"\nlength = "50 mm"\nspeed = "60 rpm"',
    'type = "slider"\nlink = "bar"\npoint = "A"\nguide = "bed"\nstart = "10 mm"\nstop = "50 mm"\nspeed = "1 m/s"',
).replace("[input]", 'bed = {angle = "0 deg"}\n\n[input]')


@pytest.mark.parametrize(
    ("scene", "head", "first", "second"),
    # A full turn in 360 steps; 40 mm in 360 steps from 10 mm on.
    [(SCENE, "phi [rad]", 0.0, 0.017453292519943295), (SLIDING, "q [m]", 0.01, 0.01 + 0.04 / 360)],
)
def test_export_of_positions__begins_with_the_input_and_its_unit(scene, head, first, second, folder):
    Path("press.toml").write_text(scene)
    assert said("export", "press.toml", "--to", "p.csv").exit_code == 0
    header, *rows = (line.split(",") for line in Path("p.csv").read_text().splitlines())
    assert header[0] == head
    assert [float(rows[0][0]), float(rows[1][0])] == pytest.approx([first, second], rel=1e-12)


def test_show_of_another_hdf5_file__is_refused(folder):
    import h5py

    with h5py.File("other.h5", "w") as file:
        file["x"] = [1, 2]
    assert "other.h5 is no result of a sweep" in refused("show", "other.h5")


# new, list, and what belongs to none


@pytest.mark.parametrize("name", sorted(templates()))
def test_new__writes_a_scene_that_can_be_read(name, folder):
    answer = said("new", name)
    assert answer.exit_code == 0
    assert f"Wrote {name}.toml" in answer.stdout
    scene = read_scene(Path(f"{name}.toml"))
    assert scene.title == templates()[name]


def test_new__never_overwrites(folder):
    assert "press.toml" in refused("new", "four_bar", "--out", "press.toml")
    assert Path("press.toml").read_text() == SCENE


def test_new__makes_the_folder_it_needs(folder):
    assert said("new", "four_bar", "--out", "a/b/mine.toml").exit_code == 0
    assert Path("a/b/mine.toml").exists()


def test_new_of_an_unknown_template__suggests_the_near_one(folder):
    assert "did you mean 'four_bar'?" in refused("new", "four_bars")
    assert "slider_crank" in refused("new", "zzz")


def test_new_where_it_cannot_be_written__is_refused(folder):
    assert "press.toml" in refused("new", "four_bar", "--out", "press.toml/mine.toml")


def test_list__names_every_study_and_template(folder):
    answer = said("list")
    assert answer.exit_code == 0
    for name, path in bundled().items():
        assert f"  {name}" in answer.stdout
        assert read_study(path).question in answer.stdout
    for name, title in templates().items():
        assert any(line.split() == [name, *title.split()] for line in answer.stdout.splitlines())


@pytest.mark.parametrize("name", sorted(bundled()))
def test_bundled_study__is_found_by_its_name_and_asks_a_question(name, folder):
    study = read_study(bundled()[name])
    assert study.question.endswith("?")
    assert study.best is not None


def test_version__is_told_whether_installed_or_not(folder):
    answer = said("--version")
    assert answer.exit_code == 0
    assert answer.stdout.startswith("sweeps")


def test_help__names_the_commands(folder):
    answer = said("--help")
    assert answer.exit_code == 0
    for command in ("run", "check", "show", "plot", "orders", "animate", "export", "new", "list", "flywheel"):
        assert f"  {command}" in answer.stdout
        assert said(command, "--help").exit_code == 0


def test_unknown_command__is_refused(folder):
    assert "frobnicate" in refused("frobnicate")


# As processes


def test_process__keeps_results_and_messages_apart(folder):
    done = python("run", "study.toml", "--no-plots")
    assert done.returncode == 0
    assert done.stderr == ""
    assert "\r" not in done.stdout
    wrong = python("run", "study.tom")
    assert (wrong.returncode, wrong.stdout) == (2, "")
    assert wrong.stderr.startswith("Error: study.tom: there is no such file")
    assert "Traceback" not in wrong.stderr


def test_process_in_a_plain_locale__still_writes_its_signs(folder):
    env = {**os.environ, "PYTHONPATH": str(ROOT), "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONIOENCODING": "ascii"}
    done = subprocess.run(
        [sys.executable, "-m", "sweeps", "check", "study.toml"], env=env, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
