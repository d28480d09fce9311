"""Fixtures of several files."""

import gc
import os
import shutil
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from commands import STUDY, leave_pictures_blank, said
from hypothesis import settings
from numba.core import event
from press_texts import PRESS, PRESS_WITH_FLYWHEEL

from engine.compiling import printed_functions
from engine.compiling.ahead import wait_until_compiled
from engine.compiling.threads import set_threads
from engine.cycle.cycle_machine import compile_driver
from engine.cycle.plan import CycleSpeed, Kept, Plan, VectorAngle
from engine.stepping.system import compile_walks_ahead
from engine.stepping.walk import walk
from engine.units.display import show_errors, show_units_of

# Thousands of tests and all compiled functions stay until the end: looking for garbage among them takes a tenth of
# the time.
gc.set_threshold(50_000, 20, 20)

# No deadlines: other work on the machine delays any example. The same examples in every run of CI; others on every
# developer's machine.
settings.register_profile("engine", deadline=None, derandomize="CI" in os.environ)
settings.load_profile("engine")

# A background job of a script ignores SIGINT, one under nohup SIGHUP, and so would the commands that tests start.
for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
    if signal.getsignal(number) is signal.SIG_IGN:
        signal.signal(number, signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL)


class Compiling(event.Listener):
    """Adds up the processor time of compiling, where functions compile those they call."""

    def __init__(self) -> None:
        self.depth, self.time = 0, 0.0

    def counting(self, function: Callable) -> Callable:
        """The same function, whose time counts."""

        def counted(*given: object) -> object:
            self.on_start(None)
            try:
                return function(*given)
            finally:
                self.on_end(None)

        return counted

    def on_start(self, event: event.Event | None) -> None:
        self.time -= time.process_time() if self.depth == 0 else 0.0
        self.depth += 1

    def on_end(self, event: event.Event | None) -> None:
        self.depth -= 1
        self.time += time.process_time() if self.depth == 0 else 0.0


# Each worker measures its own; the summary adds them up.
_COMPILING = Compiling()
event.register("numba:compile", _COMPILING)
printed_functions._translated = _COMPILING.counting(printed_functions._translated)
_TIMES: list[tuple[float, float]] = []


@pytest.hookimpl(tryfirst=True)
def pytest_sessionstart(session: pytest.Session) -> None:
    """Compile what all machines share, with every measure, before several workers need it at once."""
    if not getattr(session.config.option, "numprocesses", None):
        return
    compile_walks_ahead()
    plan = Plan(ends=(0, 1), curves=2, cuts=(0,))
    plan.find_extremes(Kept((0,)))
    plan.find_extremes(VectorAngle((0, 1)))
    plan.find("fluctuations", CycleSpeed((0, 1), 0, 1))
    plan.find("averages", Kept((0,)))
    plan.find("roots", 0)
    plan.find("arcs", (0, 1, 1))
    plan.find("spaced", Kept((0,)))
    compile_driver(plan)
    wait_until_compiled(walk)


def pytest_sessionfinish(session: pytest.Session) -> None:
    times = _COMPILING.time, time.process_time()
    output = getattr(session.config, "workeroutput", None)
    if output is None:
        _TIMES.append(times)
    else:
        output["times"] = times


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: object) -> None:
    _TIMES.append(getattr(node, "workeroutput", {}).get("times", (0.0, 0.0)))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    compiled, used = (sum(column) for column in zip(*_TIMES, strict=True))
    terminalreporter.write_line(f"{used:.0f} s of processor time in tests, {compiled:.0f} s of them compiling")


@pytest.fixture(autouse=True)
def shown_by_default() -> None:
    """Show numbers in metric units, without small error estimates, whatever was shown before."""
    show_units_of({})
    show_errors(False)


@pytest.fixture(autouse=True)
def silent_pictures(caplog: pytest.LogCaptureFixture) -> Iterator[None]:
    """Matplotlib reports missing glyphs and the like in its log, not as warnings."""
    yield
    logged = [record.getMessage() for record in caplog.get_records("call") if record.name.startswith("matplotlib")]
    assert not logged, logged


@pytest.fixture
def blank_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Files of pictures without what is drawn."""
    leave_pictures_blank(monkeypatch)


def write_press() -> None:
    Path("press.toml").write_text(PRESS)
    Path("study.toml").write_text(STUDY)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder to give commands in."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def press_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with a press and its study, to give commands in."""
    monkeypatch.chdir(tmp_path)
    write_press()
    yield tmp_path
    set_threads(0)


@pytest.fixture(scope="session")
def finished_press(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The result of the study, computed once."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("finished"))
        write_press()
        assert said("run", "study.toml", "--no-plots", "--out", "r.h5").exit_code == 0
        return Path("r.h5").resolve()


@pytest.fixture
def press_result(press_folder: Path, finished_press: Path) -> str:
    """The result of the study, done."""
    shutil.copy(finished_press, "r.h5")
    return "r.h5"


@pytest.fixture
def study_folder(tmp_path: Path) -> Path:
    """A folder with the scene that studies are written for."""
    (tmp_path / "press.toml").write_text(PRESS_WITH_FLYWHEEL)
    return tmp_path
