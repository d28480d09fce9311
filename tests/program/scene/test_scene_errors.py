"""Scenes that are refused: the message names the file, the line, the key, what is allowed and the mend."""

import random
import re
import shutil

from commands import ROOT
from hypothesis import given, settings
from hypothesis import strategies as st
from scene_samples import GOOD, refused
from slips import changed

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
