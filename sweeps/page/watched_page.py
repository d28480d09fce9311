"""The page of a machine whose file is being edited, made again whenever the file is saved."""

import secrets
from collections.abc import Callable
from pathlib import Path
from threading import Condition
from typing import Any

from engine import Scene, UserError, warnings_in_words
from sweeps.page.machine_motion import BRIEF, looks, motion_data
from sweeps.page.page_text import page_text
from sweeps.pictures.drawing import DrawnMotion
from sweeps.text.input_files import Stamp, files_read


class WatchedPage:
    """The page of one machine, with its last drawable motion and the present mistakes in its text.

    Nothing is compiled for it: one machine is evaluated by NumPy.

    Parameters
    ----------
    file : str
        Its name, the heading as long as there is no machine.
    read : callable
        Reads the scene.

    Attributes
    ----------
    version : str
        Differs for each text.
    text : str
    message : str
        What is wrong, with file and line; "" if nothing is.
    """

    def __init__(self, file: str, read: Callable[[], Scene]) -> None:
        self._read = read
        self._changed, self._files = Condition(), dict[Path, Stamp | None]()
        self._file, self._parts = file, {"title": file}
        self.version = self.text = self.message = ""
        self._make()

    def look(self) -> bool:
        """Make the page again if a file has changed since it was read; return whether one has."""
        # Editors that replace a file remove it for a moment.
        found = {path: Stamp.of(path) or stamp for path, stamp in self._files.items()}
        if found == self._files:
            return False
        self._make()
        return True

    def wait(self, version: str, seconds: float) -> None:
        """Wait for another version, at most a number of seconds."""
        with self._changed:
            self._changed.wait_for(lambda: self.version != version, seconds)

    def page(self) -> tuple[str, str]:
        """Version and text."""
        with self._changed:
            return self.version, self.text

    def _make(self) -> None:
        with files_read() as self._files:
            try:
                self._parts, self.message = _parts(self._read(), self._file), ""
            except UserError as error:
                self.message = str(error)
        version = secrets.token_hex(8)
        now = {"version": version}
        if self.message:
            now |= {"message": self.message, "drawn": "The machine as it was before the mistake"}
        text = page_text(self._parts | now)
        with self._changed:
            self.version, self.text = version, text
            self._changed.notify_all()


def _parts(scene: Scene, file: str) -> dict[str, Any]:
    """Data for the template."""
    title = scene.title or Path(file).stem
    machine = {"number": 0, "name": title, **motion_data(DrawnMotion(scene), BRIEF)}
    # A walk over time is compiled, which takes seconds.
    regimes = f"The motion is that at constant speed. sweeps plot {file} draws the regimes: {', '.join(scene.regimes)}."
    return {
        "title": title,
        "remark": regimes if scene.regimes else "",
        "drawn": "The machine",
        "motion": {"looks": looks(), "machines": [machine]},
        "warnings": warnings_in_words(scene),
    }
