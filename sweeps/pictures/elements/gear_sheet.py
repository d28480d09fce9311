"""Sheet of a gear train: kinematic scheme, and Smirnov's diagrams of linear and angular velocities."""

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engine import FRAME, GearTrain, VelocityPicture, Verdict, display_unit, train_results, velocity_picture
from sweeps.pictures.style import GREY, PALE, PALETTE, sheet
from sweeps.text.tables import column, table

RPM = 30 / math.pi
# Speeds closer than this share of the maximum share a ray.
_SAME = 1e-9


def gear_sheet(train: GearTrain, title: str = "") -> Figure:
    """Draw the scheme of a train and the diagrams of its linear and angular velocities.

    Rays of the angular diagram are parallel to the lines of the linear one.

    Parameters
    ----------
    train : GearTrain
    title : str
    """
    picture = velocity_picture(train)
    colours = {name: PALETTE[i % len(PALETTE)] for i, name in enumerate(picture.lines)}
    with sheet(180, 105) as figure:
        scheme, linear, angular = figure.subplots(1, 3, width_ratios=(1, 1.25, 1.25))
        sizes = np.array([wheel.radius for wheel in picture.wheels.values()])
        factor, unit = display_unit("m", sizes) if train.has_modules else (1.0, "modules")
        _scheme(scheme, train, picture, colours, factor)
        pace = display_unit("m s-1", np.ones(1)) if train.has_modules else (1.0, "modules/s")
        _linear(linear, picture, colours, factor, pace)
        top = max([w.axis + w.radius for w in picture.wheels.values()] + [1e-12])
        # The part below the lowest axis is a mirror image: half of it is enough.
        low = min([*picture.axes.values(), top])
        for ax in (scheme, linear, angular):
            ax.set_ylim(factor * (low - 0.25 * (top - low)), factor * (top + 0.32 * (top - low)))
        scheme.set_ylabel(f"line of centres, {unit}")
        _angular(angular, linear, picture, colours, factor / pace[0])
        fits = picture.verdict == Verdict.OK
        words = [title, "" if fits else picture.verdict.sentence]
        figure.suptitle("\n".join(filter(None, words)), fontweight="bold" if fits else None, wrap=True)
    return figure


def _scheme(ax: Axes, train: GearTrain, picture: VelocityPicture, colours: dict[str, str], factor: float) -> None:
    """Kinematic scheme: wheels as bars on their shafts, carriers as cranks, the frame hatched."""
    columns: dict[str, list[float]] = {}
    for name, wheel in picture.wheels.items():
        shaft = train.wheels[name].shaft
        x, colour = float(wheel.column), colours.get(shaft, GREY)
        columns.setdefault(shaft, []).append(x)
        ends = np.array([wheel.axis - wheel.radius, wheel.axis + wheel.radius]) * factor
        if wheel.is_ring:
            rim = 0.06 * (ends[1] - ends[0])
            for end, out in zip(ends, (-rim, rim), strict=True):
                ax.plot([x - 0.22, x + 0.22], [end, end], color=colour, linewidth=1.8)
                ax.plot([x, x], [end, end + out], color=colour, linewidth=1.8)
                if shaft == FRAME or train.shafts[shaft].held:
                    _ground(ax, x, end + out, rim)
        else:
            ax.plot([x, x], ends, color=colour, linewidth=1.8)
            for end in ends:
                ax.plot([x - 0.16, x + 0.16], [end, end], color=colour, linewidth=1.8)
        # A ring is named above its rim and support, a wheel below its teeth.
        at, ha = ((x, ends[1] + 1.7 * rim), "center") if wheel.is_ring else ((x, ends[1]), "left")
        ax.annotate(
            f"{name} {train.wheels[name].teeth:.4g}", at, (0, 3) if wheel.is_ring else (3, -9), ha=ha,
            textcoords="offset points", fontsize=6.5, color=colour,
        )  # fmt: skip
    used = [wheel.column for wheel in picture.wheels.values()]
    for shaft, axis in picture.axes.items():
        own = columns.get(shaft, [])
        pins = [p for p in picture.axes if train.shafts[p].carrier == shaft]
        reach = [*own, *(x for p in pins for x in columns.get(p, []))]
        if not reach:
            continue
        left, right = min(reach) - 0.3, max(reach) + 0.3
        y, colour = factor * axis, colours[shaft]
        if pins:
            right += 0.25
            for pin in pins:
                ax.plot([right, right], [y, factor * picture.axes[pin]], color=colour, linewidth=1.6)
                ax.plot([min(columns.get(pin, [right])), right], [factor * picture.axes[pin]] * 2, color=colour)
            ax.plot([right, right + 0.35], [y, y], color=colour, linewidth=1.6)
        elif all(w.is_ring for n, w in picture.wheels.items() if train.wheels[n].shaft == shaft):
            if not train.shafts[shaft].held:
                # The bell goes round the train on the nearer side; carriers are on the right.
                out = -1.0 if min(own) == min(used) else 1.0
                x = min(used) - 0.45 if out < 0 else max(used) + 0.8
                _bell(ax, train, picture, shaft, (x, x + 0.35 * out), factor, colour)
        elif train.shafts[shaft].carrier is None:
            ax.plot([left - 0.1, right], [y, y], color=colour, linewidth=1.4)
        else:
            ax.plot([left, right], [y, y], color=colour, linewidth=1.0)
    ax.set(xlim=(min(used) - 1.0, max(used) + 1.3), xticks=[], title="Scheme")
    ax.grid(visible=False)


def _bell(
    ax: Axes, train: GearTrain, picture: VelocityPicture, shaft: str, x: tuple[float, float], factor: float, colour: str
) -> None:
    """Shaft of a ring: around everything inside, to the axis and beyond."""
    for name, wheel in picture.wheels.items():
        if train.wheels[name].shaft == shaft:
            y, rim = factor * wheel.axis, factor * (wheel.axis + 1.12 * wheel.radius)
            ax.plot([wheel.column, x[0], x[0], x[1]], [rim, rim, y, y], color=colour, linewidth=1.4)


def _ground(ax: Axes, x: float, y: float, size: float) -> None:
    """Hatching of fixed parts."""
    ax.plot([x - 0.2, x + 0.2], [y, y], color="black", linewidth=0.9)
    for k in np.linspace(-0.2, 0.14, 5):
        ax.plot([x + k, x + k + 0.06], [y, y + 0.6 * size], color="black", linewidth=0.6)


def _linear(
    ax: Axes, picture: VelocityPicture, colours: dict[str, str], factor: float, pace: tuple[float, str]
) -> None:
    """Velocities of each shaft's points along the line of centres."""
    speed, unit = pace
    ax.axvline(0.0, color="black", linewidth=0.9)
    for name, line in picture.lines.items():
        ax.plot(speed * np.array(line.velocities), factor * np.array(line.heights), color=colours[name], label=name)
        ax.plot(
            speed * np.array(line.velocities), factor * np.array(line.heights), ".", color=colours[name], markersize=3
        )
    for height, velocity in picture.contacts.values():
        ax.plot([0, speed * velocity], [factor * height] * 2, color=PALE, linewidth=0.8, zorder=0)
        ax.plot(speed * velocity, factor * height, "o", color="black", markersize=2.5, zorder=4)
    values = [speed * v for line in picture.lines.values() for v in line.velocities] + [0.0]
    room = 0.12 * (max(values) - min(values)) or 1.0
    # A wider diagram steepens the rays of the angular one and leaves room for shaft names.
    ax.set_xlim(min(values) - room, max(values) + 4 * room)
    ax.legend(loc="best", fontsize=6.5)
    ax.set(title="Linear velocities", xlabel=f"velocity, {unit}")
    ax.tick_params(labelleft=False)


def _angular(ax: Axes, linear: Axes, picture: VelocityPicture, colours: dict[str, str], factor: float) -> None:
    """Rays from a pole, parallel to the lines of linear velocity; their intercepts are the angular speeds."""
    speeds = {name: line.speed for name, line in picture.lines.items()}
    values = [*speeds.values(), 0.0]
    room = 0.1 * (max(values) - min(values)) or 1.0
    limits = min(values) - room, max(values) + 3 * room
    # At equal size, this pole distance makes the rays parallel to the lines of the linear diagram.
    across = linear.get_xlim()
    distance = factor * (across[1] - across[0]) / (limits[1] - limits[0])
    low, high = ax.get_ylim()
    scale = high - 0.3 * (high - low)
    pole = scale - distance
    if pole < low:
        ax.set_ylim(pole - 0.05 * (high - pole), high)
    ax.set_xlim(RPM * limits[0], RPM * limits[1])
    ax.axhline(scale, color="black", linewidth=0.9)
    ax.plot(0, pole, "o", color="black", markersize=3)
    ax.annotate("P", (0, pole), (4, -3), textcoords="offset points", fontsize=7)
    ax.plot([0, 0], [pole, scale], color=GREY, linewidth=0.7, linestyle=(0, (4, 3)))
    largest = max(abs(v) for v in values) or 1.0
    groups: dict[float, list[str]] = {}
    for name, speed in speeds.items():
        same = next((s for s in groups if abs(s - speed) <= _SAME * largest), speed)
        groups.setdefault(same, []).append(name)
    for speed, names in groups.items():
        ax.plot([0, RPM * speed], [pole, scale], color=colours[names[0]])
        words = f"{', '.join(names)} {RPM * speed:.4g}"
        ax.annotate(
            words, (RPM * speed, scale), (2, 3), textcoords="offset points", fontsize=6.5, rotation=60,
            color=colours[names[0]], ha="left", va="bottom",
        )  # fmt: skip
    ax.set(yticks=[], xlabel="angular speed, rpm", title="Angular velocities")


def gear_table(train: GearTrain) -> str:
    """Mobility of a train, and speed, torque and power by shaft, as text."""
    found = {result.name: float(known.value[0]) for result, known in train_results(train, train.own_numbers())[0]}
    shown = [("speed", "speed", "rad s-1")]
    if train.has_loads:
        shown += [("torque", "moment", "N m"), ("power", "power", "W")]
    columns = [["shaft", *train.shafts]]
    columns += [column(words, unit, [found.get(f"{n}.{key}", 0.0) for n in train.shafts]) for words, key, unit in shown]
    return f"{train.structure.words}\n{table([*zip(*columns, strict=True)])}"
