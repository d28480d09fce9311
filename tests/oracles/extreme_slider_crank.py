"""A slider-crank whose every number goes to extremes, and its closed form in mpmath from the same float64 numbers.

In line, with an eccentric crank, a drag and a constant force. Each result comes with what rounding may do to it: a data
error of EPS moves the rod's projection √(l² − r² s²) by EPS/cos² of the rod's angle; every term is allowed ROUNDINGS of
that.
"""

import math
from itertools import pairwise

import mpmath as mp
import numpy as np
from machines import slider_crank

POSITIONS, ROUNDINGS = 24, 4
EPS = {np.float64: 2.0**-52, np.float32: 2.0**-23}
SLIDER_CRANK = slider_crank(
    speed=10.0,
    gravity=9.81,
    bodies={
        "eccentric": {"link": "crank", "mass": 2.0, "x": 0.01, "inertia": 0.02},
        "ram": {"link": "ram", "mass": 3.0},
    },
    forces={
        "push": {"type": "constant", "on": "B", "angle": 0.0, "force": -400.0},
        "oil": {"type": "linear_drag", "on": "B", "angle": 0.0, "coefficient": 30.0},
    },
    flywheel={"speed_fluctuation": 0.05, "wheel": {"type": "disc", "material": "steel"}},
)
# Short names of the numbers that go to extremes: usual value, powers of length, mass and speed that they scale with.
NUMBERS = {
    "r": ("input.length", 0.05, (1, 0, 0)),
    "l": ("groups.g.first.length", 0.2, (1, 0, 0)),
    "e": ("bodies.eccentric.x", 0.01, (1, 0, 0)),
    "me": ("bodies.eccentric.mass", 2.0, (0, 1, 0)),
    "J": ("bodies.eccentric.inertia", 0.02, (2, 1, 0)),
    "m": ("bodies.ram.mass", 3.0, (0, 1, 0)),
    "F": ("forces.push.force", -400.0, (1, 1, 2)),
    "c": ("forces.oil.coefficient", 30.0, (0, 1, 1)),
    "g": ("gravity", 9.81, (1, 0, 2)),
    "w": ("input.speed", 10.0, (0, 0, 1)),
    "d": ("flywheel.speed_fluctuation", 0.05, (0, 0, 0)),
}
FIELDS = {
    "x": ("B.x", (1, 0, 0)),
    "x1": ("B.x_phi", (1, 0, 0)),
    "x2": ("B.x_phiphi", (1, 0, 0)),
    "rod1": ("rod.angle_phi", (0, 0, 0)),
    "I": ("reduced_inertia", (2, 1, 0)),
    "I1": ("reduced_inertia_phi", (2, 1, 0)),
    "M": ("reduced_moment", (2, 1, 2)),
    "Q": ("input_moment", (2, 1, 2)),
    "W": ("work", (2, 1, 2)),
}
SUMMARIES = {
    "required_drive_moment": (2, 1, 2),
    "required_power": (2, 1, 3),
    "excess_work": (2, 1, 2),
    "flywheel_excess_work": (2, 1, 0),
    "flywheel_merzalov": (2, 1, 0),
    "flywheel_wittenbauer": (2, 1, 0),
    "speed_fluctuation": (0, 0, 0),
    "ram.stroke": (1, 0, 0),
}


def usual(**changes: float) -> dict[str, float]:
    return {name: value for name, (_, value, _) in NUMBERS.items()} | changes


# Each with what is meant to be hard about it.
CASES = {
    "usual": {},
    "rod longer by a tenth": {"l": 0.055},
    "rod longer by 1e-6": {"l": 0.05 * (1 + 1e-6)},
    "rod longer by 1e-12": {"l": 0.05 * (1 + 1e-12)},
    "rod a million cranks long": {"l": 5e4},
    "machine of micrometres": {"r": 1e-6, "l": 4e-6, "e": 1e-7},
    "machine of a thousand kilometres": {"r": 1e6, "l": 4e6, "e": 1e5},
    "crank of a micrometre, rod of a metre": {"r": 1e-6, "l": 1.0, "e": 1e-6},
    "ram of 1e-12 kg": {"m": 1e-12},
    "ram of 1e9 kg": {"m": 1e9},
    "all masses of 1e-12 kg": {"m": 1e-12, "me": 1e-12, "J": 1e-14},
    "all masses of 1e9 kg": {"m": 1e9, "me": 1e9, "J": 1e7},
    "ram of 1e-3 kg on a rotor of 1e9 kg·m²": {"m": 1e-3, "J": 1e9},
    "1e-9 rad/s": {"w": 1e-9},
    "a million revolutions a minute": {"w": 1e5},
    "a million revolutions a minute backwards": {"w": -1e5},
    "fluctuation of 1e-8": {"d": 1e-8},
    "fluctuation of 1.9": {"d": 1.9},
    "micrometres, 1e-12 kg, 1e5 rad/s": {
        "r": 1e-6,
        "l": 4e-6,
        "e": 1e-7,
        "m": 1e-12,
        "me": 1e-12,
        "J": 1e-24,
        "w": 1e5,
    },
    "kilometres, 1e9 kg, 1e-9 rad/s": {"r": 1e3, "l": 1.001e3, "e": 1.0, "m": 1e9, "me": 1e9, "J": 1e15, "w": 1e-9},
    "no load": {"F": 0.0, "c": 0.0, "g": 0.0},
    "drag alone, 1e-12 N·s/m": {"F": 0.0, "g": 0.0, "c": 1e-12},
    "force of 1e12 N": {"F": 1e12},
}


def paths(variants: list[dict]) -> dict[str, np.ndarray]:
    return {NUMBERS[name][0]: np.array([v[name] for v in variants]) for name in NUMBERS}


class Closed:
    """Rows and summaries of the slider-crank in mpmath, with what rounding may do to each, in units of EPS."""

    def __init__(self, nodes: np.ndarray, numbers: dict[str, float], dtype: type) -> None:
        self.v = {name: mp.mpf(float(dtype(value))) for name, value in numbers.items()}
        self.rows = {name: [] for name in FIELDS}
        self.slack = {name: [] for name in FIELDS}
        for phi in nodes:
            self._position(float(phi))
        h, moments = 2 * mp.pi / len(nodes), self.rows["M"]
        self.mean = mp.fsum(moments) / len(nodes)
        steps = [h / 2 * (a + b - 2 * self.mean) for a, b in pairwise(moments)]
        self.rows["W"] = [mp.fsum(steps[:k]) for k in range(len(nodes))]
        self.of_moments = max(self.slack["M"]) + ROUNDINGS * max(abs(m) for m in moments)
        self.slack["W"] = [len(nodes) * h * self.of_moments] * len(nodes)

    def _position(self, phi: float) -> None:
        r, rod, mass, speed, drag = (self.v[name] for name in ("r", "l", "m", "w", "c"))
        c, s = mp.cos(mp.mpf(phi)), mp.sin(mp.mpf(phi))
        root = mp.sqrt(rod**2 - (r * s) ** 2)
        # Where the crank is square to the guide, the height of its pin is the crank's length, without rounding.
        grown = ROUNDINGS * (1 if abs(math.sin(phi)) == 1.0 else (rod / root) ** 2)
        # Zeros of cosine and sine are off by EPS of 1, so sizes are those of terms without them.
        size1, size2 = r + r**2 / root, r + r**2 / root + (r**2 * s * c) ** 2 / root**3
        x1 = -r * s - r**2 * s * c / root
        x2 = -r * c - r**2 * (c * c - s * s) / root - (r**2 * s * c) ** 2 / root**3
        fixed, weight = self.v["J"] + self.v["me"] * self.v["e"] ** 2, self.v["me"] * self.v["g"] * self.v["e"]
        inertia, slope = fixed + mass * x1**2, 2 * mass * x1 * x2
        moment = self.v["F"] * x1 - drag * speed * x1**2 - weight * c
        of_slope = 2 * mass * grown * (abs(x2) * size1 + abs(x1) * size2)
        of_moment = grown * size1 * (abs(self.v["F"]) + 2 * abs(drag * speed * x1)) + ROUNDINGS * abs(weight)
        for name, value, slack in (
            ("x", r * c + root, grown * (r + root)),
            ("x1", x1, grown * size1),
            ("x2", x2, grown * size2),
            ("rod1", -r * c / root, grown * r / root),
            ("I", inertia, ROUNDINGS * inertia + 2 * mass * abs(x1) * grown * size1),
            ("I1", slope, of_slope),
            ("M", moment, of_moment),
            ("Q", speed**2 / 2 * slope - moment, speed**2 / 2 * of_slope + of_moment),
        ):
            self.rows[name].append(value)
            self.slack[name].append(slack)

    def summaries(self) -> dict[str, tuple[mp.mpf, mp.mpf]]:
        """Value, and what rounding may do to it in units of EPS."""
        w2, delta, pairs = self.v["w"] ** 2, self.v["d"], list(zip(self.rows["W"], self.rows["I"], strict=True))
        of_work, of_inertia, fixed = max(self.slack["W"]), max(self.slack["I"]), pairs[0][1]
        slow, middle, fast = (w2 / 2 * (1 + sign * delta / 2) ** 2 for sign in (-1, 0, 1))
        excess, loop = max(self.rows["W"]) - min(self.rows["W"]), [w - middle * i for w, i in pairs]
        by_excess, merzalov = excess / (delta * w2), (max(loop) - min(loop)) / (delta * w2)
        wittenbauer = (max(w - fast * i for w, i in pairs) - min(w - slow * i for w, i in pairs)) / (delta * w2)
        of_size = 2 * (of_work + fast * of_inertia) / (delta * w2) + ROUNDINGS * (by_excess + merzalov + fixed)
        wheel = max(wittenbauer, mp.mpf(0))
        # Of the speeds √(2 E/I), through E and I, and through the wheel where there is one.
        of_speed = (2 * of_work / w2 + of_inertia + (of_size if wheel else 0)) / (wheel + min(i for _, i in pairs))
        first_kind = self.v["J"] + self.v["me"] * self.v["e"] ** 2
        return {
            "required_drive_moment": (-self.mean, self.of_moments),
            "required_power": (-self.mean * self.v["w"], self.of_moments * abs(self.v["w"])),
            "excess_work": (excess, 2 * of_work),
            "flywheel_excess_work": (by_excess, of_size),
            "flywheel_merzalov": (merzalov - first_kind, of_size),
            "flywheel_wittenbauer": (wittenbauer, of_size),
            "speed_fluctuation": (true_fluctuation(pairs, wheel, abs(self.v["w"])), 4 + 2 * of_speed),
        }


def true_fluctuation(pairs: list[tuple], wheel: mp.mpf, mean: mp.mpf) -> mp.mpf:
    """δ of rows (W, I) with a flywheel: the initial energy by bisection; NaN where the machine would stop."""

    def speeds(energy: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
        squares = [2 * (energy + w) / (i + wheel) for w, i in pairs]
        return mp.sqrt(max(min(squares), 0)), mp.sqrt(max(squares))

    low = -min(w for w, _ in pairs)
    if sum(speeds(low)) / 2 > mean:
        return mp.nan
    high = low + max(w for w, _ in pairs) + 2 * (max(i for _, i in pairs) + wheel) * mean**2
    for _ in range(160):
        middle = (low + high) / 2
        low, high = (low, middle) if sum(speeds(middle)) / 2 > mean else (middle, high)
    slowest, fastest = speeds(low)
    return (fastest - slowest) / mean
