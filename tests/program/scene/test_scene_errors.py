"""Scenes that are refused: the message names the file, the line, the key, what is allowed and the mend."""

import json
import random
import shutil
from collections.abc import Iterable
from pathlib import Path

import pytest
from commands import ROOT, ran
from each_case import each
from scene_samples import FROM_CSV, GOOD, PUNCH, line_with, refused
from slips import cases, changed

from engine.parts.skeleton import Part, Refers, field_marks
from engine.scene.names import DEFINED, FITTING
from sweeps import InputError, read_scene


def test_several_problems__are_told_at_once(tmp_path):
    text = GOOD
    for old, new in (('"50 mm"', '"50 kg"'), ('"100 kg"', "100"), ('"linear"', '"cubic"'), ('"2 N m"', '"2"')):
        text = changed(text, old, new)
    error = refused(tmp_path, text)
    keys = {"input.length", "bodies.ram.mass", "forces.punch.interpolation", "moments.friction.moment"}
    assert {key for _, key, _ in error.problems} == keys
    assert str(error).count("press.toml, line ") == 4


def test_kinds_of_references__all_have_words():
    parts = [Part]
    for part in parts:
        parts += part.__subclasses__()
    fields = [field for part in parts for field in part.model_fields.values()]
    asked = {mark.kind for field in fields for mark in field_marks(field) if isinstance(mark, Refers)}
    assert asked == {*DEFINED, *FITTING}


TIMES = 100


def test_garbled_texts__are_read_or_refused_in_words(folder, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "results" / "reliability"))
    from mutations import STOCK, texts

    for part in ("studies", "templates"):
        shutil.copytree(STOCK / part, folder / part)
    ways = {}
    for i in range(TIMES):
        dice = random.Random(f"quick {i}")
        texts(dice, folder, False, lambda how, text, took: ways.setdefault(how, []).append(text))
    assert set(ways) == {"results", "refused"}, {how: found[0] for how, found in ways.items()}
    assert sum(map(len, ways.values())) == TIMES
    assert any("carried_out" in text for found in ways.values() for text in found)


# CSV tables beside scenes, and texts that are none


# Name | text of the file | words of the message.
TABLES = cases(r"""
unknown column | stroke [mm],force [kN]\n0,0\n1,1\n | unknown key | did you mean 'over_stroke'?
column without unit | over_stroke [mm],force\n0,0\n1,1\n | has no unit | "1 kN"
unit in a cell | over_stroke [mm],force [kN]\n0,0\n1,1 mm\n | punch.csv, line 3: column force: expected a force | 'mm'
unit in no cell | over_stroke [mm],force\n0,0 kN\n1,1\n | punch.csv, line 3: column force: 1 has no unit: write "1 kN"
not finite | over_stroke [mm],force [kN]\n0,0\ninf,1\n | a length | inf
""")


@each("case", TABLES)
def test_bad_csv_table__is_refused_and_named(case, tmp_path):
    content, *words = TABLES[case]
    check_table(tmp_path, content.encode(), words)


@each(
    "content, words",
    [
        (None, ("punch.csv", "there is no such file")),
        (b"", ("header line",)),
        (bytes(range(256)), ("punch.csv", "not UTF-8")),
        (b"over_stroke [mm],force [kN]\n0,0\n\x001,1\n", ("line 3", "is not a number")),
        (b"over_stroke [mm],force [kN]\n0,0\n1," + b"1" * 200_000, ("punch.csv",)),
    ],
)
def test_csv_file_that_is_none__is_refused_and_named(content, words, tmp_path):
    check_table(tmp_path, content, words)


def check_table(folder: Path, content: bytes | None, words: Iterable[str]) -> None:
    if content is not None:
        (folder / "punch.csv").write_bytes(content)
    error = refused(folder, FROM_CSV)
    table, key = line_with(FROM_CSV, "[forces.punch]"), line_with(FROM_CSV, "file =")
    assert {line for line, _, _ in error.problems} <= {table, key}
    assert all(path.startswith("forces.punch") for _, path, _ in error.problems)
    for word in words:
        assert word in str(error), str(error)


@each("name", ['"."', '"\\u0000"', '"' + "x" * 5000 + '"', "3", "[1]", "{}"])
def test_odd_name_of_a_csv_file__is_refused_with_its_line(name, tmp_path):
    text = changed(FROM_CSV, '"punch.csv"', name)
    error = refused(tmp_path, text)
    assert error.problems[0][:2] == (line_with(text, "file ="), "forces.punch.file")


def test_csv_and_columns_in_the_text__are_refused_together(tmp_path):
    (tmp_path / "punch.csv").write_text(PUNCH)
    text = changed(FROM_CSV, 'file = "punch.csv"', 'file = "punch.csv"\nforce = ["7 kN", "7 kN", "7 kN"]')
    assert "force" in str(refused(tmp_path, text))


@each("text", ["", "\n\n# nothing but a remark\n", 'title = "x"\n'])
def test_empty_text__says_that_the_input_is_missing(text, tmp_path):
    ((line, key, message),) = refused(tmp_path, text).problems
    assert (line, key) == (None, "input")
    assert message.startswith("is missing: add a table [input]")


NO_TOML = [
    *(bytes(range(256)), b"\x89HDF\r\n\x1a\n" + bytes(64), GOOD.encode("utf-16"), "a = " + "[" * 20_000, "\x00"),
    *("a = " + "[" * 500 + "]" * 500, "a = " + "9" * 5000, "<html><body>scene</body></html>"),
    "import os\nos.remove('press.toml')\n",
]


@each("text", NO_TOML)
def test_text_that_is_no_toml__is_refused(text, tmp_path):
    error = refused(tmp_path, text)
    assert "press.toml" in str(error)
    assert (tmp_path / "press.toml").exists()


@each("name", ["", "nowhere.toml", "folder/press.toml"])
def test_file_that_cannot_be_read__is_named(name, tmp_path):
    with pytest.raises(InputError, match=r"there is no such file|is a folder") as caught:
        read_scene(tmp_path / name)
    assert str(tmp_path) in str(caught.value)


@each("mark", ["\ufeff", ""])
def test_windows_text__is_read(mark, tmp_path):
    (tmp_path / "press.toml").write_bytes((mark + FROM_CSV).replace("\n", "\r\n").encode())
    (tmp_path / "punch.csv").write_bytes((mark + PUNCH).replace("\n", "\r\n").encode())
    assert read_scene(tmp_path / "press.toml").forces["punch"].force == [0.0, 100e3, 60e3]


# A part of `results/reliability/campaign.py`, whose slices add up


RELIABILITY = ROOT / "results" / "reliability"
# Both slices in one process, whose imports take most of the time.
SLICES = """
import sys
import campaign
for seed in ("5", "6"):
    sys.argv[1:] = ["--minutes", "0.0001", "--only", "inject", "--counts", "counts.json", "--seed", seed]
    campaign.main()
"""


def test_injected_texts__get_through_nowhere_and_slices_add_up(tmp_path):
    ended = ran("-c", f"import sys\nsys.path.insert(0, {str(RELIABILITY)!r})\n{SLICES}", cwd=tmp_path)
    assert ended.returncode == 0, ended.stderr
    data = json.loads((tmp_path / "counts.json").read_text())
    assert data["wrong"] == []
    assert sum(data["kinds"]["injections"]["ways"].values()) == 4
    assert len(data["slices"]) == 2
    assert "| injections | 4 |" in (tmp_path / "reliability.md").read_text()
