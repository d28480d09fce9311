"""Signals, a full disk under what is written, and readers that go away: a sentence and an exit code each."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from commands import ROOT, WRITES, done, python, ran, said

from sweeps.text.interruption import farewell, half_written, keeping
from sweeps.text.whole_files import whole_file

ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT)}

BUSY = {
    "loading": "import xml.dom, email, ast, tomllib; time.sleep(30)",
    "computing": "while True: pass",
    "waiting for a thread": "import threading; threading.Event().wait()",
    "in code that swallows what is raised": "while True:\n    try: time.sleep(30)\n    except BaseException: pass",
}


def started(code: str, *arguments: str, cwd: Path) -> subprocess.Popen:
    """A process that says when it is there."""
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    line = [sys.executable, "-c", code, *arguments]
    process = subprocess.Popen(line, cwd=cwd, env=ENVIRONMENT, text=True, **pipes)
    assert process.stdout.readline() == "here\n"
    return process


def last_words(process: subprocess.Popen) -> str:
    """What a process that was sent a signal writes to standard error; one that goes on is killed."""
    try:
        return process.communicate(timeout=60)[1]
    finally:
        process.kill()


@pytest.mark.parametrize(("number", "busy"), [*((signal.SIGINT, busy) for busy in BUSY), (signal.SIGTERM, "computing")])
def test_signal__ends_the_program_with_one_sentence(number, busy, tmp_path):
    head = "import sys, time\nfrom sweeps.text.interruption import half_written, listen\nlisten()\n"
    head += "half_written.add('draft'); open('draft', 'w').close(); print('here', flush=True)\n"
    with started(head + BUSY[busy], "run", "a b.toml", "--restart", cwd=tmp_path) as process:
        process.send_signal(number)
        errors = last_words(process)
    assert process.returncode == 128 + number
    assert errors == "Interrupted: no file is left half-written; resume with: sweeps run 'a b.toml'\n"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["SIGINT", "SIGHUP"])
def test_ignored_signal__stays_ignored(name, tmp_path):
    """As under nohup."""
    code = f"import signal; signal.signal(signal.{name}, signal.SIG_IGN); from sweeps.text.interruption import listen; "
    code += f"listen(); import os; os.kill(os.getpid(), signal.{name}); import time; time.sleep(0.3); print('well')"
    done = ran("-c", code, cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "well\n", "")


def test_signal_while_python_ends__changes_nothing(tmp_path):
    code = "import atexit, os, sys, time; sys.argv = ['sweeps', 'list']; from sweeps.__main__ import start; "
    code += f"atexit.register(lambda: (os.kill(os.getpid(), {int(signal.SIGINT)}), time.sleep(0.5))); start()"
    done = ran("-c", code, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "crank_press" in done.stdout


DRAFTING = """
import sys, time
from sweeps.text.whole_files import scratch_folder, whole_file
from sweeps.text.interruption import listen
listen()
with whole_file("out.csv") as draft, scratch_folder(".") as folder:
    draft.write_text("much")
    (folder / "part.h5").write_text("more")
    print("here", flush=True)
    time.sleep(60)
"""


def test_draft_and_scratch_folder__are_removed_by_a_signal(tmp_path):
    with started(DRAFTING, cwd=tmp_path) as process:
        assert len(list(tmp_path.iterdir())) == 2
        process.send_signal(signal.SIGTERM)
        last_words(process)
    assert list(tmp_path.iterdir()) == []


def test_farewell__tells_what_the_innermost_run_keeps():
    with keeping(lambda: "two eggs are kept"):
        assert farewell().startswith("Interrupted: two eggs are kept; resume with: sweeps")
    assert "two eggs" not in farewell()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a full device")
def test_full_disk_under_standard_output__one_sentence():
    with open("/dev/full", "w") as full:
        line = [sys.executable, "-m", "sweeps", "new", "--help"]
        done = subprocess.run(line, env=ENVIRONMENT, stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 2
    assert done.stderr.startswith("Error: ")
    assert done.stderr.endswith("No space left on device\n")
    assert done.stderr.count("\n") == 1


def test_reader_that_goes_away__nothing_said():
    line, pipes = [sys.executable, "-m", "sweeps", "list"], {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(line, env=ENVIRONMENT, text=True, **pipes) as process:
        process.stdout.close()
        errors = process.stderr.read()
        process.wait()
    assert errors == ""


def test_name_longer_than_a_disk_takes__is_told_in_part_and_spelt_out():
    answer = python("check", "\x1b[2J" + 5000 * "a", timeout=60)
    assert answer.returncode == 2
    assert answer.stderr.startswith("Error: \\x1b[2Jaaaa")
    assert "too long" in answer.stderr
    assert len(answer.stderr) < 3000
    assert "\x1b" not in answer.stderr


# Files written whole


def test_file__is_replaced_at_the_end_only(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("good")
    with whole_file(path) as draft:
        draft.write_text("new")
        assert path.read_text() == "good"
        assert draft.suffix == ".txt"
        assert str(draft) in half_written
    assert path.read_text() == "new"
    with pytest.raises(TypeError), whole_file(path) as draft:
        draft.write_bytes("not bytes")
    assert path.read_text() == "new"
    assert (list(tmp_path.iterdir()), half_written) == ([path], set())


def test_link_and_device__stay_what_they_are(tmp_path):
    path, link = tmp_path / "a.txt", tmp_path / "link.txt"
    path.write_text("good")
    link.symlink_to(path)
    with whole_file(link) as draft:
        draft.write_text("new")
    assert link.is_symlink()
    assert path.read_text() == "new"
    with whole_file("/dev/null") as draft:
        assert draft == Path("/dev/null")


OF_RESULT = ("export", "results/study.h5", "--to", "out.csv")
WRITERS = [OF_RESULT, WRITES[0], *WRITES[5:8], WRITES[-2]]


@pytest.mark.parametrize("arguments", WRITERS, ids=lambda a: " ".join(a[:2] + a[-1:]))
def test_full_disk_under_a_file__one_sentence_and_the_earlier_file_stays(arguments, press_folder, monkeypatch):
    if arguments is OF_RESULT:
        done("run", "study.toml", "--no-plots")
    earlier = Path(arguments[-1])
    if arguments[0] != "new":
        earlier.write_text("earlier")

    def refuse(self: Path, target: Path) -> None:
        raise OSError(28, "No space left on device")

    before = sorted(press_folder.rglob("*"))
    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", refuse)
        answer = said(*arguments)
    assert answer.exit_code == 2
    assert "No space left on device" in answer.stderr
    assert answer.stderr.count("\n") == 1
    assert sorted(press_folder.rglob("*")) == before
    if arguments[0] != "new":
        assert earlier.read_text() == "earlier"


@pytest.mark.skipif(sys.platform == "win32", reason="needs a limit of files' sizes")
@pytest.mark.parametrize("ending", ["pdf", "csv"])
def test_disk_that_fills_up_while_a_file_is_written__one_sentence(ending, press_folder):
    import resource

    before, limits = sorted(press_folder.rglob("*")), resource.getrlimit(resource.RLIMIT_FSIZE)
    former = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, limits[1]))
        verb = ("plot", "press.toml", "--out") if ending in ("pdf", "png") else ("export", "press.toml", "--to")
        answer = said(*verb, f"out.{ending}")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, former)
    assert answer.exit_code == 2
    assert "File too large" in answer.stderr
    assert answer.stderr.count("\n") == 1
    assert sorted(press_folder.rglob("*")) == before
