"""Slider-cranks, crank-rockers and swinging levers by stroke and time ratio, in closed form.

The slow stroke takes the crank angle π + θ, the fast one π − θ, so that K = (π + θ)/(π − θ). At the ends of the stroke
crank and coupler are in line: the end positions of the joint they drive are b − a and b + a away from the crank's
bearing, which sees the chord s between them under θ. By the law of cosines

    (2 a cos(θ/2))² + (2 b sin(θ/2))² = s²,

and the bearing lies (b² − a²) sin θ / s off the line through the end positions.

References
----------
VDI 2130: Getriebe für Hub- und Schwingbewegungen; Konstruktion und Berechnung viergliedriger ebener Gelenkgetriebe für
gegebene Totlagen.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

from sweeps.synthesis.synthesis_error import SynthesisError

# Trial lengths in the range, and the number of refinements about the best.
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
    """A lever with the crank's pin in its slot: crank, lever, distance of their bearings [m]; its swing [rad]."""

    crank: float
    lever: float
    frame: float
    swing: float


def quick_return_angle(ratio: float) -> float:
    """Crank angle θ [rad] by which the slow stroke is longer than half a turn, θ = π (K − 1)/(K + 1).

    Parameters
    ----------
    ratio : float
        Time of the slow stroke over that of the fast one, K.

    Raises
    ------
    SynthesisError
        It is less than 1, or not finite.
    """
    if not 1.0 <= ratio < math.inf:
        raise SynthesisError(
            f"a time ratio of {ratio:g} makes no sense: it is that of the slow stroke to the fast one, 1 or more"
        )
    return math.pi * (ratio - 1.0) / (ratio + 1.0)


def quick_slider_crank(stroke: float, ratio: float, rod: float | None = None) -> QuickSliderCrank:
    """Offset slider-crank of a stroke and a time ratio.

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
    words = f"a stroke of {stroke:g} m with a time ratio of {ratio:g}"

    def trial(length: float) -> QuickSliderCrank | None:
        return _slider_crank(stroke, theta, length)

    if rod is None:
        if theta == 0.0:
            raise SynthesisError("at a time ratio of 1 any rod longer than half the stroke will do: give the rod")
        rod = _best(trial, _lengths(stroke, theta))
        if rod is None:
            raise SynthesisError(f"no slider-crank has a time ratio of {ratio:g}: it must be less than 3")
    found = trial(rod)
    if found is None:
        reach = _reach(trial, stroke, theta)
        raise SynthesisError(f"no slider-crank with a rod of {rod:g} m has {words}: {reach}")
    return found


def quick_crank_rocker(rocker: float, swing: float, ratio: float, coupler: float | None = None) -> QuickCrankRocker:
    """Crank-rocker of a swing and a time ratio.

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
        raise SynthesisError(f"a swing of {math.degrees(swing):g}° is not one of a rocker: between 0 and 180°")

    def trial(length: float) -> QuickCrankRocker | None:
        return _crank_rocker(rocker, swing, theta, length)

    chord = 2.0 * rocker * math.sin(0.5 * swing)
    words = f"a swing of {math.degrees(swing):g}° with a time ratio of {ratio:g}"
    if coupler is None:
        coupler = _best(trial, _lengths(chord, theta, rocker))
        if coupler is None:
            raise SynthesisError(f"no crank-rocker has {words}: take a lower ratio, or a drive with a swinging lever")
    found = trial(coupler)
    if found is None:
        raise SynthesisError(
            f"no crank-rocker with a coupler of {coupler:g} m has {words}: {_reach(trial, chord, theta, rocker)}"
        )
    return found


def quick_lever(stroke: float, ratio: float, frame: float) -> QuickLever:
    """Swinging lever of a stroke of its end and a time ratio: the crank's pin slides in its slot.

    At the ends of its swing, which is θ, the lever is a tangent of the crank's circle.

    Parameters
    ----------
    stroke : float
        Chord of the path of the lever's end [m].
    ratio : float
        Time of the slow stroke over that of the fast one, more than 1.
    frame : float
        Distance of the bearings of crank and lever [m].

    Raises
    ------
    SynthesisError
        There is none.
    """
    theta = _checked(stroke, "stroke", ratio)
    if not 0.0 < frame < math.inf:
        raise SynthesisError(f"a distance of the bearings of {frame:g} m makes no sense: it must be greater than 0")
    if theta == 0.0:
        raise SynthesisError("a swinging lever always returns faster than it goes: give a time ratio greater than 1")
    half = math.sin(0.5 * theta)
    return QuickLever(frame * half, stroke / (2.0 * half), frame, theta)


def _checked(length: float, what: str, ratio: float) -> float:
    if not 0.0 < length < math.inf:
        raise SynthesisError(f"a {what} of {length:g} m makes no sense: it must be greater than 0")
    return quick_return_angle(ratio)


def _crank(chord: float, theta: float, coupler: float) -> float:
    """Crank whose end positions are a chord apart; 0 where the coupler is too long for them."""
    left = (chord - 2.0 * coupler * math.sin(0.5 * theta)) * (chord + 2.0 * coupler * math.sin(0.5 * theta))
    return math.sqrt(max(0.0, left)) / (2.0 * math.cos(0.5 * theta))


def _slider_crank(stroke: float, theta: float, rod: float) -> QuickSliderCrank | None:
    crank = _crank(stroke, theta, rod)
    # Both ends lie on the same side of the foot of the bearing; else the rod swings over, or the slider turns between.
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
    # The end positions lie at −half and half of x, the rocker's bearing below them, the crank's on either side.
    x = -crank * coupler / half
    y = (coupler - crank) * (coupler + crank) * math.sin(theta) / (2.0 * half)
    found = []
    for side in (1.0, -1.0) if y > 0.0 else (1.0,):
        frame = math.hypot(x, side * y + height)
        # Both end positions are on the same side of the line of the bearings: one assembly mode.
        ends = [_cross(x, side * y, end, height) for end in (-half, half)]
        if ends[0] * ends[1] > 0.0 and _turns(crank, coupler, rocker, frame):
            least = _least_transmission(crank, coupler, rocker, frame)
            found.append(QuickCrankRocker(crank, coupler, rocker, frame, least))
    return max(found, key=lambda four_bar: four_bar.least_transmission, default=None)


def _cross(x: float, y: float, end: float, height: float) -> float:
    """On which side of the line from the crank's bearing to the rocker's an end position lies."""
    return x * y + (height + y) * (end - x)


def _turns(crank: float, coupler: float, rocker: float, frame: float) -> bool:
    """Whether a crank turns fully and its rocker doesn't: Grashof's rule, the crank the shortest link."""
    others = (coupler, rocker, frame)
    return crank < min(others) and crank + max(others) < sum(others) - max(others)


def _least_transmission(crank: float, coupler: float, rocker: float, frame: float) -> float:
    """Least angle between coupler and rocker, as an acute one: where the crank is in line with the frame."""

    def angle(apart: float) -> float:
        cosine = (coupler * coupler + rocker * rocker - apart * apart) / (2.0 * coupler * rocker)
        return math.acos(min(1.0, abs(cosine)))

    return min(angle(frame - crank), angle(frame + crank))


def _lengths(chord: float, theta: float, usual: float = 0.0) -> tuple[float, float]:
    """Range of coupler lengths that are tried."""
    longest = 20.0 * max(chord, usual)
    return 0.25 * chord, min(longest, chord / (2.0 * math.sin(0.5 * theta))) if theta > 0.0 else longest


def _best(
    trial: Callable[[float], QuickSliderCrank | QuickCrankRocker | None], ends: tuple[float, float]
) -> float | None:
    """Length with the largest minimum transmission angle: the best of a grid, refined between its neighbours."""
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


def _reach(
    trial: Callable[[float], QuickSliderCrank | QuickCrankRocker | None], chord: float, theta: float, usual: float = 0.0
) -> str:
    """Between which lengths there are mechanisms, in words."""
    low, high = _lengths(chord, theta, usual)
    trials = [low + (high - low) * i / (10 * _TRIALS) for i in range(10 * _TRIALS + 1)]
    sound = [length for length in trials if trial(length) is not None]
    return f"it may be about {sound[0]:.4g} to {sound[-1]:.4g} m long" if sound else "take a lower time ratio"
