"""Linkages of PMKS, the Planar Mechanism Kinematic Simulator: one row per joint, in a file or an address."""

import math
import re
from urllib.parse import unquote

from sweeps.imports.chain import Chain, GuidedOnFrame, LinkageError

_TYPES = ("R", "P", "RP", "G")
_FLAGS = re.compile("[tf]{4}", re.IGNORECASE)


def pmks_chain(text: str, unit: float, speed: str) -> Chain:
    """Linkage of PMKS: rows "link, link, R, x, y", "link, ground, P, x, y, angle" in degrees.

    Parameters
    ----------
    text : str
        A file, or an address with `mech=` whose rows end at |.
    unit : float
        Length unit [m].
    speed : str
        Crank speed with unit.

    Raises
    ------
    LinkageError
        The text isn't PMKS, or its linkage can't be converted to a scene.
    """
    if "mech=" in text:
        text = unquote(text.partition("mech=")[2]).partition("&")[0]
    rows = [row for row in re.split(r"[|\n\r]+", text) if row.strip() and "=" not in row]
    joints: dict[str, complex] = {}
    links: dict[str, list[str]] = {}
    frame: list[str] = []
    slides: dict[str, GuidedOnFrame] = {}
    drivers: list[tuple[str, str]] = []
    first: tuple[str, str] | None = None
    for number, row in enumerate(rows, 1):
        parts = [part for part in re.split(r"[,\s]+", row.strip()) if part]
        kind = next((i for i, part in enumerate(parts) if part.upper() in _TYPES and i > 0), None)
        if kind is None or len(parts) < kind + 3:
            raise LinkageError(f"row {number}, {row.strip()!r}: needs links, a type ({', '.join(_TYPES)}), x and y")
        names, letter = parts[:kind], parts[kind].upper()
        try:
            x, y, *angle = (float(part) for part in parts[kind + 1 :] if not _FLAGS.fullmatch(part))
        except ValueError:
            raise LinkageError(f"row {number}, {row.strip()!r}: x, y and the angle must be numbers") from None
        place = unit * complex(x, y)
        moving = [name for name in names if name.lower() != "ground"]
        if letter == "R":
            name = f"J{number}"
            joints[name] = place
            for link in moving:
                links.setdefault(link, []).append(name)
            if len(moving) < len(names):
                frame.append(name)
                first = first or ((moving[0], name) if moving else None)
        elif letter == "P" and len(moving) == 1 and len(names) == 2:
            slides[moving[0]] = GuidedOnFrame(place, math.radians(angle[0] if angle else 0.0))
            links.setdefault(moving[0], [])
        else:
            raise LinkageError(
                f"row {number}: {letter} of {' and '.join(names)} is not supported; use R, or P of a link and ground"
            )
        if any(_FLAGS.fullmatch(part) and part[3] in "tT" for part in parts[kind + 1 :]):
            if letter != "R" or len(moving) == len(names) or not moving:
                raise LinkageError(f"row {number}: the driver must be R of a link and ground (a crank)")
            drivers.append((moving[0], f"J{number}"))
    if len(drivers) > 1:
        raise LinkageError(f"it has {len(drivers)} drivers; a scene has one input")
    driver = drivers[0] if drivers else first
    if driver is None:
        raise LinkageError("no driver: mark a joint R of a link and ground")
    return Chain("Linkage", joints, links, frame, slides, *driver, speed)
