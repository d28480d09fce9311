"""Oscillators and elastic drives to be looked at: vibration, a start, a machine over its cycle, and shares of parts."""

import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engine import (
    ComplianceElement,
    ElementsAlone,
    FreeStart,
    OscillatorElement,
    OverTime,
    Scene,
    SupportOverTime,
    TwoMassDrive,
    drive_cycle,
    drive_history,
    drive_run,
    oscillator_columns,
    oscillator_history,
    oscillator_numbers,
    run_through_motion,
)
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import BLUE, GREY, ORANGE, VERMILION, sheet
from sweeps.text.engineer_units import engineer_unit

INSTANTS = 2001
# Damping ratios drawn beside the oscillator's own, and the range of frequency ratios.
RATIOS, WIDEST = (0.05, 0.1, 0.2, 0.5), 3.0
RPM = 30 / math.pi
# Where an oscillator without a start is let go [m].
LET_GO = 1e-3


def oscillator_sheet(element: OscillatorElement, target: Path | str | Figure, title: str = "") -> Figure:
    """What an oscillator is asked about: free motion, vibration over the exciting frequency, run through resonance.

    Under an excitation over time: that, displacement, and force of the spring over time. One that is asked about its
    own numbers alone is let go at a displacement of 1 mm.

    Parameters
    ----------
    element : OscillatorElement
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written.
    """
    if isinstance(element.excitation, OverTime):
        return _over_time_sheet(element, target, title)
    if element.start is None and element.excitation is None:
        element = element.model_copy(update={"start": FreeStart(displacement=LET_GO)})
    drawn = [draw for draw, given in (
        (_free, element.start), (_forced, element.excitation), (_run_through, element.run_through)
    ) if given is not None]  # fmt: skip
    with sheet(target, max(90, 60 * len(drawn) + 30), 75, title) as figure:
        for ax, draw in zip(figure.subplots(1, len(drawn), squeeze=False)[0], drawn, strict=True):
            draw(ax, element)
    return figure


def _over_time_sheet(element: OscillatorElement, target: Path | str | Figure, title: str) -> Figure:
    numbers = oscillator_numbers(element)
    own = oscillator_columns(element, numbers)
    history = oscillator_history(element, numbers, own, 2 * INSTANTS)
    supported = isinstance(element.excitation, SupportOverTime)
    with sheet(target, 180, 130, title) as figure:
        top, middle, bottom = figure.subplots(3, 1, sharex=True)
        peaks = {middle: "greatest_displacement_at", bottom: "spring_force_at"}
        curves = (
            (top, history.drives, "m" if supported else "N", "support" if supported else "force", GREY),
            (middle, history.displacement, "m", "displacement", BLUE),
            (bottom, history.spring_force, "N", "spring", ORANGE),
        )
        for ax, values, si, label, colour in curves:
            factor, unit = engineer_unit(si, values)
            ax.plot(history.time, factor * values, color=colour)
            ax.axhline(0.0, color="black", linewidth=0.6)
            ax.set_ylabel(f"{label}, {unit}")
            if ax in peaks:
                at = own[peaks[ax]][0]
                ax.plot(at, factor * np.interp(at, history.time, values), "o", color=VERMILION, markersize=4)
        bottom.set(xlabel="time, s", xlim=(0, history.time[-1]))
    return figure


def _swept(element: OscillatorElement, **changed: np.ndarray) -> dict[str, np.ndarray]:
    """Results of an oscillator with some of its numbers swept; double underscores stand for dots."""
    given = {key.replace("__", "."): values for key, values in changed.items()}
    shape = np.broadcast_shapes(*(np.shape(values) for values in given.values()))
    numbers = {key: np.broadcast_to(value, shape) for key, value in oscillator_numbers(element).items()} | given
    with np.errstate(divide="ignore", invalid="ignore"):
        return oscillator_columns(element, numbers)


def _free(ax: Axes, element: OscillatorElement) -> None:
    own = {key: float(value[0]) for key, value in _swept(element, mass=np.array([element.mass])).items()}
    beta = own["damping_ratio"] * own["natural_frequency"]
    # Some periods, or until it has died away.
    long = 10 * math.tau / own["natural_frequency"]
    span = max(element.start.time, own["free_greatest_at"], min(long, 6.0 / beta) if beta > 0 else long)
    time = np.linspace(0.0, span, INSTANTS)
    moved = _swept(element, start__time=time)["free_displacement"]
    factor, unit = engineer_unit("m", moved)
    ax.plot(time, factor * moved, color=BLUE)
    if own["damping_ratio"] < 1.0 and beta > 0.0:
        root = own["natural_frequency"] * math.sqrt(1.0 - own["damping_ratio"] ** 2)
        start = element.start
        size = math.hypot(start.displacement, (start.velocity + beta * start.displacement) / root)
        for sign in (1, -1):
            ax.plot(time, sign * factor * size * np.exp(-beta * time), color=GREY, linewidth=0.7, linestyle="--")
    if element.start.time:
        ax.plot(element.start.time, factor * own["free_displacement"], "o", color=VERMILION, markersize=4)
    ax.axhline(0.0, color="black", linewidth=0.6)
    ax.set(xlabel="time, s", ylabel=f"displacement, {unit}", title="Free motion", xlim=(0, span))


def _forced(ax: Axes, element: OscillatorElement) -> None:
    own = {key: float(value[0]) for key, value in _swept(element, mass=np.array([element.mass])).items()}
    widest = max(WIDEST, 1.2 * own["frequency_ratio"])
    eta = np.linspace(0.0, widest, INSTANTS)
    plain = element.model_copy(update=dict.fromkeys(("damping", "decrement", "energy_absorption")))
    for ratio in RATIOS:
        curve = _swept(
            plain.model_copy(update={"damping_ratio": ratio}), excitation__speed=eta * own["natural_frequency"]
        )
        ax.plot(eta, curve["dynamic_factor"], color=GREY, linewidth=0.7)
    factor = _swept(element, excitation__speed=eta * own["natural_frequency"])["dynamic_factor"]
    ax.plot(eta, factor, color=BLUE, label=f"ζ = {own['damping_ratio']:.3g}")
    ax.plot(own["frequency_ratio"], own["dynamic_factor"], "o", color=VERMILION, markersize=4, label="as given")
    top = min(np.nanmax(factor), 12.0)
    ax.set(xlim=(0, widest), ylim=(0, 1.1 * max(top, 2.0)), xlabel="frequency ratio", ylabel="dynamic factor")
    ax.set_title(f"Forced (grey: ζ = {', '.join(f'{r:g}' for r in RATIOS)})")
    ax.legend(loc="upper right")


def _run_through(ax: Axes, element: OscillatorElement) -> None:
    own = {key: float(value[0]) for key, value in _swept(element, mass=np.array([element.mass])).items()}
    run, excitation = element.run_through, element.excitation
    unit_size = excitation.mass * excitation.radius / element.mass
    centre = abs((own["natural_frequency"] - run.start) / run.acceleration)
    time = np.linspace(0.0, 2.0 * centre, 4 * INSTANTS)
    frequency, ratio, start, acceleration = (
        np.full(time.shape, value)
        for value in (own["natural_frequency"], own["damping_ratio"], run.start, run.acceleration)
    )
    speed = start + acceleration * time
    kept = speed >= 0.0
    size = unit_size * np.abs(run_through_motion(frequency, ratio, start, acceleration, time))
    steady = _swept(element, excitation__speed=np.maximum(speed, 0.0))["amplitude"]
    factor, unit = engineer_unit("m", size)
    ax.plot(RPM * speed[kept], factor * steady[kept], color=GREY, linewidth=0.8, label="at steady speed")
    ax.plot(RPM * speed[kept], factor * size[kept], color=BLUE, label="on the way")
    ax.plot(RPM * own["run_through_speed"], factor * own["run_through_amplitude"], "o", color=VERMILION, markersize=4)
    ax.set(xlabel="speed, rpm", ylabel=f"amplitude, {unit}")
    if np.isfinite(own["run_through_amplitude"]):
        # Steady vibration without damping goes beyond all bounds.
        ax.set_ylim(0, 1.6 * factor * own["run_through_amplitude"])
    if run.acceleration < 0:
        ax.invert_xaxis()
    ax.set_title("Through the resonance")
    ax.legend(loc="upper right")


def drive_sheet(drive: TwoMassDrive, target: Path | str | Figure, title: str = "") -> Figure:
    """Moment of the shaft, speeds of motor and load, and play of a drive with backlash over time.

    Parameters
    ----------
    drive : TwoMassDrive
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written.
    """
    history = drive_history(drive, 4 * INSTANTS)
    with sheet(target, 180, 130, title) as figure:
        top, middle, bottom = figure.subplots(3, 1, sharex=True)
        factor, unit = engineer_unit("N m", history.moment)
        top.plot(history.time, factor * history.moment, color=BLUE, label="of the shaft")
        peak = np.abs(history.moment).argmax()
        top.plot(history.time[peak], factor * history.moment[peak], "o", color=VERMILION, markersize=4)
        top.plot(history.time, factor * history.motor_moment, color=GREY, linewidth=0.8, label="of the motor")
        dashes = {"color": GREY, "linewidth": 0.8, "linestyle": (0, (6, 2))}
        top.axhline(factor * drive.load_moment, label="of the load", **dashes)
        top.legend(loc="best")
        top.set_ylabel(f"moment, {unit}")
        for speed, colour, label in ((history.motor_speed, BLUE, "motor"), (history.load_speed, ORANGE, "load")):
            middle.plot(history.time, RPM * speed, color=colour, label=label)
        middle.set_ylabel("speed, rpm")
        middle.legend(loc="best")
        degrees = np.degrees(history.gap)
        bottom.axhspan(-math.degrees(drive.backlash), 0.0, color=GREY, alpha=0.25, linewidth=0, label="backlash")
        bottom.plot(history.time, degrees, color=BLUE)
        bottom.set(ylabel="motor ahead of load, °", xlabel="time, s", xlim=(0, drive.time))
        bottom.legend(loc="best")
    return figure


def machine_drive_sheet(scene: Scene, name: str, target: Path | str | Figure, title: str = "") -> Figure:
    """Moment of the elastic shaft, speeds of its ends and its twist over the machine's cycle, a rigid shaft beside.

    Parameters
    ----------
    scene : Scene
    name : str
        The drive among its elements.
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, it can't be written, or there is no steady motion to be drawn.
    """
    cycle = drive_cycle(scene, name)
    if cycle is None:
        raise PictureError(f"elements.{name}: the machine has no steady motion on this shaft; sweeps run says why")
    degrees = np.degrees(cycle.angle)
    with sheet(target, 180, 130, title) as figure:
        top, middle, bottom = figure.subplots(3, 1, sharex=True)
        factor, unit = engineer_unit("N m", cycle.moment)
        top.plot(degrees, factor * cycle.rigid_moment, color=GREY, linewidth=0.8, label="rigid")
        top.plot(degrees, factor * cycle.moment, color=BLUE, label="elastic")
        peak = np.abs(cycle.moment).argmax()
        top.plot(degrees[peak], factor * cycle.moment[peak], "o", color=VERMILION, markersize=4)
        top.set_ylabel(f"shaft, {unit}")
        middle.plot(degrees, RPM * cycle.rigid_speed, color=GREY, linewidth=0.8, label="rigid")
        middle.plot(degrees, RPM * cycle.motor_speed, color=BLUE, label="motors' end")
        middle.plot(degrees, RPM * cycle.machine_speed, color=ORANGE, label="crank")
        middle.set_ylabel("speed at the crank, rpm")
        bottom.plot(degrees, np.degrees(cycle.twist), color=BLUE)
        bottom.set(ylabel="crank behind, °", xlabel="crank angle, °", xlim=(0, degrees[-1]))
        for ax in (top, middle):
            ax.legend(loc="best")
    return figure


def compliance_sheet(element: ComplianceElement, target: Path | str | Figure, title: str = "") -> Figure:
    """What share of the twist, or of the energy, each elastic part of a shaft line has, the softest first.

    Parameters
    ----------
    element : ComplianceElement
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written.
    """
    scene = Scene(elements={"it": element})
    found = ElementsAlone(scene, list(ElementsAlone(scene).available_summaries)).evaluate({}).summaries
    own = {name.removeprefix("it."): float(row[0]) for name, row in found.items()}
    shares = {name.removesuffix(".share"): value for name, value in own.items() if name.endswith(".share")}
    parts = sorted(shares, key=shares.get)
    told = [f"{100 * shares[part]:.3g} %, {_stiffness(own[f'{part}.stiffness'])}" for part in parts]
    with sheet(target, 140, 25 + 9 * len(parts), title) as figure:
        ax = figure.subplots()
        bars = ax.barh([part.replace(".", " · ") for part in parts], [100 * shares[part] for part in parts], color=BLUE)
        ax.bar_label(bars, told, padding=3, fontsize=7)
        ax.set(xlabel="share of the energy, %", xlim=(0, 1.6 * 100 * max(shares.values())))
        ax.grid(axis="y", visible=False)
        words = f"whole line: {_stiffness(own['stiffness'])}"
        if "twist" in own:
            words += f", {math.degrees(own['twist']):.3g}° under {element.moment:g} N·m"
        ax.set_title(words)
    return figure


def _stiffness(value: float) -> str:
    factor, unit = engineer_unit("N m rad-1", np.array([value]))
    return f"{factor * value:.4g} {unit}"


def machine_run_sheet(scene: Scene, name: str, target: Path | str | Figure, title: str = "") -> Figure:
    """Moment of the elastic shaft, speeds of its ends and its twist over the time of a run.

    Parameters
    ----------
    scene : Scene
    name : str
        The drive among its elements; it has a run.
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, it can't be written, or the machine has no steady motion.
    """
    run = drive_run(scene, name)
    if run is None:
        raise PictureError(f"elements.{name}: the machine has no steady motion on this shaft; sweeps run says why")
    with sheet(target, 180, 130, title) as figure:
        top, middle, bottom = figure.subplots(3, 1, sharex=True)
        factor, unit = engineer_unit("N m", run.moment)
        top.plot(run.time, factor * run.moment, color=BLUE)
        peak = np.abs(run.moment).argmax()
        top.plot(run.time[peak], factor * run.moment[peak], "o", color=VERMILION, markersize=4)
        top.set_ylabel(f"shaft, {unit}")
        middle.plot(run.time, RPM * run.motor_speed, color=BLUE, label="motors' end")
        middle.plot(run.time, RPM * run.machine_speed, color=ORANGE, label="crank")
        middle.set_ylabel("speed at the crank, rpm")
        middle.legend(loc="best")
        backlash = scene.elements[name].run.backlash
        if backlash > 0.0:
            bottom.axhspan(-math.degrees(backlash), 0.0, color=GREY, alpha=0.25, linewidth=0, label="backlash")
            bottom.legend(loc="best")
        bottom.plot(run.time, np.degrees(run.twist), color=BLUE)
        bottom.set(ylabel="crank behind, °", xlabel="time, s", xlim=(0, run.time[-1]))
    return figure
