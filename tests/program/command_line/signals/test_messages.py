"""What is said of slips, of files that are none, and of numbers beyond all bounds: one or two plain sentences."""

import os
import re
from pathlib import Path

import pytest
from commands import done, refused, said
from each_case import each
from press_texts import PRESS
from slips import cases, changed

from sweeps.text.csv_text import read_csv
from sweeps.text.input_files import InputError

COMPRESSOR = """
[cylinders.gas]
type = "compressor"
piston = "ram"
bore = "80 mm"
clearance = "6 %"
suction = "1 bar"
discharge = "7 bar"
"""
TABLE = """
[moments.cam]
type = "table"
on = "crank"
over_angle = ["0 deg", "90 deg", "360 deg"]
moment = ["0 N m", "5 N m", "3 N m"]
interpolation = "linear"
"""

# Name | what stands in the press | what stands there instead | words of the message.
SLIPS = cases(r"""
text without quotes | type = "crank" | type = crank | crank is a text
from for start | speed = "60 rpm" | speed = "60 rpm"\nfrom = "0 deg" | input.from | did you mean 'start'?
title with an escape | title = "Crank press" | title = "\u001b[31mpress" | control character
a limit in degrees | speed = "60 rpm" | speed = "0 rpm" | at rest
""")


@pytest.mark.parametrize("slip", SLIPS)
def test_slip_in_a_scene__is_told_as_that(slip, press_folder):
    old, new, *words = SLIPS[slip]
    Path("press.toml").write_text(changed(PRESS, old, new))
    message = refused("check", "press.toml")
    for word in words:
        assert word in message, message
    assert "\x1b" not in message


def test_limit_of_an_angle__is_told_in_degrees_where_it_was_given_so(press_folder):
    brake = '\n[moments.b]\ntype = "block_brake"\non = "crank"\nforce = "1 N"\nfriction = 0.3\nradius = "1 m"\n'
    Path("press.toml").write_text(PRESS + brake + 'embrace = "200 deg"\n')
    # 3.2 rad.
    assert "must be at most 183.346 deg, got '200 deg'" in refused("check", "press.toml")


def test_scene_without_input__is_told_that(press_folder):
    Path("press.toml").write_text(re.sub(r"\[input\].*?\n\n", "", PRESS, flags=re.DOTALL))
    message = refused("check", "press.toml")
    assert "input: is missing" in message
    assert "sweeps help input" in message
    assert len(message.splitlines()) == 1


@pytest.mark.parametrize("command", ["check triad.toml", "show triad.toml --at 0", "run study.toml"])
def test_mode_that_no_point_selects__is_told_with_the_file(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done("new", "triad")
    Path("triad.toml").write_text(scene := changed(Path("triad.toml").read_text(), "[near]\nC =", "[near]\n# C ="))
    tables = re.sub(r"^\[", "[scene.", scene.partition("[points]")[2], flags=re.MULTILINE)
    varied = '[vary]\n"input.length" = { values = ["30 mm", "31 mm"] }\n'
    Path("study.toml").write_text(f"{varied}\n[scene.points]{tables}")
    file = command.split()[1]
    table = "[near]" if file == "triad.toml" else "[scene.near]"
    line = Path(file).read_text().splitlines().index(table) + 1
    told = f"{file}, line {line}: near: rod, lower, upper, plate have 2 assembly modes"
    assert told in refused(*command.split())


@pytest.mark.parametrize(
    ("addition", "words"),
    [
        (COMPRESSOR.replace("1 bar", "8 bar"), "discharge = 700 kPa is not above suction = 800 kPa"),
        ('\n[shafts.s]\ngeared_to = "crank"\nratio = 0\n', "shafts.s.ratio: a shaft with the ratio 0"),
        (TABLE.replace("360 deg", "400 deg"), "row 3: over_angle [deg] = 400 is more than one period (360) after"),
        (TABLE, "moments.cam.moment: row 3: moment = 3 one period after the first row, whose moment = 0; make them"),
    ],
)
def test_what_no_machine_does__is_refused_with_its_line(addition, words, press_folder):
    Path("press.toml").write_text(PRESS + addition)
    message = refused("check", "press.toml")
    assert words in message
    assert "press.toml, line " in message


def test_friction_beyond_all_experience__is_asked_about(press_folder):
    Path("press.toml").write_text(
        PRESS + '\n[friction]\np = {pair = "slide.inner", coefficient = 8, diameter = "3 mm"}\n'
    )
    assert (
        "friction.p.coefficient: 8 exceeds limits.friction = 1.5; is it a percentage?"
        in said("check", "press.toml").stdout
    )


# Numbers beyond all bounds


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("100 kg", "1e200 kg"),
        ('mass = "100 kg"', 'shape = {type = "disc", diameter = "1e160 m", thickness = "1 m"}\ndensity = "1 kg/m3"'),
        ("", COMPRESSOR.replace("80 mm", "1e160 m")),
    ],
)
def test_overflow__is_a_status_not_an_exception(old, new, press_folder):
    Path("press.toml").write_text(changed(PRESS, old, new) if old else PRESS + new)
    answer = said("run", "press.toml", "--no-plots", "--quiet")
    assert answer.exit_code == 1
    assert "not finite" in answer.stdout
    done("export", "press.toml", "--to", "p.csv", "--positions", "8")


def test_balance_of_an_infinite_machine__is_refused(press_folder):
    Path("press.toml").write_text(changed(PRESS, "100 kg", "1e200 kg"))
    assert "the shaking force is infinite" in refused("balance", "press.toml")


def test_body_without_mass__is_exported(press_folder):
    Path("press.toml").write_text(changed(PRESS, "100 kg", "0 kg"))
    done("export", "press.toml", "--to", "p.csv", "--positions", "8")
    header, *rows = Path("p.csv").read_text().splitlines()
    places = [i for i, name in enumerate(header.split(",")) if name.startswith("ram.inertia_force")]
    assert all(float(row.split(",")[i]) == 0 for row in rows for i in places)


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
    text = refused(command, "(" * 3000)
    assert "is too long for a file name" in text
    assert len(text) < 200


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


@pytest.mark.parametrize(
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


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a [mm];b\n1.234,5;1\n", "line 2: column a: '1.234,5' is not a number"),
        ('a [mm],b\n"1,2\n3",4\n', "a quoted cell spans several lines"),
    ],
)
def test_table_that_cannot_be_read__is_told_precisely(text, words, tmp_path):
    (tmp_path / "t.csv").write_text(text)
    with pytest.raises(InputError, match=re.escape(words)):
        read_csv(tmp_path / "t.csv")


@pytest.mark.parametrize("text", ["root:x:0:0:root:/root:/bin/sh\nsecret:x:1:1\n", "a [mm]\nsecret\n"])
def test_file_that_is_no_table__is_not_quoted(text, tmp_path):
    (tmp_path / "passwd").write_text(text)
    with pytest.raises(InputError) as refusal:
        read_csv(tmp_path / "passwd")
    assert not re.search("root|secret", str(refusal.value))
