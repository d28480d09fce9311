"""`python -m sweeps` is the command `sweeps`."""

import os
import sys

from sweeps.text.interruption import finish, listen


def start() -> None:
    """Run the command line; signals are heard before anything that takes long is loaded."""
    listen()
    from sweeps.cli import main

    try:
        try:
            main(prog_name="sweeps")
        finally:
            # Otherwise a full disk under standard output shows when Python has ended, as a traceback.
            sys.stdout.flush()
    except BrokenPipeError:
        # Whoever read has seen enough.
        _leave("", 1)
    except OSError as error:
        from sweeps.cli.shared import shown_message

        where = shown_message(str(error.filename or "what is shown, or a file that nothing names,"))
        _leave(f"Error: {where} can't be written or read: {error.strerror}\n", 2)
    finally:
        finish()


def _leave(message: str, code: int) -> None:
    """End without another attempt to write what standard output didn't take."""
    os.write(2, message.encode(errors="replace"))
    os._exit(code)


if __name__ == "__main__":
    start()
