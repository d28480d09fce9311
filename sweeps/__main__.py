"""`python -m sweeps` is the command `sweeps`."""

import gc
import os
import sys

from sweeps.text.interruption import finish, listen


def start() -> None:
    """Run the command line; signal handlers are set before the slow imports."""
    listen()
    # Nearly all objects live until the command ends: collect garbage less often.
    gc.set_threshold(50_000, 20, 20)
    # Variants already use all cores; NumPy's own threads gain nothing on small matrices and keep cores busy.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    from sweeps.cli import main

    try:
        try:
            main(prog_name="sweeps")
        finally:
            # Otherwise a full disk under standard output gives a traceback at exit.
            sys.stdout.flush()
    except BrokenPipeError:
        # The reader closed the pipe.
        _leave("", 1)
    except OSError as error:
        from sweeps.cli.shared import shown_message

        where = shown_message(str(error.filename or "standard output, or an unnamed file,"))
        _leave(f"Error: {where} can't be written or read: {error.strerror}\n", 2)
    finally:
        finish()
        # At exit Python looks for garbage among all objects, which takes a fifth of a second.
        gc.freeze()


def _leave(message: str, code: int) -> None:
    """Exit without flushing standard output again."""
    os.write(2, message.encode(errors="replace"))
    os._exit(code)


if __name__ == "__main__":
    start()
