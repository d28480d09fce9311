"""Symbols in plans, as Matplotlib mathtext."""

import re

import numpy as np

from engine import display_unit


def subscript(*names: str) -> str:
    """Names of points or links as a subscript: BA for short ones, pin,B for longer ones."""
    found = [_upright(name) for name in names]
    return ("" if all(len(name.rstrip("'")) == 1 for name in names) else ",").join(found)


def _upright(name: str) -> str:
    stem = name.rstrip("'")
    primes = name[len(stem) :]
    if len(stem) > 1:
        stem = r"\mathrm{" + stem.replace("_", r"\_") + "}"
    return stem + primes


def symbol(letter: str, index: str, power: str = "") -> str:
    """A letter with subscript and superscript."""
    above = rf"^{{{power}}}" if power else ""
    return f"${letter}{above}_{{{index}}}$"


def numbered(letter: str, *numbers: int, before: str = "", power: str = "") -> str:
    """A letter with link numbers as subscript: R12, or R1,12 for two-digit numbers."""
    return symbol(letter, before + ("" if all(n < 10 for n in numbers) else ",").join(map(str, numbers)), power)


def size_text(size: float, unit: str) -> str:
    """A magnitude to four digits in a practical unit."""
    factor, label = display_unit(unit, np.array([size]))
    return f"{factor * size:.4g} {label}"


def image_name(name: str) -> str:
    """Label of a point's image: its name in lower case."""
    centre = re.fullmatch(r"S(\d+)(?:_(\d+))?", name)
    if centre:
        second = f",{centre[2]}" if centre[2] else ""
        return f"$s_{{{centre[1]}{second}}}$"
    stem = name.rstrip("'")
    return f"${_upright(stem.lower() if len(stem) <= 2 else stem)}{name[len(stem) :]}$"
