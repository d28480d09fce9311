"""Progress on standard error: a bar on a terminal, a plain line every 30 s elsewhere."""

import sys
import time

import click

LINE_EVERY = 30.0


class ProgressBar:
    """Progress of something that is counted.

    Parameters
    ----------
    total : int
        How many there will be.
    quiet : bool
        Say nothing.
    unit : str
        What is counted, in the plural.
    """

    def __init__(self, total: int, quiet: bool, unit: str = "variants") -> None:
        self.total, self.quiet, self.unit = total, quiet, unit
        self.bar = None
        # Unknown until an earlier result has been looked at.
        self.done: int | None = None
        self.said = time.monotonic()
        self.first: tuple[int, float] | None = None

    def update(self, done: int, before: int, words: str = "") -> None:
        """Tell how many are done, `before` of them in earlier runs, and words on what has been found.

        What is left is estimated from what follows the first part, before which machines are compiled.
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
            click.echo(f"{done} of {self.total} {self.unit}, {rate:.3g} a second, {left:.0f} s left{found}", err=True)

    def kept_text(self) -> str:
        """How many are done and kept."""
        if self.done is None:
            return "what was done is kept"
        return f"{self.done} of {self.total} {self.unit} are done and kept"

    def close(self) -> None:
        """End the bar: all is done."""
        self.done = self.total
        if self.bar is not None:
            self.bar.close()
