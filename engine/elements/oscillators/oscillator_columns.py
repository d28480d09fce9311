"""What is computed of one mass on a spring: its constants, free motion, vibration, and its run through resonance."""

import math
from collections.abc import Iterator
from functools import partial
from operator import attrgetter

import numpy as np

from engine.elements.compliances.stiffnesses import cantilever_stiffness
from engine.elements.element_laws import ROUNDING, ElementResult, LawOfArrays, with_nudges
from engine.elements.element_numbers import Numbers
from engine.elements.oscillators.one_mass import (
    decrement_of_ratio,
    dynamic_factor,
    free_motion,
    greatest_displacement,
    phase_lag,
    ratio_from_absorption,
    ratio_from_decrement,
    resonance_factor,
    resonance_ratio,
    support_resonance_ratio,
    transmissibility,
    transmission_lag,
)
from engine.elements.oscillators.oscillator_element import DAMPINGS, OscillatorElement, OverTime
from engine.elements.oscillators.over_time import OVER_TIME_RESULTS, PIECES, over_time_columns, over_time_keys
from engine.elements.oscillators.run_through import run_through_peak
from engine.verdicts import Verdict

Columns = dict[str, np.ndarray]

# Variants at a time whose formulas are worked out, each to thousands of rows.
_FORMULA_BLOCK = 32
_CONSTANTS = (
    ElementResult("stiffness", "stiffness of the spring", "N m-1"),
    ElementResult("natural_frequency", "natural frequency without damping", "rad s-1"),
    ElementResult("damping", "damping", "N s m-1"),
    ElementResult("damping_ratio", "damping over that at which the free motion becomes aperiodic", "1"),
    ElementResult("damped_frequency", "frequency of the free motion", "rad s-1", None, True),
    ElementResult("decrement", "logarithmic decrement", "1", None, True),
    ElementResult("energy_absorption", "energy absorption in a cycle at the natural frequency", "1"),
)
_FREE = (
    ElementResult("free_greatest", "greatest displacement of the free motion", "m"),
    ElementResult("free_greatest_at", "time of the greatest displacement of the free motion", "s"),
    ElementResult("free_displacement", "displacement of the free motion at the time asked for", "m"),
    ElementResult("free_velocity", "velocity of the free motion at the time asked for", "m s-1"),
)
_FORCED = (
    ElementResult("frequency_ratio", "exciting over natural frequency", "1"),
    ElementResult("dynamic_factor", "dynamic factor", "1"),
    ElementResult("amplitude", "amplitude of the forced vibration", "m"),
    ElementResult("phase_lag", "angle by which the forced vibration lags behind what excites it", "rad"),
    ElementResult("transmitted_force", "amplitude of the force of spring and damper", "N"),
    ElementResult("dissipated_power", "mean power dissipated by the damper", "W"),
    ElementResult("resonance_speed", "exciting frequency of the greatest amplitude", "rad s-1", None, True),
    ElementResult("resonance_amplitude", "greatest amplitude at any exciting frequency", "m", None, True),
)
_THROUGH = (
    ElementResult("run_through_amplitude", "greatest amplitude on the way through the resonance", "m", None, True),
    ElementResult("run_through_speed", "speed at the greatest amplitude", "rad s-1", None, True),
    ElementResult("run_through_time", "time of the greatest amplitude", "s", None, True),
    ElementResult(
        "run_through_share", "greatest amplitude on the way over that of the steady resonance", "1", None, True
    ),
)


def oscillator_law(element: OscillatorElement) -> LawOfArrays:
    """The law of one mass on a spring: its numbers in an order of their own, and its results, by what it is given.

    Parameters
    ----------
    element : OscillatorElement
    """
    keys = tuple(_keys(element))
    if isinstance(element.excitation, OverTime):
        return LawOfArrays(
            partial(_rows_over_time, element, keys),
            lambda given_element, given: tuple(given(key) for key in keys),
            _CONSTANTS + OVER_TIME_RESULTS,
            block=LawOfArrays._field_defaults["block"] if element.excitation.formula is None else _FORMULA_BLOCK,
        )
    results = _CONSTANTS
    results += _FREE if element.start is not None else ()
    results += _FORCED if element.excitation is not None else ()
    results += _THROUGH if element.run_through is not None else ()
    return LawOfArrays(
        with_nudges(partial(_rows, element, keys, tuple(r.name for r in results))),
        lambda given_element, given: tuple(given(key) for key in keys),
        results,
        infinite=Verdict.RESONANCE,
    )


def _keys(element: OscillatorElement) -> Iterator[str]:
    """Keys of all numbers that the element is given."""
    yield "mass"
    yield from (key for key in ("stiffness", *DAMPINGS) if getattr(element, key) is not None)
    if element.cantilever is not None:
        yield from (f"cantilever.{key}" for key in ("length", "diameter", "bore", "elastic_modulus"))
    if element.start is not None:
        yield from (f"start.{key}" for key in ("displacement", "velocity", "time"))
    match element.excitation:
        case None:
            pass
        case OverTime() as excitation:
            yield from (f"excitation.{key}" for key in over_time_keys(excitation))
        case unbalance if unbalance.type == "unbalance":
            yield from (f"excitation.{key}" for key in ("mass", "radius", "speed"))
        case _:
            yield from (f"excitation.{key}" for key in ("amplitude", "speed"))
    if element.run_through is not None:
        yield from ("run_through.start", "run_through.acceleration")


def oscillator_numbers(element: OscillatorElement) -> dict[str, np.ndarray]:
    """An oscillator's own numbers by their keys, as one variant."""
    numbers = element.excitation.numbers if isinstance(element.excitation, OverTime) else {}
    beside = {f"excitation.numbers.{name}": number.value for name, number in numbers.items()}
    return {
        key: np.array([beside[key] if key in beside else attrgetter(key)(element)], float) for key in _keys(element)
    }


def _rows_over_time(
    element: OscillatorElement, keys: tuple[str, ...], table: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Results under an excitation over time, and the magnitudes whose rounding they carry.

    With those of the numbers' rounding: what rounding of the mean motion leaves, and what the pieces of a formula miss.
    """
    names = tuple(result.name for result in _CONSTANTS + OVER_TIME_RESULTS)
    rows, sizes = with_nudges(partial(_rows, element, keys, names))(table)
    n = dict(zip(keys, table, strict=True))
    stiffness, _, ratio, _ = _constants(element, n)
    coarse, carried = over_time_columns(element, n, stiffness, ratio, PIECES // 2)
    for name, size in carried.items():
        sizes[names.index(name)] += size
    if element.excitation.formula is not None:
        for name, values in coarse.items():
            row = names.index(name)
            missed = np.abs(rows[row] - values) / (ROUNDING * np.finfo(float).eps)
            sizes[row] += np.where(np.isnan(missed), 0.0, missed)
    return rows, sizes


def _rows(element: OscillatorElement, keys: tuple[str, ...], names: tuple[str, ...], table: np.ndarray) -> np.ndarray:
    columns = oscillator_columns(element, dict(zip(keys, table, strict=True)))
    return np.stack([np.broadcast_to(columns[name], table.shape[1:]) for name in names])


def oscillator_columns(element: OscillatorElement, n: Numbers) -> Columns:
    """All results of one mass on a spring for a set of variants.

    Parameters
    ----------
    element : OscillatorElement
        What it is given; its numbers are not used.
    n : mapping of str to ndarray (variants,)
        Its numbers by their keys, such as "excitation.speed".

    Returns
    -------
    dict of str to ndarray (variants,)
        As named by `oscillator_law`; infinite at a resonance without damping, NaN for what there is not.
    """
    stiffness, frequency, ratio, damping = _constants(element, n)
    columns = {
        "stiffness": stiffness,
        "natural_frequency": frequency,
        "damping": damping,
        "damping_ratio": ratio,
        "damped_frequency": frequency * np.sqrt(np.where(ratio < 1.0, (1.0 - ratio) * (1.0 + ratio), math.nan)),
        "decrement": decrement_of_ratio(ratio),
        "energy_absorption": 2.0 * math.tau * ratio,
    }
    if isinstance(element.excitation, OverTime):
        return columns | over_time_columns(element, n, stiffness, ratio)[0]
    if element.start is not None:
        start = n["start.displacement"], n["start.velocity"]
        greatest, when = greatest_displacement(frequency, ratio, *start)
        moved, velocity = free_motion(frequency, ratio, *start, n["start.time"])
        columns |= {
            "free_greatest": greatest,
            "free_greatest_at": when,
            "free_displacement": moved,
            "free_velocity": velocity,
        }
    if element.excitation is not None:
        columns |= _forced(element, n, frequency, ratio, stiffness, damping)
    if element.run_through is not None:
        columns |= _run_through(n, frequency, ratio)
    return columns


def _constants(element: OscillatorElement, n: Numbers) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
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
        return ratio_from_decrement(n["decrement"])
    if "energy_absorption" in n:
        return ratio_from_absorption(n["energy_absorption"])
    return n.get("damping_ratio", np.zeros_like(mass))


def _forced(
    element: OscillatorElement,
    n: Numbers,
    frequency: np.ndarray,
    ratio: np.ndarray,
    stiffness: np.ndarray,
    damping: np.ndarray,
) -> Columns:
    """Steady vibration under a harmonic excitation, and where it would be greatest."""
    speed = n["excitation.speed"]
    eta = speed / frequency
    lag, factor = phase_lag(eta, ratio), dynamic_factor(eta, ratio)
    best, greatest = resonance_ratio(ratio), resonance_factor(ratio)
    match element.excitation.type:
        case "force":
            unit = n["excitation.amplitude"] / stiffness
        case "unbalance":
            unit = n["excitation.mass"] * n["excitation.radius"] / n["mass"]
            with np.errstate(divide="ignore"):
                factor, best = eta**2 * factor, 1.0 / best
        case "support_motion":
            unit = n["excitation.amplitude"]
            factor, lag = transmissibility(eta, ratio), transmission_lag(eta, ratio)
            best = support_resonance_ratio(ratio)
            greatest = transmissibility(best, ratio)
    amplitude = unit * factor
    # What stretches spring and damper: the motion against the support.
    stretch = eta**2 * dynamic_factor(eta, ratio) * unit if element.excitation.type == "support_motion" else amplitude
    with np.errstate(invalid="ignore"):
        # No power without a damper, however great the amplitude.
        power = np.where(damping > 0.0, 0.5 * damping * (speed * stretch) ** 2, 0.0)
    return {
        "frequency_ratio": eta,
        "dynamic_factor": factor,
        "amplitude": amplitude,
        "phase_lag": lag,
        "transmitted_force": stiffness * np.hypot(1.0, 2.0 * ratio * eta) * stretch,
        "dissipated_power": power,
        "resonance_speed": best * frequency,
        "resonance_amplitude": unit * greatest,
    }


def _run_through(n: Numbers, frequency: np.ndarray, ratio: np.ndarray) -> Columns:
    start, acceleration = n["run_through.start"], n["run_through.acceleration"]
    peak, time = run_through_peak(frequency, ratio, start, acceleration)
    unit = n["excitation.mass"] * n["excitation.radius"] / n["mass"]
    with np.errstate(invalid="ignore"):
        share = peak / resonance_factor(ratio)
    return {
        "run_through_amplitude": unit * peak,
        "run_through_speed": start + acceleration * time,
        "run_through_time": time,
        "run_through_share": share,
    }
