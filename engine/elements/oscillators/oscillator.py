"""One mass on a spring: constants, free motion, forced vibration, and passage through resonance."""

import math
from functools import cached_property
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.compliances.stiffnesses import cantilever_stiffness
from engine.elements.element import ROUNDING, Answers, Element, NamedRows, Numbers, nudged
from engine.elements.oscillators import one_mass, over_time
from engine.elements.oscillators.excitations import (
    CantileverSpring,
    Excitation,
    FreeStart,
    OverTime,
    RotatingUnbalance,
    RunThrough,
    SupportOverTime,
)
from engine.elements.oscillators.run_through import run_through_motion, run_through_peak
from engine.elements.panels import SPEED, TIME, Curve, Mark, Panel, PanelAxis
from engine.laws.rounding import EPS
from engine.parts.actions import Damping, Stiffness
from engine.parts.skeleton import Faults, Mass, Number
from engine.words.quantity import Quantity, main_result
from engine.words.verdicts import Verdict

Ratio = Annotated[Number, Field(ge=0)]
_Constants = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
# Instants of curves; damping ratios plotted for comparison, and the range of frequency ratios; initial displacement
# for the plot of an oscillator without a start [m].
_INSTANTS = 2001
_RATIOS, _WIDEST = (0.05, 0.1, 0.2, 0.5), 3.0
_LET_GO = 1e-3
DISPLACEMENT = PanelAxis("displacement", "m", "x")
# Variants per block for formulas, each of which expands to thousands of rows.
_FORMULA_BLOCK = 32
# Results of the passage through resonance.
_THROUGH = "run_through_amplitude", "run_through_speed", "run_through_time", "run_through_share"


class OscillatorElement(Element):
    """A mass on a spring, given by its `stiffness` or as a cantilever, with a damper.

    The damper is given by its `damping`, its `damping_ratio`, the logarithmic `decrement`, or `energy_absorption`, the
    fraction of the peak energy dissipated per cycle at the natural frequency; by default there is none. From the
    `start` values the mass moves freely, or under an excitation over time.
    """

    one_of: ClassVar = (("stiffness", "cantilever"),)
    at_most_one_of: ClassVar = (("damping", "damping_ratio", "decrement", "energy_absorption"),)
    picture: ClassVar = "vibration"
    infinite: ClassVar = Verdict.RESONANCE

    type: Literal["oscillator"]
    mass: Annotated[Mass, Field(gt=0)]
    stiffness: Annotated[Stiffness, Field(gt=0)] | None = None
    cantilever: CantileverSpring | None = None
    damping: Annotated[Damping, Field(ge=0)] | None = None
    damping_ratio: Ratio | None = None
    decrement: Ratio | None = None
    energy_absorption: Ratio | None = None
    start: FreeStart | None = None
    excitation: Excitation | None = None
    run_through: RunThrough | None = None

    def _faults(self) -> Faults:
        if self.run_through is not None and not isinstance(self.excitation, RotatingUnbalance):
            yield "run_through needs a rotor: give excitation with type = 'unbalance'"
        if isinstance(self.excitation, OverTime) and self.start is not None and self.start.time != 0.0:
            yield "start.time belongs to a free motion: under an excitation over time give excitation.time"

    @property
    def variants_at_once(self) -> int:
        """A small block if a formula is evaluated."""
        by_formula = isinstance(self.excitation, OverTime) and self.excitation.formula is not None
        return _FORMULA_BLOCK if by_formula else Element.variants_at_once

    @cached_property
    def results(self) -> tuple[Quantity, ...]:
        """Results for the keys given; those over time are listed without computing the motion."""
        if isinstance(self.excitation, OverTime):
            still = self.model_copy(update={"excitation": None, "start": None})
            return *still.results, *over_time.OVER_TIME_RESULTS
        return super().results

    def named(self, n: Numbers) -> NamedRows:
        """Results for the start, excitation and passage given; infinite at an undamped resonance."""
        stiffness, frequency, ratio, damping = constants = _constants(self, n)
        damped = frequency * np.sqrt(np.where(ratio < 1.0, (1.0 - ratio) * (1.0 + ratio), math.nan))
        yield main_result("stiffness", "stiffness of the spring", "N m-1"), stiffness
        yield main_result("natural_frequency", "natural frequency without damping", "rad s-1"), frequency
        yield main_result("damping", "damping", "N s m-1"), damping
        yield main_result("damping_ratio", "damping over critical damping", "1"), ratio
        yield main_result("damped_frequency", "frequency of the free motion", "rad s-1", True), damped
        yield main_result("decrement", "logarithmic decrement", "1", True), one_mass.decrement_of_ratio(ratio)
        words = "energy absorption in a cycle at the natural frequency"
        yield main_result("energy_absorption", words, "1"), 2.0 * math.tau * ratio
        if isinstance(self.excitation, OverTime):
            columns = over_time.over_time_columns(self.excitation, n, stiffness, ratio)[0]
            yield from zip(over_time.OVER_TIME_RESULTS, columns.values(), strict=True)
            return
        if self.start is not None:
            start = n["start.displacement"], n["start.velocity"]
            greatest, when = one_mass.greatest_displacement(frequency, ratio, *start)
            moved, velocity = one_mass.free_motion(frequency, ratio, *start, n["start.time"])
            yield main_result("free_greatest", "peak displacement of the free motion", "m"), greatest
            yield main_result("free_greatest_at", "time of the peak displacement of the free motion", "s"), when
            words = "displacement of the free motion at the requested time"
            yield main_result("free_displacement", words, "m"), moved
            yield main_result("free_velocity", "velocity of the free motion at the requested time", "m s-1"), velocity
        if self.excitation is not None:
            yield from _forced(self, n, constants)
        if self.run_through is not None:
            yield from _run_through(n, frequency, ratio)

    def evaluate(self, n: Numbers) -> Answers:
        """Results with errors; over time, errors include those of the linear pieces of a formula, and rounding."""
        found, errors = nudged(self.values, n)
        if self.run_through is not None:
            time = found["run_through_time"]
            turned = (np.abs(n["run_through.start"]) + np.abs(n["run_through.acceleration"]) * time) * time
            for name in _THROUGH:
                # The angle turned by the rotor rounds in a few steps; all results depend on it.
                errors[name] += 4.0 * EPS * turned * np.abs(found[name])
        if isinstance(self.excitation, OverTime):
            stiffness, _, ratio, _ = _constants(self, n)
            coarse, carried = over_time.over_time_columns(self.excitation, n, stiffness, ratio, over_time.PIECES // 2)
            for name, size in carried.items():
                errors[name] += ROUNDING * EPS * size
            for name, values in coarse.items() if self.excitation.formula is not None else ():
                errors[name] += np.nan_to_num(np.abs(found[name] - values), posinf=np.inf)
        return Answers(found, errors)

    def panels(self) -> tuple[Panel, ...]:
        """Plots: free motion, vibration over the exciting frequency, passage through resonance.

        Under an excitation over time: excitation, displacement and spring force over time. Without start and excitation
        the plot shows a free motion from an initial displacement.
        """
        if isinstance(self.excitation, OverTime):
            return self._over_time()
        if self.start is None and self.excitation is None:
            return (self.model_copy(update={"start": FreeStart(displacement=_LET_GO)})._free(),)
        made = [] if self.start is None else [self._free()]
        made += [] if self.excitation is None else [self._forced()]
        made += [] if self.run_through is None else [self._through()]
        return tuple(made)

    def _over_time(self) -> tuple[Panel, ...]:
        n, own = self.own_numbers(), self.own_values()
        time, *rows = over_time.oscillator_history(self.excitation, n, self.values(n), 2 * _INSTANTS)
        of_support = isinstance(self.excitation, SupportOverTime)
        drives = PanelAxis("motion of the support", "m", "y") if of_support else PanelAxis("force", "N", "F")
        axes = drives, DISPLACEMENT, PanelAxis("spring force", "N", "F_s")
        peaks, made = (None, "greatest_displacement_at", "spring_force_at"), []
        for y, row, key in zip(axes, rows, peaks, strict=True):
            at = own.get(key, math.nan)
            peak = [Mark("", at, float(np.interp(at, time, row)))] if math.isfinite(at) else []
            made.append(Panel(TIME, y, time, (Curve("", row),), [*peak, Mark("", None, 0.0)]))
        return tuple(made)

    def _free(self) -> Panel:
        own = self.own_values()
        beta, ratio = own["damping_ratio"] * own["natural_frequency"], own["damping_ratio"]
        # Some periods, or until the motion has decayed.
        long = 10 * math.tau / own["natural_frequency"]
        span = max(self.start.time, own["free_greatest_at"], min(long, 6.0 / beta) if beta > 0 else long)
        time = np.linspace(0.0, span, _INSTANTS)
        curves = [Curve("", self.over("start.time", time)["free_displacement"])]
        if ratio < 1.0 and beta > 0.0:
            root = own["natural_frequency"] * math.sqrt(1.0 - ratio**2)
            start = self.start
            size = math.hypot(start.displacement, (start.velocity + beta * start.displacement) / root)
            curves += [Curve("", sign * size * np.exp(-beta * time), True) for sign in (1, -1)]
        marks = [Mark("", None, 0.0)]
        marks += [Mark("", self.start.time, own["free_displacement"])] if self.start.time else []
        return Panel(TIME, DISPLACEMENT, time, curves, marks, "Free motion")

    def _forced(self) -> Panel:
        own = self.own_values()
        eta = np.linspace(0.0, max(_WIDEST, 1.2 * own["frequency_ratio"]), _INSTANTS)
        speed, key = eta * own["natural_frequency"], "excitation.speed"
        plain = self.model_copy(update=dict.fromkeys(("damping", "decrement", "energy_absorption", "run_through")))
        factor = self.model_copy(update={"run_through": None}).over(key, speed)["dynamic_factor"]
        curves = [Curve(f"ζ = {own['damping_ratio']:.3g}", factor)]
        for ratio in _RATIOS:
            other = plain.model_copy(update={"damping_ratio": ratio}).over(key, speed)["dynamic_factor"]
            curves.append(Curve("", other, True))
        marks = (Mark("as given", own["frequency_ratio"], own["dynamic_factor"]),)
        limits = 0.0, 1.1 * max(min(np.nanmax(factor), 12.0), 2.0)
        title = f"Forced (grey: ζ = {', '.join(f'{r:g}' for r in _RATIOS)})"
        axes = PanelAxis("frequency ratio", "1", "η"), PanelAxis("dynamic factor", "1", "D")
        return Panel(*axes, eta, curves, marks, title, limits)

    def _through(self) -> Panel:
        own, run = self.own_values(), self.run_through
        time = np.linspace(0.0, 2.0 * abs((own["natural_frequency"] - run.start) / run.acceleration), 4 * _INSTANTS)
        given = own["natural_frequency"], own["damping_ratio"], run.start, run.acceleration
        speed = run.start + run.acceleration * time
        unit = self.excitation.mass * self.excitation.radius / self.mass
        size = unit * np.abs(run_through_motion(*(np.full(time.shape, value) for value in given), time)[0])
        kept = speed >= 0.0
        steady = self.model_copy(update={"run_through": None}).over("excitation.speed", speed[kept])["amplitude"]
        curves = Curve("passing through", size[kept]), Curve("steady", steady, True)
        top = own["run_through_amplitude"]
        # The undamped steady vibration is unbounded.
        limits = (0.0, 1.6 * top) if math.isfinite(top) else None
        marks = (Mark("", own["run_through_speed"], top),)
        amplitude = PanelAxis("amplitude", "m", "A")
        return Panel(SPEED, amplitude, speed[kept], curves, marks, "Through the resonance", limits)


def _constants(element: OscillatorElement, n: Numbers) -> _Constants:
    """Stiffness, natural frequency, damping ratio and damping."""
    mass, stiffness = n["mass"], _stiffness(element, n)
    frequency = np.sqrt(stiffness / mass)
    ratio = _damping_ratio(n, mass, frequency)
    return stiffness, frequency, ratio, 2.0 * ratio * frequency * mass


def _stiffness(element: OscillatorElement, n: Numbers) -> np.ndarray:
    if element.cantilever is None:
        return n["stiffness"]
    keys = ("diameter", "bore", "length", "elastic_modulus")
    found = cantilever_stiffness(*(n[f"cantilever.{key}"] for key in keys))
    return np.where(found > 0.0, found, math.nan)


def _damping_ratio(n: Numbers, mass: np.ndarray, frequency: np.ndarray) -> np.ndarray:
    if "damping" in n:
        return n["damping"] / (2.0 * mass * frequency)
    if "decrement" in n:
        return one_mass.ratio_from_decrement(n["decrement"])
    if "energy_absorption" in n:
        return one_mass.ratio_from_absorption(n["energy_absorption"])
    return n.get("damping_ratio", np.zeros_like(mass))


def _forced(element: OscillatorElement, n: Numbers, constants: _Constants) -> NamedRows:
    """Steady vibration under a harmonic excitation, and its peak over the exciting frequency."""
    stiffness, frequency, ratio, damping = constants
    speed = n["excitation.speed"]
    eta = speed / frequency
    lag, factor = one_mass.phase_lag(eta, ratio), one_mass.dynamic_factor(eta, ratio)
    best, greatest = one_mass.resonance_ratio(ratio), one_mass.resonance_factor(ratio)
    match element.excitation.type:
        case "force":
            unit = n["excitation.amplitude"] / stiffness
        case "unbalance":
            unit = n["excitation.mass"] * n["excitation.radius"] / n["mass"]
            with np.errstate(divide="ignore"):
                factor, best = eta**2 * factor, 1.0 / best
        case "support_motion":
            unit = n["excitation.amplitude"]
            factor, lag = one_mass.transmissibility(eta, ratio), one_mass.transmission_lag(eta, ratio)
            best = one_mass.support_resonance_ratio(ratio)
            greatest = one_mass.transmissibility(best, ratio)
    amplitude = unit * factor
    # Spring and damper are stretched by the motion relative to the support.
    stretch = amplitude
    if element.excitation.type == "support_motion":
        stretch = eta**2 * one_mass.dynamic_factor(eta, ratio) * unit
    with np.errstate(invalid="ignore"):
        # Without a damper the power is 0 even at infinite amplitude.
        power = np.where(damping > 0.0, 0.5 * damping * (speed * stretch) ** 2, 0.0)
    transmitted = stiffness * np.hypot(1.0, 2.0 * ratio * eta) * stretch
    yield main_result("frequency_ratio", "exciting over natural frequency", "1"), eta
    yield main_result("dynamic_factor", "dynamic factor", "1"), factor
    yield main_result("amplitude", "amplitude of the forced vibration", "m"), amplitude
    yield main_result("phase_lag", "phase lag of the forced vibration behind the excitation", "rad"), lag
    yield main_result("transmitted_force", "amplitude of the force of spring and damper", "N"), transmitted
    yield main_result("dissipated_power", "mean power dissipated by the damper", "W"), power
    words = "exciting frequency of the peak amplitude"
    yield main_result("resonance_speed", words, "rad s-1", True), best * frequency
    words = "peak amplitude at any exciting frequency"
    yield main_result("resonance_amplitude", words, "m", True), unit * greatest


def _run_through(n: Numbers, frequency: np.ndarray, ratio: np.ndarray) -> NamedRows:
    start, acceleration = n["run_through.start"], n["run_through.acceleration"]
    peak, time = run_through_peak(frequency, ratio, start, acceleration)
    unit = n["excitation.mass"] * n["excitation.radius"] / n["mass"]
    with np.errstate(invalid="ignore"):
        share = peak / one_mass.resonance_factor(ratio)
    results = (
        ("peak amplitude during the passage through resonance", "m", unit * peak),
        ("speed at the peak amplitude", "rad s-1", start + acceleration * time),
        ("time of the peak amplitude", "s", time),
        ("peak amplitude during the passage, over that of steady resonance", "1", share),
    )
    for name, (words, units, row) in zip(_THROUGH, results, strict=True):
        yield main_result(name, words, units, True), row
