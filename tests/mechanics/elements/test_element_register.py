"""Every kind of element in the register evaluates, is drawn, has help and survives garbage; a new one does at once."""

from functools import cache
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import pytest
from cam_samples import ROLLER
from element_samples import EVERY, TIE
from governor_samples import EVERY_GOVERNOR
from pydantic import Field

import sweeps
from engine import Element, ElementsAlone, PlainNumber, Scene, Verdict, element_kinds, is_warning, scene_numbers
from engine.elements import element as register
from engine.words.quantity import main_result
from sweeps.pictures.elements.element_pictures import LAYOUTS, SHEETS, element_sheets
from sweeps.pictures.style import save_beside
from sweeps.report.help import key_help
from sweeps.text.input_files import InputError
from sweeps.text.scene_text import read_scene, scene_from
from sweeps.text.toml_text import parse_toml

# The one that is no more than what the scene's machine does on it: `test_machine_drives.py` evaluates and draws it.
OF_MACHINE = "machine_drive"
some = np.random.default_rng(8)


@cache
def samples():
    """An element of every kind."""
    given = [*EVERY.values(), *EVERY_GOVERNOR.values(), ROLLER]
    found = list(Scene(elements={f"e{i}": e for i, e in enumerate(given)}).elements.values())
    for file in Path(sweeps.__file__).parent.rglob("*.toml"):
        if "[elements." in file.read_text(encoding="utf8"):
            scene = read_scene(str(file))
            found += scene.elements.values() if scene.input is None else ()
    return {element.type: element for element in found}


KINDS = sorted(set(element_kinds()) - {OF_MACHINE})


def test_samples__are_of_all_kinds():
    assert {*samples(), OF_MACHINE} == set(element_kinds())
    assert {*LAYOUTS, *SHEETS} <= set(element_kinds())


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind__evaluates_is_drawn_and_has_help(kind, tmp_path):
    scene = Scene(elements={"it": samples()[kind]})
    names = [name for name in ElementsAlone(scene).available_summaries if not is_warning(name)]
    assert names == [f"it.{result.name}" for result in samples()[kind].results]
    outcome = ElementsAlone(scene, names).evaluate({})
    assert outcome.status[0] == Verdict.OK
    for result in samples()[kind].results:
        value, error = (part[f"it.{result.name}"][0] for part in (outcome.summaries, outcome.errors))
        assert np.isfinite(value) or result.may_be_undefined
        assert not error < 0.0
    (picture, *_) = save_beside(tmp_path / "it.svg", element_sheets(scene))
    assert picture.stat().st_size > 5000
    assert f'type = "{kind}"' in key_help.key_text(kind)


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind__survives_garbage(kind):
    scene = Scene(elements={"it": samples()[kind]})
    names = [name for name in ElementsAlone(scene).available_summaries if not is_warning(name)]
    numbers = scene_numbers(scene)
    count = 48
    varied = {}
    for path, number in numbers.items():
        spread = number.value * 10.0 ** some.uniform(-3.0, 3.0, count) * some.choice([1.0, 1.0, 1.0, -1.0], count)
        wild = some.choice([0.0, np.nan, np.inf, 1e300, -1e300, 1e-300], count)
        # Most numbers stay as they are: of ten wild ones hardly any element is left.
        varied[path] = np.select([some.random(count) < 0.8, some.random(count) < 0.8], [number.value, spread], wild)
    elements = ElementsAlone(scene, names, varied=varied)
    outcome = elements.evaluate(varied)
    well = outcome.status == Verdict.OK
    # Whatever is evaluated with a variant, its numbers have the same bits; nothing may be left to evaluate.
    for chosen in (well, ~well, outcome.status == Verdict.OUTSIDE_LIMITS, *np.eye(count, dtype=bool)[well][:2]):
        part = elements.evaluate({path: values[chosen] for path, values in varied.items()})
        for rows, whole in ((part.summaries, outcome.summaries), (part.errors, outcome.errors)):
            assert all(rows[name].tobytes() == whole[name][chosen].tobytes() for name in names)
    for result in samples()[kind].results:
        value = outcome.summaries[f"it.{result.name}"]
        assert not np.isinf(value).any(), result.name
        assert result.may_be_undefined or np.isfinite(value[well]).all(), result.name


@pytest.fixture
def hoist(monkeypatch):
    """A kind of element that the engine doesn't have."""
    monkeypatch.setattr(register, "_KINDS", dict(register._KINDS))
    key_help._keys.cache_clear()

    class Hoist(Element):
        """A rope over sheaves that lifts a load; `losing` is the share that is lost at each of them."""

        type: Literal["hoist"]
        load: Annotated[PlainNumber, Field(gt=0)]
        losing: Annotated[PlainNumber, Field(ge=0, lt=1)] = 0.0
        sheaves: int = 4

        def named(self, n):
            """Pull and efficiency."""
            share = sum((1.0 - n["losing"]) ** k for k in range(1, self.sheaves + 1))
            yield main_result("pull", "force that lifts the load", "N"), n["load"] / share
            yield main_result("efficiency", "share of the work that lifts", "1"), share / self.sheaves

    yield Hoist
    key_help._keys.cache_clear()


TEXT = '[elements.lift]\ntype = "hoist"\nload = 800\nlosing = 0.05\n'


def test_new_kind__evaluates_is_offered_and_drawn_by_being_defined(hoist, tmp_path):
    scene = scene_from(parse_toml(TEXT, "lift.toml"), TEXT, "lift.toml", None)
    assert isinstance(scene.elements["lift"], hoist)
    path = "elements.lift.losing"
    varied = {path: np.array([0.0, 0.05, 1.0])}
    outcome = ElementsAlone(scene, ["lift.pull"], varied=varied).evaluate(varied)
    exact = [200.0, 800.0 / sum(0.95**k for k in range(1, 5))]
    assert outcome.summaries["lift.pull"][:2] == pytest.approx(exact, rel=1e-15)
    assert list(outcome.status) == [Verdict.OK, Verdict.OK, Verdict.OUTSIDE_LIMITS]
    # One rounding of each number and sixteen of the result: dF/F = dQ/Q, and at no loss of 0.05 (1 + … ) hardly more.
    assert outcome.errors["lift.pull"][0] == pytest.approx(17 * np.finfo(float).eps * 200.0, rel=1e-6)
    assert [p.name for p in save_beside(tmp_path / "m.svg", element_sheets(scene))] == ["m_lift_results.svg"]
    assert "`losing`" in key_help.key_text("hoist")


def test_new_kind__is_told_of_where_a_text_is_wrong(hoist):
    for old, new, words in (
        ('"hoist"', '"hoyst"', "did you mean 'hoist'"),
        ("losing", "loosing", "did you mean 'losing'"),
        ("800", "-800", "line 3: elements.lift.load: must be greater than 0"),
    ):
        text = TEXT.replace(old, new)
        with pytest.raises(InputError, match=words):
            scene_from(parse_toml(text, "lift.toml"), text, "lift.toml", None)


def test_elements_named_after_the_file__have_pictures_of_their_own(tmp_path, blank_pictures):
    elements = dict.fromkeys(("engine", "engine_b", "b"), TIE)
    made = save_beside(tmp_path / "engine.svg", element_sheets(Scene(elements=elements)))
    assert made[0].name.count("engine") == 1
    assert len({picture.name for picture in made}) == 3
