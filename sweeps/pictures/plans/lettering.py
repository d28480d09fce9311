"""Symbols as plans are lettered with them, in matplotlib's mathematical text."""

import re


def subscript(*names: str) -> str:
    """Names of points or links as an index: BA for short ones, pin,B for longer ones."""
    found = [_upright(name) for name in names]
    return ("" if all(len(name.rstrip("'")) == 1 for name in names) else ",").join(found)


def _upright(name: str) -> str:
    stem = name.rstrip("'")
    primes = name[len(stem) :]
    if len(stem) > 1:
        stem = r"\mathrm{" + stem.replace("_", r"\_") + "}"
    return stem + primes


def symbol(letter: str, index: str, power: str = "") -> str:
    """A letter with an index and what stands above it."""
    above = rf"^{{{power}}}" if power else ""
    return f"${letter}{above}_{{{index}}}$"


def numbered(letter: str, *numbers: int, before: str = "", power: str = "") -> str:
    """A letter with numbers of links as index: R12, or R1,12 where one has two digits; `before` them and above it."""
    return symbol(letter, before + ("" if all(n < 10 for n in numbers) else ",").join(map(str, numbers)), power)


def image_name(name: str) -> str:
    """Lettering of a point's image: its name in small letters."""
    centre = re.fullmatch(r"S(\d+)(?:_(\d+))?", name)
    if centre:
        second = f",{centre[2]}" if centre[2] else ""
        return f"$s_{{{centre[1]}{second}}}$"
    stem = name.rstrip("'")
    return f"${_upright(stem.lower() if len(stem) <= 2 else stem)}{name[len(stem) :]}$"
