"""The command line: files of the wrong kind, templates and studies, exit codes, processes."""

import os
import subprocess
import sys
from pathlib import Path

from commands import ROOT, done, python, refused, said
from each_case import each
from press_texts import PRESS

from sweeps import read_scene, read_study
from sweeps.study.bundled import bundled_studies
from sweeps.text.templates import templates

# Files of the wrong kind

DAMAGED = b"\x89HDF\r\n\x1a\n" + bytes(100)
WRONG = {"empty": b"", "text.toml": b"title = 'x'", "random": bytes(range(256)), "damaged.h5": DAMAGED}
KINDS = [
    ("run check plot animate", "empty", "is empty; `sweeps new slider_crank` writes a scene"),
    ("show", "empty", "it is empty, so not a sweep result"),
    ("run check plot animate", "text.toml", "scene: is missing"),
    ("show", "text.toml", "it is not an HDF5 file, so not a sweep result. `sweeps run text.toml` computes"),
    ("run check plot animate", "random", "is not UTF-8 text"),
    ("show", "random", "it is not an HDF5 file"),
    ("run check", "damaged.h5", "is a result file (HDF5), not a text; use `sweeps show`"),
    ("show plot animate", "damaged.h5", "it is damaged or truncated"),
    ("run check plot animate", "folder", "is a folder; give a study or a scene"),
    ("show", "folder", "this is a folder"),
    ("show", ".", "this is a folder"),
    ("run check plot animate", "nothing", "there is no such file, and no bundled study of that name"),
    ("show", "nothing", "there is no such file. Results are .h5 files"),
    ("run check", "r.h5", "is a result file (HDF5), not a text; use `sweeps show`"),
]


@each("command, file, words", [(command, file, words) for all_, file, words in KINDS for command in all_.split()])
def test_file_of_the_wrong_kind__is_refused_in_one_sentence(command, file, words, press_result):
    Path("folder").mkdir(exist_ok=True)
    for name, content in WRONG.items():
        Path(name).write_bytes(content)
    message = refused(command, file)
    assert words in message
    assert f" {file}: " in message or f"{file}, line" in message
    assert len(message.splitlines()) == 1
    for foreign in ("h5py", "Unable", "Errno", "synchronously", "Traceback"):
        assert foreign not in message


def test_text_without_any_known_key__is_told_to_be_neither_study_nor_scene(press_folder):
    Path("other.toml").write_text("[project]\nname = 'x'\n")
    assert "neither a study (it has no key 'scene') nor a scene" in refused("check", "other.toml")


def test_result_under_another_name__is_known_by_its_content(press_result):
    Path(press_result).rename("r.dat")
    assert said("plot", "r.dat", "--variant", "2", "--out", "p.png").stdout.startswith("Wrote p.png")
    assert said("plot", "r.dat", "-x", "input.length").stdout == "Wrote r_input_length.png\n"
    done("export", "r.dat", "--to", "r.csv")
    assert len(Path("r.csv").read_text().splitlines()) == 9


# new, list, and what belongs to none


@each("name", sorted(templates()))
def test_new__writes_a_scene_that_can_be_read(name, press_folder):
    answer = done("new", name)
    assert f"Wrote {name}.toml" in answer
    scene = read_scene(Path(f"{name}.toml"))
    assert scene.title == templates()[name]


def test_new__writes_where_it_is_told_and_never_over_what_is_there(press_folder):
    done("new", "four_bar", "--out", "a/b/mine.toml")
    assert Path("a/b/mine.toml").exists()
    for out in ("press.toml", "press.toml/mine.toml"):
        assert "press.toml" in refused("new", "four_bar", "--out", out)
    assert Path("press.toml").read_text() == PRESS
    assert "did you mean 'four_bar'?" in refused("new", "four_bars")
    assert "slider_crank" in refused("new", "zzz")


def test_list__wraps_at_the_width_of_the_terminal(monkeypatch):
    monkeypatch.setenv("COLUMNS", "72")
    lines = done("list").splitlines()
    assert 60 < max(map(len, lines)) <= 72


def test_list__names_every_study_and_template(press_folder):
    answer = done("list")
    for name, path in bundled_studies().items():
        assert f"  {name}" in answer
        assert read_study(path).question in " ".join(answer.split())
    for name, title in templates().items():
        assert any(line.split() == [name, *title.split()] for line in answer.splitlines())


def test_help__names_the_commands(press_folder):
    answer = done("--help")
    for command in ("run", "check", "show", "plot", "orders", "animate", "export", "new", "list", "flywheel"):
        assert f"  {command}" in answer
        done(command, "--help")
    assert done("--version").startswith("sweeps")
    assert "frobnicate" in refused("frobnicate")


# As processes


def test_process__keeps_results_and_messages_apart(press_folder):
    done = python("run", "study.toml", "--no-plots")
    assert done.returncode == 0
    assert done.stderr == ""
    assert "\r" not in done.stdout
    wrong = python("run", "study.tom")
    assert (wrong.returncode, wrong.stdout) == (2, "")
    assert wrong.stderr.startswith("Error: study.tom: there is no such file")
    assert "Traceback" not in wrong.stderr


def test_process_in_a_plain_locale__still_writes_its_signs(press_folder):
    env = {**os.environ, "PYTHONPATH": str(ROOT), "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONIOENCODING": "ascii"}
    line = [sys.executable, "-m", "sweeps", "check", "study.toml"]
    done = subprocess.run(line, env=env, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
