"""The guide as a site: built without a warning, whole, and without need of a network."""

import re
import subprocess
import sys

import pytest
from click.testing import CliRunner

import engine
import sweeps
from engine import Verdict, element_kinds
from sweeps.cli import main
from sweeps.guide.chapters import GENERATED, SUBJECTS
from sweeps.report.help.quantity_families import quantity_families


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The built site, and what the command prints. Sphinx reads 37 pages in some 8 s."""
    pytest.importorskip("furo", reason="pip install -e '.[guide]'")
    folder = tmp_path_factory.mktemp("guide")
    command = [sys.executable, "-m", "sweeps", "guide", "--out", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return folder, done.stdout + done.stderr


def test_site__is_built_without_a_warning(site):
    folder, printed = site
    assert printed == f"Wrote {folder / 'index.html'}\n"


def test_site__has_all_chapters_and_their_pictures(site):
    folder, _ = site
    pages = [folder / subject / f"{name}.html" for subject, names in SUBJECTS.items() for name in names]
    assert [page for page in pages if not page.exists()] == []
    assert (folder / "_images" / "machine.svg").exists()


def test_site__needs_no_network(site):
    folder, _ = site
    used = {
        found
        for page in folder.rglob("*.html")
        for found in re.findall(r"<(?:script|link|img)[^>]+(?:src|href)=\"(https?://[^\"]+)", page.read_text("utf8"))
    }
    assert used == set()


def test_reference__is_generated(site):
    folder, _ = site
    text = {page.stem: page.read_text("utf8") for page in (folder / "reference").glob("*.html")}
    assert set(text) == set(GENERATED)
    assert all(verdict.short.replace("'", "’") in text["verdicts"] for verdict in Verdict)
    assert "greater than 0" in text["keys"]
    assert "sweeps flywheel" in text["commands"]
    assert "1450 rpm" in text["units"]


def test_interface__has_every_public_name():
    page = CliRunner().invoke(main, ["guide", "interface"]).output
    assert [name for name in (*engine.__all__, *sweeps.__all__) if name not in page] == []
    assert "### Machine\n\n```text\nMachine(scene, summaries=(), fields=(), varied=()" in page
    assert "evaluate(varied" in page


def test_quantities__are_of_all_kinds_of_machines_and_name_none():
    """Reading all bundled scenes and making their registers takes some 6 s."""
    families = quantity_families()
    assert {f"Element {kind}" for kind in element_kinds()} <= {*families}
    found = {f"{owner} {family.name}" for owner, rows in families.items() for family in rows}
    assert {
        *("GROUP GROUP.transmission_angle", "LINK LINK.stroke", "Machine flywheel_wittenbauer", "PIN PIN.pressure"),
        *("REGIME REGIME.COUPLING_lock_up_time", "REGIME REGIME.COUPLING_slip", "STRUT STRUT.buckling_safety"),
        *("Element gear_train NAME.MESH.tangential_force", "Element torsional_train NAME.mode_N.MASS"),
    } <= found
    # Names of the templates' own parts.
    assert [name for name in found if set(re.split(r"[ ._]", name)) & {"rod", "piston", "rocker", "ram"}] == []


def test_missing_tool__is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "furo", None)
    result = CliRunner().invoke(main, ["guide", "--out", str(tmp_path)])
    assert result.exit_code == 2
    assert result.output == "Error: --web: the site needs furo: pip install 'machine-sweeps[guide]'\n"
