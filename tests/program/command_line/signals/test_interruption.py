"""Signals, a full disk under what is written, and readers that go away: a sentence and an exit code each."""

import ast
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from commands import ROOT, WRITES, done, ran, said

from sweeps.text.interruption import farewell, half_written, keeping
from sweeps.text.whole_files import whole_file

ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT)}

# A draft and a folder for drafts, with something in them.
DRAFTING = """
import sys, time
from contextlib import ExitStack
from sweeps.text.whole_files import scratch_folder, whole_file
from sweeps.text.interruption import listen
listen()
stack = ExitStack()
stack.enter_context(whole_file("out.csv")).write_text("much")
(stack.enter_context(scratch_folder(".")) / "part.h5").write_text("more")
print("here", flush=True)
"""
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
    with started(DRAFTING + BUSY[busy], "run", "a b.toml", "--restart", cwd=tmp_path) as process:
        assert len(list(tmp_path.iterdir())) == 2
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
def test_disk_that_fills_up_while_a_file_is_written__one_sentence(press_folder):
    import resource

    before, limits = sorted(press_folder.rglob("*")), resource.getrlimit(resource.RLIMIT_FSIZE)
    former = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, limits[1]))
        answer = said("export", "press.toml", "--to", "out.csv")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, former)
    assert answer.exit_code == 2
    assert "File too large" in answer.stderr
    assert answer.stderr.count("\n") == 1
    assert sorted(press_folder.rglob("*")) == before


# Files that commands write in folders that others may write to: nobody can predict a draft or redirect it.


def test_draft__is_created_by_its_writer_alone(press_folder, blank_pictures, monkeypatch):
    """The system's call that creates it fails where there is anything, a link too."""
    opened, real = [], os.open

    def noted(path: object, flags: int, *rest: object, **options: object) -> int:
        if isinstance(path, Path) and flags & os.O_CREAT and path.parent == press_folder.resolve():
            opened.append((path.name, flags))
        return real(path, flags, *rest, **options)

    monkeypatch.setattr(os, "open", noted)
    # The mode that the finished file gets is the one that its user's files have.
    mask = os.umask(0o027)
    try:
        for arguments in [*WRITES, WRITES[0]]:
            Path(arguments[-1]).unlink(missing_ok=True)
            before = len(opened)
            done(*arguments)
            assert len(opened) > before, arguments
    finally:
        os.umask(mask)
    assert len({name for name, _ in opened}) == len(opened)
    assert all(flags & os.O_EXCL and flags & os.O_NOFOLLOW for _, flags in opened)
    made = [path for path in press_folder.glob("out*") if path.is_file()]
    assert len(made) >= len(WRITES)
    assert {path.stat().st_mode & 0o777 for path in made} == {0o640}


def test_planted_link__is_not_written_through(press_folder, monkeypatch):
    """Even where the name of a draft is known beforehand."""
    monkeypatch.setattr("sweeps.text.whole_files.secrets.token_hex", lambda count: "known")
    target = press_folder / "target"
    # All of them write by one function: see the last test.
    for arguments in WRITES[:1] + WRITES[-2:]:
        link = press_folder / f".known{Path(arguments[-1]).suffix}"
        link.symlink_to(target)
        answer = said(*arguments)
        assert answer.exit_code == 2, arguments
        assert answer.stderr.count("\n") == 1
        assert "File exists" in answer.stderr
        assert not target.exists()
        link.unlink()


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root makes links of other users")
@pytest.mark.parametrize("name", ["out.csv", "out.part.h5"])
def test_link_of_another_user__is_refused(name, press_folder):
    target = press_folder / "target"
    target.write_text("precious")
    os.symlink(target, name)
    os.lchown(name, 65534, 65534)
    command = ("export", "press.toml", "--to", name) if name == "out.csv" else ("run", "study.toml", "--out", "out.h5")
    answer = said(*command)
    assert answer.exit_code == 2
    assert "link owned by another user" in answer.stderr
    assert target.read_text() == "precious"
    # The owner of a folder may lead what is written in it elsewhere.
    os.chown(".", 65534, 65534)
    if name == "out.csv":
        done(*command)
        assert target.read_text() != "precious"


WRITING = {"write_text", "write_bytes", "savefig", "saveas", "save", "copyfile"}
# They are handed a draft, write into memory, or make result files, which HDF5 creates exclusively.
OTHERWISE = {"python/display.py", "store/creating.py"}


def test_every_writer__takes_its_draft_from_one_place():
    for path in (ROOT / "sweeps").rglob("*.py"):
        text, name = path.read_text(encoding="utf8"), path.relative_to(ROOT / "sweeps").as_posix()
        # Folders too, which a signal is to remove.
        assert "import tempfile" not in text or name == "text/whole_files.py", name
        for call in (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)):
            called = call.func.attr if isinstance(call.func, ast.Attribute) else ""
            # What commands need of other rooms is written there.
            called = "" if ast.unparse(call.func).startswith("needed.") else called
            modes = [a.value for a in call.args if isinstance(a, ast.Constant) and isinstance(a.value, str)]
            opens = called in {"open", "File"} and any({*mode} <= {*"wax+bt"} and mode != "b" for mode in modes)
            if (opens or called in WRITING) and name not in OTHERWISE:
                assert "whole_file" in text, f"{name}, line {call.lineno}: write to a draft of whole_file"


if sys.platform == "win32":
    pytestmark = pytest.mark.skip("needs links")
