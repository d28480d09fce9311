"""Scene texts of synthesised mechanisms, with requirements and results as comments."""

import math

from engine import quantity_text, table_unit
from sweeps.synthesis.paths import PathFourBar
from sweeps.synthesis.positioned import PositionedFourBar
from sweeps.synthesis.quick_return import QuickCrankRocker, QuickLever, QuickSliderCrank

_NEXT = """\
# Kinematics only: add [bodies], [forces] and [flywheel]; see `sweeps help bodies`.
"""


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
    return f"""\
# Offset slider-crank with a stroke of {quantity_text(stroke, "m")} and a quick-return ratio of {ratio!r}.
# Minimum transmission angle {_deg(found.least_transmission)}, between the rod and the normal of the guide.
{_NEXT}
title = "Slider-crank, quick-return ratio {ratio!r}"

[points]
O = {{ x = 0, y = 0 }}           # bearing of the crank

[guides]
way = {{ angle = 0 }}

{_crank(found.crank, speed)}

[groups.drive]
type = "RRP"
inner = "B"
first = {{ link = "rod", joint = "A", length = "{_length(found.rod)}" }}
second = {{ link = "slider", guide = "way", offset = "{_length(found.offset)}" }}
"""


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
    return f"""\
# Crank-rocker with a swing of {_deg(swing)} and a quick-return ratio of {ratio!r} (slow swing to fast one).
# Minimum transmission angle {_deg(found.least_transmission)}.
{_NEXT}
title = "Crank-rocker, quick-return ratio {ratio!r}"

[points]
O = {{ x = 0, y = 0 }}           # bearing of the crank
D = {{ x = "{_length(found.frame)}", y = 0 }}           # bearing of the rocker

{_crank(found.crank, speed)}

{_dyad(found)}
"""


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
    height = 0.5 * found.lever * (1.0 + cosine)
    drag_link = found.lever * max(0.4, 0.625 * (1.0 - cosine) / cosine)
    return f"""\
# Crank-shaper with a stroke of {quantity_text(stroke, "m")} and a quick-return ratio of {ratio!r}.
# The lever swings by {_deg(found.swing)}. A longer drag link doesn't affect stroke and ratio.
{_NEXT}
title = "Crank-shaper, quick-return ratio {ratio!r}"

[points]
D = {{ x = 0, y = 0 }}           # bearing of the lever
O = {{ x = 0, y = "{_length(found.frame)}" }}           # bearing of the crank
P = {{ link = "lever", x = "{_length(found.lever)}", y = 0 }}           # end of the lever

[guides]
way = {{ y = "{_length(height)}", angle = "180 deg" }}

{_crank(found.crank, speed)}

[groups.slot]
type = "RPR"
first = {{ link = "block", joint = "A" }}
second = {{ link = "lever", joint = "D" }}

[groups.drive]
type = "RRP"
inner = "B"
first = {{ link = "drag_link", joint = "P", length = "{_length(drag_link)}" }}
second = {{ link = "ram", guide = "way" }}
"""


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
    part = ""
    if not found.turns:
        part = f'start = "{_deg(min(first, last))}"\nstop = "{_deg(max(first, last))}"\n'
    how = "turns fully" if found.turns else "can't turn fully: it moves from the first position to the last"
    return f"""\
# Four-bar linkage whose coupler carries the point P through {len(found.crank_angles)} positions, at the crank angles
# {at}.
# The plane is rotated relative to the coupler by {_deg(found.angle)}. The crank {how}.
# Minimum transmission angle {_deg(found.least_transmission)}.
{_NEXT}
title = "Four-bar linkage through {len(found.crank_angles)} positions"

[points]
O = {{ {_xy(found.crank_pivot)} }}           # bearing of the crank
D = {{ {_xy(found.rocker_pivot)} }}           # bearing of the rocker
P = {{ link = "coupler", {_xy(found.point)} }}

{_crank(found.crank, f"{sense}{speed}")}
{part}
{_dyad(found)}
mode = {found.mode}
"""


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
    return f"""\
# Crank-rocker whose coupler point P follows a path of {places} points: deviation {quantity_text(found.rms, "m")}
# (rms) and {quantity_text(found.greatest, "m")} (maximum). `sweeps plot FILE --paths P` draws its path.
{_NEXT}
title = "Crank-rocker along a path"

[points]
O = {{ {_xy(found.crank_pivot)} }}           # bearing of the crank
D = {{ {_xy(found.rocker_pivot)} }}           # bearing of the rocker
P = {{ link = "coupler", {_xy(found.point)} }}

{_crank(found.crank, speed)}

{_dyad(found)}
mode = {found.mode}
"""


def _crank(length: float, speed: str) -> str:
    return f"""\
[input]
type = "crank"
pivot = "O"
pin = "A"
length = "{_length(length)}"
speed = "{speed}\""""


def _dyad(found: QuickCrankRocker | PositionedFourBar | PathFourBar) -> str:
    return f"""\
[groups.swing]
type = "RRR"
inner = "B"
first = {{ link = "coupler", joint = "A", length = "{_length(found.coupler)}" }}
second = {{ link = "rocker", joint = "D", length = "{_length(found.rocker)}" }}"""


def _length(length: float) -> str:
    """A length to fifteen digits."""
    size, unit = table_unit("m")
    return f"{length / size:.15g} {unit}"


def _deg(angle: float) -> str:
    return f"{math.degrees(angle)!r} deg"


def _xy(point: complex) -> str:
    return f'x = "{_length(point.real)}", y = "{_length(point.imag)}"'
