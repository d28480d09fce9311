"""Torque of one cylinder of an engine from evenly spaced positions, and its harmonics by a discrete transform."""

import math

import numpy as np


def motion(theta, radius, rod, offset=0.0):
    """The piston's way from the outer dead centre and its rate, and the rate of the rod's angle, all by theta."""
    outer = math.sqrt((rod + radius) ** 2 - offset**2)
    lean = np.arcsin((offset - radius * np.sin(theta)) / rod)
    travel = outer - radius * np.cos(theta) - rod * np.cos(lean)
    return travel, radius * np.sin(theta - lean) / np.cos(lean), -radius * np.cos(theta) / (rod * np.cos(lean))


def gas_torque(gas, bore, radius, rod, offset=0.0, count=28_800):
    """Over two turns from the outer dead centre at which the cylinder fires; `gas` holds the diagram's numbers."""
    top, bottom = math.asin(offset / (rod + radius)), math.pi + math.asin(offset / (rod - radius))
    turned = 4 * math.pi * np.arange(count) / count
    travel, rate, _ = motion(top + turned, radius, rod, offset)
    stroke = math.sqrt((rod + radius) ** 2 - offset**2) - math.sqrt((rod - radius) ** 2 - offset**2)
    c, second, down = gas["clearance"], turned >= 2 * math.pi, turned % (2 * math.pi) < bottom - top
    length = np.maximum(travel, 0.0) / stroke + c
    pressure = np.select(
        [down & ~second, ~down & ~second, down & second],
        [gas["peak"] * (c / length) ** gas["n_expansion"], gas["exhaust"], gas["intake"]],
        gas["intake"] * ((1 + c) / length) ** gas["n_compression"],
    )
    return (pressure - gas["outside"]) * math.pi / 4 * bore**2 * rate


def harmonics(curve, orders, turns=2):
    """Complex amplitudes of a curve over so many turns, evenly spaced, by orders of the crank."""
    places = np.rint(np.multiply(orders, turns)).astype(int)
    return np.fft.rfft(curve)[places] * (2 / curve.size)


def inertia_harmonics(mass, correction, radius, rod, orders, offset=0.0, count=1440):
    """Of −dE/dtheta over ω², from the outer dead centre; whole orders alone have any."""
    theta = math.asin(offset / (rod + radius)) + 2 * math.pi * np.arange(count) / count
    _, rate, swing = motion(theta, radius, rod, offset)
    energy = (mass * rate**2 + correction * swing**2) / 2
    whole = [n for n in orders if n % 1 == 0]
    found = dict(zip(whole, -1j * np.array(whole) * harmonics(energy, whole, 1), strict=True))
    return np.array([found.get(n, 0.0) for n in orders])
