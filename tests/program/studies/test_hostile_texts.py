"""Texts made to be slow or too large to read: time grows with their length, and the refusal is a sentence."""

import json
import re
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from math import log
from pathlib import Path

import h5py
import pytest
from commands import done, refused
from each_case import each

from engine import ExpressionError, UnitError, any_quantity, in_text, parse_expression
from sweeps import InputError, import_scene, read_study
from sweeps.report import check_report
from sweeps.text.csv_text import read_csv
from sweeps.text.numbers_in_row import numbers_in_row
from sweeps.text.toml_text import parse_toml

PIECES = [
    *("a", "1", "1.", "a.", "1 ", "a ", "= ", "==", "[", "]", "[a]", "(", "1,", "a,", '"', "'", "#", " ", "\t", "-"),
    *("*", "1e", "mm ", "mm/", "a=1,", "{a=", "?", "?a.a", "t,", "|", "a|", "\n", "a\n", "a=1\n", "=1 a", "1 to ", "/"),
    *("1/", "not ", "-1", "a<", "a*", "(a)", "a.1 ", "%", "&", "^"),
]
SHORT, TIMES = 4000, 4
# Seconds below which a ratio is one of noise, and how many times as long a text so many times as long may take: the
# square is 16.
NOISE, MOST = 0.5, 12


def written(name: str, text: str) -> Path:
    Path(name).write_text(text, encoding="utf8")
    return Path(name)


def study(text: str) -> object:
    return read_study(written("hostile.toml", f'scene = "press.toml"\n{text}\n'))


def quoted(text: str) -> str:
    return json.dumps(text.replace("\n", " "))


READERS: dict[str, Callable[[str], object]] = {
    "value": lambda text: parse_toml(f"x = {text}", "a.toml"),
    "key": lambda text: parse_toml(text, "a.toml"),
    "header": lambda text: read_csv(written("a.csv", f"{text} [mm]\n1\n")),
    "row": lambda text: read_csv(written("a.csv", f"a [mm]\n{text}\n")),
    "linkage": lambda text: import_scene(written("l.txt", text)),
    "linkage in JSON": lambda text: import_scene(written("l.json", f"[{text}")),
    "quantity": lambda text: in_text(text, "length"),
    "expression": lambda text: parse_expression(text, any_quantity),
    "numbers in a row": lambda text: numbers_in_row("--at", text, ("length", "length")),
    "range": lambda text: study(f'[vary]\n"input.length" = {quoted(text)}'),
    "path": lambda text: study(f'[vary]\n{quoted(text)} = ["1 mm"]'),
    "condition": lambda text: study(f"require = [{quoted(text)}]"),
}


def seconds(read: Callable[[str], object], text: str) -> float:
    begin = time.process_time()
    with suppress(InputError, UnitError, ExpressionError):
        read(text)
    return time.process_time() - begin


def is_soon(read: Callable[[str], object], text: str, most: float) -> bool:
    """Whether a text is read in so many seconds; once more if another program took the processor meanwhile."""
    return any(seconds(read, text) < most for _ in range(2))


@pytest.mark.parametrize("reader", READERS)
def test_time__grows_with_the_length_of_a_text(reader, press_folder):
    read = READERS[reader]
    for piece in PIECES:
        text = piece * (SHORT // len(piece))
        short = seconds(read, text)
        # A cubic reader would take minutes over the longer text.
        assert short < 10 * NOISE, (piece, short)
        assert is_soon(read, text * TIMES, max(MOST * short, NOISE)), (piece, short)


VARY = '[vary]\n"input.length" = ["40 mm", "50 mm"]\n'
GROUP = """
[groups.g{i}]
type = "RRP"
inner = "B{i}"
first = {{link = "r{i}", joint = "A", length = "200 mm"}}
second = {{link = "s{i}", guide = "g{i}"}}
"""
WRONG_LINES = {
    "numbers": ("[vary]\n", "a{i} = {i}"),
    "lists": ("[vary]\n", '"a{i}" = ["1 kg"]'),
    "ranges": ("[vary]\n", '"a{i}" = "1 mm to 2 mm, 3"'),
    "samples": ("[vary]\n", '"a{i}" = {{ low = 1, high = 2 }}'),
    "derived": (f"{VARY}[derive]\n", 'a{i} = "b{i}"'),
    "tolerances": (f"{VARY}[tolerances]\n", '"input.a{i}" = "1 mm"'),
    "outputs": (f"{VARY}[outputs]\n", "a{i} = 1"),
}


@pytest.mark.parametrize("kind", [*WRONG_LINES, "groups"])
def test_many_wrong_keys__take_a_time_in_proportion(kind, press_folder):
    press = Path("press.toml").read_text(encoding="utf8")
    head, line = WRONG_LINES.get(kind, (press, GROUP))
    read = (lambda text: read_study(written("hostile.toml", text))) if kind == "groups" else study
    few = 250 if kind == "groups" else 2500

    def of(count: int) -> str:
        return head + "\n".join(line.format(i=i) for i in range(count))

    short = seconds(read, of(few))
    assert is_soon(read, of(4 * few), max(MOST * short, 2 * NOISE))


# Sizes that no memory holds


@each("command", [("check",), ("run", "--no-plots", "--quiet")])
@each("count", ["1000000000001", "1" + 30 * "0"])
def test_more_variants_than_any_disk_holds__are_refused(command, count, press_folder):
    axes = {
        "one": f'"input.length" = "40 mm to 60 mm, {count}"',
        "table": f'"input.length" = {{ from = "40 mm", to = "60 mm", count = {count} }}',
        "sampled": '"input.length" = { low = "40 mm", high = "60 mm" }',
        "product": '"input.length" = "40 mm to 60 mm, 1000000000"\n"bodies.ram.mass" = "1 kg to 2 kg, 1000000000"',
    }
    for kind, axis in axes.items():
        sampling = f'[sampling]\nmethod = "random"\ncount = {count}\n' if kind == "sampled" else ""
        Path("many.toml").write_text(f'scene = "press.toml"\n[vary]\n{axis}\n{sampling}')
        message = refused(*command, "many.toml")
        assert "many.toml, line" in message
        assert re.search(r"at most \d+|count 10+", message)


def test_positions_beyond_all_bounds__are_told_as_positions(press_folder):
    Path("many.toml").write_text(f'scene = "press.toml"\npositions = 1{30 * "0"}\n{VARY}')
    assert "many.toml, line 2: positions: positions = 1000" in refused("check", "many.toml")


def test_key_of_many_parts__is_refused_before_it_is_read(press_folder):
    for text in ("a." * 50_000 + "a = 1", "[" + "a . " * 50_000 + "a]", "x = { " + '"a".' * 50_000 + "a = 1 }"):
        Path("long.toml").write_text(f'scene = "press.toml"\n{text}\n')
        assert "long.toml, line 2: more than 100 parts" in refused("check", "long.toml")
    Path("press.toml").write_text(f"# {200 * '. '}\n# {200 * '.'}\n{Path('press.toml').read_text()}")
    assert read_study("press.toml").design.size == 1


@each("text", ["[" * 100_000, '{"a":' * 100_000, "[" * 100_000 + "]" * 100_000])
def test_nested_json__is_refused(text, press_folder):
    Path("linkage.json").write_text(text)
    assert "is not JSON: " in refused("import", "linkage.json", "--unit", "1 cm")


def test_nested_layout_of_a_result__is_refused(press_result):
    with h5py.File(press_result, "r+") as file:
        file["progress"].attrs["layout"] = "[" * 60_000
    for command in ("show", "verify", "plot"):
        assert press_result in refused(command, press_result)


# Machines of many links and bodies: reading and printing grow no faster than n log n, and a check waits for none.


HEAD = """
[points]
O = { x = "0 mm", y = "0 mm" }
[input]
type = "crank"
pivot = "O"
pin = "B0"
length = "50 mm"
speed = "300 rpm"
"""


def dyads(count):
    """So many four-bars in a row, each driven by the rocker before it, with ten bodies to each."""
    text = HEAD
    for i in range(1, count + 1):
        text += f'[points.G{i}]\nx = "{300 * i} mm"\ny = "0 mm"\n[groups.g{i}]\ntype = "RRR"\ninner = "B{i}"\n'
        text += f'first = {{ link = "rod{i}", joint = "B{i - 1}", length = "300 mm" }}\n'
        text += f'second = {{ link = "rocker{i}", joint = "G{i}", length = "200 mm" }}\n'
        for k in range(10):
            text += f'[bodies.b{i}_{k}]\nlink = "{("rod", "rocker")[k % 2]}{i}"\nmass = "{k + 1} kg"\nx = "{k} mm"\n'
    return text


def lines_run(count):
    """How many lines of the program are carried out to read and print a machine of so many dyads."""
    Path("long.toml").write_text(dyads(count))
    run = 0

    def count_lines(frame, event, _):
        nonlocal run
        run += event == "line"
        return count_lines

    def of_the_program(frame, _, __):
        return count_lines if "/engine/" in frame.f_code.co_filename or "/sweeps/" in frame.f_code.co_filename else None

    before = sys.gettrace()
    sys.settrace(of_the_program)
    try:
        read_study("long.toml").machine().source()
    finally:
        sys.settrace(before)
    return run


def test_reading_and_printing__grow_no_faster_than_n_log_n(folder):
    # What is made once for all machines is made.
    lines_run(1)
    few, many = 12, 48
    # In bodies, of which there are ten to a dyad; what grew with the square ran 6.2 times as many lines.
    bound = many / few * log(10 * many) / log(10 * few)
    assert lines_run(many) / lines_run(few) < bound


def test_check_of_a_long_machine__compiles_nothing_and_says_so(folder, monkeypatch):
    Path("long.toml").write_text(dyads(2))
    lines = len(read_study("long.toml").machine().source().splitlines())
    monkeypatch.setattr(check_report, "MOST_COMPILED", lines - 1)
    monkeypatch.setattr("engine.compiling.printed_functions._library", None)
    answer = done("check", "long.toml")
    for words in ("group g2: RRR", "are unknown", f"{lines} generated lines", "`sweeps run`", "kB; "):
        assert words in answer
    assert "\nTime\n" not in answer
