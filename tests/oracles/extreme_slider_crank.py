"""A slider-crank whose every number goes to extremes, and its closed form in mpmath from the same numbers.

It has an eccentric crank, a drag and a constant force. Each field comes with what rounding may do to it: a data error
of EPS moves the rod's projection √(l² − y²) by EPS/cos² of its angle; every term is allowed ROUNDINGS of that.
Summaries are those of the continuous cycle, from float64 numbers.
"""

import math
from functools import cached_property
from itertools import pairwise

import mpmath as mp
import numpy as np
from closed_forms import slider_motion
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
    "h": ("groups.g.second.offset", 0.0, (1, 0, 0)),
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
    "rod longer by 1e-6": {"l": 0.05 * (1 + 1e-6)},
    "rod longer by 1e-12": {"l": 0.05 * (1 + 1e-12)},
    "rod a million cranks long": {"l": 5e4},
    "machine of micrometres": {"r": 1e-6, "l": 4e-6, "e": 1e-7},
    "machine of a thousand kilometres": {"r": 1e6, "l": 4e6, "e": 1e5},
    "crank of a micrometre, rod of a metre": {"r": 1e-6, "l": 1.0, "e": 1e-6},
    "ram of 1e-12 kg": {"m": 1e-12},
    "ram of 1e9 kg": {"m": 1e9},
    "all masses of 1e-12 kg": {"m": 1e-12, "me": 1e-12, "J": 1e-14},
    "ram of 1e-3 kg on a rotor of 1e9 kg·m²": {"m": 1e-3, "J": 1e9},
    "1e-9 rad/s": {"w": 1e-9},
    "a million revolutions a minute backwards": {"w": -1e5},
    "fluctuation of 1e-8": {"d": 1e-8},
    "fluctuation of 1.9": {"d": 1.9},
    "micrometres, 1e-12 kg, 1e5 1/s": {"r": 1e-6, "l": 4e-6, "e": 1e-7, "m": 1e-12, "me": 1e-12, "J": 1e-24, "w": 1e5},
    "kilometres, 1e9 kg, 1e-9 rad/s": {"r": 1e3, "l": 1.001e3, "e": 1.0, "m": 1e9, "me": 1e9, "J": 1e15, "w": 1e-9},
    "no load": {"F": 0.0, "c": 0.0, "g": 0.0},
    "drag alone, 1e-12 N·s/m": {"F": 0.0, "g": 0.0, "c": 1e-12},
    "guide a fifth of the rod off": {"h": 0.04, "c": 0.0},
    "rod longer than crank and offset by 1e-8": {"h": 0.03, "l": 0.08 * (1 + 1e-8), "c": 0.0},
    "rod longer than crank and offset by 1e-4, the other way": {"h": -0.03, "l": 0.08 * (1 + 1e-4), "c": 0.0},
}


def paths(variants: list[dict]) -> dict[str, np.ndarray]:
    return {NUMBERS[name][0]: np.array([v[name] for v in variants]) for name in NUMBERS}


class SliderCrank:
    """The slider-crank of some numbers; angles are mpmath's."""

    def __init__(self, numbers: dict[str, float]) -> None:
        self.v = {name: mp.mpf(float(value)) for name, value in numbers.items()}
        self.first_kind = self.v["J"] + self.v["me"] * self.v["e"] ** 2
        self.weight = self.v["me"] * self.v["g"] * self.v["e"]

    def transfer(self, phi: mp.mpf) -> tuple[mp.mpf, mp.mpf, mp.mpf]:
        """Place of the ram, and its first two derivatives by the crank's angle."""
        return slider_motion(phi, *(self.v[name] for name in "rlh"), by=mp)

    def moment(self, phi: mp.mpf, x1: mp.mpf) -> mp.mpf:
        return self.v["F"] * x1 - self.v["c"] * self.v["w"] * x1**2 - self.weight * mp.cos(phi)


class Closed(SliderCrank):
    """Fields of the slider-crank at some positions, with what rounding may do to each, in units of EPS."""

    def __init__(self, nodes: np.ndarray, numbers: dict[str, float]) -> None:
        super().__init__(numbers)
        self.rows = {name: [] for name in FIELDS if name != "W"}
        self.slack = {name: [] for name in self.rows}
        for phi in nodes:
            self._position(float(phi))

    def _position(self, phi: float) -> None:
        r, rod, h, mass, speed, drag = (self.v[name] for name in ("r", "l", "h", "m", "w", "c"))
        c, s = mp.cos(mp.mpf(phi)), mp.sin(mp.mpf(phi))
        y = r * s - h
        root = mp.sqrt(rod**2 - y**2)
        # Where the crank is square to the guide, the height of its pin is the crank's length, without rounding.
        exact = abs(math.sin(phi)) == 1.0 and h == 0
        grown = ROUNDINGS * (1 if exact else (rod / root) ** 2)
        # Zeros of cosine and sine are off by EPS of 1, so sizes are those of terms without them.
        whole = r + abs(h)
        size1, size2 = r + r * whole / root, r + r * whole / root + (y * r * c) ** 2 / root**3
        x, x1, x2 = self.transfer(mp.mpf(phi))
        inertia, slope = self.first_kind + mass * x1**2, 2 * mass * x1 * x2
        moment = self.moment(mp.mpf(phi), x1)
        of_slope = 2 * mass * grown * (abs(x2) * size1 + abs(x1) * size2)
        of_moment = grown * size1 * (abs(self.v["F"]) + 2 * abs(drag * speed * x1)) + ROUNDINGS * abs(self.weight)
        for name, value, slack in (
            ("x", x, grown * (r + root)),
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


class Cycle(SliderCrank):
    """Summaries of the slider-crank's continuous cycle.

    A drag is allowed for without an offset of the guide alone: its work is elementary then.
    """

    def __init__(self, numbers: dict[str, float]) -> None:
        super().__init__(numbers)
        assert not (self.v["h"] and self.v["c"])
        self.turn = 2 * mp.pi
        self.mean = -self.v["c"] * self.v["w"] * self._square(self.turn) / self.turn
        self.first = self.inertia(mp.mpf(0))
        # Closer and closer about the places where the rod may stand across the guide.
        steep = [at + sign * mp.mpf(10) ** (-k / mp.mpf(4)) for at in (mp.pi / 2, 3 * mp.pi / 2) for sign in (-1, 1)
                 for k in range(36)]  # fmt: skip
        self.grid = sorted([*(self.turn * k / 96 for k in range(97)), *steep])

    @cached_property
    def _slopes(self) -> list[tuple[mp.mpf, mp.mpf]]:
        return [self._rates(phi) for phi in self.grid]

    def _square(self, phi: mp.mpf) -> mp.mpf:
        """∫₀^φ x′² dφ = r² ∫ (s² + 2 r s² c/√(l² − r² s²) + r² s² c²/(l² − r² s²)) dφ, term by term."""
        if not self.v["c"]:
            return mp.mpf(0)
        r, rod, c, s = self.v["r"], self.v["l"], mp.cos(phi), mp.sin(phi)
        ratio = r / rod
        sines = phi / 2 - s * c / 2
        second = rod**2 / (2 * r**3) * mp.asin(ratio * s) - s * mp.sqrt(rod**2 - (r * s) ** 2) / (2 * r**2)
        # With y = s², (y − y²)/(1 − λ² y) = y/λ² + k − k/(1 − λ² y).
        k, across = (1 - ratio**2) / ratio**4, mp.sqrt((1 - ratio) * (1 + ratio))
        turned = phi + mp.atan2((across - 1) * s * c, c * c + across * s * s)
        third = (sines / ratio**2 + k * (phi - turned / across)) / rod**2
        return r**2 * (sines + 2 * r * second + r**2 * third)

    def work(self, phi: mp.mpf) -> mp.mpf:
        """W(φ) about the mean moment."""
        of_force = self.v["F"] * (self.transfer(phi)[0] - self.transfer(mp.mpf(0))[0])
        of_drag = -self.v["c"] * self.v["w"] * self._square(phi)
        return of_force - self.weight * mp.sin(phi) + of_drag - self.mean * phi

    def inertia(self, phi: mp.mpf) -> mp.mpf:
        return self.first_kind + self.v["m"] * self.transfer(phi)[1] ** 2

    def _rates(self, phi: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
        """dW/dφ and dI/dφ."""
        _, x1, x2 = self.transfer(phi)
        return self.moment(phi, x1) - self.mean, 2 * self.v["m"] * x1 * x2

    def extremes(self, slope: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
        """Least and greatest value of W − slope (I − I_1): where its rate changes sign, and at the first position."""
        rates = [w - slope * i for w, i in self._slopes]
        places = [mp.mpf(0)]
        for (a, b), (before, after) in zip(pairwise(self.grid), pairwise(rates), strict=True):
            if before * after <= 0:
                places.append(self._turning(a, b, before, slope))
        values = [self.work(phi) - slope * (self.inertia(phi) - self.first) for phi in places]
        return min(values), max(values)

    def _turning(self, a: mp.mpf, b: mp.mpf, before: mp.mpf, slope: mp.mpf) -> mp.mpf:
        """Between two positions of the grid; the value is off by no more than the square of what the place is."""
        for _ in range(40):
            middle = (a + b) / 2
            w, i = self._rates(middle)
            a, b = (middle, b) if (w - slope * i) * before > 0 else (a, middle)
        return (a + b) / 2

    def summaries(self) -> dict[str, mp.mpf]:
        """NaN: a speed fluctuation of a machine that would stop."""
        square, delta = self.v["w"] ** 2, self.v["d"]
        low, high = self.extremes(mp.mpf(0))
        bottom, top = self.extremes(square / 2)
        wheel = self._excess(delta) / (delta * square) - self.first
        near, far = (mp.sqrt((self.v["l"] + sign * self.v["r"]) ** 2 - self.v["h"] ** 2) for sign in (-1, 1))
        return {
            "required_drive_moment": -self.mean,
            "required_power": -self.mean * self.v["w"],
            "excess_work": high - low,
            "flywheel_excess_work": (high - low) / (delta * square),
            "flywheel_merzalov": (top - bottom) / (delta * square) - self.first_kind,
            "flywheel_wittenbauer": wheel,
            "speed_fluctuation": delta if wheel > 0 else self._fluctuation(),
            "ram.stroke": far - near,
        }

    def _excess(self, delta: mp.mpf) -> mp.mpf:
        """max(W − ½ω_max² (I − I_1)) − min(W − ½ω_min² (I − I_1)), which is δ ω_m² (I_1 + I_F)."""
        slow, fast = (self.v["w"] ** 2 / 2 * (1 + sign * delta / 2) ** 2 for sign in (-1, 1))
        return self.extremes(fast)[1] - self.extremes(slow)[0]

    def _fluctuation(self) -> mp.mpf:
        """δ without a flywheel."""

        def beyond(delta: mp.mpf) -> mp.mpf:
            return self._excess(delta) / (self.v["w"] ** 2 * self.first) - delta

        if beyond(mp.mpf(2)) > 0:
            return mp.nan
        if self._excess(mp.mpf(0)) == 0:
            return mp.mpf(0)
        guess = beyond(mp.mpf(0))
        return mp.findroot(beyond, (guess / 2, guess), tol=mp.mpf(10) ** -60, maxsteps=50)
