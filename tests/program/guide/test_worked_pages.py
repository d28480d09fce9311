"""The guide's worked pages: commands print what is shown, calculations by hand are right, pictures are there."""

import math
import re
from pathlib import Path

import pint
import pytest
from commands import leave_pictures_blank
from worked_pages import GUIDE, PICTURES, TUTORIAL, append, folder_for, matches, other_pages, pictures, run_page, small

PAGES = sorted(GUIDE.rglob("*.md"))
UNITS = "mm|cm|m|kg|g|N|kN|J|kJ|W|kW|rpm|s|min|L|bar|Pa|kPa|MPa|GPa|rad|°|Hz"
MEASURED = re.compile(rf"(\d+(?:\.\d+)?)((?:[ ·/](?:{UNITS})(?![A-Za-z])[²³]?|[ ]?°)+)")
SIGNS = {
    "·": "*",
    "²": "**2",
    "³": "**3",
    "⁴": "**4",
    "^": "**",
    "½": "0.5",
    "¼": "0.25",
    "−": "-",
    "√": "sqrt",
    "π": "pi",
    "°": "deg",
}
KNOWN = {name: getattr(math, name) for name in ("sin", "cos", "tan", "asin", "pi")} | {"sqrt": lambda x: x**0.5}


def value(text):
    """What a side of a calculation is worth; None if it holds symbols."""
    units = pint.get_application_registry()

    def measured(found):
        name = re.sub(r"^\*", "", found[2].strip().replace(" ", "*").replace("·", "*").replace("°", "deg"))
        return f"q({found[1]}, {name.replace('²', '**2').replace('³', '**3')!r})"

    code = MEASURED.sub(measured, text)
    for sign, meant in SIGNS.items():
        code = code.replace(sign, meant)
    names = set(re.findall(r"[^\W\d]\w*", re.sub("'.*?'", "", code)))
    if names - {"q", *KNOWN}:
        return None
    found = eval(code, {"q": lambda number, unit: number * units(unit), **KNOWN})
    return found if isinstance(found, units.Quantity) else units.Quantity(found)


def last_digit(text):
    decimals = re.match(r"\s*[-−]?\d+(?:\.(\d+))?", text)[1]
    return 10.0 ** -len(decimals or "")


def calculations(text):
    return [line for body in re.findall(r"```calculation\n(.*?)```", text, re.S) for line in body.splitlines()]


def wrong(line):
    """Sides of a calculation that differ from its result by more than a unit of the last digit."""
    sides = re.split("[=≈]", line)
    result = value(sides[-1])
    assert result is not None, line
    found = {side: value(side) for side in sides[:-1] if re.search(r"\d", side)}
    checked = {side: worth for side, worth in found.items() if worth is not None}
    assert checked, line
    return [s for s, w in checked.items() if abs((w - result).to(result.units).magnitude) > last_digit(sides[-1])]


def test_calculations__are_right():
    lines = [line for page in PAGES for line in calculations(page.read_text("utf8"))]
    assert len(lines) > 100
    assert {line: found for line in lines if (found := wrong(line))} == {}


def test_calculation__is_checked():
    assert wrong("v = r ω = 50 mm · 300 rpm = 1.571 m/s") == []
    assert wrong("v = r ω = 50 mm · 300 rpm = 1.573 m/s") == [" 50 mm · 300 rpm "]
    assert wrong("½ · 2 kg · (3 m/s)² / (4 N·m) = 2.25") == []
    assert wrong("cos(60°) + √(0.25) = 1.0") == []
    assert wrong("2 J - 3 J = -1.0 J") == []


@pytest.fixture(scope="module", autouse=True)
def blank_pictures():
    """Files of pictures without what is drawn, which takes a fifth of the time."""
    with pytest.MonkeyPatch.context() as patch:
        leave_pictures_blank(patch)
        yield


@pytest.fixture(scope="module")
def tutorial(tmp_path_factory):
    """Differences on each page of the tutorial, run in one folder like a reader's."""
    folder = tmp_path_factory.mktemp("tutorial")
    return {page: run_page(page, folder) for page in TUTORIAL}, folder


@pytest.mark.parametrize("page", TUTORIAL, ids=lambda page: page.stem)
def test_tutorial__shows_what_is_printed(page, tutorial):
    differences, folder = tutorial
    assert differences[page] == []
    assert [name for name in pictures(page) if not (folder / Path(name).name).exists()] == []


@pytest.mark.parametrize("page", other_pages(), ids=lambda page: page.stem)
def test_page__shows_what_is_printed(page, tmp_path):
    folder = folder_for(page, tmp_path)
    assert run_page(page, folder) == []
    there = {name for name in pictures(page) if (folder / Path(name).name).exists() or (PICTURES / name).exists()}
    assert set(pictures(page)) == there


def test_pictures__are_those_of_the_pages_and_small():
    shown = {name for page in PAGES for name in pictures(page)}
    sizes = {path.relative_to(PICTURES).as_posix(): path.stat().st_size for path in PICTURES.rglob("*.svg")}
    assert set(sizes) == shown
    assert sum(sizes.values()) < 1.7e6


def test_small__rounds_places_only():
    svg = '<metadata>\n x\n</metadata>\n<path d="M 1.23456 -0.001" style="stroke-width: 0.625"/><text>0.0065</text>'
    assert small(svg) == '<path d="M 1.23 -0" style="stroke-width: 0.625"/><text>0.0065</text>'


def test_dots__stand_for_lines_and_text():
    real = "one\ntwo 2.5 s\nthree\n"
    assert matches("one\n…\nthree\n", real)
    assert matches("…\ntwo … s\n…\n", real)
    assert not matches("one\nthree\n", real)
    assert not matches("…\ntwo\n…\n", real)


def test_block__takes_the_place_of_tables_given_again(tmp_path):
    path = tmp_path / "scene.toml"
    append(path, "[a]\nx = 1\n[b]\ny = 1\n")
    append(path, "[a]\nx = 2\n")
    assert path.read_text("utf8") == "[b]\ny = 1\n\n[a]\nx = 2\n"
