"""Ctrl-C, a closed terminal and the termination signal end the program at once with a message.

Nothing is unwound: blocks of a result file are either flagged as done or recomputed, and all other files are written as
drafts and renamed. A thread waits for the signals, because compiled code can block the main thread for seconds.
"""

import os
import shlex
import shutil
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

# Drafts and scratch folders to remove on exit.
half_written: set[str] = set()
_HEARD = (signal.SIGINT, signal.SIGTERM, *([signal.SIGHUP] if hasattr(signal, "SIGHUP") else []))
_state: list[Callable[[], str]] = [lambda: "no file is left half-written"]


def listen() -> None:
    """Handle SIGINT, SIGTERM and SIGHUP, unless they are ignored, as under nohup."""
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    signal.set_wakeup_fd(writing, warn_on_full_buffer=False)
    for number in _HEARD:
        if signal.getsignal(number) is not signal.SIG_IGN:
            # The signal number still goes to the pipe.
            signal.signal(number, lambda *_: None)
    threading.Thread(target=_wait, args=(reading,), name="interruption", daemon=True).start()


def finish() -> None:
    """Ignore signals during interpreter shutdown."""
    for number in _HEARD:
        signal.signal(number, signal.SIG_IGN)


@contextmanager
def keeping(words: Callable[[], str]) -> Iterator[None]:
    """Context whose words an interruption reports.

    Parameters
    ----------
    words : callable
        Returns a clause on the results that are kept; called from another thread.
    """
    _state.append(words)
    try:
        yield
    finally:
        _state.remove(words)


def farewell() -> str:
    """Message of an interrupted run: what is kept, and how to resume."""
    # --restart would discard it.
    again = shlex.join(["sweeps", *(word for word in sys.argv[1:] if word != "--restart")])
    return f"Interrupted: {_state[-1]()}; resume with: {again}"


def _wait(reading: int) -> None:
    number = os.read(reading, 1)[0]
    for draft in list(half_written):
        if os.path.isdir(draft):
            shutil.rmtree(draft, ignore_errors=True)
            continue
        try:
            os.unlink(draft)
        except OSError:
            continue
    # A progress bar may be on the line.
    start = "\n" if sys.stderr is not None and sys.stderr.isatty() else ""
    try:
        os.write(2, f"{start}{farewell()}\n".encode(errors="replace"))
    finally:
        os._exit(128 + number)
