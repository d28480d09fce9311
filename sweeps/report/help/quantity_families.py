"""The quantities of all kinds of machines, as families such as GROUP.transmission_angle."""

import re
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from engine import Quantity, Scene, definitions_of_names, element_kinds, made_ready
from sweeps.study.bundled import bundled_studies
from sweeps.study.study_reader import read_study
from sweeps.text.scene_text import read_scene, scene_from
from sweeps.text.templates import bundled_templates, template_text
from sweeps.text.toml_text import parse_toml

MACHINE = "Machine"
# Tables of a scene, and what a name of theirs is called in a family.
_TABLES = {
    **{"groups": "GROUP", "bodies": "BODY", "cams": "CAM", "forces": "FORCE", "moments": "MOMENT", "springs": "SPRING"},
    **{"cylinders": "CYLINDER", "pins": "PIN", "struts": "STRUT", "wanted": "WANTED", "couplings": "COUPLING"},
    **{"regimes": "REGIME", "elements": "NAME"},
}
# A name of a part is also a word of meanings: the angle of any crank.
_NOT_A_NAME = r"(?! angle| speed| torque| force|'s)"
_BEFORE_NAMES = "link|slider|joint|guide|body|group|shaft|point|on|about|with|path of|torque of"
# Kinds whose names begin words of a regime, as in start.motor_shaft_final_speed.
_AT_BEGIN = ("SHAFT", "COUPLING")
# What no bundled machine has, for the slider-crank; once with each coupling.
_RARE = """
pins.wrist = { pair = "drive.inner", diameter = "20 mm", width = "30 mm" }
struts.con_rod = { link = "rod", diameter = "18 mm", material = "S235" }
wanted.curve = { type = "path", point = "B", x = ["150 mm", "160 mm"], y = [0, 0] }
wanted.law = { type = "link", of = "rod", over_angle = [0, "90 deg"], angle = [0, "9 deg"] }
shafts.rotor = { geared_to = "crank", ratio = 3, inertia = "1 kg m2" }
moments.drive_motor = { type = "dc_motor", on = "rotor", stall_moment = "50 N m", no_load_speed = "1000 rpm" }
regimes.work = { type = "steady" }
regimes.couple = { type = "run", time = "1 s" }
elements.watt = { type = "watt_governor", ball_mass = "5 kg", upper_arm = "0.3 m", lower_arm = "0.3 m", \
least_radius = "0.1 m", greatest_radius = "0.2 m" }
elements.proell = { type = "proell_governor", ball_mass = "5 kg", sleeve_mass = "9 kg", upper_arm = "0.3 m", \
lower_arm = "0.3 m", extension = "0.1 m", parallel_radius = "0.15 m", \
least_radius = "0.15 m", greatest_radius = "0.2 m" }
elements.measured = { type = "table_governor", ball_mass = "5 kg", over_radius = ["0.1 m", "0.2 m"], \
controlling_force = ["9 N", "20 N"], interpolation = "linear", least_radius = "0.1 m", greatest_radius = "0.2 m", \
lift_ratio = 1 }
elements.chain = { type = "chain_drive", pitch = "8 mm", driving_teeth = 9, driven_teeth = 9, speed = "9 rpm", \
moment = "1 N m", distance = "1 m", linear_density = "1 kg/m" }
elements.wheels = { type = "friction_drive", driving_diameter = "1 m", driven_diameter = "1 m", friction = 0.2, \
speed = "9 rpm", moment = "1 N m", press_force = "9 N" }
elements.axle = { type = "locomotive", cylinder_spacing = "1 m", wheel_spacing = "2 m", stroke = "1 m", \
reciprocating_mass = "1 kg", balance_radius = "1 m", speed = "9 rpm", crank_angle = 0 }
elements.lever = { type = "rotating_guide", mass = "1 kg", speed = "9 rpm", start_radius = "1 m", length = "2 m" }
elements.disc = { type = "static_rotor", unbalances = { a = { mass = "1 kg", radius = "1 m" } }, mass = "9 kg", \
correction_radius = "1 m", rolling_arm = "1 mm", speed = "9 rpm" }
elements.tie = { type = "tethered_body", mass = "1 kg", length = "1 m", stiffness = "9 N/m", strength = "9 N", \
speed = "1 m/s" }
elements.egg = { type = "tilted_body", mass = "1 kg", semi_axis_x = "1 m", semi_axis_y = "1 m", semi_axis_z = "1 m", \
speed = "9 rpm" }
elements.tape = { type = "wound_flywheel", bore = "1 m", winding_diameter = "2 m", diameter = "3 m", width = "1 m", \
density = "7850 kg/m3", winding_stress = "9 MPa", speed = "9 rpm", strength = "90 MPa" }
"""
_COUPLINGS = (
    'couplings.joint = { type = "friction_clutch", shaft = "rotor", capacity = "50 N m" }',
    'couplings.joint = { type = "fluid_coupling", shaft = "rotor", diameter = "0.2 m", density = "860 kg/m3", '
    'slip = [0, 1], coefficient = [0, 0.02], interpolation = "linear" }',
)


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
    for kind, model in element_kinds().items():
        for result in model.RESULTS:
            family = Family(f"NAME.{result.name}", result.units, result.long_name, False)
            found.setdefault(f"Element {kind}", {}).setdefault(family.name, family)
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
    for coupling in _COUPLINGS:
        text = f"{_RARE}{coupling}\n{template_text('slider_crank')}"
        yield scene_from(parse_toml(text, simplest.name), text, simplest.name, simplest.parent)


def _kinds_of_names(scene: Scene) -> dict[str, str]:
    """What each name of a scene is called in a family."""
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
