"""Wrong inputs as people make them: each answer has the place, the key, the reason and the mend, in plain words."""

import re
import tomllib
from pathlib import Path

import pytest
from commands import said
from each_case import each
from press_texts import PRESS_WITH_FLYWHEEL as SCENE
from slips import cases, changed
from study_samples import STUDY, study_of

from engine import AskError, Machine, Mechanics, Scene, SceneError
from sweeps import InputError, read_scene

# Words of Python and its libraries.
FOREIGN = re.compile(
    r"pydantic|Input should|valid (string|integer|number|list|dict)|[Tt]raceback|(Type|Value|Key|Attribute|Name)Error|"
    r"NoneType|\bdict\b|\bstr\b|\bint\b|\bbool\b|<class|Cannot (declare|overwrite)|could not convert|invalid syntax|"
    r"[a-z][A-Z][a-z]+ can't be|object has no|tuple|Expected '|at line \d+, column|literal|Errno|is not callable|loc="
)

# Name | what of the scene | becomes | line and key | words of reason and mend.
SCENES = cases(r"""
no unit | "50 mm" | 50 | 13: input.length | 50 has no unit: write "50 mm"
no quotes | "50 mm" | 50 mm | 13 | has a unit, so it needs quotes: "50 mm"
unknown unit | "100 kg" | "100 kgs" | 24: bodies.ram.mass | unknown unit 'kgs' | did you mean 'kg'
decimal comma | "50 mm" | "50,5 mm" | 13: input.length | use a decimal point, not a comma, as in '50.5 mm'
weight for mass | "100 kg" | "980 N" | 24: bodies.ram.mass | expected a mass such as '1.2 kg', got 'N'
words | "100 kg" | "heavy" | 24: bodies.ram.mass | expected a mass such as '1.2 kg' | does not begin with a number
list | "100 kg" | ["100 kg"] | 24: bodies.ram.mass | expected a mass such as '1.2 kg', got ['100 kg']
misspelt key | mass = | mas = | 24: bodies.ram.mas | unknown key; allowed: link, mass | did you mean 'mass'?
other word | length = "50 mm" | radius = "50 mm" | 13: input.radius | unknown key | did you mean 'length'?
misspelt table | [input] | [imput] | 9: imput | unknown key | did you mean 'input'?
unknown point | joint = "A" | joint = "Z" | 19: groups.slide.first.joint | 'Z' is not a point of this scene | A, B, O
name taken | inner = "B" | inner = "A" | 18: groups.slide.inner | already taken by input.pin; choose another
choice | [flywheel] | [forces.f]\ntype = "table"\n[flywheel] | 33: forces.f.interpolation | add one of linear, pchip
table twice | [flywheel] | [flywheel]\n[flywheel] | 34 | the table [flywheel] appears twice, first in line 33
key twice | mass = | mass = "9 kg"\nmass = | 25 | mass appears twice in its table: remove one
quote | "100 kg" | "100 kg | 24 | a quotation mark is missing
curly quotes | "100 kg" | “100 kg” | 24 | write straight quotation marks, ", not typographic ones
colon | mass = | mass: | 24 | write KEY = VALUE, not KEY: VALUE
semicolon | "100 kg" | "100 kg"; | 24 | a line holds one KEY = VALUE
no value | mass = "100 kg" | mass = | 24 | no value after =
blank in a name | [bodies.ram] | [bodies.the ram] | 22 | a ] is missing after the name of the table, or the name has a
backslash | Crank press | C:\press | 1 | write \\ for a backslash, or use single quotes
coordinates | {x = "0 mm", y = "0 mm"} | ["0 mm", "0 mm"] | 4: points.O | expected a table of keys, got ['0 mm', '0 mm']
units | title = "Crank press" | units = "metric" | 1: units | 'metric' is not allowed; allowed: mm, SI, US
formula | force = "100 kN" | force = "100 kN * phi = 3" | 30: forces.punch.force | expected a force such as '12 kN'
""")

# The same of a study.
STUDIES = cases(r"""
and | "ram.stroke > '90 mm'" | "reach > 3 && reach < 5" | 19: best.where | write and instead of &&
text without end | > '90 mm' | > '90 mm | 19: best.where | the quotation mark ' is never closed
bracket | "ram.stroke > '90 mm'" | "(ram.stroke > 90 mm" | 19: best.where | this bracket is never closed
condition by a number | "ram.stroke > '90 mm'" | 90 | 19: best.where | expected a list in brackets, [ ], got 90
misspelt result | "ram.stroke > '90 mm'" | "ram.strok > 90 mm" | 19: best.where | did you mean 'ram.stroke'
result in require | positions | require = "ram.stroke > 90 mm"\npositions | 4: require
    | is a result; require drops variants before they are computed, so write where
where at the top | positions | where = "reach > 3"\npositions | 4: where | belongs to [best] or [optimise]
best of what is fixed | "excess_work"\n | "input.speed"\n | 18: best.minimise | the same for all variants: vary it
range | {from = "40 mm", to = "60 mm", count = 3} | "40-60 mm" | 7: vary.input.length | such as '40 mm to 80 mm, 5'
bare range | {from = "40 mm", to = "60 mm", count = 3} | "40 to 60 mm, 3" | 7: vary.input.length | 40 has no unit
minimum | {from = "40 mm", to = "60 mm", count = 3} | {min = "40 mm", count = 3} | 7: vary.input.length.min
    | did you mean 'from'?
list of lists | [3, 4, 5] | [[3, 4]] | 9: vary.reach.values.0 | expected a number or a text in quotes, got [3, 4]
list in quotes | [3, 4, 5]} | "3, 4, 5"} | 9: vary.reach.values | expected a list in brackets, [ ], got '3, 4, 5'
spreadsheet | "reach * input.length" | "=reach * input.length" | 12: derive.groups.slide.first.length
    | leave the leading = out
no operator | reach * input | reach x input | 12: derive.groups.slide.first.length | an operator is missing here
number for a text | "reach * input.length" | 0.2 | 12: derive.groups.slide.first.length
    | expected a text in quotes, got 0.2
field for a summary | ["ram.stroke", | ["B.x", | 14: outputs | 'B.x' is a field, a curve | B.x.max
summary for a field | summaries = | fields = | 14: outputs | 'ram.stroke' is a summary, a single number
no scene | scene = "press.toml"\n |  | : scene | is missing: name the file of the scene, scene = "press.toml"
study for a scene | press.toml | study.toml | 3: scene | study.toml is a study; name the file of a scene
no such file | press.toml | Press.toml | 3: scene | Press.toml: can't be read: No such file
""")

# A table of variants, and its line and column.
TABLES = cases(r"""
empty cell | input.length [mm],bodies.ram.mass\n40,\n | 2: column bodies.ram.mass | '' is not a number such as 0.5
decimal comma | input.length [mm]\n40,5\n | 2 | has 2 cells, the header 1; separate columns by semicolons
no header | 40\n50\n | 1 | the first line must name the columns, such as 'input.length [mm]'
round brackets | input.length (mm)\n40\n | 1 | write a name and a unit for each column, such as 'force [kN]'
open quotation | input.length [mm]\n"40\n | 2 | quotation marks don't match
""")

# A command, and what is named in place of a file.
COMMANDS = cases(r"""
no such file | run nope.toml | nope.toml | there is no such file, and no bundled study of that name
scene for a result | show press.toml | press.toml | For scenes and studies use `sweeps check`
misspelt command | chekc press.toml | chekc | Did you mean 'check'?
no value | check press.toml --set input.length | --set | write PATH=VALUE, such as input.length='55 mm'
words for an angle | show press.toml --at ten | --at | expected an angle such as '30 deg' | for example --at 0,60,120
no angle | show press.toml --at , | --at | no positions; for example --at 0,60,120
words for a count | run press.toml --jobs two | --jobs | 'two' is not a whole number of at least 1
too few frames | animate press.toml --frames 2 | --frames | '2' is not a whole number from 4 to 1000
unknown field | plot press.toml -y B.speed | 'B.speed' is not a field | known are B.
accuracy | run press.toml --accuracy high | --accuracy | expected a number such as '0.3'
ending | export press.toml --to a.xls | --to | ending '.xls': allowed are .csv
picture | plot press.toml --out a.bmp | a.bmp | unknown picture format '.bmp'; allowed: .svg
""")

# What is given to a machine in Python that varies its crank.
GIVEN = {
    "unit": ({"input.length": "50 kg"}, "'input.length': expected a length such as '80 mm'"),
    "no unit": ({"input.length": "50"}, '50 has no unit: write "50 mm"'),
    "misspelt": ({"input.lenght": 0.05}, "'input.lenght' is not varied by this machine; known are: input.length"),
    "nothing": ({}, "no values are given for 'input.length'"),
    "two rows": ({"input.length": [[0.05], [0.06]]}, "'input.length' has 2 × 1 values: give one row of numbers"),
    "no path": ([0.05], "give values by path, such as {'input.length': [...]}"),
    "none": ({"input.length": None}, "give numbers in SI units, or texts with units such as '50 mm'"),
}


def check(message: str, place: str, words: list[str]) -> None:
    assert place in message, message
    for word in words:
        assert word in message, message
    assert not FOREIGN.search(message), message


def placed(file: str, place: str) -> str:
    """What a message begins with: the file, and where there is one the line and the key."""
    line, _, key = place.partition(":")
    return f"{file}, line {line}:{key}" if line else f"{file}:{key}"


@each("slip", SCENES)
def test_wrong_scene__is_answered(slip, tmp_path):
    old, new, place, *words = SCENES[slip]
    (tmp_path / "press.toml").write_text(changed(SCENE, old, new), encoding="utf8")
    with pytest.raises(InputError) as refused:
        read_scene(tmp_path / "press.toml")
    check(str(refused.value), placed("press.toml", place), words)


@each("slip", STUDIES)
def test_wrong_study__is_answered(slip, study_folder):
    old, new, place, *words = STUDIES[slip]
    with pytest.raises(InputError) as refused:
        study_of(study_folder, changed(STUDY, old, new))
    check(str(refused.value), placed("study.toml", place), words)


@each("slip", TABLES)
def test_wrong_table__is_answered(slip, study_folder):
    content, place, *words = TABLES[slip]
    (study_folder / "choice.csv").write_text(content, encoding="utf8")
    with pytest.raises(InputError) as refused:
        study_of(study_folder, 'scene = "press.toml"\nvariants = "choice.csv"\n')
    check(str(refused.value), f"study.toml, line 2: variants: {placed('choice.csv', place)}", words)


@each("slip", COMMANDS)
def test_wrong_command__is_answered(slip, press_folder):
    line, place, *words = COMMANDS[slip]
    answer = said(*line.split())
    assert answer.exit_code == 2
    check(answer.stderr, place, words)


@each("slip", GIVEN)
def test_wrong_numbers_in_python__are_answered(slip, machine):
    given, words = GIVEN[slip]
    with pytest.raises(AskError) as refused:
        machine.evaluate(given)
    check(str(refused.value), words, [])


@each("slip", SCENES)
def test_wrong_scene_in_python__is_answered(slip):
    """As in a file, except that numbers without a unit are in SI there."""
    old, new, place, *_ = SCENES[slip]
    try:
        tables = tomllib.loads(changed(SCENE, old, new))
    except tomllib.TOMLDecodeError:
        return
    for read in (Scene.model_validate, lambda data: Scene(**data)):
        try:
            Mechanics(read(tables))
        except SceneError as refused:
            check(str(refused), place.partition(":")[2].strip(), [])
        else:
            assert new == "50"


def test_wrong_scene_in_python__is_answered_key_by_key():
    with pytest.raises(SceneError) as refused:
        Scene(title=3, pionts={}, input={"type": "crank", "pivot": "O", "pin": "A", "length": "50 rpm", "speed": -1.0})
    assert dict(refused.value.problems)["title"] == "expected a text in quotes, got 3"
    assert dict(refused.value.problems)["input.length"] == "expected a length such as '80 mm', got 'rpm'"
    assert dict(refused.value.problems)["pionts"].endswith("did you mean 'points'?")


@pytest.fixture(scope="module")
def machine(tmp_path_factory) -> Machine:
    path: Path = tmp_path_factory.mktemp("scene") / "press.toml"
    path.write_text(SCENE, encoding="utf8")
    scene = read_scene(path)
    assert isinstance(scene, Scene)
    return Machine(scene, "ram.stroke", varied="input.length")
