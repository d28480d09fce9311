"""Linkages of PMKS+, whose addresses encode a whole linkage.

Sections separated by full stops follow the question mark: switches, decimals, integers, choices, joints, an empty
section, links, an empty section, then forces and others, which are ignored. Numbers are base-64 integers with a leading
zero if negative; decimals are in thousandths. Switches are the bits of such an integer, lowest first. The last
character is the length of everything before it, modulo 62.
"""

import re
from typing import NamedTuple
from urllib.parse import unquote

from sweeps.imports.chain import Chain, GuidedOnFrame, LinkageError

_DIGITS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-"
_IN_CHECK = 62
_ADDRESS = re.compile(r"(?:\S*\?)?([\w-]+\.[\w,-]*\.[\w-]*,[\w,-]*\.[0-9]+\.\S+)")
# Length units by choice [m].
_UNITS = (0.0254, 0.01, 1.0)
_PRISMATIC, _INPUT, _GROUNDED = 1, 2, 4


class _Joint(NamedTuple):
    """A joint: name, position in the address's unit, angle of its guide [rad], switches."""

    name: str
    place: complex
    angle: float
    switches: int


def is_pmks_plus_address(text: str) -> bool:
    """Whether a text looks like a PMKS+ address, or the part after its question mark."""
    return _ADDRESS.fullmatch(unquote(text.strip())) is not None


class PmksPlusAddress:
    """A PMKS+ address.

    Raises
    ------
    LinkageError
        The address is damaged or in an older format.
    """

    def __init__(self, text: str) -> None:
        whole = _ADDRESS.fullmatch(unquote(text.strip()))[1]
        if _DIGITS[(len(whole) - 1) % _IN_CHECK] != whole[-1]:
            raise LinkageError("the address is incomplete: its check character doesn't match its length; copy it again")
        self.switches, _, self.integers, self.choices, *sections = whole[:-1].split(".")
        if "" not in sections:
            raise LinkageError("the address ends within its joints; copy it again")
        end = sections.index("")
        rest = sections[end + 1 :]
        self.joints = dict(self._joint(section) for section in sections[:end])
        self.links = [self._link(section) for section in rest[: rest.index("") if "" in rest else len(rest)]]

    def _integer(self, text: str, signed: bool = True) -> int:
        value = 0
        for digit in text:
            if digit not in _DIGITS:
                raise LinkageError(f"{text!r} is not a number in the notation of PMKS+ addresses")
            value = value * len(_DIGITS) + _DIGITS.index(digit)
        return -value if signed and len(text) > 1 and text[0] == "0" else value

    def _joint(self, section: str) -> tuple[str, _Joint]:
        first, *others = section.split(",")
        if len(others) == 3:
            raise LinkageError("the format is too old; open it in PMKS+ and share it again")
        if len(others) != 4 or not first:
            raise LinkageError(f"joint {section!r} is not supported; supported: joints, and sliders on the frame")
        x, y, angle = (self._integer(part) / 1000 for part in others[1:])
        return first[1:], _Joint(others[0], complex(x, y), angle, self._integer(first[0], signed=False))

    def _link(self, section: str) -> tuple[str, bool, list[str]] | None:
        """Name, whether it is a slider block, and joints; None for a link that is part of another."""
        head, _, tail = section.partition(",")
        parts = tail.split(",")
        if len(head) < 3 or len(parts) < 7 or "" not in parts[6:]:
            raise LinkageError(f"link {section!r} isn't complete; copy the address again")
        joints = parts[6 : parts.index("", 6)]
        missing = [joint for joint in joints if joint not in self.joints]
        if missing:
            raise LinkageError(f"link {parts[0]!r} has a joint {missing[0]!r} that is not in the address")
        return (parts[0], head[1] == "P", joints) if head[0] == "Y" else None

    def chain(self, unit: float | None, speed: str | None) -> Chain:
        """Linkage of the address; masses and forces are ignored.

        Parameters
        ----------
        unit : float, optional
            Length unit [m] (default: as in the address).
        speed : str, optional
            Crank speed with unit (default: as in the address).

        Raises
        ------
        LinkageError
            The address is damaged, or its linkage can't be converted to a scene.
        """
        choice = int(self.choices[0])
        if unit is None and choice >= len(_UNITS):
            raise LinkageError(f"unknown length unit (choice {choice}); give --unit")
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
                raise LinkageError(f"slider {name!r} is not on a single guide of the frame; not supported")
            links[name] = [names[j] for j in joints if not self.joints[j].switches & _PRISMATIC]
        hinges = {names[key]: joint for key, joint in self.joints.items() if not joint.switches & _PRISMATIC}
        places = {name: size * joint.place for name, joint in hinges.items()}
        frame = [name for name, joint in hinges.items() if joint.switches & _GROUNDED]
        crank, pivot = self._driver(links, names)
        return Chain("Linkage", places, links, frame, slides, crank, pivot, speed)

    def _names(self) -> dict[str, str]:
        """Joint names by the labels that links use."""
        given = [joint.name for joint in self.joints.values()]
        unique = len(set(given)) == len(given)
        return {key: joint.name if unique else key for key, joint in self.joints.items()}

    def _driver(self, links: dict[str, list[str]], names: dict[str, str]) -> tuple[str, str]:
        """The crank and its joint on the frame."""
        drivers = [key for key, joint in self.joints.items() if joint.switches & _INPUT]
        if len(drivers) != 1:
            raise LinkageError(f"it has {len(drivers)} inputs; a scene has one")
        found = self.joints[drivers[0]]
        cranks = [name for name, joints in links.items() if names[drivers[0]] in joints]
        if found.switches & _PRISMATIC or not found.switches & _GROUNDED or len(cranks) != 1:
            raise LinkageError("the input is not a joint of one link and the frame; it must be a crank")
        return cranks[0], names[drivers[0]]
