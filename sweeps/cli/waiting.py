"""What the screen says while machine code is made, which takes seconds the first time."""

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

# Seconds after which something is said, and between one look and the next.
PATIENCE, LOOK = 1.0, 0.2
_CLEARED = "\r\x1b[K"


class Waiting:
    """Says on standard error, if that is a terminal, that something is compiled, and for how long.

    Nothing is said of what takes less than `PATIENCE`.
    """

    def __init__(self) -> None:
        self._ended = threading.Event()
        self._writing = threading.Lock()
        self._begun: float | None = None
        self._shown = False

    def watch(self) -> None:
        """Look every now and then until `end`; for a thread of its own."""
        while not self._ended.wait(LOOK):
            self.look(_is_compiling(), time.monotonic())

    def look(self, compiling: bool, now: float) -> None:
        """Say what is to be said at an instant, or take it back.

        Parameters
        ----------
        compiling : bool
            Whether something is compiled just now.
        now : float
            [s]
        """
        if not compiling:
            self._begun = None
            self.clear()
            return
        self._begun = now if self._begun is None else self._begun
        if now - self._begun >= PATIENCE:
            with self._writing:
                self._shown = True
                seconds = f"{now - self._begun:.0f} s"
                sys.stderr.write(f"{_CLEARED}Compiling this kind of machine, once for all times: {seconds}")
                sys.stderr.flush()

    def clear(self) -> None:
        """Take back what was said, so that something else may be written."""
        with self._writing:
            if self._shown:
                sys.stderr.write(_CLEARED)
                sys.stderr.flush()
            self._shown = False

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


def clear_the_line() -> None:
    """Take back what was said of waiting, before something else is written."""
    for waiting in _now:
        waiting.clear()
