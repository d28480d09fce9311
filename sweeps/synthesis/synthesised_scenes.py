"""Scene texts of synthesised mechanisms, with requirements and results as comments."""

import math
from importlib.resources import files
from string import Template
from typing import NamedTuple

from engine import quantity_text, table_unit
from sweeps.synthesis.paths import PathFourBar
from sweeps.synthesis.positioned import PositionedFourBar
from sweeps.synthesis.quick_return import QuickCrankRocker, QuickLever, QuickSliderCrank

# Results that are angles; other numbers are lengths.
_ANGLES = ("least_transmission", "swing", "angle")


def slider_crank_text(found: QuickSliderCrank, stroke: float, ratio: float, speed: str) -> str:
    """Scene of an offset slider-crank.

    Parameters
    ----------
    found : QuickSliderCrank
    stroke, ratio : float
        Requirements [m, 1].
    speed : str
        Of the crank, with its unit.
    """
    return _filled("slider_crank", found, speed=speed, stroke=quantity_text(stroke, "m"), ratio=repr(ratio))


def crank_rocker_text(found: QuickCrankRocker, swing: float, ratio: float, speed: str) -> str:
    """Scene of a crank-rocker.

    Parameters
    ----------
    found : QuickCrankRocker
    swing, ratio : float
        Requirements [rad, 1].
    speed : str
        Of the crank, with its unit.
    """
    return _filled("crank_rocker", found, speed=speed, swing=_deg(swing), ratio=repr(ratio))


def lever_text(found: QuickLever, stroke: float, ratio: float, speed: str) -> str:
    """Scene of a crank-shaper: a slotted lever drives a ram through a drag link.

    The ram's guide is at mid-height of the lever end's rise, where the drag link tilts least. A drag link shorter than
    half that rise over cos ψ/2 would turn the ram back before the lever's swing ψ ends.

    Parameters
    ----------
    found : QuickLever
    stroke, ratio : float
        Requirements [m, 1].
    speed : str
        Of the crank, with its unit.
    """
    cosine = math.cos(0.5 * found.swing)
    height = _length(0.5 * found.lever * (1.0 + cosine))
    drag_link = _length(found.lever * max(0.4, 0.625 * (1.0 - cosine) / cosine))
    asked = {"speed": speed, "stroke": quantity_text(stroke, "m"), "ratio": repr(ratio)}
    return _filled("shaper", found, height=height, drag_link=drag_link, **asked)


def positions_text(found: PositionedFourBar, speed: str) -> str:
    """Scene of a four-bar linkage whose coupler passes through given positions.

    Parameters
    ----------
    found : PositionedFourBar
    speed : str
        Of the crank, with its unit; clockwise where it passes through the positions so.
    """
    first, last = found.crank_angles[0], found.crank_angles[-1]
    sense = "-" if last < first and not speed.startswith("-") else ""
    at = ", ".join(_deg(angle) for angle in found.crank_angles)
    part, how = "", "turns fully"
    if not found.turns:
        part = f'start = "{_deg(min(first, last))}"\nstop = "{_deg(max(first, last))}"\n'
        how = "can't turn fully: it moves from the first position to the last"
    shown = {"places": str(len(found.crank_angles)), "crank_angles": at, "part": part, "how": how}
    return _filled("positions", found, speed=f"{sense}{speed}", **shown)


def path_text(found: PathFourBar, places: int, speed: str) -> str:
    """Scene of a crank-rocker whose coupler point follows a path.

    Parameters
    ----------
    found : PathFourBar
    places : int
        Number of target points.
    speed : str
        Of the crank, with its unit.
    """
    apart = {"rms": quantity_text(found.rms, "m"), "maximum": quantity_text(found.greatest, "m")}
    return _filled("path", found, speed=speed, places=str(places), **apart)


def _filled(kind: str, found: NamedTuple, **further: str) -> str:
    """The scene of a kind, with the numbers found, and further texts or the same numbers in other words."""
    template = (files("sweeps.synthesis") / "scenes" / f"{kind}.txt").read_text("utf8")
    own = {name: _text(name, value) for name, value in found._asdict().items()}
    return Template(template).substitute(own, **further)


def _text(name: str, value: object) -> str:
    """A result as the scene's text has it."""
    match value:
        case complex():
            return f'x = "{_length(value.real)}", y = "{_length(value.imag)}"'
        case float():
            return _deg(value) if name in _ANGLES else _length(value)
    return str(value)


def _length(length: float) -> str:
    """A length to fifteen digits."""
    size, unit = table_unit("m")
    return f"{length / size:.15g} {unit}"


def _deg(angle: float) -> str:
    return f"{math.degrees(angle)!r} deg"
