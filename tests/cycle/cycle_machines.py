"""Machines written by hand as the four functions that `engine.cycle` takes, and the same mechanics in plain NumPy."""

import math

import numpy as np

from engine.cycle.compiling import curves_function
from engine.cycle.lanes import LANES, in_lanes
from engine.cycle.machine import Machine, Plan

# Numbers of the press: a slider-crank with an offset, a load on the slider between two levels of its stroke on the way in
# and between two crank angles.
FIRST, LAST, R, L, E, M, J, F, G, FROM, TO, LOW, HIGH, LOW_AT, HIGH_AT = range(15)
LEVEL_A, LEVEL_B, ON_STROKE, ON_ANGLE, ZERO, OMEGA, WHEEL, LOAD = range(15, 23)
NUMBERS = 23


@curves_function
def press_events(P, T, q, cos_q, sin_q, tile):
    count, room = q.shape[0], tile.shape[1]
    P, q, cos_q, sin_q, tile = in_lanes(P), in_lanes(q), in_lanes(cos_q), in_lanes(sin_q), in_lanes(tile)
    for i in range(count):
        for k in range(LANES):
            r, length, y = P[R, k], P[L, k], P[R, k] * sin_q[i, k] - P[E, k]
            root = math.sqrt(length * length - y * y)
            tile[i, k] = r * cos_q[i, k] + root
            tile[room + i, k] = -r * sin_q[i, k] - y * r * cos_q[i, k] / root


@curves_function
def press_levels(P, T, q, cos_q, sin_q, tile):
    room = tile.shape[1]
    P, tile = in_lanes(P), in_lanes(tile)
    for k in range(LANES):
        stroke = P[HIGH, k] - P[LOW, k]
        tile[0, k], tile[room, k] = P[LOW, k] + 0.1 * stroke, P[LOW, k] + 0.4 * stroke


@curves_function
def press_states(P, T, q, cos_q, sin_q, tile):
    count, room = q.shape[0], tile.shape[1]
    P, q, cos_q, sin_q, tile = in_lanes(P), in_lanes(q), in_lanes(cos_q), in_lanes(sin_q), in_lanes(tile)
    for i in range(count):
        for k in range(LANES):
            r, length, y = P[R, k], P[L, k], P[R, k] * sin_q[i, k] - P[E, k]
            root = math.sqrt(length * length - y * y)
            x, v = r * cos_q[i, k] + root, -r * sin_q[i, k] - y * r * cos_q[i, k] / root
            on_stroke = (x > P[LEVEL_A, k]) & (x < P[LEVEL_B, k]) & (v < 0.0)
            on_angle = (q[i, k] > P[FROM, k]) & (q[i, k] < P[TO, k])
            tile[i, k] = (P[F, k] if on_stroke else 0.0) + (P[G, k] if on_angle else 0.0)


@curves_function
def press_curves(P, T, q, cos_q, sin_q, tile):
    count, room = q.shape[0], tile.shape[1]
    P, q, cos_q, sin_q, tile = in_lanes(P), in_lanes(q), in_lanes(cos_q), in_lanes(sin_q), in_lanes(tile)
    for i in range(count):
        for k in range(LANES):
            r, length, y = P[R, k], P[L, k], P[R, k] * sin_q[i, k] - P[E, k]
            root = math.sqrt(length * length - y * y)
            v = -r * sin_q[i, k] - y * r * cos_q[i, k] / root
            tile[i, k] = P[J, k] + P[M, k] * v * v
            tile[room + i, k] = P[LOAD, k] * v


def press_numbers(variants, rng):
    """Random presses; loads are opposed to the motion where they act on the way in."""
    P = np.zeros((NUMBERS, variants))
    P[LAST] = 2.0 * np.pi
    P[R], P[L], P[E] = (
        rng.uniform(0.05, 0.15, variants),
        rng.uniform(0.35, 0.6, variants),
        rng.uniform(-0.03, 0.03, variants),
    )
    P[M], P[J], P[F] = (
        rng.uniform(1.0, 10.0, variants),
        rng.uniform(0.1, 1.0, variants),
        rng.uniform(100.0, 1000.0, variants),
    )
    P[FROM] = P[TO] = np.nan
    P[OMEGA], P[WHEEL] = rng.uniform(5.0, 30.0, variants), rng.uniform(5.0, 50.0, variants)
    return P


def press(**asked):
    """The press, cut where its load sets in and ends; curves are its inertia (0) and the moment of the load (1)."""
    plan = Plan(
        ends=(FIRST, LAST),
        curves=2,
        landmarks=[(LOW, HIGH, LOW_AT, HIGH_AT)],
        levels=[LEVEL_A, LEVEL_B],
        states=[LOAD],
        crossings=[(0, LEVEL_A), (0, LEVEL_B)],
        cuts=[FROM, TO],
        **asked,
    )
    return Machine(plan, press_curves, press_events, press_levels, press_states)


def slide(P, q):
    """Place of the slider, in NumPy or mpmath."""
    y = P[R] * np.sin(q) - P[E]
    return P[R] * np.cos(q) + np.sqrt(P[L] ** 2 - y**2)
