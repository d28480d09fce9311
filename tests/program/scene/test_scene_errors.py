"""Scenes that are refused: the message names the file, the line, the key, what is allowed and the mend."""

import re
from collections.abc import Iterable
from pathlib import Path

from each_case import each
from hypothesis import given, settings
from hypothesis import strategies as st
from press_texts import slider_crank_text
from scene_samples import FROM_CSV, GOOD, PUNCH, SLIDING, line_with, refused
from slips import cases, changed

from engine.parts.skeleton import Part, Refers, field_marks
from engine.scene.names import DEFINED, FITTING
from sweeps import InputError, read_scene

GROUND = """\
[points]
O = {x = "0 mm", y = "0 mm"}
D = {x = "200 mm", y = "0 mm"}
E = {x = "100 mm", y = "200 mm"}

[input]
type = "crank"
pivot = "O"
pin = "A"
length = "50 mm"
speed = "60 rpm"
"""

FOUR_BAR = f"""{GROUND}
[groups.bars]
type = "RRR"
inner = "B"
first = {{link = "coupler", joint = "A", length = "200 mm"}}
second = {{link = "rocker", joint = "D", length = "150 mm"}}
"""

# Two bars carry one more link each, and each of these pairs of links hangs on the other: a triad.
TRIAD = f"""{GROUND}
[points.corner]
link = "plate"
x = "50 mm"
y = "0 mm"

[groups.one]
type = "RRR"
inner = "B"
first = {{link = "plate", joint = "F", length = "100 mm"}}
second = {{link = "bar_1", joint = "D", length = "100 mm"}}

[groups.two]
type = "RRR"
inner = "F"
first = {{link = "bar_2", joint = "E", length = "100 mm"}}
second = {{link = "bar_3", joint = "corner", length = "100 mm"}}
"""

ENGINE = f"""\
{slider_crank_text("", "1500 rpm", "slide", "piston", "revolutions = 2")}
[cylinders.fire]
type = "four_stroke"
piston = "piston"
bore = "80 mm"
clearance = 0.1
intake = "1 bar"
exhaust = "1.1 bar"
peak = "50 bar"
"""


def check(error: InputError, text: str, marker: str, key: str, words: Iterable[str]) -> None:
    """Some problem stands at the line of `marker` and has the key; together they say all the words."""
    found = [p for p in error.problems if p[1] == key]
    assert found, str(error)
    assert line_with(text, marker) in [line for line, _, _ in found], str(error)
    place = f"press.toml, line {line_with(text, marker)}: "
    assert (f"{place}{key}: " if key else place) in str(error)
    for word in words:
        assert word in str(error), str(error)
    assert "pydantic" not in str(error)
    assert "Traceback" not in str(error)


def test_good_texts__are_read(tmp_path):
    (tmp_path / "punch.csv").write_text(PUNCH)
    for i, text in enumerate((GOOD, FOUR_BAR, SLIDING, ENGINE, FROM_CSV)):
        (tmp_path / f"{i}.toml").write_text(text)
        assert read_scene(tmp_path / f"{i}.toml").input.speed > 0


# Name | what to change in GOOD | what into | a mark of the line to be named | key | words of the message.
SLIPS = cases(r"""
no mass | mass = "100 kg"\n |  | [bodies.ram] | bodies.ram | give mass | shape with density
unknown law | "table" | "tabel" | [forces.punch] | forces.punch | constant, table | did you mean 'table'?
no type | type = "RRP"\n |  | [groups.press] | groups.press | 'type' is missing
force, not moment | 2 N m | 2 N | "2 N" | moments.friction.moment | a moment such as '7 N m'
fluctuation | "1/10" | "3" | "3" | flywheel.speed_fluctuation | must be less than 2
capital letter | on = "C" | on = "c" | on = "c" | forces.punch.on | not a point | did you mean 'C'?
spring on nothing | "tip"] | "top"] | top | springs.back.between | 'top' | did you mean 'tip'?
spring with one end | ["D", "tip"] | ["D"] | between | springs.back.between
spring on one point | ["D", "tip"] | ["D", "D"] | between | springs.back.between | 'D'
name of two actions | springs.back | springs.punch | [springs.punch] | springs.punch | taken by forces.punch
bad name | inner = "C" | inner = "my C" | my C | groups.press.inner | 'my C' is not a name | underscores
link of two groups | link = "pitman" | link = "rod" | link = "rod", joint = "A", length = "200
    | groups.press.first.link | 'rod' is already moved by groups.bars.first.link | over-constrained
group on the frame | joint = "A", length = "220 | joint = "O", length = "220 | [groups.bars] | groups.bars
    | over-constrained | frame | W =  | moving link
pivot that moves | pivot = "O" | pivot = "tip" | pivot | input.pivot | not on the frame | D, O
body on the frame | link = "ram"\nmass | link = "frame"\nmass | link = "frame" | bodies.ram.link | moving link
moment on a slider | on = "rocker"\nmoment | on = "ram"\nmoment | on = "ram" | moments.friction.on | 'ram'
motor on a rocker | type = "against_motion"\non = "rocker"\nmoment = "2 N m"
    | type = "dc_motor"\non = "rocker"\nstall_moment = "2 N m"\nno_load_speed = "90 rpm" | on = "rocker"
    | moments.friction.on | a motor drives the crank | allowed: crank
stroke of a rocker | slider = "ram" | slider = "rocker" | slider | forces.punch.slider | sliders are: ram
stroke of nothing | slider = "ram"\n |  | [forces.punch] | forces.punch | over_stroke and slider | name
table not sorted | "1 mm", "8 mm" | "8 mm", "1 mm" | [forces.punch] | forces.punch | row 3 | sort
table not equal | "1 mm", "8 mm" | "1 mm" | [forces.punch] | forces.punch | 2 rows | has 3
mass and density | density = | mass = "1 kg"\ndensity = | [bodies.bar] | bodies.bar | either mass or density
inertia and shape | density = | inertia = "1 kg m2"\ndensity = | [bodies.bar] | bodies.bar | give one of
start alone | "60 rpm" | "60 rpm"\nstart = "0 deg" | [input] | input | start and stop | full revolutions
flywheel without a cycle | "60 rpm" | "60 rpm"\nstart = "0 deg"\nstop = "9 deg" | [flywheel] | flywheel | turns fully
revolutions | "60 rpm" | "60 rpm"\nrevolutions = 0 | revolutions | input.revolutions | 0 | at least 1
mode | inner = "C" | inner = "C"\nmode = 0 | mode = 0 | groups.press.mode | 1 or -1
list of tables | [input] | [[input]] | [[input]] | input | expected a table of keys
Python for a number | mass = "100 kg" | mass = "__import__('os').system('touch stolen')" | __import__
    | bodies.ram.mass | a mass such as '1.2 kg' | __import__
Python for a name | inner = "C" | inner = "C); import os; os.remove('press.toml'); (" | import os | groups.press.inner
    | is not a name
""")


@each("slip", SLIPS)
def test_slip__is_refused_with_line_key_and_mend(slip, tmp_path):
    old, new, marker, key, *words = SLIPS[slip]
    text = changed(GOOD, old, new)
    check(refused(tmp_path, text), text, marker, key, words)
    assert not Path("stolen").exists()


# Name | scene | what to change in it | what into | a mark of the line to be named | key | words of the message.
STRUCTURES = cases(r"""
class III | TRIAD |  |  | [groups.one] | groups.one | one waits for F | two waits for corner | class III
undriven link | FOUR_BAR | [input] | [points.P]\nlink = "lever"\nx = "1 mm"\ny = "0 mm"\n\n[input] | lever
    | points.P.link | 'lever' is not a link | coupler, crank, frame, rocker
sliding input on a moving guide | SLIDING | guide = "way" | guide = "slot" | guide = "slot" | input.guide
    | moving link | must be on the frame
shaft on a sliding input | SLIDING | [groups.bars] | [shafts.wheel]\ngeared_to = "ram"\nratio = 2\n\n[groups.bars]
    | geared_to | shafts.wheel.geared_to | sliding input
sliding input that doesn't move | SLIDING | stop = "50 mm" | stop = "0 mm" | [input] | input | stop | start
shaft on the frame | FOUR_BAR | [groups.bars] | [shafts.wheel]\ngeared_to = "frame"\nratio = 2\n\n[groups.bars]
    | geared_to | shafts.wheel.geared_to | 'frame'
shaft with a pivot that moves | FOUR_BAR | [groups.bars]
    | [shafts.wheel]\ngeared_to = "crank"\nratio = 2\npivot = "B"\n\n[groups.bars] | pivot = "B" | shafts.wheel.pivot
    | not on the frame | D, E, O
cylinder on a rod | ENGINE | piston = "piston" | piston = "rod" | piston = "rod" | cylinders.fire.piston
    | 'rod' doesn't slide | sliders are: piston
four strokes in a turn | ENGINE | revolutions = 2\n |  | four_stroke | cylinders.fire.type | two turns
    | input.revolutions = 2
""")


@each("case", STRUCTURES)
def test_impossible_structure__is_refused_in_the_mechanics_words(case, tmp_path):
    name, old, new, marker, key, *words = STRUCTURES[case]
    text = changed(globals()[name], old, new)
    check(refused(tmp_path, text), text, marker, key, words)


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


LINES = GOOD.splitlines()
WORDS = re.findall(r'"[^"]*"', GOOD)
KEYS = [i for i, line in enumerate(LINES) if "=" in line]
VALUES = [
    *("0", "-1", "1e400", "true", "nan", '""', '"1 mm"', '"-3 deg"', '"A"', '"frame"', '"ram"', "[]", "{}", '["D"]'),
    *('["1 mm", "2 mm"]', "[[1]]", "{x = 1}", "1979-05-27", '"""\n[input]\n"""'),
]


@st.composite
def mutations(draw: st.DrawFn) -> str:
    """GOOD with one to three lines deleted, doubled, moved, given another value or another key."""
    lines = list(LINES)
    for _ in range(draw(st.integers(1, 3))):
        i = draw(st.sampled_from([k for k in KEYS if k < len(lines)]))
        match draw(st.sampled_from(["delete", "double", "value", "key", "swap", "text", "word"])):
            case "delete":
                del lines[i]
            case "double":
                lines.insert(draw(st.integers(0, len(lines))), lines[i])
            case "value":
                lines[i] = lines[i].split("=")[0] + "= " + draw(st.sampled_from(VALUES))
            case "key":
                key = draw(st.sampled_from(["x", "type", "link", '"a.b"', "input.length"]))
                lines[i] = f"{key} ={lines[i].split('=', 1)[-1]}"
            case "swap":
                j = draw(st.integers(0, len(lines) - 1))
                lines[i], lines[j] = lines[j], lines[i]
            case "text":
                lines[i] = draw(st.text(max_size=20))
            case "word":
                lines[i] = re.sub(r'"[^"]*"', draw(st.sampled_from(WORDS)), lines[i])
    return "\n".join(lines)


@settings(deadline=None, max_examples=200)
@given(mutations())
def test_any_mutation__is_read_or_refused_with_reasons(tmp_path_factory, text):
    path = tmp_path_factory.getbasetemp() / "mutated.toml"
    path.write_bytes(text.encode())
    try:
        read_scene(path)
    except InputError as error:
        problems = error.problems
    else:
        return
    assert problems
    for line, _, message in problems:
        assert message
        # TOML places an unfinished text just behind its end.
        assert line is None or 1 <= line <= len(text.splitlines()) + 1
