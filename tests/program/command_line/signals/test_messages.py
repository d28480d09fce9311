"""What is said of slips, of files that are none, and of numbers beyond all bounds: one or two plain sentences."""

import os
import re
from pathlib import Path

import pytest
from commands import done, refused, said
from each_case import each
from press_texts import COMPRESSOR, PRESS
from slips import changed

from sweeps.text.csv_text import read_csv
from sweeps.text.input_files import InputError


def test_mode_that_no_point_selects__is_told_with_the_file(folder):
    done("new", "triad")
    Path("triad.toml").write_text(scene := changed(Path("triad.toml").read_text(), "[near]\nC =", "[near]\n# C ="))
    tables = re.sub(r"^\[", "[scene.", scene.partition("[points]")[2], flags=re.MULTILINE)
    varied = '[vary]\n"input.length" = { values = ["30 mm", "31 mm"] }\n'
    Path("study.toml").write_text(f"{varied}\n[scene.points]{tables}")
    for command, table in (("show triad.toml --at 0", "[near]"), ("check study.toml", "[scene.near]")):
        file = command.split()[1]
        line = Path(file).read_text().splitlines().index(table) + 1
        told = f"{file}, line {line}: near: rod, lower, upper, plate have 2 assembly modes"
        assert told in refused(*command.split())


# Numbers beyond all bounds


@each(
    "old, new",
    [
        ("100 kg", "1e200 kg"),
        ('mass = "100 kg"', 'shape = {type = "disc", diameter = "1e160 m", thickness = "1 m"}\ndensity = "1 kg/m3"'),
        ("", COMPRESSOR.replace("80 mm", "1e160 m")),
    ],
)
def test_overflow__is_a_status_not_an_exception(old, new, press_folder):
    Path("press.toml").write_text(changed(PRESS, old, new) if old else PRESS + new)
    answer = said("run", "press.toml", "--no-plots", "--quiet", "--replace")
    assert answer.exit_code == 1
    assert "infinite or undefined" in answer.stdout
    done("export", "press.toml", "--to", "p.csv", "--positions", "8")
    if new == "1e200 kg":
        assert "the shaking force is infinite" in refused("balance", "press.toml")


# Files that are none


@each("command", ["check", "run", "plot"])
def test_device_or_pipe__is_refused_at_once(command, press_folder):
    Path("pipe.toml").unlink(missing_ok=True)
    os.mkfifo("pipe.toml")
    for name in ("/dev/zero", "pipe.toml"):
        assert "is a device or a pipe" in refused(command, name)
    assert "is a device or a pipe" in refused("show", "pipe.toml")


@each("command", ["check", "show", "quantities"])
def test_name_that_no_file_may_have__is_refused_and_not_repeated(command, press_folder):
    text = refused(command, "\x1b[2J" + "(" * 3000)
    assert "is too long for a file name" in text
    assert "\\x1b[2J(((" in text
    assert len(text) < 200


@each(
    "line",
    [
        ("list", "press", "\x1b[2J"),
        ("--\x1b[2J",),
        ("\x1b[2J",),
        ("run", "--\x1b[2J"),
        ("run", "--jobs", "\x1b[2J", "p"),
    ],
)
def test_command_line_that_is_none__is_quoted_with_its_control_characters_spelled_out(line):
    text = refused(*line)
    assert "\x1b" not in text
    assert "\\x1b[2J" in text


def test_huge_file__is_refused_at_once(press_folder):
    with Path("huge.toml").open("wb") as file:
        file.truncate(10**11)
    assert "100000 MB, more than the allowed 16 MB" in refused("check", "huge.toml")


def test_contents_of_other_files__are_not_quoted(press_folder):
    Path("secret.key").write_text("password: hunter2\nother: hunter3\n")
    Path("secret.toml").write_text('[registry]\ntoken = "hunter2"\n')
    for message in (
        refused("check", "secret.key"),
        refused("check", "secret.toml"),
        refused("flywheel", "secret.key", "--speed", "1 rpm", "--fluctuation", "1/50"),
    ):
        assert "hunter" not in message


def test_long_message__is_cut(press_folder):
    Path("press.toml").write_text(PRESS + "".join(f"[bodies.ram.x{i}]\n" for i in range(400)))
    assert len(refused("check", "press.toml")) < 3000


# Tables


@each(
    "text",
    [
        "input.length [mm],input.speed [rpm]\n40.5,60\n50,70\n",
        "\ufeffinput.length [mm];input.speed [rpm]\r\n40,5;60\r\n50;70\r\n",
        "sep=;\ninput.length [mm];input.speed [rpm]\n40,5;60\n50;70\n",
        "# measured\n\ninput.length [mm]\tinput.speed [rpm]\n40.5\t60\n\n50\t7e1\n",
        '"input.length [mm]","input.speed [rpm]"\n"40.5","60"\n"50","70"\n',
    ],
)
def test_table_of_a_spreadsheet__is_read(text, tmp_path):
    (tmp_path / "t.csv").write_bytes(text.encode())
    columns = read_csv(tmp_path / "t.csv")
    assert {name: (column.unit, column.plain_numbers()) for name, column in columns.items()} == {
        "input.length": ("mm", [40.5, 50]),
        "input.speed": ("rpm", [60, 70]),
    }


@each("text", ["root:x:0:0:root:/root:/bin/sh\nsecret:x:1:1\n", "a [mm]\nsecret\n"])
def test_file_that_is_no_table__is_not_quoted(text, tmp_path):
    (tmp_path / "passwd").write_text(text)
    with pytest.raises(InputError) as refusal:
        read_csv(tmp_path / "passwd")
    assert not re.search("root|secret", str(refusal.value))
