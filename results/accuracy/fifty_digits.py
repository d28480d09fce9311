"""The references of random machines against mpmath at 50 digits.

    python results/accuracy/fifty_digits.py

evaluates every field where it is extreme, of every machine, from the same closed formulas at 50 digits, and for some
machines the mean moment and the excess work by Gauss's rule at 50 digits; writes fifty_digits.md beside this file.
With gmpy2 installed, mpmath takes a tenth of the time.
"""

import argparse
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import mpmath
import numpy as np
from closed_cycle import TURN, Curve, Cycle, fields_of
from closed_forces import Dynamics, Ends, Where
from closed_motion import Motion, numbers_of
from closed_summaries import Summaries
from random_machines import kinds, machines
from taylor import MANY_DIGITS

from engine.compiling.threads import threads

HERE = Path(__file__).parent
DIGITS = 50
# Of so many machines of a kind one has its integrals checked.
SAMPLED = 50
GAUSS = 20


def exactly(values: np.ndarray) -> np.ndarray:
    """Numbers in extended precision as mpmath's, without rounding."""
    high = np.asarray(values, float)
    low = np.asarray(values - high, float)
    return np.array([mpmath.mpf(float(h)) + mpmath.mpf(float(d)) for h, d in zip(high, low, strict=True)], object)


class Checked:
    """A machine at 50 digits beside its references."""

    def __init__(self, cycle: Cycle, varied: dict[str, float]) -> None:
        self.cycle, self.numbers = cycle, numbers_of(cycle.scene, varied, MANY_DIGITS)
        self.ends = self._ends()

    def motion(self, angles: np.ndarray) -> Motion:
        """Motion at 50 digits."""
        return Motion(self.cycle.scene, self.numbers, angles, 2, MANY_DIGITS)

    def _ends(self) -> Ends:
        """Ends of strokes, from one Newton step more."""
        found = {}
        for name, places in self.cycle.ends_at.items():
            at = exactly(np.array([places[0][0], places[1][0]]))
            slide = self.motion(at).slides[name]
            found[name] = tuple(self.motion(at - slide[1] / (2 * slide[2])).slides[name][0])
        return found

    def dynamics(self, angles: np.ndarray, middles: np.ndarray) -> Dynamics:
        """Dynamics at 50 digits."""
        where = Where(self.motion(angles), self.motion(middles))
        return Dynamics(self.cycle.scene, self.numbers, where, self.ends)

    def values(self, summaries: Summaries) -> float:
        """Greatest difference of an extreme value from its reference, relative to the field's peak."""
        points = list(summaries.pointwise.items())
        angles = exactly(np.array([p.extreme.angle for _, p in points]))
        fields = fields_of(self.dynamics(angles, exactly(np.array([p.extreme.middle for _, p in points]))))
        worst = 0.0
        for i, (_, point) in enumerate(points):
            value = fields[point.field].series[0][i]
            value = mpmath.sqrt(value) if fields[point.field].magnitude else value
            peak = max(float(abs(summaries.truths[f"{point.field}.{end}"].values[0])) for end in ("min", "max"))
            if peak > 0:
                worst = max(worst, float(abs(value - exactly(np.array([point.extreme.value]))[0])) / peak)
        return worst

    def integrals(self, summaries: Summaries) -> float:
        """Greatest relative difference of the mean moment and the excess work from their references."""
        panels, moment = self.cycle.panels, self.cycle.curves["reduced_moment"]
        begin, length, middle = (exactly(part) for part in panels)
        nodes, weights = _gauss()
        places = (begin[:, None] + length[:, None] * (nodes + 1) / 2).ravel()
        values = self.dynamics(places, np.repeat(middle, nodes.size)).moment[0].reshape(begin.size, nodes.size)
        areas = (values @ weights) * length / 2
        mean = areas.sum() / (2 * mpmath.pi)
        work = np.concatenate([[mpmath.mpf(0)], np.cumsum(areas - mean * length)])
        panel, x = self._extremes(moment)
        local = length[panel] * (x + 1) / 2
        inner = (begin[panel][:, None] + local[:, None] * (nodes + 1) / 2).ravel()
        parts = self.dynamics(inner, np.repeat(middle[panel], nodes.size)).moment[0].reshape(panel.size, nodes.size)
        there = work[panel] + ((parts @ weights) - 2 * mean) * local / 2
        excess = there[1] - there[0]
        truths = summaries.truths
        peak = max(truths[f"reduced_moment.{end}"].size for end in ("min", "max"))
        gaps = (
            abs(mean + exactly(np.array(truths["required_drive_moment"].values))[0]) / peak,
            abs(excess - exactly(np.array(truths["excess_work"].values))[0]) / excess,
        )
        return float(max(gaps))

    def _extremes(self, moment: Curve) -> tuple[np.ndarray, np.ndarray]:
        """Panels and local places of the least and greatest work."""
        excess = Curve(moment.panels, moment.series.copy())
        excess.series[0] -= moment.total / TURN
        angles = np.array([e.angle for e in excess.integral().extremes()])
        panel = np.searchsorted(moment.panels.begin, angles, "right") - 1
        return panel, exactly(2 * (angles - moment.panels.begin[panel]) / moment.panels.length[panel] - 1)


def _gauss() -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights at 50 digits."""
    nodes, weights = [], []
    for guess in np.polynomial.legendre.leggauss(GAUSS)[0]:
        x = mpmath.findroot(lambda t: mpmath.legendre(GAUSS, t), mpmath.mpf(float(guess)))
        slope = GAUSS * (mpmath.legendre(GAUSS - 1, x) - x * mpmath.legendre(GAUSS, x)) / (1 - x * x)
        nodes.append(x)
        weights.append(2 / ((1 - x * x) * slope**2))
    return np.array(nodes, object), np.array(weights, object)


def checked_kind(index: int, count: int) -> tuple[str, list[float], list[float]]:
    """Differences of the extremes of all machines of a kind, and of the integrals of some."""
    mpmath.mp.dps = DIGITS
    kind = kinds()[index]
    varied = machines(kind, count)
    values, integrals = [], []
    for k in range(count):
        numbers = {path: float(column[k]) for path, column in varied.items()}
        with np.errstate(all="ignore"):
            cycle = Cycle(kind.scene, numbers)
            summaries = Summaries(cycle, set(kind.asked))
            checked = Checked(cycle, numbers)
            values.append(checked.values(summaries))
            if k % SAMPLED == 0:
                integrals.append(checked.integrals(summaries))
    return kind.name, values, integrals


def main() -> None:
    """Check all kinds and write the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--machines", type=int, default=100, help="of each kind")
    count = parser.parse_args().machines
    lines = [
        "# The references against 50 digits",
        "",
        f"Relative differences between the references in extended precision and mpmath at {DIGITS} digits, from the",
        "same float64 data: extreme values of all fields that are looked at, of every machine, and mean moment and",
        f"excess work of one machine in {SAMPLED}. Made by `python results/accuracy/fifty_digits.py`.",
        "",
        "| machine | machines | extremes: median | worst | integrals: worst |",
        "|---|---|---|---|---|",
    ]
    with ProcessPoolExecutor(threads()) as pool:
        for name, values, integrals in pool.map(checked_kind, range(len(kinds())), [count] * len(kinds())):
            cells = f"{np.median(values):.1e} | {max(values):.1e} | {max(integrals):.1e}"
            lines.append(f"| {name} | {count} | {cells} |")
    (HERE / "fifty_digits.md").write_text("\n".join([*lines, ""]))


if __name__ == "__main__":
    main()
