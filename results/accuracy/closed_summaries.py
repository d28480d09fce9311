"""True values of a machine's summaries, by the engine's names, with the uncertainty of the references."""

import math
from typing import NamedTuple

import numpy as np
from closed_cycle import TO_SERIES, TURN, Curve, Cycle, W, X, legendre_sum

STATISTICS_OF_VALUE = ("min", "max", "range", "peak", "mean", "rms")
ORDERS = (1, 2, 4)
# Permitted remainder of the series of a root, relative to its maximum, and minimum length of a part of a panel.
CLOSE_ROOT, SHORT = 1e-16, 1e-9


class Truth(NamedTuple):
    """A true value; for positions, all angles of the extreme; and its uncertainty, in the same unit."""

    values: tuple
    uncertainty: float = 0.0

    def error(self, value: float, turn: float = 0.0) -> float:
        """Distance of a value from the truth, from the nearest of several; angles modulo `turn`."""
        gaps = [abs(np.longdouble(value) - true) for true in self.values]
        if turn:
            gaps = [min(gap % TURN, TURN - gap % TURN) for gap in gaps]
        return float(min(gaps))

    @property
    def size(self) -> float:
        """Magnitude of the value."""
        return float(abs(self.values[0]))


def one(value: object, uncertainty: float = 0.0) -> Truth:
    """A single true value."""
    return Truth((value,), uncertainty)


def integral_of_root(curve: Curve) -> tuple[np.longdouble, float]:
    """Integral of the root of a curve, and its uncertainty.

    Panels are halved until the root's series has decayed.
    """
    scale = np.sqrt(curve.on_nodes().max())
    panel = np.arange(curve.panels.length.size)
    low, high = -np.ones(panel.size, np.longdouble), np.ones(panel.size, np.longdouble)
    total, left = np.longdouble(0), 0.0
    while panel.size:
        nodes = low[:, None] + (high - low)[:, None] * (X + 1) / 2
        root = np.sqrt(np.maximum(legendre_sum(nodes, curve.series[:, panel][:, :, None]), 0))
        tail = np.abs(root @ TO_SERIES.T)[:, -2:].sum(axis=1)
        share = curve.panels.length[panel] * (high - low) / 2
        done = (tail <= CLOSE_ROOT * scale) | (high - low < SHORT)
        total += (root @ W / 2 * share)[done].sum()
        left += float((tail * share)[done].sum())
        panel, low, high = panel[~done], low[~done], high[~done]
        middle = (low + high) / 2
        panel, low, high = np.tile(panel, 2), np.append(low, middle), np.append(middle, high)
    # The square is known within its rounding.
    return total, left + float(8 * np.finfo(np.longdouble).eps * scale * TURN)


class Summaries:
    """True summaries of a cycle.

    Parameters
    ----------
    cycle : Cycle
    asked : set of str
        Names of summaries; only fields named here get statistics.

    Attributes
    ----------
    truths : dict of str to Truth
    """

    def __init__(self, cycle: Cycle, asked: set[str]) -> None:
        self.cycle = cycle
        fields = {name.rpartition(".")[0] for name in asked}
        self.truths: dict[str, Truth] = {}
        for name in cycle.fields:
            if name in fields:
                self._statistics(name)
        self._strokes()
        self._swings(fields)
        for group, sine in cycle.dynamics.motion.sines.items():
            low, high = cycle.curve(sine).extremes()
            least = min(abs(low.value), abs(high.value)) if low.value * high.value > 0 else np.longdouble(0)
            self.truths[f"{group}.transmission_angle"] = one(np.arcsin(min(least, np.longdouble(1))))
        self._orders()
        if cycle.scene.flywheel is not None:
            self._flywheel()

    def _statistics(self, name: str) -> None:
        field, curve = self.cycle.fields[name], self.cycle.curves[name]
        low, high = curve.extremes()
        mean_square = curve.total / TURN if field.magnitude else self._square(curve)
        mean, uncertainty, of_ends = curve.total / TURN, 0.0, (0.0, 0.0)
        if field.magnitude:
            # Uncertainty of the square; that of the root grows as it becomes small.
            left = np.abs(curve.series[-2:]).max() + 16 * np.finfo(np.longdouble).eps * high.value
            of_ends = tuple(
                float(left / (np.sqrt(max(e.value, np.longdouble(0))) + np.sqrt(left))) for e in (low, high)
            )
            total, uncertainty = integral_of_root(curve)
            mean, uncertainty = total / TURN, uncertainty / float(TURN)
            low, high = (e._replace(value=np.sqrt(max(e.value, np.longdouble(0)))) for e in (low, high))
        values = (low.value, high.value, high.value - low.value, max(abs(low.value), abs(high.value)))
        left_open = {"mean": uncertainty, "min": of_ends[0], "max": of_ends[1]}
        for suffix, value in zip(STATISTICS_OF_VALUE, (*values, mean, np.sqrt(mean_square)), strict=True):
            self.truths[f"{name}.{suffix}"] = one(value, left_open.get(suffix, 0.0))
        self.truths[f"{name}.min_at"] = Truth(tuple(low.ties))
        self.truths[f"{name}.max_at"] = Truth(tuple(high.ties))

    def _square(self, curve: Curve) -> np.longdouble:
        return ((curve.on_nodes() ** 2 @ W) * curve.panels.length / 2).sum() / TURN

    def _strokes(self) -> None:
        for name, (low, high) in self.cycle.ends.items():
            self._ends(name, "stroke", low, high, *self.cycle.ends_at[name])

    def _ends(self, name: str, kind: str, low: object, high: object, low_at: np.ndarray, high_at: np.ndarray) -> None:
        found = {kind: high - low, f"{kind}_low": low, f"{kind}_high": high}
        self.truths |= {f"{name}.{what}": one(value) for what, value in found.items()}
        ups = [(b - a) % TURN for a in low_at for b in high_at]
        ratios = tuple(max(up, TURN - up) / min(up, TURN - up) for up in ups)
        found = {"low_at": tuple(low_at), "high_at": tuple(high_at), "time_ratio": ratios}
        self.truths |= {f"{name}.{kind}_{what}": Truth(values) for what, values in found.items()}

    def _swings(self, links: set[str]) -> None:
        """Rockers: links whose angular velocity changes sign and whose turn closes."""
        cycle, speed = self.cycle, self.cycle.numbers["input.speed"]
        for name in cycle.dynamics.motion.links:
            curve = cycle.curves.get(f"{name}.angular_velocity")
            if name not in links or curve is None or abs(curve.total / speed) > 1:
                continue
            turn = Curve(curve.panels, curve.series / speed).integral()
            low, high = turn.extremes()
            at_zero = cycle.motion(np.zeros(1, np.longdouble)).links[name].way
            ways = [cycle.motion(np.array([e.angle])).links[name].way for e in (low, high)]
            start = np.arctan2(at_zero.y[0], at_zero.x[0])[0]
            k = int(np.searchsorted(curve.panels.begin, TURN, "right") - 1)
            zero_at = turn.at(np.array([k]), 2 * (TURN - curve.panels.begin[k]) / curve.panels.length[k] - 1)
            ends = []
            for extreme, way in zip((low, high), ways, strict=True):
                guess = start + (extreme.value - zero_at[0])
                angle = np.arctan2(way.y[0], way.x[0])[0]
                ends.append(angle + TURN * np.round(float((guess - angle) / TURN)))
            self._ends(name, "swing", *ends, low.ties, high.ties)

    def _orders(self) -> None:
        """Half axes of the ellipses of the shaking force's orders."""
        force, nodes = self.cycle.dynamics.shaking, self.cycle.panels.nodes
        x, y = (part[0].reshape(nodes.shape) for part in force)

        def mean(row: np.ndarray) -> np.longdouble:
            return ((row @ W) * self.cycle.panels.length / 2).sum() / TURN

        for n in ORDERS:
            c, s = np.cos(n * nodes), np.sin(n * nodes)
            xc, xs, yc, ys = mean(x * c), mean(x * s), mean(y * c), mean(y * s)
            axis = np.hypot(xc + ys, yc - xs) + np.hypot(xc - ys, yc + xs)
            self.truths[f"shaking_force.order_{n}"] = one(axis)

    def _flywheel(self) -> None:
        cycle = self.cycle
        numbers, flywheel = cycle.numbers, cycle.scene.flywheel
        moment, inertia, omega = (
            cycle.curves["reduced_moment"],
            cycle.curves["reduced_inertia"],
            abs(numbers["input.speed"]),
        )
        mean = moment.total / TURN
        excess_moment = Curve(moment.panels, moment.series.copy())
        excess_moment.series[0] -= mean
        work = excess_moment.integral()
        low, high = work.extremes()
        found = {"required_drive_moment": -mean, "required_power": -mean * numbers["input.speed"]}
        found["excess_work"] = high.value - low.value
        wheel = numbers.get("flywheel.inertia")
        if flywheel.speed_fluctuation is not None:
            sizes = self._sizes(work, inertia, omega, numbers["flywheel.speed_fluctuation"], found["excess_work"])
            found |= sizes
            wheel = max(sizes["flywheel_wittenbauer"], np.longdouble(0)) if wheel is None else wheel
        found["flywheel_used"] = wheel
        found |= self._speeds(work, inertia, omega, wheel)
        self.truths |= {name: one(value) for name, value in found.items()}

    def _sizes(self, work: Curve, inertia: Curve, omega: object, delta: object, excess: object) -> dict[str, object]:
        # Half the squares of the minimum and maximum speed.
        slow, middle, fast = (omega**2 * (1 + sign * delta / 2) ** 2 / 2 for sign in (-1, 0, 1))
        energies = [work.plus(inertia, -slope).extremes() for slope in (slow, middle, fast)]
        scale = delta * omega**2
        merzalov = (energies[1][1].value - energies[1][0].value) / scale - self._first_kind()
        wittenbauer = (energies[2][1].value - energies[0][0].value) / scale
        by_excess = excess / scale
        return {
            "flywheel_excess_work": by_excess,
            "flywheel_merzalov": merzalov,
            "flywheel_wittenbauer": wittenbauer,
            "excess_work_difference": by_excess / wittenbauer - 1,
            "merzalov_difference": merzalov / wittenbauer - 1,
        }

    def _first_kind(self) -> np.longdouble:
        """Constant part of the inertia, of the bodies on the crank."""
        n, scene = self.cycle.numbers, self.cycle.scene
        on_crank = [f"bodies.{name}" for name, body in scene.bodies.items() if body.link == scene.input.link]
        return sum(n[f"{b}.inertia"] + n[f"{b}.mass"] * (n[f"{b}.x"] ** 2 + n[f"{b}.y"] ** 2) for b in on_crank)

    def _speeds(self, work: Curve, inertia: Curve, omega: object, wheel: object) -> dict[str, object]:
        """Minimum and maximum speed of the cycle with a flywheel, for its mean speed."""
        w, i = work.on_nodes(), inertia.on_nodes() + wheel
        usual = omega**2 / 2

        def slowest_and_fastest(surplus: np.longdouble) -> tuple[np.longdouble, np.longdouble]:
            # ½ω² less that at the mean speed, so that small fluctuations keep their digits.
            ratio = Curve.through(work.panels, (surplus + w - usual * (i - i[0, 0])) / i)
            low, high = ratio.extremes()
            return tuple(np.sqrt(max(2 * (usual + e.value), np.longdouble(0))) - omega for e in (low, high))

        x0 = usual * (i - i[0, 0]).mean() - w.mean()
        x1 = x0 + (w.max() - w.min()) / 16 + usual * i[0, 0] * np.longdouble(1e-6)
        f0, f1 = sum(slowest_and_fastest(x0)), sum(slowest_and_fastest(x1))
        for _ in range(30):
            if f1 == f0 or abs(f1) <= 1e-18 * omega:
                break
            x0, x1, f0 = x1, x1 - f1 * (x1 - x0) / (f1 - f0), f1
            f1 = sum(slowest_and_fastest(x1))
        slow, fast = slowest_and_fastest(x1)
        if not abs(f1) <= 1e-12 * omega or not slow > -omega:
            return {name: np.longdouble(math.nan) for name in ("speed_fluctuation", "speed_min", "speed_max")}
        return {"speed_fluctuation": (fast - slow) / omega, "speed_min": omega + slow, "speed_max": omega + fast}
