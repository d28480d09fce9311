"""Machines written by hand as the three functions that `engine.cycle` takes."""

import math
from functools import cache

import numpy as np
from numba import njit
from printed_calls import FillsTile

from engine.compiling.blocks import LANES, in_lanes
from engine.compiling.compilers import Apart
from engine.compiling.decorators import RULES
from engine.compiling.printed_functions import signature_of
from engine.cycle.cycle_machine import CycleMachine
from engine.cycle.plan import Kept, Plan

# Numbers of the press, a slider-crank with an offset: range of the input; crank, rod, offset; mass of the slider,
# inertia of the crank; a force on the slider between two levels of its stroke as it approaches the crank's axis,
# another between two positions of the input.
FIRST, LAST, CRANK, ROD, OFFSET, MASS, INERTIA, FORCE, OTHER_FORCE, FROM, TO = range(11)
# Levels as shares of the stroke, from its near end; mean speed and flywheel.
NEAR_SHARE, FAR_SHARE, SPEED, WHEEL = range(11, 15)
# What the cycle fills in.
LOW, HIGH, LOW_AT, HIGH_AT, NEAR, FAR, LOAD = range(15, 22)
NUMBERS = 22

COMPILED = {"error_model": "numpy", "fastmath": set(RULES), "nogil": True, "pipeline_class": Apart}


def at_positions(law):
    """What makes a function that fills a tile by a law: what its curves are in a lane at a position.

    It compiles when first called, in the process that needs it.
    """

    @cache
    def made():
        compiled = njit(error_model="numpy", fastmath=set(RULES))(law)

        @njit(signature_of("tile"), **COMPILED)
        def filled(P, T, q, cos_q, sin_q, tile):
            count, room = q.shape[0], tile.shape[1]
            P, q, cos_q, sin_q, tile = in_lanes(P), in_lanes(q), in_lanes(cos_q), in_lanes(sin_q), in_lanes(tile)
            for i in range(count):
                for lane in range(LANES):
                    compiled(P, lane, q[i, lane], cos_q[i, lane], sin_q[i, lane], tile, i, room)

        return FillsTile(filled)

    return made


@at_positions
def press_events(P, lane, q, c, s, tile, i, room):
    r, length, y = P[CRANK, lane], P[ROD, lane], P[CRANK, lane] * s - P[OFFSET, lane]
    root = math.sqrt(length * length - y * y)
    place, rate = r * c + root, -r * s - y * r * c / root
    tile[i, lane], tile[room + i, lane] = place, rate
    on_stroke = (place > P[NEAR, lane]) & (place < P[FAR, lane]) & (rate < 0.0)
    on_input = (q > P[FROM, lane]) & (q < P[TO, lane])
    held = (P[FORCE, lane] if on_stroke else 0.0) + (P[OTHER_FORCE, lane] if on_input else 0.0)
    tile[2 * room + i, lane] = held


@at_positions
def press_levels(P, lane, q, c, s, tile, i, room):
    stroke = P[HIGH, lane] - P[LOW, lane]
    tile[0, lane] = P[LOW, lane] + P[NEAR_SHARE, lane] * stroke
    tile[1, lane] = P[LOW, lane] + P[FAR_SHARE, lane] * stroke


@at_positions
def press_curves(P, lane, q, c, s, tile, i, room):
    r, length, y = P[CRANK, lane], P[ROD, lane], P[CRANK, lane] * s - P[OFFSET, lane]
    rate = -r * s - y * r * c / math.sqrt(length * length - y * y)
    tile[i, lane] = P[INERTIA, lane] + P[MASS, lane] * rate * rate
    tile[room + i, lane] = P[LOAD, lane] * rate


def press_numbers(variants, **given):
    """P of presses; what isn't given is the same for all."""
    numbers = np.full((NUMBERS, variants), np.nan)
    usual = {"first": 0.0, "last": 2.0 * np.pi, "crank": 0.1, "rod": 0.4, "offset": 0.02, "mass": 5.0, "inertia": 0.5}
    usual |= {"force": 0.0, "other_force": 0.0, "from_": np.nan, "to": np.nan, "near_share": 0.1, "far_share": 0.4}
    usual |= {"speed": 20.0, "wheel": 10.0}
    for row, name in enumerate(usual):
        numbers[row] = given.get(name, usual[name])
    return numbers


def planned(*places, extremes=(), integrals=(), roots=(), averages=(), spaced=(), arcs=(), **settings):
    """A plan; extremes of curves of the machine by their numbers, which sides may follow."""
    plan = Plan(*places, **settings)
    wanted = {"integrals": integrals, "roots": roots, "averages": averages, "spaced": spaced, "arcs": arcs}
    for measure, all_of_it in wanted.items():
        for one in all_of_it:
            plan.find(measure, one)
    for one in extremes:
        curve, *sides = one if isinstance(one, tuple) else (one,)
        plan.find_extremes(Kept((curve,)) if isinstance(curve, int) else curve, *sides)
    return plan


def press(**asked):
    """The press, cut where its loads set in and end; curves are its inertia (0) and the moment of the loads (1)."""
    loads = {"levels": [NEAR, FAR], "states": [LOAD], "crossings": [(0, NEAR, 0.0), (0, FAR, 0.0)], "cuts": [FROM, TO]}
    plan = planned(ends=(FIRST, LAST), curves=2, landmarks=[(LOW, HIGH, LOW_AT, HIGH_AT)], **loads, **asked)
    return CycleMachine(plan, press_curves(), press_events(), press_levels())


def slide(numbers, q):
    """Place of the slider of presses."""
    y = numbers[CRANK] * np.sin(q) - numbers[OFFSET]
    return numbers[CRANK] * np.cos(q) + np.sqrt(numbers[ROD] ** 2 - y**2)


# Numbers of a few smooth curves: range; eccentricity e; cosine and sine of a phase.
CURVE_FIRST, CURVE_LAST, ECCENTRICITY, COS_PHASE, SIN_PHASE = range(5)


@at_positions
def smooth_curves(P, lane, q, c, s, tile, i, room):
    along = c * P[COS_PHASE, lane] + s * P[SIN_PHASE, lane]
    across = s * P[COS_PHASE, lane] - c * P[SIN_PHASE, lane]
    e = P[ECCENTRICITY, lane]
    tile[i, lane], tile[room + i, lane] = 1.0 / (1.0 + e * along), math.sqrt(1.0 - e * e * across * across)
    tile[2 * room + i, lane], tile[3 * room + i, lane] = along, 2.5


def smooth_numbers(e, phase, first=0.0, last=2.0 * np.pi):
    """P of the smooth curves 1/(1 + e cos x), √(1 − e² sin² x), cos x and 2.5, where x = q − phase."""
    e, phase, first, last = np.broadcast_arrays(e, phase, first, last)
    return np.array([first, last, e, np.cos(phase), np.sin(phase)], dtype=float)


def smooth(**asked):
    """The smooth curves, with nothing that switches."""
    return CycleMachine(planned(ends=(CURVE_FIRST, CURVE_LAST), curves=4, **asked), smooth_curves())


# Harmonics of a wave: cosine and sine parts of order k in rows 2 k and 2 k + 1, the range in the first two.
ORDERS = 7


@at_positions
def wave_curve(P, lane, q, c, s, tile, i, room):
    cos_k, sin_k, total = c, s, 0.0
    for k in range(1, ORDERS):
        total += P[2 * k, lane] * cos_k + P[2 * k + 1, lane] * sin_k
        cos_k, sin_k = cos_k * c - sin_k * s, sin_k * c + cos_k * s
    tile[i, lane] = total


@at_positions
def rounding_curves(P, lane, q, c, s, tile, i, room):
    # Nothing but rounding, and a wave with rounding far above what is tolerated.
    tile[i, lane] = 1e3 * ((c * c + s * s) - 1.0)
    tile[room + i, lane] = (1e6 + c) - 1e6


@at_positions
def peak_curve(P, lane, q, c, s, tile, i, room):
    tile[i, lane] = 1.0 / (P[2, lane] + (1.0 - (c * P[3, lane] + s * P[4, lane])))


@at_positions
def force_curves(P, lane, q, c, s, tile, i, room):
    x = q - P[3, lane]
    angle, size = P[2, lane] * math.sin(x), 1.0 + 0.5 * math.cos(x)
    tile[i, lane], tile[room + i, lane] = size * math.cos(angle), size * math.sin(angle)
    tile[2 * room + i, lane] = size * size
    fading = 0.25 * (1.0 + math.cos(x)) ** 2
    tile[3 * room + i, lane], tile[4 * room + i, lane] = fading * math.cos(x), fading * math.sin(x)
    tile[5 * room + i, lane] = fading * fading
    tile[6 * room + i, lane] = P[2, lane] * math.cos(x)


def forces(**asked):
    """A force that swings by ± a, numbers 2, about the x axis, and one that turns and fades behind it; squares of both.

    Both with a phase, number 3; the last curve is the rate of the first one's angle.
    """
    return CycleMachine(planned(ends=(0, 1), curves=7, **asked), force_curves())


def force_numbers(swing, phase):
    """P of the forces over a whole turn."""
    swing, phase = np.broadcast_arrays(swing, phase)
    return np.array([np.zeros(swing.size), np.full(swing.size, 2.0 * np.pi), swing, phase], dtype=float)


@at_positions
def square_curve(P, lane, q, c, s, tile, i, room):
    along = c * P[COS_PHASE, lane] + s * P[SIN_PHASE, lane]
    across = P[ECCENTRICITY, lane] * (s * P[COS_PHASE, lane] - c * P[SIN_PHASE, lane])
    tile[i, lane] = along * along + across * across


def squares(**asked):
    """The square cos² x + b² sin² x of a vector that nearly vanishes twice; numbers as of `smooth_numbers`, b for e."""
    return CycleMachine(planned(ends=(CURVE_FIRST, CURVE_LAST), curves=1, **asked), square_curve())
