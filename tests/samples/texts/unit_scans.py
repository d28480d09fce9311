"""Texts searched for units of another system than their own."""

import re
from pathlib import Path

METRIC = "mm cm km µm kg g t N kN MN J kJ MJ W kW MW Pa kPa MPa GPa bar kp kgf m"
AMERICAN = "in ft yd lb lbs oz slug lbf kip klbf tonf psi ksi hp"
BANNED = {"US": METRIC, "mm": AMERICAN, "SI": f"{AMERICAN} mm kN kJ kW MPa rpm"}


def units_of(words: str) -> re.Pattern[str]:
    """A unit after a number, a comma or a gap, in brackets, or in a compound: "3 kN", "v, m/s", "[N m]", "N·m".

    A letter before a comma is a symbol: "W, ft·lbf" is work.
    """
    power, units = r"(?:-?[2-9]|[²³⁴])?", words.split()
    plain = "|".join(unit for unit in units if unit not in ("in", "m", "t", "g"))
    return re.compile(
        rf"(?:(?<=\d )|(?<=, )|(?<=  )|(?<=[·/(])|^(?!\w, ))(?:{'|'.join(units)}){power}(?=$|  |[;:,.)\]·/|])"
        rf"|(?<=\d )(?:{plain}){power}(?= )|\[(?:[^\]]* )?(?:{'|'.join(units)})(?:-?\d)?(?: [^\]]*)?\]"
    )


def foreign(text: str, system: str) -> list[str]:
    """Lines with a unit that the system doesn't have."""
    pattern = units_of(BANNED[system])
    return [line for line in text.splitlines() if pattern.search(line)]


def words_of_page(page: Path) -> str:
    """What a page says, apart from its pictures, scripts and quoted texts."""
    shown = re.sub(r"<(script|style|svg|pre)\b.*?</\1>", "", page.read_text(encoding="utf8"), flags=re.S)
    return re.sub(r"<[^>]+>", "\n", shown)
