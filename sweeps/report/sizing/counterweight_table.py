"""Report on counterweights of a mechanism: mass times radius, place and effect."""

import math
from collections.abc import Sequence

from engine import BalancedMachine, CounterweightPlace, Machine, Scene, balance, made_ready, quantity_text
from sweeps.text.input_files import InputError
from sweeps.text.numbers_in_row import numbers_in_row
from sweeps.text.tables import table

# Compared loads: a better balance may increase others.
COMPARED = {
    "shaking_force.max": "peak shaking force",
    "shaking_force.rms": "rms shaking force",
    "shaking_moment.peak": "peak shaking moment",
    "input.reaction.max": "peak force on the crank bearing",
    "input_moment.peak": "peak drive torque",
}
# A counterweight that pulls with less than this share of the shaking force is rounding.
NOTHING = 1e-9
SOUGHT = {"full": "zero shaking force", "rms": "minimum rms shaking force", "peak": "minimum peak shaking force"}


def counterweight_place(text: str) -> CounterweightPlace:
    """A place for a counterweight from a text such as "rod: -60 mm, 0 mm", in link axes.

    Parameters
    ----------
    text : str

    Raises
    ------
    InputError
        The text is not a link and a place on it.
    """
    link, _, place = text.partition(":")
    if place.count(",") != 1:
        raise InputError.of("--place", f"{text!r}: write a link and a place on it, 'rod: -60 mm, 0 mm'")
    return CounterweightPlace(link.strip(), *numbers_in_row("--place", place, ("length", "length")))


def counterweights_of(
    scene: Scene,
    links: Sequence[str] = (),
    places: Sequence[str] = (),
    criterion: str = "rms",
    radius: str | None = None,
    most: str | None = None,
) -> BalancedMachine:
    """The best counterweights of a mechanism.

    Parameters
    ----------
    scene : Scene
    links : sequence of str
        Links on fixed axes; default without places: the input.
    places : sequence of str
        As for `counterweight_place`.
    criterion : {"full", "rms", "peak"}
    radius : str, optional
        Radius of the counterweights, such as "60 mm" (default: the crank's length).
    most : str, optional
        Maximum mass of each counterweight, such as "8 kg".

    Raises
    ------
    InputError
        Invalid text, or a scene without a mechanism.
    BalanceError
        There are no such counterweights.
    """
    if scene.input is None:
        message = "the scene has only machine elements: there are no links to balance"
        raise InputError.of(scene.title or "scene", message, key="input")
    links = tuple(links) if links or places else (scene.input.link,)
    size = None if radius is None else numbers_in_row("--radius", radius, ("length",))[0]
    found = [counterweight_place(place) for place in places]
    limits: dict[str, float] = {}
    if most is not None:
        mass = numbers_in_row("--most", most, ("mass",))[0]
        limits = {link: mass * (size or getattr(scene.input, "length", 1.0)) for link in links}
        found = [place._replace(most=mass) for place in found]
    return balance(scene, links, found, criterion, size, limits)


def counterweight_text(scene: Scene, found: BalancedMachine, criterion: str) -> str:
    """The counterweights found, their effect, and the proven bound for any others in these places.

    Parameters
    ----------
    scene : Scene
        Without them.
    found : BalancedMachine
    criterion : {"full", "rms", "peak"}
    """
    rows = [("link", "m·r", "at", "mass", "radius")]
    pulls = [weight.unbalance * scene.input.speed**2 for weight in found.counterweights]
    for weight in (w for w, pull in zip(found.counterweights, pulls, strict=True) if pull > NOTHING * found.before):
        angle = math.degrees(math.atan2(weight.y, weight.x)) % 360.0
        sizes = (quantity_text(weight.mass, "kg"), quantity_text(math.hypot(weight.x, weight.y), "m"))
        rows.append((weight.link, quantity_text(weight.unbalance, "kg m"), f"{angle:.1f}°", *sizes))
    speed = quantity_text(abs(scene.input.speed), "rad s-1" if scene.input.type == "crank" else "m s-1")
    head = f"Counterweights for {SOUGHT[criterion]}, at {speed}:"
    note = "Angles and radii in link axes: a crank's origin is its pivot, its x axis points to its pin."
    shown = [table(rows, "  "), note] if len(rows) > 1 else ["  none: at these places every counterweight raises it"]
    lines = [head, *shown, _compared(scene, found.scene)]
    if criterion != "full":
        left, bound = quantity_text(found.after, "N"), quantity_text(found.bound, "N")
        lines.append(f"Residual shaking force {left}; proven minimum for counterweights at these places: {bound}.")
    return "\n".join(lines)


def _compared(before: Scene, after: Scene) -> str:
    # Time-dependent loads have no cycle of the drive torque.
    asked = tuple(name for name in COMPARED if made_ready(before).register.why_not(name) is None)
    columns = [_values(made_ready(scene, asked)) for scene in (before, after)]
    rows = [("", "without", "with")]
    rows += [(COMPARED[name], *(column[name] for column in columns)) for name in asked]
    return table(rows, "  ")


def _values(machine: Machine) -> dict[str, str]:
    outcome, known = machine.evaluate({}), machine.available_summaries
    return {
        name: quantity_text(float(outcome.summaries[name][0]), known[name].units, float(outcome.errors[name][0]))
        for name in machine.asked_summaries
    }
