"""Status line while code compiles or something else takes longer than a second."""

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import engine

# Delay before the status line appears, and polling interval [s].
PATIENCE, LOOK = 1.0, 0.2
_CLEARED = "\r\x1b[K"
_COMPILING = "Compiling this type of machine (once only)"


class Waiting:
    """Print on standard error, if that is a terminal, that something is compiled or done, and for how long.

    Tasks shorter than `PATIENCE` show nothing.
    """

    def __init__(self) -> None:
        self._ended = threading.Event()
        self._writing = threading.RLock()
        self._begun: float | None = None
        self._shown = self._task = self._words = ""

    def watch(self) -> None:
        """Poll until `end`, in a separate thread."""
        while not self._ended.wait(LOOK):
            self.look(_is_compiling(), time.monotonic())

    def look(self, compiling: bool, now: float) -> None:
        """Update or clear the status line.

        Parameters
        ----------
        compiling : bool
            Whether code is compiling, which takes precedence.
        now : float
            [s]
        """
        with self._writing:
            words = _COMPILING if compiling else self._task
            if words != self._words:
                self._words, self._begun = words, now
                self.clear()
            # A poll may finish after the end.
            if words and now - self._begun >= PATIENCE and not self._ended.is_set():
                self._shown = words
                sys.stderr.write(f"{_CLEARED}{words}: {now - self._begun:.0f} s")
                sys.stderr.flush()

    def name(self, task: str) -> None:
        """Set the current task; "" for none."""
        with self._writing:
            self._task = task
            self.clear()

    def clear(self) -> None:
        """Clear the status line."""
        with self._writing:
            if self._shown:
                sys.stderr.write(_CLEARED)
                sys.stderr.flush()
            self._shown = ""

    def end(self) -> None:
        """Stop."""
        self._ended.set()
        self.clear()


def _is_compiling() -> bool:
    # Don't import it here: commands without compiled code start quickly.
    return "engine.compiling.kept_code" in sys.modules and engine.is_compiling()


_now: list[Waiting] = []


@contextmanager
def status_line() -> Iterator[None]:
    """Show compilation while a command runs on a terminal."""
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
    """Show a task without its own progress bar once it takes longer than `PATIENCE`."""
    for waiting in _now:
        waiting.name(task)
    try:
        yield
    finally:
        for waiting in _now:
            waiting.name("")


def clear_the_line() -> None:
    """Clear the status line before other output."""
    for waiting in _now:
        waiting.clear()
