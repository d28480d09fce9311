"""What the screen says while something is compiled: only on a terminal, only after a second."""

import io
import sys
import time
from types import SimpleNamespace

import pytest

from engine.compiling.kept_code import compiling
from sweeps.cli.waiting import Waiting, doing, status_line


class Terminal(io.StringIO):
    """A standard error that is a terminal."""

    def isatty(self) -> bool:
        return True


@pytest.fixture
def terminal(monkeypatch):
    screen = Terminal()
    # pytest sets the real one anew for every phase of a test.
    monkeypatch.setattr("sweeps.cli.waiting.sys", SimpleNamespace(stderr=screen, modules=sys.modules))
    return screen


def test_short_wait__is_not_told(terminal):
    waiting = Waiting()
    for now in (0.0, 0.5, 0.9):
        waiting.look(True, now)
    waiting.look(False, 1.0)
    assert terminal.getvalue() == ""


def test_long_wait__is_told_with_its_seconds_and_taken_back(terminal):
    waiting = Waiting()
    for now in (10.0, 11.0, 13.0):
        waiting.look(True, now)
    assert terminal.getvalue().endswith("(once only): 3 s")
    waiting.look(False, 13.2)
    assert terminal.getvalue().endswith("\r\x1b[K")
    before = terminal.getvalue()
    waiting.look(False, 13.4)
    waiting.end()
    assert terminal.getvalue() == before


def test_pause_between_two_waits__begins_anew(terminal):
    waiting = Waiting()
    for busy, now in ((True, 0.0), (True, 0.8), (False, 0.9), (True, 1.0), (True, 1.9)):
        waiting.look(busy, now)
    assert terminal.getvalue() == ""


def test_task__is_told_but_for_what_is_compiled_for_it(terminal):
    waiting = Waiting()
    waiting.name("Drawing")
    for busy, now in ((False, 0.0), (False, 1.5), (True, 1.7), (True, 3.7), (False, 4.0), (False, 4.8)):
        waiting.look(busy, now)
    said = [line.rstrip() for line in terminal.getvalue().split("\r\x1b[K") if line]
    assert said == ["Drawing: 2 s", "Compiling this type of machine (once only): 2 s"]
    waiting.look(False, 5.0)
    assert terminal.getvalue().endswith("Drawing: 1 s")
    waiting.name("")
    assert terminal.getvalue().endswith("\r\x1b[K")
    before = terminal.getvalue()
    waiting.look(False, 9.0)
    assert terminal.getvalue() == before


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr("sweeps.cli.waiting.PATIENCE", 0.0)
    monkeypatch.setattr("sweeps.cli.waiting.LOOK", 0.01)


def wait_for_words(terminal):
    for _ in range(500):
        if terminal.getvalue():
            break
        time.sleep(0.01)


def test_command__names_its_task_while_it_is_done(terminal, impatient):
    with status_line():
        with doing("Writing"):
            wait_for_words(terminal)
        assert terminal.getvalue().endswith("\r\x1b[K")
    assert "Writing: 0 s" in terminal.getvalue()


def test_compiling__is_seen_in_the_engine(terminal, impatient):
    with compiling(), status_line():
        wait_for_words(terminal)
    assert "Compiling this type of machine" in terminal.getvalue()
    assert terminal.getvalue().endswith("\r\x1b[K")


def test_file_or_pipe__stays_clean(monkeypatch):
    screen = io.StringIO()
    monkeypatch.setattr("sweeps.cli.waiting.sys", SimpleNamespace(stderr=screen, modules=sys.modules))
    with status_line():
        pass
    assert screen.getvalue() == ""
