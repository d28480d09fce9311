"""Slider-cranks, crank-rockers and slotted levers by stroke and quick-return ratio, in closed form.

The slow stroke takes the crank angle π + θ, the fast one π − θ, so K = (π + θ)/(π − θ). At the ends of the stroke crank
and coupler are in line: the end positions of the driven joint are b − a and b + a from the crank pivot and subtend θ
there, with the chord s. By the law of cosines

    (2 a cos(θ/2))² + (2 b sin(θ/2))² = s²,

and the pivot lies (b² − a²) sin θ / s off the line through the end positions.

References
----------
VDI 2130: Getriebe für Hub- und Schwingbewegungen; Konstruktion und Berechnung viergliedriger ebener Gelenkgetriebe für
gegebene Totlagen.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from sweeps.synthesis.positioned import least_transmission
from sweeps.synthesis.synthesis_error import SynthesisError

# _Trial lengths in the range, and refinements about the best.
_TRIALS, _FINER = 200, 12


class QuickSliderCrank(NamedTuple):
    """An offset slider-crank: crank, rod, offset of the slider's line [m]; minimum transmission angle [rad]."""

    crank: float
    rod: float
    offset: float
    least_transmission: float


class QuickCrankRocker(NamedTuple):
    """A crank-rocker: lengths of its links [m]; minimum transmission angle [rad]."""

    crank: float
    coupler: float
    rocker: float
    frame: float
    least_transmission: float


class QuickLever(NamedTuple):
    """A slotted lever on the crankpin: crank, lever, distance of the pivots [m]; swing [rad]."""

    crank: float
    lever: float
    frame: float
    swing: float


_Linkage = QuickSliderCrank | QuickCrankRocker
# The linkage with a length of its coupler, if there is one.
_Trial = Callable[[float], _Linkage | None]


def quick_return_angle(ratio: float) -> float:
    """Crank angle θ [rad] of the slow stroke beyond half a turn, θ = π (K − 1)/(K + 1).

    Parameters
    ----------
    ratio : float
        Quick-return ratio K: time of the slow stroke over that of the fast one.

    Raises
    ------
    SynthesisError
        It is less than 1, or not finite.
    """
    if not 1.0 <= ratio < math.inf:
        raise SynthesisError(f"invalid quick-return ratio {ratio:g}: it must be at least 1")
    return math.pi * (ratio - 1.0) / (ratio + 1.0)


def quick_slider_crank(stroke: float, ratio: float, rod: float | None = None) -> QuickSliderCrank:
    """Offset slider-crank with a given stroke and quick-return ratio.

    Parameters
    ----------
    stroke : float
        [m]
    ratio : float
        Time of the slow stroke over that of the fast one.
    rod : float, optional
        [m] (default: that of the best transmission angle).

    Raises
    ------
    SynthesisError
        There is none.
    """
    theta = _checked(stroke, "stroke", ratio)
    if rod is None and theta == 0.0:
        raise SynthesisError("at a quick-return ratio of 1 any rod longer than half the stroke works: give the rod")
    none = f"no slider-crank has a quick-return ratio of {ratio:g}: it must be less than 3"
    words = f"a stroke of {stroke:g} m with a quick-return ratio of {ratio:g}"
    not_this = f"no slider-crank with a rod of {{:g}} m has {words}"
    return _chosen(partial(_slider_crank, stroke, theta), rod, _lengths(stroke, theta), none, not_this)


def quick_crank_rocker(rocker: float, swing: float, ratio: float, coupler: float | None = None) -> QuickCrankRocker:
    """Crank-rocker with a given swing and quick-return ratio.

    Parameters
    ----------
    rocker : float
        Length of the rocker [m].
    swing : float
        [rad]
    ratio : float
        Time of the slow swing over that of the fast one.
    coupler : float, optional
        [m] (default: that of the best transmission angle).

    Raises
    ------
    SynthesisError
        There is none.
    """
    theta = _checked(rocker, "length of the rocker", ratio)
    if not 0.0 < swing < math.pi:
        raise SynthesisError(f"a rocker can't swing by {math.degrees(swing):g}°: the swing must be between 0 and 180°")
    chord = 2.0 * rocker * math.sin(0.5 * swing)
    words = f"a swing of {math.degrees(swing):g}° with a quick-return ratio of {ratio:g}"
    none = f"no crank-rocker has {words}: use a lower ratio, or a slotted lever"
    not_this = f"no crank-rocker with a coupler of {{:g}} m has {words}"
    trial = partial(_crank_rocker, rocker, swing, theta)
    return _chosen(trial, coupler, _lengths(chord, theta, rocker), none, not_this)


def quick_lever(stroke: float, ratio: float, frame: float) -> QuickLever:
    """Slotted lever with a given stroke of its end and quick-return ratio; the crankpin slides in its slot.

    At the ends of its swing θ the lever is tangent to the crank circle.

    Parameters
    ----------
    stroke : float
        Chord of the path of the lever's end [m].
    ratio : float
        Time of the slow stroke over that of the fast one, more than 1.
    frame : float
        Distance between the crank and lever pivots [m].

    Raises
    ------
    SynthesisError
        There is none.
    """
    theta = _checked(stroke, "stroke", ratio)
    if not 0.0 < frame < math.inf:
        raise SynthesisError(f"invalid distance of the pivots {frame:g} m: it must be positive and finite")
    if theta == 0.0:
        raise SynthesisError("a slotted lever always returns faster: give a quick-return ratio greater than 1")
    half = math.sin(0.5 * theta)
    return QuickLever(frame * half, stroke / (2.0 * half), frame, theta)


def _checked(length: float, what: str, ratio: float) -> float:
    if not 0.0 < length < math.inf:
        raise SynthesisError(f"invalid {what} {length:g} m: it must be greater than 0")
    return quick_return_angle(ratio)


def _crank(chord: float, theta: float, coupler: float) -> float:
    """Crank for a given chord between the end positions; 0 if the coupler is too long."""
    left = (chord - 2.0 * coupler * math.sin(0.5 * theta)) * (chord + 2.0 * coupler * math.sin(0.5 * theta))
    return math.sqrt(max(0.0, left)) / (2.0 * math.cos(0.5 * theta))


def _slider_crank(stroke: float, theta: float, rod: float) -> QuickSliderCrank | None:
    crank = _crank(stroke, theta, rod)
    # Both ends must lie on the same side of the pivot's foot; else the rod swings over, or the slider reverses between.
    if not 0.0 < crank < rod or 4.0 * crank * rod <= stroke * stroke:
        return None
    offset = (rod - crank) * (rod + crank) * math.sin(theta) / stroke
    if crank + offset >= rod:
        return None
    return QuickSliderCrank(crank, rod, offset, math.acos((crank + offset) / rod))


def _crank_rocker(rocker: float, swing: float, theta: float, coupler: float) -> QuickCrankRocker | None:
    half, height = rocker * math.sin(0.5 * swing), rocker * math.cos(0.5 * swing)
    crank = _crank(2.0 * half, theta, coupler)
    if not 0.0 < crank < coupler:
        return None
    # End positions at x = ±half, the rocker pivot below them, the crank pivot on either side.
    x = -crank * coupler / half
    y = (coupler - crank) * (coupler + crank) * math.sin(theta) / (2.0 * half)
    found = []
    for side in (1.0, -1.0) if y > 0.0 else (1.0,):
        frame = math.hypot(x, side * y + height)
        # Both end positions are on the same side of the pivots' line: one assembly mode.
        ends = [_cross(x, side * y, end, height) for end in (-half, half)]
        # The rocker turns, too, unless the crank is the shortest link.
        least = least_transmission(crank, coupler, rocker, frame) if crank < min(coupler, rocker, frame) else None
        if ends[0] * ends[1] > 0.0 and least is not None:
            found.append(QuickCrankRocker(crank, coupler, rocker, frame, least))
    return max(found, key=lambda four_bar: four_bar.least_transmission, default=None)


def _cross(x: float, y: float, end: float, height: float) -> float:
    """Side of an end position relative to the line from crank pivot to rocker pivot."""
    return x * y + (height + y) * (end - x)


def _lengths(chord: float, theta: float, usual: float = 0.0) -> tuple[float, float]:
    """Range of trial coupler lengths."""
    longest = 20.0 * max(chord, usual)
    return 0.25 * chord, min(longest, chord / (2.0 * math.sin(0.5 * theta))) if theta > 0.0 else longest


def _chosen(trial: _Trial, length: float | None, ends: tuple[float, float], none: str, not_this: str) -> _Linkage:
    """The linkage with a given length, by default the best one in a range; else why there is none."""
    if length is None and (length := _best(trial, ends)) is None:
        raise SynthesisError(none)
    if (found := trial(length)) is None:
        raise SynthesisError(f"{not_this.format(length)}: {_reach(trial, ends)}")
    return found


def _best(trial: _Trial, ends: tuple[float, float]) -> float | None:
    """Length with the largest minimum transmission angle, from a refined grid."""
    low, high = ends
    best = None
    for _ in range(_FINER):
        step = (high - low) / _TRIALS
        known = {length: trial(length) for length in (low + (i + 0.5) * step for i in range(_TRIALS))}
        sound = {length: found.least_transmission for length, found in known.items() if found is not None}
        if not sound:
            break
        best = max(sound, key=sound.__getitem__)
        low, high = best - 1.5 * step, best + 1.5 * step
    return best


def _reach(trial: _Trial, ends: tuple[float, float]) -> str:
    """Feasible lengths, as text."""
    low, high = ends
    trials = [low + (high - low) * i / (10 * _TRIALS) for i in range(10 * _TRIALS + 1)]
    sound = [length for length in trials if trial(length) is not None]
    return f"it may be about {sound[0]:.4g} to {sound[-1]:.4g} m long" if sound else "use a lower quick-return ratio"
