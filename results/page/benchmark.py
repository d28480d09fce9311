"""Sizes of pages, and the time from saving a scene to its new picture in a browser; writes page.md beside itself."""

import os
import shutil
import statistics
import subprocess
import tempfile
import threading
import time
from contextlib import chdir
from pathlib import Path
from typing import NamedTuple

from sweeps.cli import main
from sweeps.cli.named_machine import machine_of
from sweeps.cli.shared import foreseen_errors
from sweeps.page.page_server import PageServer
from sweeps.page.watched_page import WatchedPage
from sweeps.study.bundled import find_study
from sweeps.text.templates import template_text

HERE = Path(__file__).parent
BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
OPTIONS = ("--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--remote-debugging-port=0")
SAVES, LOOK = 9, 0.05
STUDY = """scene = "slider_crank.toml"
[vary]
"input.length" = "30 mm to 60 mm, 40"
"bodies.piston_body.mass" = "1 kg to 3 kg, 25"
[best]
minimise = "wheel_mass"
"""
# Asks for an address that isn't there when a version is painted.
PAINTED = """<script>requestAnimationFrame(() => requestAnimationFrame(
  () => fetch(`/painted-${document.body.dataset.version}`)));</script></body>"""
HEAD = """# Pages

Made by `python results/page/benchmark.py`: {cores} cores, shared with others (load {load:.1f} when this was begun).

## Sizes

| page | variants | MB |
|---|---|---|
"""
SAVED = """
## From saving to the new picture

`sweeps watch` looks at the file every {look:.0f} ms. Medians of {saves} savings in ms, with the slowest: processor time
from the look that finds the file changed to the page as text; wall time from saving to the same, half a look included;
and wall time to the picture that the browser has painted.

| machine | processor | text | painted |
|---|---|---|---|
"""
TAIL = """
Nothing is compiled. What bounds it is the drawing at 60 positions, in Python; then the browser, which loads the page
again. On a processor of its own a machine takes the processor's time, half a look, and the browser's time.
"""


class Saved(NamedTuple):
    """Times of a saving [s]: of the processor to the page, to the page, to the picture."""

    processor: float
    text: float
    painted: float


class Reporting(WatchedPage):
    """A page that reports when it is painted."""

    def page(self) -> tuple[str, str]:
        """Version and text, with a script."""
        version, text = super().page()
        return version, text.replace("</body>", PAINTED)


def sizes(folder: Path) -> list[str]:
    """Rows of pages and their sizes."""
    (folder / "slider_crank.toml").write_text(template_text("slider_crank"), encoding="utf8")
    (folder / "many.toml").write_text(STUDY, encoding="utf8")
    with chdir(folder):
        main(["report", "slider_crank.toml"], standalone_mode=False)
        main(["run", "many.toml", "--no-plots", "--quiet"], standalone_mode=False)
        main(["report", "results/many.h5"], standalone_mode=False)
    watched = len(WatchedPage("", lambda: machine_of(str(folder / "slider_crank.toml"), None), foreseen_errors()).text)
    rows = [
        ("`sweeps report` of a scene", 1, (folder / "slider_crank.html").stat().st_size),
        ("`sweeps report` of a result", 1000, (folder / "results" / "many.html").stat().st_size),
        ("`sweeps watch` of a scene", 1, watched),
    ]
    return [f"| {words} | {count} | {size / 1e6:.2f} |" for words, count, size in rows]


def savings(scene: Path, folder: Path) -> list[Saved]:
    """Save a scene several times with a browser open."""
    page = Reporting(scene.name, lambda: machine_of(str(scene), None), foreseen_errors())
    painted: dict[str, float] = {}
    found = []
    with PageServer(page) as server:

        class Noted(server.RequestHandlerClass):
            def log_message(self, *_: object) -> None:
                painted[self.path.rpartition("painted-")[2]] = time.perf_counter()

        server.RequestHandlerClass = Noted
        threading.Thread(target=server.serve_forever, daemon=True).start()
        profile = f"--user-data-dir={folder / 'profile'}"
        browser = subprocess.Popen([BROWSER, *OPTIONS, profile, server.address], stderr=subprocess.DEVNULL)
        try:
            await_version(painted, page.version)
            for _ in range(SAVES):
                time.sleep(0.5)
                scene.write_text(scene.read_text("utf8") + "\n", encoding="utf8")
                saved = time.perf_counter()
                time.sleep(LOOK / 2)
                begun = time.process_time()
                page.look()
                processor, text = time.process_time() - begun, time.perf_counter() - saved
                found.append(Saved(processor, text, await_version(painted, page.version) - saved))
        finally:
            browser.terminate()
            browser.wait()
            server.shutdown()
    return found


def await_version(painted: dict[str, float], version: str) -> float:
    """When a version was painted."""
    while version not in painted:
        time.sleep(0.002)
    return painted[version]


def row(name: str, found: list[Saved]) -> str:
    cells = (f"{1e3 * statistics.median(times):.0f} ({1e3 * max(times):.0f})" for times in zip(*found, strict=True))
    return f"| {name} | {' | '.join(cells)} |"


if __name__ == "__main__":
    text = HEAD.format(cores=os.cpu_count(), load=os.getloadavg()[0])
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        text += "\n".join(sizes(folder)) + "\n" + SAVED.format(look=1e3 * LOOK, saves=SAVES)
        for machine in ("slider_crank", "crank_press", "shaper", "watt_six_bar"):
            scene = folder / f"watched_{machine}.toml"
            try:
                scene.write_text(template_text(machine), encoding="utf8")
            except ValueError:
                path = find_study(machine).parent / "scenes" / f"{machine}.toml"
                tables = str(path.parents[2] / "tables")
                scene.write_text(path.read_text("utf8").replace("../../tables", tables), encoding="utf8")
            text += row(machine.replace("_", " "), savings(scene, folder)) + "\n"
    (HERE / "page.md").write_text(text + TAIL, encoding="utf8")
    print(text)
