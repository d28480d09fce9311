"""A drawing to a round scale: vectors, mechanism figures, labels clear of lines."""

import math
from collections.abc import Iterable, Sequence
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Polygon
from matplotlib.text import Text
from matplotlib.textpath import TextPath

from engine import table_unit
from sweeps.pictures.drawing import Primitive, paint
from sweeps.pictures.style import GREY, MM_PER_INCH

MM_PER_POINT = MM_PER_INCH / 72
LETTERS = 8.0
# Sizes on paper [mm].
HEAD, HALF_HEAD, DOT = 2.4, 0.55, 0.45
# Height of the strip for the scale along the lower edge.
STRIP = 5.0
LEAST_VECTOR = 0.4
MARK = 0.5
GAPS = (0.5, 1.5, 3.0, 5.0, 7.5)
_STEPS = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.5, 10.0)


def round_scale(least: float) -> float:
    """Smallest scale 1, 1.5, 2, 2.5, 3, 4, 5, 6, 7.5 times a power of ten that is at least `least`.

    Parameters
    ----------
    least : float
        Minimum units per millimetre of paper; positive.
    """
    power = 10.0 ** math.floor(math.log10(least))
    # Allow for rounding.
    return next(step for step in _STEPS if step * power >= least * (1 - 1e-9)) * power


class _Label(NamedTuple):
    """A text with candidate positions: centres [mm] with costs, and the start of its leader."""

    text: str
    colour: str
    places: np.ndarray
    costs: np.ndarray
    half: complex
    origin: complex


@lru_cache(4096)
def half_size(text: str) -> complex:
    """Half width and height of a text on paper [mm]."""
    box = TextPath((0, 0), text, size=LETTERS).get_extents()
    return complex(box.width, max(box.height, 0.55 * LETTERS)) * MM_PER_POINT / 2


def size_of(ax: Axes) -> complex:
    """Width and height of axes on paper [mm]."""
    return complex(*(MM_PER_INCH * ax.figure.get_size_inches() * ax.get_position().size))


class Paper:
    """Axes as a sheet of paper with a round scale; labels are placed last, when all lines are known.

    The scale holds for the axes' size at creation.

    Parameters
    ----------
    ax : Axes
    cloud : sequence of complex
        Points that must fit, x + iy in drawing units.
    margin : float
        Margin for labels [mm].
    to_scale : bool
        Round the scale, and leave a strip to show it.

    Attributes
    ----------
    per_mm : float
        Drawing units per millimetre of paper.
    """

    def __init__(self, ax: Axes, cloud: Sequence[complex], margin: float = 8.0, to_scale: bool = True) -> None:
        self.ax, points = ax, np.asarray(cloud, complex)
        self.size = size_of(ax)
        low, high = (complex(f(points.real), f(points.imag)) for f in (np.min, np.max))
        self.strip = STRIP if to_scale else 0.0
        room = self.size - complex(2 * margin, 2 * margin + self.strip)
        span = high - low
        least = max(span.real / room.real, span.imag / room.imag) or 1.0
        self.per_mm = round_scale(least) if to_scale else least
        self.corner = (low + high) / 2 - self.per_mm * (self.size + 1j * self.strip) / 2
        top = self.corner + self.per_mm * self.size
        ax.set(xlim=(self.corner.real, top.real), ylim=(self.corner.imag, top.imag))
        ax.set_axis_off()
        self._marks: list[np.ndarray] = []
        self._labels: list[_Label] = []

    def _mm(self, places: object) -> object:
        return (places - self.corner) / self.per_mm

    def mark(self, points: Sequence[complex]) -> None:
        """Keep labels off a polyline."""
        ends = self._mm(np.asarray(points, complex))
        for a, b in pairwise(ends):
            self._marks.append(np.linspace(a, b, min(int(abs(b - a) / MARK) + 2, 1000)))

    def figures(self, drawn: Iterable[Primitive]) -> None:
        """Paint mechanism figures without names."""
        drawn = [p for p in drawn if p.kind != "text"]
        paint(self.ax, drawn, 1.0)
        for p in drawn:
            self.mark(p.outline())

    def line(self, points: Sequence[complex], colour: str = GREY, width: float = 0.5, dashes: object = "solid") -> None:
        """Draw a polyline."""
        z = np.asarray(points, complex)
        self.ax.plot(z.real, z.imag, color=colour, linewidth=width, linestyle=dashes, zorder=6, solid_capstyle="round")
        self.mark(points)

    def arrow(self, start: complex, vector: complex, text: str, colour: str, width: float = 1.1) -> None:
        """Draw a vector with its symbol, if long enough."""
        if abs(vector) < LEAST_VECTOR * self.per_mm:
            return
        length, u = abs(vector) / self.per_mm, vector / abs(vector)
        head = min(HEAD, 0.6 * length) * self.per_mm
        tip = start + vector
        wings = [tip - head * u + side * HALF_HEAD / HEAD * head * 1j * u for side in (1, -1)]
        shaft = np.array([start, tip - 0.8 * head * u])
        self.ax.plot(shaft.real, shaft.imag, color=colour, linewidth=width, zorder=7, solid_capstyle="butt")
        corners = [(z.real, z.imag) for z in (tip, *wings)]
        self.ax.add_artist(Polygon(corners, closed=True, facecolor=colour, edgecolor="none", zorder=7.5))
        self.mark([start, tip])
        self.mark([tip, wings[0], wings[1], tip])
        if text:
            self._beside(start, vector, text, colour)

    def _beside(self, start: complex, vector: complex, text: str, colour: str) -> None:
        """Request a label position next to a vector."""
        a, b, half = self._mm(start), self._mm(start + vector), half_size(text)
        normal = 1j * (b - a) / abs(b - a)
        reach = abs(normal.real) * half.real + abs(normal.imag) * half.imag
        found = [
            (a + t * (b - a) + side * (reach + gap) * normal, gap + 4 * abs(t - 0.5))
            for t in (0.5, 0.4, 0.6, 0.3, 0.7, 0.15, 0.85)
            for side in (1, -1)
            for gap in GAPS
        ]
        self._ask(text, colour, found, half, (a + b) / 2)

    def name(self, at: complex, text: str, colour: str = "black", clear: float = 0.7) -> None:
        """Request a label position next to a point, at distance `clear` [mm]."""
        c, half = self._mm(at), half_size(text)
        found = []
        for angle in np.arange(0, math.tau, np.pi / 8):
            u = np.exp(1j * angle)
            beside = half.real * np.clip(1.5 * u.real, -1, 1) + 1j * half.imag * np.clip(1.5 * u.imag, -1, 1)
            found += [(c + (clear + gap) * u + beside, gap) for gap in GAPS]
        self._ask(text, colour, found, half, c)

    def _ask(self, text: str, colour: str, found: list[tuple[complex, float]], half: complex, origin: complex) -> None:
        places, costs = (np.array(part) for part in zip(*found, strict=True))
        self._labels.append(_Label(text, colour, places, costs, half, origin))

    def dot(self, at: complex, text: str) -> None:
        """Draw a named point."""
        radius = DOT * self.per_mm
        self.ax.add_artist(Circle((at.real, at.imag), radius, facecolor="black", edgecolor="none", zorder=8))
        self.mark(at + radius * np.exp(2j * np.pi * np.arange(5) / 4))
        self.name(at, text, clear=DOT + 0.3)

    def scale(self, bar: str, note: str) -> None:
        """Draw a scale bar of 20 mm in the lower left corner, with its length and the scale."""
        a = self.corner + (2 + 3j) * self.per_mm
        b = a + 20.0 * self.per_mm
        ends = [a + 1j * self.per_mm, a, b, b + 1j * self.per_mm]
        self.ax.plot(np.real(ends), np.imag(ends), color="black", linewidth=0.8, solid_joinstyle="miter")
        middle = (a + b) / 2
        self._text(middle + 0.8j * self.per_mm, bar, fontsize=6.5, ha="center", va="bottom")
        self._text(b + 3 * self.per_mm, note, fontsize=7, ha="left", va="bottom")

    def scale_of(self, symbol: str, unit: str) -> None:
        """Draw a scale bar of a quantity in a unit, and its size on a millimetre or inch of paper."""
        per, paper = (1.0, "mm") if table_unit("m")[1] in ("mm", "m") else (MM_PER_INCH, "in")
        bar = unit if "/" not in unit else f"({unit})"
        note = rf"$\mu_{symbol}$ = {per * self.per_mm:.4g} {bar}/{paper}"
        self.scale(f"{20 * self.per_mm:g} {unit}", note)

    def _text(self, at: complex, text: str, **look: object) -> None:
        self.ax.add_artist(Text(at.real, at.imag, text, transform=self.ax.transData, **look))

    def letter(self) -> None:
        """Write all requested labels where they overlap least, in the order in which they were requested."""
        marks = np.concatenate(self._marks) if self._marks else np.empty(0, complex)
        taken: list[tuple[complex, complex]] = []
        for label in self._labels:
            half = label.half + complex(0.3, 0.25)
            gap = marks[None, :] - label.places[:, None]
            covered = ((np.abs(gap.real) < half.real) & (np.abs(gap.imag) < half.imag)).sum(axis=1)
            overlaps = sum(_overlap(label.places - centre, half + other) for centre, other in taken)
            cost = label.costs + 1.5 * covered + 8 * overlaps + 10 * self._outside(label.places, half)
            best = complex(label.places[np.argmin(cost)])
            taken.append((best, half))
            self._write(label, best)

    def _outside(self, places: np.ndarray, half: complex) -> np.ndarray:
        """Overlap of texts with the sheet's border or scale strip [mm]."""
        low, high = places - half, places + half - self.size
        beyond = (-low.real, self.strip - low.imag, high.real, high.imag)
        return sum(np.clip(part, 0, None) for part in beyond)

    def _write(self, label: _Label, place: complex) -> None:
        look = {"color": label.colour, "fontsize": LETTERS, "zorder": 9}
        self._text(self.corner + self.per_mm * place, label.text, ha="center", va="center", **look)
        away = place - label.origin
        edge = min(
            label.half.real / abs(away.real) if away.real else math.inf,
            label.half.imag / abs(away.imag) if away.imag else math.inf,
        )
        # A leader only for distant labels.
        if (1 - edge) * abs(away) > 4:
            ends = self.corner + self.per_mm * np.array([label.origin, place - edge * away])
            self.ax.plot(ends.real, ends.imag, color=GREY, linewidth=0.4, zorder=5)


def _overlap(apart: np.ndarray, both: complex) -> np.ndarray:
    """Overlap of two texts from the distance of their centres and the sum of their half sizes [mm²]."""
    wide, high = both.real - np.abs(apart.real), both.imag - np.abs(apart.imag)
    return np.clip(wide, 0, None) * np.clip(high, 0, None)
