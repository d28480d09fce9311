"""What the screen says while machine code is made, or something else takes longer than a second."""

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

# Seconds after which something is said, and between one look and the next.
PATIENCE, LOOK = 1.0, 0.2
_CLEARED = "\r\x1b[K"
_COMPILING = "Compiling this kind of machine, once for all times"


class Waiting:
    """Says on standard error, if that is a terminal, that something is compiled or done, and for how long.

    Nothing is said of what takes less than `PATIENCE`.
    """

    def __init__(self) -> None:
        self._ended = threading.Event()
        self._writing = threading.Lock()
        self._begun: float | None = None
        self._shown = self._task = self._words = ""

    def watch(self) -> None:
        """Look every now and then until `end`; for a thread of its own."""
        while not self._ended.wait(LOOK):
            self.look(_is_compiling(), time.monotonic())

    def look(self, compiling: bool, now: float) -> None:
        """Say what is to be said at an instant, or take it back.

        Parameters
        ----------
        compiling : bool
            Whether something is compiled just now; that is said rather than what it is for.
        now : float
            [s]
        """
        with self._writing:
            words = _COMPILING if compiling else self._task
            if words != self._words:
                self._words, self._begun = words, now
                self._take_back()
            # A look may have begun before the end and come to write after it.
            if words and now - self._begun >= PATIENCE and not self._ended.is_set():
                self._shown = words
                sys.stderr.write(f"{_CLEARED}{words}: {now - self._begun:.0f} s")
                sys.stderr.flush()

    def name(self, task: str) -> None:
        """Name what is being done, "" where nothing need be said of it."""
        with self._writing:
            self._task = task
            self._take_back()

    def clear(self) -> None:
        """Take back what was said, so that something else may be written."""
        with self._writing:
            self._take_back()

    def _take_back(self) -> None:
        if self._shown:
            sys.stderr.write(_CLEARED)
            sys.stderr.flush()
        self._shown = ""

    def end(self) -> None:
        """Say nothing any more."""
        self._ended.set()
        self.clear()


def _is_compiling() -> bool:
    # Not loaded here: what takes no machine code starts quickly.
    if "engine.compiling.kept_code" not in sys.modules:
        return False
    from engine import is_compiling

    return is_compiling()


_now: list[Waiting] = []


@contextmanager
def waiting_told() -> Iterator[None]:
    """Tell of compiling while a command runs on a terminal."""
    if not sys.stderr.isatty():
        yield
        return
    waiting = Waiting()
    _now.append(waiting)
    threading.Thread(target=waiting.watch, daemon=True).start()
    try:
        yield
    finally:
        _now.remove(waiting)
        waiting.end()


@contextmanager
def doing(task: str) -> Iterator[None]:
    """Tell what a command does that shows no progress of its own, once that takes longer than `PATIENCE`."""
    for waiting in _now:
        waiting.name(task)
    try:
        yield
    finally:
        for waiting in _now:
            waiting.name("")


def clear_the_line() -> None:
    """Take back what was said of waiting, before something else is written."""
    for waiting in _now:
        waiting.clear()
