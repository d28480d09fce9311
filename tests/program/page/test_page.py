"""The page of a result: what it tells is what the file holds, and it works in a browser without a network."""

import base64
import html
import json
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
import tracemalloc
from io import BytesIO
from pathlib import Path

import h5py
import numpy as np
import pytest
from commands import done, refused, said
from PIL import Image
from press_sweeps import ASKED, BEST, SCENE, run, text_of
from searches import TWO, searched

from engine import Verdict
from sweeps.optimising.optimum import front
from sweeps.page import digest as digest_module
from sweeps.page import page_text
from sweeps.page.digest import Digest
from sweeps.pictures.style import new_figure, save
from sweeps.report.recorded import result_file
from sweeps.report.sweep_result import SweepResult
from sweeps.store import FileLayout, Store

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
QUIET = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
)
LENGTHS = [f"{length} mm" for length in (20, 30, 40, 45, 50, 55, 60, 250)]
MASSES = ["50 kg", "100 kg", "150 kg"]
EVIL = "</script><script>document.title = 'taken'</script>"


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    """A grid of two numbers; the longest cranks can't be assembled."""
    head = "positions = 48\nrequire = [\"bodies.ram.mass < '140 kg'\"]\n"
    text = text_of(LENGTHS, MASSES, ASKED + BEST, head)
    return run(tmp_path_factory.mktemp("page"), text.replace("Which crank?", EVIL.replace("'", "\\u0027")))


@pytest.fixture(scope="module")
def page(result):
    done("report", str(result))
    return result.with_suffix(".html")


@pytest.mark.parametrize("library", ["markupsafe", "jinja2"])
def test_missing_extra__is_named_with_its_remedy(result, library, monkeypatch):
    page_text._template.cache_clear()
    monkeypatch.setitem(sys.modules, library, None)
    message = f"report: a page needs {library}: pip install 'machine-sweeps[report]'"
    assert message in refused("report", str(result), "--out", "unmade.html")


# What is found in the file


@pytest.mark.parametrize("at_a_time", [1, 7])
def test_digest__is_what_the_whole_file_says(result, at_a_time, monkeypatch):
    monkeypatch.setattr(result_file, "VARIANTS_AT_A_TIME", at_a_time)
    digest, whole = Digest(result), SweepResult(result)
    assert digest.best == whole.best()
    assert np.count_nonzero(digest.meets) == np.count_nonzero(whole.candidates())
    assert list(digest.leaders) == list(whole.select(whole.goal.where, "excess_work"))
    assert set(digest.shown) == set(np.flatnonzero(whole.columns["status"] == Verdict.OK))
    for name, column in whole.columns.items():
        assert digest.rows[name] == pytest.approx(column[digest.shown], nan_ok=True, rel=0, abs=0)


def test_digest__price_of_a_condition_is_the_best_without_it(result):
    digest, whole = Digest(result), SweepResult(result)
    (price,) = digest.prices
    assert price.text == whole.goal.condition
    assert price.without == whole.select(None, "excess_work")[0]
    stroke, limit = whole.columns["ram.stroke"][whole.best()], 0.08
    assert price.margin == pytest.approx((stroke - limit) / limit, rel=1e-9)


def test_digest__neighbours_are_a_step_of_the_grid_away(result):
    digest, whole = Digest(result), SweepResult(result)
    length, mass = whole.columns["input.length"], whole.columns["bodies.ram.mass"]
    by_name = {n.names[0]: n for n in digest.neighbours}
    here = digest.best
    for name, column, other in (("input.length", length, mass), ("bodies.ram.mass", mass, length)):
        places = np.unique(column)
        k = np.searchsorted(places, column[here])
        for beside, step in ((by_name[name].below, -1), (by_name[name].above, 1)):
            if not 0 <= k + step < places.size:
                assert beside is None
            else:
                assert (column[beside], other[beside]) == (places[k + step], other[here])


def test_digest__a_million_variants_take_the_memory_of_a_piece(tmp_path, result, monkeypatch):
    """Thirteen columns of 8 bytes are 104 MB; a piece of 200,000 numbers with what is made of it stays far below."""
    record = SweepResult(result).file
    count, rng = 1_000_000, np.random.default_rng(5)
    columns = tuple(column for column in record.described if column.dims == ("variant",))
    attributes = {k: v for k, v in record.attributes.items() if k not in ("Conventions", "finished", "outcome")}
    axis = {"kind": "Sampled", "names": ["input.length", "bodies.ram.mass"], "size": count}
    attributes["study_json"] = json.dumps(json.loads(attributes["study_json"]) | {"vary": [axis]})
    path = tmp_path / "many.h5"
    layout = FileLayout(count, count, columns, attributes)
    values = {c.name: rng.random(count) if c.dtype == np.float64 else np.zeros(count, c.dtype) for c in columns}
    values |= {name: np.zeros(count) for name in values if name.endswith("_error")}
    with Store.open(path, layout) as store:
        store.write(0, values)
        store.finish()
    least = np.where(values["ram.stroke"] > 0.08, values["excess_work"], np.inf)
    monkeypatch.setattr(result_file, "VARIANTS_AT_A_TIME", 15_000)
    tracemalloc.start()
    try:
        digest = Digest(path)
        assert digest.rows["status"].size == digest.shown.size
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 20e6
    assert list(digest.leaders) == list(np.argsort(least, kind="stable")[: digest_module.MOST_BEST])
    assert digest.shown.size <= digest_module.MOST_BEST + digest_module.MOST_SAMPLED


# The page


def text_without_scripts(page: Path) -> str:
    return re.sub(r"<script\b.*?</script>", "", page.read_text("utf8"), flags=re.S)


def test_page__tells_question_answer_and_provenance(page, result):
    text, whole = text_without_scripts(page), SweepResult(result)
    assert "How short?" in text
    assert f"variant {whole.best()}" in text
    assert whole.file.attributes["study_hash"] in text
    # The age of its numbers, as `sweeps show` gives it for the result.
    assert re.fullmatch(r"\d{4}-\d\d-\d\d \d\d:\d\d UTC", whole.finished)
    assert f"<td>{whole.finished}</td>" in text
    assert whole.finished in done("show", str(result))
    for words in ("What limits it", "Sensitivity", "Error estimates", "Verdicts", "be assembled"):
        assert words in text


def test_page__needs_nothing_from_elsewhere(page):
    text = text_without_scripts(page)
    # Names of XML's vocabularies are no addresses to load from.
    text = re.sub(r'xmlns(:\w+)?="[^"]*"', "", text)
    assert not re.findall(r"https?://[^\s<]*", re.sub(r"<pre>.*?</pre>", "", text, flags=re.S))
    assert "default-src 'none'" in text
    assert "unsafe-eval" not in text


def test_page__raster_pictures_have_a_palette(page):
    pictures = re.findall(r'data:image/png;base64,([^"]*)', page.read_text("utf8"))
    assert pictures
    for picture in pictures:
        with Image.open(BytesIO(base64.b64decode(picture))) as opened:
            assert opened.mode == "P"


def test_page__names_within_it_stand_once(page):
    ids = re.findall(r'\bid="([^"]+)"', text_without_scripts(page))
    assert len(ids) == len(set(ids)) > 10


def test_page__scene_is_computed_first(tmp_path, page, blank_pictures):
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE)
    done("report", str(scene))
    text = text_without_scripts(tmp_path / "scene.html")
    assert "Press with a rocker" in text
    assert "flywheel_wittenbauer" in text
    assert sorted(path.name for path in tmp_path.iterdir()) == ["scene.html", "scene.toml"]
    (tmp_path / "study.toml").write_text(text_of(LENGTHS, MASSES))
    assert "run it first" in refused("report", str(tmp_path / "study.toml"))


# The machine in motion, and the variants, as data


def data_in(text: str, name: str) -> dict:
    (found,) = re.findall(rf'<script type="application/json" id="{name}">(.*?)</script>', text)
    return json.loads(found)


def data_of(page: Path, name: str) -> dict:
    return data_in(page.read_text("utf8"), name)


def best_crank(result: Path) -> float:
    whole = SweepResult(result)
    return whole.columns["input.length"][whole.best()]


def test_page__curves_are_those_of_the_best_machine(page, result):
    """Of a centric slider-crank, the ram has the crankpin's speed a quarter turn after a dead centre."""
    first = data_of(page, "motion")["machines"][0]
    assert first["number"] == SweepResult(result).best()
    curves = {curve["y"]["label"]: curve["y"] for curve in first["curves"]}
    ram = next(curve for label, curve in curves.items() if "velocity" in label and "ram" in label)
    assert ram["unit"] == "m/s"
    quarter = (len(ram["values"]) - 1) // 4
    assert ram["values"][quarter] == pytest.approx(-2 * np.pi * best_crank(result), rel=1e-4)
    assert ram["values"][0] == pytest.approx(ram["values"][-1])


def test_page__breaks_long_names_over_narrow_columns(page):
    heads = re.findall(r"<th[^>]*>(.*?)</th>", page.read_text(encoding="utf8"))
    assert any("bodies.<wbr>" in head for head in heads)
    assert not any(re.search(r"[a-z][._](?!<wbr>)[a-z]", head) for head in heads)


def test_page__carries_machines_of_other_variants_in_the_order_of_merit(page, result):
    digest = Digest(result)
    numbers = [machine["number"] for machine in data_of(page, "motion")["machines"]]
    assert numbers[: digest.leaders.size] == digest.leaders.tolist()
    assert len(numbers) == len(set(numbers))


def test_page__carries_the_front_of_a_search(tmp_path, blank_pictures, monkeypatch):
    monkeypatch.setattr(digest_module, "MOST_BEST", 1)
    monkeypatch.setattr(digest_module, "MOST_SAMPLED", 5)
    found = searched(tmp_path, TWO.replace("population = 40", "population = 8").replace("= 40", "= 3"))
    done("report", str(found.path))
    page = found.path.with_suffix(".html")
    there = set(front(found).tolist())
    assert there <= set(data_of(page, "variants")["numbers"])
    assert there <= {machine["number"] for machine in data_of(page, "motion")["machines"]}
    words = page.read_text("utf8")
    assert "the front, and a random sample" in words
    assert "meet the condition" not in words


def test_page__variants_have_every_number(page, result):
    data, whole = data_of(page, "variants"), SweepResult(result)
    columns = {column["name"]: column for column in data["columns"]}
    assert set(columns) == {*whole.parameters, *whole.summaries}
    for name in whole.parameters:
        assert columns[name]["exact"] == whole.columns[name][data["numbers"]].tolist()
    assert data["numbers"][data["best"]] == whole.best()


def test_page__a_thousand_variants_stay_below_two_megabytes(tmp_path):
    """It takes 9 s: a thousand variants are computed, and many of their machines drawn at sixty positions."""
    lengths = [f"{20 + 0.3 * k:.1f} mm" for k in range(100)]
    path = run(tmp_path, text_of(lengths, [f"{mass} kg" for mass in range(10, 110, 10)]))
    done("report", str(path))
    page = path.with_suffix(".html")
    assert len(data_of(page, "variants")["numbers"]) == 1000
    assert page.stat().st_size < 2e6


# In a browser


def browsed(page: Path, folder: Path, script: str, link: str = "") -> tuple[dict, str]:
    """What a script notes of a page opened by a link, and the page's text after it."""
    help_of = "const $ = (id) => document.getElementById(id), noted = {};"
    told = 'setTimeout(() => document.body.setAttribute("data-noted", JSON.stringify(noted)), 3000);'
    opened = folder / "opened.html"
    text = page.read_text("utf8").replace("</body>", f"<script>{help_of}{script}{told}</script></body>")
    opened.write_text(text, "utf8")
    profile = f"--user-data-dir={folder / 'profile'}"
    command = [BROWSER, *QUIET, profile, "--virtual-time-budget=8000", "--dump-dom", f"{opened.as_uri()}{link}"]
    dom = subprocess.run(command, capture_output=True, text=True, timeout=120).stdout
    return json.loads(html.unescape(re.search(r'data-noted="([^"]*)"', dom)[1])), dom


in_browser = pytest.mark.skipif(BROWSER is None, reason="no browser of the Chromium family")

TURNED = """
const centres = () => [...document.querySelectorAll("#machines circle")].map((circle) => {
  const box = circle.getBoundingClientRect();
  return [box.x + box.width / 2, box.y + box.height / 2];
});
const to = (angle) => { $("position").value = angle; $("position").dispatchEvent(new Event("input")); };
to(0); noted.start = centres();
to(90); noted.quarter = centres(); noted.words = $("position").getAttribute("aria-valuetext");
noted.captions = [...document.querySelectorAll("figcaption")].map((caption) => caption.textContent);
"""


@in_browser
def test_page__slider_turns_the_crank_and_moves_the_marks(page, result, tmp_path):
    noted, dom = browsed(page, tmp_path, TURNED)
    start, quarter = (np.array([complex(x, -y) for x, y in noted[key]]) for key in ("start", "quarter"))
    still = start[np.abs(start - quarter) < 1e-3]
    pivot, stand = still[np.argmin(still.real)], still[np.argmax(still.real)]
    scale = (stand - pivot).real / 0.26
    crankpin = pivot + 1j * scale * best_crank(result)
    assert np.abs(quarter - crankpin).min() < 0.5
    assert "90" in noted["words"]
    (speed,) = re.findall(r"velocity of slider ram: \N{MINUS SIGN}([\d.]+) m/s", "\n".join(noted["captions"]))
    assert float(speed) == pytest.approx(2 * np.pi * best_crank(result), rel=1e-3)
    assert re.search(r"<title>(.*?)</title>", dom, re.S)[1].startswith("&lt;/script&gt;")


PLAYED = """
// Frames every 20 ms; a browser without a screen draws few.
let clock = 0;
window.requestAnimationFrame = (draw) => setTimeout(() => draw(clock += 20), 20);
const at = () => Number($("position").value);
$("play").click(); noted.word = $("play").textContent;
setTimeout(() => { noted.later = at(); $("play").click(); noted.paused = at(); }, 1000);
setTimeout(() => { noted.still = at(); noted.link = location.hash; }, 2000);
"""


@in_browser
def test_page__plays_and_pauses(page, tmp_path):
    noted, _ = browsed(page, tmp_path, PLAYED, "#at=30&pace=4")
    assert noted["word"] == "Pause"
    # A quarter of a cycle in a second.
    assert noted["later"] == pytest.approx(120, abs=15)
    assert noted["still"] == noted["paused"]
    assert float(re.search(r"at=([\d.]+)", noted["link"])[1]) == pytest.approx(noted["paused"], abs=1)
    assert "play" not in noted["link"]


PICKED = """
const data = page.data("variants"), scatter = $("scatter");
navigator.clipboard.writeText = (text) => { noted.copied = [...(noted.copied ?? []), text]; return Promise.resolve(); };
const row = (k) => [...$("compared").tBodies[0].rows[k].cells].map((cell) => cell.textContent);
scatter.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight" }));
noted.link = location.hash; noted.row = row(0);
noted.machines = [...document.querySelectorAll("h3")].map((h) => h.textContent);
noted.widths = [...document.querySelectorAll(".drawing")].map((svg) => svg.viewBox.baseVal.width);
$("copy").click(); $("copy-command").click();
scatter.dispatchEvent(new KeyboardEvent("keydown", { key: "Escape" })); noted.none = location.hash;
const box = scatter.getBoundingClientRect();
const touch = (kind, x, y) => scatter.dispatchEvent(new PointerEvent(kind, {
  pointerId: 1, bubbles: true, clientX: box.x + x, clientY: box.y + y,
}));
touch("pointerdown", 100, 50); touch("pointermove", 500, 380); touch("pointerup", 500, 380);
noted.selected = $("selected").textContent; noted.ranges = location.hash;
$("clear").click(); noted.cleared = $("selected").textContent;
// One of the clicks all over the scatter hits a dot.
const click = (x, y) => { touch("pointerdown", x, y); touch("pointerup", x, y); };
for (let x = 60; x < 700; x += 8) for (let y = 20; y < 360; y += 8) if (!location.hash.includes("variant")) click(x, y);
noted.clicked = location.hash;
"""


@in_browser
def test_page__a_picked_variant_is_shown_beside_the_best_and_copied(page, result, tmp_path):
    noted, _ = browsed(page, tmp_path, PICKED)
    whole, data = SweepResult(result), data_of(page, "variants")
    number = int(re.search(r"variant=(\d+)", noted["link"])[1])
    assert number != whole.best()
    name, scale = data["columns"][0]["name"], 1e3
    best, picked = (whole.columns[name][variant] * scale for variant in (whole.best(), number))
    assert noted["row"][1:3] == [f"{best:g}", f"{picked:g}"]
    assert noted["machines"] == [f"Variant {whole.best()}", f"Variant {number}"]
    units = {machine["number"]: machine["unit"] for machine in data_of(page, "motion")["machines"]}
    widths = [width * units[variant] for width, variant in zip(noted["widths"], (whole.best(), number), strict=True)]
    assert widths[0] == pytest.approx(widths[1])
    text, command = noted["copied"]
    length, mass = tomllib.loads(text)["input"]["length"], tomllib.loads(text)["bodies"]["ram"]["mass"]
    assert (length, mass) == (f"{picked / scale} m", f"{whole.columns['bodies.ram.mass'][number]:.0f} kg")
    program, *words = shlex.split(command)
    scene = tmp_path / words[-1]
    done(*(str(result) if word == result.name else str(scene) if word == scene.name else word for word in words))
    assert program == "sweeps"
    assert tomllib.loads(scene.read_text())["input"]["length"] == f"{picked:g} mm"
    assert "variant" not in noted["none"]
    assert noted["selected"].endswith("shown variants selected")
    assert "ranges=" in noted["ranges"]
    assert noted["cleared"] == ""
    assert "variant=" in noted["clicked"]


STATE = """
noted.paths = document.querySelectorAll(".path").length; noted.place = $("place").textContent;
noted.machines = [...document.querySelectorAll("h3")].map((h) => h.textContent);
noted.least = $("compared").tBodies[0].rows[0].querySelector("input").value;
noted.unnamed = [...document.querySelectorAll("button, select, input")].filter(
  (one) => !one.textContent.trim() && !one.labels.length && !one.getAttribute("aria-label")).length;
noted.pictures = [...document.querySelectorAll("[role=img]")].filter((one) => !one.getAttribute("aria-label")).length;
"""


@in_browser
def test_page__a_link_holds_its_state_and_everything_has_a_name(page, result, tmp_path):
    number = int(Digest(result).leaders[1])
    noted, _ = browsed(page, tmp_path, STATE, f"#at=120&paths=B,C&variant={number}&ranges=0_35_50")
    assert noted["place"] == "crank angle φ 120 °"
    # Of both machines.
    assert noted["paths"] == 4
    assert noted["machines"][1] == f"Variant {number}"
    assert noted["least"] == "35"
    assert (noted["unnamed"], noted["pictures"]) == (0, 0)


# Texts of a file that anyone may have written

ACTING = "\x1b]0;taken\x07 \u202egnp.exe\u202c \u2066 \u200f \x9b31m \u2028 \x7f $\\foo{$"
ACTS = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")


UNTOUCHED = ("dims", "dtype", "units", "name", "scene", "where", "require")


def planted(data: object) -> object:
    """Data with acting characters at the end of every text that isn't a name."""
    if isinstance(data, dict):
        return {k: v if k in UNTOUCHED else planted(v) for k, v in data.items()}
    if isinstance(data, list):
        return data
    return data + ACTING if isinstance(data, str) and " " in data else data


def test_acting_characters_of_a_foreign_result__are_spelled_out(result, folder):
    path = Path(f"foreign{ACTING.replace('/', '')}.h5")
    shutil.copyfile(result, path)
    with h5py.File(path, "r+") as file:
        for name in ("title", "question", "study", "scene_text", "versions", "machine", "study_json"):
            text = file.attrs[name]
            file.attrs[name] = json.dumps(planted(json.loads(text))) if name == "study_json" else f"{text}\n#{ACTING}"
        file.attrs["scene"] = file.attrs["scene"].replace("Press with a rocker", f"Press{json.dumps(ACTING)[1:-1]}")
        progress = file["progress"]
        progress.attrs["layout"] = json.dumps(planted(json.loads(progress.attrs["layout"])))
        del progress.attrs["text_checksums"]
    name = str(path)
    assert json.loads(said("show", name, "--json").stdout)
    commands = [
        ("show", name),
        ("show", name, "--json"),
        ("report", name, "--out", "page.html"),
        ("plot", name, "--out", "plot.svg"),
        ("plot", name, "--variant", "0", "--out", "machine.svg"),
        ("export", name, "--variant", "0", "--to", "drawing.svg"),
        ("export", name, "--variant", "0", "--to", "drawing.dxf"),
    ]
    for command in commands:
        answer = said(*command)
        assert answer.exit_code == 0, answer.output
        assert not ACTS.search(answer.output), command
    made = [file for file in folder.iterdir() if file.suffix in (".html", ".svg", ".dxf")]
    assert len(made) >= 5
    for file in made:
        text = file.read_text("utf8").replace("\r\n", "\n")
        text = re.sub(r"<script>.*?</script>", "", text, flags=re.S) if file.suffix == ".html" else text
        assert not (found := ACTS.search(text)), (file.name, text[max(found.start() - 60, 0) : found.end() + 20])
    assert "\\u202egnp.exe" in Path("page.html").read_text("utf8")
    columns = data_of(Path("page.html"), "variants")["columns"]
    texts = [text for column in columns for text in (column["name"], column["label"], *column["lines"])]
    texts += [machine["name"] for machine in data_of(Path("page.html"), "motion")["machines"]]
    assert any("gnp.exe" in text for text in texts)
    assert not any(ACTS.search(text) for text in texts)


def test_acting_characters_in_every_text_of_a_figure__are_spelled_out(tmp_path):
    """Texts at ticks too, which Matplotlib makes anew while it draws."""
    figure = new_figure(600, 600)
    axes = figure.add_subplot(title=ACTING, xlabel=ACTING, ylabel=f"$M_{{in}}$ {ACTING}")
    axes.plot([0, 1], label=ACTING)
    axes.set_xticks([0, 1], labels=[ACTING, "$M_{in}$"])
    axes.text(0.5, 0.5, ACTING, wrap=True)
    axes.legend(title=ACTING)
    figure.suptitle(ACTING)
    save(figure, tmp_path / "all.svg")
    text = (tmp_path / "all.svg").read_text("utf8")
    assert not ACTS.search(text)
    assert text.count("gnp.exe") >= 8
