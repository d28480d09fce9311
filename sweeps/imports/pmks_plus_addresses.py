"""Linkages of PMKS+, whose addresses hold a whole linkage in letters and digits.

After the question mark stand sections with full stops between them: switches, decimals, integers, choices, then the
joints, an empty section, the links, an empty section, and forces and others that are ignored. Numbers are integers
to base 64 with a leading zero where they are negative, decimals of them thousandths. Switches are the bits of such an
integer, the lowest first. The last character is the length of all before it modulo 62.
"""

import re
from typing import NamedTuple
from urllib.parse import unquote

from sweeps.imports.chain import Chain, GuidedOnFrame
from sweeps.text.input_files import InputError

_DIGITS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-"
_IN_CHECK = 62
_ADDRESS = re.compile(r"(?:\S*\?)?([\w-]+\.[\w,-]*\.[\w-]*,[\w,-]*\.[0-9]+\.\S+)")
# What the choice of a unit of length stands for [m].
_UNITS = (0.0254, 0.01, 1.0)
_PRISMATIC, _INPUT, _GROUNDED = 1, 2, 4


class _Joint(NamedTuple):
    """A joint: its name, where it is in the address's unit, the angle of its guide [rad], and its switches."""

    name: str
    place: complex
    angle: float
    switches: int


def is_pmks_plus_address(text: str) -> bool:
    """Whether a text looks like an address of PMKS+, or what stands after its question mark."""
    return _ADDRESS.fullmatch(unquote(text.strip())) is not None


def pmks_plus_chain(text: str, source: str, unit: float | None, speed: str | None) -> Chain:
    """Linkage of an address of PMKS+; its masses and forces are left out.

    Parameters
    ----------
    text : str
        The address.
    source : str
        Name of the file, for messages.
    unit : float, optional
        What its unit of length is [m]; what the address says unless given.
    speed : str, optional
        Of the crank, with its unit; that of the address unless given.

    Raises
    ------
    InputError
        The address is damaged or of an older form, or its linkage isn't one that becomes a scene.
    """
    return _Address(text, source).chain(unit, speed)


class _Address:
    def __init__(self, text: str, source: str) -> None:
        self.source = source
        whole = _ADDRESS.fullmatch(unquote(text.strip()))[1]
        if _DIGITS[(len(whole) - 1) % _IN_CHECK] != whole[-1]:
            raise self._refused("the address isn't whole: its last character doesn't fit its length; copy it again")
        self.switches, _, self.integers, self.choices, *sections = whole[:-1].split(".")
        if "" not in sections:
            raise self._refused("the address has no end of its joints; copy it again")
        end = sections.index("")
        rest = sections[end + 1 :]
        self.joints = dict(self._joint(section) for section in sections[:end])
        self.links = [self._link(section) for section in rest[: rest.index("") if "" in rest else len(rest)]]

    def _refused(self, message: str) -> InputError:
        return InputError(self.source, [(None, "", message)])

    def _integer(self, text: str, signed: bool = True) -> int:
        value = 0
        for digit in text:
            if digit not in _DIGITS:
                raise self._refused(f"{text!r} is not a number in the notation of PMKS+ addresses")
            value = value * len(_DIGITS) + _DIGITS.index(digit)
        return -value if signed and len(text) > 1 and text[0] == "0" else value

    def _joint(self, section: str) -> tuple[str, _Joint]:
        first, *others = section.split(",")
        if len(others) == 3:
            raise self._refused("it is of an older form; open it in PMKS+ and share it again")
        if len(others) != 4 or not first:
            raise self._refused(f"joint {section!r} isn't read; joints and sliders on the frame are")
        x, y, angle = (self._integer(part) / 1000 for part in others[1:])
        return first[1:], _Joint(others[0], complex(x, y), angle, self._integer(first[0], signed=False))

    def _link(self, section: str) -> tuple[str, bool, list[str]] | None:
        """Name, whether it is a slider's block, and joints; None for a link that is part of another."""
        head, _, tail = section.partition(",")
        parts = tail.split(",")
        if len(head) < 3 or len(parts) < 7 or "" not in parts[6:]:
            raise self._refused(f"link {section!r} isn't complete; copy the address again")
        joints = parts[6 : parts.index("", 6)]
        missing = [joint for joint in joints if joint not in self.joints]
        if missing:
            raise self._refused(f"link {parts[0]!r} has a joint {missing[0]!r} that the address doesn't hold")
        return (parts[0], head[1] == "P", joints) if head[0] == "Y" else None

    def chain(self, unit: float | None, speed: str | None) -> Chain:
        """The linkage."""
        choice = int(self.choices[0])
        if unit is None and choice >= len(_UNITS):
            raise self._refused(f"its unit of length, choice {choice}, isn't known; give --unit")
        size = _UNITS[choice] if unit is None else unit
        if speed is None:
            turns = abs(self._integer(self.integers.partition(",")[0])) or 60
            speed = f"{-turns if self._integer(self.switches, signed=False) & 1 else turns} rpm"
        names = self._names()
        links, slides = {}, {}
        for name, is_block, joints in filter(None, self.links):
            guides = [self.joints[joint] for joint in joints if self.joints[joint].switches & _PRISMATIC]
            if is_block and len(guides) == 1 and guides[0].switches & _GROUNDED:
                slides[name] = GuidedOnFrame(size * guides[0].place, guides[0].angle)
            elif is_block or guides:
                raise self._refused(f"slider {name!r} isn't on one guide of the frame; it isn't read")
            links[name] = [names[j] for j in joints if not self.joints[j].switches & _PRISMATIC]
        hinges = {names[key]: joint for key, joint in self.joints.items() if not joint.switches & _PRISMATIC}
        places = {name: size * joint.place for name, joint in hinges.items()}
        frame = [name for name, joint in hinges.items() if joint.switches & _GROUNDED]
        crank, pivot = self._driver(links, names)
        return Chain(self.source, "Linkage", places, links, frame, slides, crank, pivot, speed)

    def _names(self) -> dict[str, str]:
        """What the joints are called, by what the links call them."""
        given = [joint.name for joint in self.joints.values()]
        unique = len(set(given)) == len(given)
        return {key: joint.name if unique else key for key, joint in self.joints.items()}

    def _driver(self, links: dict[str, list[str]], names: dict[str, str]) -> tuple[str, str]:
        """The crank and its joint on the frame."""
        drivers = [key for key, joint in self.joints.items() if joint.switches & _INPUT]
        if len(drivers) != 1:
            raise self._refused(f"it has {len(drivers)} inputs; a scene has one")
        found = self.joints[drivers[0]]
        cranks = [name for name, joints in links.items() if names[drivers[0]] in joints]
        if found.switches & _PRISMATIC or not found.switches & _GROUNDED or len(cranks) != 1:
            raise self._refused("its input isn't the joint of one link and the frame; a crank must be the input")
        return cranks[0], names[drivers[0]]
