"""Vehicles to be looked at: what shakes a locomotive over a turn and over its speed, how cars come to rest."""

import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engine import CarElement, ElementsAlone, LocomotiveElement, Scene
from sweeps.pictures.style import BLUE, GREY, ORANGE, PALETTE, VERMILION, sheet
from sweeps.text.engineer_units import engineer_unit

PLACES = 361
# Speeds up to so many times the one given.
FASTEST = 1.5
RPM, KMH = 30 / math.pi, 3.6
SIDES = (("left", BLUE), ("right", ORANGE))


def locomotive_sheet(element: LocomotiveElement, target: Path | str | Figure, title: str = "") -> Figure:
    """Forces along the track and in the wheels and the swaying couple over a turn, hammer blows over the speed.

    Parameters
    ----------
    element : LocomotiveElement
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written.
    """
    turning = element.model_copy(update={"crank_angle": 0.0})
    angle = np.linspace(0.0, math.tau, PLACES)
    asked = ("tractive_force", "left_rail_force", "right_rail_force", "swaying_moment")
    turn = _swept(turning, asked, crank_angle=angle)
    with sheet(target, 180, 130, title) as figure:
        drawn = figure.subplot_mosaic([["forces", "blows"], ["couple", "blows"]])
        forces, couple, blows = (drawn[name] for name in ("forces", "couple", "blows"))
        factor, unit = engineer_unit("N", np.concatenate([turn[name] for name in asked[:3]]))
        forces.plot(np.degrees(angle), factor * turn["tractive_force"], color=VERMILION, label="along the track")
        for side, colour in SIDES:
            forces.plot(np.degrees(angle), factor * turn[f"{side}_rail_force"], color=colour, label=f"up, {side} wheel")
        forces.set(ylabel=f"unbalanced force, {unit}", title="Over a turn")
        forces.legend(loc="best")
        factor, unit = engineer_unit("N m", turn["swaying_moment"])
        couple.plot(np.degrees(angle), factor * turn["swaying_moment"], color=VERMILION)
        couple.set(ylabel=f"swaying couple, {unit}", xlabel="crank angle, °")
        for ax in (forces, couple):
            ax.set(xlim=(0, 360), xticks=range(0, 361, 90))
        _blows(blows, element)
    return figure


def _blows(ax: Axes, element: LocomotiveElement) -> None:
    """Hammer blows and variation of the tractive effort over the speed, with the load of a wheel where it is known."""
    asked = ["left_hammer_blow", "right_hammer_blow", "tractive_variation"]
    fastest = FASTEST * element.speed
    if element.wheel_load is not None:
        lifts = float(_swept(element, ["lift_off_speed"], speed=np.array([element.speed]))["lift_off_speed"][0])
        # A well balanced one would lift off far beyond all speeds.
        fastest = max(fastest, 1.1 * lifts) if lifts < 4 * element.speed else fastest
    speed = np.linspace(1e-3, 1.0, PLACES) * fastest
    found = _swept(element, asked, speed=speed)
    factor, unit = engineer_unit("N", np.concatenate(list(found.values())))
    for side, colour in SIDES:
        ax.plot(RPM * speed, factor * found[f"{side}_hammer_blow"], color=colour, label=f"hammer blow, {side}")
    ax.plot(RPM * speed, factor * found["tractive_variation"], color=VERMILION, label="along the track")
    if element.wheel_load is not None:
        ax.axhline(factor * element.wheel_load, color=GREY, linewidth=0.8, linestyle=(0, (6, 2)), label="wheel load")
    ax.axvline(RPM * element.speed, color=GREY, linewidth=0.8)
    ax.set(xlim=(0, RPM * fastest), ylim=(0, None), xlabel="speed of the axle, rpm", ylabel=f"greatest force, {unit}")
    ax.set_title("Over the speed (upright line: as given)")
    ax.legend(loc="upper left")


def car_sheet(element: CarElement, target: Path | str | Figure, title: str = "") -> Figure:
    """Way to rest over the speed with brakes on front, rear and all wheels; speed along the way as given.

    Parameters
    ----------
    element : CarElement
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written.
    """
    speed = np.linspace(1e-3, FASTEST, PLACES) * element.speed
    with sheet(target, 180, 75, title) as figure:
        over_speed, along = figure.subplots(1, 2)
        for colour, brakes in zip(PALETTE, ("front", "rear", "all"), strict=False):
            braked = element.model_copy(update={"brakes": brakes})
            own = brakes == element.brakes
            way = _swept(braked, ["stopping_distance"], speed=speed)["stopping_distance"]
            over_speed.plot(KMH * speed, way, color=colour, linewidth=1.6 if own else 0.8, label=f"brakes: {brakes}")
            # The brakes begin to act when the reaction time is over; then the square of the speed falls evenly.
            held = _swept(braked, ["deceleration"], speed=speed[-1:])["deceleration"][0]
            left = np.linspace(element.speed, 0.0, PLACES)
            braking = element.speed * element.reaction_time + (element.speed**2 - left**2) / (2 * held)
            along.plot(
                [0.0, *braking], KMH * np.array([element.speed, *left]), color=colour, linewidth=1.6 if own else 0.8
            )
        over_speed.axvline(KMH * element.speed, color=GREY, linewidth=0.8)
        over_speed.set(xlabel="speed, km/h", ylabel="way to rest, m", xlim=(0, KMH * speed[-1]), ylim=(0, None))
        over_speed.set_title("Over the speed (upright line: as given)")
        over_speed.legend(loc="upper left")
        along.set(xlabel="way, m", ylabel="speed, km/h", xlim=(0, None), ylim=(0, None), title="Along the way")
    return figure


def _swept(element: CarElement | LocomotiveElement, asked: list[str], **changed: np.ndarray) -> dict[str, np.ndarray]:
    """Results of an element by itself, with one of its numbers swept."""
    paths = {f"elements.it.{key}": values for key, values in changed.items()}
    alone = ElementsAlone(Scene(elements={"it": element}), [f"it.{name}" for name in asked], varied=paths)
    found = alone.evaluate(paths).summaries
    return {name: found[f"it.{name}"] for name in asked}
