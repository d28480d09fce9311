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
        self.bar, self.done = None, 0
        self.started = self.said = time.monotonic()

    def update(self, done: int, before: int, words: str = "") -> None:
        """Tell how many are done, `before` of them in earlier runs, and words on what has been found."""
        self.done = done
        if self.quiet:
            return
        if not sys.stderr.isatty():
            self._line(done, before, words)
            return
        if self.bar is None:
            from tqdm import tqdm

            self.bar = tqdm(total=self.total, initial=before, unit=f" {self.unit}", unit_scale=True, file=sys.stderr)
        if words:
            self.bar.set_postfix_str(words, refresh=False)
        self.bar.update(done - self.bar.n)

    def _line(self, done: int, before: int, words: str) -> None:
        now = time.monotonic()
        if now - self.said >= LINE_EVERY and done > before:
            self.said = now
            rate = (done - before) / (now - self.started)
            left = (self.total - done) / rate
            found = f"; {words}" if words else ""
            click.echo(f"{done} of {self.total} {self.unit}, {rate:.3g} a second, {left:.0f} s left{found}", err=True)

    def kept_text(self) -> str:
        """How many are done and kept."""
        return f"{self.done} of {self.total} {self.unit} are done and kept"

    def close(self) -> None:
        """End the bar."""
        if self.bar is not None:
            self.bar.close()
