"""Progress on standard error: a bar on a terminal, else a line every 30 s."""

import shutil
import sys
import time

import click

LINE_EVERY = 30.0
BAR_WIDTH = 20


class ProgressBar:
    """Progress display.

    Parameters
    ----------
    total : int
        Total number.
    quiet : bool
        Show nothing.
    unit : str
        Counted items, in the plural.
    kept : int
        Number that an earlier run left in a file.
    """

    def __init__(self, total: int, quiet: bool, unit: str = "variants", kept: int = 0) -> None:
        self.total, self.quiet, self.unit = total, quiet, unit
        self.kept = kept
        # Unknown until earlier results are checked.
        self.done: int | None = None
        self.said = time.monotonic()
        self.first: tuple[int, float] | None = None
        self.is_drawn = False

    def update(self, done: int, before: int, words: str = "") -> None:
        """Show the number done, `before` of them in earlier runs, and a remark.

        The remaining time is estimated without the first part, which includes compilation.
        """
        self.done = done
        if self.quiet:
            return
        now = time.monotonic()
        if self.first is None and done > before:
            self.first = done, now
        text = f"{done} of {self.total} {self.unit}"
        is_timed = self.first is not None and done > self.first[0] and now > self.first[1]
        if is_timed:
            rate = (done - self.first[0]) / (now - self.first[1])
            text += f", {rate:.3g} per second, {(self.total - done) / rate:.0f} s left"
        text += f"; {words}" if words else ""
        if sys.stderr.isatty():
            self.is_drawn = True
            line = f"[{'#' * (BAR_WIDTH * done // self.total):{BAR_WIDTH}}] {text}"
            click.echo(f"\r\x1b[K{line[: shutil.get_terminal_size().columns - 1]}", nl=False, err=True)
        elif is_timed and now - self.said >= LINE_EVERY:
            self.said = now
            click.echo(text, err=True)

    def kept_text(self) -> str:
        """What is kept, as text.

        Earlier results stay in their file until they are checked and, for another study, copied.
        """
        if self.kept > (self.done or 0):
            done = f"{self.done} of {self.total} {self.unit} are done, and " if self.done else ""
            return f"{done}the {self.kept} of the earlier run are kept"
        if self.done is None:
            return "finished work is kept"
        return f"{self.done} of {self.total} {self.unit} are done and kept"

    def close(self) -> None:
        """End the bar's line."""
        self.done = self.total
        if self.is_drawn:
            click.echo(err=True)
