"""Ctrl-C, a closed terminal and the signal to terminate: the program ends at once with a sentence, whatever it does.

Nothing is unwound: blocks of a result file are either flagged as done or computed again, and all other files are
written beside and renamed. A thread waits for the signals, as compiled code keeps the main thread from hearing them,
sometimes for seconds.
"""

import os
import shlex
import shutil
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

# Drafts of files and scratch folders, by name: removed on the way out.
half_written: set[str] = set()
_HEARD = (signal.SIGINT, signal.SIGTERM, *([signal.SIGHUP] if hasattr(signal, "SIGHUP") else []))
_state: list[Callable[[], str]] = [lambda: "no file is left half-written"]


def listen() -> None:
    """Take over SIGINT, SIGTERM and SIGHUP, unless they are ignored, as they are by commands under nohup."""
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    signal.set_wakeup_fd(writing, warn_on_full_buffer=False)
    for number in _HEARD:
        if signal.getsignal(number) is not signal.SIG_IGN:
            # The number is written to the pipe all the same.
            signal.signal(number, lambda *_: None)
    threading.Thread(target=_wait, args=(reading,), name="interruption", daemon=True).start()


def finish() -> None:
    """Heed no signal any more: all is done, and Python, while it ends, would forget what was agreed on."""
    for number in _HEARD:
        signal.signal(number, signal.SIG_IGN)


@contextmanager
def keeping(words: Callable[[], str]) -> Iterator[None]:
    """While something runs, tell what of it is kept if it is interrupted.

    Parameters
    ----------
    words : callable
        Returns it, as the beginning of a sentence; called from another thread.
    """
    _state.append(words)
    try:
        yield
    finally:
        _state.remove(words)


def farewell() -> str:
    """Last words of an interrupted run: what is kept, and the command that resumes it."""
    # To restart would throw away what is kept.
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
    # A bar of progress may stand in the line.
    start = "\n" if sys.stderr is not None and sys.stderr.isatty() else ""
    try:
        os.write(2, f"{start}{farewell()}\n".encode(errors="replace"))
    finally:
        os._exit(128 + number)
