"""Sheets of plans: the mechanism at a position, its plan, and the values."""

from collections.abc import Iterator
from textwrap import fill

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text

from engine import FRAME, Scene
from sweeps.pictures.plans.forces.force_plan import force_lines, force_plan
from sweeps.pictures.plans.forces.free_body import free_body, height_of_body
from sweeps.pictures.plans.kinematic_plans import draw_plan, plan_lines
from sweeps.pictures.plans.lettering import subscript
from sweeps.pictures.plans.mechanism_plan import mechanism_plan
from sweeps.pictures.plans.polygons import VectorPlan, accelerations, velocities
from sweeps.pictures.plans.pose import Pose
from sweeps.pictures.style import MM_PER_INCH, Sheet, house_style, titled

WIDTH, HEIGHT = 180.0, 130.0
HEADING = 8.0
# A free body at most [mm].
HIGHEST = 74.0
# Characters per line of a note at that width.
LINE = 150


def blank_sheet(height: float) -> Figure:
    """An empty sheet of a height [mm] with fixed axes."""
    return Sheet(figsize=(WIDTH / MM_PER_INCH, height / MM_PER_INCH))


def place(figure: Figure, left: float, bottom: float, width: float, height: float, **kind: str) -> Axes:
    """Axes at a position on a sheet [mm]."""
    w, h = figure.get_size_inches() * MM_PER_INCH
    return figure.add_axes((left / w, bottom / h, width / w, height / h), **kind)


def write(figure: Figure, left: float, top: float, text: str, **look: object) -> None:
    """Text below and to the right of a position on a sheet [mm]."""
    w, h = figure.get_size_inches() * MM_PER_INCH
    figure.add_artist(Text(left / w, top / h, text, ha="left", va="top", **look))


def heading(figure: Figure, scene: Scene, what: str) -> None:
    """Title of a sheet."""
    top = figure.get_figheight() * MM_PER_INCH - 3
    write(figure, 4, top, titled(scene.title, what), fontsize=10, fontweight="bold", parse_math=False)


def links_line(pose: Pose) -> str:
    """The link numbers as text."""
    return ", ".join(f"{n} {link}" for link, n in pose.motion.link_numbers.items() if link != FRAME)


def columns(lines: list[str], rows: int) -> list[str]:
    """Lines in columns of limited height."""
    return ["\n".join(lines[i : i + rows]) for i in range(0, len(lines), rows)]


def kinematic_sheet(pose: Pose, which: str) -> Figure:
    """Sheet of the "velocity" or "acceleration" plan with the mechanism, 180 mm wide.

    Parameters
    ----------
    pose : Pose
    which : {"velocity", "acceleration"}
    """
    with house_style():
        plan = (velocities if which == "velocity" else accelerations)(pose)
        under = [f"${subscript(n)}$ on {pose.number(link)}" for n, link in plan.under.items()]
        notes = fill(f"links: {links_line(pose)}", LINE).splitlines()
        notes += [f"coincident points: {', '.join(under)}"] * bool(under)
        if plan.special:
            points = ", ".join(f"${subscript(s.name)}$ on {pose.number(s.link)}" for s in plan.special)
            notes.append(f"special points of Assur: {points}")
        notes += _of_places(plan)
        lines = plan_lines(pose, plan)
        # Values that don't fit next to the plan go in a strip below.
        few = len(lines) <= 33
        rows = 11 if few else -(-len(lines) // 6)
        strip = 3.2 * max(0, len(notes) - 2) + (0.0 if few else 9.5 + 3.5 * rows)
        figure = blank_sheet(HEIGHT + strip)
        heading(figure, pose.scene, f"{which} plan at {pose.title}")
        mechanism_plan(pose, place(figure, 2, 54 + strip, 76, HEIGHT - HEADING - 54), plan.special, plan.places)
        draw_plan(plan, place(figure, 80, 2 + strip, 98, HEIGHT - HEADING - 2))
        for i, text in enumerate(columns(lines, rows)):
            at = (4 + 26 * i, 52 + strip) if few else (4 + 29 * i, strip)
            write(figure, *at, text, fontsize=6.5, linespacing=1.4)
        write(figure, 4, 4 + 3.2 * len(notes), "\n".join(notes), fontsize=6.5)
    return figure


_PLACES = {
    "P": "pitch points",
    "B": "centres of rollers, or edges",
    "C": "centres of curvature of profiles",
    "A": "origins of sliders without points",
}


def _of_places(plan: VectorPlan) -> Iterator[str]:
    """Kinds of the points that the scene doesn't name."""
    for letter, words in _PLACES.items():
        names = [f"${subscript(name)}$" for name in plan.places if name[0] == letter]
        if names:
            yield f"{words}: {', '.join(names)}"


def force_sheet(pose: Pose, of: str) -> Figure:
    """Sheet of a group's or link's force polygon with its free bodies, 180 mm wide.

    Parameters
    ----------
    pose : Pose
    of : str
        A group or a moving link.
    """
    links = pose.motion.groups.get(of, (of,))
    rows = -(-len(links) // 2)
    # A single link has the polygon on its right.
    width, columns_of_text, alone = 88, 5, len(links) == 1
    # With more than two links the values go in a strip below the plan.
    strip = 40 * -(-len(links) // columns_of_text) if len(links) > 2 else 0
    high = [height_of_body(pose, link, width, HIGHEST) for link in links]
    heights = [max(high[2 * i : 2 * i + 2]) for i in range(rows)]
    plan = (66, 9 + strip, 112, 88)
    if alone:
        heights = [max(*heights, 88)]
        plan = (2 + width, 62, width, heights[0])
    top = (62 if alone else 98) + strip + sum(heights) + 3 * rows
    with house_style():
        figure = blank_sheet(top + 10)
        heading(figure, pose.scene, f"forces on {of} at {pose.title}")
        for i, link in enumerate(links):
            height = heights[i // 2]
            left, bottom = 2 + i % 2 * width, top - sum(heights[: i // 2 + 1]) - 3 * (i // 2 + 1)
            loads = free_body(pose, link, place(figure, left, bottom, width, height))
            write(figure, left + 3, bottom + height + 3, f"{pose.number(link)} {link}", fontsize=8, fontweight="bold")
            text = "\n".join(force_lines(loads))
            row, column = divmod(i, columns_of_text)
            at = (72, 58) if alone else (4 + 33 * column, 46 if not strip else strip + 8 - 40 * row)
            write(figure, *at, f"on {link}:\n{text}", fontsize=6.5, linespacing=1.4)
        mechanism_plan(pose, place(figure, 2, 10 if alone else 48 + strip, 62, 50))
        force_plan(pose, of, place(figure, *plan))
        notes = [
            *fill(f"links: 0 frame, {links_line(pose)}", LINE).splitlines(),
            "$R_{12}$: force of link 1 on link 2; $G$ weight, $U$ inertia force; ∠ from the x axis, counter-clockwise. "
            "Arrows on links are not to scale.",
        ]
        if pose.scene.friction:
            notes.insert(0, r"$F_{\mathrm{f}12}$: friction in a guide; $\rho_{12}$: radius of the friction circle")
        write(figure, 4, 1.6 + 3.2 * len(notes), "\n".join(notes), fontsize=6.5)
    return figure
