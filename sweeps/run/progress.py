"""Progress on standard error: a bar on a terminal, else a line every 30 s."""

import sys
import time

import click

LINE_EVERY = 30.0


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
        self.bar = None
        # Unknown until earlier results are checked.
        self.done: int | None = None
        self.said = time.monotonic()
        self.first: tuple[int, float] | None = None

    def update(self, done: int, before: int, words: str = "") -> None:
        """Show the number done, `before` of them in earlier runs, and a remark.

        The remaining time is estimated without the first part, which includes compilation.
        """
        self.done = done
        if self.quiet:
            return
        is_first = self.first is None and done > before
        if is_first:
            self.first = done, time.monotonic()
        if not sys.stderr.isatty():
            self._line(done, words)
            return
        if self.bar is None:
            from tqdm import tqdm

            self.bar = tqdm(total=self.total, initial=before, unit=f" {self.unit}", unit_scale=True, file=sys.stderr)
        if words:
            self.bar.set_postfix_str(words, refresh=False)
        if is_first:
            self.bar.reset()
            self.bar.initial = self.bar.n = self.bar.last_print_n = done
            self.bar.refresh()
        self.bar.update(done - self.bar.n)

    def _line(self, done: int, words: str) -> None:
        now = time.monotonic()
        if now - self.said >= LINE_EVERY and self.first and done > self.first[0] and now > self.first[1]:
            self.said = now
            rate = (done - self.first[0]) / (now - self.first[1])
            left = (self.total - done) / rate
            found = f"; {words}" if words else ""
            click.echo(f"{done} of {self.total} {self.unit}, {rate:.3g} per second, {left:.0f} s left{found}", err=True)

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
        """Close the bar."""
        self.done = self.total
        if self.bar is not None:
            self.bar.close()
