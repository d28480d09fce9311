"""The page that follows a file being edited: what it shows, when it changes, and what its server refuses."""

import contextlib
import http.client
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from commands import ROOT, refused
from test_page import BROWSER, QUIET, data_in, in_browser

from sweeps.cli.named_machine import machine_of
from sweeps.page import page_server
from sweeps.page.page_server import PageServer
from sweeps.page.watched_page import WatchedPage
from sweeps.text.templates import template_text

CRANK = 'length = "40 mm"'


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "press.toml"
    path.write_text(template_text("slider_crank"), encoding="utf8")
    return path


def watched(path: Path) -> WatchedPage:
    return WatchedPage(path.name, lambda: machine_of(str(path), None).scene)


@contextlib.contextmanager
def served(page: WatchedPage):
    with PageServer(page) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        try:
            yield server
        finally:
            server.shutdown()
            thread.join()


def asked(server: PageServer, method: str = "GET", path: str = "/", **headers: str) -> tuple[int, dict, str]:
    """Status, headers and text of an answer."""
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=30)
    connection.request(method, path, headers={name.replace("_", "-"): value for name, value in headers.items()})
    answer = connection.getresponse()
    found = answer.status, dict(answer.headers), answer.read().decode()
    connection.close()
    return found


def replaced(path: Path, old: str, new: str) -> None:
    """Save a file with another text, later than before."""
    text = path.read_text(encoding="utf8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf8")


def crank_of(text: str) -> float:
    """Length of the crank in the drawing of a page [m]: half the size of the path of A."""
    machine = data_in(text, "motion")["machines"][0]
    across = machine["points"]["A"][::2]
    return 0.5 * (max(across) - min(across)) * machine["unit"]


def test_page__shows_the_saved_machine(scene):
    page = watched(scene)
    assert not page.message
    assert crank_of(page.text) == pytest.approx(0.04, rel=1e-3)
    assert not page.look()
    first = page.version
    replaced(scene, CRANK, 'length = "50 mm"')
    assert page.look()
    assert page.version != first
    assert crank_of(page.text) == pytest.approx(0.05, rel=1e-3)


def test_page__with_a_mistake_keeps_the_machine_and_names_the_line(scene):
    page = watched(scene)
    replaced(scene, CRANK, 'lenght = "50 mm"')
    assert page.look()
    text = scene.read_text(encoding="utf8")
    line = text[: text.index("lenght")].count("\n") + 1
    # The words that `sweeps check` prints.
    assert page.message in refused("check", str(scene))
    assert f"press.toml, line {line}: input.lenght: unknown key" in page.message
    assert f"line {line}: input.lenght" in page.text
    assert "before the mistake" in page.text
    assert crank_of(page.text) == pytest.approx(0.04, rel=1e-3)
    replaced(scene, "lenght", "length")
    assert page.look()
    assert 'role="alert"' not in page.text


def test_page__of_a_file_that_was_never_right_shows_the_message_alone(scene):
    replaced(scene, "[input]", "[inputs")
    page = watched(scene)
    assert "line" in page.message
    assert "<h1>press.toml</h1>" in page.text
    assert 'id="motion"' not in page.text


def test_page__with_regimes_says_what_draws_them(tmp_path):
    path = tmp_path / "press.toml"
    path.write_text(template_text("press_with_motor"), encoding="utf8")
    assert "sweeps plot press.toml draws the regimes: start, work, stop." in watched(path).text


def test_page__follows_the_files_that_the_scene_names(tmp_path, scene):
    table = tmp_path / "punch.csv"
    table.write_text("over_stroke [mm],force [kN]\n120,0\n130,2\n200,1\n")
    replaced(
        scene, 'type = "constant"', 'type = "table"\nfile = "punch.csv"\nslider = "piston"\ninterpolation = "linear"'
    )
    for line in ('force = "2 kN"', 'acts = "against"'):
        replaced(scene, line, "")
    study = tmp_path / "study.toml"
    study.write_text('scene = "press.toml"\n[vary]\n"input.length" = ["30 mm", "40 mm"]\n')
    page = watched(study)
    assert not page.message
    first = page.text
    table.write_text("over_stroke [mm],force [kN]\n120,0\n130,4\n200,1\n")
    assert page.look()
    assert not page.message
    curves = [re.search(r'"curves":.*', text)[0] for text in (first, page.text)]
    assert curves[0] != curves[1]
    table.write_text("over_stroke [mm],force [kN]\n120,0\n130,x\n200,1\n")
    assert page.look()
    assert "punch.csv, line 3" in page.message


def test_page__survives_an_editor_that_replaces_the_file(scene):
    page = watched(scene)
    kept = scene.read_text(encoding="utf8")
    scene.unlink()
    assert not page.look()
    scene.write_text(kept.replace(CRANK, 'length = "45 mm"'), encoding="utf8")
    assert page.look()
    assert crank_of(page.text) == pytest.approx(0.045, rel=1e-3)


def test_server__serves_the_page_and_nothing_else(scene, monkeypatch):
    monkeypatch.setattr(page_server, "PATIENCE", 0.2)
    page = watched(scene)
    with served(page) as server:
        assert server.server_address[0] == "127.0.0.1"
        status, headers, text = asked(server)
        assert (status, text) == (200, page.text)
        assert headers["Cache-Control"] == "no-store"
        for path in ("/press.toml", "/../press.toml", "/?x=1", "/favicon.ico", str(scene)):
            assert asked(server, path=path)[0] == 404
        for method in ("POST", "PUT", "DELETE", "OPTIONS", "HEAD"):
            assert asked(server, method)[0] == 501
        assert asked(server, If_None_Match=headers["ETag"])[::2] == (304, "")


def test_server__refuses_names_of_foreign_sites(scene):
    with served(watched(scene)) as server:
        port = server.server_port
        for host in ("evil.example", f"evil.example:{port}", "127.0.0.1", f"127.0.0.1.evil.example:{port}", ""):
            status, _, text = asked(server, Host=host)
            assert (status, text) == (421, "")
        assert asked(server, Host=f"localhost:{port}")[0] == 200


def test_server__answers_a_waiting_browser_when_the_file_is_saved(scene):
    page = watched(scene)
    with served(page) as server:
        found = []
        first = asked(server)[1]["ETag"]
        waiting = threading.Thread(target=lambda: found.append(asked(server, If_None_Match=first)))
        waiting.start()
        waiting.join(0.3)
        assert waiting.is_alive()
        replaced(scene, CRANK, 'length = "50 mm"')
        assert page.look()
        waiting.join(10)
        ((status, headers, text),) = found
        assert (status, headers["ETag"] != first, crank_of(text)) == (200, True, pytest.approx(0.05, rel=1e-3))


def test_server__bears_a_browser_that_leaves_while_it_waits(scene, capsys):
    page = watched(scene)
    with served(page) as server:
        tag = asked(server)[1]["ETag"]
        connection = http.client.HTTPConnection("127.0.0.1", server.server_port)
        connection.request("GET", "/", headers={"If-None-Match": tag})
        connection.close()
        replaced(scene, CRANK, 'length = "50 mm"')
        page.look()
        assert asked(server)[1]["ETag"] != tag
    assert capsys.readouterr().err == ""


def test_command__follows_the_file_until_it_is_interrupted(scene):
    """It takes 6 s: a process starts, with all that draws a machine."""
    command = [sys.executable, "-m", "sweeps", "watch", str(scene)]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            port = int(re.search(r"http://127.0.0.1:(\d+)/ ", process.stdout.readline())[1])
            connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
            connection.request("GET", "/")
            tag = connection.getresponse().headers["ETag"]
            replaced(scene, CRANK, 'length = "40 mn"')
            connection.request("GET", "/", headers={"If-None-Match": tag})
            assert "unknown unit &#39;mn&#39;" in connection.getresponse().read().decode()
            assert "unknown unit 'mn'" in process.stderr.readline()
            process.send_signal(signal.SIGINT)
            said = process.stderr.read()
        finally:
            process.kill()
    assert process.returncode == 128 + signal.SIGINT
    assert said.startswith("Interrupted: the page isn't served any more")
    assert "Traceback" not in said


def test_command__takes_no_results_and_no_missing_files(tmp_path):
    assert "there is no such file" in refused("watch", str(tmp_path / "none.toml"))
    (tmp_path / "result.h5").write_bytes(b"\x89HDF\r\n\x1a\n")
    assert "sweeps report makes its page" in refused("watch", str(tmp_path / "result.h5"))


# In a browser

# It reports what the browser shows by asking the server for it.
REPORTS = """<script>
const said = encodeURIComponent(document.querySelector("[role=alert]")?.textContent ?? "");
const drawn = document.querySelectorAll("#machines circle").length;
setTimeout(() => fetch(`/seen-${said}-${drawn}-${location.hash.slice(1)}`), 300);
</script></body>"""


@in_browser
def test_browser__shows_the_mistake_and_the_machine_after_saving(scene, tmp_path, monkeypatch):
    """It takes 10 s: a browser starts, and shows three versions one after another."""
    seen = []
    page = watched(scene)
    plain = WatchedPage.page
    monkeypatch.setattr(WatchedPage, "page", lambda page: (page.version, plain(page)[1].replace("</body>", REPORTS)))

    def reported(pattern: str) -> str:
        end = time.monotonic() + 60
        while time.monotonic() < end:
            for path in seen:
                if re.search(pattern, path):
                    return path
            time.sleep(0.05)
        raise AssertionError(seen)

    with served(page) as server:

        class Noted(server.RequestHandlerClass):
            def log_message(self, *_):
                seen.append(self.path)

        server.RequestHandlerClass = Noted
        profile = f"--user-data-dir={tmp_path / 'profile'}"
        command = [BROWSER, *QUIET, profile, "--remote-debugging-port=0", f"{server.address}#at=90&paths=A"]
        browser = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            assert int(reported("^/seen--").split("-")[2]) > 2
            seen.clear()
            replaced(scene, CRANK, 'length = "40 mn"')
            assert page.look()
            found = reported("^/seen-press.toml")
            assert "mn" in found
            # The machine is still there, as the user has turned it.
            assert int(found.split("-")[-2]) > 2
            assert "at=90" in found
            seen.clear()
            replaced(scene, '"40 mn"', '"50 mm"')
            assert page.look()
            reported("^/seen--")
        finally:
            browser.terminate()
            browser.wait(30)
