"""Machines of many links and bodies: reading and printing grow no faster than n log n, and a check waits for none."""

import sys
from math import log
from pathlib import Path

from commands import done

from sweeps.report import check_report
from sweeps.study.study_reader import read_study

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
    monkeypatch.setattr("engine.compiling.kept_code._load", None)
    answer = done("check", "long.toml")
    for words in ("group g2: RRR", "are unknown", f"{lines} generated lines", "`sweeps run`", "kB; "):
        assert words in answer
    assert "\nTime\n" not in answer
