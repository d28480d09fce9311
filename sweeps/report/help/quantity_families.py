"""The quantities of all kinds of machines, as families such as GROUP.transmission_angle."""

import re
import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from engine import Quantity, Scene, definitions_of_names, made_ready
from sweeps.study.bundled import bundled_studies
from sweeps.study.study_reader import read_study
from sweeps.text.scene_text import read_scene, scene_from
from sweeps.text.templates import bundled_templates, template_text

MACHINE = "Machine"
# Tables of a scene, and the placeholder for their names in a family.
_TABLES = {
    **{"groups": "GROUP", "bodies": "BODY", "cams": "CAM", "forces": "FORCE", "moments": "MOMENT", "springs": "SPRING"},
    **{"cylinders": "CYLINDER", "pins": "PIN", "struts": "STRUT", "wanted": "WANTED", "couplings": "COUPLING"},
    **{"regimes": "REGIME", "elements": "NAME"},
}
# The name of a part may also be a plain word in a meaning: the angle of any crank.
_NOT_A_NAME = r"(?! angle| speed| torque| force|'s)"
_BEFORE_NAMES = "link|slider|joint|guide|body|group|shaft|point|on|about|with|path of|torque of"
# Kinds whose names start a regime's quantity, as in start.motor_shaft_final_speed.
_AT_BEGIN = ("SHAFT", "COUPLING")


class Family(NamedTuple):
    """A quantity with capital letters in place of the names of parts; a curve, or a number of a variant."""

    name: str
    units: str
    long_name: str
    curve: bool


def quantity_families() -> dict[str, list[Family]]:
    """Families of quantities by their owner: the machine, a kind of part, or a type of element."""
    found: dict[str, dict[str, Family]] = {MACHINE: {}}
    for scene in _scenes():
        machine, kinds = made_ready(scene), _kinds_of_names(scene)
        for known, curve in ((machine.available_summaries, False), (machine.available_fields, True)):
            for quantity in known.values():
                owner, family = _family(quantity, kinds, scene, curve)
                found.setdefault(owner, {}).setdefault(family.name, family)
    elements = sorted(owner for owner in found if owner.startswith("Element "))
    owners = [owner for owner in found if owner not in elements]
    return {owner: list(found[owner].values()) for owner in (*owners, *elements)}


def _scenes() -> Iterator[Scene]:
    """Bundled scenes, the simplest machine first, and rare parts."""
    templates = bundled_templates()
    simplest = templates.pop("slider_crank")
    for path in (simplest, *templates.values()):
        yield read_scene(path)
    for path in bundled_studies().values():
        yield read_study(path).scene
    # Parts that no bundled machine has, added to the slider-crank; once with each coupling.
    rare = tomllib.loads(Path(__file__).with_name("rare_parts.toml").read_text("utf8"))
    for coupling in rare.pop("each_coupling"):
        data = tomllib.loads(template_text("slider_crank")) | rare
        data["couplings"] = {"joint": coupling}
        yield scene_from(data, "", simplest.name, simplest.parent)


def _kinds_of_names(scene: Scene) -> dict[str, str]:
    """Placeholder in a family for each name of a scene."""
    kinds = {name: kind for table, kind in _TABLES.items() for name in getattr(scene, table)}
    if scene.input is not None:
        points, guides, links = definitions_of_names(scene)
        kinds |= dict.fromkeys(points, "POINT") | dict.fromkeys(guides, "GUIDE") | dict.fromkeys(links, "LINK")
        kinds |= dict.fromkeys(scene.shafts, "SHAFT") | {f"group_of_{link}": "GROUP" for link in links}
        kinds.pop("frame")
    return kinds


def _family(quantity: Quantity, kinds: dict[str, str], scene: Scene, curve: bool) -> tuple[str, Family]:
    """A quantity's owner and family."""
    *parts, last = quantity.name.split(".")
    owner, own, words = kinds.get(parts[0] if parts else "", MACHINE), dict(kinds), quantity.long_name
    if owner == "NAME":
        element = scene.elements[parts[0]]
        owner, own, words = f"Element {element.type}", {parts[0]: "NAME"}, words.removeprefix(f"{parts[0]}: ")
        for key, inner in element:
            if isinstance(inner, dict):
                own |= dict.fromkeys(inner, re.sub(r"(?<=s|h)es$|s$", "", key).upper())
        numbered, begins = r"(?<=_)\d+$", [name for name, kind in own.items() if kind != "NAME"]
        words = re.sub(rf"(?<!\w){re.escape(last)}(?!\w)", own.get(last, last), words)
        last = own.get(last, last)
    else:
        numbered, begins = r"(?<=order_)\d+(?:_\d+)?$", [n for n, kind in kinds.items() if kind in _AT_BEGIN]
    any_name, begin = _any_of(own), _any_of(begins)
    replaced = re.findall(rf"^(?:{any_name})(?=_shaft_torque)|^(?:{begin})(?=_)|(?<=_of_)(?:{any_name})(?![^_])", last)
    for name in replaced:
        last = re.sub(rf"(?<![^_]){re.escape(name)}(?![^_])", own[name], last)
    used = {name for name in (*parts, *replaced) if own.get(name, "NAME") != "NAME"}
    words = re.sub(
        rf"(?<!\w)((?:{_BEFORE_NAMES}) )?({any_name})(?!\w){_NOT_A_NAME}",
        lambda found: (found[1] or "") + own[found[2]] if found[1] or found[2] in used else found[0],
        words,
    )
    words = re.sub(r"[\d.]+(?:st|nd|rd|th)(?=-order)", "Nth", words)
    names = [re.sub(numbered, "N", part) for part in (*(own.get(part, part) for part in parts), last)]
    if names[-1] != last or "mode_N" in names:
        words = re.sub(r"(?<!from) \d+(?=\b)", " N", words)
    return owner, Family(".".join(names), quantity.units, words, curve)


def _any_of(names: Iterable[str]) -> str:
    """A pattern for any of some names, motor_shaft before motor; for nothing without names."""
    return "|".join(map(re.escape, sorted(names, key=len, reverse=True))) or r"(?!)"
